//! The attitude monitor for ArduPilot (packaging/lua/irhorizon-monitor.lua), run by Lua 5.3 against
//! strictly faked bindings (tests/lua/). Without Lua these tests fail; they are never skipped.

mod process;

use process::{ATTITUDE, Daemon, Folder, Receiver};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

fn lua(args: &[&str]) -> String {
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/lua/monitor.lua");
    let output = Command::new("lua5.3").arg(script).args(args).output().expect("no Lua 5.3: apt-get install lua5.3");
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

macro_rules! scenarios {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            lua(&[stringify!($name)]);
        })*
        const SCENARIOS: &[&str] = &[$(stringify!($name)),*];
    };
}

scenarios! {
    a_fault_at_the_start_is_tried_again
    a_fault_in_a_binding_does_not_end_the_script
    a_flood_is_taken_in_portions
    agree
    api_4_5
    api_later
    damaged_frames
    differ_briefly
    differ_long
    difference_outlives_a_gap
    feed_lost
    flicker_is_not_told_without_end
    limits_are_parameters
    log_at_10_hz
    mavlink_1
    mavlink_1_wide
    mavlink_2
    mavlink_2_wide
    memory_is_bounded
    no_wrap_error
    nothing_heard
    on_the_ground
    other_senders_are_ignored
    poor_quality
    script_restart
    the_clock_wraps
    withheld_by_quality
    withheld_by_status
    withheld_though_sent
}

#[test]
fn every_scenario_is_run() {
    let list = lua(&["--list"]);
    let mut listed: Vec<&str> = list.lines().collect();
    listed.sort_unstable();
    assert_eq!(listed, SCENARIOS);
}

/// What the monitor has logged after each frame: roll, pitch (°), quality, state.
fn understood(frames: &[Vec<u8>]) -> Vec<[f64; 4]> {
    let folder = Folder::new();
    let mut text = String::new();
    for frame in frames {
        frame.iter().for_each(|b| write!(text, "{b:02x}").unwrap());
        text.push('\n');
    }
    let file = folder.write("frames", text);
    let answer = lua(&["--feed", file.to_str().unwrap()]);
    let number = |w: &str| w.trim_start_matches('-').parse::<f64>().map(|x| if w.starts_with('-') { -x } else { x });
    let row = |l: &str| l.split(' ').map(|w| number(w).unwrap()).collect::<Vec<_>>().try_into().unwrap();
    let rows: Vec<[f64; 4]> = answer.lines().map(row).collect();
    assert_eq!(rows.len(), frames.len(), "{answer}");
    rows
}

#[test]
fn the_daemon_s_own_frames_are_understood() {
    let (folder, receiver) = (Folder::new(), Receiver::new());
    let endpoint = format!("[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:{}\"\n", receiver.port());
    let text = format!("[dbus]\nbus = \"none\"\n[simulation]\nenabled = true\n{endpoint}");
    let _daemon = Daemon::start(&folder, &text);
    let mut frames = Vec::new();
    let mut buffer = [0; 512];
    while frames.len() < 300 {
        let length = receiver.0.recv(&mut buffer).expect("a message within 10 s");
        frames.push(buffer[..length].to_vec());
    }
    let rows = understood(&frames);
    let mut attitudes = 0;
    for (frame, row) in frames.iter().zip(&rows).filter(|(f, _)| f[7] == ATTITUDE) {
        let mut payload = [0; 28];
        payload[..frame.len() - 12].copy_from_slice(&frame[10..frame.len() - 2]);
        let angle = |at: usize| f64::from(f32::from_le_bytes(payload[at..at + 4].try_into().unwrap())).to_degrees();
        assert!((row[0] - angle(4)).abs() < 2e-4 && (row[1] - angle(8)).abs() < 2e-4, "{row:?}");
        attitudes += 1;
    }
    assert!(attitudes > 200, "{attitudes}");
    // The monitor takes a tenth of a second over each, so that a quality is old before the next one comes.
    assert!(rows.iter().any(|r| r[2] > 0.5 && r[3] == 4.0), "no good feed, which agrees with level: {:?}", rows.last());
}

#[test]
fn pymavlink_s_frames_are_understood() {
    let clients = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/clients");
    let setup = Command::new(clients.join("setup")).output().expect("tests/clients/setup runs");
    assert!(setup.status.success(), "no pymavlink, no test: {}", String::from_utf8_lossy(&setup.stderr));
    let program = "
import math
from pymavlink.dialects.v10 import common as one
from pymavlink.dialects.v20 import common as two
signed = two.MAVLink(None, srcSystem=7, srcComponent=191)
signed.signing.secret_key, signed.signing.sign_outgoing, signed.signing.timestamp = b'k' * 32, True, 1
for mav in one.MAVLink(None, srcSystem=7, srcComponent=191), two.MAVLink(None, srcSystem=7, srcComponent=191), signed:
    for roll, pitch in ((25, -12.5), (-170, 80), (0, 0)):
        message = mav.attitude_encode(123456, math.radians(roll), math.radians(pitch), 0, 0, 0, 0)
        print(message.pack(mav).hex())
    print(mav.named_value_float_encode(123456, b'ir_qual', 0.75).pack(mav).hex())
";
    let python = String::from_utf8(setup.stdout).unwrap();
    let output = Command::new(python.trim()).args(["-c", program]).env("MAVLINK20", "1").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let bytes = |l: &str| (0..l.len()).step_by(2).map(|i| u8::from_str_radix(&l[i..i + 2], 16).unwrap()).collect();
    let frames: Vec<Vec<u8>> = String::from_utf8(output.stdout).unwrap().lines().map(bytes).collect();
    assert_eq!(frames.iter().map(|f| f[0]).collect::<Vec<_>>(), [[0xfe; 4], [0xfd; 4], [0xfd; 4]].concat());
    assert_eq!(frames[8][2], 1, "signed");
    for part in understood(&frames).chunks(4) {
        let angles: Vec<_> = part.iter().map(|r| (r[0], r[1])).collect();
        assert_eq!(angles, [(25.0, -12.5), (-170.0, 80.0), (0.0, 0.0), (0.0, 0.0)]);
        assert_eq!(part[3][2], 0.75);
    }
}
