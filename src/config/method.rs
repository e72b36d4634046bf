//! The methods of estimation: their names, which is usual for a head, what each needs.

use crate::estimator::suits;
use crate::head::Head;

/// A method of estimation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The report's scheme.
    InverseSine,
    /// Pairs, inverted through the sky's shape.
    Profile,
    /// Every sensor by itself, the sky estimated together with the attitude.
    Field,
}

impl Method {
    /// All methods with the names that configuration and D-Bus spell them by.
    pub const NAMED: [(&'static str, Self); 3] =
        [("inverse-sine", Self::InverseSine), ("profile", Self::Profile), ("field", Self::Field)];

    /// The method's name.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::InverseSine => "inverse-sine",
            Self::Profile => "profile",
            Self::Field => "field",
        }
    }

    /// The method for `head` when none is chosen: `field` where every sensor shows a temperature of
    /// its own, `profile` where any is a pair.
    pub fn usual(head: &Head) -> Self {
        let absolute = head.sensors.iter().all(|s| s.is_absolute());
        if absolute { Self::Field } else { Self::Profile }
    }

    /// Whether the method works on `head`.
    pub fn suits(self, head: &Head) -> bool {
        match self {
            Self::InverseSine => suits::inverse_sine(head),
            Self::Profile => suits::profile(head),
            Self::Field => suits::field(head).is_ok(),
        }
    }

    /// What a head must have for it, in words.
    pub const fn needs(self) -> &'static str {
        match self {
            Self::InverseSine => "a vertical pair, and pairs in three directions",
            Self::Profile => "pairs in three directions",
            Self::Field => "5 to 8 thermopiles, or 3 to 8 pairs, that look all ways",
        }
    }

    /// The limit of roll when none is chosen, °: 45 for the report's scheme, which is lost beyond, and
    /// 0, none, for the others.
    pub const fn usual_roll_limit_deg(self) -> f64 {
        match self {
            Self::InverseSine => 45.0,
            Self::Profile | Self::Field => 0.0,
        }
    }
}
