//! Colours, or none (NO_COLOR, a file, a dumb terminal).

use ratatui::style::{Color, Modifier, Style};

/// Whether there are colours, and which. The 256-colour indices are the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Whether to use colours at all.
    pub colours: bool,
}

impl Palette {
    /// The sky.
    pub const SKY: Color = Color::Indexed(26);
    /// The ground.
    pub const GROUND: Color = Color::Indexed(94);
    /// Scales and ladder.
    pub const WHITE: Color = Color::Indexed(231);
    /// The aircraft.
    pub const YELLOW: Color = Color::Indexed(226);
    /// What needs attention.
    pub const AMBER: Color = Color::Indexed(214);
    /// What must not be used.
    pub const RED: Color = Color::Indexed(196);
    /// What is as it should be.
    pub const GREEN: Color = Color::Indexed(77);
    /// Labels.
    pub const GREY: Color = Color::Indexed(245);
    /// Behind a withheld attitude.
    pub const BLACK: Color = Color::Indexed(16);

    /// `fg` on `bg`.
    pub fn pair(self, fg: Color, bg: Color) -> Style {
        if self.colours { Style::new().fg(fg).bg(bg) } else { Style::new() }
    }

    /// Text in `fg`.
    pub fn text(self, fg: Color) -> Style {
        if self.colours { Style::new().fg(fg) } else { Style::new() }
    }

    /// Bold text in `fg`.
    pub fn bold(self, fg: Color) -> Style {
        self.text(fg).add_modifier(Modifier::BOLD)
    }

    /// The colour of a mode's word.
    pub fn mode(self, mode: &str) -> Color {
        match mode {
            "nominal" => Self::GREEN,
            "degraded" | "starting" => Self::AMBER,
            _ => Self::RED,
        }
    }
}
