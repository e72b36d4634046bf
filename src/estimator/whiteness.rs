//! How much moves, learnt from innovations: whether they keep their sign.

/// Over this time innovations are compared, s.
const WINDOW_S: f64 = 4.0;

/// Watches the innovations in one direction. Where they keep their sign the process noise is too small,
/// where they change it too often too large; how large the sensors' own noise is has no part in it.
#[derive(Clone, Debug)]
pub struct Whiteness {
    least: f64,
    smooth_s: f64,
    learning: (f64, f64),
    bounds: (f64, f64),
    smooth: f64,
    slow: f64,
    all: f64,
    factor: f64,
}

impl Whiteness {
    /// With the time over which innovations are averaged, s, how fast the factor goes up and down, 1/s,
    /// and its bounds. It begins at 1.
    pub fn new(smooth_s: f64, learning: (f64, f64), bounds: (f64, f64)) -> Self {
        Self { least: 0.0, smooth_s, learning, bounds, smooth: 0.0, slow: 0.0, all: 0.0, factor: 1.0 }
    }

    /// The same, but innovations smaller than `least` show nothing.
    pub fn above(self, least: f64) -> Self {
        Self { least, ..self }
    }

    /// What the process noise's standard deviation is to be multiplied with.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Something else has shown that the factor is at least so much.
    pub fn expect(&mut self, factor: f64) {
        self.factor = self.factor.max(factor).min(self.bounds.1);
    }

    /// Takes in an innovation, `dt_s` after the last.
    pub fn update(&mut self, innovation: f64, dt_s: f64) {
        let keep = (-dt_s / self.smooth_s).exp();
        let share = -(-dt_s / WINDOW_S).exp_m1();
        self.smooth = keep * self.smooth + (1.0 - keep) * innovation;
        // White: the average has this share of the power.
        let slow = self.smooth * self.smooth * (1.0 + keep) / (1.0 - keep);
        self.slow += share * (slow - self.slow);
        self.all += share * (innovation * innovation - self.all);
        if self.all > 0.0 && self.slow > 0.0 {
            let excess = (self.slow / self.all.max(self.least * self.least)).ln().clamp(-1.0, 1.5);
            let learning = if excess > 0.0 { self.learning.0 } else { self.learning.1 };
            let step = (learning * excess * dt_s).clamp(-1.0, 1.0);
            self.factor = (self.factor * step.exp()).clamp(self.bounds.0, self.bounds.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn innovations_that_keep_their_sign_ask_for_more_and_those_that_change_it_for_less() {
        let after = |innovation: &dyn Fn(u32) -> f64| {
            let mut w = Whiteness::new(0.1, (0.5, 0.5), (0.1, 8.0)).above(0.01);
            (0..3000).for_each(|i| w.update(innovation(i), 0.02));
            w.factor()
        };
        assert_eq!(after(&|i| 1.0 + 0.1 * f64::from(i % 2)), 8.0);
        assert_eq!(after(&|i| if i % 2 == 0 { 1.0 } else { -1.0 }), 0.1);
        assert_eq!(after(&|_| 0.0), 1.0);
        assert_eq!(after(&|_| 1e-4), 0.1);
    }

    #[test]
    fn what_else_shows_makes_it_no_less_and_no_more_than_its_bounds() {
        let mut w = Whiteness::new(0.1, (0.5, 0.5), (0.1, 8.0));
        let factors = [0.5, 2.0, 1.0, 9.0].map(|factor| {
            w.expect(factor);
            w.factor()
        });
        assert_eq!(factors, [1.0, 2.0, 2.0, 8.0]);
    }
}
