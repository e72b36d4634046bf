use super::super::kit::{at, frames, hear, open, until};
use crate::config::settings::EndpointAddress;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::time::Duration;

#[test]
fn it_reaches_servers_of_both_internets_and_hears_them() {
    for address in ["127.0.0.1:0", "[::1]:0"] {
        let server = TcpListener::bind(address).unwrap();
        let to = server.local_addr().unwrap();
        let mut endpoint = open(EndpointAddress::TcpOut(to));
        until(&mut endpoint, at(0.0), |e| e.listening());
        let (mut stream, _) = server.accept().unwrap();
        let frames = frames(50);
        for frame in &frames {
            endpoint.send(at(0.1), frame);
        }
        let mut got = vec![0; frames.concat().len()];
        stream.read_exact(&mut got).unwrap();
        assert_eq!(got, frames.concat());
        stream.write_all(&frames.concat()).unwrap();
        assert_eq!(hear(&mut endpoint, at(0.2), 50), (0..50).collect::<Vec<u8>>());
        endpoint.tend(at(0.3));
        let view = endpoint.stats().view();
        assert_eq!((view.sent, view.failed, view.received, view.peers), (50, 0, 50, 1), "{view:?}");
    }
}

#[test]
fn a_server_that_comes_and_goes_is_regained() {
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let to = server.local_addr().unwrap();
    drop(server);
    let mut endpoint = open(EndpointAddress::TcpOut(to));
    until(&mut endpoint, at(0.0), |e| e.stats().view().last_error.contains("nobody listens there"));
    endpoint.send(at(0.1), b"nobody");
    assert!(!endpoint.listening());
    for round in 0..3 {
        let now = 10.0 * f64::from(round) + 5.0;
        let server = TcpListener::bind(to).unwrap();
        endpoint.tend(at(now));
        until(&mut endpoint, at(now), |e| e.listening());
        assert_eq!(endpoint.stats().view().last_error, "");
        let (mut stream, _) = server.accept().unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        endpoint.send(at(now), b"here");
        stream.read_exact(&mut [0; 4]).unwrap();
        drop((stream, server));
        until(&mut endpoint, at(now + 0.5), |e| !e.listening());
        assert!(endpoint.stats().view().last_error.contains("ended the connection"));
        endpoint.tend(at(now + 0.9));
        assert!(!endpoint.listening(), "tried again before its time");
    }
}

#[test]
fn a_server_that_does_not_answer_is_given_up() {
    // TEST-NET-1 is nobody's: no answer, no way there, or a gateway that refuses in its name.
    let mut endpoint = open(EndpointAddress::TcpOut("192.0.2.1:5760".parse().unwrap()));
    endpoint.send(at(0.5), b"nobody");
    for second in 1..6 {
        endpoint.tend(at(f64::from(second)));
    }
    let view = endpoint.stats().view();
    println!("{view:?}");
    let whys = ["does not answer", "no way", "nobody listens"];
    assert!(whys.iter().any(|why| view.last_error.contains(why)), "{view:?}");
    assert_eq!((view.sent, view.failed, view.peers), (0, 1, 0));
}

#[test]
fn a_server_that_never_reads_gets_whole_frames_and_costs_old_ones() {
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut endpoint = open(EndpointAddress::TcpOut(server.local_addr().unwrap()));
    until(&mut endpoint, at(0.0), |e| e.listening());
    let (mut stream, _) = server.accept().unwrap();
    let frames = frames(256);
    let mut sent = 0;
    while endpoint.stats().view().dropped < 1000 {
        endpoint.send(at(1.0), &frames[sent % 256]);
        sent += 1;
        assert!(sent < 1_000_000, "it all goes somewhere");
    }
    drop(endpoint);
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let mut heard = 0;
    let skipped = crate::mavlink::deframe::Deframer::default().take(&bytes, |_| heard += 1);
    println!("{sent} sent, {heard} heard, {skipped:?}");
    assert!(heard > 100 && skipped.bytes == 0);
}
