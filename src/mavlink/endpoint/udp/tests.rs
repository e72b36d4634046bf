use super::super::Endpoint;
use super::super::kit::{at, frames, hear, open};
use super::*;
use crate::config::settings::EndpointAddress;
use std::time::{Duration, Instant};

fn receiver(address: &str) -> UdpSocket {
    let socket = UdpSocket::bind(address).unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    socket
}

/// An address that nobody has.
fn free(address: &str) -> SocketAddr {
    UdpSocket::bind(address).unwrap().local_addr().unwrap()
}

/// Takes in what has come, then tends.
fn take(endpoint: &mut Endpoint, now: Time) {
    endpoint.receive(now, |_| {});
    endpoint.tend(now);
}

fn received(socket: &UdpSocket) -> Vec<u8> {
    let mut buffer = [0; 64];
    let length = socket.recv(&mut buffer).unwrap();
    buffer[..length].to_vec()
}

fn nothing(socket: &UdpSocket) -> bool {
    socket.set_nonblocking(true).unwrap();
    let error = socket.recv(&mut [0; 64]).unwrap_err();
    socket.set_nonblocking(false).unwrap();
    error.kind() == ErrorKind::WouldBlock
}

#[test]
fn udpout_reaches_both_internets() {
    for address in ["127.0.0.1:0", "[::1]:0"] {
        let socket = receiver(address);
        let to = socket.local_addr().unwrap();
        let mut endpoint = Endpoint::new(EndpointAddress::UdpOut(to));
        assert!(!endpoint.listening());
        endpoint.send(at(0.0), b"too early");
        endpoint.tend(at(0.0));
        assert!(endpoint.listening());
        endpoint.send(at(0.0), b"fd");
        assert_eq!(received(&socket), b"fd");
        let view = endpoint.stats().view();
        assert_eq!((view.address, view.sent, view.failed), (format!("udpout:{to}"), 1, 1));
    }
}

#[test]
fn nobody_listening_is_noticed_and_does_not_last() {
    let socket = receiver("127.0.0.1:0");
    let to = socket.local_addr().unwrap();
    drop(socket);
    let mut endpoint = Endpoint::new(EndpointAddress::UdpOut(to));
    endpoint.tend(at(0.0));
    for _ in 0..10 {
        endpoint.send(at(0.0), b"lost");
    }
    let view = endpoint.stats().view();
    assert!(view.failed >= 9 && view.sent == 10, "{view:?}");
    assert_eq!(
        view.last_error,
        format!("udpout:{to}: nobody listens there; start the receiver or correct the address")
    );
    assert!(!endpoint.listening());
    take(&mut endpoint, at(0.1));
    let socket = receiver(&to.to_string());
    endpoint.send(at(0.2), b"here");
    assert_eq!(received(&socket), b"here", "not the first one after the refusals");
    endpoint.tend(at(3.05));
    assert!(!endpoint.listening());
    endpoint.tend(at(3.2));
    assert!(endpoint.listening());
    assert_eq!(endpoint.stats().view().last_error, "");
}

#[test]
fn a_port_in_use_is_named_and_tried_again() {
    let other = receiver("127.0.0.1:0");
    let address = other.local_addr().unwrap();
    let mut endpoint = Endpoint::new(EndpointAddress::UdpIn(address));
    endpoint.tend(at(0.0));
    let port = address.port();
    assert_eq!(
        endpoint.stats().view().last_error,
        format!(
            "udpin:127.0.0.1:{port}: the port is in use by another program; choose another port or stop it \
             (ss -lutnp 'sport = :{port}')"
        )
    );
    drop(other);
    endpoint.tend(at(0.9));
    assert!(endpoint.transport.is_none(), "tried again before its time");
    endpoint.tend(at(1.0));
    assert!(endpoint.transport.is_some());
}

#[test]
fn an_address_that_is_not_here_is_waited_for() {
    // TEST-NET-1 is nobody's.
    let mut endpoint = Endpoint::new(EndpointAddress::UdpIn("192.0.2.1:14550".parse().unwrap()));
    for i in 0..5 {
        endpoint.tend(at(f64::from(i)));
        endpoint.send(at(f64::from(i)), b"fd");
    }
    let view = endpoint.stats().view();
    assert!(view.last_error.contains("does not have that address"), "{view:?}");
    assert_eq!(view.failed, 5);
}

fn udpin() -> (Endpoint, SocketAddr) {
    let address = free("127.0.0.1:0");
    (open(EndpointAddress::UdpIn(address)), address)
}

#[test]
fn udpin_sends_to_whom_it_heard_and_forgets_who_is_silent() {
    let (mut endpoint, address) = udpin();
    endpoint.send(at(0.0), b"to nobody");
    let peers: Vec<UdpSocket> = (0..5).map(|_| receiver("127.0.0.1:0")).collect();
    for (i, peer) in peers.iter().take(4).enumerate() {
        peer.send_to(b"hello", address).unwrap();
        take(&mut endpoint, at(i as f64));
    }
    endpoint.send(at(4.0), b"1");
    for peer in peers.iter().take(4) {
        assert_eq!(received(peer), b"1");
    }
    // The first is heard again, so that the second is silent for longest when a fifth comes.
    peers[0].send_to(b"hello", address).unwrap();
    take(&mut endpoint, at(5.0));
    peers[4].send_to(b"hello", address).unwrap();
    take(&mut endpoint, at(6.0));
    endpoint.send(at(7.0), b"2");
    assert!(nothing(&peers[1]));
    for i in [0, 2, 3, 4] {
        assert_eq!(received(&peers[i]), b"2");
    }
    take(&mut endpoint, at(65.5));
    endpoint.send(at(65.5), b"3");
    assert_eq!(received(&peers[4]), b"3");
    assert!([0, 2, 3].iter().all(|i| nothing(&peers[*i])), "sent to the silent");
    take(&mut endpoint, at(70.0));
    assert!(!endpoint.listening());
    let view = endpoint.stats().view();
    assert_eq!((view.sent, view.failed, view.last_error.as_str()), (9, 0, ""));
}

#[test]
fn an_empty_datagram_is_not_the_end_and_a_flood_not_for_ever() {
    let (mut endpoint, address) = udpin();
    let peer = receiver("127.0.0.1:0");
    peer.send_to(b"", address).unwrap();
    let frames = frames(200);
    peer.send_to(&frames[0], address).unwrap();
    assert_eq!(hear(&mut endpoint, at(0.0), 1), [0]);
    assert!(endpoint.listening());
    // Two datagrams of three messages, with noise and a forged length between them.
    for three in frames[1..7].chunks(3) {
        let noise = [0xfd, 0xff, 0x00, 0xfe, 0x07];
        peer.send_to(&[&three[0], &noise[..], &three[1], &three[2]].concat(), address).unwrap();
    }
    assert_eq!(hear(&mut endpoint, at(0.0), 6), [1, 2, 3, 4, 5, 6]);
    assert_eq!(endpoint.stats().view().skipped_bytes, 10);
    for frame in &frames {
        peer.send_to(frame, address).unwrap();
    }
    assert_eq!(hear(&mut endpoint, at(0.0), 200), (0..200).collect::<Vec<u8>>());
    assert_eq!(endpoint.stats().view().received, 207);
}

/// Bytes of 0xfe: each of them may begin a message of 254 bytes whose CRC must be looked at.
#[test]
fn bytes_that_are_costly_to_check_are_taken_in_turns() {
    let (mut endpoint, address) = udpin();
    let peer = receiver("127.0.0.1:0");
    for _ in 0..50 {
        peer.send_to(&[0xfe; 1400], address).unwrap();
    }
    let begun = Instant::now();
    let mut turns = 0;
    while endpoint.stats().view().skipped_bytes < 50 * 1400 {
        endpoint.receive(at(0.0), |_| {});
        turns += 1;
        assert!(begun.elapsed() < Duration::from_secs(30));
    }
    println!("{turns} turns of {:?}", begun.elapsed() / turns);
    assert!(turns > 5, "50 datagrams in {turns} turns");
}

#[test]
fn strangers_do_not_push_out_those_who_go_on_talking() {
    let (mut endpoint, address) = udpin();
    let peers: Vec<UdpSocket> = (0..4).map(|_| receiver("127.0.0.1:0")).collect();
    for second in 0..6 {
        for peer in &peers {
            peer.send_to(b"hello", address).unwrap();
        }
        take(&mut endpoint, at(f64::from(second)));
        for _ in 0..20 {
            receiver("127.0.0.1:0").send_to(b"me", address).unwrap();
        }
        take(&mut endpoint, at(f64::from(second) + 0.5));
    }
    endpoint.send(at(6.0), b"1");
    for peer in &peers {
        assert_eq!(received(peer), b"1");
    }
}

#[test]
fn a_peer_that_went_away_harms_nobody() {
    let (mut endpoint, address) = udpin();
    let (gone, stays) = (receiver("127.0.0.1:0"), receiver("127.0.0.1:0"));
    gone.send_to(b"hello", address).unwrap();
    stays.send_to(b"hello", address).unwrap();
    take(&mut endpoint, at(0.0));
    drop(gone);
    for i in 0..20_u8 {
        endpoint.send(at(0.0), &[i]);
        take(&mut endpoint, at(0.0));
        assert_eq!(received(&stays), [i]);
    }
}
