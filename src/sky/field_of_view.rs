//! How a sensor weighs what lies about its axis.

use std::f64::consts::PI;

/// A field of view, symmetrical about the sensor's axis. Angles in degrees off the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldOfView {
    /// A flat fan in the vertical plane through the axis, `±half_deg`: the report integrates over ±50°.
    InPlane {
        /// Half its angle, 0 to 90.
        half_deg: f64,
    },
    /// A cone about the axis that sees like a flat plate: weight `sin a cos a` up to `half_deg`.
    Cone {
        /// Half its angle, 0 to 90.
        half_deg: f64,
    },
    /// A bell about the axis, weight `sin a` times a Gaussian, cut off at 90°: as datasheets of
    /// thermopiles show it (MLX90614 xAx: 90°).
    Gaussian {
        /// Full angle between the half-power points, 1 to 180.
        fwhm_deg: f64,
    },
    /// A cone about the axis that sees alike all that is in it: weight `sin a` up to `half_deg`.
    Even {
        /// Half its angle, 0 to 90.
        half_deg: f64,
    },
    /// A bell with long tails, weight `sin a` over one plus the square of the angle, cut off at 90°.
    Tailed {
        /// Full angle between the half-power points, 1 to 180.
        fwhm_deg: f64,
    },
}

/// A direction in the field of view. Seen along an axis at elevation E it lies at the elevation
/// whose sine is `along·sin E + across·cos E`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Component along the axis.
    pub along: f64,
    /// Component on the upward perpendicular of the axis.
    pub across: f64,
    /// Its share of the whole; all shares add up to 1.
    pub weight: f64,
}

/// Steps across the field, and around the axis over half a turn (the other half is the mirror image).
const OFF_AXIS: usize = 48;
const AROUND: usize = 48;
/// Half the angle of an even cone over the width of a bell that sees much the same.
const EVEN: f64 = 50.0 / 90.0;

impl FieldOfView {
    /// One `times` as wide, as far as a field of view can be.
    pub fn scaled(self, times: f64) -> Self {
        match self {
            Self::InPlane { half_deg } => Self::InPlane { half_deg: half_deg * times },
            Self::Cone { half_deg } => Self::Cone { half_deg: half_deg * times },
            Self::Gaussian { fwhm_deg } => Self::Gaussian { fwhm_deg: fwhm_deg * times },
            Self::Even { half_deg } => Self::Even { half_deg: half_deg * times },
            Self::Tailed { fwhm_deg } => Self::Tailed { fwhm_deg: fwhm_deg * times },
        }
    }

    /// Two of other forms that are about as wide: between the three, and somewhat beyond, is whatever sees less the farther
    /// off the axis.
    pub fn others(self) -> [Self; 2] {
        match self {
            Self::Gaussian { fwhm_deg } => [Self::Even { half_deg: fwhm_deg * EVEN }, Self::Tailed { fwhm_deg }],
            Self::Tailed { fwhm_deg } => [Self::Even { half_deg: fwhm_deg * EVEN }, Self::Gaussian { fwhm_deg }],
            Self::InPlane { half_deg } | Self::Cone { half_deg } | Self::Even { half_deg } => {
                let fwhm_deg = half_deg / EVEN;
                [Self::Gaussian { fwhm_deg }, Self::Tailed { fwhm_deg }]
            }
        }
    }

    /// The field as weighted directions (midpoint rule). About 2300; to be made once.
    pub fn nodes(self) -> Vec<Node> {
        let mut nodes = match self {
            Self::InPlane { half_deg } => {
                let steps = 2 * OFF_AXIS * 4;
                (0..steps)
                    .map(|i| {
                        let (across, along) = (half(half_deg) * (midpoint(i, steps) * 2.0 - 1.0)).sin_cos();
                        Node { along, across, weight: 1.0 }
                    })
                    .collect()
            }
            Self::Cone { half_deg } => about_the_axis(half(half_deg), |a| a.sin() * a.cos()),
            Self::Even { half_deg } => about_the_axis(half(half_deg), f64::sin),
            Self::Tailed { fwhm_deg } => {
                let half = half(fwhm_deg / 2.0);
                about_the_axis(PI / 2.0, |a| a.sin() / (1.0 + (a / half).powi(2)))
            }
            Self::Gaussian { fwhm_deg } => {
                let fwhm = 2.0 * half(fwhm_deg / 2.0);
                // At twice the width off the axis less than 2e-5 is left.
                let edge = (2.0 * fwhm).min(PI / 2.0);
                about_the_axis(edge, |a| a.sin() * (-4.0 * std::f64::consts::LN_2 * (a / fwhm).powi(2)).exp())
            }
        };
        let sum: f64 = nodes.iter().map(|n| n.weight).sum();
        for n in &mut nodes {
            n.weight /= sum;
        }
        nodes
    }
}

/// Half an angle in radians, kept within what a sensor in front of a wall can have.
fn half(deg: f64) -> f64 {
    if deg.is_nan() { PI / 4.0 } else { deg.clamp(0.01, 90.0).to_radians() }
}

/// The middle of step `i` of `steps` over 0..1.
fn midpoint(i: usize, steps: usize) -> f64 {
    (i as f64 + 0.5) / steps as f64
}

fn about_the_axis(edge: f64, weight: impl Fn(f64) -> f64) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(OFF_AXIS * AROUND);
    for i in 0..OFF_AXIS {
        let a = edge * midpoint(i, OFF_AXIS);
        for j in 0..AROUND {
            let across = a.sin() * (PI * midpoint(j, AROUND)).cos();
            nodes.push(Node { along: a.cos(), across, weight: weight(a) });
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_to_one_and_the_field_is_symmetrical() {
        for field in [
            FieldOfView::InPlane { half_deg: 50.0 },
            FieldOfView::Cone { half_deg: 50.0 },
            FieldOfView::Gaussian { fwhm_deg: 90.0 },
            FieldOfView::Gaussian { fwhm_deg: 5.0 },
            FieldOfView::Even { half_deg: 50.0 },
            FieldOfView::Tailed { fwhm_deg: 90.0 },
        ] {
            let nodes = field.nodes();
            assert!((nodes.iter().map(|n| n.weight).sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(nodes.iter().map(|n| n.weight * n.across).sum::<f64>().abs() < 1e-12);
        }
    }

    #[test]
    fn mean_cosines_are_those_of_the_integrals() {
        let mean = |f: FieldOfView| f.nodes().iter().map(|n| n.weight * n.along).sum::<f64>();
        let h = 50.0_f64.to_radians();
        assert!((mean(FieldOfView::InPlane { half_deg: 50.0 }) - h.sin() / h).abs() < 1e-4);
        // ∫ sin a cos a / ∫ sin a
        let even = h.sin().powi(2) / 2.0 / (1.0 - h.cos());
        assert!((mean(FieldOfView::Even { half_deg: 50.0 }) - even).abs() < 1e-4);
        // ∫ sin a cos² a / ∫ sin a cos a
        let cone = (1.0 - h.cos().powi(3)) / 3.0 / (h.sin().powi(2) / 2.0);
        assert!((mean(FieldOfView::Cone { half_deg: 50.0 }) - cone).abs() < 1e-4);
    }

    #[test]
    fn wider_is_as_much_wider() {
        for (field, wider) in [
            (FieldOfView::InPlane { half_deg: 50.0 }, FieldOfView::InPlane { half_deg: 60.0 }),
            (FieldOfView::Cone { half_deg: 30.0 }, FieldOfView::Cone { half_deg: 36.0 }),
            (FieldOfView::Gaussian { fwhm_deg: 90.0 }, FieldOfView::Gaussian { fwhm_deg: 108.0 }),
            (FieldOfView::Even { half_deg: 50.0 }, FieldOfView::Even { half_deg: 60.0 }),
            (FieldOfView::Tailed { fwhm_deg: 90.0 }, FieldOfView::Tailed { fwhm_deg: 108.0 }),
        ] {
            assert_eq!(field.scaled(1.2), wider);
        }
    }

    #[test]
    fn others_are_as_wide_and_of_other_forms() {
        let fields = [
            FieldOfView::InPlane { half_deg: 50.0 },
            FieldOfView::Cone { half_deg: 50.0 },
            FieldOfView::Gaussian { fwhm_deg: 90.0 },
            FieldOfView::Even { half_deg: 50.0 },
            FieldOfView::Tailed { fwhm_deg: 90.0 },
        ];
        for field in fields {
            let others = field.others();
            assert!(!others.contains(&field) && others[0] != others[1]);
            for other in others {
                assert!(fields.iter().any(|f| format!("{f:?}") == format!("{other:?}")), "{field:?}: {other:?}");
            }
        }
    }

    #[test]
    fn hostile_angles_give_finite_fields() {
        for x in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e300] {
            for f in [
                FieldOfView::InPlane { half_deg: x },
                FieldOfView::Cone { half_deg: x },
                FieldOfView::Gaussian { fwhm_deg: x },
                FieldOfView::Even { half_deg: x },
                FieldOfView::Tailed { fwhm_deg: x },
            ] {
                assert!(f.nodes().iter().all(|n| n.weight.is_finite() && n.along.is_finite()), "{f:?}");
            }
        }
    }
}
