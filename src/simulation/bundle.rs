//! A field of view as a few hundred directions in space, for scenes that differ all around.

use crate::sky::FieldOfView;

/// Directions in a field of view; each stands for an equal share.
const RAYS: usize = 400;
/// The golden angle, rad: turns by it fill a circle evenly.
const GOLDEN_RAD: f64 = 2.399_963_229_728_653;

/// A direction, on the axis, its upward perpendicular, and the horizontal one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Along the axis.
    pub along: f64,
    /// On the upward perpendicular of the axis.
    pub across: f64,
    /// On the horizontal perpendicular of the axis.
    pub aside: f64,
    /// Its share of the whole; all shares add up to 1.
    pub weight: f64,
}

/// The field as rays. A fan in the vertical plane stays one; a field about the axis becomes a
/// spiral of equal shares.
pub fn rays(field: FieldOfView) -> Vec<Ray> {
    let nodes = field.nodes();
    if let FieldOfView::InPlane { .. } = field {
        return nodes.iter().map(|n| Ray { along: n.along, across: n.across, aside: 0.0, weight: n.weight }).collect();
    }
    // The field's rings from the axis outward: cosine of the angle, share.
    let mut rings: Vec<(f64, f64)> = Vec::new();
    for n in &nodes {
        match rings.last_mut() {
            Some((along, weight)) if *along == n.along => *weight += n.weight,
            _ => rings.push((n.along, n.weight)),
        }
    }
    let (mut ring, mut before) = (0, 0.0);
    (0..RAYS)
        .map(|i| {
            let share = (i as f64 + 0.5) / RAYS as f64;
            while ring + 1 < rings.len() && before + rings[ring].1 < share {
                before += rings[ring].1;
                ring += 1;
            }
            // Between the middles of two rings' angles; a ring is as wide as their distance.
            let (angle, width) = (rings[ring].0.acos(), rings[0].0.acos() * 2.0);
            let off = angle + width * ((share - before) / rings[ring].1 - 0.5);
            let (sin, along) = off.max(0.0).sin_cos();
            let (around_sin, around_cos) = (i as f64 * GOLDEN_RAD).sin_cos();
            Ray { along, across: sin * around_cos, aside: sin * around_sin, weight: 1.0 / RAYS as f64 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bundle_is_the_field_it_was_made_of() {
        for field in [
            FieldOfView::InPlane { half_deg: 50.0 },
            FieldOfView::Cone { half_deg: 50.0 },
            FieldOfView::Gaussian { fwhm_deg: 90.0 },
            FieldOfView::Gaussian { fwhm_deg: 5.0 },
        ] {
            let rays = rays(field);
            let sum = |f: &dyn Fn(&Ray) -> f64| rays.iter().map(|r| r.weight * f(r)).sum::<f64>();
            let mean = field.nodes().iter().map(|n| n.weight * n.along).sum::<f64>();
            assert!((sum(&|_| 1.0) - 1.0).abs() < 1e-9);
            assert!((sum(&|r| r.along) - mean).abs() < 1e-3, "{field:?}");
            assert!(sum(&|r| r.across).abs() < 3e-3 && sum(&|r| r.aside).abs() < 3e-3, "{field:?}");
            assert!(rays.iter().all(|r| (r.along.hypot(r.across).hypot(r.aside) - 1.0).abs() < 1e-9));
        }
    }
}
