//! Basins of attraction: disturbances, over forward speed, from which a ride does not fall.

mod bound;
mod compare;
mod drawn;
mod ends;
mod fast;
mod outline;
mod plain;
mod plane;
mod rounds;
mod scan;
mod search;
mod sensitivity;

pub use bound::Bound;
pub use compare::{Rmse, rmse};
pub use drawn::{Drawn, QUANTILES, drawn, drawn_bicycles, drawn_riders};
pub use outline::{Basin, Column, Island, ScanPoint, Work, area};
pub use plane::{Plane, PlaneSearch, Ray, plane};
pub use rounds::{Refined, Rounds, SMALLEST_STEP, basin_in_rounds};
pub use search::{
    Axis, Method, Search, SearchError, basin, basin_by, border, borders, column, columns, together,
};
pub use sensitivity::{Quantity, Sensitivity, sensitivities};
