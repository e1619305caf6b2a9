//! stub
#![allow(missing_docs)]
use crate::basin::*;
use crate::ride::*;
pub fn basin(_: &Basin, _: usize) -> String {
    String::new()
}
pub fn ride(_: &[TracePoint], _: usize) -> String {
    String::new()
}
pub fn eigen(_: &[f64], _: &[[nalgebra::Complex<f64>; 4]], _: usize) -> String {
    String::new()
}
