//! The few elements of SVG that are drawn, with a tenth of a unit in each place.

use super::style::{INK, PAPER, Stroke};
use crate::recording::push_fixed;
use std::fmt::Write as _;

/// A place on the paper: x to the right, y down.
pub type Point = (f64, f64);

/// A rectangle on the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Its left edge.
    pub x: f64,
    /// Its upper edge.
    pub y: f64,
    /// Its width.
    pub width: f64,
    /// Its height.
    pub height: f64,
}

impl Area {
    /// Its right edge.
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    /// Its lower edge.
    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }
}

/// How a text stands to its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// A drawing being made.
#[derive(Debug)]
pub struct Svg {
    text: String,
    clips: usize,
}

impl Svg {
    /// An empty sheet.
    pub fn new(width: f64, height: f64) -> Self {
        let mut svg = Self { text: String::with_capacity(64 * 1024), clips: 0 };
        let _ = writeln!(
            svg.text,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" \
             font-size=\"13\" fill=\"{INK}\" stroke-linejoin=\"round\" stroke-linecap=\"butt\">"
        );
        svg.fill(Area { x: 0.0, y: 0.0, width, height }, PAPER);
        svg
    }

    /// The drawing, closed.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }

    /// A filled rectangle.
    pub fn fill(&mut self, area: Area, colour: &str) {
        self.rect(area);
        let _ = writeln!(self.text, " fill=\"{colour}\"/>");
    }

    /// The outline of a rectangle.
    pub fn outline(&mut self, area: Area, stroke: Stroke) {
        self.rect(area);
        self.text.push_str(" fill=\"none\"");
        self.stroke(stroke);
        self.text.push_str("/>\n");
    }

    /// Lines from point to point of each run; a point alone is a dot.
    pub fn lines(&mut self, runs: impl Iterator<Item = impl Iterator<Item = Point>>, stroke: Stroke) {
        self.text.push_str("<path fill=\"none\"");
        self.stroke(stroke);
        self.text.push_str(" d=\"");
        let mut dots = String::new();
        for run in runs {
            let start = self.text.len();
            let points = self.run(run, 'M');
            if points == 1 {
                dots.push_str(&self.text[start..]);
                dots.push_str("h0");
                self.text.truncate(start);
            }
        }
        self.text.push_str("\"/>\n");
        if !dots.is_empty() {
            let _ = write!(self.text, "<path fill=\"none\" stroke-linecap=\"round\" stroke=\"{}\"", stroke.colour);
            let _ = writeln!(self.text, " stroke-width=\"{}\" d=\"{dots}\"/>", 1.5 * stroke.width);
        }
    }

    /// A filled shape along `there` and back along `back`.
    pub fn shape(&mut self, there: impl Iterator<Item = Point>, back: impl Iterator<Item = Point>, colour: &str) {
        let _ = write!(self.text, "<path fill=\"{colour}\" d=\"");
        self.run(there, 'M');
        self.run(back, 'L');
        self.text.push_str("Z\"/>\n");
    }

    /// A text of `size`; `attributes` are further ones, ready to be written.
    pub fn text(&mut self, (x, y): Point, anchor: Anchor, size: f64, attributes: &str, text: &str) {
        self.text.push_str("<text x=\"");
        push_fixed(&mut self.text, x, 1);
        self.text.push_str("\" y=\"");
        push_fixed(&mut self.text, y, 1);
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let _ = writeln!(self.text, "\"{anchor} font-size=\"{size}\"{attributes}>{}</text>", escaped(text));
    }

    /// What `draw` draws shows within `area` alone.
    pub fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Self)) {
        self.clips += 1;
        let n = self.clips;
        let _ = write!(self.text, "<clipPath id=\"clip{n}\">");
        self.rect(area);
        let _ = writeln!(self.text, "/></clipPath>\n<g clip-path=\"url(#clip{n})\">");
        draw(self);
        self.text.push_str("</g>\n");
    }

    fn rect(&mut self, area: Area) {
        self.text.push_str("<rect");
        for (name, value) in [("x", area.x), ("y", area.y), ("width", area.width), ("height", area.height)] {
            let _ = write!(self.text, " {name}=\"");
            push_fixed(&mut self.text, value, 1);
            self.text.push('"');
        }
    }

    fn stroke(&mut self, stroke: Stroke) {
        let _ = write!(self.text, " stroke=\"{}\" stroke-width=\"{}\"", stroke.colour, stroke.width);
        if !stroke.dash.is_empty() {
            let _ = write!(self.text, " stroke-dasharray=\"{}\"", stroke.dash);
        }
    }

    /// The points of a path; gives how many there are. What is no number is left out.
    fn run(&mut self, points: impl Iterator<Item = Point>, first: char) -> usize {
        let mut count = 0;
        for (x, y) in points.filter(|(x, y)| x.is_finite() && y.is_finite()) {
            self.text.push(match count {
                0 => first,
                1 => 'L',
                _ => ' ',
            });
            // Far outside the sheet there is nothing to see, and renderers lose their way.
            push_fixed(&mut self.text, x.clamp(-1e4, 1e4), 1);
            self.text.push(',');
            push_fixed(&mut self.text, y.clamp(-1e4, 1e4), 1);
            count += 1;
        }
        count
    }
}

/// Text as it may stand in XML.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// The text, cut to `most` characters.
pub fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most { text.to_owned() } else { text.chars().take(most - 1).chain(['…']).collect() }
}

#[cfg(test)]
mod tests {
    use super::super::style::REFERENCE;
    use super::*;

    #[test]
    fn any_text_may_be_written() {
        assert_eq!(escaped("a<b>&\u{0}\u{7f}\"é"), "a&lt;b&gt;&amp;\u{fffd}\u{fffd}\"é");
        assert_eq!(cut("abcdef", 4), "abc…");
        assert_eq!(cut("äbcd", 4), "äbcd");
    }

    #[test]
    fn a_point_alone_is_a_dot_and_no_number_is_no_point() {
        let mut svg = Svg::new(10.0, 10.0);
        let runs = [vec![(1.0, 2.0)], vec![(f64::NAN, 0.0), (3.0, 4.0), (1e300, -1e300)], vec![]];
        svg.lines(runs.into_iter().map(Vec::into_iter), REFERENCE);
        let text = svg.finish();
        assert!(text.contains("d=\"M3.0,4.0L10000.0,-10000.0\""), "{text}");
        assert!(text.contains("d=\"M1.0,2.0h0\""), "{text}");
    }
}
