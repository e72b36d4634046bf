//! How far around the aircraft looks.
//!
//! In straight flight a warm side of the sky is always on the same side, and looks like an attitude, or like sensors that are
//! off. Nothing that lasts as long tells them apart until the aircraft turns. In a circle with one bank sensors that are off
//! still look like a bank.

/// So many headings are kept, one every so often, s: a minute in all.
const KEPT: usize = 12;
const EVERY_S: f64 = 5.0;

/// The headings of the last minute, from any one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Around {
    turn: f64,
    heading: f64,
    kept: [f64; KEPT],
    since_s: f64,
    next: usize,
    known: bool,
    ever: f64,
    /// The least and the most sine of a bank.
    banks: Option<(f64, f64)>,
}

impl Around {
    /// It turns about the vertical by `turn`, rad, in `dt_s`, with this sine of its bank.
    pub fn update(&mut self, turn: f64, bank: f64, dt_s: f64) {
        let (least, most) = self.banks.unwrap_or((bank, bank));
        self.banks = Some((least.min(bank), most.max(bank)));
        self.turn = turn;
        self.heading += turn;
        self.since_s += dt_s;
        if self.since_s >= EVERY_S {
            self.since_s = 0.0;
            self.kept[self.next] = self.heading;
            self.next = (self.next + 1) % KEPT;
            self.known |= self.next == 0;
        }
        self.ever = self.ever.max(self.lately());
    }

    /// How far it has just turned, rad.
    pub fn turn(&self) -> f64 {
        self.turn
    }

    /// The widest angle between two headings of the last minute, rad; beyond a circle it goes on.
    pub fn lately(&self) -> f64 {
        let [least, most] = self.kept.iter().fold([self.heading; 2], |[l, m], h| [h.min(l), h.max(m)]);
        most - least
    }

    /// Whether a minute has passed.
    pub fn is_known(&self) -> bool {
        self.known
    }

    /// The widest that there has been in any minute, rad.
    pub fn ever(&self) -> f64 {
        self.ever
    }

    /// How far apart the sines of its banks have been.
    pub fn banks(&self) -> f64 {
        self.banks.map_or(0.0, |(least, most)| most - least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute's turn and a half, then straight on with a wobble, rad and s.
    fn flown(straight_s: f64) -> Around {
        let mut around = Around::default();
        (0..600).for_each(|_| around.update(-3.0 * std::f64::consts::PI / 600.0, 0.5, 0.1));
        (0..(10.0 * straight_s) as u32).for_each(|i| around.update(0.05 * f64::from(i).cos(), 0.0, 0.1));
        around
    }

    #[test]
    fn a_turn_is_seen_and_forgotten_and_a_wobble_is_none() {
        assert!((flown(0.0).lately() - 9.4).abs() < 0.9, "{}", flown(0.0).lately());
        let later = flown(65.0);
        assert!(later.lately() < 0.2 && later.ever() > 8.5 && later.is_known(), "{later:?}");
        assert_eq!(Around::default().lately(), 0.0);
        assert_eq!([flown(0.0).banks(), later.banks(), Around::default().banks()], [0.0, 0.5, 0.0]);
    }
}
