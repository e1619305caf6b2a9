//! Flight cards of the control crate alone: what holds whatever the bicycle.

mod answer;
mod cross;
mod fuzz;
mod guard;
mod input;
mod limits;
mod maths;
mod permit;
mod polarity;
mod press;
mod properties;
mod pulses;
mod shape;
mod slope;
mod smooth;
mod steering;
mod watch;
mod wire;
