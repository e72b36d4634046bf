//! An autopilot on the same flight as the head, over a link that is slow and loses messages. Its rates, speeds and
//! noise are those of a simulated flight of the same seed; its clock is its own.

mod voice;

use irhorizon::attitude::Attitude;
use irhorizon::frame::{Aiding, Frame};
use irhorizon::mavlink::aiding::{Ask, Listener};
use irhorizon::mavlink::deframe::datagram;
use irhorizon::mavlink::heard::Heard;
use irhorizon::simulation::{Scenario, SimulatedSource};
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use mavlink::MessageData;
use mavlink::dialects::common::{
    ATTITUDE_DATA, COMMAND_ACK_DATA, GLOBAL_POSITION_INT_DATA, MavResult, TIMESYNC_DATA, VFR_HUD_DATA,
};
use std::collections::BTreeMap;
use std::time::Duration;
use voice::{Voice, WAY};

/// How much longer the way may take.
const JITTER_NS: u64 = 8_000_000;
/// How long the autopilot has been running when the flight begins here: its clock less ours.
const BEHIND: Duration = Duration::from_nanos(987_654_321_987);
/// How often it sends ATTITUDE unasked.
const PERIOD: Duration = Duration::from_millis(20);
/// Its messages are of moments between ours.
const PHASE: Duration = Duration::from_millis(7);

/// The autopilot, and what is on its way from it.
pub struct Autopilot {
    flight: SimulatedSource,
    frame: Frame,
    /// Added to the attitude that it tells.
    pub wrong: Attitude,
    /// Whether it sends ATTITUDE as often as it is asked to.
    pub obliges: bool,
    /// Its nose is where the head's tail is.
    pub backwards: bool,
    /// Speaks as iNav 8 does: rates in degrees a second, pitch and yaw the other way round, climb upside down, positions
    /// stamped in µs.
    pub inav: bool,
    voice: Voice,
    /// How often ATTITUDE is sent in 20 ms: as asked for.
    often: u32,
    /// By their arrival.
    on_the_way: BTreeMap<(Time, u8), Vec<u8>>,
}

impl Autopilot {
    /// On the flight of `scenario` and `seed` that begins at `origin`.
    pub fn new(scenario: &Scenario, seed: u64, origin: Time) -> Self {
        let flight = scenario.source(seed).with_origin(origin);
        let frame = Frame::new(scenario.head().sensors.len());
        Self {
            flight,
            frame,
            wrong: Attitude::default(),
            obliges: true,
            backwards: false,
            inav: false,
            voice: Voice::new(seed),
            often: 1,
            on_the_way: BTreeMap::new(),
        }
    }

    /// Its time, ns, at a moment of ours.
    fn clock(&self, now: Time) -> u64 {
        now.as_nanos() - BEHIND.as_nanos() as u64
    }

    fn send<M: MessageData>(&mut self, now: Time, message: &M) {
        let jitter = Duration::from_nanos((self.voice.chance() * JITTER_NS as f64) as u64);
        if let Some((number, bytes)) = self.voice.say(message) {
            self.on_the_way.insert((now + WAY + jitter, number), bytes);
        }
    }

    /// What it does in the 20 ms that begin at `tick`.
    pub fn step(&mut self, tick: Time) {
        if tick.as_nanos() % 1_000_000_000 < 20_000_000 {
            self.send(tick + PHASE, &voice::heartbeat());
        }
        for i in 0..self.often {
            self.speak(tick + PHASE + PERIOD / self.often * i);
        }
    }

    fn speak(&mut self, now: Time) {
        self.flight.scan(now, &mut self.frame);
        let mut truth = self.flight.truth_at(now);
        if self.backwards {
            truth = Attitude { roll: -truth.roll, pitch: -truth.pitch };
        }
        let aiding = self.frame.aiding;
        if let [Some(p), Some(q), Some(r)] = aiding.gyro_deg_s {
            let [p, q] = if self.backwards { [-p, -q] } else { [p, q] };
            let rates = if self.inav { [p, -q, -r].map(f64::to_degrees) } else { [p, q, r] };
            self.send(now, &voice::attitude(self.clock(now), truth, self.wrong, 1.0, rates));
        }
        let unit_ns = if self.inav { 1000 } else { 1_000_000 };
        self.speeds(now, (self.clock(now) / unit_ns) as u32, &aiding);
    }

    fn speeds(&mut self, now: Time, time_boot_ms: u32, aiding: &Aiding) {
        if let (Some(speed), Some(course), Some(climb)) = (aiding.ground_speed_m_s, aiding.course_deg, aiding.climb_m_s)
        {
            let (east, north) = course.to_radians().sin_cos();
            let down = if self.inav { climb } else { -climb };
            let [vx, vy, vz] = [speed * north, speed * east, down].map(|v| (v * 100.0).round() as i16);
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
                    if self.obliges && command.param1 == ATTITUDE_DATA::ID as f32 {
                        let most = PERIOD.as_micros() as f32 / command.param2;
                        self.often = (most.round() as u32).max(1);
                    }
                    let result = MavResult::MAV_RESULT_ACCEPTED;
                    self.send(there, &COMMAND_ACK_DATA { command: command.command, result });
                }
            }
        }
    }
}
