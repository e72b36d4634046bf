//! Errors of roll and pitch against a reference over time, in the bands that they should lie in.

use super::axis::Axis;
use super::chart::{Curve, Panel, heading};
use super::envelope::Envelope;
use super::flight::{BETWEEN, LEFT, SHEET, TIME, TOP, WIDTH, angle_axis};
use super::style::ESTIMATE;
use super::svg::{Area, Svg};

/// A row's errors and standard deviations, of roll and pitch, °; nothing where attitude is withheld
/// or there is no reference.
pub type Errors = Option<[(f64, f64); 2]>;

/// The errors of a flight.
#[derive(Clone, Debug, Default)]
pub struct Residuals {
    times_s: Option<(f64, f64)>,
    errors: [Envelope; 2],
    bands: [Envelope; 2],
}

impl Residuals {
    /// Takes in a row, in the order of time.
    pub fn add(&mut self, time_s: f64, errors: Errors) {
        self.times_s = Some((self.times_s.map_or(time_s, |(first, _)| first), time_s));
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
