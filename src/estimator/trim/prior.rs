//! How much of a mean difference is the mounting's.
//!
//! Pitch differs from the angle of climb by the angle of attack too, and no reference tells the two apart.
//! But an angle of attack is small, and most heads are mounted well. So two explanations are weighed: a
//! well mounted head, whose small difference needs no trim, and a head mounted askew.

/// The share of heads that are mounted askew, before anything is known.
const ASKEW: f64 = 0.1;

/// The power of the odds that is acted on: a trim that is not needed spoils every flight, one that is not yet believed
/// leaves things as they were.
const CAUTION: f64 = 2.0;

/// What is expected of a difference, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Standard deviation of the difference that a well mounted head shows in the mean: the angle of
    /// attack, sideslip.
    pub well: f64,
    /// Standard deviation of the trim that a head mounted askew needs.
    pub askew: f64,
}

/// What is to be taken off, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Belief {
    /// The trim.
    pub trim: f64,
    /// The part of its standard deviation that it brings to the attitude: near 0 while the head is
    /// believed to be mounted well, and largest where either may be.
    pub sigma: f64,
}

impl Prior {
    /// Of roll: a turn is flown without much sideslip.
    pub const ROLL: Self = Self { well: 0.7_f64.to_radians(), askew: 4_f64.to_radians() };
    /// Of pitch: an angle of attack of a degree or two about that for which the head was trimmed.
    pub const PITCH: Self = Self { well: 1.4_f64.to_radians(), askew: 8_f64.to_radians() };

    /// What a mean difference of `mean` ± `error` (1σ) rad says: the trim of a head mounted askew,
    /// times the probability that it is, by the square of its odds. Of pitch, known to 0.3°:
    ///
    /// | difference | 1° | 2° | 2.5° | 3° | 4° | 5° | 6° | 8° |
    /// |---|---|---|---|---|---|---|---|---|
    /// | trim | 0.0° | 0.0° | 0.0° | 0.1° | 1.6° | 4.8° | 5.8° | 7.8° |
    pub fn believe(&self, mean: f64, error: f64) -> Belief {
        let [well, askew] = [self.well.powi(2) + error.powi(2), self.askew.powi(2)];
        let both = well + askew;
        let odds =
            (ASKEW / (1.0 - ASKEW)).ln() + 0.5 * (well / both).ln() + 0.5 * mean.powi(2) * (1.0 / well - 1.0 / both);
        let probability = 1.0 / (1.0 + (-CAUTION * odds).exp());
        let (whole, known) = (mean * askew / both, (well * askew / both).sqrt());
        // The whole is the mounting's, or nothing: the variance between the two.
        let undecided = (probability * (1.0 - probability)).sqrt() * whole;
        Belief { trim: probability * whole, sigma: (probability * known).hypot(undecided) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The trim of pitch and its deviation, all in degrees.
    fn pitch(mean_deg: f64, error_deg: f64) -> (f64, f64) {
        let b = Prior::PITCH.believe(mean_deg.to_radians(), error_deg.to_radians());
        (b.trim.to_degrees(), b.sigma.to_degrees())
    }

    #[test]
    fn the_table_is_what_is_believed() {
        // By Bayes' rule from two normal densities, written out.
        for tenths in -120..=120 {
            let d = f64::from(tenths) / 10.0;
            let density = |variance: f64| (-0.5 * d * d / variance).exp() / variance.sqrt();
            let (well, both) = (1.4 * 1.4 + 0.09, 1.4 * 1.4 + 0.09 + 64.0);
            let [askew, straight] = [0.1 * density(both), 0.9 * density(well)].map(|d: f64| d.powi(2));
            let askew = askew / (askew + straight);
            assert!((pitch(d, 0.3).0 - askew * d * 64.0 / both).abs() < 1e-9, "{d}");
        }
        let table = [(1.0, 0.0), (2.0, 0.0), (2.5, 0.0), (3.0, 0.1), (4.0, 1.6), (5.0, 4.8), (6.0, 5.8), (8.0, 7.8)];
        for (d, trim) in table {
            assert!((pitch(d, 0.3).0 - trim).abs() < 0.06, "{d}: {}", pitch(d, 0.3).0);
        }
    }

    #[test]
    fn what_is_not_known_well_is_not_believed() {
        assert!(pitch(6.0, 5.0).0 < 1.0);
        assert_eq!(pitch(0.0, 1.0).0, 0.0);
        assert!(pitch(1.0, 0.3).1 < 0.1 && (pitch(9.0, 0.3).1 - 1.4).abs() < 0.1);
    }

    /// By half a trim it is off either way.
    #[test]
    fn between_the_two_it_may_be_either() {
        let tenths = (30..60).map(|d| f64::from(d) / 10.0);
        let half = tenths.map(|d| (d, pitch(d, 0.3))).find(|(d, (trim, _))| *trim > 0.5 * d).unwrap();
        let (difference, (trim, sigma)) = half;
        assert!((4.0..4.6).contains(&difference) && sigma > 0.45 * difference, "{difference}: {trim} +- {sigma}");
        assert!((pitch(9.0, 0.3).1 - 1.4).abs() < 0.1 && (pitch(-difference, 0.3).1 - sigma).abs() < 1e-12);
    }

    #[test]
    fn roll_is_believed_sooner_and_both_signs_alike() {
        for prior in [Prior::ROLL, Prior::PITCH] {
            for d in [0.01, 0.1, 1.0, 1e6] {
                let (plus, minus) = (prior.believe(d, 0.005), prior.believe(-d, 0.005));
                assert_eq!((plus.trim, plus.sigma), (-minus.trim, minus.sigma));
                assert!(plus.trim.is_finite() && plus.trim <= d);
            }
        }
        let d = 3_f64.to_radians();
        assert!(Prior::ROLL.believe(d, 0.005).trim > 3.0 * Prior::PITCH.believe(d, 0.005).trim);
    }
}
