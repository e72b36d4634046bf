//! Body rates, and when to believe them.

use crate::attitude::Attitude;
use crate::estimator::vector::{Vector, dot, product, rotation};
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

    /// The head shows this roll and pitch in level flight. What the rates are turned back by now, rad: from the axes by the
    /// trim before; a small angle.
    pub fn set_trim(&mut self, trim: Attitude) -> Vector {
        // The other way round than from the head to the airframe.
        let [pitch, roll] = [[0.0, trim.pitch, 0.0], [-trim.roll, 0.0, 0.0]].map(rotation);
        let columns: [Vector; 3] = std::array::from_fn(|k| product(&roll, std::array::from_fn(|i| pitch[i][k])));
        let to_head = std::array::from_fn(|r| std::array::from_fn(|k| columns[k][r]));
        let turned = trim != Attitude::default();
        let before = std::mem::replace(&mut self.to_head, turned.then_some(to_head)).unwrap_or(rotation([0.0; 3]));
        // Of the matrix from the new axes to those before.
        let element = |r: usize, c: usize| dot(before[r], to_head[c]);
        std::array::from_fn(|i| {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            0.5 * (element(last, next) - element(next, last))
        })
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

    /// What is shown by one trim is what is shown by the next and turned back.
    #[test]
    fn a_trim_that_moves_turns_the_axes() {
        let mut gyro = Gyro::default();
        let mut shown = |degrees: [f64; 2]| {
            let [roll, pitch] = degrees.map(f64::to_radians);
            let turned = gyro.set_trim(Attitude { roll, pitch });
            (gyro.to_head.map_or([1.0, -2.0, 0.5], |m| product(&m, [1.0, -2.0, 0.5])), turned)
        };
        let mut before = shown([0.0, 0.0]).0;
        for trim in [[1.0, 0.0], [1.0, -0.5], [3.0, 4.0], [3.5, 4.5], [0.0, 4.0], [0.0, 3.0], [0.0, 0.0]] {
            let (now, turned) = shown(trim);
            let back = product(&rotation(turned), now);
            assert!((0..3).all(|i| (back[i] - before[i]).abs() < 2e-3), "{trim:?}: {back:?} {before:?}");
            before = now;
        }
    }

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
