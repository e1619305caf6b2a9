//! The flashed code in the simulated loop.

mod basins;
mod checks;
mod motion;
mod published;
mod riders;
mod rides;
mod rounds;
mod search;
mod sensitivity;
