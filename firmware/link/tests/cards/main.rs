//! Flight cards of the link and the store, on the host with simulated flash.

mod alignment;
mod corruption;
mod documented;
mod flash;
mod frames;
mod listing;
mod lockstep;
mod messages;
mod parameters;
mod power;
mod ring;
mod sender;
mod store;
