//! Flight cards: sensors, actuators and what breaks in them.

mod actuator;
mod faults;
mod readings;
mod rides;
mod sensors;
