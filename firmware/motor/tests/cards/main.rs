//! Flight cards of the motor's loop, on a motor that is simulated.

mod alignment;
mod bench;
mod command_word;
mod config;
mod faults;
mod machine;
mod maths;
mod model;
mod properties;
mod slip;
mod torque;
