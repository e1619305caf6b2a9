//! Flight cards: the image that is flashed, on the virtual board.

mod alive;
mod bed;
mod bring_up;
mod core;
mod core_beside_qemu;
mod gate;
mod gdb;
mod input;
mod measured;
mod motor;
mod product;
mod program;
mod registers;
mod rides;
mod rides_page;
mod rig;
mod serial;
mod slip;
mod store;
mod vibration;
