//! A finding: what was looked at, how it stands, by which evidence, and the one next step.

use serde::Serialize;

/// What is looked at. Each has its paragraph in docs/troubleshooting.md.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Check {
    /// The configuration file and its drop-ins.
    Configuration,
    /// Whether a scan fits into its period.
    Schedule,
    /// The systemd unit.
    Service,
    /// The daemon's name on D-Bus.
    Dbus,
    /// The system bus's policy for it.
    Policy,
    /// Device files.
    Permissions,
    /// The buses that the configuration names.
    Bus,
    /// What an adapter can do.
    Adapter,
    /// Whether a sensor answers at its address.
    Answers,
    /// Whether its words are checked, and arrive whole.
    Pec,
    /// Its error bit.
    ErrorFlag,
    /// Values at or beyond the end of a range.
    Range,
    /// Which chip it is, and how it is set.
    Identity,
    /// The time that its filters take.
    Settling,
    /// GPIO lines.
    Gpio,
    /// ALERT/RDY of an ADS1115.
    DataReady,
    /// Whether scans come when they should.
    Timing,
    /// Whether attitude is given.
    Attitude,
    /// The MAVLink endpoints.
    Mavlink,
}

impl Check {
    /// All of them.
    pub const ALL: [Self; 19] = [
        Self::Configuration,
        Self::Schedule,
        Self::Service,
        Self::Dbus,
        Self::Policy,
        Self::Permissions,
        Self::Bus,
        Self::Adapter,
        Self::Answers,
        Self::Pec,
        Self::ErrorFlag,
        Self::Range,
        Self::Identity,
        Self::Settling,
        Self::Gpio,
        Self::DataReady,
        Self::Timing,
        Self::Attitude,
        Self::Mavlink,
    ];

    /// Its name, as report and documentation write it.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Configuration => "configuration",
            Self::Schedule => "schedule",
            Self::Service => "service",
            Self::Dbus => "dbus",
            Self::Policy => "policy",
            Self::Permissions => "permissions",
            Self::Bus => "bus",
            Self::Adapter => "adapter",
            Self::Answers => "answers",
            Self::Pec => "pec",
            Self::ErrorFlag => "error-flag",
            Self::Range => "range",
            Self::Identity => "identity",
            Self::Settling => "settling",
            Self::Gpio => "gpio",
            Self::DataReady => "data-ready",
            Self::Timing => "timing",
            Self::Attitude => "attitude",
            Self::Mavlink => "mavlink",
        }
    }

    /// As it should be.
    pub fn ok(self, on: &str, evidence: impl Into<String>) -> Finding {
        self.found(Verdict::Ok, on, evidence, None)
    }

    /// It works, but should not stay so.
    pub fn warn(self, on: &str, evidence: impl Into<String>, next: impl Into<String>) -> Finding {
        self.found(Verdict::Warn, on, evidence, Some(next.into()))
    }

    /// It does not work.
    pub fn fail(self, on: &str, evidence: impl Into<String>, next: impl Into<String>) -> Finding {
        self.found(Verdict::Fail, on, evidence, Some(next.into()))
    }

    /// It could not be looked at: why.
    pub fn skipped(self, on: &str, why: impl Into<String>) -> Finding {
        self.found(Verdict::Skipped, on, why, None)
    }

    fn found(self, verdict: Verdict, on: &str, evidence: impl Into<String>, next: Option<String>) -> Finding {
        Finding {
            check: self,
            on: on.to_owned(),
            verdict,
            evidence: one_line(&evidence.into()),
            next: next.map(|n| one_line(&n)),
        }
    }
}

/// How it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// As it should be.
    Ok,
    /// It works, but should not stay so.
    Warn,
    /// It does not work.
    Fail,
    /// It could not be looked at.
    Skipped,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What was looked at.
    pub check: Check,
    /// On which sensor, bus or file; empty where there is one only.
    pub on: String,
    /// How it stands.
    pub verdict: Verdict,
    /// By what.
    pub evidence: String,
    /// What to do next: of every warning and failure.
    pub next: Option<String>,
}

/// Findings that differ by their subject alone are one.
pub(super) fn merged(found: Vec<Finding>) -> Vec<Finding> {
    let mut merged: Vec<Finding> = Vec::new();
    for f in found {
        let alike =
            |m: &&mut Finding| (m.check, m.verdict, &m.evidence, &m.next) == (f.check, f.verdict, &f.evidence, &f.next);
        match merged.iter_mut().find(alike) {
            Some(first) if first.on != f.on => first.on = format!("{}, {}", first.on, f.on),
            Some(_) => {}
            None => merged.push(f),
        }
    }
    merged
}

/// What a text tells before `mark`, and the next step that it tells after it; `otherwise` where it tells none.
pub(super) fn told<'a>(text: &'a str, mark: &str, otherwise: &'a str) -> (&'a str, &'a str) {
    text.split_once(mark).filter(|(_, next)| !next.trim().is_empty()).unwrap_or((text, otherwise))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_always_a_next_step() {
        assert_eq!(told("no bus: plug it in", ": ", "look"), ("no bus", "plug it in"));
        assert_eq!(told("no bus", ": ", "look"), ("no bus", "look"));
        for nothing in ["no bus: ", "no bus: \n"] {
            assert_eq!(told(nothing, ": ", "look"), (nothing, "look"));
        }
    }
}
