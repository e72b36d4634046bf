//! Any requests at any times: no panic; each command for this component gets one acknowledgement, at once; what is
//! ordered is good configuration; nothing is answered with a burst.

use irhorizon::attitude::{Attitude, Mode};
use irhorizon::config::Settings;
use irhorizon::config::settings::{EndpointAddress, EndpointSettings, Streams};
use irhorizon::mavlink::deframe::datagram;
use irhorizon::mavlink::encode::Encoder;
use irhorizon::mavlink::heard::Heard;
use irhorizon::mavlink::messages::Message;
use irhorizon::mavlink::service::request::{Request, What};
use irhorizon::mavlink::service::{Ids, Order, Replies, Service, Situation, apply};
use irhorizon::mavlink::session::{Seen, Session};
use irhorizon::state::Moment;
use irhorizon::time::Time;
use std::time::Duration;

const US: Ids = Ids { system: 1, component: 191 };
/// The messages that are requests, with their extra CRC and where their target stands.
const REQUESTS: [(u8, u8, usize); 5] = [(20, 214, 2), (21, 159, 0), (23, 168, 4), (75, 158, 30), (76, 152, 30)];

/// Commands, parameters asked for and set, and requests that go on for long.
pub fn seeds() -> Vec<Vec<u8>> {
    let mut seeds: Vec<Vec<u8>> = Vec::new();
    let command = |number: u16, params: [f32; 7]| {
        let mut payload: Vec<u8> = params.iter().flat_map(|p| p.to_le_bytes()).collect();
        payload.extend(number.to_le_bytes());
        payload.extend([1, 191, 0]);
        [&[4, 3, 3, 33], payload.as_slice()].concat()
    };
    for (number, params) in [
        (241, [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0]),
        (510, [30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (511, [31.0, 1e5, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (512, [396.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (9999, [1.0; 7]),
    ] {
        seeds.push(command(number, params));
    }
    for (name, value) in [("IRH_ROLL_TRIM", 3.0_f32), ("IRH_ON_FAULT", 1.0), ("IRH_E1_ATT_HZ", 5.0)] {
        let mut id = [0; 16];
        id[..name.len()].copy_from_slice(name.as_bytes());
        seeds.push([&[2, 20, 3, 23], value.to_le_bytes().as_slice(), &[1, 191], &id, &[9]].concat());
        seeds.push([[0, 1, 3, 20, 0xff, 0xff, 1, 191].as_slice(), &id].concat());
    }
    seeds.push(vec![1, 1, 3, 2, 1, 191]);
    // Time goes by: a list goes on, a calibration ends.
    let list = [1_u8, 5, 3, 2, 1, 191].repeat(120);
    seeds.push([command(241, [0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0]), list.clone()].concat());
    seeds.push(list);
    seeds
}

/// A byte for the message, one for the time since the last (10 ms), one for flags, one for the length; the payload.
pub fn serve(mut data: &[u8]) {
    let mut settings = Settings::default();
    let address = EndpointAddress::UdpOut(([127, 0, 0, 1], 14550).into());
    settings.mavlink.endpoints = vec![EndpointSettings { address, streams: Streams::default(), tlog: None }];
    let mut now = Time::from_secs_f64(100.0);
    let (mut service, mut session) = (Service::default(), Session::new(now, 0, &Streams::default()));
    let mut encoder = Encoder::new(US.system, US.component);
    let mut seen = Seen::default();
    let mut replies = Replies::default();
    while let Some((&[which, wait, flags, len], rest)) = data.split_first_chunk() {
        let (payload, rest) = rest.split_at(usize::from(len).min(rest.len()));
        data = rest;
        now = now + Duration::from_millis(u64::from(wait) * 10);
        let (id, extra, target) = REQUESTS[usize::from(which) % REQUESTS.len()];
        let mut payload = payload.to_vec();
        if flags & 1 != 0 && payload.len() >= target + 2 {
            payload[target..target + 2].copy_from_slice(&[US.system, US.component]);
        }
        if flags & 2 != 0 {
            let withheld = flags & 4 != 0;
            let mode = if withheld { Mode::Faulted } else { Mode::Nominal };
            let attitude = (!withheld).then(|| Attitude::from_degrees(f64::from(flags), -3.0));
            let sequence = seen.moment.sequence + 1;
            seen.moment = Moment { sequence, written: now, valid_at: now, attitude, mode, ..Moment::default() };
        }
        let at = Situation { now, us: US, settings: &settings, wanted: &settings, seen: &seen, flying: flags & 8 != 0 };
        let (mut asked, mut answered) = (None, 0);
        replies.clear();
        let frame = frame(id, extra, &payload);
        datagram(&frame, |packet| {
            let Some(Heard::Request(request)) = Heard::new(&packet) else { panic!("a request is heard") };
            let from = Ids { system: packet.system_id, component: packet.component_id };
            service.heed(from, &request, &at, &mut session, &mut replies);
            asked = Some(request);
        });
        for message in &replies.messages {
            answered += usize::from(matches!(message, Message::Ack(a) if a.target_system == 255));
            assert!(encoder.encode(message).len() <= 280);
        }
        if let Some(Request { target: US, what: What::Command(_) }) = asked {
            // A calibration that is cancelled is told so as well.
            assert!(answered == 1 || answered == 2, "{replies:?}");
        }
        assert!(replies.messages.len() <= 4 && replies.orders.len() <= 1, "{replies:?}");
        service.step(&at, &mut replies);
        assert!(replies.messages.len() <= 8, "{replies:?}");
        for Order::Set(changes) in std::mem::take(&mut replies.orders) {
            settings = apply(&settings, &changes).expect("what is ordered is good");
        }
    }
}

/// A MAVLink 2 frame of a ground station.
fn frame(id: u8, extra: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![0xfd, payload.len() as u8, 0, 0, 0, 255, 190, id, 0, 0];
    frame.extend(payload);
    let crc = frame[1..].iter().copied().chain([extra]).fold(0xffff, |crc: u16, byte| {
        (0..8).fold(crc ^ u16::from(byte), |c, _| if c & 1 == 1 { (c >> 1) ^ 0x8408 } else { c >> 1 })
    });
    frame.extend(crc.to_le_bytes());
    frame
}
