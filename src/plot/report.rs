//! Figures 6 to 9 of MECSE-2-2007, drawn anew from this program's own sky.
//!
//! The report's sensors see 100°, in the plane, all of it alike. Durham's `SkyMax` is this program's
//! choice ([`Sky::DURHAM`]); the measurements behind figure 6 are not drawn, only the exponentials.

use super::axis::Axis;
use super::chart::{Curve, Panel, heading};
use super::style::{FIRST, SECOND, Stroke, THIRD};
use super::svg::{Area, Point, Svg};
use crate::sky::{Averaging, FieldOfView, Response, Sky};

/// Half the field of view of the report's sensors, °.
const HALF_FIELD_DEG: f64 = 50.0;
/// From point to point of a curve, °.
const GRAIN_DEG: f64 = 0.5;

/// A figure of the report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Its number in the report.
    pub number: u32,
    /// The drawing.
    pub svg: String,
}

/// A curve of a figure with its name.
type Named = (&'static str, Stroke, Vec<Point>);

/// Figures 6, 7, 8 and 9.
pub fn figures() -> Vec<Figure> {
    [(6, figure_6()), (7, figure_7()), (8, figure_8()), (9, figure_9())]
        .map(|(number, svg)| Figure { number, svg })
        .into()
}

fn figure_6() -> String {
    let sky = |sky: Sky| along(0.0, 90.0, |e| sky.temperature_c(e));
    draw(
        "Figure 6. Sky temperature against elevation",
        "exponential approximations: Namibia, ground 16 °C, SkyMax 40 K; Durham, ground 5 °C, SkyMax 30 K (chosen)",
        ("elevation, °", Axis::degrees(0.0, 90.0, 6)),
        ("sky temperature, °C", Axis::rounded(-30.0, 20.0, 5)),
        vec![("Namibia", FIRST, sky(Sky::NAMIBIA)), ("Durham", SECOND, sky(Sky::DURHAM))],
    )
}

fn figure_7() -> String {
    let (r, sky) = (response(), Sky::NAMIBIA);
    let at = |e: f64| r.sensor_c(e.to_radians().sin(), sky.ground_c, sky.sky_max_k);
    draw(
        "Figure 7. The two sensors of a pair, and their difference, Namibia",
        "each sensor sees ±50° in the plane; the second looks opposite to the first",
        ("elevation angle of the first sensor, °", Axis::degrees(0.0, 360.0, 8)),
        ("temperature, °C; difference, K", Axis::rounded(-40.0, 40.0, 8)),
        vec![
            ("first sensor", SECOND, along(0.0, 360.0, at)),
            ("second sensor", THIRD, along(0.0, 360.0, |e| at(-e))),
            ("second − first", FIRST, along(0.0, 360.0, |e| at(-e) - at(e))),
        ],
    )
}

fn figure_8() -> String {
    let r = response();
    let pair = |sky: Sky| along(-90.0, 90.0, |e| r.pair_k(e.to_radians().sin(), sky.ground_c, sky.sky_max_k));
    let durham = r.pair_k(1.0, Sky::DURHAM.ground_c, Sky::DURHAM.sky_max_k);
    draw(
        "Figure 8. Output of a sensor pair, with the sine for Durham",
        "each sensor sees ±50° in the plane; the sine is the smaller in size: angles taken from it are too large",
        ("elevation angle, °", Axis::degrees(-90.0, 90.0, 6)),
        ("temperature difference, K", Axis::rounded(-40.0, 40.0, 8)),
        vec![
            ("Namibia", FIRST, pair(Sky::NAMIBIA)),
            ("Durham", SECOND, pair(Sky::DURHAM)),
            ("sine, Durham", THIRD, along(-90.0, 90.0, |e| durham * e.to_radians().sin())),
        ],
    )
}

fn figure_9() -> String {
    let curve = response().pair_curve(Sky::NAMIBIA.ground_c, Sky::NAMIBIA.sky_max_k);
    draw(
        "Figure 9. Normalised output of a sensor pair, with the sine",
        "Namibia; each sensor sees ±50° in the plane; relative to the output at 90°",
        ("elevation angle, °", Axis::degrees(-90.0, 90.0, 6)),
        ("output over its largest", Axis::rounded(-1.0, 1.0, 8)),
        vec![
            ("Namibia", FIRST, along(-90.0, 90.0, |e| curve.g(e.to_radians().sin()))),
            ("sine", THIRD, along(-90.0, 90.0, |e| e.to_radians().sin())),
        ],
    )
}

fn response() -> Response {
    let field = FieldOfView::InPlane { half_deg: HALF_FIELD_DEG };
    Response::new(Sky::NAMIBIA.shape, field, Averaging::Temperature)
}

/// `value` at each angle from `low` to `high`.
fn along(low: f64, high: f64, value: impl Fn(f64) -> f64) -> Vec<Point> {
    let steps = ((high - low) / GRAIN_DEG) as u32;
    (0..=steps).map(|i| low + f64::from(i) * GRAIN_DEG).map(|e| (e, value(e))).collect()
}

fn draw(title: &str, remark: &str, (x_name, x): (&str, Axis), (y_name, y): (&str, Axis), curves: Vec<Named>) -> String {
    let mut svg = Svg::new(800.0, 480.0);
    heading(&mut svg, 70.0, title, remark);
    let area = Area { x: 70.0, y: 62.0, width: 560.0, height: 364.0 };
    let curves = curves.iter().map(|(name, stroke, points)| (Curve::Points(points, *stroke), (*name).to_owned()));
    Panel { area, x: &x, x_name: Some(x_name), y, y_name, curves: curves.collect() }.draw(&mut svg);
    svg.finish()
}
