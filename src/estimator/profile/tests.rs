use super::*;
use crate::frame::{Missing, Sample, Value};
use crate::sky::{Averaging, FieldOfView, Response, Shape, Sky};
use proptest::prelude::*;
use std::sync::OnceLock;

/// The curves of both skies of the report under three fields of view.
fn curves() -> &'static [PairCurve] {
    static MADE: OnceLock<Vec<PairCurve>> = OnceLock::new();
    MADE.get_or_init(|| {
        let fields = [
            FieldOfView::InPlane { half_deg: 50.0 },
            FieldOfView::Cone { half_deg: 50.0 },
            FieldOfView::Gaussian { fwhm_deg: 90.0 },
        ];
        let skies = [Sky::NAMIBIA, Sky::DURHAM].into_iter().flat_map(|s| fields.map(|f| (s, f)));
        let curve = |(s, f): (Sky, FieldOfView)| {
            Response::new(s.shape, f, Averaging::Temperature).pair_curve(s.ground_c, s.sky_max_k)
        };
        skies.map(curve).collect()
    })
}

fn orthogonal() -> [Direction; 3] {
    [Direction::NOSE, Direction::LEFT, Direction::UP]
}

fn signals(directions: &[Direction], curve: &PairCurve, u: Vector, contrast_k: f64) -> Vec<Option<f64>> {
    directions.iter().map(|d| Some(contrast_k * curve.g(d.dot(u)))).collect()
}

fn degrees_apart(a: Vector, b: Vector) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    dot(cross, cross).sqrt().atan2(dot(a, b)).to_degrees()
}

#[test]
fn exact_in_the_model_s_own_sky_whatever_the_attitude() {
    for (n, curve) in curves().iter().enumerate() {
        let solver = Solver::new(&orthogonal(), curve.clone()).unwrap();
        for roll in -36..=36 {
            for pitch in -18..=18 {
                let attitude = Attitude::from_degrees(f64::from(roll) * 5.0, f64::from(pitch) * 5.0);
                let s = solver.solve(&signals(&orthogonal(), curve, attitude.vertical(), 27.0)).unwrap();
                let off = degrees_apart(s.vertical, attitude.vertical());
                assert!(off < 0.05 && (s.contrast_k - 27.0).abs() < 0.03, "curve {n} {attitude:?}: {off}° {s:?}");
                assert!((s.length - 1.0).abs() < 1e-6 && s.residual_k == 0.0);
            }
        }
    }
}
