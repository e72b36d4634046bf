//! Frames held back until the body rates of their time are there. Pure; time comes in as an argument.
//!
//! Rates come by a slower way than frames, and some are lost on it. A rate taken for a newer one than it is costs
//! rate times delay: at 60 °/s and 40 ms, 2.4°. So a frame waits for the rates on both sides of its moment, a few
//! hundredths of a second and [`LONGEST_S`] at most, and [`carry`](super::carry) makes up for the wait. Without rates
//! frames pass at once.

use super::carry::{FARTHEST_S, carry};
use super::compare::Comparison;
use super::rates::Rates;
use super::{Autopilot, Link, Said, What};
use crate::attitude::Attitude;
use crate::estimator::vector::Vector;
use crate::frame::{Aiding, Frame};
use crate::time::Time;
use std::collections::VecDeque;

/// The longest wait of a frame, s.
pub const LONGEST_S: f64 = 0.12;
/// As many frames wait: those of the longest wait at 200 Hz, and some.
const ROOM: usize = 32;
/// Rates are gone when for so long none has arrived, s.
const SILENT_S: f64 = 0.25;
/// GPS and airspeed older than this are none, s.
const OLD_S: f64 = 2.5;
/// As many of them wait for their frame.
const SLOW_ROOM: usize = 32;
/// A source that makes aiding of its own is taken to go on with it for so long, s.
const OWN_S: f64 = 3.0;
/// An autopilot not heard for so long is not there, s.
const GONE_S: f64 = 5.0;
/// Over how many messages the delay is learnt.
const LEARNT_OVER: f64 = 50.0;

/// Frames in, frames with their aiding out.
#[derive(Debug)]
pub struct Aligner {
    held: VecDeque<Frame>,
    spare: Vec<Frame>,
    rates: Rates,
    slow: VecDeque<Said>,
    delay: Delay,
    /// When rates arrived last.
    arrived: Option<Time>,
    /// When the source had aiding of its own last.
    own: Option<Time>,
    link: Link,
    attitude: Option<(Time, Attitude, f64)>,
    comparison: Comparison,
    /// The last frame that went out.
    gone: Option<Time>,
    /// Whether what waits is carried on by the rates.
    carries: bool,
}

/// How old rates are when they arrive, s.
#[derive(Clone, Copy, Debug, Default)]
struct Delay {
    mean_s: f64,
    /// Mean departure from that.
    jitter_s: f64,
    seen: f64,
    /// They come too late to be of use.
    late: bool,
}

impl Delay {
    fn learn(&mut self, age_s: f64) {
        self.seen = (self.seen + 1.0).min(LEARNT_OVER);
        let off = age_s - self.mean_s;
        self.mean_s += off / self.seen;
        if self.seen > 1.0 {
            self.jitter_s += (off.abs() - self.jitter_s) / self.seen;
        }
        self.late = self.mean_s > LONGEST_S * if self.late { 0.75 } else { 1.0 };
    }
}

impl Aligner {
    /// For frames of `sensors` readings. Nothing is allocated after this.
    pub fn new(sensors: usize) -> Self {
        Self {
            held: VecDeque::with_capacity(ROOM + 1),
            spare: (0..=ROOM).map(|_| Frame::new(sensors)).collect(),
            rates: Rates::default(),
            slow: VecDeque::with_capacity(SLOW_ROOM),
            delay: Delay::default(),
            arrived: None,
            own: None,
            link: Link::default(),
            attitude: None,
            comparison: Comparison::default(),
            gone: None,
            carries: true,
        }
    }

    /// How the autopilot is heard. Another one than before begins anew.
    pub fn linked(&mut self, link: Link) {
        if link.system != self.link.system {
            self.rates.clear();
            self.slow.clear();
            (self.delay, self.arrived, self.attitude) = (Delay::default(), None, None);
            self.comparison = Comparison::default();
        }
        self.link = link;
    }

    /// Whether the attitude is carried on by the rates, as it is while they are believed: else no frame waits for them.
    pub fn carries(&mut self, carries: bool) {
        self.carries = carries;
    }

    /// Takes in what the autopilot said. What cannot be is not heard.
    pub fn hear(&mut self, said: &Said) {
        let Said { time, arrived, what } = *said;
        match what {
            What::Rates(rate) => {
                // A clock that was set back: nothing of before is of any use.
                if self.rates.newest().is_some_and(|newest| time.since(newest) < -1.0) {
                    self.rates.clear();
                }
                if rate.iter().all(|v| v.is_finite()) && self.rates.insert(time, rate) {
                    self.delay.learn(arrived.since(time).max(0.0));
                    self.arrived = Some(arrived);
                }
            }
            What::Attitude(attitude, yaw) => {
                self.comparison.theirs(time, attitude);
                self.attitude = Some((time, attitude, yaw));
            }
            What::Slow(_) => {
                if self.slow.len() >= SLOW_ROOM {
                    self.slow.pop_front();
                }
                self.slow.push_back(*said);
            }
        }
    }

    /// Takes in a frame.
    pub fn offer(&mut self, frame: &Frame) {
        if frame.aiding != Aiding::default() {
            self.own = Some(frame.time);
        }
        // There is always one to spare: `next` gives one back before the room is full.
        let Some(mut place) = self.spare.pop().or_else(|| self.held.pop_front()) else { return };
        place.clone_from(frame);
        self.held.push_back(place);
    }

    /// Whether the autopilot's words go into frames.
    fn aids(&self, now: Time) -> bool {
        self.link.aids && self.own.is_none_or(|own| !(0.0..OWN_S).contains(&now.since(own)))
    }

    /// Whether body rates are there and of use.
    pub fn has_rates(&self, now: Time) -> bool {
        self.aids(now) && !self.delay.late && self.arrived.is_some_and(|at| now.since(at) < SILENT_S)
    }

    /// How long a frame waits at most, s: as long as rates take, one of them lost or two.
    fn longest_s(&self) -> f64 {
        let interval_s = self.rates.interval_s().unwrap_or(0.0);
        (self.delay.mean_s + 4.0 * self.delay.jitter_s + 3.0 * interval_s).min(LONGEST_S)
    }

    /// Puts the next frame that need not wait at `now` into `frame`, with what belongs to it; `false` when there is
    /// none.
    pub fn next(&mut self, now: Time, frame: &mut Frame) -> bool {
        let Some(first) = self.held.front() else { return false };
        let moment = first.sample_time().unwrap_or(first.time);
        let has_rates = self.has_rates(now);
        // One that waits for the next could be carried no farther.
        let near = self.gone.is_none_or(|gone| moment.since(gone) <= FARTHEST_S);
        let waits = has_rates
            && self.carries
            && near
            && self.held.len() <= ROOM
            && self.rates.newest().is_none_or(|newest| newest < moment)
            && (0.0..self.longest_s()).contains(&now.since(moment));
        if waits {
            return false;
        }
        let Some(mut first) = self.held.pop_front() else { return false };
        if self.aids(now) {
            first.aiding.gyro_deg_s = match self.rates.at(moment).filter(|_| has_rates) {
                Some(rate) => rate.map(Some),
                None => [None; 3],
            };
            self.fill(&mut first, moment);
        }
        self.gone = Some(moment);
        std::mem::swap(frame, &mut first);
        self.spare.push(first);
        true
    }

    /// What is nearer to this frame than to the next one.
    fn fill(&mut self, frame: &mut Frame, moment: Time) {
        let period_s = match (self.held.front(), self.gone) {
            (Some(next), _) => next.sample_time().unwrap_or(next.time).since(moment),
            (None, Some(last)) => moment.since(last),
            (None, None) => 0.0,
        };
        self.slow.retain(|said| {
            let What::Slow(new) = said.what else { return false };
            let ahead_s = said.time.since(moment);
            if ahead_s > 0.5 * period_s.clamp(0.0, 1.0) {
                // Farther ahead than this is of no clock of ours.
                return ahead_s < OLD_S;
            }
            if ahead_s > -OLD_S {
                take(&mut frame.aiding, &new);
            }
            false
        });
    }

    /// The attitude and standard deviations that are `given` at the first moment, carried on to the second by the
    /// rates, with the `correction` of [`carry()`]. `None` where they do not tell.
    pub fn carry(
        &self,
        given: (Attitude, Attitude),
        correction: Vector,
        span: (Time, Time),
    ) -> Option<(Attitude, Attitude)> {
        if self.has_rates(span.1) { carry(given, &self.rates, correction, span) } else { None }
    }

    /// Body rates at `time`, rad/s about x (nose), y (right), z (down): the autopilot's, or a guess from the newest of
    /// them, with the `correction` of [`carry()`].
    pub fn rates(&self, time: Time, [nose, left, up]: Vector) -> Option<Vector> {
        let [p, q, r] = self.rates.at(time)?.map(f64::to_radians);
        Some([p + nose, q - left, r - up])
    }

    /// Our attitude at `time`, to be compared.
    pub fn compare(&mut self, time: Time, ours: Attitude) {
        self.comparison.ours(time, ours);
    }

    /// The autopilot as it is shown at `now`.
    pub fn autopilot(&self, now: Time) -> Autopilot {
        if now.since(self.link.heard) > GONE_S || self.link.system.is_none() {
            return Autopilot::default();
        }
        let rates = self.arrived.is_some_and(|at| now.since(at) < SILENT_S);
        Autopilot {
            link: self.link,
            late_s: rates.then_some(self.delay.mean_s),
            used: self.has_rates(now),
            differs: self.comparison.difference(now),
            attitude: self.attitude.filter(|(at, ..)| now.since(*at) < OLD_S).map(|(_, a, yaw)| (a, yaw)),
        }
    }
}

/// What is new over what was there.
fn take(aiding: &mut Aiding, new: &Aiding) {
    let over = |old: &mut Option<f64>, new: Option<f64>| *old = new.or(*old);
    over(&mut aiding.airspeed_m_s, new.airspeed_m_s);
    over(&mut aiding.ground_speed_m_s, new.ground_speed_m_s);
    over(&mut aiding.course_deg, new.course_deg);
    over(&mut aiding.climb_m_s, new.climb_m_s);
    over(&mut aiding.altitude_m, new.altitude_m);
}

#[cfg(test)]
mod tests;
