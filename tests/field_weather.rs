//! Fog and hail over a head whose method is `field`: withheld while it lasts, right again after it.

use irhorizon::attitude::{Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::config::settings::SimulationSettings;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::{Flight, SimulatedSource, Weather};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// Flies for a minute; calls `look` with the seconds flown, the estimate and the larger error, °.
fn fly(weather: &[(f64, f64, f64)], mut look: impl FnMut(f64, &Estimate, f64)) {
    let head = Head::six();
    let weather = weather.iter().map(|&(time_s, ground_c, sky_max_k)| Weather { time_s, ground_c, sky_max_k });
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let mut source = SimulatedSource::new(&SimulationSettings::default(), &head, field)
        .with_flight(Flight::demo(3))
        .with_weather(weather.collect());
    let mut horizon = Horizon::new(&Settings::default(), head);
    let (mut frame, mut estimate) = (Frame::new(6), Estimate::default());
    for i in 0..3000 {
        let now = Time::from_secs_f64(100.0 + f64::from(i) * 0.02);
        source.scan(now, &mut frame);
        horizon.update(&frame, &[], &mut estimate);
        // As of when it is said to be: suspected weather leaves the last one standing.
        let truth = source.truth_at(estimate.time);
        let off = estimate
            .attitude
            .map_or(f64::NAN, |a| (a.roll - truth.roll).abs().max((a.pitch - truth.pitch).abs()).to_degrees());
        look(f64::from(i) * 0.02, &estimate, off);
    }
}

fn names(estimate: &Estimate) -> Vec<String> {
    estimate.faults.iter().map(|f| f.kind.display(&Head::six()).to_string()).collect()
}

#[test]
fn fog_withholds_the_attitude_and_lets_it_go_again() {
    let fog = [(0.0, 15.0, 38.0), (20.0, 15.0, 38.0), (23.0, 15.0, 0.5), (40.0, 15.0, 0.5), (43.0, 15.0, 38.0)];
    fly(&fog, |s, e, off| {
        if (2.0..20.0).contains(&s) || s > 47.0 {
            assert!(e.mode == Mode::Nominal && off < 3.0, "{s} s: {off}° {e:?}");
        }
        if (24.0..40.0).contains(&s) {
            assert!(e.mode == Mode::Faulted && e.attitude.is_none(), "{s} s: {e:?}");
            assert!(names(e).contains(&"low-contrast".to_owned()), "{s} s: {e:?}");
        }
        // At no time a wrong one.
        assert!(off.is_nan() || off < 8.0, "{s} s: {off}° {e:?}");
    });
}

#[test]
fn hail_withholds_the_attitude_and_lets_it_go_again() {
    let hail = [(0.0, 15.0, 38.0), (20.0, 15.0, 38.0), (24.0, 4.0, -6.0), (40.0, 4.0, -6.0), (44.0, 15.0, 38.0)];
    fly(&hail, |s, e, off| {
        if (26.0..40.0).contains(&s) {
            assert!(e.mode == Mode::Faulted && e.attitude.is_none(), "{s} s: {e:?}");
        }
        if (30.0..40.0).contains(&s) {
            assert!(names(e).contains(&"inverted-contrast".to_owned()), "{s} s: {e:?}");
        }
        if s > 48.0 {
            assert!(e.mode == Mode::Nominal && off < 3.0, "{s} s: {off}° {e:?}");
        }
        assert!(off.is_nan() || off < 8.0, "{s} s: {off}° {e:?}");
    });
}
