//! Flight cards: the flashed code in the simulated loop.

mod basins;
mod published;
mod riders;
mod rides;
mod sensitivity;
