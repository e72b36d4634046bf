//! Facts of installations that are well, new, wired wrong, degraded.

use irhorizon::bus::{BusError, Functions, explain};
use irhorizon::config::settings::BusAddress;
use irhorizon::config::{Loaded, parse};
use irhorizon::ctl::doctor::facts::{Facts, Lateness, Line, Node, Seen, Service, Silence};
use irhorizon::ctl::view::{Endpoint, Fault, Sensor, Status};

pub const SIX: [&str; 6] = ["nose", "tail", "left", "right", "up", "down"];

pub fn loaded(text: &str) -> Loaded {
    parse(&[("irhorizon.toml".into(), text.into())]).unwrap()
}

pub fn six() -> String {
    let mlx = |(name, address)| {
        format!("[[sensor]]\nname = \"{name}\"\nkind = \"mlx90614\"\nbus = \"/dev/i2c-1\"\naddress = {address:#04x}\n")
    };
    SIX.iter().zip(0x5b..).map(mlx).collect()
}

/// A pair for each axis on one ADC whose ALERT/RDY is wired.
pub fn pairs() -> String {
    let pair = |(name, looks, input)| {
        format!(
            "[[sensor]]\nname = \"{name}\"\nkind = \"ads1115\"\nbus = \"/dev/i2c-1\"\naddress = 0x48\ninput = \
             \"{input}\"\nkelvin-per-v = 40.0\ndirection = \"{looks}\"\ndata-ready = {{ chip = \
             \"pinctrl-bcm2711\", line = 17 }}\n"
        )
    };
    [("long", "nose", "ain0"), ("lat", "left", "ain1"), ("vert", "up", "ain2")].map(pair).concat()
}

pub fn sensor(i: usize) -> Sensor {
    Sensor {
        name: SIX[i].into(),
        kind: "mlx90614".into(),
        bus: "/dev/i2c-1".into(),
        address: 0x5b + i as u8,
        direction: SIX[i].into(),
        state: "ok".into(),
        object_c: Some([-3.25, 11.5, 4.0, 4.62, -21.48, 15.3][i]),
        ambient_c: Some(21.5),
        integrity: "pec".into(),
        settling_s: 0.10,
        emissivity: Some(1.0),
        identity: format!("{:016x}", 0x1234_5678_9abc_def0_u64 + i as u64),
        counters: vec![("reads".into(), 180_000)],
        ..Sensor::default()
    }
}

pub fn pair(name: &str, volts: f64) -> Sensor {
    let integrity = "unchecked: sensor has no PEC".into();
    let (kind, bus, state) = ("ads1115".into(), "/dev/i2c-1".into(), "ok".into());
    Sensor { name: name.into(), kind, bus, address: 0x48, state, volts: Some(volts), integrity, ..Sensor::default() }
}

pub fn seen(sensors: Vec<Sensor>) -> Vec<Seen> {
    let system = |s: &Sensor| explain::Facts {
        buses: vec!["/dev/i2c-1".into(), "/dev/i2c-20".into()],
        device: Some(format!("1-{:04x}", s.address)),
        driver: None,
        group: Some(("i2c".into(), 0o660)),
        user: Some("pilot".into()),
    };
    sensors.into_iter().map(|sensor| Seen { system: system(&sensor), sensor }).collect()
}

pub fn nominal(sensors: Vec<Sensor>) -> Status {
    Status {
        version: env!("CARGO_PKG_VERSION").into(),
        method: "field".into(),
        mode: "nominal".into(),
        roll_deg: Some(1.0),
        pitch_deg: Some(2.0),
        roll_sigma_deg: Some(0.8),
        pitch_sigma_deg: Some(0.9),
        measured: true,
        sample_time_usec: 3_600_000_000,
        sample_age_s: 0.0123,
        rate_hz: 50.02,
        sensors,
        endpoints: vec![Endpoint { address: "udpout:127.0.0.1:14550".into(), sent: 184_321, ..Endpoint::default() }],
        ..Status::default()
    }
}

pub fn node() -> Node {
    Node {
        path: "/dev/i2c-1".into(),
        present: true,
        allowed: true,
        group: Some(("i2c".into(), 0o660)),
        user: "pilot".into(),
        member: true,
    }
}

/// Everything as it should be.
pub fn well() -> Facts {
    let sensors: Vec<Sensor> = (0..6).map(sensor).collect();
    Facts {
        file: "/etc/irhorizon/irhorizon.toml".into(),
        configuration: Ok(loaded(&six())),
        asked: BusAddress::System,
        daemon: Ok(nominal(sensors.clone())),
        process: Some(812),
        policy: Some("/usr/share/dbus-1/system.d/org.irhorizon1.conf".into()),
        service: Some(Service {
            load: "loaded".into(),
            active: "active".into(),
            result: "success".into(),
            restarts: 0,
        }),
        nodes: vec![node()],
        adapters: vec![("/dev/i2c-1".into(), Ok(Functions(0x0eff_0009)))],
        sensors: seen(sensors),
        lines: vec![],
        lateness: None,
    }
}

pub const ABSENT: &str =
    "no irhorizond on the system bus: start it with `systemctl start irhorizond`, or give --bus session";

pub fn scene(name: &str) -> Facts {
    let mut f = well();
    let absent = |f: &mut Facts| {
        (f.daemon, f.process) = (Err(Silence::Absent(ABSENT.into())), None);
        f.lateness = Some(Lateness { waits: 40, mean_ms: 0.071, most_ms: 0.32 });
    };
    match name {
        "well" => {}
        // Straight after unpacking.
        "new" => {
            absent(&mut f);
            f.configuration = Err("/etc/irhorizon/irhorizon.toml: there is no such file. Copy the example \
                                   /usr/share/irhorizon/irhorizon.toml there and fit it to your sensors, or name \
                                   another file with --config"
                .into());
            (f.policy, f.lateness) = (None, None);
            f.service = Some(Service { load: "not-found".into(), active: "inactive".into(), ..Service::default() });
            (f.nodes, f.adapters, f.sensors) = (vec![], vec![], vec![]);
        }
        // Wired for the first time: nearly everything that can be wrong is.
        "wiring" => {
            absent(&mut f);
            f.service = Some(Service { load: "loaded".into(), active: "inactive".into(), ..Service::default() });
            f.adapters = vec![("/dev/i2c-1".into(), Ok(Functions(0x0c7f_0000)))];
            f.lateness = Some(Lateness { waits: 40, mean_ms: 1.4, most_ms: 6.25 });
            for x in &mut f.sensors {
                x.sensor.integrity = "unchecked: adapter has no PEC".into();
                x.sensor.counters = vec![("reads".into(), 10)];
            }
            let gone = |s: &mut Sensor, state: &str| {
                *s = Sensor { state: state.into(), object_c: None, ambient_c: None, settling_s: 0.0, ..s.clone() };
                (s.identity, s.integrity) = (String::new(), "none".into());
            };
            gone(&mut f.sensors[0].sensor, "no answer");
            gone(&mut f.sensors[1].sensor, "claimed by a kernel driver");
            f.sensors[1].system.driver = Some("mlx90614".into());
            gone(&mut f.sensors[2].sensor, "error bit set");
            f.sensors[2].sensor.settling_s = 1.33;
            f.sensors[3].sensor.emissivity = Some(0.3);
            f.sensors[4].sensor.counters.push(("out-of-range".into(), 2));
            f.sensors[5].sensor.identity = f.sensors[4].sensor.identity.clone();
            f.sensors[5].sensor.address = 0x70;
        }
        // This user may not open the bus.
        "denied" => {
            absent(&mut f);
            f.nodes = vec![Node { allowed: false, member: false, ..node() }];
            f.adapters = vec![("/dev/i2c-1".into(), Err(BusError::Denied))];
            for x in &mut f.sensors {
                let s = &mut x.sensor;
                *s =
                    Sensor { state: "permission denied".into(), identity: String::new(), settling_s: 0.0, ..s.clone() };
                (s.object_c, s.ambient_c, s.integrity) = (None, None, "none".into());
            }
        }
        // An analogue head with a daemon that has trouble.
        "degraded" => {
            f.configuration = Ok(loaded(&pairs()));
            let mut sensors = vec![pair("long", 0.1), pair("lat", -0.0525), pair("vert", 2.048)];
            sensors[0].counters = vec![("reads".into(), 9_000), ("not-ready".into(), 41)];
            sensors[1].counters = vec![("reads".into(), 9_000)];
            sensors[2].counters = vec![("reads".into(), 8_000), ("out-of-range".into(), 1_000)];
            (sensors[2].state, sensors[2].volts) = ("saturated".into(), None);
            let mut status = nominal(sensors.clone());
            (status.mode, status.rate_hz) = ("faulted".into(), 31.4);
            status.faults = vec![Fault {
                name: "sensor-saturated:vert".into(),
                for_s: 3.0,
                evidence: "saturated, 150 reads in a row".into(),
                advice: irhorizon::ctl::advice::of("sensor-saturated"),
            }];
            status.endpoints[0].last_error = "connection refused".into();
            status.endpoints.push(Endpoint { address: "udpin:127.0.0.1:14551".into(), ..Endpoint::default() });
            (f.daemon, f.sensors) = (Ok(status), seen(sensors));
            f.service.as_mut().unwrap().restarts = 3;
            let settings = |line| irhorizon::config::settings::LineSettings {
                chip: "pinctrl-bcm2711".into(),
                line,
                active_low: false,
            };
            f.lines = vec![
                Line {
                    purpose: "data-ready of long".into(),
                    settings: settings(17),
                    used_by: Ok(Some("irhorizon".into())),
                },
                Line { purpose: "lamp".into(), settings: settings(27), used_by: Ok(Some("fan0".into())) },
            ];
        }
        "simulated" => {
            f.configuration = Ok(loaded("[simulation]\nenabled = true\n[dbus]\nbus = \"session\"\n"));
            let simulated = |s: Sensor| Sensor { kind: "simulated".into(), bus: String::new(), address: 0, ..s };
            f.daemon = Ok(nominal((0..6).map(sensor).map(simulated).collect()));
            (f.asked, f.service, f.policy) = (BusAddress::Session, None, None);
            (f.nodes, f.adapters, f.sensors) = (vec![], vec![], vec![]);
        }
        // It runs, but not where it is asked.
        "elsewhere" => {
            absent(&mut f);
            f.process = Some(812);
            f.configuration = Ok(loaded(&format!("[dbus]\nbus = \"session\"\n{}", six())));
            (f.nodes, f.adapters, f.sensors, f.policy) = (vec![], vec![], vec![], None);
        }
        other => panic!("no scene {other}"),
    }
    f
}

pub const SCENES: [&str; 7] = ["well", "new", "wiring", "denied", "degraded", "simulated", "elsewhere"];
