//! What an estimate is in MAVLink's terms (common.xml). Pure.

use super::session::Seen;
use crate::attitude::{Attitude, Mode};
use crate::fault::{Evidence, FaultKind, FaultName};
use crate::time::Time;
use ::mavlink::dialects::common::{
    ATTITUDE_DATA, HEARTBEAT_DATA, MavAutopilot, MavModeFlag, MavSeverity, MavState, MavSysStatusSensor, MavType,
    NAMED_VALUE_FLOAT_DATA, STATUSTEXT_DATA, SYS_STATUS_DATA,
};
use std::fmt::{self, Write};

/// Bytes of text that one STATUSTEXT holds.
const TEXT_LEN: usize = 50;

/// The standard deviation at which the quality is one half, °.
const HALF_QUALITY_SIGMA_DEG: f64 = 5.0;

/// The best quality of a degraded attitude.
const DEGRADED_QUALITY: f64 = 0.5;

/// A message that this component sends.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// HEARTBEAT (0).
    Heartbeat(HEARTBEAT_DATA),
    /// SYS_STATUS (1).
    Status(SYS_STATUS_DATA),
    /// ATTITUDE (30).
    Attitude(ATTITUDE_DATA),
    /// NAMED_VALUE_FLOAT (251).
    Value(NAMED_VALUE_FLOAT_DATA),
    /// STATUSTEXT (253).
    Text(STATUSTEXT_DATA),
}

/// HEARTBEAT of an onboard controller that is no autopilot.
pub fn heartbeat(state: MavState) -> Message {
    Message::Heartbeat(HEARTBEAT_DATA {
        custom_mode: 0,
        mavtype: MavType::MAV_TYPE_ONBOARD_CONTROLLER,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: state,
        mavlink_version: 3,
    })
}

/// SYS_STATUS that speaks of the attitude alone (MAV_SYS_STATUS_AHRS): it is healthy while it may be trusted.
/// There is no battery, and of load and communication nothing is said.
pub fn sys_status(healthy: bool) -> Message {
    let attitude = MavSysStatusSensor::MAV_SYS_STATUS_AHRS;
    Message::Status(SYS_STATUS_DATA {
        onboard_control_sensors_present: attitude,
        onboard_control_sensors_enabled: attitude,
        onboard_control_sensors_health: if healthy { attitude } else { MavSysStatusSensor::empty() },
        load: 0,
        voltage_battery: u16::MAX,
        current_battery: -1,
        battery_remaining: -1,
        ..SYS_STATUS_DATA::DEFAULT
    })
}

/// Whether the attitude may be trusted in a mode.
pub const fn healthy(mode: Mode) -> bool {
    matches!(mode, Mode::Nominal | Mode::Degraded)
}

/// The MAV_STATE of a mode. "Calibrating and not flight-ready" while starting; active while
/// attitude goes out, degraded or not (STATUSTEXT tells the difference); critical while it is
/// withheld or not measured. MAV_STATE_EMERGENCY speaks of an airframe going down and is never ours to say.
pub const fn state(mode: Mode) -> MavState {
    match mode {
        Mode::Starting => MavState::MAV_STATE_CALIBRATING,
        Mode::Nominal | Mode::Degraded => MavState::MAV_STATE_ACTIVE,
        Mode::Faulted => MavState::MAV_STATE_CRITICAL,
    }
}

/// Milliseconds since boot as MAVLink carries them: they wrap after 49.7 days.
pub const fn time_boot_ms(time: Time) -> u32 {
    time.as_millis() as u32
}

/// ATTITUDE of a sample taken at `time`; `None` for angles that are not finite. Yaw and the rates
/// are not known to a horizon; the message has no way to say so, they are 0.
pub fn attitude(time: Time, attitude: Attitude) -> Option<Message> {
    if !attitude.roll.is_finite() || !attitude.pitch.is_finite() {
        return None;
    }
    Some(Message::Attitude(ATTITUDE_DATA {
        time_boot_ms: time_boot_ms(time),
        roll: attitude.roll as f32,
        pitch: attitude.pitch as f32,
        ..ATTITUDE_DATA::DEFAULT
    }))
}

/// NAMED_VALUE_FLOAT `ir_contr`: the contrast, K, as seen at `time`.
pub fn contrast(time: Time, contrast_k: f64) -> Message {
    value("ir_contr", time, contrast_k)
}

/// NAMED_VALUE_FLOAT `ir_qual`: the quality, 0 to 1, as it is at `time`; see [`quality`].
pub fn quality_value(time: Time, quality: f64) -> Message {
    value("ir_qual", time, quality)
}

fn value(name: &str, time: Time, value: f64) -> Message {
    Message::Value(NAMED_VALUE_FLOAT_DATA { time_boot_ms: time_boot_ms(time), value: value as f32, name: name.into() })
}

/// One number for how good the attitude is: 0 while it is withheld, else `1 / (1 + (σ / 5°)²)` of
/// the larger standard deviation, and at most 0.5 while degraded.
pub fn quality(seen: &Seen) -> f64 {
    let best = match (seen.attitude, seen.mode) {
        (None, _) | (_, Mode::Starting | Mode::Faulted) => return 0.0,
        (_, Mode::Degraded) => DEGRADED_QUALITY,
        (_, Mode::Nominal) => 1.0,
    };
    let (roll, pitch) = (seen.sigma.roll, seen.sigma.pitch);
    if !roll.is_finite() || !pitch.is_finite() {
        return 0.0;
    }
    let sigma = roll.abs().max(pitch.abs()).to_degrees() / HALF_QUALITY_SIGMA_DEG;
    (1.0 / (1.0 + sigma * sigma)).min(best)
}

/// STATUSTEXT that a fault has come: CRITICAL while attitude is withheld ("failure in a primary
/// system": whoever flies by it has lost it), else ERROR ("error in secondary or redundant
/// systems"). `irhorizon: sensor-lost:nose (no answer)`.
pub fn fault_came(kind: FaultKind, evidence: Evidence, withheld: bool, names: &dyn FaultName) -> Message {
    let severity = if withheld { MavSeverity::MAV_SEVERITY_CRITICAL } else { MavSeverity::MAV_SEVERITY_ERROR };
    let name = kind.display(names);
    match evidence {
        Evidence::Missing { reason, .. } => text(severity, format_args!("{name} ({reason})")),
        limit @ Evidence::Limit { .. } => text(severity, format_args!("{name} ({limit})")),
    }
}

/// STATUSTEXT that a fault has gone, NOTICE: `irhorizon: sensor-lost:nose cleared`.
pub fn fault_went(kind: FaultKind, names: &dyn FaultName) -> Message {
    text(MavSeverity::MAV_SEVERITY_NOTICE, format_args!("{} cleared", kind.display(names)))
}

/// A STATUSTEXT in one message; what does not fit is cut, and ends in `..` then.
fn text(severity: MavSeverity, what: fmt::Arguments<'_>) -> Message {
    let mut line = Line { bytes: [0; TEXT_LEN], len: 0, cut: false };
    // Writing to a line never fails.
    let _ = write!(line, "irhorizon: {what}");
    Message::Text(STATUSTEXT_DATA { severity, text: line.finish().into() })
}

/// Text of limited length, without allocation.
struct Line {
    bytes: [u8; TEXT_LEN],
    len: usize,
    cut: bool,
}

impl Write for Line {
    fn write_str(&mut self, s: &str) -> fmt::Result {
        for c in s.chars() {
            let end = self.len + c.len_utf8();
            if self.cut || end > TEXT_LEN {
                self.cut = true;
                break;
            }
            c.encode_utf8(&mut self.bytes[self.len..end]);
            self.len = end;
        }
        Ok(())
    }
}

impl Line {
    fn finish(mut self) -> [u8; TEXT_LEN] {
        if self.cut {
            let mut end = self.len.min(TEXT_LEN - 2);
            // Not in the middle of a character.
            while end > 0 && self.bytes[end] & 0xc0 == 0x80 {
                end -= 1;
            }
            self.bytes[end..].fill(0);
            self.bytes[end..end + 2].copy_from_slice(b"..");
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Missing;
    use crate::head::Head;

    fn spelled(message: &Message) -> (u8, String) {
        match message {
            Message::Text(t) => (t.severity as u8, t.text.to_str().unwrap().to_owned()),
            other => panic!("{other:?}"),
        }
    }

    fn lost(reason: Missing) -> Evidence {
        Evidence::Missing { reason, failures: 7 }
    }

    #[test]
    fn faults_are_spelled_in_one_vocabulary() {
        let head = Head::six();
        let came = fault_came(FaultKind::SensorLost(0), lost(Missing::NoAnswer), true, &head);
        assert_eq!(spelled(&came), (2, "irhorizon: sensor-lost:nose (no answer)".into()));
        let evidence = Evidence::Limit { value: 0.431, limit: 1.5, unit: "K" };
        let came = fault_came(FaultKind::LowContrast, evidence, false, &head);
        assert_eq!(spelled(&came), (3, "irhorizon: low-contrast (0.43 K, limit 1.50 K)".into()));
        let went = fault_went(FaultKind::SensorLost(0), &head);
        assert_eq!(spelled(&went), (5, "irhorizon: sensor-lost:nose cleared".into()));
    }

    #[test]
    fn text_is_cut_at_fifty_bytes_between_characters() {
        let head = Head::new(Vec::new(), vec!["/dev/i2c-1".into(), "x".repeat(200), "ö".repeat(40), "€".repeat(40)]);
        let say = |bus, reason| spelled(&fault_came(FaultKind::BusDown(bus), lost(reason), true, &head)).1;
        assert_eq!(say(0, Missing::Denied), "irhorizon: bus-down:/dev/i2c-1 (permission denied)");
        assert_eq!(say(0, Missing::Claimed), "irhorizon: bus-down:/dev/i2c-1 (claimed by a ker..");
        assert_eq!(say(1, Missing::Denied), format!("irhorizon: bus-down:{}..", "x".repeat(28)));
        assert_eq!(say(2, Missing::Denied), format!("irhorizon: bus-down:{}..", "ö".repeat(14)));
        assert_eq!(say(3, Missing::Denied), format!("irhorizon: bus-down:{}..", "€".repeat(9)));
    }

    #[test]
    fn angles_that_are_not_finite_are_no_attitude() {
        assert!(attitude(Time::default(), Attitude { roll: f64::NAN, pitch: 0.0 }).is_none());
        assert!(attitude(Time::default(), Attitude { roll: 0.0, pitch: f64::INFINITY }).is_none());
    }

    #[test]
    fn the_stamp_wraps_at_32_bits() {
        assert_eq!(time_boot_ms(Time::from_nanos(4_294_967_295_000_000)), u32::MAX);
        assert_eq!(time_boot_ms(Time::from_nanos(4_294_967_301_999_999)), 5);
    }

    #[test]
    fn quality_falls_with_sigma_and_mode() {
        let mut seen = Seen {
            attitude: Some(Attitude::default()),
            sigma: Attitude::from_degrees(0.0, 0.0),
            mode: Mode::Nominal,
            ..Seen::default()
        };
        assert_eq!(quality(&seen), 1.0);
        seen.sigma = Attitude::from_degrees(1.0, 5.0);
        assert!((quality(&seen) - 0.5).abs() < 1e-12);
        seen.mode = Mode::Degraded;
        seen.sigma = Attitude::from_degrees(1.0, 0.0);
        assert_eq!(quality(&seen), 0.5);
        seen.sigma.roll = f64::NAN;
        assert_eq!(quality(&seen), 0.0);
        seen.sigma.roll = 0.0;
        seen.attitude = None;
        assert_eq!(quality(&seen), 0.0);
    }
}
