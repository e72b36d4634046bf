//! Named scenarios flown once, their frames kept with the truth, so that every method is scored on the same.

use irhorizon::attitude::Attitude;
use irhorizon::ctl::score::statistics::{Errors, Said, Score, Truth};
use irhorizon::estimator::Estimator;
use irhorizon::frame::{Aiding, Frame};
use irhorizon::simulation::Scenario;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// The first flight's seed. A few constants were settled with the first three flights in sight.
const FIRST: u64 = 11;
/// Frames of a flight: 300 s at 50 Hz.
const FRAMES: u64 = 300 * 50;
/// The first 20 s are left out: a method may begin as it likes.
const LEFT_OUT: usize = 20 * 50;

/// A flight's frames with the attitudes truly flown.
#[derive(Debug)]
pub struct Flown(Vec<(Frame, Attitude)>);

impl Flown {
    /// Flies `scenario` so many times, each with another seed: chance is pooled, as where the clouds stand differs more
    /// from flight to flight than methods do.
    pub fn all(scenario: &Scenario, flights: u64) -> Vec<Self> {
        let fly = |seed| {
            let mut source = scenario.source(seed);
            let mut frame = Frame::new(scenario.head().sensors.len());
            let scan = |i| {
                let tick = Time::from_nanos(i * 20_000_000);
                source.scan(tick, &mut frame);
                (frame.clone(), source.truth_at(tick))
            };
            Self((0..FRAMES).map(scan).collect())
        };
        (FIRST..FIRST + flights).map(fly).collect()
    }

    /// Takes the errors of `update` into `errors`, each frame changed by `change` before it is seen.
    fn judge(&self, change: impl Fn(&mut Frame), mut update: impl FnMut(&Frame) -> Option<Said>, errors: &mut Errors) {
        let mut seen = Frame::default();
        for (i, (frame, truth)) in self.0.iter().enumerate() {
            seen.clone_from(frame);
            change(&mut seen);
            let said = update(&seen);
            if i >= LEFT_OUT {
                let (roll_deg, pitch_deg) = (truth.roll.to_degrees(), truth.pitch.to_degrees());
                errors.add(Truth { roll_deg, pitch_deg }, said);
            }
        }
    }
}

/// What `estimator` says of each frame.
pub fn said(mut estimator: impl Estimator) -> impl FnMut(&Frame) -> Option<Said> {
    move |frame| {
        let solution = estimator.update(frame);
        solution.attitude.map(|a| Said::new(a, solution.sigma))
    }
}

/// Whether the instruments are heard: a change to frames.
pub fn hear(aided: bool) -> impl Fn(&mut Frame) {
    move |frame| {
        if !aided {
            frame.aiding = Aiding::default();
        }
    }
}

/// What is said of a method on all of `flights`: a fresh one from `make` for each, its frames changed by `change`.
pub fn score<U: FnMut(&Frame) -> Option<Said>>(
    flights: &[Flown],
    change: impl Fn(&mut Frame),
    make: impl Fn() -> U,
) -> Score {
    let mut errors = Errors::default();
    for flown in flights {
        flown.judge(&change, make(), &mut errors);
    }
    errors.score()
}
