//! The events, with what is asked of each.

use irhorizon::head::Head;

/// Seconds into the flight when it begins.
pub const BEGINS_S: f64 = 20.0;
/// Flights of each event: four under each sky, each sensor in four.
pub const FLIGHTS: u64 = 24;

/// From when the time counts until it is seen.
#[derive(Clone, Copy, Debug)]
pub enum Due {
    /// So many seconds after it began.
    After(f64),
    /// The bank has moved by 10° since it began.
    Manoeuvre,
}

/// Something that goes wrong, and what is asked. `{}` in a text is the sensor or the side that it befalls.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    /// What happens.
    pub name: &'static str,
    /// The fault as the simulator has it, without its time.
    pub fault: &'static str,
    /// The contrast before, if it is not the sky's own, K.
    pub contrast_k: Option<f64>,
    /// What is to be said, one of these; each may end in `*`.
    pub right: &'static [&'static str],
    /// What may rightly be said besides.
    pub besides: &'static [&'static str],
    /// From when the time counts.
    pub due: Due,
    /// Within which time it is to be seen, s.
    pub within_s: f64,
    /// How far off attitudes may be, °, without aiding and with it.
    pub error_deg: [Option<f64>; 2],
    /// The share of errors that twice the standard deviation is to cover without aiding, %.
    pub covered_percent: Option<f64>,
    /// Whether the attitude is to be withheld.
    pub withheld: bool,
    /// How long the flight lasts, s.
    pub seconds: f64,
}

const PLAIN: Event = Event {
    name: "",
    fault: "",
    contrast_k: None,
    right: &[],
    besides: &[],
    due: Due::After(0.0),
    within_s: 0.0,
    error_deg: [None; 2],
    covered_percent: None,
    withheld: false,
    seconds: 50.0,
};

/// Ground colder than the sky: from 5 K to −2 K in 2 s the contrast is zero after 2 · 5 / 7 s.
pub const HAIL: Event = Event {
    name: "hail: 5 K to −2 K in 2 s",
    fault: "hail=2",
    contrast_k: Some(5.0),
    right: &["inverted-contrast"],
    // It goes through nothing on its way.
    besides: &["low-contrast"],
    due: Due::After(2.0 * 5.0 / 7.0),
    within_s: 2.0,
    error_deg: [Some(10.0); 2],
    withheld: true,
    seconds: 35.0,
    ..PLAIN
};

/// From 20 K to 0.3 K in 2 s there are 2 K after 2 · 18 / 19.7 s.
pub const FOG: Event = Event {
    name: "fog: 20 K to 0.3 K in 2 s",
    fault: "fog=0.3",
    contrast_k: Some(20.0),
    right: &["low-contrast"],
    due: Due::After(2.0 * 18.0 / 19.7),
    within_s: 2.0,
    withheld: true,
    seconds: 35.0,
    ..PLAIN
};

/// A film of water on one sensor.
pub const WET: Event = Event {
    name: "film on one sensor, 92 % in 3 s",
    fault: "wet=92:{}",
    right: &["wet-sensor:{}"],
    due: Due::After(3.0),
    within_s: 5.0,
    error_deg: [Some(3.0); 2],
    ..PLAIN
};

/// The same on all of them.
pub const WET_ALL: Event = Event {
    name: "film on all sensors, 92 % in 3 s",
    fault: "wet=92:all",
    // Which is what it looks like from inside.
    right: &["wet-sensor:*", "low-contrast"],
    due: Due::After(3.0),
    within_s: 5.0,
    withheld: true,
    seconds: 40.0,
    ..PLAIN
};

/// A sensor that repeats itself in a flight that turns.
pub const STUCK: Event = Event {
    name: "stuck sensor",
    fault: "stuck:{}",
    right: &["sensor-stuck:{}"],
    due: Due::Manoeuvre,
    within_s: 10.0,
    error_deg: [Some(3.0); 2],
    ..PLAIN
};

/// A sensor that does not answer.
pub const LOST: Event = Event {
    name: "lost sensor",
    fault: "off:{}",
    right: &["sensor-lost:{}"],
    due: Due::After(0.0),
    within_s: 0.2,
    error_deg: [Some(2.0); 2],
    ..PLAIN
};

/// A ridge beside the flight.
pub const RIDGE: Event = Event {
    name: "ridge of 25° on one side, in 3 s",
    fault: "ridge=25:{side}",
    right: &["obstructed"],
    // Which they do.
    besides: &["roll-disagrees", "pitch-disagrees"],
    due: Due::After(3.0),
    within_s: 5.0,
    error_deg: [None, Some(5.0)],
    covered_percent: Some(95.0),
    ..PLAIN
};

/// A valley.
pub const VALLEY: Event = Event { name: "valley of 35°, in 3 s", fault: "valley=35:{side}", ..RIDGE };

/// Whom it befalls in the flight of `seed`: a sensor.
pub fn sensor(seed: u64) -> String {
    let sensors = Head::six().sensors;
    let i = (seed + seed / sensors.len() as u64) as usize % sensors.len();
    sensors[i].name.clone()
}

/// On which side in the flight of `seed`.
pub fn side(seed: u64) -> &'static str {
    if (seed + seed / 6).is_multiple_of(2) { "left" } else { "right" }
}

impl Event {
    /// Whether it is rightly called so in the flight of `seed`.
    pub fn is_right(&self, name: &str, seed: u64) -> bool {
        self.right.iter().any(|right| is(name, &Self::fill(right, seed)))
    }

    /// Whether that may be said besides.
    pub fn may_be_said(&self, name: &str) -> bool {
        self.besides.iter().any(|besides| is(name, besides))
    }

    /// A text with the sensor or the side of `seed` filled in.
    pub fn fill(text: &str, seed: u64) -> String {
        text.replace("{side}", side(seed)).replace("{}", &sensor(seed))
    }
}

/// Whether a name is as asked, which may end in `*`.
fn is(name: &str, asked: &str) -> bool {
    asked.strip_suffix('*').map_or(name == asked, |begin| name.starts_with(begin))
}
