//! The bicycle.

mod closed_loop;
mod counts;
mod energy;
mod lateral_force;
mod linear;
mod newton_euler;
mod operations;
mod order;
mod pitch;
mod published;
mod rotor;
mod speeds;
mod symmetry;
mod table1;
