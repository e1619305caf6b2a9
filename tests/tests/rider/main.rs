//! The delayed human riders.

mod delay;
mod linear;
mod parts;
mod roots;
mod tables;
