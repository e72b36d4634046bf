//! Attitudes flown through on each of the three ways of wiring a head.

use crate::adapter::{Adapter, GpioSim};
use crate::adc::{Converters, Pins};
use crate::flight::{Flight, Sensors, TOLERANCE_DEG, Worst, listener};
use crate::mlx::{ADDRESSES, NAMES, SixMlx, word};
use crate::rig::Daemon;
use crate::sky::{CONTRAST_K, Scheme, pairs_k, six_c};
use rustix::process::Signal;
use serde_json::Value;

/// What every set-up's configuration begins and ends with; the host listens to `name`.
fn config(name: &str, scheme: Scheme, sensors: &str) -> String {
    format!(
        "[daemon]\nrate-hz = {}\n[estimator]\nmethod = \"inverse-sine\"\nrange-time-constant-s = {}\nroll-limit-deg = {}\n{sensors}\
         [[mavlink.endpoint]]\naddress = \"{}\"\n",
        scheme.rate_hz,
        scheme.time_constant_s,
        scheme.roll_limit_deg,
        listener(name)
    )
}

/// So often a flight is begun while the machine stands still.
const FLIGHTS: u32 = 3;

/// Waits until the daemon is nominal, flies, ends it in good order; gives the last status. Where the machine stood still
/// meanwhile another daemon flies again.
fn fly(name: &str, sensors: &mut impl Sensors, scheme: Scheme, config: &str) -> Value {
    for number in 1.. {
        let flight = Flight::begin(name, sensors, scheme);
        let mut daemon = Daemon::start(config);
        daemon.until("nominal", |s| s["mode"] == "nominal");
        let (worst, calm) = flight.fly(&daemon);
        let status = daemon.status();
        daemon.signal(Signal::TERM);
        assert!(daemon.ended().success(), "{}", daemon.said());
        if calm || number == FLIGHTS {
            let Worst { dbus_deg, status_deg } = worst.unwrap_or_else(|what| panic!("{what}\n{}", daemon.said()));
            println!("{name}: worst error {dbus_deg:.3}° on D-Bus, {status_deg:.3}° in status");
            println!("{name}: {} frames a second, wanted {}", status["rate_hz"], scheme.rate_hz);
            return status;
        }
    }
    unreachable!()
}

/// Of each sensor: the words read, and the attempts that failed.
fn counts(status: &Value) -> Vec<(u64, u64)> {
    let sensors = status["sensors"].as_array().unwrap().iter();
    let counts = sensors.map(|sensor| {
        let counters = sensor["counters"].as_array().unwrap().iter();
        let counters = counters.map(|c| (c[0].as_str().unwrap(), c[1].as_u64().unwrap()));
        counters.fold((0, 0), |(reads, failed), (name, count)| match name {
            "reads" => (reads + count, failed),
            _ => (reads, failed + count),
        })
    });
    counts.collect()
}

#[test]
fn six_mlx90614() {
    let bus = Adapter::stub(&ADDRESSES);
    let mut six = SixMlx::new(&bus);
    let scheme = Scheme { rate_hz: 25.0, time_constant_s: 3.0, roll_limit_deg: 180.0 };
    let status = fly("mlx", &mut six, scheme, &config("mlx", scheme, &SixMlx::config(&bus)));
    let sensors = status["sensors"].as_array().unwrap();
    assert_eq!(sensors.len(), 6);
    for (i, sensor) in sensors.iter().enumerate() {
        assert_eq!((&sensor["name"], &sensor["state"]), (&NAMES[i].into(), &"ok".into()));
        assert_eq!(sensor["integrity"], "unchecked: adapter has no PEC", "i2c-stub has none");
        assert_eq!(sensor["settling_s"], 0.10, "IIR 100 %, FIR 1024");
        assert!((sensor["emissivity"].as_f64().unwrap() - 0.98).abs() < 1e-4, "{sensor}");
        assert_eq!(sensor["identity"], format!("1234abcd0001{:04x}", ADDRESSES[i]));
        assert!((sensor["ambient_c"].as_f64().unwrap() - (20.0 + i as f64)).abs() < 0.011, "{sensor}");
    }
    let counts = counts(&status);
    println!("mlx: words read and failures {counts:?}");
    assert!(counts.iter().all(|(reads, failed)| *reads > 500 && *failed == 0), "{status}");
}

/// Three amplified pairs along nose, left and up.
struct Pairs {
    /// For each: the chip's pins, the positive and the negative one (or ground).
    wires: [(Pins, usize, Option<usize>); 3],
    neutral_v: [f64; 3],
    kelvin_per_v: [f64; 3],
}

impl Sensors for Pairs {
    fn columns(&self) -> &'static [&'static str] {
        &["long_v", "lat_v", "vert_v"]
    }

    fn show(&mut self, roll_deg: f64, pitch_deg: f64) -> Vec<f64> {
        let kelvin = pairs_k(roll_deg, pitch_deg);
        let volts: [f64; 3] = std::array::from_fn(|i| self.neutral_v[i] + kelvin[i] / self.kelvin_per_v[i]);
        for ((pins, positive, negative), v) in self.wires.iter().zip(volts) {
            let mut pins = pins.lock().unwrap();
            let common = negative.map_or(0.0, |_| 1.2);
            if let Some(negative) = negative {
                pins[*negative] = common;
            }
            pins[*positive] = common + v;
        }
        volts.to_vec()
    }

    fn pairs_k(&self, raw: &[f64]) -> [f64; 3] {
        std::array::from_fn(|i| (raw[i] - self.neutral_v[i]) * self.kelvin_per_v[i])
    }
}

/// `[[sensor]]` with what the three have in common.
fn pair(bus: &Adapter, name: &str, direction: &str, rest: &str) -> String {
    format!(
        "[[sensor]]\nname = \"{name}\"\nkind = \"ads1115\"\nbus = \"{}\"\ndirection = \"{direction}\"\n\
         data-rate-sps = 64\n{rest}\n",
        bus.path
    )
}

/// The emulation is plain memory that two write: a lost race costs a reading, and must be rare.
fn few_failures(name: &str, status: &Value, conversions: u64) {
    let counts = counts(status);
    println!("{name}: {conversions} conversions, read and failed {counts:?}");
    let (reads, failed) = counts.iter().fold((0, 0), |a, c| (a.0 + c.0, a.1 + c.1));
    assert!(reads > 1000 && failed * 200 <= reads, "{status}");
}

#[test]
fn three_ads1115_polled() {
    let bus = Adapter::stub(&[0x48, 0x49, 0x4a]);
    let (converters, pins) = Converters::start(&bus, &[0x48, 0x49, 0x4a], None);
    let mut pairs = Pairs {
        wires: [(pins[0].clone(), 0, Some(1)), (pins[1].clone(), 2, Some(3)), (pins[2].clone(), 0, Some(3))],
        neutral_v: [0.0, 0.01, -0.02],
        kelvin_per_v: [40.0, -40.0, 50.0],
    };
    let sensors = [
        pair(&bus, "long", "nose", "address = 0x48\ninput = \"ain0-ain1\"\nkelvin-per-v = 40.0"),
        pair(&bus, "lat", "left", "address = 0x49\ninput = \"ain2-ain3\"\nkelvin-per-v = -40.0\nneutral-v = 0.01"),
        pair(&bus, "vert", "up", "address = 0x4a\ninput = \"ain0-ain3\"\nkelvin-per-v = 50.0\nneutral-v = -0.02"),
    ];
    // The report's limit.
    let scheme = Scheme { rate_hz: 15.0, time_constant_s: 3.0, roll_limit_deg: 45.0 };
    let status = fly("polled", &mut pairs, scheme, &config("polled", scheme, &sensors.concat()));
    few_failures("polled", &status, converters.stop());
}

#[test]
fn one_ads1115_multiplexed_with_its_data_ready_line() {
    let bus = Adapter::stub(&[0x48]);
    let gpio = GpioSim::new();
    let line = format!("data-ready = {{ chip = \"{}\", line = 3 }}\n", gpio.chip);
    let (converters, pins) = Converters::start(&bus, &[0x48], Some((gpio, 3)));
    let mut pairs = Pairs {
        wires: [0, 1, 2].map(|pin| (pins[0].clone(), pin, None)),
        neutral_v: [1.65; 3],
        kelvin_per_v: [40.0, 40.0, -40.0],
    };
    let common = format!("address = 0x48\ngain-v = 4.096\nneutral-v = 1.65\n{line}");
    let sensors = [
        pair(&bus, "long", "nose", &format!("{common}input = \"ain0\"\nkelvin-per-v = 40.0")),
        pair(&bus, "lat", "left", &format!("{common}input = \"ain1\"\nkelvin-per-v = 40.0")),
        pair(&bus, "vert", "up", &format!("{common}input = \"ain2\"\nkelvin-per-v = -40.0")),
    ];
    let scheme = Scheme { rate_hz: 12.0, time_constant_s: 10.0, roll_limit_deg: 180.0 };
    let status = fly("multiplexed", &mut pairs, scheme, &config("multiplexed", scheme, &sensors.concat()));
    few_failures("multiplexed", &status, converters.stop());
}

/// Roll and pitch as `status` gives them once they are of `after_s` or later.
/// What is shown once a step, which no aircraft can make, has been eased.
fn angles(daemon: &Daemon, after_s: f64) -> (f64, f64) {
    const EASED_S: f64 = 5.0;
    let eased = |s: &serde_json::Value| s["sample_time_usec"].as_u64().unwrap() as f64 * 1e-6 > after_s + EASED_S;
    let s = daemon.until("a later sample", eased);
    (s["roll_deg"].as_f64().unwrap(), s["pitch_deg"].as_f64().unwrap())
}

#[test]
fn each_sensor_moves_the_angle_that_it_should() {
    let bus = Adapter::stub(&ADDRESSES);
    let mut six = SixMlx::new(&bus);
    let daemon = Daemon::start(&format!("[estimator]\nmethod = \"inverse-sine\"\n{}", SixMlx::config(&bus)));
    daemon.until("nominal", |s| s["mode"] == "nominal");
    let mut show = |words: [u16; 6]| {
        six.write(words);
        angles(&daemon, irhorizon::clock::now().as_secs_f64())
    };
    let level = six_c(0.0, 0.0).map(word);
    let tilt = (5.0 / CONTRAST_K).asin().to_degrees();
    // A sensor 5 K warmer than level: down goes what sees the ground.
    let expected = [(0.0, -tilt), (0.0, tilt), (-tilt, 0.0), (tilt, 0.0), (0.0, 0.0), (0.0, 0.0)];
    for (i, (roll, pitch)) in expected.into_iter().enumerate() {
        let mut words = level;
        words[i] += 250;
        let seen = show(words);
        let near = (seen.0 - roll).abs() <= TOLERANCE_DEG && (seen.1 - pitch).abs() <= TOLERANCE_DEG;
        assert!(near, "{} warmer: {seen:?}, expected {roll} {pitch}", NAMES[i]);
        show(level);
    }
    // Two sensors' words swapped: that angle's sign turns, the other stays.
    let tilted = six_c(12.0, 8.0).map(word);
    let (roll, pitch) = show(tilted);
    assert!(roll > 10.0 && pitch > 6.0, "{roll} {pitch}");
    for (a, b, signs) in [(0, 1, (1.0, -1.0)), (2, 3, (-1.0, 1.0))] {
        let mut swapped = tilted;
        swapped.swap(a, b);
        let seen = show(swapped);
        let near =
            (seen.0 - roll * signs.0).abs() <= TOLERANCE_DEG && (seen.1 - pitch * signs.1).abs() <= TOLERANCE_DEG;
        assert!(near, "{} and {} swapped: {seen:?} after {roll} {pitch}", NAMES[a], NAMES[b]);
    }
}
