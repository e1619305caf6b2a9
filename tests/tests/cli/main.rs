//! The command line.

mod adaptive;
mod any_bicycle;
mod bad_input;
mod bicycle_files;
mod capped;
mod contract;
mod data;
mod design;
mod details;
mod document;
mod drawn_riders;
mod examples;
mod falls;
mod identify;
mod identify_loop;
mod identify_report;
mod identify_rider;
mod identify_sensor;
mod interrupt;
mod library;
mod none;
mod options;
mod outputs;
mod parsers;
mod plant;
mod record;
mod riders;
mod same_bytes;
mod scenario;
mod smoothing;

mod study;
mod sweep;
mod sweep_shared;
