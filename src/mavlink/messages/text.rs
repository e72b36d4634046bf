//! Faults in words: STATUSTEXT.

use super::Message;
use crate::fault::{Evidence, FaultKind, FaultName};
use ::mavlink::dialects::common::{MavSeverity, STATUSTEXT_DATA};
use std::fmt::{self, Write};

/// Bytes of text that one STATUSTEXT holds.
const TEXT_LEN: usize = 50;

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

/// STATUSTEXT of something else worth a word: why a request was refused, what a setting does.
pub fn note(severity: MavSeverity, what: &str) -> Message {
    text(severity, format_args!("{what}"))
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
}
