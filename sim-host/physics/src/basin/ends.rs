//! The ends of a narrowed edge, and those of the section beside it if the border is not between them.

use super::scan::{Edge, SECTIONS};
use crate::ride::Ride;

/// A narrowed edge and the exact rides of its ends.
pub(super) struct Ends {
    pub(super) edge: Edge,
    pub(super) safe: Ride,
    pub(super) fell: Ride,
}

impl Ends {
    /// Whether one ride falls and the other does not.
    pub(super) fn contain_border(&self) -> bool {
        !self.safe.fell() && self.fell.fell()
    }

    /// The other end of the section beside these, on the side on which the border must be, by the divisions of the `brackets` that
    /// became this edge; `None` if the ends contain the border, or there is none.
    pub(super) fn neighbour(&self, brackets: &[Edge], tolerance: f64) -> Option<f64> {
        if self.contain_border() {
            return None;
        }
        let lower = self.safe.fell();
        let mut edge = self.edge;
        for bracket in brackets.iter().rev() {
            let beside = bracket.parts().into_iter().find(|part| match lower {
                true => part.fell == edge.safe,
                false => part.safe == edge.fell,
            });
            let Some(mut beside) = beside else {
                edge = *bracket;
                continue;
            };
            while !beside.narrow(tolerance) {
                beside = beside.parts()[if lower { SECTIONS } else { 0 }];
            }
            return Some(if lower { beside.safe } else { beside.fell });
        }
        None
    }

    /// The ends of the section beside these, of whose other end `neighbour` is the ride with the disturbance `rate` \[rad/s\].
    pub(super) fn shifted(&self, rate: f64, neighbour: Ride) -> Self {
        if self.safe.fell() {
            Self { edge: Edge { safe: rate, fell: self.edge.safe }, safe: neighbour, fell: self.safe }
        } else {
            Self { edge: Edge { safe: self.edge.fell, fell: rate }, safe: self.fell, fell: neighbour }
        }
    }
}
