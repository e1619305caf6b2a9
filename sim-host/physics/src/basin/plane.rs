//! The basin at one speed over two disturbances: steer rate and roll rate.

use super::search::{along, together};
use super::{Axis, Column, Method, Search, SearchError, Work};
use crate::range::within_key;
use crate::ride::{Conditions, Start};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Settings of the search along rays from the undisturbed ride, evenly spread over half of the plane in units
/// of the two largest rates. The other half is the mirror image.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PlaneSearch {
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// Rays over half a turn.
    pub rays: usize,
    /// Largest steer rate tried \[rad/s\].
    pub max_steer_rate: f64,
    /// Largest roll rate tried \[rad/s\].
    pub max_roll_rate: f64,
    /// Points of the scan along each ray.
    pub points: usize,
    /// Tolerance of borders, as a fraction of a ray.
    pub tolerance: f64,
    /// How the rides are simulated.
    pub method: Method,
}

impl Default for PlaneSearch {
    /// 60 rays up to 20 and 4 rad/s; the speed is unknown (NaN).
    fn default() -> Self {
        Self {
            speed: f64::NAN,
            rays: 60,
            max_steer_rate: 20.0,
            max_roll_rate: 4.0,
            points: 80,
            tolerance: 5e-4,
            method: Method::Fast,
        }
    }
}

/// One direction in the plane of disturbances.
#[derive(Clone, Debug, PartialEq)]
pub struct Ray {
    /// Steer rate at the ray's end \[rad/s\].
    pub steer_rate: f64,
    /// Roll rate at the ray's end \[rad/s\].
    pub roll_rate: f64,
    /// Result along the ray; its rates are fractions of the ray, 0 to 1.
    pub column: Column,
}

impl Ray {
    /// The disturbance at the fraction `s` of the ray: steer rate, roll rate \[rad/s\].
    pub fn at(&self, s: f64) -> (f64, f64) {
        (s * self.steer_rate, s * self.roll_rate)
    }
}

/// A basin over steer rate and roll rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// The rays searched, ordered by angle. Incomplete after an interruption.
    pub rays: Vec<Ray>,
}

impl Plane {
    /// Border of the star-shaped part around zero, as a closed curve: steer rate, roll rate \[rad/s\].
    pub fn outline(&self) -> Vec<(f64, f64)> {
        let half = self.rays.iter().map(|ray| ray.at(ray.column.upper));
        let mirrored = half.clone().map(|(steer, roll)| (-steer, -roll));
        half.chain(mirrored).collect()
    }

    /// Area inside the outline \[rad^2/s^2\].
    pub fn area(&self) -> f64 {
        let points = self.outline();
        let next = points.iter().cycle().skip(1);
        0.5 * points.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>() + 0.0
    }

    /// Whether the area is a lower bound: no ride fell up to the end of some ray.
    pub fn capped(&self) -> bool {
        self.rays.iter().any(|ray| ray.column.capped)
    }

    /// Computing effort.
    pub fn work(&self) -> Work {
        self.rays.iter().fold(Work::default(), |sum, ray| sum.plus(&ray.column.work))
    }
}

impl PlaneSearch {
    /// The direction of ray `i`: steer rate, roll rate at its end \[rad/s\].
    fn direction(&self, i: usize) -> (f64, f64) {
        let (sin, cos) = libm::sincos(PI * i as f64 / self.rays as f64);
        (self.max_steer_rate * cos, self.max_roll_rate * sin)
    }

    /// Checks ranges.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), SearchError> {
        within_key("plane.speed", "speed (m/s)", self.speed, 0.0, 30.0)?;
        within_key("plane.rays", "number of rays", self.rays as f64, 2.0, 10_000.0)?;
        within_key("plane.max_steer_rate", "largest steer rate (rad/s)", self.max_steer_rate, 0.01, 100.0)?;
        within_key("plane.max_roll_rate", "largest roll rate (rad/s)", self.max_roll_rate, 0.01, 100.0)?;
        within_key("plane.points", "points of a ray", self.points as f64, 1.0, 10_000.0)?;
        let most = 1.0 / self.points as f64;
        within_key("plane.tolerance", "tolerance as a part of a ray", self.tolerance, 1e-9, most)?;
        Ok(())
    }
}

/// Computes the basin over both rates, on all cores of the current rayon pool. `finished` is called after
/// each ray, `stop` is checked before each. The result does not depend on the number of threads.
///
/// # Errors
/// The search or the conditions fail their checks.
pub fn plane(
    conditions: &Conditions,
    search: &PlaneSearch,
    finished: impl Fn(&Ray) + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Plane, SearchError> {
    search.check()?;
    conditions.check()?;
    let line = Search {
        speeds: vec![search.speed],
        axis: Axis::SteerRate,
        max_rate: 1.0,
        scan_step: 1.0 / search.points as f64,
        tolerance: search.tolerance,
        method: search.method,
        efforts: false,
    };
    let all: Vec<usize> = (0..search.rays).collect();
    let explored = |group: &[usize]| -> Vec<Ray> {
        if stop() {
            return Vec::new();
        }
        let ends: Vec<(f64, f64)> = group.iter().map(|&i| search.direction(i)).collect();
        let starts: Vec<_> = ends
            .iter()
            .map(|&(steer_rate, roll_rate)| {
                move |s: f64| Start {
                    speed_m_s: search.speed,
                    steer_rate_rad_s: s * steer_rate,
                    roll_rate_rad_s: s * roll_rate,
                }
            })
            .collect();
        let columns = along(conditions, &line, &starts);
        let rays = ends.into_iter().zip(columns);
        rays.map(|((steer_rate, roll_rate), column)| Ray { steer_rate, roll_rate, column })
            .inspect(|ray| finished(ray))
            .collect()
    };
    Ok(Plane {
        rays: all.par_chunks(together(conditions, &line, all.len())).flat_map_iter(explored).collect(),
    })
}
