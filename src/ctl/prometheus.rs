//! The state as Prometheus text exposition, version 0.0.4: base units, a HELP and a TYPE for each
//! metric. Angles are NaN while withheld, as on D-Bus: the series goes on and no value is made up.

use super::view::{Endpoint, Status};
use std::fmt::Write as _;

/// The state in lines for a scrape; `None`: no daemon answers.
pub fn exposition(status: Option<&Status>) -> String {
    let mut t = Text::default();
    t.metric("up", "gauge", "Whether the daemon answers.");
    t.sample("up", &[], if status.is_some() { 1.0 } else { 0.0 });
    let Some(s) = status else { return t.0 };
    t.metric("info", "gauge", "Version and method of estimation, always 1.");
    t.sample("info", &[("version", &s.version), ("method", &s.method)], 1.0);
    for (name, help, value) in [
        ("roll_degrees", "Roll, right wing down positive; NaN while withheld.", s.roll_deg),
        ("pitch_degrees", "Pitch, nose up positive; NaN while withheld.", s.pitch_deg),
        ("roll_sigma_degrees", "Standard deviation of roll.", s.roll_sigma_deg),
        ("pitch_sigma_degrees", "Standard deviation of pitch.", s.pitch_sigma_deg),
        (
            "measured",
            "Whether roll and pitch are measured, and do not stand in for what is withheld.",
            Some(f64::from(s.measured)),
        ),
        ("contrast_kelvin", "Ground less zenith as the vertical pair sees it.", s.contrast_c),
        (
            "hint_bearing_degrees",
            "Where something warm stands above the horizon, clockwise from the nose; NaN when nothing does.",
            s.hint.map(|h| h.bearing_deg),
        ),
        ("hint_strength_kelvin", "How much warmer than the opposite side that is.", s.hint.map(|h| h.strength_c)),
        ("sample_age_seconds", "Age of the newest measurement.", Some(s.sample_age_s)),
        ("rate_hertz", "Frames a second.", Some(s.rate_hz)),
    ] {
        t.metric(name, "gauge", help);
        t.sample(name, &[], value.unwrap_or(f64::NAN));
    }
    t.metric("mode", "gauge", "1 for the mode the daemon is in.");
    for mode in ["starting", "nominal", "degraded", "faulted"] {
        t.sample("mode", &[("mode", mode)], f64::from(s.mode == mode));
    }
    t.metric("faults", "gauge", "Active faults.");
    t.sample("faults", &[], s.faults.len() as f64);
    if !s.faults.is_empty() {
        t.metric("fault", "gauge", "1 for each active fault.");
        for f in &s.faults {
            t.sample("fault", &[("name", &f.name)], 1.0);
        }
        t.metric("fault_seconds", "gauge", "For how long each active fault has been there.");
        for f in &s.faults {
            t.sample("fault_seconds", &[("fault", &f.name)], f.for_s);
        }
    }
    sensors(&mut t, s);
    autopilot(&mut t, s);
    endpoints(&mut t, s);
    t.0
}

fn sensors(t: &mut Text, s: &Status) {
    if s.sensors.is_empty() {
        return;
    }
    t.metric("sensor_ok", "gauge", "Whether the sensor gives a measurement.");
    for x in &s.sensors {
        t.sample("sensor_ok", &[("sensor", &x.name)], f64::from(x.state == "ok"));
    }
    for (name, help) in [
        ("sensor_object_celsius", "What the sensor looks at."),
        ("sensor_ambient_celsius", "The sensor's own die."),
        ("sensor_volts", "The pair's voltage."),
        ("sensor_residual_kelvin", "What the sensor shows beyond what attitude and sky explain."),
    ] {
        let values: Vec<_> = s
            .sensors
            .iter()
            .filter_map(|x| {
                let value = match name {
                    "sensor_object_celsius" => x.object_c,
                    "sensor_ambient_celsius" => x.ambient_c,
                    "sensor_residual_kelvin" => x.residual_c,
                    _ => x.volts,
                };
                Some((x, value?))
            })
            .collect();
        if !values.is_empty() {
            t.metric(name, "gauge", help);
        }
        for (x, value) in values {
            t.sample(name, &[("sensor", &x.name)], value);
        }
    }
    if s.sensors.iter().any(|x| !x.counters.is_empty()) {
        t.metric("sensor_events_total", "counter", "What the sensor's reads came to, since start.");
        for x in &s.sensors {
            for (event, n) in &x.counters {
                t.sample("sensor_events_total", &[("sensor", &x.name), ("event", event)], *n as f64);
            }
        }
    }
}

fn autopilot(t: &mut Text, s: &Status) {
    let Some(a) = &s.autopilot else { return };
    let id = a.system_id.to_string();
    for (name, help, value) in [
        ("autopilot_rates_hertz", "Body rates a second that the autopilot sends.", a.rates_hz),
        ("autopilot_rates_late_seconds", "How old they are when they arrive.", a.late_s.unwrap_or(f64::NAN)),
        ("autopilot_rates_used", "Whether they aid the attitude.", f64::from(a.used)),
        ("autopilot_synced", "Whether the autopilot answers TIMESYNC.", f64::from(a.synced)),
        ("autopilot_gps_hertz", "Fixes a second that the autopilot sends.", a.gps_hz),
        ("autopilot_airspeed_hertz", "Airspeeds a second that the autopilot sends.", a.airspeed_hz),
        (
            "autopilot_roll_difference_degrees",
            "The autopilot's roll less ours.",
            a.roll_difference_deg.unwrap_or(f64::NAN),
        ),
        (
            "autopilot_pitch_difference_degrees",
            "The autopilot's pitch less ours.",
            a.pitch_difference_deg.unwrap_or(f64::NAN),
        ),
    ] {
        t.metric(name, "gauge", help);
        t.sample(name, &[("system", &id)], value);
    }
}

fn endpoints(t: &mut Text, s: &Status) {
    if s.endpoints.is_empty() {
        return;
    }
    for (name, kind, help, value) in [
        ("mavlink_sent_total", "counter", "MAVLink messages sent.", (|e| e.sent) as fn(&Endpoint) -> u64),
        ("mavlink_failed_total", "counter", "MAVLink messages that could not be sent.", |e| e.failed),
        ("mavlink_dropped_total", "counter", "MAVLink messages dropped for newer ones.", |e| e.dropped),
        ("mavlink_received_total", "counter", "Good MAVLink messages that came in.", |e| e.received),
        ("mavlink_skipped_bytes_total", "counter", "Bytes that were no message of the dialect.", |e| e.skipped_bytes),
        ("mavlink_bad_crc_total", "counter", "MAVLink messages that came in damaged.", |e| e.bad_crc),
        ("mavlink_tlog_lost_total", "counter", "MAVLink messages that did not get into the tlog.", |e| e.tlog_lost),
        ("mavlink_peers", "gauge", "How many may be there to listen.", |e| e.peers),
    ] {
        t.metric(name, kind, help);
        for e in &s.endpoints {
            t.sample(name, &[("endpoint", &e.address)], value(e) as f64);
        }
    }
}

#[derive(Default)]
struct Text(String);

impl Text {
    fn metric(&mut self, name: &str, kind: &str, help: &str) {
        let _ = write!(self.0, "# HELP irhorizon_{name} {help}\n# TYPE irhorizon_{name} {kind}\n");
    }

    fn sample(&mut self, name: &str, labels: &[(&str, &str)], value: f64) {
        let _ = write!(self.0, "irhorizon_{name}");
        for (i, (label, text)) in labels.iter().enumerate() {
            let text = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
            let _ = write!(self.0, "{}{label}=\"{text}\"", if i == 0 { '{' } else { ',' });
        }
        let end = if labels.is_empty() { "" } else { "}" };
        let _ = match value {
            _ if value.is_nan() => writeln!(self.0, "{end} NaN"),
            _ if value.is_infinite() => writeln!(self.0, "{end} {}Inf", if value > 0.0 { '+' } else { '-' }),
            _ => writeln!(self.0, "{end} {value}"),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ctl::view::Fault;

    #[test]
    fn labels_are_escaped_and_an_absent_daemon_is_a_sample() {
        let faults = vec![Fault { name: "bus-down:a\"\\\n".into(), ..Fault::default() }];
        let text = exposition(Some(&Status { faults, ..Status::default() }));
        assert!(text.contains(r#"irhorizon_fault_seconds{fault="bus-down:a\"\\\n"} 0"#), "{text}");
        assert!(text.contains("irhorizon_roll_degrees NaN\n"));
        assert!(exposition(None).ends_with("irhorizon_up 0\n"));
    }
}
