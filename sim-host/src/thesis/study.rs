//! Data common to all items: the bicycle, the resolution, and basins computed once.

use super::case::{Assisted, Case, Resolution};
use super::memo::Memo;
use super::{app_i, app_k};
use crate::basin::{Basin, Column, Search, together};
use crate::bicycle::linear::Linear;
use crate::bicycle::{Geometry, Parameters, catalogue};
use crate::eigen::{CriticalSpeeds, critical_speeds};
use crate::ride::{Conditions, TracePoint};
use crate::rider::Gains;
use rayon::prelude::*;
use std::sync::Arc;

/// The bicycle of the thesis.
const BICYCLE: &str = "rigid_jason";

/// Data common to all items.
#[derive(Debug)]
pub struct Study {
    /// The bicycle's parameters.
    pub parameters: Parameters,
    /// The nonlinear model.
    pub bicycle: Geometry,
    /// The linearised model.
    pub linear: Linear,
    /// Critical speeds of the uncontrolled bicycle.
    pub critical: CriticalSpeeds,
    /// Resolution of basin searches.
    pub resolution: Resolution,
    /// Whether the resolution is reduced for speed.
    pub quick: bool,
    basins: Memo<Case, Basin>,
    /// The sets of Tables I.1 and I.2 with their basins, by table and step of the scan \[rad/s\].
    pub(super) heights: Memo<(&'static str, f64), Vec<app_i::Set>>,
    /// Appendix K's motions at constant gains, by gains and speed \[m/s\].
    pub(super) motions: Memo<(Gains, f64), app_k::Motion>,
    /// The responses of the uncontrolled bicycle to the disturbance of appendix C, by speed \[m/s\].
    pub(super) responses: Memo<f64, Vec<TracePoint>>,
}

impl Study {
    /// The study of the built-in thesis bicycle.
    ///
    /// # Errors
    /// The built-in bicycles cannot be read.
    pub fn new(quick: bool) -> Result<Self, catalogue::BicycleError> {
        let parameters = catalogue::load(BICYCLE)?.parameters;
        let linear = Linear::new(&parameters);
        Ok(Self {
            parameters,
            bicycle: Geometry::new(&parameters),
            linear,
            critical: critical_speeds(&linear, &Assisted::Alone.law()),
            resolution: if quick { Resolution::QUICK } else { Resolution::FULL },
            quick,
            basins: Memo::default(),
            heights: Memo::default(),
            motions: Memo::default(),
            responses: Memo::default(),
        })
    }

    /// The self-stable range of the uncontrolled bicycle \[m/s\].
    pub fn self_stable(&self) -> Option<(f64, f64)> {
        self.critical.v_w.zip(self.critical.v_c)
    }

    /// The basin of a case, stored or computed now.
    pub fn basin(&self, case: &Case) -> Arc<Basin> {
        let columns = || self.columns_at(case, &case.search(&self.resolution).speeds);
        self.basins.get(*case, || Basin { columns: columns() })
    }

    /// The columns of a case's basin at some speeds \[m/s\], computed now.
    pub fn columns_at(&self, case: &Case, speeds: &[f64]) -> Vec<Column> {
        let (conditions, search) = (case.conditions(&self.bicycle), case.search(&self.resolution));
        let size = together(&conditions, &search, speeds.len());
        speeds.par_chunks(size).flat_map_iter(|speeds| case.columns(&conditions, &search, speeds)).collect()
    }

    /// Whether the basin of a case is stored.
    pub fn has(&self, case: &Case) -> bool {
        self.basins.stored(case).is_some()
    }

    /// Computes and stores the basins of `cases`, with all their columns in parallel; calls `finished` after and `stop`
    /// before each column. Interrupted basins are not stored.
    pub fn prepare(&self, cases: &[Case], finished: impl Fn() + Sync, stop: impl Fn() -> bool + Sync) {
        let missing: Vec<&Case> = cases.iter().filter(|c| !self.has(c)).collect();
        let searches: Vec<Search> = missing.iter().map(|c| c.search(&self.resolution)).collect();
        let conditions: Vec<Conditions> = missing.iter().map(|c| c.conditions(&self.bicycle)).collect();
        let left = searches.iter().map(|search| search.speeds.len()).sum();
        let jobs = searches.iter().zip(&conditions).enumerate().flat_map(|(i, (search, conditions))| {
            let size = together(conditions, search, left);
            search.speeds.chunks(size).enumerate().map(move |(k, speeds)| (i, k, speeds))
        });
        // A bridge distributes the jobs in order, one at a time.
        let mut done: Vec<(usize, usize, Vec<Column>)> = jobs
            .par_bridge()
            .filter_map(|(i, k, speeds)| {
                let some = || missing[i].columns(&conditions[i], &searches[i], speeds);
                let columns = (!stop()).then(some)?;
                speeds.iter().for_each(|_| finished());
                Some((i, k, columns))
            })
            .collect();
        done.sort_by_key(|(i, k, _)| (*i, *k));
        let mut done = done.into_iter().peekable();
        for (i, case) in missing.into_iter().enumerate() {
            let mut columns = Vec::new();
            while let Some((_, _, some)) = done.next_if(|(of, _, _)| *of == i) {
                columns.extend(some);
            }
            if columns.len() == searches[i].speeds.len() {
                self.basins.store(*case, Basin { columns });
            }
        }
    }

    /// Number of columns that [`Self::prepare`] has to compute.
    pub fn columns(&self, cases: &[Case]) -> usize {
        cases.iter().filter(|c| !self.has(c)).map(|c| c.search(&self.resolution).speeds.len()).sum()
    }
}
