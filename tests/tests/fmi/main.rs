//! The FMUs: in FMPy, through the C interface, and their export.

mod c_interface;
mod fmpy;
mod program;
mod states;
