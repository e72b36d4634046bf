//! An autopilot on the same flight as the head, over a link that is slow and loses messages. Its rates, speeds and
//! noise are those of a simulated flight of the same seed; its clock is its own.

use irhorizon::attitude::Attitude;
use irhorizon::frame::{Aiding, Frame};
use irhorizon::mavlink::aiding::{Ask, Listener};
use irhorizon::mavlink::deframe::datagram;
use irhorizon::mavlink::heard::Heard;
use irhorizon::simulation::{Scenario, SimulatedSource};
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use mavlink::dialects::common::{
    ATTITUDE_DATA, COMMAND_ACK_DATA, GLOBAL_POSITION_INT_DATA, HEARTBEAT_DATA, MavAutopilot, MavResult, TIMESYNC_DATA,
    VFR_HUD_DATA,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use std::collections::BTreeMap;
use std::time::Duration;

/// From the autopilot to us and back, and how much longer it may take.
const WAY: Duration = Duration::from_millis(40);
const JITTER_NS: u64 = 8_000_000;
/// Messages that are lost.
const LOST: f64 = 0.2;
/// How long the autopilot has been running when the flight begins here: its clock less ours.
const BEHIND: Duration = Duration::from_nanos(987_654_321_987);
/// Its messages are of moments between ours.
const PHASE: Duration = Duration::from_millis(7);

/// The autopilot, and what is on its way from it.
pub struct Autopilot {
    flight: SimulatedSource,
    frame: Frame,
    /// Added to the attitude that it tells.
    pub wrong: Attitude,
    chance: u64,
    sequence: u8,
    /// By their arrival.
    on_the_way: BTreeMap<(Time, u8), Vec<u8>>,
}

impl Autopilot {
    /// On the flight of `scenario` and `seed` that begins at `origin`.
    pub fn new(scenario: &Scenario, seed: u64, origin: Time) -> Self {
        let flight = scenario.source(seed).with_origin(origin);
        let frame = Frame::new(scenario.head().sensors.len());
        Self { flight, frame, wrong: Attitude::default(), chance: seed, sequence: 0, on_the_way: BTreeMap::new() }
    }

    fn chance(&mut self) -> f64 {
        self.chance = self.chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.chance >> 33) as f64 / (1_u64 << 31) as f64
    }

    /// Its time, ns, at a moment of ours.
    fn clock(&self, now: Time) -> u64 {
        now.as_nanos() - BEHIND.as_nanos() as u64
    }

    fn send<M: MessageData>(&mut self, now: Time, message: &M) {
        let mut raw = MAVLinkV2MessageRaw::new();
        raw.serialize_message_data(MavHeader { system_id: 7, component_id: 1, sequence: self.sequence }, message);
        self.sequence = self.sequence.wrapping_add(1);
        let jitter = Duration::from_nanos((self.chance() * JITTER_NS as f64) as u64);
        if self.chance() >= LOST {
            self.on_the_way.insert((now + WAY + jitter, self.sequence), raw.raw_bytes().to_vec());
        }
    }

    /// What it does in the 20 ms that begin at `tick`.
    pub fn step(&mut self, tick: Time) {
        let now = tick + PHASE;
        self.flight.scan(now, &mut self.frame);
        let truth = self.flight.truth_at(now);
        let aiding = self.frame.aiding;
        let time_boot_ms = (self.clock(now) / 1_000_000) as u32;
        if tick.as_nanos() % 1_000_000_000 < 20_000_000 {
            let autopilot = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
            self.send(now, &HEARTBEAT_DATA { autopilot, mavlink_version: 3, ..HEARTBEAT_DATA::DEFAULT });
        }
        if let [Some(p), Some(q), Some(r)] = aiding.gyro_deg_s.map(|v| v.map(|v| v.to_radians() as f32)) {
            self.send(
                now,
                &ATTITUDE_DATA {
                    time_boot_ms,
                    roll: (truth.roll + self.wrong.roll) as f32,
                    pitch: (truth.pitch + self.wrong.pitch) as f32,
                    yaw: 1.0,
                    rollspeed: p,
                    pitchspeed: q,
                    yawspeed: r,
                },
            );
        }
        self.speeds(now, time_boot_ms, &aiding);
    }

    fn speeds(&mut self, now: Time, time_boot_ms: u32, aiding: &Aiding) {
        if let (Some(speed), Some(course), Some(climb)) = (aiding.ground_speed_m_s, aiding.course_deg, aiding.climb_m_s)
        {
            let (east, north) = course.to_radians().sin_cos();
            let [vx, vy, vz] = [speed * north, speed * east, -climb].map(|v| (v * 100.0).round() as i16);
            let relative_alt = (aiding.altitude_m.unwrap_or(0.0) * 1000.0) as i32;
            let fix = GLOBAL_POSITION_INT_DATA { time_boot_ms, relative_alt, vx, vy, vz, ..Default::default() };
            self.send(now, &fix);
        }
        if let Some(airspeed) = aiding.airspeed_m_s {
            self.send(now, &VFR_HUD_DATA { airspeed: airspeed as f32, ..VFR_HUD_DATA::DEFAULT });
        }
    }

    /// Gives `listener` all that has arrived by `now`, at its moments, and takes what it asks.
    pub fn talk(&mut self, now: Time, listener: &mut Listener) {
        while let Some(entry) = self.on_the_way.first_entry().filter(|e| e.key().0 <= now) {
            let arrival = entry.key().0;
            datagram(&entry.remove(), |p| listener.hear(arrival, 0, &p, Heard::new(&p).as_ref()));
        }
        while let Some(ask) = listener.ask(now, 0) {
            // It arrives, and is answered, later.
            let there = now + WAY;
            match ask {
                Ask::Time(question) => {
                    let tc1 = self.clock(there) as i64;
                    self.send(there, &TIMESYNC_DATA { tc1, ts1: question.ts1 });
                }
                Ask::Interval(command) => {
                    let result = MavResult::MAV_RESULT_ACCEPTED;
                    self.send(there, &COMMAND_ACK_DATA { command: command.command, result });
                }
            }
        }
    }
}
