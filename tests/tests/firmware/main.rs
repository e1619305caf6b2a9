//! The images, in QEMU.

mod budgets;
mod deadlines;
mod faults;
mod functions;
mod line;
mod no_panic;
mod outputs;
mod polarity;
mod replay;
mod resets;
mod runner;
mod steady_board;
