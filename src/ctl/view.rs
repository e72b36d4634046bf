//! What the daemon says, as a client sees it. `status --format json` prints this.

use serde::Serialize;

/// The daemon's state at one moment.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Status {
    /// The daemon's version.
    pub version: String,
    /// The method of estimation.
    pub method: String,
    /// `starting`, `nominal`, `degraded` or `faulted`.
    pub mode: String,
    /// Roll, °, right wing down positive; `None` while withheld.
    pub roll_deg: Option<f64>,
    /// Pitch, °, nose up positive; `None` while withheld.
    pub pitch_deg: Option<f64>,
    /// Standard deviation of roll, °.
    pub roll_sigma_deg: Option<f64>,
    /// Standard deviation of pitch, °.
    pub pitch_sigma_deg: Option<f64>,
    /// Whether roll and pitch are measured: not while withheld, nor while something stands in for them.
    pub measured: bool,
    /// The head's trim.
    pub trim: Trim,
    /// Ground less zenith as the vertical pair sees it, K.
    pub contrast_c: Option<f64>,
    /// Something warm above the horizon to one side.
    pub hint: Option<Hint>,
    /// The stamp of the newest measurement, µs of `CLOCK_BOOTTIME`.
    pub sample_time_usec: u64,
    /// Its age when the client looked, s.
    pub sample_age_s: f64,
    /// Frames a second.
    pub rate_hz: f64,
    /// The active faults.
    pub faults: Vec<Fault>,
    /// The sensors, in the configuration's order.
    pub sensors: Vec<Sensor>,
    /// The autopilot that is listened to, while it is heard.
    pub autopilot: Option<Autopilot>,
    /// The MAVLink endpoints.
    pub endpoints: Vec<Endpoint>,
}

impl Status {
    /// Whether what is shown stands in for an attitude that is withheld.
    pub fn stands_in(&self) -> bool {
        !self.measured && self.roll_deg.is_some_and(f64::is_finite)
    }
}

/// What the head shows in level flight, taken off the attitude.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Trim {
    /// Of roll, configured and learnt, °.
    pub roll_deg: f64,
    /// Of pitch, configured and learnt, °.
    pub pitch_deg: f64,
    /// The part of the roll's that was learnt in flight, °.
    pub roll_learnt_deg: f64,
    /// The part of the pitch's that was learnt in flight, °.
    pub pitch_learnt_deg: f64,
}

/// Something warm above the horizon to one side: a ridge, a cloud bank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Hint {
    /// Where, ° clockwise from the nose, in (−180, 180].
    pub bearing_deg: f64,
    /// How much warmer than the opposite side, K.
    pub strength_c: f64,
}

/// An active fault.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Fault {
    /// Its name: `sensor-lost:nose`.
    pub name: String,
    /// For how long it has been there when the client looked, s.
    pub for_s: f64,
    /// What speaks for it, in words and numbers.
    pub evidence: String,
    /// What to do about it; empty for a fault that this program does not know.
    pub advice: &'static str,
}

/// A sensor.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Sensor {
    /// Its name.
    pub name: String,
    /// `mlx90614` or `ads1115`, or `simulated`.
    pub kind: String,
    /// The bus it is read from, empty when simulated.
    pub bus: String,
    /// Its address there.
    pub address: u8,
    /// Where it looks.
    pub direction: String,
    /// `ok`, or why there is no measurement now.
    pub state: String,
    /// What it looks at, °C.
    pub object_c: Option<f64>,
    /// Its own die, °C.
    pub ambient_c: Option<f64>,
    /// The pair's voltage, V.
    pub volts: Option<f64>,
    /// What it shows beyond what attitude and sky explain, K.
    pub residual_c: Option<f64>,
    /// How its words are checked: `pec`, `software-pec`, `unchecked: …`.
    pub integrity: String,
    /// Its settling time, s; 0 when unknown.
    pub settling_s: f64,
    /// Emissivity set in it.
    pub emissivity: Option<f64>,
    /// Its identity, hexadecimal, empty when unknown.
    pub identity: String,
    /// Named counts since start: `reads`, `retries`, `no-answer`, `bad-pec`, …
    pub counters: Counters,
}

/// The autopilot that is listened to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Autopilot {
    /// Its system id.
    pub system_id: u8,
    /// Body rates a second.
    pub rates_hz: f64,
    /// How old they are when they arrive, s; `None` while there are none.
    pub late_s: Option<f64>,
    /// Whether they aid the attitude.
    pub used: bool,
    /// Whether its clock is known by TIMESYNC, and not only by when its messages arrive.
    pub synced: bool,
    /// Fixes a second.
    pub gps_hz: f64,
    /// Airspeeds a second.
    pub airspeed_hz: f64,
    /// Its roll less ours, over the last second or so, °.
    pub roll_difference_deg: Option<f64>,
    /// Its pitch less ours, °.
    pub pitch_difference_deg: Option<f64>,
}

/// Counts by name, as on D-Bus.
pub type Counters = Vec<(String, u64)>;

/// A MAVLink endpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Endpoint {
    /// As configured.
    pub address: String,
    /// Messages sent since start.
    pub sent: u64,
    /// Messages that could not be sent.
    pub failed: u64,
    /// Messages dropped for newer ones, as the other side takes them too slowly.
    pub dropped: u64,
    /// Good messages that came in.
    pub received: u64,
    /// Bytes that came in and were no message of the dialect.
    pub skipped_bytes: u64,
    /// Messages that came in damaged.
    pub bad_crc: u64,
    /// How many may be there to listen now.
    pub peers: u64,
    /// Messages that did not get into the tlog.
    pub tlog_lost: u64,
    /// Why the last one failed; empty when it did not.
    pub last_error: String,
}

impl Endpoint {
    /// Its numbers by name, as on D-Bus.
    pub fn counters(&self) -> [(&'static str, u64); 8] {
        [
            ("sent", self.sent),
            ("failed", self.failed),
            ("dropped", self.dropped),
            ("received", self.received),
            ("skipped-bytes", self.skipped_bytes),
            ("bad-crc", self.bad_crc),
            ("peers", self.peers),
            ("tlog-lost", self.tlog_lost),
        ]
    }

    /// Out of its numbers by name: one that is not named is 0.
    pub fn from_counters(address: String, counters: &[(String, u64)], last_error: String) -> Self {
        let of = |name: &str| counters.iter().find(|(n, _)| n == name).map_or(0, |(_, count)| *count);
        Self {
            address,
            sent: of("sent"),
            failed: of("failed"),
            dropped: of("dropped"),
            received: of("received"),
            skipped_bytes: of("skipped-bytes"),
            bad_crc: of("bad-crc"),
            peers: of("peers"),
            tlog_lost: of("tlog-lost"),
            last_error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_endpoint_comes_back_from_its_counters() {
        let names = Endpoint::default().counters().map(|(name, _)| name);
        let counters: Vec<(String, u64)> = names.iter().zip(1..).map(|(n, count)| ((*n).to_owned(), count)).collect();
        let endpoint = Endpoint::from_counters("udpout:…".into(), &counters, "why".into());
        let back: Vec<u64> = endpoint.counters().iter().map(|(_, count)| *count).collect();
        assert_eq!(back, (1..=8).collect::<Vec<u64>>());
        assert_eq!(Endpoint::from_counters("a".into(), &[], String::new()).sent, 0);
    }
}
