//! Where the autopilot's words meet the frames: what goes to the estimator, and what is published of it.

use crate::aiding::inbox::ROOM;
use crate::aiding::{Aligner, Autopilot, Inbox, Said};
use crate::attitude::{Attitude, Estimate};
use crate::frame::Frame;
use crate::horizon::Horizon;
use crate::time::Time;
use std::sync::Arc;

/// Between a sampling loop's source and its estimator. Nothing is allocated after it is made.
pub struct Alignment {
    inbox: Option<Arc<Inbox>>,
    said: Vec<Said>,
    aligner: Aligner,
    frame: Frame,
    shown: Estimate,
    /// Whether the body rates are believed.
    believed: bool,
}

impl Alignment {
    /// For frames of `sensors` readings, and estimates with as many `faults`.
    pub fn new(sensors: usize, faults: usize) -> Self {
        Self {
            inbox: None,
            said: Vec::with_capacity(ROOM),
            aligner: Aligner::new(sensors),
            frame: Frame::new(sensors),
            believed: true,
            shown: Estimate {
                faults: Vec::with_capacity(faults),
                residuals_k: Vec::with_capacity(sensors),
                ..Estimate::default()
            },
        }
    }

    /// Takes what the autopilot says out of `inbox`.
    pub fn listen(&mut self, inbox: Arc<Inbox>) {
        self.inbox = Some(inbox);
    }

    /// Takes in the newest scan, and what the autopilot has said until now.
    pub fn offer(&mut self, frame: &Frame) {
        if let Some(inbox) = &self.inbox {
            self.said.clear();
            self.aligner.linked(inbox.take(&mut self.said));
            self.said.iter().for_each(|said| self.aligner.hear(said));
        }
        self.aligner.offer(frame);
    }

    /// The next frame for the estimator of `horizon`, if one need not wait at `now`.
    pub fn next(&mut self, now: Time, horizon: &Horizon) -> Option<&Frame> {
        self.aligner.carries(horizon.rate_correction().is_some());
        self.aligner.next(now, &mut self.frame).then_some(&self.frame)
    }

    /// Our newest estimate, to be compared with the autopilot's.
    pub fn compare(&mut self, estimate: &Estimate) {
        if let Some(attitude) = estimate.attitude.filter(|_| estimate.measured) {
            self.aligner.compare(estimate.valid_at, attitude);
        }
    }

    /// The autopilot as it is shown at `now`.
    pub fn autopilot(&mut self, horizon: &Horizon, now: Time) -> Autopilot {
        let autopilot = self.aligner.autopilot(now);
        let believed = horizon.rate_correction().is_some();
        // While they are silent nothing is known of them.
        if autopilot.used && horizon.judges_rates() && believed != self.believed {
            self.believed = believed;
            if believed {
                log::info!("the autopilot's body rates are believed again");
            } else {
                log::warn!(
                    "the autopilot's body rates are not believed: they do not turn as the thermopiles see it turn, or come too \
                     seldom; is the head mounted and wired as the configuration says, on the autopilot's axes?"
                );
            }
        }
        Autopilot { used: autopilot.used && believed, ..autopilot }
    }

    /// What is published of `estimate`, the newest, when `scan` is the newest: carried on to its moment by the body
    /// rates, where there are any. What waited for them is then no older than what did not. `horizon` is told of it.
    pub fn shown(&mut self, estimate: &Estimate, horizon: &mut Horizon, scan: &Frame) -> &Estimate {
        let before = (self.shown.attitude, self.shown.sigma, self.shown.rates, self.shown.valid_at);
        let measured = self.shown.measured;
        self.shown.clone_from(estimate);
        let (Some(attitude), now) = (estimate.attitude, scan.sample_time().unwrap_or(scan.time)) else {
            return &self.shown;
        };
        if !estimate.measured {
            // What stands in for an attitude does so at any time.
            if self.aligner.has_rates(scan.time) {
                self.shown.valid_at = scan.time;
            }
            return &self.shown;
        }
        let given = (attitude, estimate.sigma);
        if let Some(correction) = horizon.rate_correction()
            && let Some((carried, sigma)) = self.aligner.carry(given, correction, (estimate.valid_at, now))
        {
            let limit = horizon.roll_limit().max(attitude.roll.abs());
            let roll = carried.roll.clamp(-limit, limit);
            self.shown.attitude = Some(Attitude { roll, ..carried });
            self.shown.sigma = sigma;
            self.shown.rates = self.aligner.rates(now, correction);
            self.shown.valid_at = now;
        } else if measured && before.3 > estimate.valid_at && before.3 <= now {
            // What was carried farther is newer than this.
            (self.shown.attitude, self.shown.sigma, self.shown.rates, self.shown.valid_at) = before;
        }
        horizon.published(&self.shown);
        &self.shown
    }
}

#[cfg(test)]
mod tests;
