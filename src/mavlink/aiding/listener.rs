//! All that is heard of the autopilot, and all that it is asked. Time comes in as an argument.

use super::choice::{Choice, Source};
use super::climb::Climb;
use super::clock::Clock;
use super::decode::{Stamp, Words, decode, rates};
use super::intervals::Intervals;
use super::meter::Meter;
use super::sense::Sense;
use super::timesync::Asker;
use crate::aiding::{Inbox, Link, Said, What};
use crate::config::settings::{EndpointAddress, MavlinkSettings};
use crate::frame::Aiding;
use crate::mavlink::deframe::Packet;
use crate::mavlink::heard::Heard;
use crate::mavlink::identity::{Identity, Notice};
use crate::time::Time;
use ::mavlink::dialects::common::{COMMAND_ACK_DATA, COMMAND_LONG_DATA, MavCmd, TIMESYNC_DATA};
use std::sync::Arc;

/// Rates, and everything else, older than this when they arrive are dropped, s.
const RATES_OLD_S: f64 = 0.5;
const SLOW_OLD_S: f64 = 2.5;
/// A position that seems to be older has no stamp, s.
const STRAY_S: f64 = 60.0;
/// While positions come this often, what says less of the same is not heeded, s.
const POSITION_S: f64 = 1.0;
/// While no rates with such stamps come for so long, a clock goes by those of positions, s.
const DRIVEN_S: f64 = 5.0;
/// Faster than anybody walks, m/s; so long after that it may still fly, s.
const WALK_M_S: f64 = 3.0;
const MOVED_S: f64 = 10.0;
/// Where COMMAND_ACK says for whom it is, where it does: system, component.
const ACK_TARGET: (usize, usize) = (8, 9);

/// What the autopilot is asked.
#[derive(Clone, Debug, PartialEq)]
pub enum Ask {
    /// TIMESYNC (111): its time.
    Time(TIMESYNC_DATA),
    /// COMMAND_LONG (76): to send a message at an interval.
    Interval(COMMAND_LONG_DATA),
}

/// Listens to one autopilot.
#[derive(Debug)]
pub struct Listener {
    identity: Identity,
    component_id: u8,
    /// How often ATTITUDE is asked for, Hz.
    rates_hz: f64,
    endpoints: Vec<EndpointAddress>,
    inbox: Arc<Inbox>,
    link: Link,
    boot: Clock,
    epoch: Clock,
    asker: Asker,
    choice: Choice,
    sense: Sense,
    climb: Climb,
    intervals: Intervals,
    rates: Meter,
    gps: Meter,
    air: Meter,
    /// The newest stamps of rates and of fixes: what comes twice counts once.
    newest: [Option<Time>; 2],
    /// When rates came last that have a stamp since its start, or since 1970.
    driven: [Option<Time>; 2],
    /// Whether the GPS has a fix, and when it said so.
    fix: Option<(bool, Time)>,
    positioned: Option<Time>,
    /// Its yaw, rad clockwise from north, and when it arrived.
    yaw: Option<(f64, Time)>,
    /// When it moved faster than anybody walks.
    moved: Option<Time>,
    /// Where the autopilot was heard last.
    endpoint: usize,
}

/// Where the autopilot may be asked, and for how many rates a second: two for each frame, so that the newest is less old;
/// what the aircraft has done since is a guess.
fn wanted(settings: &MavlinkSettings, rate_hz: f64) -> (Vec<EndpointAddress>, f64) {
    let endpoints = settings.endpoints.iter().map(|e| e.address.clone()).collect();
    (endpoints, settings.rates_hz.min(2.0 * rate_hz))
}

impl Listener {
    /// As `[mavlink]` says, for a daemon of `rate_hz`. What is heard goes to `inbox`.
    pub fn new(settings: &MavlinkSettings, rate_hz: f64, inbox: Arc<Inbox>) -> Self {
        let (endpoints, rates_hz) = wanted(settings, rate_hz);
        Self {
            identity: Identity::new(settings.system_id, settings.autopilot_id),
            component_id: settings.component_id,
            rates_hz,
            intervals: Intervals::new(rates_hz, &endpoints),
            endpoints,
            inbox,
            link: Link { aids: settings.aiding, ..Link::default() },
            boot: Clock::default(),
            epoch: Clock::default(),
            asker: Asker::default(),
            choice: Choice::default(),
            sense: Sense::default(),
            climb: Climb::default(),
            rates: Meter::default(),
            gps: Meter::default(),
            air: Meter::default(),
            newest: [None; 2],
            driven: [None; 2],
            fix: None,
            positioned: None,
            yaw: None,
            moved: None,
            endpoint: 0,
        }
    }

    /// A new configuration. What is known of the autopilot stays, unless another one is asked for.
    pub fn configure(&mut self, settings: &MavlinkSettings, rate_hz: f64) {
        let mut identity = self.identity.clone();
        identity.configure(settings.system_id, settings.autopilot_id);
        if identity.autopilot() != self.identity.autopilot() {
            *self = Self::new(settings, rate_hz, Arc::clone(&self.inbox));
            self.inbox.tell(self.link);
            return;
        }
        self.identity = identity;
        self.component_id = settings.component_id;
        self.link.aids = settings.aiding;
        let (endpoints, rates_hz) = wanted(settings, rate_hz);
        if endpoints != self.endpoints || rates_hz != self.rates_hz {
            (self.endpoints, self.rates_hz) = (endpoints, rates_hz);
            self.intervals = Intervals::new(rates_hz, &self.endpoints);
        }
        self.inbox.tell(self.link);
    }

    /// Who is who.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Takes in a message that has arrived at `now` at endpoint number `endpoint`; `heard` is what it holds.
    pub fn hear(&mut self, now: Time, endpoint: usize, packet: &Packet<'_>, heard: Option<&Heard>) {
        match self.identity.hear(packet) {
            Notice::Nothing => {}
            Notice::Autopilot(id) => {
                log::info!("listening to the autopilot of system {id}");
                if !self.identity.is_aeroplane() {
                    log::info!("it flies no aeroplane: its GPS and airspeed tell nothing of bank and pitch");
                }
            }
            Notice::Another(id) => {
                log::warn!("another autopilot, of system {id}, is not listened to: choose one with autopilot-id");
            }
        }
        if !self.identity.is_of_autopilot(packet) {
            return;
        }
        self.endpoint = endpoint;
        self.intervals.heard(now, endpoint, packet.id);
        match heard {
            Some(Heard::CommandAck(m)) if self.is_for_us(packet, ACK_TARGET) => self.acknowledged(endpoint, m),
            Some(Heard::Timesync(m)) => {
                if let Some(asked) = self.asker.answer(m) {
                    self.boot.answered(asked, m.tc1, now);
                }
            }
            Some(heard) => self.listen(now, heard),
            None => {}
        }
        self.link = Link {
            system: self.identity.autopilot(),
            heard: now,
            rates_hz: self.rates.hz(now),
            gps_hz: self.gps.hz(now),
            airspeed_hz: self.air.hz(now),
            synced: self.boot.is_synced(),
            ..self.link
        };
        self.inbox.tell(self.link);
    }

    /// Its yaw, rad clockwise from north, heard within half a second.
    pub fn yaw(&self, now: Time) -> Option<f32> {
        self.yaw.filter(|(_, at)| now.since(*at) <= RATES_OLD_S).map(|(yaw, _)| yaw as f32)
    }

    /// Whether the aircraft flies, or may: its motors are armed, or it moved lately.
    pub fn flying(&self, now: Time) -> bool {
        self.identity.is_armed() || self.moved.is_some_and(|at| now.since(at) <= MOVED_S)
    }

    /// What the autopilot is to be asked at `endpoint` now; to be called until there is nothing more.
    pub fn ask(&mut self, now: Time, endpoint: usize) -> Option<Ask> {
        let system = self.identity.autopilot()?;
        if endpoint == self.endpoint
            && let Some(question) = self.asker.ask(now)
        {
            return Some(Ask::Time(question));
        }
        if !self.link.aids {
            return None;
        }
        self.intervals.ask(now, endpoint, system).map(Ask::Interval)
    }

    fn is_for_us(&self, packet: &Packet<'_>, (system, component): (usize, usize)) -> bool {
        let ours = |at: usize, own: u8| packet.payload.get(at).is_none_or(|to| *to == 0 || *to == own);
        ours(system, self.identity.system_id()) && ours(component, self.component_id)
    }

    fn acknowledged(&mut self, endpoint: usize, m: &COMMAND_ACK_DATA) {
        if m.command == MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL {
            self.intervals.answered(endpoint, m.result);
        }
    }

    fn listen(&mut self, now: Time, heard: &Heard) {
        let Some((stamp, words)) = decode(heard, self.identity.is_ardupilot()) else { return };
        let is_rates = matches!(words, Words::Attitude(..) | Words::Rates(..));
        let Some(time) = self.moment(now, stamp, is_rates) else { return };
        // What would be so old was stamped in another unit (iNav: µs).
        let stray = matches!(words, Words::Position(_)) && now.since(time) > STRAY_S;
        let time = if stray { self.moment(now, Stamp::None, false).unwrap_or(now) } else { time };
        let age_s = now.since(time);
        match words {
            Words::Rates(source, rate) if age_s <= RATES_OLD_S => self.rates(now, time, source, rate),
            Words::Attitude(attitude, yaw, said) if age_s <= RATES_OLD_S => {
                self.yaw = Some((yaw, now));
                self.say(now, time, What::Attitude(attitude, yaw));
                let rate = said.and_then(|said| self.sense.hear(time, attitude, said));
                if let Some(rate) = rate.and_then(rates) {
                    self.rates(now, time, Source::Attitude, rate);
                }
            }
            Words::Position(aiding) if age_s <= SLOW_OLD_S && aiding.ground_speed_m_s.is_some() => {
                self.positioned = Some(now);
                let climb = aiding.altitude_m.zip(aiding.climb_m_s);
                let climb_m_s = climb.map(|(altitude_m, said)| self.climb.hear(time, altitude_m, said));
                let aiding = Aiding { climb_m_s, ..aiding };
                // Without a fix the filter's velocity is not the GPS's.
                let no_fix = self.fix.is_some_and(|(fix, at)| !fix && now.since(at) <= SLOW_OLD_S);
                if !no_fix {
                    self.fixed(now, time, aiding);
                }
            }
            Words::Fix(fix) => {
                self.fix = Some((fix.is_some(), now));
                if let Some(aiding) = fix.filter(|_| age_s <= SLOW_OLD_S && !self.has_position(now)) {
                    self.fixed(now, time, aiding);
                }
            }
            Words::Air(aiding) => {
                if aiding.airspeed_m_s.is_some() {
                    self.air.count(now);
                }
                let climb_m_s = aiding.climb_m_s.filter(|_| !self.has_position(now));
                self.slow(now, time, Aiding { climb_m_s, ..aiding });
            }
            Words::Rates(..) | Words::Attitude(..) | Words::Position(..) => {}
        }
    }

    fn has_position(&self, now: Time) -> bool {
        self.positioned.is_some_and(|at| now.since(at) <= POSITION_S)
    }

    /// When that was, on our clock.
    fn moment(&mut self, now: Time, stamp: Stamp, is_rates: bool) -> Option<Time> {
        let sent = match stamp {
            Stamp::Millis(ms) => self.boot.of_millis(ms),
            Stamp::Micros(usec) | Stamp::Epoch(usec) => i64::try_from(usec).ok()?.checked_mul(1000)?,
            Stamp::None => {
                let way_s = self.boot.delay_s(now);
                return Some(Time::from_secs_f64(now.as_secs_f64() - way_s));
            }
        };
        let dated = matches!(stamp, Stamp::Epoch(_));
        let clock = if dated { &mut self.epoch } else { &mut self.boot };
        let driven = &mut self.driven[usize::from(dated)];
        if is_rates {
            *driven = Some(now);
        }
        // A position has the stamp of its fix, which may have been some time ago.
        let drives = driven.is_none_or(|at| is_rates || now.since(at) > DRIVEN_S);
        let began = drives && clock.arrived(now, sent);
        let moment = clock.ours(now, sent);
        // Of an autopilot that knows the date since now, not one that has begun anew.
        if began && !dated {
            log::info!("the autopilot's clock has begun anew");
            self.asker = Asker::default();
            (self.sense, self.climb) = (Sense::default(), Climb::default());
            self.intervals.restart();
            self.newest = [None; 2];
        }
        moment
    }

    /// Whether a stamp is newer than all before.
    fn is_new(&mut self, kind: usize, time: Time) -> bool {
        let new = self.newest[kind].is_none_or(|newest| time > newest);
        self.newest[kind] = self.newest[kind].max(Some(time));
        new
    }

    fn rates(&mut self, now: Time, time: Time, source: Source, rate: [f64; 3]) {
        if self.choice.heeds(source, now) {
            if self.is_new(0, time) {
                self.rates.count(now);
            }
            self.say(now, time, What::Rates(rate));
        }
    }

    fn fixed(&mut self, now: Time, time: Time, aiding: Aiding) {
        if aiding.ground_speed_m_s.is_some_and(|speed| speed > WALK_M_S) {
            self.moved = Some(now);
        }
        if self.is_new(1, time) {
            if aiding.ground_speed_m_s.is_some() {
                self.gps.count(now);
            }
            self.slow(now, time, aiding);
        }
    }

    /// What does not turn by banking tells nothing of its attitude by where it goes.
    fn slow(&self, now: Time, time: Time, aiding: Aiding) {
        let nothing = Aiding { altitude_m: aiding.altitude_m, ..Aiding::default() };
        self.say(now, time, What::Slow(if self.identity.is_aeroplane() { aiding } else { nothing }));
    }

    fn say(&self, now: Time, time: Time, what: What) {
        self.inbox.push(Said { time, arrived: now, what });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Settings;
    use ::mavlink::dialects::common::{
        ATTITUDE_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA, GpsFixType, HEARTBEAT_DATA, MavAutopilot, MavType,
        VFR_HUD_DATA,
    };
    use ::mavlink::{MavlinkVersion, MessageData};

    fn hear<D: MessageData>(listener: &mut Listener, data: &D) {
        let mut buffer = [0; 255];
        let length = data.ser(MavlinkVersion::V2, &mut buffer);
        let (payload, signature) = (&buffer[..length], None);
        let packet =
            Packet { bytes: &[], v2: true, system_id: 3, component_id: 1, sequence: 0, id: D::ID, payload, signature };
        listener.hear(Time::from_secs_f64(50.0), 0, &packet, Heard::new(&packet).as_ref());
    }

    #[test]
    fn only_an_aeroplane_tells_by_where_it_goes() {
        let autopilot = MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA;
        for (mavtype, tells) in [(MavType::MAV_TYPE_FIXED_WING, true), (MavType::MAV_TYPE_QUADROTOR, false)] {
            let inbox = Arc::new(Inbox::default());
            let mut listener = Listener::new(&Settings::default().mavlink, 50.0, Arc::clone(&inbox));
            hear(&mut listener, &HEARTBEAT_DATA { autopilot, mavtype, ..HEARTBEAT_DATA::DEFAULT });
            let fix = GLOBAL_POSITION_INT_DATA {
                relative_alt: 90_000,
                vx: 1500,
                vz: -100,
                ..GLOBAL_POSITION_INT_DATA::DEFAULT
            };
            hear(&mut listener, &fix);
            hear(&mut listener, &VFR_HUD_DATA { airspeed: 16.0, ..VFR_HUD_DATA::DEFAULT });
            let mut said = Vec::new();
            assert!(listener.flying(Time::from_secs_f64(50.0)) && inbox.take(&mut said).system == Some(3));
            let slow = |what: &What| if let What::Slow(aiding) = what { Some(*aiding) } else { None };
            let slow: Vec<_> = said.iter().filter_map(|s| slow(&s.what)).collect();
            assert_eq!(slow.len(), 2, "{said:?}");
            for (told, what) in [
                (slow[0].course_deg, "course"),
                (slow[0].ground_speed_m_s, "speed"),
                (slow[0].climb_m_s, "climb"),
                (slow[1].airspeed_m_s, "airspeed"),
            ] {
                assert_eq!(told.is_some(), tells, "{what} of {mavtype:?}");
            }
            assert_eq!(slow[0].altitude_m, Some(90.0));
        }
    }

    #[test]
    fn a_fix_stamped_since_1970_is_heard_beside_an_attitude_stamped_since_the_start() {
        let inbox = Arc::new(Inbox::default());
        let mut listener = Listener::new(&Settings::default().mavlink, 50.0, Arc::clone(&inbox));
        hear(&mut listener, &HEARTBEAT_DATA { mavtype: MavType::MAV_TYPE_FIXED_WING, ..HEARTBEAT_DATA::DEFAULT });
        hear(&mut listener, &ATTITUDE_DATA { time_boot_ms: 20_000, roll: 0.1, ..ATTITUDE_DATA::DEFAULT });
        let fix_type = GpsFixType::GPS_FIX_TYPE_3D_FIX;
        let fix = GPS_RAW_INT_DATA { fix_type, vel: 1500, cog: 9000, eph: 100, ..GPS_RAW_INT_DATA::DEFAULT };
        hear(&mut listener, &GPS_RAW_INT_DATA { time_usec: 1_700_000_000_000_000, ..fix });
        let mut said = Vec::new();
        inbox.take(&mut said);
        let heard = |s: &Said| matches!(&s.what, What::Slow(aiding) if aiding.course_deg == Some(90.0));
        assert!(said.iter().any(heard), "{said:?}");
    }
}
