//! Differences from the references over minutes, and what explains them together: how the head sits, and how far the
//! horizon that it sees leans to one side of the compass.

use crate::estimator::linear::solve;

/// The time over which differences are gathered, s: long, since a mounting does not change in flight, and every gust that
/// fades out of them would move the trim.
const WINDOW_S: f64 = 600.0;
/// A side of the sky or ground warmer than the other lets the horizon lean by about so much (1σ) to north and to east, rad.
const WARM_SIDE: f64 = 2.5_f64.to_radians();
/// However well they agreed so far, they scatter by this share of their references' σ.
const LEAST_SCATTER: f64 = 0.5;
/// What a mounting may be before anything is heard (1σ), rad: anything.
const ANYTHING: f64 = 1.0;

/// How much of a difference each is: the mounting, a lean to north, a lean to east.
pub type Shares = [f64; 3];

/// What is gathered of one angle.
#[derive(Clone, Copy, Debug)]
pub struct Differences {
    /// The time after which a reference's error is another one, s.
    lasts_s: f64,
    /// Sums over the window of products of shares, each with a weight that is 1 over the variance of what it weighs and
    /// fades with its age; and the variance of the weighted sums. rad⁻².
    weights: [[f64; 3]; 3],
    squares: [[f64; 3]; 3],
    /// The weighted sums of differences, rad⁻¹.
    sums: Shares,
    /// The sum of the weights, and the mean square of what is left unexplained, in its own σ².
    weight: f64,
    scatter: f64,
    /// The mean angle of climb, rad.
    climb: f64,
}

impl Differences {
    /// Of a reference whose error is another one after `lasts_s` seconds.
    pub fn new(lasts_s: f64) -> Self {
        Self {
            lasts_s,
            weights: [[0.0; 3]; 3],
            squares: [[0.0; 3]; 3],
            sums: [0.0; 3],
            weight: 0.0,
            scatter: 0.0,
            climb: 0.0,
        }
    }

    /// Takes in that the estimate is `difference` ± `sigma` (rad) above the reference, which stands for `span_s` seconds of
    /// climbing at an angle of `climb` rad; `left` of it is unexplained by what was gathered before.
    pub fn gather(&mut self, (difference, sigma): (f64, f64), shares: Shares, left: f64, span_s: f64, climb: f64) {
        let new = span_s / (self.lasts_s * sigma.powi(2));
        let fading = (-span_s / WINDOW_S).exp();
        for i in 0..3 {
            self.sums[i] = self.sums[i] * fading + new * shares[i] * difference;
            for j in 0..3 {
                self.weights[i][j] = self.weights[i][j] * fading + new * shares[i] * shares[j];
                self.squares[i][j] = self.squares[i][j] * fading.powi(2) + new * shares[i] * shares[j];
            }
        }
        let departure = if self.weight > 0.0 { left / sigma } else { 1.0 };
        self.weight = self.weight * fading + new;
        self.scatter += new / self.weight * (departure.powi(2) - self.scatter);
        self.climb += new / self.weight * (climb - self.climb);
    }

    /// How widely they scatter about what explains them, in their references' σ.
    pub fn scatter(&self) -> f64 {
        self.scatter.sqrt().max(LEAST_SCATTER)
    }

    /// The mean angle of climb, rad.
    pub fn climb(&self) -> f64 {
        self.climb
    }
}

/// What explains the differences of roll and pitch.
#[derive(Clone, Copy, Debug)]
pub struct Explained {
    /// The mounting's roll and pitch, rad.
    pub mounting: [f64; 2],
    /// How far each may be off (1σ), rad.
    pub error: [f64; 2],
    /// How far the horizon leans to north and east, rad.
    lean: [f64; 2],
}

impl Default for Explained {
    fn default() -> Self {
        Self { mounting: [0.0; 2], error: [ANYTHING; 2], lean: [0.0; 2] }
    }
}

impl Explained {
    /// By the differences of roll and of pitch.
    pub fn by(angles: &[Differences; 2]) -> Option<Self> {
        let [mounting, lean] = [ANYTHING, WARM_SIDE].map(|sigma| sigma.powi(-2));
        let mut weights = [[0.0; 4]; 4];
        (0..4).for_each(|i| weights[i][i] = if i < 2 { mounting } else { lean });
        let (mut squares, mut sums) = (weights, [0.0; 4]);
        for (angle, d) in angles.iter().enumerate() {
            let scatter = d.scatter.max(1.0);
            let place = [angle, 2, 3];
            for (i, row) in place.into_iter().enumerate() {
                sums[row] += d.sums[i] / scatter;
                for (j, column) in place.into_iter().enumerate() {
                    weights[row][column] += d.weights[i][j] / scatter;
                    squares[row][column] += d.squares[i][j] / scatter;
                }
            }
        }
        let found = solve(weights, sums)?;
        let mut error = [0.0; 2];
        for (i, error) in error.iter_mut().enumerate() {
            let mut one = [0.0; 4];
            one[i] = 1.0;
            let by = solve(weights, one)?;
            let variance: f64 = (0..4).map(|j| (0..4).map(|k| by[j] * squares[j][k] * by[k]).sum::<f64>()).sum();
            *error = variance.max(0.0).sqrt();
        }
        let [roll, pitch, north, east] = found;
        Some(Self { mounting: [roll, pitch], error, lean: [north, east] })
    }

    /// What it says of a difference of `angle` (0 is roll, 1 pitch), rad.
    pub fn of(&self, angle: usize, shares: Shares) -> f64 {
        let [north, east] = self.lean;
        let [mounting, by_north, by_east] = shares;
        mounting * self.mounting[angle] + by_north * north + by_east * east
    }
}
