//! Commands, parameters and time, asked of the daemon on its simulated source by pymavlink. What `tests/setup` installs
//! is needed.

mod asking;
mod process;
mod wire;

use asking::Asked;
use process::{ATTITUDE, HEARTBEAT};
use rustix::process::Signal;

/// MAV_RESULT.
const ACCEPTED: u64 = 0;
const UNSUPPORTED: u64 = 3;
const FAILED: u64 = 4;
/// MAV_STATE.
const ACTIVE: u8 = 4;

/// Time since boot, ms, and roll, °, of so many attitudes at the endpoint beside.
fn flight(asked: &Asked, count: usize) -> Vec<(u32, f64)> {
    let row = |p: Vec<u8>| {
        let roll = f32::from_le_bytes(p[4..8].try_into().unwrap());
        (u32::from_le_bytes(p[..4].try_into().unwrap()), f64::from(roll).to_degrees())
    };
    (0..count).map(|_| row(asked.beside.wait(ATTITUDE))).collect()
}

fn rolls(asked: &Asked, count: usize) -> Vec<f64> {
    flight(asked, count).into_iter().map(|(_, roll)| roll).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn an_interval_is_of_one_endpoint() {
    let asked = Asked::new("none", "", |_| {});
    assert_eq!(asked.answer(&["message-interval", "ATTITUDE", "10"])["result"], ACCEPTED);
    asked.call();
    let (slow, beside) = (asked.peer.attitude_rate(4.0), asked.beside.attitude_rate(2.0));
    println!("asked for: {slow}; beside it: {beside}");
    assert!(slow.is(9.0..=11.0), "{slow}");
    assert!(beside.is(20.0..=55.0), "{beside}");
    assert_eq!(asked.answer(&["get-message-interval", "ATTITUDE"])["interval_us"], 100_000);
    assert_eq!(asked.answer(&["get-message-interval", "GPS_RAW_INT"])["interval_us"], 0);
    let version = asked.answer(&["request-message", "AUTOPILOT_VERSION"]);
    assert_eq!(version["COMMAND_ACK"]["result"], ACCEPTED, "{version}");
    assert!(version["AUTOPILOT_VERSION"]["capabilities"].as_u64().is_some_and(|c| c & 0x2000 != 0), "{version}");
    assert_eq!(asked.answer(&["unsupported"])["result"], UNSUPPORTED);
    let time = asked.answer(&["timesync"]);
    assert!(time["tc1"].as_u64() > Some(0), "{time}");
}

#[test]
fn what_is_for_another_is_not_answered() {
    let asked = Asked::new("none", "", |_| {});
    for to in [["--to", "42", "190"], ["--to", "41", "191"]] {
        for question in [&["unsupported"][..], &["get-message-interval", "ATTITUDE"]] {
            assert_eq!(asked.answer(&[&to[..], question].concat()), serde_json::Value::Null);
        }
    }
    for station in ["1", "42", "255"] {
        assert_eq!(asked.answer(&["--station", station, "unsupported"])["result"], UNSUPPORTED);
    }
    // To everybody: answered where it is something that is done here.
    let report = asked.answer(&["--to", "0", "0", "get-message-interval", "ATTITUDE"]);
    assert!(report["interval_us"].as_i64() > Some(0), "{report}");
    assert_eq!(asked.answer(&["--to", "0", "0", "unsupported"]), serde_json::Value::Null);
}

#[test]
fn a_flight_that_moves_is_no_level_ground() {
    let asked = Asked::new("none", "", |_| {});
    let before = asked.kept();
    let answer = asked.answer(&["calibrate"]);
    assert_eq!(answer["result"], FAILED, "{answer}");
    assert_eq!(asked.kept(), before);
    assert_eq!(asked.parameter("IRH_ROLL_TRIM"), 0.0);
}

/// Roll and pitch, °, on the mean of fifty attitudes from now on.
fn stands(asked: &Asked) -> [f64; 2] {
    asked.beside.forget();
    let attitudes: Vec<[f64; 2]> = (0..50)
        .map(|_| {
            let mut payload = asked.beside.wait(ATTITUDE);
            // Zeros at the end are not sent.
            payload.resize(12, 0);
            [4, 8].map(|at| f64::from(f32::from_le_bytes(payload[at..at + 4].try_into().unwrap())).to_degrees())
        })
        .collect();
    [0, 1].map(|i| mean(&attitudes.iter().map(|a| a[i]).collect::<Vec<_>>()))
}

#[test]
fn level_ground_gives_the_trim_and_it_is_kept() {
    let mut asked = Asked::new("none", "", |folder| {
        std::fs::create_dir(folder.path("irhorizon.toml.d")).unwrap();
        folder.write("irhorizon.toml.d/parked.toml", "[simulation]\nflight = \"parked\"\n");
    });
    let is_active = |heartbeat: Vec<u8>| heartbeat[7] == ACTIVE;
    while !is_active(asked.beside.wait(HEARTBEAT)) {}
    let askew = stands(&asked);
    println!("as mounted {askew:.2?}°");
    assert!((askew[0] - 3.0).abs() < 1.0 && (askew[1] + 2.0).abs() < 1.0, "{askew:?}");

    let answer = asked.answer(&["calibrate"]);
    assert_eq!(answer["result"], ACCEPTED, "{answer}\n{}", asked.daemon.said());
    let steps: Vec<u64> = answer["steps"].as_array().unwrap().iter().map(|s| s.as_u64().unwrap()).collect();
    assert!(steps.len() > 2 && steps[0] == 0 && steps.is_sorted() && steps.last() < Some(&100), "{steps:?}");
    asked.daemon.says("configuration reloaded");
    let parameters = |asked: &Asked| ["IRH_ROLL_TRIM", "IRH_PITCH_TRIM"].map(|name| asked.parameter(name));
    let (trims, level) = (parameters(&asked), stands(&asked));
    println!("trims {trims:.2?}°, then {level:.2?}°");
    for i in [0, 1] {
        assert!((trims[i] - askew[i]).abs() < 0.5 && level[i].abs() < 0.5, "{trims:?} {level:?}");
    }

    asked.restart("", true, Signal::TERM);
    while !is_active(asked.beside.wait(HEARTBEAT)) {}
    assert_eq!(parameters(&asked), trims);
    let level = stands(&asked);
    println!("after a restart {level:.2?}°");
    assert!(level.iter().all(|angle| angle.abs() < 0.5), "{level:?}");
}

#[test]
fn a_trim_is_taken_off_at_once() {
    let (asked, plain) = (Asked::new("none", "", |_| {}), Asked::new("none", "", |_| {}));
    // The same flight twice, each from its first attitude on: a busy machine makes that a few degrees.
    let begun = flight(&asked, 1)[0].0;
    let as_flown = std::thread::spawn(move || flight(&plain, 500));
    let set = asked.answer(&["param-set", "IRH_ROLL_TRIM", "12"]);
    assert_eq!(set["param_value"], 12.0, "{set}");
    std::thread::sleep(std::time::Duration::from_secs(2));
    asked.beside.forget();
    let trimmed = flight(&asked, 50);
    let as_flown = as_flown.join().unwrap();
    let untrimmed = |since: u32| as_flown.iter().min_by_key(|(t, _)| (t - as_flown[0].0).abs_diff(since)).unwrap().1;
    let off: Vec<f64> = trimmed.iter().map(|(time, roll)| untrimmed(time - begun) - roll).collect();
    println!("{:.2}° taken off", mean(&off));
    assert!((mean(&off) - 12.0).abs() < 5.0, "{off:?}");
}

#[test]
fn parameters_are_listed_set_and_kept() {
    let mut asked = Asked::new("none", "", |_| {});
    // From the start, as the simulated flight begins at the start.
    let level = mean(&rolls(&asked, 50));
    let list = asked.answer(&["param-list"]);
    let list = list.as_array().unwrap();
    println!("{} parameters", list.len());
    assert!(list.len() > 20 && list.iter().enumerate().all(|(i, p)| p["param_index"] == i));
    assert!(list.iter().all(|p| p["param_count"] == list.len()));

    asked.call();
    let set = asked.answer(&["param-set", "IRH_ROLL_TRIM", "90"]);
    assert_eq!(set["param_value"], 0.0, "{set}");
    assert!(asked.is_told("IRH_ROLL_TRIM needs"), "{}", asked.daemon.said());
    assert_eq!(asked.kept(), "");

    for (name, value) in [("IRH_ROLL_TRIM", 12.0), ("IRH_E2_VAL_HZ", 4.0)] {
        let set = asked.answer(&["param-set", name, &value.to_string()]);
        assert_eq!(set["param_value"], value, "{set}");
    }
    // The answer comes before the change is taken up.
    let begun = std::time::Instant::now();
    while !(asked.kept().contains("roll-trim-deg = 12\n") && asked.kept().contains("values-hz = 4\n")) {
        assert!(begun.elapsed().as_secs() < 5, "{}", asked.kept());
    }

    asked.restart("", true, Signal::TERM);
    asked.beside.forget();
    let trimmed = mean(&rolls(&asked, 50));
    println!("roll {level:.2}°, then {trimmed:.2}°");
    assert!((level - trimmed - 12.0).abs() < 3.0, "{level} {trimmed}");
    assert_eq!((asked.parameter("IRH_ROLL_TRIM"), asked.parameter("IRH_E2_VAL_HZ")), (12.0, 4.0));

    // An endpoint that is no longer configured does not come back; what else is kept stays.
    asked.restart("", false, Signal::TERM);
    assert_eq!(asked.parameter("IRH_ROLL_TRIM"), 12.0);
    let list = asked.answer(&["param-list"]);
    let names: Vec<&str> = list.as_array().unwrap().iter().map(|p| p["param_id"].as_str().unwrap()).collect();
    assert!(names.contains(&"IRH_E1_VAL_HZ") && !names.contains(&"IRH_E2_VAL_HZ"), "{names:?}");

    // A configuration that has been broken meanwhile: what is set is told to hold, and then told not to.
    let (kept, sound) = (asked.kept(), std::fs::read_to_string(asked.folder.path("irhorizon.toml")).unwrap());
    asked.folder.write("irhorizon.toml", format!("{sound}\noops ="));
    asked.call();
    assert_eq!(asked.answer(&["param-set", "IRH_ROLL_TRIM", "3"])["param_value"], 3.0);
    assert!(asked.is_told("settings refused"), "{}", asked.daemon.said());
    assert_eq!((asked.parameter("IRH_ROLL_TRIM"), asked.kept()), (12.0, kept));
    asked.folder.write("irhorizon.toml", sound);

    // Without the file the configuration holds as it is written, from the next reload on.
    std::fs::remove_file(asked.folder.path("irhorizon.toml.parameters")).unwrap();
    asked.daemon.signal(Signal::HUP);
    asked.daemon.says("configuration reloaded");
    assert_eq!(asked.parameter("IRH_ROLL_TRIM"), 0.0);
}
