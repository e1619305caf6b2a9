//! A ride as it was when its motion settled, from where it continues if the motion does not remain calm.

use crate::bicycle::State;
use crate::ride::quick::controller::LaneController;
use crate::ride::quick::lane::Lane;
use crate::ride::quick::riders::RiderStart;

/// The ride in a lane at the start of its first calm step.
pub(in crate::ride::quick) struct CalmStart {
    pub(in crate::ride::quick) state: State<f64>,
    pub(in crate::ride::quick) ride: Lane,
    pub(in crate::ride::quick) rider: Option<RiderStart>,
    pub(in crate::ride::quick) controller: LaneController,
}
