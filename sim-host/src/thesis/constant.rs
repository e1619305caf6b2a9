//! Riders with gains independent of speed: appendices I and K.

use super::study::Study;
use crate::ride::{Assist, Conditions, Start};
use crate::rider::{Gains, Neuromuscular, Rider, Schedule};

/// A rider with the same gains at every speed and the neuromuscular dynamics of the thesis.
pub(super) fn constant(gains: Gains, delay_s: f64) -> Rider {
    Rider { schedule: Schedule::constant(gains), delay_s, neuromuscular: Neuromuscular::SHOULDERS }
}

/// The published conditions for a rider without assist.
pub(super) fn ridden(study: &Study, rider: Rider) -> Conditions {
    Conditions { rider: Some(rider), ..Conditions::thesis(study.bicycle, Assist::None) }
}

/// A ride at `speed_m_s` disturbed by a steer rate.
pub(super) fn disturbed(speed_m_s: f64, steer_rate_rad_s: f64) -> Start {
    Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 }
}
