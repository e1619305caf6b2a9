//! The basin of attraction: from which disturbances, over forward speed, the bicycle recovers.

mod compare;
mod outline;
mod plane;
mod search;

pub use compare::{Rmse, rmse};
pub use outline::{Basin, Column, Island, ScanPoint, Work};
pub use plane::{Plane, PlaneSearch, Ray, plane};
pub use search::{Axis, Search, SearchError, basin, border, column};
