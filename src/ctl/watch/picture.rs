//! The whole picture, a pure function of what was seen and of the size.

use super::canvas::Canvas;
use super::palette::Palette;
use super::{horizon, instruments, panel};
use crate::ctl::status::{duration, finite};
use crate::ctl::view::Status;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

/// The least size of a picture, cells; a line of text below it.
pub const LEAST: (u16, u16) = (60, 20);

/// What was seen of the daemon.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// It has not been asked yet.
    Nothing,
    /// It answered.
    Status(Box<Status>),
    /// It does not answer.
    Silent {
        /// Why.
        reason: String,
        /// For how long, s.
        for_s: f64,
    },
}

/// Draws `seen` over the whole of `buf`.
pub fn draw(seen: &Seen, palette: Palette, buf: &mut Buffer) {
    let area = buf.area;
    buf.reset();
    if area.width < LEAST.0 || area.height < LEAST.1 {
        one_line(seen, palette, buf);
        return;
    }
    let panel_width = (area.width / 3).clamp(24, 34);
    // A cell in the middle, both ways.
    let odd = |n: u16| n - (n + 1) % 2;
    let scene = Rect::new(area.x, area.y, odd(area.width - panel_width - 1), odd(area.height - 1));
    let x = scene.right() + 1;
    let beside = Rect::new(x, area.y, area.right() - x, area.height - 1);
    match seen {
        Seen::Status(s) => {
            match (finite(s.roll_deg), finite(s.pitch_deg)) {
                (Some(roll), Some(pitch)) => {
                    let view = horizon::View::new(roll, pitch, scene);
                    horizon::draw(&view, palette, scene, buf);
                    instruments::draw(&view, palette, scene, buf);
                    if let Some(hint) = s.hint {
                        instruments::hint(hint.bearing_deg, &view, palette, scene, buf);
                    }
                    if s.stands_in() {
                        sign("SHOWN, NOT MEASURED", &reasons(s), palette, scene, buf);
                    }
                }
                _ => withheld("ATTITUDE WITHHELD", &reasons(s), palette, scene, buf),
            }
            panel::draw(s, palette, beside, buf);
            footer(&format!("irhorizon {}", s.version), palette, buf);
        }
        Seen::Silent { reason, for_s } => {
            let lines = [reason.clone(), format!("for {}, trying again", duration(*for_s))];
            withheld("NO DAEMON", &lines, palette, scene, buf);
            footer("irhorizon", palette, buf);
        }
        Seen::Nothing => {
            withheld("ASKING THE DAEMON", &[], palette, scene, buf);
            footer("irhorizon", palette, buf);
        }
    }
}

/// Why there is no attitude, a line each.
fn reasons(s: &Status) -> Vec<String> {
    if s.faults.is_empty() && s.mode == "starting" {
        return vec!["starting: not enough seen yet".to_owned()];
    }
    s.faults.iter().map(|f| f.name.clone()).collect()
}

/// A red cross from corner to corner, and the reasons in the middle of it.
fn withheld(title: &str, lines: &[String], palette: Palette, area: Rect, buf: &mut Buffer) {
    let mut canvas = Canvas::new(area.width, area.height);
    let (x, y) = (f64::from(area.width) - 0.5, 2.0 * f64::from(area.height) - 0.5);
    for shift in [-1.0, 0.0, 1.0] {
        canvas.line((-x + shift, -y), (x + shift, y), (1, 1));
        canvas.line((-x + shift, y), (x + shift, -y), (1, 1));
    }
    let red = palette.pair(Palette::RED, Palette::BLACK);
    for row in 0..area.height {
        for column in 0..area.width {
            let symbol = canvas.character(column, row).unwrap_or(' ');
            buf[(area.x + column, area.y + row)].set_char(symbol).set_style(red);
        }
    }
    sign(title, lines, palette, area, buf);
}

/// A frame in the middle with a title in red and lines below it.
fn sign(title: &str, lines: &[String], palette: Palette, area: Rect, buf: &mut Buffer) {
    let red = palette.pair(Palette::RED, Palette::BLACK);
    let inside = usize::from(area.width).saturating_sub(6);
    let mut text = vec![title.to_owned()];
    text.extend(lines.iter().flat_map(|l| wrap(l, inside)).take(usize::from(area.height) - 6));
    let width = text.iter().map(|l| l.chars().count()).max().unwrap_or(0) as u16 + 4;
    let height = text.len() as u16 + 2;
    let sign = Rect::new(
        area.x + (area.width - width.min(area.width)) / 2,
        area.y + (area.height - height) / 2,
        width.min(area.width),
        height,
    );
    for row in sign.y..sign.bottom() {
        for column in sign.x..sign.right() {
            let side = (column == sign.x, column + 1 == sign.right());
            let symbol = match (row == sign.y, row + 1 == sign.bottom(), side) {
                (true, _, (true, _)) => '╔',
                (true, _, (_, true)) => '╗',
                (_, true, (true, _)) => '╚',
                (_, true, (_, true)) => '╝',
                (true, _, _) | (_, true, _) => '═',
                (_, _, (false, false)) => ' ',
                _ => '║',
            };
            buf[(column, row)].set_char(symbol).set_style(red);
        }
    }
    for (i, line) in text.iter().enumerate() {
        let column = sign.x + (sign.width - (line.chars().count() as u16).min(sign.width)) / 2;
        let style = if i == 0 { palette.bold(Palette::RED) } else { palette.pair(Palette::WHITE, Palette::BLACK) };
        buf.set_stringn(column, sign.y + 1 + i as u16, line, inside, style);
    }
}

/// Cuts a line into lines of at most `width` characters, between words where it can.
pub(super) fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut used = 0;
    for word in text.split_whitespace() {
        let letters: Vec<char> = word.chars().collect();
        for (i, part) in letters.chunks(width.max(1)).enumerate() {
            let blank = usize::from(i == 0 && used > 0);
            if used + blank + part.len() > width && used > 0 {
                lines.push(String::new());
                used = 0;
            }
            if let Some(line) = lines.last_mut() {
                if used > 0 && blank == 1 {
                    line.push(' ');
                    used += 1;
                }
                line.extend(part);
                used += part.len();
            }
        }
    }
    lines
}

fn footer(left: &str, palette: Palette, buf: &mut Buffer) {
    let area = buf.area;
    let row = area.bottom() - 1;
    let grey = palette.text(Palette::GREY);
    buf.set_stringn(area.x, row, left, usize::from(area.width) - 8, grey);
    buf.set_string(area.right() - 7, row, "q quits", grey);
}

/// All that fits into a line.
fn one_line(seen: &Seen, palette: Palette, buf: &mut Buffer) {
    let (text, style) = match seen {
        Seen::Nothing => ("asking the daemon".to_owned(), Style::new()),
        Seen::Silent { reason, .. } => (format!("no daemon: {reason}"), palette.text(Palette::RED)),
        Seen::Status(s) => {
            let style = palette.text(palette.mode(&s.mode));
            let text = match (finite(s.roll_deg), finite(s.pitch_deg)) {
                (Some(roll), Some(pitch)) => format!("roll {roll:+.1}° pitch {pitch:+.1}° {}", s.mode),
                _ => format!("WITHHELD {} {}", s.mode, reasons(s).join(" ")),
            };
            (text, style)
        }
    };
    let area = buf.area;
    if area.height > 0 {
        buf.set_stringn(area.x, area.y, text, usize::from(area.width), style);
    }
}
