//! Sensors, actuators and their faults.

mod actuator;
mod faults;
mod fitted;
mod readings;
mod rides;
mod sensor_files;
mod sensors;
