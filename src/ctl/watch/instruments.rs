//! What is drawn over the horizon: pitch ladder, bank scale with its pointer, the aircraft.

use super::canvas::Canvas;
use super::horizon::View;
use super::palette::Palette;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier};

/// From the aircraft's middle to its wings, cells.
const GAP: u16 = 3;
const SOLID: (usize, usize) = (1, 1);
/// Below the horizon the ladder is dashed.
const DASHED: (usize, usize) = (2, 4);
/// The marks of the bank scale, °, and their length in dots.
const BANK_MARKS: [(f64, f64); 9] = [
    (-60.0, 4.0),
    (-45.0, 2.0),
    (-30.0, 4.0),
    (-20.0, 2.0),
    (-10.0, 2.0),
    (10.0, 2.0),
    (20.0, 2.0),
    (30.0, 4.0),
    (45.0, 2.0),
];

/// Draws all of them over the horizon in `area`.
pub(super) fn draw(view: &View, palette: Palette, area: Rect, buf: &mut Buffer) {
    let radius = view.half.0.min(view.half.1) - 6.0;
    let mut canvas = Canvas::new(area.width, area.height);
    let labels = ladder(view, radius, &mut canvas);
    bank_scale(view, radius, &mut canvas);
    lay(&canvas, Palette::WHITE, view, palette, area, buf);
    let mut canvas = Canvas::new(area.width, area.height);
    pointer(view, radius, &mut canvas);
    lay(&canvas, Palette::YELLOW, view, palette, area, buf);
    for ((x, y), text) in labels {
        label((x, y), &text, view, palette, area, buf);
    }
    aircraft(view, palette, area, buf);
}

/// A mark at the side on which something warm stands above the horizon, `bearing_deg` clockwise from the nose, at the
/// horizon's height there. Ahead and behind there is no side.
pub(super) fn hint(bearing_deg: f64, view: &View, palette: Palette, area: Rect, buf: &mut Buffer) {
    let (side, symbol, column) = match bearing_deg.to_radians().sin() {
        s if s >= 0.5 => (1.0, '▶', area.width.saturating_sub(1)),
        s if s <= -0.5 => (-1.0, '◀', 0),
        _ => return,
    };
    let row = view.horizon_row(side * view.half.0, area.height);
    put(symbol, Palette::RED, (column, row), view, palette, area, buf);
    buf[(area.x + column, area.y + row)].modifier.insert(Modifier::BOLD);
}

/// Rungs each 10° with their numbers and shorter ones between, inside the bank scale. Gives where
/// the numbers go.
fn ladder(view: &View, radius: f64, canvas: &mut Canvas) -> Vec<((f64, f64), String)> {
    let mut labels = Vec::new();
    let (up, along) = (view.up, (view.up.1, -view.up.0));
    for pitch in (-90_i32..=90).step_by(5).filter(|p| *p != 0) {
        let major = pitch % 10 == 0;
        let rise = (f64::from(pitch) - view.pitch_deg) / view.deg_per_dot;
        let length = radius * if major { 0.26 } else { 0.12 };
        // The pointer is always on the side of the sky.
        let limit = if rise > 0.0 { radius - 12.0 } else { radius - 3.0 };
        if rise.hypot(length) > limit {
            continue;
        }
        let at = |r: f64| (rise * up.0 + r * along.0, rise * up.1 + r * along.1);
        let dashes = if pitch > 0 { SOLID } else { DASHED };
        canvas.line(at(0.0), at(length), dashes);
        canvas.line(at(0.0), at(-length), dashes);
        if major {
            for side in [-1.0, 1.0] {
                labels.push((at(side * (length + 5.0)), pitch.abs().to_string()));
            }
        }
    }
    labels
}

/// The arc with its marks; it stands still.
fn bank_scale(view: &View, radius: f64, canvas: &mut Canvas) {
    let at = |deg: f64, r: f64| (r * deg.to_radians().sin(), r * deg.to_radians().cos());
    for step in -240..=240 {
        let (x, y) = at(f64::from(step) / 4.0, radius);
        canvas.dot(x, y);
    }
    for (deg, length) in BANK_MARKS.into_iter().chain([(60.0, 4.0)]) {
        canvas.line(at(deg, radius), at(deg, radius + length), SOLID);
    }
    // No bank: a triangle that points down onto the arc.
    for step in 0..=4 {
        let half = f64::from(step) * 0.75;
        let y = view.half.1.min(radius + 1.0 + f64::from(step));
        canvas.line((-half, y), (half, y), SOLID);
    }
}

/// The triangle below the arc that points to the zenith.
fn pointer(view: &View, radius: f64, canvas: &mut Canvas) {
    let (up, along) = (view.up, (view.up.1, -view.up.0));
    for step in 0..=18 {
        let step = f64::from(step) / 2.0;
        // Slender, so that it is seen which of its corners points.
        let (r, half) = (radius - 1.5 - step, step * 0.36);
        let at = |s: f64| (r * up.0 + s * along.0, r * up.1 + s * along.1);
        canvas.line(at(-half), at(half), SOLID);
    }
}

/// Lays the dots over what is there.
fn lay(canvas: &Canvas, fg: Color, view: &View, palette: Palette, area: Rect, buf: &mut Buffer) {
    for row in 0..area.height {
        for column in 0..area.width {
            if let Some(symbol) = canvas.character(column, row) {
                put(symbol, fg, (column, row), view, palette, area, buf);
            }
        }
    }
}

fn put(
    symbol: char,
    fg: Color,
    (column, row): (u16, u16),
    view: &View,
    palette: Palette,
    area: Rect,
    buf: &mut Buffer,
) {
    if column < area.width && row < area.height {
        let bg = if view.is_sky(column, row) { Palette::SKY } else { Palette::GROUND };
        buf[(area.x + column, area.y + row)].set_char(symbol).set_style(palette.pair(fg, bg));
    }
}

/// A rung's number around a point.
fn label((x, y): (f64, f64), text: &str, view: &View, palette: Palette, area: Rect, buf: &mut Buffer) {
    let row = ((view.half.1 - y) / 4.0).floor() as i32;
    let first = ((x + view.half.0) / 2.0 - text.len() as f64 / 2.0).round() as i32;
    // Half a number under a wing would be another number.
    let (middle, reach) = (i32::from(area.width / 2), i32::from(GAP + wing(area)) + 2);
    if row == i32::from(area.height / 2) && (first - middle).abs() <= reach {
        return;
    }
    for (i, symbol) in text.chars().enumerate() {
        if let (Ok(column), Ok(row)) = (u16::try_from(first + i as i32), u16::try_from(row)) {
            put(symbol, Palette::WHITE, (column, row), view, palette, area, buf);
        }
    }
}

/// The length of a wing, cells.
fn wing(area: Rect) -> u16 {
    (area.width / 8).clamp(2, 8)
}

/// The aircraft seen from behind; it stands still in the middle.
fn aircraft(view: &View, palette: Palette, area: Rect, buf: &mut Buffer) {
    let (middle, row) = (area.width / 2, area.height / 2);
    let (wing, gap) = (wing(area), GAP);
    for side in [-1_i32, 1] {
        for i in 0..=wing {
            let column = i32::from(middle) + side * i32::from(gap + i);
            let symbol = match (i, side) {
                (0, -1) => '┓',
                (0, _) => '┏',
                _ => '━',
            };
            put(symbol, Palette::YELLOW, (column as u16, row), view, palette, area, buf);
        }
    }
    put('◆', Palette::YELLOW, (middle, row), view, palette, area, buf);
    for column in middle.saturating_sub(gap + wing)..=(middle + gap + wing).min(area.width.saturating_sub(1)) {
        let cell = &mut buf[(area.x + column, area.y + row)];
        cell.modifier.insert(Modifier::BOLD);
    }
}
