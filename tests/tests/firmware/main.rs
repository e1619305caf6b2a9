//! Flight cards: the images, in QEMU.

mod budgets;
mod deadlines;
mod faults;
mod line;
mod no_panic;
mod outputs;
mod replay;
mod resets;
