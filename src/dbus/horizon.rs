//! `org.irhorizon1.Horizon`: attitude, mode and faults.

use super::info::Control;
use super::live::Live;
use crate::attitude::{Attitude, Hint};
use crate::ctl::view::{Counters, Endpoint};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use zbus::{Variant, interface};

/// The live state, shared by the interfaces and the loop that signals its changes.
pub(super) type SharedLive = Arc<Mutex<Live>>;

/// A short look at the live state.
pub(super) fn lock(live: &SharedLive) -> MutexGuard<'_, Live> {
    live.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The interface's object.
#[derive(Clone)]
pub(super) struct Horizon {
    pub live: SharedLive,
    pub control: Arc<dyn Control>,
}

impl Horizon {
    fn attitude_deg(&self, pick: impl FnOnce(Attitude) -> f64) -> f64 {
        lock(&self.live).snapshot.estimate.attitude.map_or(f64::NAN, |a| pick(a).to_degrees())
    }

    fn sigma_deg(&self, pick: impl FnOnce(Attitude) -> f64) -> f64 {
        let live = lock(&self.live);
        let estimate = &live.snapshot.estimate;
        if estimate.attitude.is_some() { pick(estimate.sigma).to_degrees() } else { f64::NAN }
    }

    /// The trim by which the attitude is: the configured and the learnt.
    fn trim_deg(&self, pick: impl Fn(Attitude) -> f64) -> f64 {
        let configured = lock(&self.live).info.trim;
        pick(configured).to_degrees() + self.learnt_deg(pick)
    }

    fn learnt_deg(&self, pick: impl Fn(Attitude) -> f64) -> f64 {
        pick(lock(&self.live).snapshot.estimate.trim).to_degrees()
    }

    fn hint(&self, pick: impl FnOnce(Hint) -> f64) -> f64 {
        lock(&self.live).snapshot.estimate.hint.map_or(f64::NAN, pick)
    }

    /// The properties whose changes are signalled.
    pub fn signalled(&self) -> [(&'static str, Variant<'static>); 14] {
        [
            ("RollDeg", self.roll_deg().into()),
            ("PitchDeg", self.pitch_deg().into()),
            ("RollSigmaDeg", self.roll_sigma_deg().into()),
            ("PitchSigmaDeg", self.pitch_sigma_deg().into()),
            ("Measured", self.measured().into()),
            ("ContrastC", self.contrast_c().into()),
            ("HintBearingDeg", self.hint_bearing_deg().into()),
            ("HintStrengthC", self.hint_strength_c().into()),
            ("Mode", self.mode().into()),
            ("Faults", self.faults().into()),
            ("FaultDetails", self.fault_details().into()),
            ("Method", self.method().into()),
            ("SampleTimeUsec", self.sample_time_usec().into()),
            ("RateHz", self.rate_hz().into()),
        ]
    }
}

/// The properties are read-only. Angles are in degrees and NaN while attitude is withheld.
/// Changes come as one PropertiesChanged for all properties, `update-hz` times a second at most,
/// and at once when the mode or the faults change.
#[interface(name = "org.irhorizon1.Horizon")]
impl Horizon {
    /// Roll, degrees, right wing down positive.
    #[zbus(property)]
    pub fn roll_deg(&self) -> f64 {
        self.attitude_deg(|a| a.roll)
    }

    /// Pitch, degrees, nose up positive.
    #[zbus(property)]
    pub fn pitch_deg(&self) -> f64 {
        self.attitude_deg(|a| a.pitch)
    }

    /// Standard deviation of roll, degrees.
    #[zbus(property)]
    pub fn roll_sigma_deg(&self) -> f64 {
        self.sigma_deg(|a| a.roll)
    }

    /// Standard deviation of pitch, degrees.
    #[zbus(property)]
    pub fn pitch_sigma_deg(&self) -> f64 {
        self.sigma_deg(|a| a.pitch)
    }

    /// Whether roll and pitch are measured: not while they are withheld, nor while what is held or eased to level stands in.
    #[zbus(property)]
    pub fn measured(&self) -> bool {
        let live = lock(&self.live);
        let estimate = &live.snapshot.estimate;
        estimate.attitude.is_some() && estimate.measured
    }

    /// Ground less zenith as the vertical pair sees it, kelvin; NaN when unknown.
    #[zbus(property)]
    pub fn contrast_c(&self) -> f64 {
        lock(&self.live).snapshot.estimate.contrast_k.unwrap_or(f64::NAN)
    }

    /// Where something warm stands above the horizon, degrees clockwise from the nose, in (-180, 180]; NaN when
    /// there is nothing.
    #[zbus(property)]
    pub fn hint_bearing_deg(&self) -> f64 {
        self.hint(|h| h.bearing.to_degrees())
    }

    /// How much warmer than the opposite side that is, kelvin; NaN when there is nothing.
    #[zbus(property)]
    pub fn hint_strength_c(&self) -> f64 {
        self.hint(|h| h.strength_k)
    }

    /// The roll that the head shows in level flight, as configured and learnt, degrees.
    /// Changes of the trims are not signalled.
    #[zbus(property(emits_changed_signal = "false"))]
    pub fn roll_trim_deg(&self) -> f64 {
        self.trim_deg(|a| a.roll)
    }

    /// The pitch that the head shows in level flight, as configured and learnt, degrees.
    #[zbus(property(emits_changed_signal = "false"))]
    pub fn pitch_trim_deg(&self) -> f64 {
        self.trim_deg(|a| a.pitch)
    }

    /// The part of it that was learnt in flight, degrees.
    #[zbus(property(emits_changed_signal = "false"))]
    pub fn roll_trim_learnt_deg(&self) -> f64 {
        self.learnt_deg(|a| a.roll)
    }

    /// The part of it that was learnt in flight, degrees.
    #[zbus(property(emits_changed_signal = "false"))]
    pub fn pitch_trim_learnt_deg(&self) -> f64 {
        self.learnt_deg(|a| a.pitch)
    }

    /// `starting`, `nominal`, `degraded` or `faulted`.
    #[zbus(property)]
    pub fn mode(&self) -> &'static str {
        lock(&self.live).snapshot.estimate.mode.as_str()
    }

    /// The active faults.
    #[zbus(property)]
    pub fn faults(&self) -> Vec<String> {
        let live = lock(&self.live);
        live.snapshot.estimate.faults.iter().map(|f| f.kind.display(&*live.snapshot.head).to_string()).collect()
    }

    /// The active faults: name, since when (microseconds of CLOCK_BOOTTIME), evidence.
    #[zbus(property)]
    pub fn fault_details(&self) -> Vec<(String, u64, String)> {
        let live = lock(&self.live);
        let one = |f: &crate::fault::ActiveFault| {
            (f.kind.display(&*live.snapshot.head).to_string(), f.since.as_micros(), f.evidence.to_string())
        };
        live.snapshot.estimate.faults.iter().map(one).collect()
    }

    /// The method of estimation.
    #[zbus(property)]
    pub fn method(&self) -> &'static str {
        lock(&self.live).info.method
    }

    /// When the newest measurement was made, microseconds of CLOCK_BOOTTIME; 0 before the first.
    #[zbus(property)]
    pub fn sample_time_usec(&self) -> u64 {
        lock(&self.live).snapshot.estimate.time.as_micros()
    }

    /// Frames a second, measured.
    #[zbus(property)]
    pub fn rate_hz(&self) -> f64 {
        lock(&self.live).snapshot.rate_hz
    }

    /// The daemon's version.
    #[zbus(property(emits_changed_signal = "const"))]
    pub fn version(&self) -> &'static str {
        env!("CARGO_PKG_VERSION")
    }

    /// The autopilot that is listened to, while it is heard: `SystemId`; `RatesHz`, `GpsHz`, `AirspeedHz`, how often its
    /// body rates, fixes and airspeeds come; `LateS`, how old the rates are then; `Used` and `Synced`, 1 for yes;
    /// `RollDifferenceDeg` and `PitchDifferenceDeg`, its attitude less ours. What is not known is left out. Changes
    /// are not signalled.
    #[zbus(property(emits_changed_signal = "false"))]
    pub fn autopilot(&self) -> HashMap<String, f64> {
        let autopilot = lock(&self.live).snapshot.autopilot;
        let Some(system) = autopilot.link.system else { return HashMap::new() };
        let (link, differs) = (autopilot.link, autopilot.differs);
        let said = [
            ("SystemId", Some(f64::from(system))),
            ("RatesHz", Some(link.rates_hz)),
            ("GpsHz", Some(link.gps_hz)),
            ("AirspeedHz", Some(link.airspeed_hz)),
            ("Used", Some(f64::from(autopilot.used))),
            ("Synced", Some(f64::from(link.synced))),
            ("LateS", autopilot.late_s),
            ("RollDifferenceDeg", differs.map(|d| d.roll.to_degrees())),
            ("PitchDifferenceDeg", differs.map(|d| d.pitch.to_degrees())),
        ];
        said.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect()
    }

    /// The MAVLink endpoints: address, named counts since start and how many listen, the last error.
    /// Changes are not signalled.
    #[zbus(property(emits_changed_signal = "false"))]
    pub fn endpoints(&self) -> Vec<(String, Counters, String)> {
        let named = |e: &Endpoint| e.counters().map(|(name, count)| (name.to_owned(), count)).into();
        self.control.endpoints().into_iter().map(|e| (e.address.clone(), named(&e), e.last_error)).collect()
    }
}
