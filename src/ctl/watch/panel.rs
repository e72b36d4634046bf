//! The readouts beside the horizon.

use super::palette::Palette;
use super::picture::wrap;
use crate::ctl::status::{duration, finite, number};
use crate::ctl::view::{Sensor, Status};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};

/// The contrast at which the bar is full, K: a clear and dry sky.
const FULL_CONTRAST_K: f64 = 40.0;
/// The age from which a sample is shown in amber, s.
const OLD_S: f64 = 0.5;

/// Draws the state in `area`, the most important first.
pub(super) fn draw(s: &Status, palette: Palette, area: Rect, buf: &mut Buffer) {
    let mut p = Panel { palette, area, row: area.y, buf };
    p.angle("ROLL", s.roll_deg, s.roll_sigma_deg);
    p.angle("PITCH", s.pitch_deg, s.pitch_sigma_deg);
    let mode = palette.mode(&s.mode);
    p.pair("MODE", &s.mode.to_uppercase(), palette.bold(mode));
    p.contrast(finite(s.contrast_c));
    if let Some(hint) = s.hint {
        let text = format!("{} K at {}°", number(hint.strength_c, 1), number(hint.bearing_deg, 0));
        p.pair("WARM", &text, palette.text(Palette::AMBER));
    }
    p.pair("RATE", &format!("{} Hz", number(s.rate_hz, 1)), Style::new());
    let (age, old) = match s.sample_time_usec {
        0 => ("none yet".to_owned(), true),
        _ => (duration(s.sample_age_s), !(0.0..OLD_S).contains(&s.sample_age_s)),
    };
    p.pair("SAMPLE AGE", &age, if old { palette.bold(Palette::AMBER) } else { Style::new() });
    p.pair("METHOD", &s.method, Style::new());
    // The sensors' lines are kept free for them as long as the faults leave any.
    let sensors = 1 + s.sensors.len() as u16;
    let most = p.left().saturating_sub(sensors).max(2);
    p.faults(s, most);
    p.sensors(&s.sensors);
}

struct Panel<'a> {
    palette: Palette,
    area: Rect,
    row: u16,
    buf: &'a mut Buffer,
}

impl Panel<'_> {
    fn left(&self) -> u16 {
        self.area.bottom().saturating_sub(self.row)
    }

    /// A label on the left, a value on the right.
    fn pair(&mut self, label: &str, value: &str, style: Style) {
        if self.left() == 0 {
            return;
        }
        let width = usize::from(self.area.width);
        let shown: String = value.chars().take(width).collect();
        let start = self.area.right() - shown.chars().count() as u16;
        let room = usize::from(start - self.area.x);
        self.buf.set_stringn(self.area.x, self.row, label, room, self.palette.text(Palette::GREY));
        self.buf.set_stringn(start, self.row, shown, width, style);
        self.row += 1;
    }

    fn angle(&mut self, label: &str, value: Option<f64>, sigma: Option<f64>) {
        let bold = Style::new().add_modifier(Modifier::BOLD);
        match finite(value) {
            Some(v) => {
                let v = if v.abs() < 0.05 { 0.0 } else { v };
                let sigma = finite(sigma).map_or_else(|| "?".into(), |s| format!("{s:.1}"));
                self.pair(label, &format!("{v:+.1}° ±{sigma:>4}"), bold);
            }
            None => self.pair(label, "withheld", self.palette.bold(Palette::RED)),
        }
    }

    fn contrast(&mut self, contrast_k: Option<f64>) {
        let Some(k) = contrast_k else {
            self.pair("CONTRAST", "not seen yet", Style::new());
            return;
        };
        self.pair("CONTRAST", &format!("{k:.1} K"), Style::new());
        if self.left() == 0 {
            return;
        }
        let full = (k / FULL_CONTRAST_K * f64::from(self.area.width)).round().clamp(0.0, f64::from(self.area.width));
        for i in 0..self.area.width {
            let symbol = if f64::from(i) < full { '█' } else { '░' };
            let style = self.palette.text(self.bar_colour(k));
            self.buf[(self.area.x + i, self.row)].set_char(symbol).set_style(style);
        }
        self.row += 1;
    }

    fn bar_colour(&self, k: f64) -> Color {
        match k {
            ..3.0 => Palette::RED,
            ..8.0 => Palette::AMBER,
            _ => Palette::GREEN,
        }
    }

    /// The faults in at most `most` lines, with their evidence where there is room.
    fn faults(&mut self, s: &Status, most: u16) {
        let most = usize::from(most.min(self.left()));
        if s.faults.is_empty() {
            self.pair("FAULTS", "none", Style::new());
            return;
        }
        self.pair("FAULTS", &s.faults.len().to_string(), self.palette.bold(Palette::AMBER));
        let width = usize::from(self.area.width);
        let room = most.saturating_sub(1);
        let evidence: Vec<_> = s.faults.iter().map(|f| wrap(&f.evidence, width - 2)).collect();
        let all = s.faults.len() + evidence.iter().map(Vec::len).sum::<usize>();
        let shown = if s.faults.len() <= room { s.faults.len() } else { room.saturating_sub(1) };
        for (fault, evidence) in s.faults.iter().zip(&evidence).take(shown) {
            let since = duration(fault.for_s);
            let colour = self.palette.text(Palette::AMBER);
            let row = self.row;
            self.pair("", &since, Style::new());
            let name_width = width.saturating_sub(since.chars().count() + 1);
            self.buf.set_stringn(self.area.x, row, &fault.name, name_width, colour);
            for line in evidence.iter().take(if all <= room { usize::MAX } else { 0 }) {
                self.line(&format!("  {line}"), Style::new());
            }
        }
        if shown < s.faults.len() {
            self.line(&format!("and {} more", s.faults.len() - shown), self.palette.text(Palette::AMBER));
        }
    }

    fn sensors(&mut self, sensors: &[Sensor]) {
        if sensors.is_empty() || self.left() < 2 {
            return;
        }
        let ok = sensors.iter().filter(|s| s.state == "ok").count();
        self.pair("SENSORS", &format!("{ok} of {} ok", sensors.len()), Style::new());
        let room = usize::from(self.left());
        let shown = if sensors.len() <= room { sensors.len() } else { room.saturating_sub(1) };
        for s in sensors.iter().take(shown) {
            let number = |v: Option<f64>| finite(v).map_or_else(|| "-".into(), |v| format!("{v:.1}"));
            let (text, style) = match (finite(s.volts), s.state.as_str()) {
                (Some(v), "ok") => (format!("{v:+.4} V"), Style::new()),
                (None, "ok") => (format!("{} °C ({:>5})", number(s.object_c), number(s.ambient_c)), Style::new()),
                (_, state) => (state.to_owned(), self.palette.text(Palette::RED)),
            };
            self.pair(&s.name, &text, style);
        }
        if shown < sensors.len() {
            self.line(&format!("and {} more", sensors.len() - shown), Style::new());
        }
    }

    fn line(&mut self, text: &str, style: Style) {
        if self.left() > 0 {
            self.buf.set_stringn(self.area.x, self.row, text, usize::from(self.area.width), style);
            self.row += 1;
        }
    }
}
