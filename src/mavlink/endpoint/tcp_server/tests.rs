use super::super::Endpoint;
use super::super::kit::{at, frames, hear, open, until};
use super::*;
use crate::config::settings::EndpointAddress;
use std::io::{Read, Write};

fn server(address: &str) -> (Endpoint, SocketAddr) {
    let address = TcpListener::bind(address).unwrap().local_addr().unwrap();
    (open(EndpointAddress::TcpIn(address)), address)
}

fn client(endpoint: &mut Endpoint, address: SocketAddr, now: f64) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    endpoint.receive(at(now), |_| {});
    endpoint.tend(at(now));
    stream
}

/// Whether the other side has ended the connection.
fn ended(stream: &mut TcpStream) -> bool {
    let mut buffer = [0; 4096];
    loop {
        match stream.read(&mut buffer) {
            Ok(0) => return true,
            Ok(_) => {}
            Err(e) => return e.kind() == ErrorKind::ConnectionReset,
        }
    }
}

#[test]
fn clients_of_both_internets_hear_and_are_heard() {
    for address in ["127.0.0.1:0", "[::1]:0"] {
        let (mut endpoint, address) = server(address);
        assert!(!endpoint.listening());
        endpoint.send(at(0.0), b"to nobody");
        let mut clients: Vec<TcpStream> = (0..4).map(|_| client(&mut endpoint, address, 0.0)).collect();
        assert!(endpoint.listening());
        let frames = frames(20);
        for frame in &frames {
            endpoint.send(at(0.1), frame);
        }
        let mut got = vec![0; frames.concat().len()];
        for client in &mut clients {
            client.read_exact(&mut got).unwrap();
            assert_eq!(got, frames.concat());
        }
        for frame in &frames {
            clients[2].write_all(&frame[..7]).unwrap();
            endpoint.receive(at(0.2), |_| {});
            clients[2].write_all(&frame[7..]).unwrap();
            hear(&mut endpoint, at(0.2), 1);
        }
        let view = endpoint.stats().view();
        assert_eq!((view.sent, view.failed, view.received, view.skipped_bytes, view.peers), (80, 0, 20, 0, 4));
        drop(clients);
        until(&mut endpoint, at(0.3), |e| !e.listening());
        assert_eq!(endpoint.stats().view().last_error, "");
    }
}

#[test]
fn a_fifth_client_is_turned_away_unless_one_takes_nothing() {
    let (mut endpoint, address) = server("127.0.0.1:0");
    let mut clients: Vec<TcpStream> = (0..4).map(|_| client(&mut endpoint, address, 0.0)).collect();
    let mut fifth = client(&mut endpoint, address, 0.0);
    assert!(ended(&mut fifth), "there was no room");
    // All read whatever is sent, but the second.
    let frame = &frames(1)[0];
    let mut batch = frame.repeat(100);
    let mut rounds = 0_u32;
    while endpoint.stats().view().dropped == 0 {
        for _ in 0..100 {
            endpoint.send(at(1.0), frame);
        }
        for (_, client) in clients.iter_mut().enumerate().filter(|(i, _)| *i != 1) {
            client.read_exact(&mut batch).unwrap();
        }
        rounds += 1;
        assert!(rounds < 100_000);
    }
    let mut sixth = client(&mut endpoint, address, 3.0);
    assert!(ended(&mut sixth), "stuck for 2 s only");
    let mut seventh = client(&mut endpoint, address, 4.5);
    assert!(ended(&mut clients[1]));
    endpoint.send(at(4.5), frame);
    let mut got = [0; 21];
    seventh.read_exact(&mut got).unwrap();
    assert_eq!(got, frame[..]);
    // Those that stay stuck are given up without another: none of the four takes anything once a batch is lost to all.
    let (mut before, mut rounds) = (0, 0_u32);
    while endpoint.stats().view().dropped < before + 400 {
        before = endpoint.stats().view().dropped;
        for _ in 0..100 {
            endpoint.send(at(5.0), frame);
        }
        rounds += 1;
        assert!(rounds < 100_000);
    }
    endpoint.tend(at(64.0));
    assert_eq!(endpoint.stats().view().peers, 4);
    endpoint.tend(at(66.0));
    assert_eq!(endpoint.stats().view().peers, 0);
}

#[test]
fn a_port_in_use_is_waited_for() {
    let other = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = other.local_addr().unwrap();
    let mut endpoint = open(EndpointAddress::TcpIn(address));
    let view = endpoint.stats().view();
    assert!(view.last_error.contains("in use") && view.last_error.contains(&address.port().to_string()), "{view:?}");
    drop(other);
    endpoint.tend(at(1.0));
    let mut stream = client(&mut endpoint, address, 1.0);
    endpoint.send(at(1.0), b"here");
    stream.read_exact(&mut [0; 4]).unwrap();
}
