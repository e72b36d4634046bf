use super::*;
use crate::mavlink::deframe::datagram;
use crate::mavlink::encode::Encoder;
use crate::mavlink::messages;
use ::mavlink::dialects::common::MavState;
use proptest::prelude::*;

fn key() -> Key {
    Key::new(std::array::from_fn(|i| i as u8))
}

fn signing() -> Signing {
    Signing::new(key(), 0, 0)
}

/// A signed heartbeat of 1/191 on link 3 with the timestamp `stamp`.
fn heartbeat(key: Key, link: u8, stamp: u64) -> Vec<u8> {
    let mut encoder = Encoder::new(1, 191);
    let mut signing = Signing::new(key, stamp, 0);
    encoder.encode_signed(&messages::heartbeat(MavState::MAV_STATE_ACTIVE), &mut signing, link, 0).to_vec()
}

fn check(signing: &mut Signing, bytes: &[u8], wall: u64) -> Result<(), Refused> {
    let mut outcome = None;
    datagram(bytes, |p| outcome = Some(signing.check(&p, wall)));
    outcome.expect("the CRC holds")
}

/// pymavlink 2.4.50 signs the same heartbeat with the same key, link and timestamp as these bytes, and Python's hashlib
/// finds the last six of them:
///
/// ```text
/// signed = bytes.fromhex("fd0901000001bf000000000000001208000403493e" "03" "060504030201")
/// hashlib.sha256(bytes(range(32)) + signed).hexdigest()[:12]
/// ```
#[test]
fn the_signature_is_the_one_that_python_finds() {
    let frame = heartbeat(key(), 3, 0x0102_0304_0506);
    let hex: String = frame.iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(hex, VECTOR);
}

const VECTOR: &str = "fd0901000001bf000000000000001208000403493e03060504030201e62ad56138f5";

#[test]
fn timestamps_count_from_2015() {
    let at = |secs: u64| timestamp(SystemTime::UNIX_EPOCH + Duration::from_secs(secs));
    assert_eq!([at(0), at(1_420_070_400), at(1_420_070_401)], [0, 0, 100_000]);
    assert_eq!(timestamp(SystemTime::UNIX_EPOCH - Duration::from_secs(1)), 0);
    assert_eq!(at(1 << 40), (1 << 48) - 1);
}

#[test]
fn timestamps_only_rise_also_when_the_clock_steps_back_an_hour() {
    let mut signing = Signing::new(key(), 500, 0);
    let walls = [1000, 1000, 1001, 2000, 1100, 5, 0, 3000, u64::MAX, 7];
    let stamps: Vec<u64> = walls.map(|wall| signing.stamp(wall)).to_vec();
    assert_eq!(stamps[..8], [1000, 1001, 1002, 2000, 2001, 2002, 2003, 3000]);
    assert_eq!(Signing::new(key(), 500, 0).stamp(0), 500);
}

#[test]
fn what_is_not_signed_or_by_another_key_is_refused() {
    let mut encoder = Encoder::new(1, 191);
    let plain = encoder.encode(&messages::heartbeat(MavState::MAV_STATE_ACTIVE)).to_vec();
    assert_eq!(check(&mut signing(), &plain, 0), Err(Refused::Unsigned));
    let mut v1 = vec![0xfe, 9, 7, 3, 1, 0, 0, 0, 0, 0, 2, 3, 0, 4, 3];
    v1.extend(::mavlink::calculate_crc(&v1[1..], 50).to_le_bytes());
    assert_eq!(check(&mut signing(), &v1, 0), Err(Refused::Unsigned));
    assert_eq!(check(&mut signing(), &heartbeat(Key::new([9; 32]), 0, 5), 0), Err(Refused::Wrong));
    assert_eq!(check(&mut signing(), &heartbeat(key(), 0, 5), 0), Ok(()));
}

#[test]
fn every_changed_byte_behind_the_crc_is_noticed() {
    let good = heartbeat(key(), 3, 77);
    for i in good.len() - SIGNATURE..good.len() {
        let mut bad = good.clone();
        bad[i] ^= 0x10;
        assert_eq!(check(&mut signing(), &bad, 0), Err(Refused::Wrong), "byte {i}");
    }
}

#[test]
fn what_was_sent_before_is_refused_on_its_link_alone() {
    let mut signing = signing();
    let mut hear = |link, stamp| check(&mut signing, &heartbeat(key(), link, stamp), 0);
    assert_eq!(hear(1, 100), Ok(()));
    assert_eq!(hear(1, 100), Err(Refused::Replayed));
    assert_eq!(hear(1, 99), Err(Refused::Replayed));
    assert_eq!(hear(2, 99), Ok(()));
    assert_eq!(hear(1, 101), Ok(()));
}

#[test]
fn a_new_sender_may_be_a_minute_behind_and_not_more() {
    let wall = 100 * MINUTE;
    assert_eq!(check(&mut signing(), &heartbeat(key(), 0, wall - MINUTE), wall), Ok(()));
    assert_eq!(check(&mut signing(), &heartbeat(key(), 0, wall - MINUTE - 1), wall), Err(Refused::Old));
    // Without a clock of its own the newest message heard is the clock.
    let mut signing = signing();
    assert_eq!(check(&mut signing, &heartbeat(key(), 0, wall), 0), Ok(()));
    assert_eq!(check(&mut signing, &heartbeat(key(), 1, wall - MINUTE - 1), 0), Err(Refused::Old));
    assert_eq!(signing.stamp(0), wall);
}

#[test]
fn the_list_of_senders_is_bounded_and_makes_room_for_the_new() {
    let mut signing = signing();
    for link in 0..=255 {
        assert_eq!(check(&mut signing, &heartbeat(key(), link, 1000 + u64::from(link)), 0), Ok(()));
    }
    let mut encoder = Encoder::new(7, 1);
    let mut other = Signing::new(key(), 2000, 0);
    let heartbeat = messages::heartbeat(MavState::MAV_STATE_ACTIVE);
    let frame = encoder.encode_signed(&heartbeat, &mut other, 0, 0).to_vec();
    assert_eq!(check(&mut signing, &frame, 2000), Err(Refused::TooMany));
    let frame = encoder.encode_signed(&heartbeat, &mut other, 0, 2 * MINUTE).to_vec();
    assert_eq!(check(&mut signing, &frame, 2 * MINUTE), Ok(()));
}

#[test]
fn nothing_shows_the_key() {
    let shown = format!("{:?}", Signing::new(Key::new([0xa5; 32]), 0, 0));
    assert!(!shown.contains("165") && !shown.to_lowercase().contains("a5"), "{shown}");
}

proptest! {
    #[test]
    fn what_one_signs_the_other_heeds_once(
        secret: [u8; 32], link: u8, walls in prop::collection::vec(0_u64..1 << 48, 1..20),
    ) {
        let (mut ours, mut theirs) = (Signing::new(Key::new(secret), 0, 0), Signing::new(Key::new(secret), 0, 0));
        let mut encoder = Encoder::new(1, 191);
        for wall in walls {
            let frame = encoder.encode_signed(&messages::autopilot_version(), &mut ours, link, wall).to_vec();
            if ours.sent() < LAST {
                prop_assert_eq!(check(&mut theirs, &frame, 0), Ok(()));
            }
            prop_assert_eq!(check(&mut theirs, &frame, 0), Err(Refused::Replayed));
        }
    }
}
