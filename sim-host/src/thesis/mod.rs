//! Reproduces the thesis: every table and figure of Kuipers 2020 that needs no unpublished measurement, with each
//! published number beside the computed one.

pub mod app_c;
#[cfg(feature = "solvers")]
pub mod app_d;
mod app_h;
mod app_i;
mod app_j;
mod app_k;
pub mod case;
pub mod catalogue;
mod ch2;
mod ch3_assist;
mod ch3_laws;
mod ch3_riders;
mod constant;
pub mod cyclist;
pub mod document;
mod draw;
mod figures_of_merit;
mod fits;
pub mod heights;
mod html;
pub mod item;
mod memo;
pub mod published;
mod reductions;
pub mod run;
mod sensitivity;
#[cfg(feature = "solvers")]
pub mod solvers;
pub mod study;
pub mod write;
