//! Converts the sensors' samples to validated measurements, and checks sensors against each other.

pub mod calibration;
pub mod cross_check;
pub mod frame;
pub mod latency;
pub mod measurements;
pub mod monitor;
pub mod polarity;
mod recent;
pub mod regression;
pub mod sign_check;
pub mod validation;
pub mod wheel_speed;
