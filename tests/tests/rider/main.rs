//! The delayed human riders.

mod delay;
mod linear;
mod parts;
mod perturbation;
mod roots;
mod tables;
