//! From the sensors' samples to measurements that the controller may use, and the checks of sensors against each other.

pub mod calibration;
pub mod cross_check;
pub mod frame;
pub mod latency;
pub mod monitor;
pub mod polarity;
pub mod regression;
pub mod sign_check;
pub mod validation;
pub mod wheel_speed;
