//! Colours of different lightness and lines of different dashes: a print in black and white reads too.

/// The sheet.
pub const PAPER: &str = "#ffffff";
/// Texts and frames.
pub const INK: &str = "#1a1a1a";
/// Texts of less weight.
pub const SOFT: &str = "#555555";
/// A band of uncertainty.
pub const BAND: &str = "#c9dcee";
/// A fault's bar.
pub const FAULT: &str = "#b5452a";
/// The strip behind bars.
pub const STRIP: &str = "#f4f4f2";

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: &'static str,
    /// Its width.
    pub width: f64,
    /// Its dashes and gaps; empty: unbroken.
    pub dash: &'static str,
}

const fn stroke(colour: &'static str, width: f64, dash: &'static str) -> Stroke {
    Stroke { colour, width, dash }
}

/// A panel's frame.
pub const FRAME: Stroke = stroke("#444444", 1.0, "");
/// A tick's line across a panel.
pub const GRID: Stroke = stroke("#e3e3e0", 1.0, "");
/// The line at zero.
pub const ZERO: Stroke = stroke("#9a9a96", 1.0, "");
/// What was estimated.
pub const ESTIMATE: Stroke = stroke("#10508f", 1.2, "");
/// What it is compared with.
pub const REFERENCE: Stroke = stroke("#c8501e", 1.3, "5 3");
/// The first of several curves.
pub const FIRST: Stroke = stroke("#10508f", 2.0, "");
/// The second.
pub const SECOND: Stroke = stroke("#c8501e", 2.0, "8 4");
/// The third.
pub const THIRD: Stroke = stroke("#3a3a3a", 1.6, "2 3");
