//! stub
#![allow(missing_docs)]
use crate::basin::*;
use crate::eigen::*;
use crate::ride::*;
pub struct Picture;
impl Picture {
    pub fn svg(&self) -> &str {
        ""
    }
    pub fn png(&self) -> Result<Vec<u8>, String> {
        Ok(vec![])
    }
}
pub struct BasinFigure<'a> {
    pub series: &'a [(&'a str, &'a Basin)],
    pub self_stable: Option<(f64, f64)>,
    pub axis: Axis,
    pub cap: f64,
    pub title: &'a str,
}
pub fn basin(_: &BasinFigure) -> Picture {
    Picture
}
pub struct RideFigure<'a> {
    pub trace: &'a [TracePoint],
    pub outcome: Outcome,
    pub title: &'a str,
}
pub fn ride(_: &RideFigure) -> Picture {
    Picture
}
pub struct EigenFigure<'a> {
    pub speeds: &'a [f64],
    pub eigenvalues: &'a [[nalgebra::Complex<f64>; 4]],
    pub critical: CriticalSpeeds,
    pub title: &'a str,
}
pub fn eigen(_: &EigenFigure) -> Picture {
    Picture
}
