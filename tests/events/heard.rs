//! A flight through `Horizon`, heard in several ways at once.

use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::Settings;
use irhorizon::frame::{Aiding, Frame};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::SimulatedSource;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// What is heard of all that the instruments say.
pub type Way = fn(Aiding) -> Aiding;

/// An instant of a flight.
pub struct Instant<'a> {
    /// Seconds flown.
    pub time_s: f64,
    /// What is truly flown.
    pub truth: Attitude,
    /// What is said.
    pub estimate: &'a Estimate,
    /// An attitude, if a new one is given, and what was truly flown at its time. One that was left standing was judged when it
    /// was new.
    pub given: Option<(Attitude, Attitude)>,
    head: &'a Head,
}

impl Instant<'_> {
    /// What is said to be wrong.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.estimate.faults.iter().map(|f| f.kind.display(self.head).to_string())
    }
}

/// Flies for `seconds` at `rate_hz`; `look` is called with the number of the way in which it is heard.
pub fn fly<const N: usize>(
    mut source: SimulatedSource,
    (seconds, rate_hz): (f64, f64),
    ways: [Way; N],
    mut look: impl FnMut(usize, &Instant),
) {
    let head = Head::six();
    let mut settings = Settings { rate_hz, ..Settings::default() };
    // What is learnt of the mounting would hide errors, and none is off here.
    settings.head.learn_trim = false;
    let mut all: [(Horizon, Estimate); N] =
        std::array::from_fn(|_| (Horizon::new(&settings, head.clone()), Estimate::default()));
    let mut frame = Frame::new(head.sensors.len());
    let begin = Time::from_secs_f64(100.0);
    for i in 0..(seconds * rate_hz) as u32 {
        let time_s = f64::from(i) / rate_hz;
        let now = Time::from_secs_f64(100.0 + time_s);
        source.scan(now, &mut frame);
        let aiding = frame.aiding;
        for (way, (horizon, estimate)) in all.iter_mut().enumerate() {
            frame.aiding = ways[way](aiding);
            let last = estimate.valid_at;
            horizon.update(&frame, &[], estimate);
            let new = estimate.attitude.filter(|_| estimate.valid_at > last.max(begin));
            let given = new.map(|attitude| (attitude, source.truth_at(estimate.valid_at)));
            look(way, &Instant { time_s, truth: source.truth_at(now), estimate, given, head: &head });
        }
    }
}
