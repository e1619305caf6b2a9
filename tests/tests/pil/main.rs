//! The control step on a board in lockstep with the simulated bicycle, a fake one and the image in QEMU.

mod basins;
mod board;
mod chip_failures;
mod command_line;
mod image;
mod link;
mod stopping;
