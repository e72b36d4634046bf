//! Body rates, and when to believe them.

use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, product, rotation};
use crate::frame::Aiding;
use crate::time::Time;

/// A sample older than this is none, and frames farther apart cannot use one, s.
const AGE_S: f64 = 0.25;
/// Faster than this nothing that flies can turn, °/s.
const FASTEST_DEG_S: f64 = 2000.0;
/// A gyro that was wrong is believed again after this, s; twice as long each time.
const DISTRUST_S: (f64, f64) = (20.0, 640.0);

/// The gyro of an autopilot.
#[derive(Clone, Debug, Default)]
pub struct Gyro {
    last: Option<(Vector, Time)>,
    rates: Option<Vector>,
    now: Time,
    /// From the airframe's axes to the head's; `None` where they are the same.
    to_head: Option<[Vector; 3]>,
    wrong_since: Option<Time>,
    distrust_s: f64,
}

impl Gyro {
    /// Takes in what came with a frame, `dt_s` after the last; whether the gyro has come or gone.
    pub fn update(&mut self, aiding: &Aiding, now: Time, dt_s: f64) -> bool {
        self.now = now;
        let before = self.rates.is_some();
        self.rates = self.current(aiding, now, dt_s);
        if self.wrong_since.is_some_and(|at| (0.0..self.distrust_s).contains(&now.since(at))) {
            self.rates = None;
        }
        before != self.rates.is_some()
    }

    fn current(&mut self, aiding: &Aiding, now: Time, dt_s: f64) -> Option<Vector> {
        let age = |at: Time| (0.0..AGE_S).contains(&now.since(at));
        if let [Some(p), Some(q), Some(r)] = aiding.gyro_deg_s
            && [p, q, r].iter().all(|v| v.abs() <= FASTEST_DEG_S)
        {
            // Front, right, down to nose, left, up.
            let rates = [p, -q, -r].map(f64::to_radians);
            let rates = self.to_head.map_or(rates, |m| product(&m, rates));
            let (last, at) = self.last.replace((rates, now)).filter(|(_, at)| age(*at)).unwrap_or((rates, now));
            // All frames since then went by the last sample alone: half of what it has changed by since then is made up for.
            let frames = if dt_s > 0.0 { (now.since(at) / dt_s).max(1.0) } else { 1.0 };
            return (dt_s < AGE_S).then(|| std::array::from_fn(|i| last[i] + 0.5 * frames * (rates[i] - last[i])));
        }
        self.last.filter(|(_, at)| age(*at) && dt_s < AGE_S).map(|(rates, _)| rates)
    }

    /// The head shows this roll and pitch in level flight.
    pub fn set_trim(&mut self, trim: Attitude) {
        // The other way round than from the head to the airframe.
        let [pitch, roll] = [[0.0, trim.pitch, 0.0], [-trim.roll, 0.0, 0.0]].map(rotation);
        let columns: [Vector; 3] = std::array::from_fn(|k| product(&roll, std::array::from_fn(|i| pitch[i][k])));
        let turned = trim != Attitude::default();
        self.to_head = turned.then(|| std::array::from_fn(|r| std::array::from_fn(|k| columns[k][r])));
    }

    /// The rates to be used, rad/s on nose, left, up: the mean over the time since the last frame.
    pub fn rates(&self) -> Option<Vector> {
        self.rates
    }

    /// Whether there are rates.
    pub fn in_use(&self) -> bool {
        self.rates.is_some()
    }

    /// The thermopiles speak against it: it is not believed for a while.
    pub fn distrust(&mut self) {
        if self.rates.take().is_some() {
            self.wrong_since = Some(self.now);
            self.distrust_s = (2.0 * self.distrust_s).clamp(DISTRUST_S.0, DISTRUST_S.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// About the nose, at 0 and at 0.1 s; the frames between them have none.
    #[test]
    fn samples_between_frames_turn_as_far_as_their_mean() {
        let mut gyro = Gyro::default();
        let mut turned_deg = 0.0;
        for (i, rate) in [Some(0.0), None, None, None, None, Some(10.0)].into_iter().enumerate() {
            let aiding = Aiding { gyro_deg_s: [rate, rate, rate], ..Aiding::default() };
            gyro.update(&aiding, Time::from_secs_f64(5.0 + 0.02 * i as f64), 0.02);
            turned_deg += gyro.rates().map_or(0.0, |r| r[0].to_degrees() * 0.02);
        }
        assert!((turned_deg - 0.5).abs() < 1e-6, "{turned_deg}°");
    }
}
