//! A ride as it was when its motion settled, from where it continues if the motion does not remain calm.

use super::controller::LaneController;
use super::lane::Lane;
use super::riders::RiderStart;
use crate::bicycle::State;

/// The ride in a lane at the start of its first calm step.
pub(super) struct CalmStart {
    pub(super) state: State<f64>,
    pub(super) ride: Lane,
    pub(super) rider: Option<RiderStart>,
    pub(super) controller: LaneController,
}
