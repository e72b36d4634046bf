use super::*;
use proptest::prelude::*;

fn said(roll_deg: f64, pitch_deg: f64) -> Said {
    Said { roll_deg, pitch_deg, roll_sigma_deg: None, pitch_sigma_deg: None }
}

fn score(rows: &[(f64, f64, f64, f64)]) -> Score {
    let mut errors = Errors::default();
    for &(true_roll, true_pitch, roll, pitch) in rows {
        errors.add(Truth { roll_deg: true_roll, pitch_deg: true_pitch }, Some(said(roll, pitch)));
    }
    errors.score()
}

fn near(value: Option<f64>, expected: f64) -> bool {
    value.is_some_and(|v| (v - expected).abs() < 1e-9)
}

#[test]
fn known_errors_have_known_figures() {
    // Errors of roll 3, −4; of pitch 0, 1.
    let s = score(&[(0.0, 0.0, 3.0, 0.0), (10.0, -2.0, 6.0, -1.0)]);
    assert_eq!((s.rows, s.withheld_percent), (2, Some(0.0)));
    assert!(near(s.roll_rms_deg, 12.5_f64.sqrt()) && near(s.pitch_rms_deg, 0.5_f64.sqrt()), "{s:?}");
    assert!(near(s.roll_bias_deg, -0.5) && near(s.pitch_bias_deg, 0.5), "{s:?}");
    // The larger of the two: 3 and 4.
    assert!(near(s.error_p50_deg, 3.5) && near(s.error_p95_deg, 3.95) && near(s.error_p99_deg, 3.99), "{s:?}");
    // No true roll beyond 20°, no standard deviation.
    assert_eq!((s.underestimated_p99_deg, s.roll_in_2_sigma_percent), (None, None));
}

#[test]
fn roll_errors_go_the_short_way_round() {
    let s = score(&[(179.0, 0.0, -179.0, 0.0), (-179.0, 0.0, 179.0, 0.0)]);
    assert!(near(s.roll_rms_deg, 2.0) && near(s.roll_bias_deg, 0.0), "{s:?}");
    assert!(near(s.underestimated_worst_deg, 0.0), "{s:?}");
}

#[test]
fn what_falls_short_in_size_is_underestimated_and_nothing_else() {
    let beyond = [(30.0, 25.0, 5.0), (-30.0, -35.0, 0.0), (-30.0, 10.0, 20.0), (45.0, 45.0, 0.0), (21.0, 0.0, 21.0)];
    for (truth, roll, short) in beyond {
        assert!(near(score(&[(truth, 0.0, roll, 0.0)]).underestimated_worst_deg, short), "{truth} {roll}");
    }
    assert_eq!(score(&[(20.0, 0.0, 0.0, 0.0)]).underestimated_worst_deg, None);
    let all: Vec<_> = beyond.iter().map(|&(truth, roll, _)| (truth, 0.0, roll, 0.0)).collect();
    // In order 0 0 5 20 21; the rank is 0.99 · 4.
    assert!(near(score(&all).underestimated_p99_deg, 20.96));
}

#[test]
fn an_error_is_covered_up_to_twice_its_sigma() {
    let truth = Truth { roll_deg: 0.0, pitch_deg: 0.0 };
    let mut errors = Errors::default();
    let sigmas = [(Some(1.0), Some(2.0)), (Some(0.9), Some(2.0)), (Some(f64::NAN), Some(9.0)), (None, None)];
    for (roll_sigma_deg, pitch_sigma_deg) in sigmas {
        errors.add(truth, Some(Said { roll_sigma_deg, pitch_sigma_deg, ..said(-2.0, 4.0) }));
    }
    let s = errors.score();
    assert_eq!(
        [s.roll_in_2_sigma_percent, s.pitch_in_2_sigma_percent, s.both_in_2_sigma_percent],
        [Some(25.0), Some(75.0), Some(25.0)]
    );
}

#[test]
fn nothing_is_said_of_a_sigma_that_no_row_has() {
    let truth = Truth { roll_deg: 0.0, pitch_deg: 0.0 };
    for (roll, pitch, expected) in [
        (Some(1.0), None, [Some(0.0), None, None]),
        (Some(1.0), Some(f64::NAN), [Some(0.0), None, None]),
        (None, Some(2.0), [None, Some(100.0), None]),
        (None, None, [None; 3]),
    ] {
        let mut errors = Errors::default();
        errors.add(truth, Some(Said { roll_sigma_deg: roll, pitch_sigma_deg: pitch, ..said(-3.0, 4.0) }));
        let s = errors.score();
        let covered = [s.roll_in_2_sigma_percent, s.pitch_in_2_sigma_percent, s.both_in_2_sigma_percent];
        assert_eq!(covered, expected, "{roll:?} {pitch:?}");
    }
}

#[test]
fn what_is_no_number_counts_as_withheld() {
    let truth = Truth { roll_deg: 25.0, pitch_deg: 0.0 };
    let mut errors = Errors::default();
    assert!(errors.is_empty());
    for given in [None, Some(said(f64::NAN, 0.0)), Some(said(0.0, f64::INFINITY)), Some(said(24.0, 0.0))] {
        errors.add(truth, given);
    }
    assert!(!errors.is_empty());
    let s = errors.score();
    assert_eq!((s.rows, s.withheld_percent), (1, Some(75.0)));
    assert!(near(s.underestimated_worst_deg, 1.0));
    assert_eq!(Errors::default().score(), Score::default());
}

/// How many values lie below or at `v`, and how many at or above: a percentile cuts at its share.
fn cuts(values: &[f64], p: f64, v: f64) -> bool {
    let n = values.len() as f64 - 1.0;
    let below = values.iter().filter(|x| **x < v - 1e-9).count() as f64;
    let above = values.iter().filter(|x| **x > v + 1e-9).count() as f64;
    below <= (p / 100.0 * n).floor() + 1.0 && above <= n - (p / 100.0 * n).floor()
}

proptest! {
    #[test]
    fn percentiles_and_roots_are_those_of_their_definitions(
        rolls in prop::collection::vec(-80.0..80.0_f64, 1..200),
        p in 0.0..100.0_f64,
    ) {
        let s = score(&rolls.iter().map(|r| (0.0, 0.0, *r, 0.0)).collect::<Vec<_>>());
        let mean_square = rolls.iter().map(|r| r.powi(2) / rolls.len() as f64).sum::<f64>();
        prop_assert!((s.roll_rms_deg.unwrap().powi(2) - mean_square).abs() < 1e-6);
        let sizes: Vec<f64> = rolls.iter().map(|r| r.abs()).collect();
        for (p, v) in [(50.0, s.error_p50_deg), (95.0, s.error_p95_deg), (99.0, s.error_p99_deg)] {
            prop_assert!(cuts(&sizes, p, v.unwrap()), "{p} %: {v:?}");
        }
        let mut sorted = sizes.clone();
        sorted.sort_by(f64::total_cmp);
        prop_assert!(cuts(&sizes, p, percentile(&sorted, p).unwrap()));
        // Interpolation between ranks makes the percentiles of 0, 1, … n straight.
        let straight: Vec<f64> = (0..sizes.len()).map(|i| i as f64).collect();
        let expected = p / 100.0 * (sizes.len() - 1) as f64;
        prop_assert!((percentile(&straight, p).unwrap() - expected).abs() < 1e-6);
    }

    #[test]
    fn any_numbers_give_a_score(rows in prop::collection::vec(any::<(f64, f64, f64, f64)>(), 0..20)) {
        let s = score(&rows);
        prop_assert!(s.rows <= rows.len() as u64);
    }
}
