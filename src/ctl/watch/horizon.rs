//! Sky over ground, the edge between them to an eighth of a cell.
//!
//! Seen from the cockpit: in a right bank the horizon turns counter-clockwise and its right end
//! rises; nose up, it sinks.

use super::canvas::Canvas;
use super::palette::Palette;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// The pitch from the middle to the upper edge, °.
const HALF_HEIGHT_DEG: f64 = 26.0;
/// Eighths of a cell, filled from below and from the left.
const FROM_BELOW: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
const FROM_LEFT: [char; 9] = [' ', '▏', '▎', '▍', '▌', '▋', '▊', '▉', '█'];
/// Quarters of a cell: bits for upper left, upper right, lower left, lower right.
const QUARTERS: [char; 16] = [' ', '▘', '▝', '▀', '▖', '▌', '▞', '▛', '▗', '▚', '▐', '▜', '▄', '▙', '▟', '█'];
/// Ground where there are no colours.
const PLAIN_GROUND: char = '░';

/// Where the sky lies on the picture. Lengths in dots, x to the right, y up, from the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// The picture of the upward vertical, a unit vector.
    pub up: (f64, f64),
    /// Pitch, °.
    pub pitch_deg: f64,
    /// Degrees of pitch for a dot.
    pub deg_per_dot: f64,
    /// Half the picture's width and height.
    pub half: (f64, f64),
}

impl View {
    pub fn new(roll_deg: f64, pitch_deg: f64, area: Rect) -> Self {
        let (sin, cos) = roll_deg.to_radians().sin_cos();
        let half = (f64::from(area.width), 2.0 * f64::from(area.height));
        Self { up: (-sin, cos), pitch_deg, deg_per_dot: HALF_HEIGHT_DEG / half.1, half }
    }

    /// How far the horizon lies below the middle, along `up`; held back so that a sliver of sky or
    /// ground always says where the rest is.
    fn drop(&self) -> f64 {
        let edge = self.up.0.abs() * self.half.0 + self.up.1.abs() * self.half.1 - 5.0;
        (self.pitch_deg / self.deg_per_dot).clamp(-edge, edge)
    }

    /// How far a point lies above the horizon, along `up`.
    fn above(&self, x: f64, y: f64) -> f64 {
        self.drop() + x * self.up.0 + y * self.up.1
    }

    /// The row of `rows` in which the horizon lies at `x`, or the nearest to it.
    pub fn horizon_row(&self, x: f64, rows: u16) -> u16 {
        let y = -(self.drop() + x * self.up.0) / self.up.1;
        // A cast saturates, and sends NaN (a horizon that stands upright) to 0.
        let row = ((self.half.1 - y) / 4.0).floor() as u16;
        row.min(rows.saturating_sub(1))
    }

    /// The middle of a cell.
    fn middle(&self, column: u16, row: u16) -> (f64, f64) {
        (f64::from(2 * column) + 1.0 - self.half.0, self.half.1 - f64::from(4 * row) - 2.0)
    }

    /// Whether a cell is more sky than ground.
    pub fn is_sky(&self, column: u16, row: u16) -> bool {
        let (x, y) = self.middle(column, row);
        self.above(x, y) >= 0.0
    }
}

/// Fills `area` with sky and ground.
pub(super) fn draw(view: &View, palette: Palette, area: Rect, buf: &mut Buffer) {
    for row in 0..area.height {
        for column in 0..area.width {
            let (symbol, fg, bg) = cell(view, column, row);
            let cell = &mut buf[(area.x + column, area.y + row)];
            if palette.colours {
                cell.set_char(symbol).set_style(palette.pair(fg, bg));
            } else {
                cell.set_char(if view.is_sky(column, row) { ' ' } else { PLAIN_GROUND });
            }
        }
    }
    if !palette.colours {
        plain_edge(view, area, buf);
    }
}

/// A cell's character, and the colours of what it fills and of the rest.
fn cell(view: &View, column: u16, row: u16) -> (char, ratatui::style::Color, ratatui::style::Color) {
    let (sky, ground) = (Palette::SKY, Palette::GROUND);
    let (x, y) = view.middle(column, row);
    let above = view.above(x, y);
    let (up_x, up_y) = view.up;
    if above.abs() >= up_x.abs() + 2.0 * up_y.abs() {
        return (' ', ground, if above > 0.0 { sky } else { ground });
    }
    let eighths = |part: f64| (8.0 * part).round().clamp(0.0, 8.0) as usize;
    // Where the edge meets the cell's sides, its floor and its ceiling; the cell is 2 × 4 dots.
    let at_sides = [-1.0, 1.0].map(|x| -(above + x * up_x) / up_y);
    let at_ends = [-2.0, 2.0].map(|y| -(above + y * up_y) / up_x);
    if at_sides.iter().all(|y| y.abs() <= 2.0) {
        let (below, over) = if up_y > 0.0 { (ground, sky) } else { (sky, ground) };
        (FROM_BELOW[eighths((2.0 - above / up_y) / 4.0)], below, over)
    } else if at_ends.iter().all(|x| x.abs() <= 1.0) {
        let (left, right) = if up_x > 0.0 { (ground, sky) } else { (sky, ground) };
        (FROM_LEFT[eighths((1.0 - above / up_x) / 2.0)], left, right)
    } else {
        let quarters = [(-0.5, 1.0), (0.5, 1.0), (-0.5, -1.0), (0.5, -1.0)];
        let below = |(x, y): (f64, f64)| usize::from(above + x * up_x + y * up_y < 0.0);
        let index = quarters.iter().rev().fold(0, |bits, q| 2 * bits + below(*q));
        (QUARTERS[index], ground, sky)
    }
}

/// The edge as a line of dots.
fn plain_edge(view: &View, area: Rect, buf: &mut Buffer) {
    let mut canvas = Canvas::new(area.width, area.height);
    let (up_x, up_y) = view.up;
    let (x, y) = (-view.drop() * up_x, -view.drop() * up_y);
    let reach = view.half.0 + view.half.1;
    let ends = [reach, -reach].map(|r| (x + r * up_y, y - r * up_x));
    canvas.line(ends[0], ends[1], (1, 1));
    for row in 0..area.height {
        for column in 0..area.width {
            if let Some(symbol) = canvas.character(column, row) {
                buf[(area.x + column, area.y + row)].set_char(symbol);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rect = Rect { x: 0, y: 0, width: 41, height: 21 };

    #[test]
    fn a_right_bank_lifts_the_right_end_and_nose_up_sinks_the_horizon() {
        let bank = View::new(30.0, 0.0, AREA);
        assert!(bank.is_sky(2, 10) && !bank.is_sky(38, 10));
        let climb = View::new(0.0, 15.0, AREA);
        assert!(climb.is_sky(20, 10) && climb.is_sky(20, 14) && !climb.is_sky(20, 20));
        let back = View::new(180.0, 0.0, AREA);
        assert!(!back.is_sky(20, 2) && back.is_sky(20, 18));
    }

    #[test]
    fn a_sliver_is_left_at_any_attitude() {
        for roll in (-180..=180).step_by(7) {
            for pitch in [-90.0, -60.0, 60.0, 90.0] {
                let view = View::new(f64::from(roll), pitch, AREA);
                let sky = (0..21).flat_map(|r| (0..41).map(move |c| (c, r))).filter(|(c, r)| view.is_sky(*c, *r));
                assert!((1..41 * 21).contains(&sky.count()), "{roll} {pitch}");
            }
        }
    }

    #[test]
    fn the_edge_moves_by_eighths() {
        // An eighth of a cell is half a dot.
        let dot = View::new(0.0, 0.0, AREA).deg_per_dot;
        let at = |dots: f64| cell(&View::new(0.0, dots * dot, AREA), 20, 10).0;
        assert_eq!([at(0.0), at(0.5), at(1.0), at(-0.5)], ['▄', '▃', '▂', '▅']);
    }
}
