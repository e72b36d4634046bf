//! The state as people read it.

use super::error::{EXIT_FAILED, EXIT_OK, EXIT_WITHHELD};
use super::view::{Autopilot, Endpoint, Hint, Status};
use std::fmt::Write as _;

/// A smaller trim that was learnt is not spoken of, °.
const WORTH_SAYING_DEG: f64 = 0.5;

/// The exit code of `status`: 0 nominal, 1 degraded, 2 withheld.
pub fn exit_code(status: &Status) -> u8 {
    match status.mode.as_str() {
        "nominal" => EXIT_OK,
        "degraded" => EXIT_FAILED,
        _ => EXIT_WITHHELD,
    }
}

/// The state in lines for people.
pub fn plain(s: &Status) -> String {
    let mut t = String::new();
    let mut line = |label: &str, text: &str| {
        let _ = writeln!(t, "{label:<10} {text}");
    };
    line("irhorizond", &format!("{}, method {}", s.version, s.method));
    line("mode", &format!("{}{}", s.mode, if s.stands_in() { "; roll and pitch are shown, not measured" } else { "" }));
    line("roll", &angle(s.roll_deg, s.roll_sigma_deg, ("right", "left")));
    line("pitch", &angle(s.pitch_deg, s.pitch_sigma_deg, ("up", "down")));
    let learnt = s.trim.roll_learnt_deg.abs().max(s.trim.pitch_learnt_deg.abs());
    if learnt >= WORTH_SAYING_DEG {
        // Never "-0.0".
        let [roll, pitch] =
            [s.trim.roll_learnt_deg, s.trim.pitch_learnt_deg].map(|v| if v.abs() < 0.05 { 0.0 } else { v });
        line("trim", &format!("learnt in flight: roll {roll:+.1}°, pitch {pitch:+.1}°; irhorizonctl trim keeps it"));
    }
    line("contrast", &finite(s.contrast_c).map_or_else(|| "not seen yet".into(), |k| format!("{k:.1} K")));
    let age = if s.sample_time_usec == 0 { "none yet".into() } else { format!("{} old", duration(s.sample_age_s)) };
    line("sample", &format!("{age}, {} a second", number(s.rate_hz, 1)));
    if s.faults.is_empty() {
        line("faults", "none");
    }
    let width = s.faults.iter().map(|f| f.name.chars().count()).max().unwrap_or(0);
    for (i, f) in s.faults.iter().enumerate() {
        let label = if i == 0 { "faults" } else { "" };
        line(label, &format!("{:<width$}  for {:<7} {}", f.name, duration(f.for_s), f.evidence));
        if !f.advice.is_empty() {
            line("", &format!("  {}", f.advice));
        }
    }
    if let Some(hint) = s.hint {
        line("hint", &warm(hint));
    }
    let bad: Vec<_> = s.sensors.iter().filter(|x| x.state != "ok").collect();
    line("sensors", &format!("{} of {} ok", s.sensors.len() - bad.len(), s.sensors.len()));
    let width = bad.iter().map(|x| x.name.chars().count()).max().unwrap_or(0);
    for sensor in bad {
        line("", &format!("{:<width$}  {}", sensor.name, sensor.state));
    }
    if let Some(a) = &s.autopilot {
        line("autopilot", &autopilot(a));
    }
    for (i, e) in s.endpoints.iter().enumerate() {
        let label = if i == 0 { "mavlink" } else { "" };
        line(label, &endpoint(e));
    }
    t
}

/// `udpin:0.0.0.0:14550  512 sent, 0 failed, 20 received, 1 listening: what is wrong`; the rest where there is any.
fn endpoint(e: &Endpoint) -> String {
    let mut text = format!("{}  {} sent, {} failed", e.address, e.sent, e.failed);
    for (count, what) in [
        (e.dropped, "dropped"),
        (e.received, "received"),
        (e.bad_crc, "received damaged"),
        (e.tlog_lost, "not in the tlog"),
        (e.peers, "listening"),
    ] {
        if count > 0 {
            let _ = write!(text, ", {count} {what}");
        }
    }
    if !e.last_error.is_empty() {
        let _ = write!(text, ": {}", e.last_error);
    }
    text
}

/// `+12.3° ± 0.8° right`, or that it is withheld.
fn angle(value: Option<f64>, sigma: Option<f64>, (positive, negative): (&str, &str)) -> String {
    let Some(v) = finite(value) else { return "withheld".to_owned() };
    let side = match () {
        () if v >= 0.05 => positive,
        () if v <= -0.05 => negative,
        () => "level",
    };
    // Never "-0.0".
    let v = if v.abs() < 0.05 { 0.0 } else { v };
    let sigma = finite(sigma).map_or_else(|| "?".into(), |s| format!("{s:.1}°"));
    format!("{v:>+6.1}° ± {sigma}  {side}")
}

/// `3.2 K warmer on the right (90°)`.
fn warm(hint: Hint) -> String {
    let sides = ["ahead", "ahead to the right", "on the right", "behind to the right", "behind"];
    let left = ["", "ahead to the left", "on the left", "behind to the left", ""];
    let eighth = (hint.bearing_deg.abs() / 45.0).round().clamp(0.0, 4.0) as usize;
    let side = if hint.bearing_deg < 0.0 && !left[eighth].is_empty() { left[eighth] } else { sides[eighth] };
    format!("{} K warmer {side} ({}°)", number(hint.strength_c, 1), number(hint.bearing_deg, 0))
}

/// `system 1, rates 49 Hz, 38 ms late, GPS 5 Hz; differs by 0.8° roll, 0.3° pitch`.
fn autopilot(a: &Autopilot) -> String {
    let mut t = format!("system {}", a.system_id);
    match finite(a.late_s) {
        Some(late_s) => {
            let _ = write!(t, ", rates {} Hz, {} late", number(a.rates_hz, 0), duration(late_s));
            t.push_str(if a.used { "" } else { " and not used" });
        }
        None => t.push_str(", no rates"),
    }
    for (what, hz) in [("GPS", a.gps_hz), ("airspeed", a.airspeed_hz)] {
        // Less often than every other second is hardly at all.
        if hz > 0.5 {
            let _ = write!(t, ", {what} {} Hz", number(hz, 0));
        }
    }
    if !a.synced {
        t.push_str(", no TIMESYNC");
    }
    if let (Some(roll), Some(pitch)) = (finite(a.roll_difference_deg), finite(a.pitch_difference_deg)) {
        let _ = write!(t, "; differs by {:.1}° roll, {:.1}° pitch", roll.abs(), pitch.abs());
    }
    t
}

/// A value that is one.
pub fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|v| v.is_finite())
}

/// A number, or a question mark.
pub fn number(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "?".to_owned() }
}

/// A time span in the unit that suits it.
pub fn duration(seconds: f64) -> String {
    let s = seconds.max(0.0);
    match s {
        _ if !seconds.is_finite() => "?".to_owned(),
        ..0.9995 => format!("{:.0} ms", s * 1e3),
        ..99.95 => format!("{s:.1} s"),
        ..5_970.0 => format!("{:.0} min", s / 60.0),
        ..356_400.0 => format!("{:.1} h", s / 3_600.0),
        _ => format!("{:.1} d", s / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_take_the_unit_that_suits() {
        for (s, text) in [
            (0.0124, "12 ms"),
            (0.99951, "1.0 s"),
            (59.0, "59.0 s"),
            (600.0, "10 min"),
            (7_200.0, "2.0 h"),
            (864_000.0, "10.0 d"),
            (-1.0, "0 ms"),
            (f64::NAN, "?"),
            (f64::INFINITY, "?"),
        ] {
            assert_eq!(duration(s), text);
        }
    }

    #[test]
    fn the_autopilot_in_a_line() {
        let mut a = Autopilot {
            system_id: 1,
            rates_hz: 49.2,
            late_s: Some(0.0381),
            used: true,
            synced: true,
            gps_hz: 4.9,
            airspeed_hz: 0.0,
            roll_difference_deg: Some(-0.83),
            pitch_difference_deg: Some(0.3),
        };
        let line = "system 1, rates 49 Hz, 38 ms late, GPS 5 Hz; differs by 0.8° roll, 0.3° pitch";
        assert_eq!(autopilot(&a), line);
        (a.used, a.synced, a.late_s, a.roll_difference_deg) = (false, false, Some(0.3), None);
        assert_eq!(autopilot(&a), "system 1, rates 49 Hz, 300 ms late and not used, GPS 5 Hz, no TIMESYNC");
        assert_eq!(autopilot(&Autopilot { synced: true, ..Autopilot::default() }), "system 0, no rates");
    }

    #[test]
    fn angles_say_their_side_and_are_never_minus_nothing() {
        let sides = ("right", "left");
        assert_eq!(angle(Some(-12.34), Some(0.8), sides), " -12.3° ± 0.8°  left");
        assert_eq!(angle(Some(-0.01), None, sides), "  +0.0° ± ?  level");
        assert_eq!(angle(Some(f64::NAN), None, sides), "withheld");
    }
}
