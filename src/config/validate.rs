//! From the merged tables to [`Settings`]: every section but the sensors.

use super::endpoint;
use super::findings::Findings;
use super::nearest::nearest;
use super::raw::Table;
use super::section::Section;
use super::sensor::{self, Sensors};
use super::settings::{
    BusAddress, DbusSettings, EstimatorSettings, FaultSettings, FlightName, HeadSettings, LineSettings,
    MavlinkSettings, Method, OnFault, Settings, SimulationSettings, SkyName,
};
use super::source::Place;
use crate::direction::Direction;
use crate::simulation::Fault;
use std::time::Duration;

/// Reads all of `root`; what is wrong goes to `findings`.
pub fn validate<'a>(root: &'a Table, findings: &'a Findings<'a>) -> (Settings, Sensors<'a>) {
    let defaults = Settings::default();
    let mut root = Section::new(findings, root, Place::default(), "", String::new());

    let mut s = root.section("daemon", "[daemon]", "daemon.");
    let rate_hz = s.range("rate-hz", 1.0, 200.0, " Hz").unwrap_or(defaults.rate_hz);
    let quiet = s.range("quiet-ms", 0.0, 20.0, " ms").map_or(defaults.quiet, |ms| Duration::from_secs_f64(ms * 1e-3));
    s.finish();

    let sensors = sensor::read(&mut root, findings);

    let settings = Settings {
        rate_hz,
        quiet,
        sensors: sensors.settings(),
        head: head(root.section("head", "[head]", "head."), defaults.head),
        estimator: estimator(root.section("estimator", "[estimator]", "estimator."), defaults.estimator),
        faults: faults(root.section("faults", "[faults]", "faults."), defaults.faults),
        mavlink: mavlink(root.section("mavlink", "[mavlink]", "mavlink."), defaults.mavlink, findings, rate_hz),
        dbus: dbus(root.section("dbus", "[dbus]", "dbus."), defaults.dbus),
        simulation: simulation(root.section("simulation", "[simulation]", "simulation."), &sensors, findings),
    };
    root.finish();
    (settings, sensors)
}

fn head(mut s: Section<'_>, d: HeadSettings) -> HeadSettings {
    let settings = HeadSettings {
        roll_trim_deg: s.range("roll-trim-deg", -45.0, 45.0, "°").unwrap_or(d.roll_trim_deg),
        pitch_trim_deg: s.range("pitch-trim-deg", -45.0, 45.0, "°").unwrap_or(d.pitch_trim_deg),
        learn_trim: s.boolean("learn-trim").unwrap_or(d.learn_trim),
        field_of_view_deg: s.range("field-of-view-deg", 5.0, 150.0, "°").unwrap_or(d.field_of_view_deg),
        lag_s: s.range("lag-s", 0.0, 5.0, " s").or(d.lag_s),
    };
    s.finish();
    settings
}

fn estimator(mut s: Section<'_>, d: EstimatorSettings) -> EstimatorSettings {
    let settings = EstimatorSettings {
        method: s.choice("method", &Method::NAMED).or(d.method),
        range_time_constant_s: s.range("range-time-constant-s", 0.1, 60.0, " s").unwrap_or(d.range_time_constant_s),
        roll_limit_deg: s
            .number("roll-limit-deg", "0 (no limit) or 10 to 180°", |v| v == 0.0 || (10.0..=180.0).contains(&v))
            .or(d.roll_limit_deg),
    };
    s.finish();
    settings
}

fn faults(mut s: Section<'_>, d: FaultSettings) -> FaultSettings {
    let settings = FaultSettings {
        on_fault: s.choice("on-fault", &OnFault::NAMED).unwrap_or(d.on_fault),
        hold_s: s.range("hold-s", 0.1, 30.0, " s").unwrap_or(d.hold_s),
        sigma_limit_deg: s.range("sigma-limit-deg", 2.0, 90.0, "°").unwrap_or(d.sigma_limit_deg),
        low_contrast_c: s.range("low-contrast-c", 0.2, 20.0, " K").unwrap_or(d.low_contrast_c),
        accuracy_deg: s.range("accuracy-deg", 0.5, 30.0, "°").unwrap_or(d.accuracy_deg),
        wet_percent: s.range("wet-percent", 20.0, 95.0, " %").unwrap_or(d.wet_percent),
        obstructed_deg: s.range("obstructed-deg", 1.0, 45.0, "°").unwrap_or(d.obstructed_deg),
        disagree_deg: s.range("disagree-deg", 2.0, 90.0, "°").unwrap_or(d.disagree_deg),
        stuck_after_s: s.range("stuck-after-s", 0.2, 60.0, " s").unwrap_or(d.stuck_after_s),
        lost_after_s: s.range("lost-after-s", 0.02, 5.0, " s").unwrap_or(d.lost_after_s),
        back_after_s: s.range("back-after-s", 0.02, 5.0, " s").unwrap_or(d.back_after_s),
        stale_after_s: s.range("stale-after-s", 0.05, 10.0, " s").unwrap_or(d.stale_after_s),
        lamp: line(&mut s, "lamp"),
    };
    s.finish();
    settings
}

fn mavlink<'a>(mut s: Section<'a>, d: MavlinkSettings, findings: &Findings<'a>, rate_hz: f64) -> MavlinkSettings {
    let id = |i: i64| u8::try_from(i).ok();
    let settings = MavlinkSettings {
        system_id: s.integer_or_auto("system-id", 1, 255, "1 to 255").and_then(id).or(d.system_id),
        component_id: s.integer("component-id", 1, 255, "1 to 255").and_then(id).unwrap_or(d.component_id),
        autopilot_id: s.integer_or_auto("autopilot-id", 1, 255, "1 to 255").and_then(id).or(d.autopilot_id),
        aiding: s.boolean("aiding").unwrap_or(d.aiding),
        rates_hz: s
            .number("rates-hz", "0 (nothing is asked for) or 1 to 200 Hz", |hz| {
                hz == 0.0 || (1.0..=200.0).contains(&hz)
            })
            .unwrap_or(d.rates_hz),
        yaw: s.boolean("yaw").unwrap_or(d.yaw),
        sys_status: s.boolean("sys-status").unwrap_or(d.sys_status),
        signing_key: s.path("signing-key", "a file of 32 bytes that only its owner may read").or(d.signing_key),
        endpoints: endpoint::read(&mut s, findings, rate_hz),
    };
    s.finish();
    settings
}

fn dbus(mut s: Section<'_>, d: DbusSettings) -> DbusSettings {
    let choices = "\"system\", \"session\", \"none\" or an address such as \"unix:path=/run/…\"";
    let bus = match s.string("bus", choices) {
        None => d.bus,
        Some("system") => Some(BusAddress::System),
        Some("session") => Some(BusAddress::Session),
        Some("none") => None,
        Some(address) if address.parse::<zbus::Address>().is_ok() => Some(BusAddress::Address(address.to_owned())),
        Some(address) if address.contains(':') => {
            s.wrong("bus", &format!("is no address of a bus: expected {choices}"));
            None
        }
        Some(word) => {
            let near = nearest(word, ["system", "session", "none"]);
            let hint = near.map_or(String::new(), |n| format!("; did you mean \"{n}\"?"));
            s.wrong("bus", &format!("is not known{hint} ({choices})"));
            None
        }
    };
    let update_hz = s.range("update-hz", 0.1, 50.0, " Hz").unwrap_or(d.update_hz);
    s.finish();
    DbusSettings { bus, update_hz }
}

fn simulation(mut s: Section<'_>, sensors: &Sensors<'_>, findings: &Findings<'_>) -> Option<SimulationSettings> {
    let d = SimulationSettings::default();
    let enabled = s.boolean("enabled").unwrap_or(false);
    let settings = SimulationSettings {
        flight: s.choice("flight", &FlightName::NAMED).unwrap_or(d.flight),
        sky: s.choice("sky", &SkyName::NAMED).unwrap_or(d.sky),
        noise_c: s.range("noise-c", 0.0, 5.0, " K").unwrap_or(d.noise_c),
        lag_s: s.range("lag-s", 0.0, 5.0, " s").unwrap_or(d.lag_s),
        seed: s.integer("seed", 0, i64::MAX, "0 or more, below 2^63").map_or(d.seed, i64::unsigned_abs),
        faults: flight_faults(&mut s, sensors, findings),
    };
    if !enabled && !settings.faults.is_empty() {
        s.wrong(
            "faults",
            "are for a simulated flight alone and this configuration reads hardware: take them out, or set enabled = \
             true under [simulation]",
        );
    }
    s.finish();
    enabled.then_some(settings)
}

/// `faults = ["wet:nose@10..40", …]`, of the sensors that there are.
fn flight_faults(s: &mut Section<'_>, sensors: &Sensors<'_>, findings: &Findings<'_>) -> Vec<Fault> {
    let named: Vec<&str> = sensors.good.iter().map(|r| r.settings.name.as_str()).collect();
    let names = if named.is_empty() { Direction::NAMED.map(|(name, _)| name).to_vec() } else { named };
    let read = |(place, text): (Place, &str)| match text.parse::<Fault>() {
        // Where a sensor is wrong itself nobody knows which there are.
        Ok(fault) => match fault.check(&names) {
            Err(e) if sensors.complete => Err((place, e)),
            _ => Ok(fault),
        },
        Err(e) => Err((place, e)),
    };
    let mut faults = Vec::new();
    for fault in s.strings("faults", "faults such as \"wet:nose@10..40\"").into_iter().map(read) {
        match fault {
            Ok(fault) => faults.push(fault),
            Err((place, e)) => findings.add(place, format!("simulation.faults: {e}")),
        }
    }
    faults
}

/// A GPIO line `{ chip = …, line = …, active-low = … }`.
pub fn line(s: &mut Section<'_>, key: &'static str) -> Option<LineSettings> {
    let example = "{ chip = \"pinctrl-bcm2711\", line = 17 }";
    let there = s.has(key);
    let mut s = s.section(key, example, &format!("{key}."));
    let chip = s.string("chip", "a GPIO chip's label (see gpiodetect) or /dev/gpiochipN");
    let offset = s.integer("line", 0, 1023, "a line's number on its chip, 0 to 1023");
    let active_low = s.boolean("active-low").unwrap_or(false);
    if there && s.is_table() {
        for (name, expected) in
            [("chip", "the chip's label (see gpiodetect)"), ("line", "the line's number on the chip")]
        {
            if !s.has(name) {
                s.missing(name, expected);
            }
        }
    }
    s.finish();
    Some(LineSettings { chip: chip?.to_owned(), line: u32::try_from(offset?).ok()?, active_low })
}
