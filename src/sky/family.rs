//! One table for a whole family of skies, so that the sky's shape can be estimated.
//!
//! A plane-parallel grey atmosphere whose optical depth is free comes within 0.1 K of every sky of
//! 40 K contrast that was tried: the report's exponentials with k from 3.5 to 160 (0.15 K at k = 2),
//! dry to overcast, averaged in temperature or in radiance. With next to no depth it is a dome of one temperature, as
//! the base of a closed cloud is.

use super::{FieldOfView, Shape};

/// The table's ends: natural logarithms of the optical depth. Below [`DRY`] each step stands for [`DRY_STEPS`] of them, as
/// there less and less changes.
pub const LN_DEPTH: (f64, f64) = (DRY - MORE as f64 * STEP, HUMID);
/// Where dry air begins.
pub const DRY: f64 = -3.5;
const HUMID: f64 = 1.4;
/// How much more a step is there.
pub const DRY_STEPS: f64 = 3.0;
/// Entries for it.
const MORE: usize = 6;
const DEPTHS: usize = 24 + MORE;
const ELEVATIONS: usize = 181;
/// Steps of the sine of elevation while the table is being made.
const SINES: usize = 512;

/// One number for each elevation.
type Row = [f64; ELEVATIONS];

/// What a sensor sees of a grey atmosphere, against its axis' elevation and the logarithm of the
/// atmosphere's optical depth, as [`LN_DEPTH`] says.
///
/// Normalised: 0 with the axis straight down, 1 with it straight up. A sensor shows
/// `ground − contrast·level`, `contrast` being what a vertical pair shows.
#[derive(Clone, Debug)]
pub struct Family {
    /// By depth, then by elevation from −90° in steps of 1°.
    table: Vec<Row>,
    /// What the spread of the field of view adds, and its square; and what each of two other forms of it do.
    by_view: Vec<[Row; 2 + FORMS]>,
    /// What averaging in radiance adds to the level at [`RADIANCE_K`] of contrast.
    radiance: Vec<Row>,
}

/// A look-up with its slopes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// 0..1, rising with elevation.
    pub value: f64,
    /// Its change with the sine of the elevation.
    pub by_sine: f64,
    /// Its change with the logarithm of the depth.
    pub by_ln_depth: f64,
    /// Its change with how much is averaged in radiance.
    pub by_radiance: f64,
    /// Its change with the field of view.
    pub by_view: View,
}

/// How many other forms of the field of view there are.
pub const FORMS: usize = 2;

/// How much wider the sensors see than the field of view that was given: 1 is wider by [`WIDER`] of it, -1 narrower by that.
/// Then how much they see as [each of two others](FieldOfView::others) does: 0 nothing, 1 all, below 0 the other way.
pub type View = [f64; 1 + FORMS];

impl Family {
    /// Makes the tables, in some ten milliseconds.
    pub fn new(field: FieldOfView) -> Self {
        let depths: Vec<f64> = (0..DEPTHS).map(depth).collect();
        let deficits: Vec<[f64; DEPTHS]> = (0..=SINES)
            .map(|i| {
                let s = i as f64 / SINES as f64;
                std::array::from_fn(|d| Shape::Grey { depth: depths[d] }.deficit(s))
            })
            .collect();
        let levels = |by: f64| means(field.scaled(by), &deficits);
        let mut table = levels(1.0);
        // What is radiated less than by the ground, as a share of that, where a vertical pair shows RADIANCE_K.
        let span = |row: &Row| row[ELEVATIONS - 1] - row[0];
        let shares: [f64; DEPTHS] = std::array::from_fn(|d| RADIANCE_K / GROUND_K / span(&table[d]));
        let dimmer = |by: &[f64; DEPTHS]| std::array::from_fn(|d| 1.0 - (1.0 - by[d] * shares[d]).powi(4));
        let mut radiance = means(field, &deficits.iter().map(dimmer).collect::<Vec<_>>());
        radiance.iter_mut().flatten().for_each(|v| *v = 1.0 - (1.0 - *v).sqrt().sqrt());
        let [mut narrower, mut wider] = [-WIDER, WIDER].map(|by| levels(1.0 + by));
        let [mut one, mut other] = field.others().map(|field| means(field, &deficits));
        for table in [&mut table, &mut radiance, &mut narrower, &mut wider, &mut one, &mut other] {
            table.iter_mut().for_each(normalise);
        }
        for (more, level) in radiance.iter_mut().zip(&table) {
            more.iter_mut().zip(level).for_each(|(more, level)| *more -= level);
        }
        let by_view = |d: usize| {
            let beyond = |other: &[Row]| -> Row { std::array::from_fn(|e| other[d][e] - table[d][e]) };
            // A parabola through the three.
            let [less, more] = [beyond(&narrower), beyond(&wider)];
            let slope = std::array::from_fn(|e| (more[e] - less[e]) / 2.0);
            let square = std::array::from_fn(|e| (more[e] + less[e]) / 2.0);
            [slope, square, beyond(&one), beyond(&other)]
        };
        let by_view = (0..DEPTHS).map(by_view).collect();
        Self { table, by_view, radiance }
    }

    /// The level with the axis at the elevation whose sine is `sine` under a sky of `ln_depth`;
    /// both are kept inside the table. `radiance` 0: averaged in temperature, 1: in radiance at
    /// [`RADIANCE_K`]. NaN gives NaN.
    pub fn level(&self, sine: f64, ln_depth: f64, radiance: f64, view: View) -> Level {
        let sine = sine.clamp(-1.0, 1.0);
        let place = sine.asin().to_degrees() + 90.0;
        let cell = (place as usize).min(ELEVATIONS - 2);
        let x = place - cell as f64;
        let depth = (ln_depth.clamp(LN_DEPTH.0, LN_DEPTH.1) - LN_DEPTH.0) / STEP;
        let row = (depth as usize).min(DEPTHS - 2);
        let y = depth - row as f64;
        let weights = Spline::at(x);
        // The four neighbours at this depth and field of view, then the spline.
        let ([low, high], [by_low, by_high], [more_low, more_high]) = (
            [&self.table[row], &self.table[row + 1]],
            [&self.by_view[row], &self.by_view[row + 1]],
            [&self.radiance[row], &self.radiance[row + 1]],
        );
        let [spread, one, other] = view;
        let square = spread * spread;
        let mut sums = [[0.0; 2]; 4 + FORMS];
        for (i, weight) in weights.near(cell) {
            let seen_at = |[slope, curve, first, second]: &[Row; 2 + FORMS]| {
                spread * slope[i] + square * curve[i] + one * first[i] + other * second[i]
            };
            let low = low[i] + seen_at(by_low) + radiance * more_low[i];
            let high = high[i] + seen_at(by_high) + radiance * more_high[i];
            let between = |low: f64, high: f64| low + y * (high - low);
            let [slope, curve, first, second] = std::array::from_fn(|k| between(by_low[k][i], by_high[k][i]));
            let by_radiance = between(more_low[i], more_high[i]);
            let terms = [between(low, high), high - low, by_radiance, slope + 2.0 * spread * curve, first, second];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum = [sum[0] + weight[0] * term, sum[1] + weight[1] * term];
            }
        }
        let [[value, by_degree], [by_row, _], [by_radiance, _], [by_spread, _], [first, _], [second, _]] = sums;
        // A degree of elevation is this much of its sine; near the poles the slope is a little off.
        let cosine = (1.0 - sine * sine).max(1e-4).sqrt();
        Level {
            value,
            by_sine: by_degree.to_degrees() / cosine,
            by_ln_depth: by_row / STEP,
            by_radiance,
            by_view: [by_spread, first, second],
        }
    }
}

/// As much wider, of its own width, is a field of view of spread 1.
pub const WIDER: f64 = 0.15;

/// The contrast for which the table of averaging in radiance is made, and the ground's temperature, K.
pub const RADIANCE_K: f64 = 40.0;
const GROUND_K: f64 = 283.0;

const STEP: f64 = (HUMID - DRY) / (DEPTHS - MORE - 1) as f64;

/// The optical depth of an entry.
fn depth(i: usize) -> f64 {
    let ln = LN_DEPTH.0 + i as f64 * STEP;
    (if ln < DRY { DRY + DRY_STEPS * (ln - DRY) } else { ln }).exp()
}

/// The mean over the field of view by depth and elevation, of what is given by sine of elevation and depth.
fn means(field: FieldOfView, by_sine: &[[f64; DEPTHS]]) -> Vec<Row> {
    let nodes = field.nodes();
    let mut table = vec![[0.0; ELEVATIONS]; DEPTHS];
    let mut shares = vec![0.0; SINES + 1];
    for e in 0..ELEVATIONS {
        // How the view is spread over the sine of elevation: alike for every sky.
        shares.fill(0.0);
        let (sin, cos) = (e as f64 - 90.0).to_radians().sin_cos();
        for n in &nodes {
            let sine = (n.along * sin + n.across * cos).min(1.0);
            let place = sine * SINES as f64;
            if place > 0.0 {
                let cell = (place as usize).min(SINES - 1);
                let part = n.weight * (place - cell as f64);
                shares[cell] += n.weight - part;
                shares[cell + 1] += part;
            }
        }
        for (share, there) in shares.iter().zip(by_sine).filter(|(share, _)| **share > 0.0) {
            for (row, d) in table.iter_mut().zip(there) {
                row[e] += share * d;
            }
        }
    }
    table
}

/// 0 at its beginning, 1 at its end, never falling.
fn normalise(row: &mut Row) {
    let (down, up) = (row[0], row[ELEVATIONS - 1]);
    let mut least = 0.0_f64;
    for v in row.iter_mut() {
        least = least.max((*v - down) / (up - down));
        *v = least;
    }
    // Looking down, the outermost nodes see the first of a dry sky all at once: not so fast that cubics overshoot.
    row[1] = row[1].max(row[2] / 4.0);
}

/// Weights of four neighbours for value and slope (Catmull-Rom); mirrored at the ends.
struct Spline([[f64; 2]; 4]);

impl Spline {
    fn at(x: f64) -> Self {
        let (x2, x3) = (x * x, x * x * x);
        Self([
            [-0.5 * x + x2 - 0.5 * x3, -0.5 + 2.0 * x - 1.5 * x2],
            [1.0 - 2.5 * x2 + 1.5 * x3, -5.0 * x + 4.5 * x2],
            [0.5 * x + 2.0 * x2 - 1.5 * x3, 0.5 + 4.0 * x - 4.5 * x2],
            [-0.5 * x2 + 0.5 * x3, -x + 1.5 * x2],
        ])
    }

    /// The entries about `cell` with their weights.
    fn near(&self, cell: usize) -> impl Iterator<Item = (usize, [f64; 2])> {
        let before = if cell == 0 { 1 } else { cell - 1 };
        let after = if cell + 2 == ELEVATIONS { ELEVATIONS - 2 } else { cell + 2 };
        [before, cell, cell + 1, after].into_iter().zip(self.0)
    }
}
