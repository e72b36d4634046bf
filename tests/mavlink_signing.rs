//! Messages signed by the daemon and by pymavlink, which checks those of the daemon with its own code. What
//! `tests/setup` installs is needed.

mod asking;
mod process;
mod wire;

use asking::Asked;
use process::{Folder, Receiver};
use rustix::process::Signal;
use serde_json::Value;
use std::os::unix::fs::PermissionsExt;
use std::time::Duration;

const KEY: &str = "signing-key = \"FOLDER/key\"";

/// A key that `mode` allows to read.
fn key(mode: u32) -> impl FnOnce(&Folder) {
    move |folder| {
        let bytes: Vec<u8> = (100..132).collect();
        let path = folder.write("key", bytes);
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
    }
}

/// The signature's timestamp in each frame that comes to `receiver` within `ms`; `None` for one without.
fn stamps(receiver: &Receiver, ms: u64) -> Vec<Option<u64>> {
    let begun = std::time::Instant::now();
    receiver.0.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
    let mut stamps = Vec::new();
    let mut frame = [0; 512];
    while begun.elapsed() < Duration::from_millis(ms) {
        if let Ok(length) = receiver.0.recv(&mut frame) {
            let whole = usize::from(frame[1]) + 12;
            let stamp = |s: &[u8]| s.iter().rev().fold(0, |n, b| n << 8 | u64::from(*b));
            stamps.push((frame[2] == 1 && length == whole + 13).then(|| stamp(&frame[whole + 1..whole + 7])));
        }
    }
    stamps
}

fn kept(asked: &Asked) -> u64 {
    std::fs::read_to_string(asked.folder.path("signing-time")).unwrap().trim().parse().unwrap()
}

#[test]
fn only_what_is_signed_is_heeded() {
    let asked = Asked::new("none", KEY, key(0o600));
    let path = asked.folder.path("key").display().to_string();
    let signed = ["--key", &path];
    // Its frames verify: without a good signature it would not be met.
    let report = asked.report(&[&signed[..], &["get-message-interval", "ATTITUDE"]].concat());
    assert!(report["met"] == true && report["answer"]["interval_us"].as_i64() > Some(0), "{report}");
    assert!(report["signed"]["good"].as_u64() > Some(0) && report["signed"]["bad"] == 0, "{report}");
    assert_eq!(asked.answer(&["--key", &path, "param-set", "IRH_ROLL_TRIM", "3"])["param_value"], 3.0);

    assert_eq!(asked.answer(&["--key", &path, "--unsigned", "param-set", "IRH_ROLL_TRIM", "5"]), Value::Null);
    assert_eq!(asked.answer(&["unsupported"]), Value::Null);
    asked.daemon.says("is refused: it is not signed");
    let other = asked.folder.write("other", [9; 32]).display().to_string();
    assert_eq!(asked.report(&["--key", &other, "--wait", "3", "unsupported"])["met"], false);
    assert_eq!(asked.answer(&["--key", &path, "param-read", "IRH_ROLL_TRIM"])["param_value"], 3.0);

    let answers = asked.answer(&["--key", &path, "replayed"]);
    assert_eq!((&answers[0]["result"], &answers[2]["result"]), (&0.into(), &0.into()), "{answers}");
    assert_eq!(answers[1], Value::Null);
}

#[test]
fn a_key_that_others_may_read_makes_it_silent() {
    let asked = Asked::new("none", KEY, key(0o644));
    asked.daemon.says("MAVLink is silent");
    asked.daemon.says("chmod 600");
    asked.call();
    assert_eq!((stamps(&asked.beside, 2000), stamps(&asked.peer, 200)), (vec![], vec![]));
    assert!(!asked.folder.path("signing-time").exists());
    assert_eq!(asked.daemon.said().matches("MAVLink is silent").count(), 1);

    // Once it is mended a reload is enough.
    std::fs::set_permissions(asked.folder.path("key"), std::fs::Permissions::from_mode(0o600)).unwrap();
    asked.daemon.signal(Signal::HUP);
    asked.daemon.says("configuration reloaded");
    let signed = stamps(&asked.beside, 2000);
    assert!(signed.len() > 20 && signed.iter().all(Option::is_some), "{signed:?}");
}

#[test]
fn timestamps_never_go_back() {
    let mut asked = Asked::new("none", KEY, key(0o600));
    let (mut last, mut before) = (0, 0);
    for end in [Signal::TERM, Signal::KILL, Signal::TERM] {
        let seen: Option<Vec<u64>> = stamps(&asked.beside, 1500).into_iter().collect();
        let seen = seen.expect("every frame is signed");
        assert!(seen.len() > 20 && seen.is_sorted() && seen[0] > last, "{last}, then {seen:?}");
        last = *seen.last().unwrap();
        assert!(kept(&asked) > last && kept(&asked) >= before, "{last} {before}");
        asked.restart(KEY, true, end);
        before = kept(&asked);
    }
    println!("last {last}, kept {before}");
}
