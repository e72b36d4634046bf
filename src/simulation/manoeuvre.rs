//! What the pilot does: banks and climbs that are commanded, and how an airframe follows.

use super::flight::Flight;
use super::noise::Noise;
use super::turbulence::Gusts;

/// A climb after which only descents follow, and the other way round, rad s: some 100 m.
const FAR_RAD_S: f64 = 5.0;

/// A way of flying.
#[derive(Clone, Debug, PartialEq)]
pub enum Style {
    /// Turns and level stretches of 5 to 20 s and climbs, chosen by the seed, in turbulence.
    Random(Random),
    /// A script, with its own turbulence.
    Scripted(Flight),
}

/// Limits of a random flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random {
    /// The steepest bank commanded, °.
    pub bank_deg: f64,
    /// The steepest climb and descent commanded, °.
    pub climb_deg: f64,
    /// Roll rate of the turbulence, °/s rms.
    pub roll_rate_deg_s: f64,
    /// Pitch rate of the turbulence, °/s rms.
    pub pitch_rate_deg_s: f64,
}

impl Default for Random {
    /// Banks to 50°, climbs to 15°; in all, roll rates of 7.5 °/s rms.
    fn default() -> Self {
        Self { bank_deg: 50.0, climb_deg: 15.0, roll_rate_deg_s: 5.2, pitch_rate_deg_s: 2.1 }
    }
}

/// Roll and pitch with their rates, rad and rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Roll, going on beyond π.
    pub roll: f64,
    /// Its derivative.
    pub roll_rate: f64,
    /// Pitch, going on beyond π/2 over the top.
    pub pitch: f64,
    /// Its derivative.
    pub pitch_rate: f64,
}

/// An angle that follows a command as an airframe does.
#[derive(Clone, Debug, Default)]
struct Follower {
    omega: f64,
    rate_limit: f64,
    angle: f64,
    rate: f64,
    command: f64,
    /// The time of the next command, s.
    next_s: f64,
}

impl Follower {
    fn new(omega: f64, rate_limit_deg_s: f64) -> Self {
        Self { omega, rate_limit: rate_limit_deg_s.to_radians(), ..Self::default() }
    }

    /// Goes on to `time_s`, where `choose` gives the next command, rad, and how long it stands, s.
    fn step(&mut self, time_s: f64, dt_s: f64, choose: impl FnOnce() -> [f64; 2]) {
        if time_s >= self.next_s {
            let [command, hold_s] = choose();
            (self.command, self.next_s) = (command, time_s + hold_s);
        }
        let before = self.rate;
        let pull = self.omega * (self.omega * (self.command - self.angle) - 1.7 * self.rate);
        self.rate = (self.rate + pull * dt_s).clamp(-self.rate_limit, self.rate_limit);
        self.angle += 0.5 * (before + self.rate) * dt_s;
    }
}

/// A pilot of either style.
#[derive(Clone, Debug)]
pub(super) enum Pilot<'a> {
    Random(Box<RandomPilot>),
    Scripted(&'a Flight),
}

/// One who follows nothing but a seed.
#[derive(Clone, Debug)]
pub(super) struct RandomPilot {
    limits: Random,
    noise: Noise,
    bank: Follower,
    climb: Follower,
    /// How far it has climbed: the climb's angle over time, rad s.
    risen: f64,
    gusts: [Gusts; 2],
}

impl<'a> Pilot<'a> {
    pub fn new(style: &'a Style, seed: u64) -> Self {
        match style {
            Style::Scripted(flight) => Self::Scripted(flight),
            Style::Random(limits) => {
                let mut noise = Noise::new(seed);
                let gusts = [
                    Gusts::new(limits.roll_rate_deg_s.to_radians(), 2.5, 0.7, noise.bits()),
                    Gusts::new(limits.pitch_rate_deg_s.to_radians(), 2.5, 0.7, noise.bits()),
                ];
                let (bank, climb) = (Follower::new(1.0, 25.0), Follower::new(0.8, 6.0));
                Self::Random(Box::new(RandomPilot { limits: *limits, noise, bank, climb, risen: 0.0, gusts }))
            }
        }
    }

    /// The motion at `time_s`, `dt_s` after the last. `lift` gives the angle of attack's part of
    /// pitch and its derivative by roll, rad, at a roll.
    pub fn step(&mut self, time_s: f64, dt_s: f64, lift: impl Fn(f64) -> [f64; 2]) -> Motion {
        match self {
            Self::Random(pilot) => pilot.step(time_s, dt_s, lift),
            Self::Scripted(flight) => scripted(flight, time_s),
        }
    }
}

impl RandomPilot {
    fn step(&mut self, time_s: f64, dt_s: f64, lift: impl Fn(f64) -> [f64; 2]) -> Motion {
        let Self { limits, noise, bank, climb, risen, gusts } = self;
        bank.step(time_s, dt_s, || {
            let level = noise.uniform() < 0.3;
            let angle = limits.bank_deg.to_radians() * (2.0 * noise.uniform() - 1.0);
            [if level { 0.0 } else { angle }, 5.0 + 15.0 * noise.uniform()]
        });
        climb.step(time_s, dt_s, || {
            let level = noise.uniform() < 0.5;
            let angle = limits.climb_deg.to_radians() * (2.0 * noise.uniform() - 1.0);
            // Far from where it began it goes back.
            let angle = if risen.abs() > FAR_RAD_S { -angle.abs().copysign(*risen) } else { angle };
            [if level { 0.0 } else { angle }, 6.0 + 14.0 * noise.uniform()]
        });
        *risen += climb.angle * dt_s;
        let [[roll_gust, roll_gust_rate], [pitch_gust, pitch_gust_rate]] =
            gusts.each_mut().map(|gusts| gusts.step(dt_s));
        let (roll, roll_rate) = (bank.angle + roll_gust, bank.rate + roll_gust_rate);
        let [attack, attack_by_roll] = lift(roll);
        Motion {
            roll,
            roll_rate,
            pitch: climb.angle + attack + pitch_gust,
            pitch_rate: climb.rate + attack_by_roll * roll_rate + pitch_gust_rate,
        }
    }
}

/// The motion of a script.
fn scripted(flight: &Flight, time_s: f64) -> Motion {
    const STEP_S: f64 = 1e-4;
    let [before, [roll, pitch], after] = [-STEP_S, 0.0, STEP_S].map(|step| flight.angles(time_s + step));
    let [roll_rate, pitch_rate] = std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * STEP_S));
    Motion { roll, roll_rate, pitch, pitch_rate }
}
