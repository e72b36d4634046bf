//! A panel: axes with ticks and grid, curves and bands, a legend beside it where it hides nothing.

use super::axis::Axis;
use super::envelope::{Cell, Envelope};
use super::style::{BAND, FRAME, GRID, INK, SOFT, Stroke, ZERO};
use super::svg::{Anchor, Area, Point, Svg, cut};
use std::iter;

/// From a panel to its legend.
const TO_LEGEND: f64 = 16.0;
/// The length of a legend's sample.
const SAMPLE: f64 = 30.0;
/// From line to line of a legend.
const LEGEND_LINE: f64 = 20.0;

/// What is drawn in a panel.
#[derive(Debug)]
pub enum Curve<'a> {
    /// A line through points.
    Points(&'a [Point], Stroke),
    /// A line through a long series.
    Series(&'a Envelope, Stroke),
    /// The room between the lower and upper end of a series.
    Band(&'a Envelope),
}

/// A panel.
#[derive(Debug)]
pub struct Panel<'a> {
    /// Where its frame is.
    pub area: Area,
    /// The horizontal axis.
    pub x: &'a Axis,
    /// Its name with the unit; none: the ticks have no labels.
    pub x_name: Option<&'a str>,
    /// The vertical axis.
    pub y: Axis,
    /// Its name with the unit.
    pub y_name: &'a str,
    /// What is drawn in it, and what it is called; nothing under an empty name.
    pub curves: Vec<(Curve<'a>, String)>,
}

impl Panel<'_> {
    /// Draws it.
    pub fn draw(&self, svg: &mut Svg) {
        let area = self.area;
        grid(svg, area, self.x, self.x_name);
        let place_y = |value: f64| area.bottom() - area.height * self.y.share(value);
        for (tick, label) in self.y.ticks() {
            let y = place_y(tick);
            let stroke = if tick == 0.0 { ZERO } else { GRID };
            svg.lines(iter::once([(area.x, y), (area.right(), y)].into_iter()), stroke);
            svg.text((area.x - 7.0, y + 4.5), Anchor::End, 12.0, "", &label);
        }
        let (x, y) = (area.x - 46.0, area.y + area.height / 2.0);
        let turned = format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"");
        svg.text((x, y), Anchor::Middle, 13.0, &turned, self.y_name);
        svg.clipped(area, |svg| {
            // Bands lie under the lines.
            let (bands, lines): (Vec<_>, Vec<_>) = self.curves.iter().partition(|(c, _)| matches!(c, Curve::Band(_)));
            for (curve, _) in bands.into_iter().chain(lines) {
                self.curve(curve, svg);
            }
        });
        svg.outline(area, FRAME);
        let named = self.curves.iter().filter(|(_, name)| !name.is_empty());
        for (i, (curve, name)) in named.enumerate() {
            legend(svg, (area.right() + TO_LEGEND, area.y + 10.0 + LEGEND_LINE * i as f64), curve, name);
        }
    }

    fn place(&self, (x, y): Point) -> Point {
        let a = self.area;
        (a.x + a.width * self.x.share(x), a.bottom() - a.height * self.y.share(y))
    }

    fn points<'a>(&'a self, run: &'a [Cell]) -> impl Iterator<Item = Point> + 'a {
        run.iter().flat_map(Cell::points).map(|p| self.place(p))
    }

    fn curve(&self, curve: &Curve<'_>, svg: &mut Svg) {
        match curve {
            Curve::Points(points, stroke) => svg.lines(iter::once(points.iter().map(|p| self.place(*p))), *stroke),
            Curve::Series(series, stroke) => {
                svg.lines(series.runs().map(|run| self.points(run)), *stroke);
            }
            Curve::Band(series) => {
                for run in series.runs() {
                    let edge = |c: &Cell, upper: bool| {
                        let (low, high) = c.values.unwrap_or((f64::NAN, f64::NAN));
                        self.place((c.time_s(), if upper { high } else { low }))
                    };
                    svg.shape(run.iter().map(|c| edge(c, true)), run.iter().rev().map(|c| edge(c, false)), BAND);
                }
            }
        }
    }
}

/// A drawing's title, and what else there is to say of it.
pub fn heading(svg: &mut Svg, x: f64, title: &str, remark: &str) {
    svg.text((x, 26.0), Anchor::Start, 16.0, " font-weight=\"bold\"", &cut(title, 100));
    svg.text((x, 45.0), Anchor::Start, 12.0, &format!(" fill=\"{SOFT}\""), &cut(remark, 150));
}

/// The lines across a panel at the ticks of its horizontal axis, with labels if the axis is named.
pub fn grid(svg: &mut Svg, area: Area, axis: &Axis, name: Option<&str>) {
    for (tick, label) in axis.ticks() {
        let x = area.x + area.width * axis.share(tick);
        svg.lines(iter::once([(x, area.y), (x, area.bottom())].into_iter()), GRID);
        if name.is_some() {
            svg.text((x, area.bottom() + 18.0), Anchor::Middle, 12.0, "", &label);
        }
    }
    if let Some(name) = name {
        svg.text((area.x + area.width / 2.0, area.bottom() + 38.0), Anchor::Middle, 13.0, "", name);
    }
}

/// A sample of a curve and its name.
fn legend(svg: &mut Svg, (x, y): Point, curve: &Curve<'_>, name: &str) {
    match curve {
        Curve::Points(_, stroke) | Curve::Series(_, stroke) => {
            svg.lines(iter::once([(x, y), (x + SAMPLE, y)].into_iter()), *stroke);
        }
        Curve::Band(_) => svg.fill(Area { x, y: y - 6.0, width: SAMPLE, height: 12.0 }, BAND),
    }
    svg.text((x + SAMPLE + 8.0, y + 4.5), Anchor::Start, 12.0, &format!(" fill=\"{INK}\""), &cut(name, 22));
}
