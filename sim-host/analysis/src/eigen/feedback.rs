//! Feedback gains of an assist at a speed.

use control::{Capsize, Law};

/// Steer torque `roll * roll angle + roll_rate * roll rate`, positive into the fall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StaticFeedback {
    /// Roll-angle gain \[N m/rad\].
    pub roll: f64,
    /// Roll-rate gain \[N m s/rad\].
    pub roll_rate: f64,
}

/// The intuitive controller (eq. 2.16; Schwab, Kooijman and Meijaard 2008): roll-rate feedback below `v_max`,
/// roll-angle feedback above. The published torque has the opposite sign, hence its minus signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intuitive {
    /// Roll-rate gain per speed below `v_max` \[N s^2/rad\].
    pub k_v: f64,
    /// Speed without feedback \[m/s\].
    pub v_max: f64,
    /// Roll-angle gain per speed above `v_max` \[N s/rad\].
    pub k_c: f64,
}

/// An assist in the linear analysis.
#[allow(clippy::large_enum_variant, reason = "there is one of them in an analysis")]
#[derive(Clone, Debug, PartialEq)]
pub enum Feedback {
    /// A roll-rate law of the control crate; [`Law::None`] for no assist.
    Law(Law),
    /// A roll-rate law plus the capsize term.
    WithCapsize(Law, Capsize),
    /// The intuitive controller.
    Intuitive(Intuitive),
}

impl Feedback {
    /// A law, with the capsize term if its gain is not zero.
    pub fn new(law: Law, capsize: Capsize) -> Self {
        if capsize.is_on() { Self::WithCapsize(law, capsize) } else { Self::Law(law) }
    }

    /// The gains at forward speed `v` \[m/s\].
    pub fn at(&self, v: f64) -> StaticFeedback {
        match self {
            Self::Law(law) => StaticFeedback { roll: 0.0, roll_rate: law.gain(v) },
            Self::WithCapsize(law, capsize) => {
                StaticFeedback { roll: capsize.gain(v), roll_rate: law.gain(v) }
            }
            Self::Intuitive(Intuitive { k_v, v_max, .. }) if v < *v_max => {
                StaticFeedback { roll: 0.0, roll_rate: k_v * (v_max - v) }
            }
            Self::Intuitive(Intuitive { v_max, k_c, .. }) => {
                StaticFeedback { roll: k_c * (v - v_max), roll_rate: 0.0 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_intuitive_controller_changes_over_at_its_speed() {
        let feedback = Feedback::Intuitive(Intuitive { k_v: 10.0, v_max: 4.0, k_c: 3.0 });
        let gains = |v| (feedback.at(v).roll, feedback.at(v).roll_rate);
        assert_eq!([1.0, 4.0, 6.0].map(gains), [(0.0, 30.0), (0.0, 0.0), (6.0, 0.0)]);
    }
}
