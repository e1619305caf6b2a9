//! The parts of the controller on the nonlinear bicycle.

mod dead_band;
mod estimate;
mod fault_heights;
mod fault_pages;
mod fault_rides;
mod gentle;
mod laws;
mod leaves;
mod limp;
mod lone_wheel;
mod loose_switch;
mod predict;
mod response;
mod sensor_sets;
mod track;
