//! Flight cards: sensors, actuators and what breaks in them.

mod actuator;
mod faults;
mod fitted;
mod readings;
mod rides;
mod sensor_files;
mod sensors;
