//! Findings on device files, buses, adapters and GPIO lines.

use super::facts::{Facts, Line, Node};
use super::finding::{Check, Finding, told};
use crate::bus::{BusError, Functions};
use crate::config::settings::{DeviceSettings, PecPolicy, Settings};

/// All of them.
pub fn findings(f: &Facts) -> Vec<Finding> {
    const CHECKS: [Check; 4] = [Check::Permissions, Check::Bus, Check::Adapter, Check::Gpio];
    if let Some(why) = f.hands_off() {
        return CHECKS.iter().map(|c| c.skipped("", why.as_str())).collect();
    }
    let mut found: Vec<Finding> = f.nodes.iter().map(|node| permissions(node, f.by_daemon())).collect();
    let buses = || f.nodes.iter().filter(|n| !n.path.starts_with("/dev/tty") && !n.path.starts_with("/dev/serial"));
    found.extend(buses().map(|node| bus(node, f)));
    let settings = f.configuration.as_ref().ok().map(|l| &l.settings);
    found.extend(f.adapters.iter().map(|(bus, functions)| adapter(bus, *functions, settings, f.by_daemon())));
    found.extend(f.lines.iter().map(line));
    found.extend(data_ready(f));
    found
}

fn permissions(node: &Node, by_daemon: bool) -> Finding {
    const C: Check = Check::Permissions;
    let Node { path, user, .. } = node;
    let group = match &node.group {
        Some((group, mode)) => format!(" (group {group}, mode {mode:04o})"),
        None => String::new(),
    };
    if !node.present {
        return C.skipped(path, "it is not there");
    }
    if node.allowed {
        return C.ok(path, format!("{user} may read and write it{group}"));
    }
    if by_daemon {
        return C.skipped(path, "the daemon has it; what this user may does not matter");
    }
    let next = match &node.group {
        Some((group, _)) if node.member => format!("{user} is in group {group} since this session began: log in again"),
        Some((group, mode)) if group != "root" && mode & 0o060 == 0o060 => {
            format!("sudo usermod -aG {group} {user}, then log in again")
        }
        _ if path.starts_with("/dev/i2c") => {
            "sudo apt install i2c-tools: its udev rule gives the buses to group i2c".to_owned()
        }
        _ => "give it to a group by a udev rule: see udev/60-irhorizon.rules".to_owned(),
    };
    C.fail(path, format!("{user} may not read and write it{group}"), next)
}

fn bus(node: &Node, f: &Facts) -> Finding {
    if node.present {
        return Check::Bus.ok(&node.path, "there");
    }
    let others = f.sensors.first().map(|s| s.system.buses.as_slice()).unwrap_or_default();
    let others = if others.is_empty() {
        "there is no I2C bus at all".to_owned()
    } else {
        format!("there are: {}", others.join(", "))
    };
    Check::Bus.fail(
        &node.path,
        format!("not there; {others}"),
        "plug the adapter in, or enable I2C: dtparam=i2c_arm=on in config.txt (raspi-config), then sudo modprobe i2c-dev",
    )
}

fn adapter(bus: &str, functions: Result<Functions, BusError>, settings: Option<&Settings>, by_daemon: bool) -> Finding {
    const C: Check = Check::Adapter;
    let functions = match functions {
        Ok(functions) => functions,
        Err(BusError::Denied) if by_daemon => return C.skipped(bus, "this user may not ask it, and the daemon does"),
        Err(e @ (BusError::Denied | BusError::Gone)) => return C.skipped(bus, e.to_string()),
        Err(BusError::Other(25)) => {
            return C.fail(bus, "it is no I2C bus", "name one of /dev/i2c-* in the configuration");
        }
        Err(e) => return C.fail(bus, e.to_string(), "see the kernel's log: dmesg | grep -i i2c"),
    };
    let text = functions.to_string();
    if !functions.words() {
        return C.fail(bus, text, "it cannot transfer SMBus words: use another adapter, or the i2c-gpio overlay");
    }
    let policies: Vec<PecPolicy> = settings
        .into_iter()
        .flat_map(|s| &s.sensors)
        .filter_map(|s| match &s.device {
            DeviceSettings::Mlx90614(m) if m.bus.to_string_lossy() == bus => Some(m.pec),
            _ => None,
        })
        .collect();
    if functions.pec() || policies.iter().all(|p| *p == PecPolicy::Off) {
        C.ok(bus, text)
    } else if policies.contains(&PecPolicy::Required) {
        C.fail(bus, text, "a sensor has pec = \"required\": use another adapter, or the i2c-gpio overlay")
    } else {
        C.warn(bus, text, "damaged words go unseen: use an adapter with PEC, or the i2c-gpio overlay; keep wires short")
    }
}

fn line(line: &Line) -> Finding {
    const C: Check = Check::Gpio;
    let place = format!("line {} of {}", line.settings.line, line.settings.chip);
    match &line.used_by {
        Ok(None) => C.ok(&line.purpose, format!("{place} is free")),
        Ok(Some(user)) if user == "irhorizon" => C.ok(&line.purpose, format!("{place} is the daemon's")),
        Ok(Some(user)) => C.fail(
            &line.purpose,
            format!("{place} is in use by {user}"),
            "wire and configure another one, or end what uses it: see gpioinfo",
        ),
        // The error tells what is wrong and then what to do.
        Err(why) => {
            let (evidence, next) = told(why, ": ", "see gpiodetect and gpioinfo");
            C.fail(&line.purpose, evidence, next)
        }
    }
}

fn data_ready(f: &Facts) -> Vec<Finding> {
    const C: Check = Check::DataReady;
    let Ok(loaded) = &f.configuration else { return Vec::new() };
    let mut found = Vec::new();
    for s in &loaded.settings.sensors {
        let DeviceSettings::Ads1115(ads) = &s.device else { continue };
        let Some(line) = &ads.data_ready else { continue };
        let seen = f.sensors.iter().map(|x| &x.sensor).find(|x| x.name == s.name).filter(|_| f.by_daemon());
        let count = |name| seen.and_then(|x| x.counters.iter().find(|(n, _)| n == name)).map_or(0, |(_, n)| *n);
        let (reads, late) = (count("reads"), count("not-ready"));
        let evidence = format!("{late} of {} conversions did not end in time", reads + late);
        let next = format!(
            "is ALERT/RDY wired to line {} of {}, with a pull-up of 10 kΩ? Without the line conversions are waited for",
            line.line, line.chip
        );
        found.push(match (reads, late) {
            (0, 0) => C.skipped(&s.name, "it shows while the daemon converts"),
            (_, 0) => C.ok(&s.name, format!("{reads} conversions, each in time")),
            (0, _) => C.fail(&s.name, evidence, next),
            _ => C.warn(&s.name, evidence, next),
        });
    }
    found
}
