//! Linear analysis and identification: eigenvalues of the linearised bicycle with assist and delayed rider, gains of path
//! tracking, and what recordings say of a rider, of a controller or of the weave.

pub mod closed_loop;
pub mod damped;
pub mod eigen;
pub mod exponential;
pub mod identify;
pub mod matrix_pencil;
pub mod simplex;
pub mod tracking;
pub mod weave;
