//! The linear loop of bicycle, rider and assist: at which speeds small disturbances grow.

use crate::bicycle::Parameters;
use crate::eigen::{Feedback, Model, unstable};
use crate::ride::Assist;
use crate::rider::Rider;
use control::Law;

/// The feedback of an assist for small motions, without sensor delay.
pub(super) fn feedback(assist: &Assist) -> Feedback {
    match assist {
        Assist::Firmware(plan) => Feedback::new(plan.config().law.clone(), plan.config().capsize),
        Assist::Ideal(ideal) => Feedback::new(ideal.law.clone(), Default::default()),
        Assist::None | Assist::Own(_) => Feedback::new(Law::None, Default::default()),
    }
}

/// Number of `speeds` \[m/s\] at which the straight ride is linearly unstable; a function as law counts as no assist.
pub fn unstable_speeds(parameters: &Parameters, assist: &Assist, rider: &Rider, speeds: &[f64]) -> usize {
    let model = Model::new(parameters, feedback(assist), Some(rider.clone()));
    unstable(&[model], speeds).iter().sum()
}
