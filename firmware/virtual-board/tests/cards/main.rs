//! The flashed image on the virtual board; tests in the form of flight cards.

mod bed;
mod boards;
mod bring_up;
mod core;
mod core_beside_qemu;
mod documented_times;
mod gate;
mod gdb;
mod input;
mod motor;
mod product;
mod program;
mod registers;
mod rides;
mod rides_page;
mod serial;
mod slip;
mod startup;
mod store;
mod vibration;
