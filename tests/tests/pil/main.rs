//! Flight cards: the control step on a board in lockstep with the simulated bicycle, a fake one and the image in QEMU.

mod basins;
mod board;
mod command_line;
mod image;
mod link;
mod mishaps;
mod stopping;
