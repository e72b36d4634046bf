//! What is said after a frame: the attitude, what stands in for one that cannot be trusted, or nothing.
//!
//! - `sigma_limit`: an attitude too uncertain is withheld;
//! - `stand_in`: what is shown in place of a withheld one (`on-fault`);
//! - `continuity`: no step in what is published that the aircraft has not made.

use super::continuity::Continuity;
use super::sigma_limit::SigmaLimit;
use super::stand_in::Shown;
use crate::attitude::{Attitude, Estimate, Mode};
use crate::config::settings::{FaultSettings, OnFault};
use crate::fault::{ActiveFault, Evidence, FaultKind};
use crate::time::Time;

/// Frames are not placed to the nanosecond, s.
const GRACE_S: f64 = 0.000_5;

/// What estimator and fault detectors make of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// An attitude that may be trusted.
    Given {
        /// Roll and pitch on the airframe's axes, rad.
        attitude: Attitude,
        /// Their standard deviations, rad.
        sigma: Attitude,
        /// Roll stands at its limit: it is a bound, whose standard deviation may be of any size.
        limited: bool,
        /// There is less behind it than was configured.
        degraded: bool,
    },
    /// Nothing new, and no reason to take back what was said, for a while: one missed read, a first suspicion.
    Nothing,
    /// A fault withholds the attitude.
    Withheld,
}

/// Brings an estimate's attitude, standard deviations, mode and times up to date.
#[derive(Clone, Debug)]
pub struct Output {
    on_fault: OnFault,
    hold_s: f64,
    stale_after_s: f64,
    limit: SigmaLimit,
    continuity: Continuity,
    /// What was said last, while something is.
    shown: Option<Shown>,
    /// What was published of it, where that was carried on.
    published: Option<Shown>,
    /// The last attitude that was given, while another stands in for it, and since when.
    given: Option<(Shown, Time)>,
    /// The time for which attitudes have been held, s. A moment of trust does not give it back.
    held_s: f64,
    /// Since when the attitude has been given again.
    trusted_since: Option<Time>,
    /// When an attitude was last given or withheld; at first, when there might have been one.
    answered: Option<Time>,
    /// Neither was done with the last frame.
    waits: bool,
}

impl Output {
    /// As `[faults]` says.
    pub fn new(settings: &FaultSettings) -> Self {
        Self {
            on_fault: settings.on_fault,
            hold_s: settings.hold_s,
            stale_after_s: settings.stale_after_s,
            limit: SigmaLimit::new(settings.sigma_limit_deg),
            continuity: Continuity::default(),
            shown: None,
            published: None,
            given: None,
            held_s: 0.0,
            trusted_since: None,
            answered: None,
            waits: false,
        }
    }

    /// Takes up what `[faults]` says now.
    pub fn retune(&mut self, settings: &FaultSettings) {
        (self.on_fault, self.hold_s) = (settings.on_fault, settings.hold_s);
        self.stale_after_s = settings.stale_after_s;
        self.limit.retune(settings.sigma_limit_deg);
    }

    /// Takes in the verdict on the frame of time `now`, whose newest measurement is of `sampled`. The faults that it
    /// is based on are in `estimate` already; where the standard deviation alone withholds, that is added to them.
    pub fn update(&mut self, verdict: Verdict, now: Time, sampled: Option<Time>, estimate: &mut Estimate) {
        if verdict != Verdict::Nothing {
            (self.answered, self.waits) = (Some(now), false);
        }
        match verdict {
            Verdict::Given { attitude, sigma, limited, degraded } => {
                let judged = if limited { Attitude { roll: 0.0, ..sigma } } else { sigma };
                let sure = self.limit.update(attitude, judged, now);
                let known = [attitude.roll, attitude.pitch, sigma.roll, sigma.pitch].into_iter().all(f64::is_finite);
                match (sure, known) {
                    (true, true) => {
                        self.give(attitude, sigma, now, estimate);
                        let less = degraded || !estimate.faults.is_empty();
                        estimate.mode = if less { Mode::Degraded } else { Mode::Nominal };
                        estimate.time = sampled.unwrap_or(estimate.time);
                        estimate.valid_at = estimate.time;
                    }
                    (true, false) => self.wait(now, sampled, estimate),
                    (false, _) => {
                        self.limit.report(&mut estimate.faults);
                        self.withhold(now, sampled, estimate);
                    }
                }
            }
            Verdict::Nothing => self.wait(now, sampled, estimate),
            Verdict::Withheld => self.withhold(now, sampled, estimate),
        }
    }

    /// Takes in what was published of what was said last, with its standard deviations, rad: what stands in goes on from that.
    pub fn published(&mut self, attitude: Attitude, sigma: Attitude) {
        self.published = self.shown.map(|shown| Shown { attitude, sigma, ..shown });
    }

    fn give(&mut self, attitude: Attitude, sigma: Attitude, now: Time, estimate: &mut Estimate) {
        let stood_in = self.given.take().is_some();
        let (attitude, sigma) = self.continuity.update(attitude, sigma, self.shown, stood_in, now);
        self.shown = Some(Shown { attitude, sigma, at: now });
        let since = *self.trusted_since.get_or_insert(now);
        if now.since(since) >= self.hold_s {
            self.held_s = 0.0;
        }
        estimate.attitude = Some(attitude);
        estimate.measured = true;
        estimate.sigma = sigma;
    }

    /// Nothing new is said, except that what stands in grows older; and what was given is not in force for ever.
    fn wait(&mut self, now: Time, sampled: Option<Time>, estimate: &mut Estimate) {
        let since = *self.answered.get_or_insert(now);
        let age_s = now.since(since);
        // One missed read is no matter, however seldom there is one.
        let waited = std::mem::replace(&mut self.waits, true);
        let unsure = self.limit.report(&mut estimate.faults);
        let stale = !unsure && waited && age_s > self.stale_after_s;
        if stale {
            let evidence = Evidence::Limit { value: age_s, limit: self.stale_after_s, unit: "s" };
            estimate.faults.push(ActiveFault { kind: FaultKind::Stale, since, evidence });
        }
        if unsure || stale || self.given.is_some() {
            self.withhold(now, sampled, estimate);
        } else if estimate.mode == Mode::Nominal && !estimate.faults.is_empty() {
            estimate.mode = Mode::Degraded;
        }
    }

    fn withhold(&mut self, now: Time, sampled: Option<Time>, estimate: &mut Estimate) {
        self.trusted_since = None;
        let before = self.shown;
        self.shown = self.stand_in(now);
        estimate.time = sampled.unwrap_or(estimate.time);
        estimate.valid_at = if self.shown.is_some() { now } else { estimate.time };
        estimate.attitude = self.shown.map(|s| s.attitude);
        estimate.rates = None;
        estimate.measured = false;
        let shown = self.shown.or(before);
        estimate.sigma = shown.map_or(estimate.sigma, |s| s.sigma);
        let held = self.on_fault == OnFault::Hold && self.shown.is_some();
        estimate.mode = if held { Mode::Degraded } else { Mode::Faulted };
    }

    /// What to show at `now` for an attitude that is withheld; nothing where nothing was shown before.
    fn stand_in(&mut self, now: Time) -> Option<Shown> {
        let shown = self.shown?;
        let last = self.published.take().unwrap_or(shown);
        let (given, since) = *self.given.get_or_insert((last, now));
        match self.on_fault {
            OnFault::Level => return Some(given.levelled(now, since)),
            OnFault::Hold => {
                // From when it was given: what no frame has renewed since is as old.
                self.held_s += now.since(shown.at).max(0.0);
                if self.held_s <= self.hold_s + GRACE_S {
                    return Some(given.held(now));
                }
            }
            OnFault::Withhold => {}
        }
        self.given = None;
        None
    }
}

#[cfg(test)]
mod tests;
