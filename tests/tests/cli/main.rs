//! Flight cards: the command line.

mod bad_input;
mod contract;
mod design;
mod document;
mod identify;
mod identify_sensor;
mod interrupt;
mod options;
mod outputs;
mod parsers;
mod plant;
mod riders;
mod study;
mod sweep;
