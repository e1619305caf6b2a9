//! The delayed human riders.

mod covariance;
mod delay;
mod draws;
mod identify;
mod linear;
mod parts;
mod perturbation;
mod recovery;
mod residuals;
mod roots;
mod spline;
mod tables;
