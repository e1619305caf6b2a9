//! The thesis computed again: every table and figure of Kuipers 2020 that needs no unpublished
//! measurement, each published number beside the computed one.

pub mod app_c;
pub mod app_d;
pub mod case;
pub mod catalogue;
mod ch2;
mod ch3_assist;
mod ch3_laws;
pub mod damped;
pub mod document;
mod draw;
pub mod heights;
mod html;
pub mod item;
pub mod pencil;
pub mod published;
pub mod run;
pub mod simplex;
pub mod solvers;
pub mod study;
pub mod write;
