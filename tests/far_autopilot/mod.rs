//! An autopilot at the far end of a UDP link that is 40 ms long each way and loses one message in five. It flies what
//! a daemon's simulated source flies, and has a clock of its own. What is late here is late on the link: the stamps
//! are right whenever the machine gets round to it.

#[path = "../autopilot/voice.rs"]
mod voice;

use irhorizon::attitude::Attitude;
use irhorizon::clock;
use irhorizon::mavlink::deframe::{Packet, datagram};
use irhorizon::mavlink::heard::Heard;
use irhorizon::simulation::Flight;
use irhorizon::time::Time;
use mavlink::dialects::common::{ATTITUDE_DATA, COMMAND_ACK_DATA, COMMAND_LONG_DATA, MavCmd, MavResult, TIMESYNC_DATA};
use mavlink::{MavlinkVersion, MessageData};
use std::collections::BTreeMap;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;
use voice::{Voice, WAY};

/// Between its words, unasked.
const PERIOD: Duration = Duration::from_millis(20);
/// Its clock less ours, µs.
const CLOCK_USEC: i64 = 3_600_123_457;
/// Over what its rates are differences, s.
const STEP_S: f64 = 1e-4;

/// An ATTITUDE of the daemon.
#[derive(Clone, Copy, Debug)]
pub struct Told {
    pub system: u8,
    pub component: u8,
    /// By its stamp, in the middle of its millisecond.
    pub time: Time,
    pub attitude: Attitude,
    /// °/s about x, y, z.
    pub rates: [f64; 3],
    pub yaw: f32,
}

/// Body rates, °/s, of a flight whose nose does not turn round the vertical.
pub fn body_rates(flight: &Flight, time_s: f64) -> [f64; 3] {
    let (before, after) = (flight.angles(time_s - STEP_S), flight.angles(time_s + STEP_S));
    let [roll_rate, pitch_rate] = [0, 1].map(|i| (after[i] - before[i]).to_degrees() / (2.0 * STEP_S));
    let (sin, cos) = flight.angles(time_s)[0].sin_cos();
    [roll_rate, pitch_rate * cos, -pitch_rate * sin]
}

pub struct FarAutopilot {
    socket: UdpSocket,
    daemon: Option<SocketAddr>,
    flight: Flight,
    origin: Time,
    /// What its own attitude is wrong by.
    pub wrong: Attitude,
    /// Whether it says anything.
    pub talks: bool,
    /// When it last did.
    pub spoke: Time,
    next: Time,
    period: Duration,
    /// When it is to send its next heartbeat.
    beat: Time,
    voice: Voice,
    /// To the daemon, and from it, by their arrival.
    down: BTreeMap<(Time, u8), Vec<u8>>,
    up: Vec<(Time, Question)>,
    /// Which messages it was asked to send, and of how many of these its answer was lost.
    pub asked: Vec<u32>,
    pub unanswered: Vec<u32>,
    pub told: Vec<Told>,
}

#[derive(Clone, Copy, Debug)]
enum Question {
    Time(i64),
    Interval(u32, Duration),
}

impl FarAutopilot {
    /// Listening, with the flight of `seed` yet to begin.
    pub fn new(seed: u64) -> Self {
        Self {
            socket: UdpSocket::bind("127.0.0.1:0").unwrap(),
            daemon: None,
            flight: Flight::demo(seed),
            origin: Time::default(),
            wrong: Attitude::default(),
            talks: true,
            spoke: Time::default(),
            next: Time::default(),
            period: PERIOD,
            beat: Time::default(),
            voice: Voice::new(seed),
            down: BTreeMap::new(),
            up: Vec::new(),
            asked: Vec::new(),
            unanswered: Vec::new(),
            told: Vec::new(),
        }
    }

    pub fn port(&self) -> u16 {
        self.socket.local_addr().unwrap().port()
    }

    /// The flight began at `origin`.
    pub fn took_off(&mut self, origin: Time) {
        self.origin = origin;
        self.next = clock::now();
    }

    /// When the flight began.
    pub fn origin(&self) -> Time {
        self.origin
    }

    /// The attitude truly flown.
    pub fn truth(&self, time: Time) -> Attitude {
        self.flight.attitude(time.since(self.origin))
    }

    /// What the body rates in these words err by, and what they truly are, rms, °/s.
    pub fn rates_off(&self, told: &[Told]) -> [[f64; 3]; 2] {
        let (mut off, mut are) = ([0.0; 3], [0.0; 3]);
        for t in told {
            let truth = body_rates(&self.flight, t.time.since(self.origin));
            for i in 0..3 {
                off[i] += (t.rates[i] - truth[i]).powi(2);
                are[i] += truth[i].powi(2);
            }
        }
        [off, are].map(|sums| sums.map(|sum: f64| (sum / told.len() as f64).sqrt()))
    }

    /// How fast roll and pitch change, °/s.
    pub fn rates(&self, time: Time) -> [f64; 2] {
        let angles = |by_s: f64| self.flight.angles(time.since(self.origin) + by_s);
        let (before, after) = (angles(-STEP_S), angles(STEP_S));
        [0, 1].map(|i| (after[i] - before[i]).to_degrees() / (2.0 * STEP_S))
    }

    fn clock_ns(time: Time) -> i64 {
        time.as_nanos() as i64 + CLOCK_USEC * 1000
    }

    /// `false`: it will not arrive.
    fn send<M: MessageData>(&mut self, at: Time, message: &M) -> bool {
        let said = self.voice.say(message);
        let arrives = said.is_some();
        self.down.extend(said.map(|(number, bytes)| ((at + WAY, number), bytes)));
        arrives
    }

    fn speak(&mut self, at: Time) {
        if at >= self.beat {
            self.send(at, &voice::heartbeat());
            self.beat = at + Duration::from_secs(1);
        }
        let truth = self.truth(at);
        let rates = body_rates(&self.flight, at.since(self.origin));
        let attitude = voice::attitude(Self::clock_ns(at) as u64, truth, self.wrong, 1.25, rates);
        self.send(at, &attitude);
    }

    fn answer(&mut self, at: Time, question: Question) {
        match question {
            Question::Time(ts1) => {
                self.send(at, &TIMESYNC_DATA { tc1: Self::clock_ns(at), ts1 });
            }
            Question::Interval(id, period) => {
                if id == ATTITUDE_DATA::ID {
                    self.period = period;
                }
                let (command, result) = (MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, MavResult::MAV_RESULT_ACCEPTED);
                if !self.send(at, &COMMAND_ACK_DATA { command, result }) {
                    self.unanswered.push(id);
                }
            }
        }
    }

    /// Takes in what the daemon has said, flies on and talks until `end`.
    pub fn run(&mut self, end: Time) {
        let mut buffer = [0; 512];
        while clock::now() < end {
            self.socket.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
            if let Ok((length, from)) = self.socket.recv_from(&mut buffer) {
                self.daemon = Some(from);
                let now = clock::now();
                datagram(&buffer[..length], |packet| self.hear(now, &packet));
            }
            let now = clock::now();
            while self.next <= now {
                let at = self.next;
                if self.talks {
                    self.speak(at);
                }
                self.next = at + self.period;
            }
            let there = self.up.iter().take_while(|(at, _)| *at <= now).count();
            for (at, question) in self.up.drain(..there).collect::<Vec<_>>() {
                self.answer(at, question);
            }
            while let (Some(entry), Some(daemon)) = (self.down.first_entry().filter(|e| e.key().0 <= now), self.daemon)
            {
                let frame = entry.remove();
                if self.talks {
                    self.spoke = now;
                    self.socket.send_to(&frame, daemon).unwrap();
                }
            }
        }
    }

    fn hear(&mut self, now: Time, packet: &Packet<'_>) {
        let question = match packet.id {
            TIMESYNC_DATA::ID => {
                let m = TIMESYNC_DATA::deser(MavlinkVersion::V2, packet.payload).unwrap();
                (m.tc1 == 0).then_some(Question::Time(m.ts1))
            }
            COMMAND_LONG_DATA::ID => {
                let m = COMMAND_LONG_DATA::deser(MavlinkVersion::V2, packet.payload).unwrap();
                assert_eq!((m.target_system, m.target_component), (7, 1), "{m:?}");
                assert_eq!(m.command, MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, "{m:?}");
                self.asked.push(m.param1 as u32);
                Some(Question::Interval(m.param1 as u32, Duration::from_micros(m.param2 as u64)))
            }
            _ => None,
        };
        self.up.extend(question.map(|q| (now + WAY, q)));
        if let Some(Heard::Attitude(m)) = Heard::new(packet) {
            let time = Time::from_nanos(u64::from(m.time_boot_ms) * 1_000_000 + 500_000);
            let attitude = Attitude { roll: f64::from(m.roll), pitch: f64::from(m.pitch) };
            let (system, component) = (packet.system_id, packet.component_id);
            let rates = [m.rollspeed, m.pitchspeed, m.yawspeed].map(|r| f64::from(r).to_degrees());
            self.told.push(Told { system, component, time, attitude, rates, yaw: m.yaw });
        }
    }
}
