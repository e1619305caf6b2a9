//! Content of a measurement file.

use super::super::frames::Frames;
use super::super::{Group, Remark};

/// Content of a measurement file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Content {
    /// Groups of numeric channels.
    pub groups: Vec<Group>,
    /// Frames of CAN.
    pub frames: Frames,
    /// Data that could not be used.
    pub remarks: Vec<Remark>,
}
