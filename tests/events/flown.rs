//! A flight through `Horizon`, without aiding and with rates and GPS, under one of six even skies.

use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config::Settings;
use irhorizon::frame::{Aiding, Frame};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::{Scenario, SimulatedSource};
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

/// The skies, by the names of the scenarios.
pub const SKIES: [&str; 6] = ["clear-dry", "clear-humid", "namibia", "durham", "overcast", "radiance"];
/// How the instruments are heard: not at all, and with rates and GPS.
pub const AIDING: [&str; 2] = ["without aiding", "with rates and GPS"];
/// Scans a second.
const RATE_HZ: f64 = 50.0;

/// The scenario of the sky number `i`.
pub fn under(i: u64) -> Scenario {
    let name = SKIES[i as usize % SKIES.len()];
    Scenario::named(name).unwrap_or_else(|| panic!("no scenario {name}"))
}

/// An instant of a flight.
pub struct Instant<'a> {
    /// Seconds flown.
    pub time_s: f64,
    /// What is truly flown.
    pub truth: Attitude,
    /// What is said.
    pub estimate: &'a Estimate,
    /// What is wrong with it, if something new is given.
    pub error: Option<Error>,
    head: &'a Head,
}

/// How far off an attitude is.
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// The larger of those of roll and pitch, °.
    pub larger_deg: f64,
    /// Whether both are within twice their standard deviations.
    pub covered: bool,
}

impl Instant<'_> {
    /// What is said to be wrong.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.estimate.faults.iter().map(|f| f.kind.display(self.head).to_string())
    }
}

/// Flies for `seconds` at 50 Hz; `look` is called with 0 for what is said without aiding, 1 with rates and GPS.
pub fn fly(mut source: SimulatedSource, seconds: f64, mut look: impl FnMut(usize, &Instant)) {
    let head = Head::six();
    let mut settings = Settings::default();
    // What is learnt of the mounting would hide errors, and none is off here.
    settings.head.learn_trim = false;
    let mut both: [(Horizon, Estimate); 2] =
        std::array::from_fn(|_| (Horizon::new(&settings, head.clone()), Estimate::default()));
    let mut frame = Frame::new(head.sensors.len());
    let mut heard = frame.clone();
    let begin = Time::from_secs_f64(100.0);
    for i in 0..(seconds * RATE_HZ) as u32 {
        let time_s = f64::from(i) / RATE_HZ;
        let now = Time::from_secs_f64(100.0 + time_s);
        source.scan(now, &mut frame);
        for (aided, (horizon, estimate)) in both.iter_mut().enumerate() {
            heard.clone_from(&frame);
            if aided == 0 {
                heard.aiding = Aiding::default();
            }
            let last = estimate.valid_at;
            horizon.update(&heard, &[], estimate);
            // One that was left standing was judged when it was new.
            let new = estimate.attitude.filter(|_| estimate.valid_at > last.max(begin));
            let truth = source.truth_at(estimate.valid_at);
            let error = new.map(|attitude| Error::new(attitude, estimate.sigma, truth));
            look(aided, &Instant { time_s, truth: source.truth_at(now), estimate, error, head: &head });
        }
    }
}

impl Error {
    fn new(said: Attitude, sigma: Attitude, truth: Attitude) -> Self {
        let turned = |a: f64| (a + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
        let [roll, pitch] = [turned(said.roll - truth.roll).abs(), (said.pitch - truth.pitch).abs()];
        let covered = roll <= 2.0 * sigma.roll && pitch <= 2.0 * sigma.pitch;
        Self { larger_deg: roll.max(pitch).to_degrees(), covered }
    }
}
