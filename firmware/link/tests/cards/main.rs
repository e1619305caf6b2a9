//! Flight cards of the link and the store, on the host with simulated flash.

mod alignment;
mod can;
mod can_bit_timing;
mod can_mailbox;
mod corruption;
mod documented;
mod fault_log;
mod flash;
mod frames;
mod listing;
mod lockstep;
mod messages;
mod power;
mod requests;
mod store;
mod tx_queue;
