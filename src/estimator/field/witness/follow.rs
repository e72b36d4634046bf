//! Whether a sensor follows what it should show: one under a film does not, one that looks at a wall does.

/// Over this time, s.
const OVER_S: f64 = 4.0;
/// It must have been looked at for so much of that.
const LOOKED: f64 = 0.2;
/// What it should show must change by so much, K rms, to see what it follows.
const CHANGES_K: f64 = 0.7;

/// What does not follow for the other way it goes: one that loses more than all, after so much of the time, so that what
/// it does as a film grows is no part of it.
const STRAYS: (f64, f64) = (1.1, 1.3);
const GROWN: f64 = 0.6;

/// Weights, means, and the second moments of what it should show and shows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Follow {
    sums: [f64; 6],
}

impl Follow {
    /// Takes in what it should show and shows, K, `dt_s` after the last.
    pub fn update(&mut self, expected: f64, shown: f64, dt_s: f64) {
        let keep = (-dt_s / OVER_S).exp();
        let sample = [1.0, expected, shown, expected * expected, expected * shown, shown * shown];
        self.sums.iter_mut().zip(sample).for_each(|(s, x)| *s = keep * *s + (1.0 - keep) * x);
    }

    /// How much it does not follow of what it should show, where that has changed: 0 for all of it, 1 for nothing.
    pub fn lost(&self) -> Option<f64> {
        self.lost_of(CHANGES_K)
    }

    /// The same where that has changed by `changes_k`, K rms.
    pub fn lost_of(&self, changes_k: f64) -> Option<f64> {
        let [w, e, z, ee, ez, _] = self.sums;
        if w < LOOKED {
            return None;
        }
        let [e, z, ee, ez] = [e / w, z / w, ee / w, ez / w];
        let changes = ee - e * e;
        (changes > changes_k * changes_k).then(|| 1.0 - (ez - e * z) / changes)
    }

    /// What a film at `ambient_c` does not explain of what it shows, as a share of how far that is from what it should show, rms.
    pub fn beside_film(&self, ambient_c: f64) -> Option<f64> {
        let [w, e, z, ee, ez, zz] = self.sums;
        let apart = ambient_c * ambient_c * w - 2.0 * ambient_c * e + ee;
        let along = ambient_c * (z - e) - ez + ee;
        let off = zz - 2.0 * ez + ee;
        (apart > 0.0).then(|| (off - along * along / apart).max(0.0).sqrt() / apart.sqrt())
    }

    /// How much what it shows changes, K rms.
    pub fn moves_k(&self) -> Option<f64> {
        let [w, _, z, _, _, zz] = self.sums;
        (w >= LOOKED).then(|| (zz / w - (z / w).powi(2)).max(0.0).sqrt())
    }

    /// How surely it goes another way than it should, as no film does: 0..1.
    pub fn strays(&self) -> f64 {
        let lost = self.lost().filter(|_| self.sums[0] > GROWN).unwrap_or(0.0);
        ((lost - STRAYS.0) / (STRAYS.1 - STRAYS.0)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many seconds at 20 Hz of what changes by `swing_k` to either side, behind a film of share `film` at 24 °C.
    fn lost(film: f64, swing_k: f64, seconds: f64) -> Option<f64> {
        let mut follow = Follow::default();
        for i in 0..(20.0 * seconds) as u32 {
            let due = 5.0 + swing_k * (0.05 * f64::from(i)).sin();
            follow.update(due, film * 24.0 + (1.0 - film) * due, 0.05);
        }
        follow.lost()
    }

    #[test]
    fn a_film_is_what_does_not_follow() {
        for film in [0.0, 0.3, 0.92, 1.0] {
            let lost = lost(film, 6.0, 5.0).unwrap();
            assert!((lost - film).abs() < 1e-9, "{film}: {lost}");
        }
    }

    #[test]
    fn what_goes_the_other_way_is_no_film() {
        let strays = |share: f64, seconds: f64| {
            let mut follow = Follow::default();
            for i in 0..(20.0 * seconds) as u32 {
                let due = 5.0 + 6.0 * (0.05 * f64::from(i)).sin();
                follow.update(due, 24.0 - share * due, 0.05);
            }
            follow.strays()
        };
        assert_eq!([strays(0.0, 8.0), strays(0.05, 8.0), strays(-0.9, 8.0)], [0.0; 3]);
        assert!((strays(0.2, 8.0) - 0.5).abs() < 1e-9 && strays(1.0, 8.0) == 1.0);
        assert_eq!(strays(1.0, 3.0), 0.0, "too soon");
    }

    #[test]
    fn what_does_not_change_proves_nothing() {
        assert_eq!(lost(0.9, 0.3, 5.0), None);
        assert_eq!(lost(0.9, 6.0, 0.5), None, "too soon");
    }
}
