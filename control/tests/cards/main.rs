//! Flight cards of the control crate alone: what holds whatever the bicycle.

mod answer;
mod cross_check;
mod engagement;
mod fuzz;
mod guard;
mod limiter;
mod limits;
mod maths;
mod monitor;
mod polarity;
mod press;
mod properties;
mod regression;
mod smooth;
mod steering;
mod validation;
mod wheel_speed;
mod wire;
