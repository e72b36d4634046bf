//! A replayed flight over time: roll and pitch in their bands, contrast, mode, faults.

use super::axis::Axis;
use super::chart::{Curve, Panel, heading};
use super::envelope::Envelope;
use super::spans::Spans;
use super::strip;
use super::style::{ESTIMATE, REFERENCE};
use super::svg::{Area, Svg};
use crate::attitude::{Attitude, Estimate, Mode};
use crate::fault::{FaultKind, FaultName};

/// The sheet's width; left of the panels; the panels' width.
pub(super) const SHEET: f64 = 1100.0;
pub(super) const LEFT: f64 = 70.0;
pub(super) const WIDTH: f64 = 830.0;
/// The first panel's top, and what lies between two.
pub(super) const TOP: f64 = 62.0;
pub(super) const BETWEEN: f64 = 16.0;
/// What the horizontal axis is called.
pub(super) const TIME: &str = "time, s";

/// A row of the replay.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Its time, s.
    pub time_s: f64,
    /// The attitude that it gives, if it gives one.
    pub attitude: Option<Attitude>,
    /// Whether it says nothing of attitude at all, so that the lines go on past it.
    pub nothing_new: bool,
    /// Everything else that is said.
    pub estimate: &'a Estimate,
    /// Roll and pitch of the reference, °.
    pub reference_deg: [Option<f64>; 2],
}

/// The flight.
#[derive(Clone, Debug, Default)]
pub struct Flight {
    times_s: Option<(f64, f64)>,
    angles: [Angle; 2],
    contrast_k: Envelope,
    modes: Spans<Mode>,
    faults: Spans<FaultKind>,
}

/// Roll, or pitch, °.
#[derive(Clone, Debug, Default)]
struct Angle {
    estimate: Envelope,
    band: Envelope,
    reference: Envelope,
}

impl Flight {
    /// Takes in a row, in the order of time.
    pub fn add(&mut self, row: Row<'_>) {
        let t = row.time_s;
        self.times_s = Some((self.times_s.map_or(t, |(first, _)| first), t));
        let sigma = row.estimate.sigma;
        for (i, angle) in self.angles.iter_mut().enumerate() {
            let pick = |a: Attitude| [a.roll, a.pitch][i].to_degrees();
            let value = row.attitude.map(pick);
            if !row.nothing_new {
                angle.estimate.add_value(t, value);
                angle.band.add(t, value.map(|v| (v - 2.0 * pick(sigma), v + 2.0 * pick(sigma))));
            }
            // A reference that comes less often has no gaps for that.
            if row.reference_deg[i].is_some() {
                angle.reference.add_value(t, row.reference_deg[i]);
            }
        }
        self.contrast_k.add_value(t, row.estimate.contrast_k);
        self.modes.add(t, std::iter::once(row.estimate.mode));
        self.faults.add(t, row.estimate.faults.iter().map(|f| f.kind));
    }

    /// Whether no row has come.
    pub fn is_empty(&self) -> bool {
        self.times_s.is_none()
    }

    /// The drawing; `names` are those of the faults' sensors and buses.
    pub fn draw(&self, title: &str, remark: &str, names: &dyn FaultName) -> String {
        let (first_s, last_s) = self.times_s.unwrap_or_default();
        let x = Axis::exact(first_s, last_s, 10);
        let faults = strip::LINE * self.faults.keys().len().max(1) as f64;
        let heights = [210.0, 170.0, 100.0, strip::LINE, faults];
        let height = TOP + heights.iter().sum::<f64>() + BETWEEN * (heights.len() - 1) as f64 + 54.0;
        let mut svg = Svg::new(SHEET, height);
        heading(&mut svg, LEFT, title, remark);
        let mut top = TOP;
        let areas = heights.map(|height| {
            let area = Area { x: LEFT, y: top, width: WIDTH, height };
            top = area.bottom() + BETWEEN;
            area
        });
        for ((angle, name), area) in self.angles.iter().zip(["roll", "pitch"]).zip(areas) {
            let mut curves = vec![
                (Curve::Series(&angle.estimate, ESTIMATE), format!("{name}, estimated")),
                (Curve::Band(&angle.band), "within 2σ".to_owned()),
            ];
            if angle.reference.extremes().is_some() {
                curves.push((Curve::Series(&angle.reference, REFERENCE), format!("{name}, reference")));
            }
            let y = angle_axis(&[&angle.estimate, &angle.reference]);
            Panel { area, x: &x, x_name: None, y, y_name: &format!("{name}, °"), curves }.draw(&mut svg);
        }
        let (low, high) = self.contrast_k.extremes().unwrap_or((0.0, 1.0));
        let curves = vec![(Curve::Series(&self.contrast_k, ESTIMATE), "ground − zenith".to_owned())];
        let y = Axis::rounded(low.min(0.0), high.max(1.0), 3);
        Panel { area: areas[2], x: &x, x_name: None, y, y_name: "contrast, K", curves }.draw(&mut svg);
        strip::modes(&mut svg, areas[3], &x, &self.modes);
        strip::faults(&mut svg, areas[4], &x, TIME, &self.faults, names);
        svg.finish()
    }
}

/// An axis for all of `lines`, ±5° at the least. A band may reach beyond it.
pub(super) fn angle_axis(lines: &[&Envelope]) -> Axis {
    let all = lines.iter().filter_map(|e| e.extremes());
    let (low, high) = all.fold((-5.0_f64, 5.0_f64), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    Axis::degrees(low, high, 6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{ActiveFault, Evidence};
    use crate::head::Head;
    use crate::time::Time;

    fn flight(rows: u32) -> String {
        let mut flight = Flight::default();
        assert!(flight.is_empty());
        for i in 0..rows {
            let phase = f64::from(i) * 0.002;
            let attitude = Attitude { roll: phase.sin(), pitch: 0.2 * (phase * 7.0).cos() };
            let withheld = i % 1000 > 900;
            let mut estimate = Estimate {
                attitude: (!withheld).then_some(attitude),
                sigma: Attitude { roll: 0.02, pitch: if i == 3 { f64::NAN } else { 0.01 } },
                contrast_k: Some(20.0),
                mode: if withheld { Mode::Faulted } else { Mode::Nominal },
                ..Estimate::default()
            };
            if withheld {
                let evidence = Evidence::Limit { value: 1.0, limit: 2.0, unit: "K" };
                let kind = if i % 2 == 0 { FaultKind::LowContrast } else { FaultKind::SensorLost(1) };
                estimate.faults.push(ActiveFault { kind, since: Time::default(), evidence });
            }
            let reference_deg = [Some(10.0), None];
            let time_s = 1000.0 + f64::from(i) * 0.02;
            let attitude = estimate.attitude;
            flight.add(Row { time_s, attitude, nothing_new: false, estimate: &estimate, reference_deg });
        }
        flight.draw("a <flight>", "", &Head::six())
    }

    #[test]
    fn an_hour_is_less_than_a_megabyte() {
        let svg = flight(180_000);
        assert!(svg.len() < 1_000_000, "{}", svg.len());
        assert!(svg.contains("a &lt;flight&gt;") && svg.contains(">sensor-lost:tail<"));
        assert!(svg.contains("roll, reference") && !svg.contains("pitch, reference"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn only_a_withheld_attitude_breaks_the_lines() {
        let mut flight = Flight::default();
        let estimate = Estimate::default();
        let level = Some(Attitude::default());
        let rows = [(level, false), (None, true), (level, false), (None, false), (level, false)];
        for (time_s, (attitude, nothing_new)) in (0_u8..).map(f64::from).zip(rows) {
            flight.add(Row { time_s, attitude, nothing_new, estimate: &estimate, reference_deg: [None; 2] });
        }
        for angle in &flight.angles {
            for line in [&angle.estimate, &angle.band] {
                assert_eq!(line.runs().map(<[_]>::len).collect::<Vec<_>>(), [2, 1]);
            }
        }
    }

    #[test]
    fn the_same_flight_is_the_same_drawing_and_any_is_borne() {
        assert_eq!(flight(5000), flight(5000));
        assert!(flight(1).ends_with("</svg>\n"));
        assert!(flight(0).ends_with("</svg>\n"));
    }
}
