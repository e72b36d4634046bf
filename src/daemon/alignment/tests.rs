use super::*;
use crate::aiding::{Link, What};
use crate::config::Settings;
use crate::config::settings::{Method, OnFault};
use crate::direction::Direction;
use crate::frame::{Sample, Value};
use crate::head::Head;

fn at(ms: u32) -> Time {
    Time::from_secs_f64(100.0 + f64::from(ms) / 1000.0)
}

/// A sinusoidal sky seen at roll 10° and pitch 3°, in frames that wait 0.2 s for rates that say 20 deg/s of roll.
struct Roll {
    alignment: Alignment,
    horizon: Horizon,
    estimate: Estimate,
    ms: u32,
}

impl Roll {
    fn new(on_fault: OnFault) -> Self {
        let mut settings = Settings::default();
        settings.estimator.method = Some(Method::Field);
        settings.faults.on_fault = on_fault;
        let horizon = Horizon::new(&settings, Head::six());
        let mut alignment = Alignment::new(6, 16);
        alignment.aligner.linked(Link { system: Some(1), aids: true, ..Link::default() });
        Self { alignment, horizon, estimate: Estimate::default(), ms: 0 }
    }

    /// What is published after the next scan, in whose frame there are six sensors or none.
    fn scan(&mut self, seen: bool) -> Estimate {
        self.ms += 20;
        let (time, now) = (at(self.ms), at(self.ms + 200));
        self.alignment.aligner.hear(&Said { time: now, arrived: now, what: What::Rates([20.0, 0.0, 0.0]) });
        let mut frame = Frame { time, ..Frame::new(6) };
        let vertical = Attitude::from_degrees(10.0, 3.0).vertical();
        for (reading, (_, direction)) in frame.readings.iter_mut().zip(Direction::NAMED).filter(|_| seen) {
            let object_c = 16.0 - 10.0 * (1.0 + direction.dot(vertical));
            *reading = Ok(Sample { value: Value::Absolute { object_c, ambient_c: None }, time });
        }
        self.horizon.update(&frame, &[], &mut self.estimate);
        let scan = Frame { time: now, ..Frame::new(6) };
        self.alignment.shown(&self.estimate, &mut self.horizon, &scan).clone()
    }

    fn for_s(&mut self, seconds: u32) -> Estimate {
        (0..50 * seconds).for_each(|_| _ = self.scan(true));
        self.scan(true)
    }
}

fn degrees(e: &Estimate) -> [f64; 2] {
    [e.attitude.unwrap().roll.to_degrees(), e.attitude.unwrap().pitch.to_degrees()]
}

#[test]
fn what_is_held_is_what_was_published() {
    let mut roll = Roll::new(OnFault::Hold);
    for _ in 0..2 {
        let mut last = roll.for_s(40);
        // Carried on for 0.2 s.
        assert!((degrees(&last)[0] - degrees(&roll.estimate)[0] - 4.0).abs() < 0.1 && last.measured, "{last:?}");
        assert_eq!(last.valid_at, at(roll.ms + 200));
        let mut held = 0;
        for _ in 0..150 {
            let e = roll.scan(false);
            if e.attitude.is_some() && !e.measured {
                assert_eq!((e.attitude, e.valid_at), (last.attitude, at(roll.ms + 200)), "{held}");
                assert!(e.sigma.roll >= last.sigma.roll && e.sigma.pitch >= last.sigma.pitch);
                held += 1;
                last = e;
            } else if e.measured {
                last = e;
            }
        }
        assert!(held > 90, "{held}");
    }
}

#[test]
fn what_is_eased_to_level_begins_at_what_was_published() {
    let mut roll = Roll::new(OnFault::Level);
    let mut last = roll.for_s(40);
    let carried = last.sigma;
    for i in 0..500 {
        let e = roll.scan(false);
        if !e.measured {
            let ([was, _], [now, _]) = (degrees(&last), degrees(&e));
            assert!(now < was + 1e-9 && was - now < 0.25, "{was} {now} at frame {i}");
            assert!(e.sigma.roll >= carried.roll);
        }
        last = e;
    }
    assert!(!last.measured && degrees(&last)[0].abs() < 0.2, "{last:?}");
}
