//! Errors of roll and pitch against a reference over time, in the bands that they should lie in.

use super::axis::Axis;
use super::chart::{Curve, Panel, heading};
use super::envelope::Envelope;
use super::flight::{BETWEEN, LEFT, SHEET, TIME, TOP, WIDTH, angle_axis};
use super::style::ESTIMATE;
use super::svg::{Area, Svg};

/// A row's errors and standard deviations, of roll and pitch, °; nothing where attitude is withheld.
pub type Errors = Option<[(f64, f64); 2]>;

/// The errors of a flight.
#[derive(Clone, Debug, Default)]
pub struct Residuals {
    times_s: Option<(f64, f64)>,
    errors: [Envelope; 2],
    bands: [Envelope; 2],
}

impl Residuals {
    /// Takes in a row of which nothing is known, in the order of time: the lines go on past it.
    pub fn pass(&mut self, time_s: f64) {
        self.times_s = Some((self.times_s.map_or(time_s, |(first, _)| first), time_s));
    }

    /// Takes in a row, in the order of time.
    pub fn add(&mut self, time_s: f64, errors: Errors) {
        self.pass(time_s);
        for (i, (line, band)) in self.errors.iter_mut().zip(&mut self.bands).enumerate() {
            let of = errors.map(|e| e[i]);
            line.add_value(time_s, of.map(|(error, _)| error));
            band.add(time_s, of.map(|(_, sigma)| (-2.0 * sigma, 2.0 * sigma)));
        }
    }

    /// Whether no row had errors.
    pub fn is_empty(&self) -> bool {
        self.errors[0].extremes().is_none()
    }

    /// The drawing.
    pub fn draw(&self, title: &str, remark: &str) -> String {
        let (first_s, last_s) = self.times_s.unwrap_or_default();
        let x = Axis::exact(first_s, last_s, 10);
        let height = 220.0;
        let mut svg = Svg::new(SHEET, TOP + 2.0 * height + BETWEEN + 54.0);
        heading(&mut svg, LEFT, title, remark);
        for (i, name) in ["roll", "pitch"].into_iter().enumerate() {
            let curves = vec![
                (Curve::Series(&self.errors[i], ESTIMATE), format!("{name} − reference")),
                (Curve::Band(&self.bands[i]), "±2σ".to_owned()),
            ];
            let area = Area { x: LEFT, y: TOP + (height + BETWEEN) * i as f64, width: WIDTH, height };
            let (y, y_name) = (angle_axis(&[&self.errors[i]]), format!("error of {name}, °"));
            let x_name = (i == 1).then_some(TIME);
            Panel { area, x: &x, x_name, y, y_name: &y_name, curves }.draw(&mut svg);
        }
        svg.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_which_nothing_is_known_breaks_no_line() {
        let mut residuals = Residuals::default();
        let errors = Some([(1.0, 1.0), (2.0, 1.0)]);
        residuals.pass(0.0);
        residuals.add(1.0, errors);
        residuals.pass(2.0);
        residuals.add(3.0, errors);
        residuals.add(4.0, None);
        residuals.add(5.0, errors);
        assert_eq!(residuals.times_s, Some((0.0, 5.0)));
        for line in residuals.errors.iter().chain(&residuals.bands) {
            assert_eq!(line.runs().map(<[_]>::len).collect::<Vec<_>>(), [2, 1]);
        }
    }

    #[test]
    fn errors_of_no_number_are_gaps() {
        let mut residuals = Residuals::default();
        residuals.add(0.0, None);
        residuals.add(1.0, Some([(f64::NAN, 1.0), (2.0, f64::INFINITY)]));
        assert!(residuals.is_empty());
        residuals.add(2.0, Some([(12.0, 1.0), (2.0, 1.0)]));
        assert!(!residuals.is_empty());
        let svg = residuals.draw("t", "r");
        assert!(svg.contains("error of pitch, °") && !svg.contains("NaN") && !svg.contains("inf"));
    }
}
