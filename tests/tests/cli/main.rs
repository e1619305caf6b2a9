//! Flight cards: the command line.

mod bad_input;
mod bicycle_files;
mod capped;
mod contract;
mod design;
mod document;
mod identify;
mod interrupt;
mod none;
mod options;
mod outputs;
mod parsers;
mod plant;
mod riders;
mod study;
mod sweep;
