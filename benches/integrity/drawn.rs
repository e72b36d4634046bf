//! A flight by chance.

use irhorizon::simulation::aerobatics::aerobatics;
use irhorizon::simulation::aircraft::Aircraft;
use irhorizon::simulation::fault::kind::{Kind, Target};
use irhorizon::simulation::fault::{Fault, Who};
use irhorizon::simulation::manoeuvre::{Random, Style};
use irhorizon::simulation::noise::Noise;
use irhorizon::simulation::trajectory::Trajectory;
use irhorizon::simulation::{Scenario, SimulatedSource};

const SCENES: [&str; 10] = [
    "clear-dry",
    "clear-humid",
    "namibia",
    "durham",
    "overcast",
    "radiance",
    "scattered",
    "patchwork",
    "warm-sky",
    "into-cloud",
];
const SENSORS: [&str; 6] = ["nose", "tail", "left", "right", "up", "down"];
/// How many faults, and how often.
const FAULTS: [usize; 8] = [0, 1, 1, 1, 1, 1, 2, 2];
/// The share of flights with loops and rolls.
const WILD: f64 = 0.1;

/// A flight of two minutes.
pub struct Drawn {
    pub seed: u64,
    pub source: SimulatedSource,
    /// Scans a second.
    pub rate_hz: f64,
    /// How many faults it has.
    pub faults: usize,
    /// What it is, in words.
    pub text: String,
}

impl Drawn {
    /// The flight of this seed.
    pub fn new(seed: u64) -> Self {
        let mut n = Noise::new(77_000 + seed);
        // The first draws of neighbouring seeds are alike.
        (0..5).for_each(|_| {
            n.uniform();
        });
        let scene = pick(&mut n, &SCENES);
        let wild = n.uniform() < WILD;
        let rough = 1.0 + n.uniform();
        let bank_deg = 30.0 + 40.0 * n.uniform();
        let rates =
            Random { bank_deg, roll_rate_deg_s: 5.2 * rough, pitch_rate_deg_s: 2.1 * rough, ..Random::default() };
        let style = if wild { Style::Scripted(aerobatics()) } else { Style::Random(rates) };
        let noise_k = 0.05 + 0.1 * n.uniform();
        let rate_hz = pick(&mut n, &[50.0, 50.0, 20.0]);
        let dropped = pick(&mut n, &[0.0, 0.0, 0.05]);
        let faults: Vec<Fault> = (0..pick(&mut n, &FAULTS)).map(|_| fault(&mut n)).collect();
        let texts: Vec<String> = faults.iter().map(ToString::to_string).collect();
        let (sin, cos) = (std::f64::consts::TAU * n.uniform()).sin_cos();
        let wind_m_s = 10.0 * n.uniform();
        let aircraft = Aircraft { wind_m_s: [wind_m_s * cos, wind_m_s * sin], ..Aircraft::default() };
        let scenario = Scenario::named(scene).unwrap_or_else(|| panic!("no scenario {scene}"));
        let scenario = scenario.lasting(1.0).with_noise(noise_k).with_dropped(dropped);
        let trajectory = Trajectory::fly(&aircraft, &style, 121.0, 5000 + seed);
        let pilot = if wild { "loops and rolls".to_owned() } else { format!("banks to {bank_deg:.0}°") };
        Self {
            seed,
            faults: faults.len(),
            source: scenario.source(9000 + seed).with_trajectory(trajectory).with_faults(faults),
            rate_hz,
            text: format!("{scene}, {pilot}, {rate_hz} Hz, {}", texts.join(" ")),
        }
    }
}

fn pick<T: Copy>(n: &mut Noise, of: &[T]) -> T {
    of[((n.uniform() * of.len() as f64) as usize).min(of.len() - 1)]
}

/// Any fault: it begins between 15 and 60 s, and may end.
fn fault(n: &mut Noise) -> Fault {
    let about = pick(n, &Kind::ALL);
    let strength = match about.kind {
        Kind::Wrong => (2.0 + 10.0 * n.uniform()) * if n.uniform() < 0.5 { -1.0 } else { 1.0 },
        Kind::Slow => 0.2 + 3.0 * n.uniform(),
        Kind::Delayed => 0.05 + n.uniform(),
        Kind::Intermittent => 20.0 + 70.0 * n.uniform(),
        Kind::Wet => 50.0 + 50.0 * n.uniform(),
        Kind::Hail => 0.5 + 5.0 * n.uniform(),
        Kind::Fog => 0.1 + 2.0 * n.uniform(),
        Kind::Rain => 20.0 + 60.0 * n.uniform(),
        Kind::Ridge | Kind::Valley | Kind::Cloud => 5.0 + 40.0 * n.uniform(),
        Kind::Off | Kind::Stuck | Kind::Garbage => 0.0,
    };
    let who = match about.target {
        Target::Sensor => Who::Sensor(pick(n, &SENSORS).to_owned()),
        Target::World => Who::World,
        Target::Side if n.uniform() < 0.5 => Who::Left,
        Target::Side => Who::Right,
    };
    let from_s = (15.0 + 45.0 * n.uniform()).round();
    let lasts = n.uniform() >= 0.4;
    let to_s = if lasts { (from_s + 5.0 + 40.0 * n.uniform()).round() } else { f64::INFINITY };
    Fault { kind: about.kind, strength: (10.0 * strength).round() / 10.0, who, from_s, to_s }
}
