//! Settings written out as TOML, every default included: reading it gives the same settings.
//!
//! A default that hangs on other settings, or on the sensors, is written as a comment, so that it goes
//! with them when they change.

use super::settings::{
    AdcInput, Ads1115Settings, BusAddress, DeviceSettings, FlightName, HeadSettings, LineSettings, Method,
    Mlx90614Settings, PecPolicy, SensorSettings, Settings, SkyName,
};
use crate::direction::Direction;
use std::fmt::{Display, Write};
use std::path::Path;

/// The settings as TOML.
pub fn show(settings: &Settings) -> String {
    let mut out = Out(String::new());
    let Settings { rate_hz, quiet, sensors, head, estimator, faults, mavlink, dbus, simulation } = settings;
    out.header("[daemon]");
    out.set("rate-hz", rate_hz);
    out.set("quiet-ms", rounded(quiet.as_secs_f64() * 1e3));
    for s in sensors {
        sensor(&mut out, s);
    }
    out.header("[head]");
    out.set("roll-trim-deg", head.roll_trim_deg);
    out.set("pitch-trim-deg", head.pitch_trim_deg);
    out.set("learn-trim", head.learn_trim);
    out.set("field-of-view-deg", head.field_of_view_deg);
    out.set_or("lag-s", head.lag_s, HeadSettings::UNSAID_LAG_S);
    out.header("[estimator]");
    let (method, usual) = (settings.method(), Method::usual(&settings.head()));
    out.set_or("method", estimator.method.map(|m| string(m.as_str())), string(usual.as_str()));
    out.set("range-time-constant-s", estimator.range_time_constant_s);
    out.set_or("roll-limit-deg", estimator.roll_limit_deg, method.usual_roll_limit_deg());
    out.header("[faults]");
    out.set("on-fault", string(faults.on_fault.as_str()));
    out.set("hold-s", faults.hold_s);
    out.set("sigma-limit-deg", faults.sigma_limit_deg);
    out.set("low-contrast-c", faults.low_contrast_c);
    out.set("accuracy-deg", faults.accuracy_deg);
    out.set("wet-percent", faults.wet_percent);
    out.set("obstructed-deg", faults.obstructed_deg);
    out.set("disagree-deg", faults.disagree_deg);
    out.set("stuck-after-s", faults.stuck_after_s);
    out.set("lost-after-s", faults.lost_after_s);
    out.set("back-after-s", faults.back_after_s);
    out.set("stale-after-s", faults.stale_after_s);
    out.line("lamp", faults.lamp.as_ref());
    out.header("[mavlink]");
    out.set("system-id", id(mavlink.system_id));
    out.set("component-id", mavlink.component_id);
    out.set("autopilot-id", id(mavlink.autopilot_id));
    out.set("aiding", mavlink.aiding);
    out.set("rates-hz", mavlink.rates_hz);
    out.set("yaw", mavlink.yaw);
    out.set("sys-status", mavlink.sys_status);
    out.path("signing-key", mavlink.signing_key.as_deref());
    for e in &mavlink.endpoints {
        out.header("[[mavlink.endpoint]]");
        out.set("address", string(&e.address.to_string()));
        if let Some(hz) = e.streams.attitude_hz {
            out.set("attitude-hz", hz);
        }
        out.set("quaternion-hz", e.streams.quaternion_hz);
        out.set("covariance-hz", e.streams.covariance_hz);
        out.set("values-hz", e.streams.values_hz);
        out.set("texts", e.streams.texts);
        out.path("tlog", e.tlog.as_deref());
    }
    out.header("[dbus]");
    out.set(
        "bus",
        string(match &dbus.bus {
            None => "none",
            Some(BusAddress::System) => "system",
            Some(BusAddress::Session) => "session",
            Some(BusAddress::Address(a)) => a,
        }),
    );
    out.set("update-hz", dbus.update_hz);
    out.header("[simulation]");
    out.set("enabled", simulation.is_some());
    if let Some(s) = simulation {
        out.set("flight", string(named(&FlightName::NAMED, s.flight)));
        out.set("sky", string(named(&SkyName::NAMED, s.sky)));
        out.set("noise-c", s.noise_c);
        out.set("lag-s", s.lag_s);
        out.set("seed", s.seed);
        let faults: Vec<String> = s.faults.iter().map(|f| string(&f.to_string())).collect();
        out.set("faults", format_args!("[{}]", faults.join(", ")));
    }
    out.0
}

fn sensor(out: &mut Out, s: &SensorSettings) {
    out.header("[[sensor]]");
    out.set("name", string(&s.name));
    match &s.device {
        DeviceSettings::Mlx90614(Mlx90614Settings { bus, address, object, pec, offset_c }) => {
            out.set("kind", string("mlx90614"));
            out.set("bus", string(&bus.to_string_lossy()));
            out.set("address", format_args!("{address:#04x}"));
            out.set("object", object);
            let policy = match pec {
                PecPolicy::Auto => "auto",
                PecPolicy::Required => "required",
                PecPolicy::Off => "off",
            };
            out.set("pec", string(policy));
            out.set("offset-c", offset_c);
        }
        DeviceSettings::Ads1115(a) => {
            let Ads1115Settings { bus, address, input, gain_v, data_rate_sps, .. } = a;
            out.set("kind", string("ads1115"));
            out.set("bus", string(&bus.to_string_lossy()));
            out.set("address", format_args!("{address:#04x}"));
            out.set("input", string(named(&AdcInput::NAMED, *input)));
            out.set("gain-v", gain_v);
            out.set("data-rate-sps", data_rate_sps);
            out.set("mode", string(if a.continuous { "continuous" } else { "single-shot" }));
            out.set("neutral-v", a.neutral_v);
            out.set("kelvin-per-v", a.kelvin_per_v);
            out.line("data-ready", a.data_ready.as_ref());
        }
    }
    match Direction::NAMED.iter().find(|(_, d)| *d == s.direction) {
        Some((name, _)) => out.set("direction", string(name)),
        None => {
            let [nose, left, up] = s.direction.components();
            let azimuth = rounded((-left).atan2(nose).to_degrees());
            let elevation = rounded(up.clamp(-1.0, 1.0).asin().to_degrees());
            out.set("direction", format_args!("{{ azimuth-deg = {azimuth}, elevation-deg = {elevation} }}"));
        }
    }
    out.line("power", s.power.as_ref());
}

struct Out(String);

impl Out {
    fn header(&mut self, header: &str) {
        self.0.push_str(header);
        self.0.push('\n');
    }

    fn set(&mut self, key: &str, value: impl Display) {
        // Writing to a String does not fail.
        let _ = writeln!(self.0, "{key} = {value}");
    }

    /// What was chosen, or as a comment what holds unsaid.
    fn set_or<T: Display>(&mut self, key: &str, chosen: Option<T>, unsaid: T) {
        match chosen {
            Some(value) => self.set(key, value),
            None => self.set(&format!("#{key}"), unsaid),
        }
    }

    fn path(&mut self, key: &str, path: Option<&Path>) {
        path.into_iter().for_each(|p| self.set(key, string(&p.to_string_lossy())));
    }

    fn line(&mut self, key: &str, line: Option<&LineSettings>) {
        if let Some(LineSettings { chip, line, active_low }) = line {
            let chip = string(chip);
            self.set(key, format_args!("{{ chip = {chip}, line = {line}, active-low = {active_low} }}"));
        }
    }
}

/// A system's id as the configuration spells it.
fn id(id: Option<u8>) -> String {
    id.map_or_else(|| string("auto"), |id| id.to_string())
}

/// A basic TOML string; control characters do not pass validation.
fn string(s: &str) -> String {
    format!("\"{}\"", s.replace('\\', "\\\\").replace('"', "\\\""))
}

/// To a millionth: finer than any setting means, and without the last digits of a conversion.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

fn named<T: PartialEq>(names: &[(&'static str, T)], value: T) -> &'static str {
    names.iter().find(|(_, v)| *v == value).map_or("", |(n, _)| n)
}
