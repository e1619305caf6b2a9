//! The delayed human riders.

mod covariance;
mod delay;
mod draws;
mod linear;
mod parts;
mod roots;
mod spline;
mod tables;
