//! Tests of the control crate alone, independent of the bicycle, written as flight cards: situation, action, what must
//! hold.

mod answer;
mod cross_check;
mod dead_band;
mod engagement;
mod fuzz;
mod guard;
mod limiter;
mod limits;
mod maths;
mod monitor;
mod needs_motion;
mod parameters;
mod polarity;
mod press;
mod properties;
mod recent;
mod regression;
mod smooth;
mod steering;
mod validation;
mod wheel_speed;
mod wire;
