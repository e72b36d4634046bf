//! Findings on configuration, service, D-Bus, and on the daemon at work.

use super::facts::{Facts, Service, Silence};
use super::finding::{Check, Finding, told};
use crate::config::settings::{BusAddress, Settings};
use crate::ctl::view::Status;
use crate::dbus::NAME;
use crate::dbus::bus::place;
use crate::sensor::schedule::Schedule;

/// What must be there before anything is measured.
pub fn groundwork(f: &Facts) -> Vec<Finding> {
    let mut found = configuration(f);
    found.push(schedule(f));
    found.push(service(f));
    found.push(dbus(f));
    found.push(policy(f));
    found
}

/// How the daemon does.
pub fn at_work(f: &Facts) -> Vec<Finding> {
    let mut found = vec![timing(f)];
    match &f.daemon {
        Ok(status) => {
            found.extend(attitude(status));
            found.extend(mavlink(status));
        }
        Err(_) => {
            found.push(Check::Attitude.skipped("", "no daemon answers"));
            found.push(Check::Mavlink.skipped("", "no daemon answers"));
        }
    }
    found
}

fn settings(f: &Facts) -> Option<&Settings> {
    f.configuration.as_ref().ok().map(|l| &l.settings)
}

fn configuration(f: &Facts) -> Vec<Finding> {
    let file = f.file.display().to_string();
    match &f.configuration {
        Err(errors) => {
            let lines: Vec<&str> = errors.lines().filter(|l| !l.starts_with("   ")).collect();
            let more = lines.len().saturating_sub(1);
            let rest = if more > 0 { format!(" (and {more} more)") } else { String::new() };
            let first = lines.first().copied().unwrap_or("it cannot be used");
            let first = first.strip_prefix(&format!("{file}: ")).unwrap_or(first);
            // One that is about the whole file says what to do.
            let otherwise = format!("see each with its line: irhorizonctl validate {file}");
            let (evidence, next) = if more == 0 { told(first, ". ", &otherwise) } else { (first, &*otherwise) };
            vec![Check::Configuration.fail(&file, format!("{evidence}{rest}"), next)]
        }
        Ok(loaded) if !loaded.warnings.is_empty() => {
            let next = format!("correct it, then look again: irhorizonctl validate {file}");
            loaded.warnings.iter().map(|w| Check::Configuration.warn(&file, w.as_str(), next.as_str())).collect()
        }
        Ok(loaded) => {
            let s = &loaded.settings;
            let drop_ins = match loaded.files.len() {
                0 | 1 => String::new(),
                2 => ", one drop-in".to_owned(),
                n => format!(", {} drop-ins", n - 1),
            };
            let head = if s.simulation.is_some() { "a simulated flight" } else { "hardware" };
            let (sensors, method) = (s.head().sensors.len(), s.method().as_str());
            let text = format!("{head}, {sensors} sensors, {} Hz, method {method}{drop_ins}", s.rate_hz);
            vec![Check::Configuration.ok(&file, text)]
        }
    }
}

fn schedule(f: &Facts) -> Finding {
    let Some(s) = settings(f) else { return Check::Schedule.skipped("", "there is no configuration") };
    if s.simulation.is_some() {
        return Check::Schedule.skipped("", "the flight is simulated");
    }
    match Schedule::plan(&s.sensors, &s.head(), s.rate_hz, s.quiet) {
        Ok(plan) => {
            let [needed, period] = [plan.needed, plan.period].map(|d| d.as_secs_f64() * 1e3);
            Check::Schedule.ok("", format!("a scan takes {needed:.1} ms of the {period:.1} ms that it may"))
        }
        Err(e) => {
            let text = e.to_string();
            let (evidence, next) = told(&text, ": ", "set [daemon] rate-hz lower");
            Check::Schedule.fail("", evidence, next)
        }
    }
}

fn service(f: &Facts) -> Finding {
    const UNIT: &str = "irhorizond";
    const LOG: &str = "see why: journalctl -u irhorizond -n 30";
    let Some(Service { load, active, result, restarts }) = &f.service else {
        return Check::Service.skipped(UNIT, "systemd does not run here");
    };
    let start = "have it start now and with the machine: sudo systemctl enable --now irhorizond";
    match active.as_str() {
        _ if load == "not-found" && f.process.is_some() => {
            Check::Service.skipped(UNIT, "not installed; it was started by hand")
        }
        _ if load == "not-found" => Check::Service.skipped(UNIT, "not installed"),
        "active" | "reloading" if *restarts > 0 => {
            Check::Service.warn(UNIT, format!("active, but had to be started again {restarts} times"), LOG)
        }
        "active" | "reloading" => Check::Service.ok(UNIT, active.as_str()),
        "failed" => Check::Service.fail(UNIT, format!("failed ({result})"), LOG),
        "activating" => Check::Service.warn(UNIT, "still starting", LOG),
        other => Check::Service.warn(UNIT, if other.is_empty() { "in no known state" } else { other }, start),
    }
}

fn dbus(f: &Facts) -> Finding {
    let configured = settings(f).map(|s| s.dbus.bus.clone());
    match &f.daemon {
        Ok(status) if status.version == env!("CARGO_PKG_VERSION") => {
            Check::Dbus.ok(NAME, format!("irhorizond {} answers on {}", status.version, place(&f.asked)))
        }
        Ok(status) => Check::Dbus.warn(
            NAME,
            format!("irhorizond {} answers a client of version {}", status.version, env!("CARGO_PKG_VERSION")),
            "after an upgrade the old one goes on: sudo systemctl restart irhorizond",
        ),
        Err(Silence::Refused(why)) => {
            Check::Dbus.fail(NAME, why.as_str(), "ask again as root or as a member of the group irhorizon")
        }
        Err(Silence::Absent(why)) => match configured {
            Some(None) => Check::Dbus.skipped(NAME, "the configuration keeps the daemon off D-Bus (bus = \"none\")"),
            Some(Some(bus)) if bus != f.asked => {
                let option = match bus {
                    BusAddress::System => "--bus system",
                    BusAddress::Session => "--bus session",
                    BusAddress::Address(_) => "--bus with its address",
                };
                let evidence = format!("not on {}; the configuration puts it on {}", place(&f.asked), place(&bus));
                Check::Dbus.warn(NAME, evidence, format!("ask there: irhorizonctl {option} doctor"))
            }
            _ if f.process.is_some() => {
                let why = why.split_once(": ").map_or(why.as_str(), |(evidence, _)| evidence);
                let evidence = format!("{why}, and yet one runs (pid {})", f.process.unwrap_or_default());
                Check::Dbus.fail(NAME, evidence, "see why: journalctl -u irhorizond | grep D-Bus")
            }
            // The error tells what is missing and then what to do.
            _ => {
                let (evidence, next) = told(why, ": ", "start irhorizond");
                Check::Dbus.warn(NAME, evidence, next)
            }
        },
    }
}

fn policy(f: &Facts) -> Finding {
    const FILE: &str = "org.irhorizon1.conf";
    let on_system = settings(f).is_none_or(|s| s.dbus.bus == Some(BusAddress::System));
    match &f.policy {
        Some(path) => Check::Policy.ok(FILE, format!("installed as {}", path.display())),
        None if !on_system || f.asked != BusAddress::System => {
            Check::Policy.skipped(FILE, "the system bus is not used")
        }
        None if f.by_daemon() => Check::Policy.ok(FILE, "not in the usual places, and the daemon has its name"),
        None => Check::Policy.fail(
            FILE,
            "not installed: no daemon may own its name on the system bus",
            "sudo cp packaging/org.irhorizon1.conf /usr/share/dbus-1/system.d/ && sudo systemctl reload dbus",
        ),
    }
}

/// The share of the configured rate below which scans are left out.
const LEAST_RATE: f64 = 0.95;
/// The share of a period that is kept free for delays.
const FREE: f64 = 0.1;

fn timing(f: &Facts) -> Finding {
    let rate_hz = settings(f).map(|s| s.rate_hz);
    match (&f.daemon, rate_hz, f.lateness) {
        (Ok(status), Some(rate_hz), _) if status.rate_hz > 0.0 && status.rate_hz < LEAST_RATE * rate_hz => {
            Check::Timing.warn(
                "",
                format!("{:.1} scans a second of {rate_hz}", status.rate_hz),
                "a sensor that fails costs time: mend the failures told here, else set [daemon] rate-hz lower",
            )
        }
        (Ok(status), ..) if status.rate_hz <= 0.0 => Check::Timing.skipped("", "no scan yet"),
        // Scans go on, and none of them has read anything.
        (Ok(status), ..) if status.sample_age_s.is_nan() => Check::Timing.warn(
            "",
            format!("{:.1} scans a second, and no measurement yet", status.rate_hz),
            "mend what is told of the sensors here: irhorizonctl sensors",
        ),
        (Ok(status), ..) => Check::Timing.ok(
            "",
            format!("{:.1} scans a second, the newest {:.0} ms old", status.rate_hz, status.sample_age_s * 1e3),
        ),
        (Err(_), Some(rate_hz), Some(l)) => {
            let text = format!(
                "woken {:.2} ms late on the mean and {:.2} ms at most, of {} times at {rate_hz} Hz",
                l.mean_ms, l.most_ms, l.waits
            );
            if l.most_ms <= FREE * 1e3 / rate_hz {
                Check::Timing.ok("", text)
            } else {
                Check::Timing.warn(
                    "",
                    text,
                    "the machine is busy: find with what (top), else set [daemon] rate-hz lower",
                )
            }
        }
        _ => Check::Timing.skipped("", "no rate is known"),
    }
}

fn attitude(status: &Status) -> Vec<Finding> {
    const C: Check = Check::Attitude;
    let sigma = status.roll_sigma_deg.into_iter().chain(status.pitch_sigma_deg).fold(f64::NAN, f64::max);
    let mode = status.mode.as_str();
    if status.faults.is_empty() {
        return vec![match mode {
            "nominal" if sigma.is_finite() => C.ok("", format!("nominal, σ {sigma:.1}°")),
            "nominal" => C.ok("", "nominal"),
            "starting" => C.warn("", "starting: nothing was measured yet", "wait: irhorizonctl wait-ready"),
            mode => C.warn("", mode, "irhorizonctl status"),
        }];
    }
    let one = |fault: &crate::ctl::view::Fault| {
        let evidence = format!("{mode}: {}", fault.evidence);
        let next = if fault.advice.is_empty() { "irhorizonctl status" } else { fault.advice };
        if mode == "faulted" { C.fail(&fault.name, evidence, next) } else { C.warn(&fault.name, evidence, next) }
    };
    status.faults.iter().map(one).collect()
}

fn mavlink(status: &Status) -> Vec<Finding> {
    const C: Check = Check::Mavlink;
    if status.endpoints.is_empty() {
        return vec![C.skipped("", "no endpoint is configured")];
    }
    let one = |e: &crate::ctl::view::Endpoint| {
        let counts = format!("{} sent, {} failed", e.sent, e.failed);
        let next = "is somebody listening there? See docs/mavlink-dbus.md, Endpoints";
        match (e.sent, e.last_error.as_str()) {
            (0, "") => C.warn(&e.address, "nothing was sent yet: nobody was heard there", next),
            (_, "") => C.ok(&e.address, counts),
            (0, error) => C.fail(&e.address, format!("{counts}: {error}"), next),
            (_, error) => C.warn(&e.address, format!("{counts}, at last: {error}"), next),
        }
    };
    status.endpoints.iter().map(one).collect()
}
