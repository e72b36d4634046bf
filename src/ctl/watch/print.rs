//! One picture as text.

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};
use std::fmt::Write as _;

/// The characters, a line each, blanks at the ends cut off.
pub fn text(buf: &Buffer) -> String {
    let mut out = String::new();
    for row in buf.content.chunks(usize::from(buf.area.width).max(1)) {
        let line: String = row.iter().map(Cell::symbol).collect();
        out.push_str(line.trim_end());
        out.push('\n');
    }
    out
}

/// The characters in their colours (ECMA-48 SGR, 256 colours).
pub fn ansi(buf: &Buffer) -> String {
    let mut out = String::new();
    for row in buf.content.chunks(usize::from(buf.area.width).max(1)) {
        let mut last = None;
        for cell in row {
            let style = (cell.fg, cell.bg, cell.modifier);
            if last != Some(style) {
                out.push_str("\x1b[0");
                if cell.modifier.contains(Modifier::BOLD) {
                    out.push_str(";1");
                }
                for (code, colour) in [(38, cell.fg), (48, cell.bg)] {
                    if let Color::Indexed(i) = colour {
                        let _ = write!(out, ";{code};5;{i}");
                    }
                }
                out.push('m');
                last = Some(style);
            }
            out.push_str(cell.symbol());
        }
        out.push_str("\x1b[0m\n");
    }
    out
}
