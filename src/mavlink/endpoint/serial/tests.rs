use super::super::Endpoint;
use super::super::kit::{at, frames, hear, open};
use crate::config::settings::EndpointAddress;
use rustix::pty::{OpenptFlags, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, tcgetattr};
use std::fs::File;
use std::io::{Read, Write};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// An adapter that is plugged in at `path`: its far end.
fn plug(path: &Path) -> File {
    let far = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    unlockpt(&far).unwrap();
    let name = ptsname(&far, Vec::new()).unwrap().into_string().unwrap();
    let _ = std::fs::remove_file(path);
    symlink(name, path).unwrap();
    File::from(far)
}

fn path(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("irhorizon-{name}-{}", std::process::id()))
}

fn endpoint(path: &Path, baud: u32) -> Endpoint {
    open(EndpointAddress::Serial { path: path.to_owned(), baud })
}

#[test]
fn frames_go_both_ways_unchanged() {
    let path = path("both-ways");
    let mut far = plug(&path);
    // 250000 is a rate that has no constant of its own.
    let mut endpoint = endpoint(&path, 250_000);
    assert!(endpoint.listening(), "{:?}", endpoint.stats().view());
    let tty = tcgetattr(&far).unwrap();
    assert_eq!(tty.output_speed(), 250_000);
    assert!(!tty.local_modes.intersects(LocalModes::ECHO | LocalModes::ICANON | LocalModes::ISIG));
    // With every byte there is: carriage returns, XOFF, interrupts.
    let all: Vec<u8> = (0..=255).collect();
    endpoint.send(at(0.0), &all);
    let mut got = [0; 256];
    far.read_exact(&mut got).unwrap();
    assert_eq!(got[..], all);
    let frames = frames(100);
    for (i, frame) in frames.iter().enumerate() {
        far.write_all(&[b"noise", &frame[..]].concat()).unwrap();
        assert_eq!(hear(&mut endpoint, at(0.1), 1), [i as u8]);
    }
    let view = endpoint.stats().view();
    assert_eq!((view.sent, view.received, view.skipped_bytes, view.peers), (1, 100, 500, 1));
    std::fs::remove_file(path).unwrap();
}

#[test]
fn an_adapter_pulled_out_and_put_back_is_regained_within_a_second() {
    let path = path("plugged");
    let mut endpoint = endpoint(&path, 57_600);
    assert!(endpoint.stats().view().last_error.contains("no such device"), "{:?}", endpoint.stats().view());
    for round in 0..3 {
        let start = 100.0 * f64::from(round);
        // Long enough away that the wait between attempts is the longest.
        for tenth in 1..100 {
            endpoint.tend(at(start + f64::from(tenth) * 0.1));
        }
        assert!(!endpoint.listening());
        let mut far = plug(&path);
        let back = (0..=9).find(|tenth| {
            endpoint.tend(at(start + 10.0 + f64::from(*tenth) * 0.1));
            endpoint.listening()
        });
        assert!(back.is_some(), "not within a second: {:?}", endpoint.stats().view());
        endpoint.send(at(start + 11.0), b"here");
        far.read_exact(&mut [0; 4]).unwrap();
        endpoint.tend(at(start + 15.0));
        assert_eq!(endpoint.stats().view().last_error, "");
        std::fs::remove_file(&path).unwrap();
        drop(far);
        endpoint.receive(at(start + 20.0), |_| {});
        assert!(!endpoint.listening());
        assert!(endpoint.stats().view().last_error.contains("the device has gone"), "{:?}", endpoint.stats().view());
    }
}

#[test]
fn a_far_end_that_never_reads_costs_old_frames_only() {
    let path = path("never-reads");
    let mut far = plug(&path);
    let mut endpoint = endpoint(&path, 57_600);
    let frames = frames(256);
    let mut sent = 0_usize;
    while endpoint.stats().view().dropped < 500 {
        endpoint.send(at(1.0), &frames[sent % 256]);
        sent += 1;
        assert!(sent < 100_000);
    }
    // When it reads again, what it gets are whole frames, the newest at the end.
    let mut deframer = crate::mavlink::deframe::Deframer::default();
    let (mut heard, mut last, mut skipped) = (0, 0, 0);
    let mut buffer = [0; 4096];
    while endpoint.stats().view().sent + endpoint.stats().view().dropped < sent as u64 {
        let bytes = far.read(&mut buffer).unwrap();
        skipped += deframer.take(&buffer[..bytes], |packet| (heard, last) = (heard + 1, packet.sequence)).bytes;
        endpoint.receive(at(1.1), |_| {});
    }
    while last != ((sent - 1) % 256) as u8 {
        let bytes = far.read(&mut buffer).unwrap();
        skipped += deframer.take(&buffer[..bytes], |packet| (heard, last) = (heard + 1, packet.sequence)).bytes;
    }
    assert_eq!((skipped, endpoint.stats().view().sent), (0, heard));
    std::fs::remove_file(path).unwrap();
}

#[test]
fn what_is_no_serial_port_is_named() {
    let file = path("no-tty");
    std::fs::write(&file, "not a tty").unwrap();
    for (path, why) in [
        (file.as_path(), "no serial port"),
        (Path::new("/dev/null"), "no serial port"),
        (Path::new("/tmp"), "no serial port"),
        (Path::new("/nonexistent/tty"), "no such device"),
    ] {
        let endpoint = endpoint(path, 57_600);
        let said = endpoint.stats().view().last_error;
        assert!(said.contains(why), "{}: {said}", path.display());
    }
    assert_eq!(std::fs::read(&file).unwrap(), b"not a tty");
    std::fs::remove_file(file).unwrap();
}
