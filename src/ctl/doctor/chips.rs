//! Findings on the sensors themselves.

use super::facts::{Facts, Seen};
use super::finding::{Check, Finding, told};
use crate::bus::explain::{Place, explain_missing};
use crate::ctl::view::Sensor;
use crate::frame::Missing;
use std::path::PathBuf;

/// A share of damaged words above which the bus is not well.
const DAMAGED: f64 = 1e-3;
/// A settling time, s, above which a turn is seen late.
const SLOW_S: f64 = 0.3;
/// An emissivity below which the sensor does not say what it sees.
const LEAST_EMISSIVITY: f64 = 0.9;

/// All of them.
pub fn findings(f: &Facts) -> Vec<Finding> {
    if let Some(why) = f.hands_off() {
        return vec![Check::Answers.skipped("", why)];
    }
    let mut found = Vec::new();
    for check in [answers, pec, error_flag, range, identity, settling] {
        found.extend(f.sensors.iter().flat_map(check));
    }
    found.extend(twins(f));
    found
}

fn answers(seen: &Seen) -> Option<Finding> {
    const C: Check = Check::Answers;
    let s = &seen.sensor;
    let values =
        [s.object_c.map(|v| format!("sees {v:.1} °C")), s.ambient_c.map(|v| format!("is at {v:.1} °C itself"))];
    let values =
        values.into_iter().flatten().chain(s.volts.map(|v| format!("{v:.4} V"))).collect::<Vec<_>>().join(", ");
    let at = format!("{:#04x} on {}", s.address, s.bus);
    Some(match Missing::from_words(&s.state) {
        _ if s.state == "ok" && values.is_empty() => C.ok(&s.name, format!("answers at {at}")),
        _ if s.state == "ok" => C.ok(&s.name, format!("{at}: {values}")),
        // These answer: their own checks tell.
        Some(Missing::ErrorFlag | Missing::Saturated | Missing::Impossible | Missing::NotReady | Missing::BadPec) => {
            C.ok(&s.name, format!("answers at {at}"))
        }
        Some(Missing::NotYet | Missing::PoweredOff | Missing::Empty) => C.skipped(&s.name, s.state.as_str()),
        Some(why) => {
            let (evidence, next) = explained(seen, why);
            let evidence = match why {
                // These are the whole bus's, and alike for all on it.
                why if why.is_of_the_bus() && evidence.contains(&s.bus) => evidence,
                why if why.is_of_the_bus() => format!("{evidence}: {}", s.bus),
                _ => format!("{evidence} at {at}"),
            };
            C.fail(&s.name, evidence, next)
        }
        None => C.warn(&s.name, s.state.as_str(), "irhorizonctl sensors"),
    })
}

/// Why there is no measurement, and the next step.
fn explained(seen: &Seen, why: Missing) -> (String, String) {
    let s = &seen.sensor;
    let chip = if s.kind == "ads1115" { "ADS1115" } else { "MLX90614" };
    let place = Place { name: s.name.clone(), chip, bus: PathBuf::from(&s.bus), address: s.address };
    let text = explain_missing(&place, why, &seen.system);
    let text = text.strip_prefix(&format!("{place}: ")).unwrap_or(&text);
    let (evidence, next) = told(text, "; ", "irhorizonctl sensors");
    (evidence.to_owned(), next.to_owned())
}

fn count(s: &Sensor, name: &str) -> u64 {
    s.counters.iter().find(|(n, _)| n == name).map_or(0, |(_, n)| *n)
}

/// `12 of 180000 words`.
fn share(s: &Sensor, name: &str) -> (u64, f64, String) {
    let (bad, good) = (count(s, name), count(s, "reads"));
    let all = bad.saturating_add(good).max(1);
    (bad, bad as f64 / all as f64, format!("{bad} of {all} words"))
}

fn pec(seen: &Seen) -> Option<Finding> {
    const C: Check = Check::Pec;
    let s = &seen.sensor;
    if s.kind == "ads1115" {
        return None;
    }
    let (bad, part, words) = share(s, "bad-pec");
    if s.state == Missing::BadPec.as_str() {
        let (evidence, next) = explained(seen, Missing::BadPec);
        return Some(C.fail(&s.name, evidence, next));
    }
    Some(match s.integrity.as_str() {
        "none" | "" => return None,
        "pec" | "software-pec" if part > DAMAGED => C.warn(
            &s.name,
            format!("{words} arrived damaged"),
            "shorten the wires, check the pull-ups, run the bus at 100 kHz or less",
        ),
        "pec" | "software-pec" if bad > 0 => C.ok(&s.name, format!("checked; {words} arrived damaged")),
        "pec" | "software-pec" => C.ok(&s.name, "every word is checked"),
        "unchecked: PEC switched off" => C.warn(
            &s.name,
            "switched off in the configuration",
            "unless the part is known to send a wrong PEC, take its pec = \"off\" out",
        ),
        // The adapter's own finding has the next step.
        other => C.skipped(&s.name, other),
    })
}

fn error_flag(seen: &Seen) -> Option<Finding> {
    let s = &seen.sensor;
    let (bad, _, words) = share(s, "error-flag");
    if s.state == Missing::ErrorFlag.as_str() {
        let (evidence, next) = explained(seen, Missing::ErrorFlag);
        return Some(Check::ErrorFlag.fail(&s.name, evidence, next));
    }
    let next = "watch the count (irhorizonctl sensors); if it grows, look at its supply, then replace it";
    (bad > 0).then(|| Check::ErrorFlag.warn(&s.name, format!("{words} had it set"), next))
}

fn range(seen: &Seen) -> Option<Finding> {
    let s = &seen.sensor;
    let (bad, _, words) = share(s, "out-of-range");
    match Missing::from_words(&s.state) {
        Some(why @ (Missing::Saturated | Missing::Impossible)) => {
            let (evidence, next) = explained(seen, why);
            Some(Check::Range.fail(&s.name, evidence, next))
        }
        _ if bad == 0 => None,
        _ if s.kind == "ads1115" => {
            Some(Check::Range.warn(&s.name, format!("{words} stood at the end of the range"), "choose a larger gain-v"))
        }
        _ => Some(Check::Range.warn(
            &s.name,
            format!("{words} were none that it can measure"),
            "is it an MLX90614? Look at its wiring: without PEC damaged words are taken",
        )),
    }
}

fn identity(seen: &Seen) -> Option<Finding> {
    const C: Check = Check::Identity;
    let s = &seen.sensor;
    if s.identity.is_empty() {
        return None;
    }
    let emissivity = s.emissivity.filter(|e| e.is_finite());
    let text = match emissivity {
        Some(e) => format!("{}, emissivity {e:.2}", s.identity),
        None => s.identity.clone(),
    };
    Some(match emissivity {
        _ if !is_identity(&s.identity) => C.warn(
            &s.name,
            format!("its identity reads {}", s.identity),
            "no MLX90614 has that: is it another chip, or is its data line stuck?",
        ),
        Some(e) if e < LEAST_EMISSIVITY => C.warn(
            &s.name,
            text,
            "its temperatures are scaled by that: have cell 0x24 set to 0xffff, or use another part",
        ),
        _ => C.ok(&s.name, text),
    })
}

/// Whether a chip can have that: not all its bits are alike.
fn is_identity(digits: &str) -> bool {
    digits.bytes().any(|b| b != b'0') && digits.bytes().any(|b| b != b'f')
}

/// One chip that stands for two sensors: a multiplexer that is not switched, a sensor named twice.
fn twins(f: &Facts) -> Vec<Finding> {
    let sensors: Vec<&Sensor> = f.sensors.iter().map(|s| &s.sensor).collect();
    let mut found = Vec::new();
    for (i, s) in sensors.iter().enumerate().filter(|(_, s)| is_identity(&s.identity)) {
        let elsewhere = |o: &&&Sensor| o.identity == s.identity && (&o.bus, o.address) != (&s.bus, s.address);
        if let Some(other) = sensors[..i].iter().find(elsewhere) {
            found.push(Check::Identity.warn(
                &format!("{}, {}", other.name, s.name),
                format!("both are the chip {}", s.identity),
                "see that each bus leads to chips of its own: i2cdetect -l",
            ));
        }
    }
    found
}

fn settling(seen: &Seen) -> Option<Finding> {
    let s = &seen.sensor;
    if s.settling_s <= 0.0 {
        return None;
    }
    let text = format!("shows a step after {:.2} s", s.settling_s);
    Some(if s.settling_s > SLOW_S {
        let next = "turns are seen late: use a part with faster filters, such as an xAA (0.10 s)";
        Check::Settling.warn(&s.name, text, next)
    } else {
        Check::Settling.ok(&s.name, text)
    })
}
