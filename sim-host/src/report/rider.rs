//! Document and table of `rider show`.
#![allow(non_snake_case, reason = "the symbols of the thesis")]

use super::resolved::{ResolvedGains, ResolvedMuscles};
use super::tool::{SCHEMA, Tool};
use crate::rider::{Fit, Gains, KEYS, Outside, RiderTable, Row, Schedule, ScheduleError, Spline};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

type ByKey<T> = BTreeMap<&'static str, T>;

/// `rider show`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RiderDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// Name, or FILE as given.
    pub name: String,
    /// Source of the values.
    pub source: Option<String>,
    /// A remark.
    pub note: Option<String>,
    /// Neural delay \[s\].
    pub delay_s: f64,
    /// The neuromuscular dynamics.
    pub muscles: ResolvedMuscles,
    /// The measured sets of gains.
    pub rows: Vec<RowEntry>,
    /// The gains as functions of speed.
    pub fits: Vec<FitEntry>,
}

/// One measured set.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct RowEntry {
    /// The experiment.
    pub run: Option<u32>,
    /// Sets of similar speed have the same number.
    pub group: u32,
    /// Variance accounted for \[%\].
    pub vaf: Option<f64>,
    /// Standard error of each gain that has one, in the gain's unit.
    pub standard_errors: Option<ByKey<f64>>,
    /// Speed and gains.
    #[serde(flatten)]
    pub at: ResolvedGains,
}

/// The gains as functions of speed.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct FitEntry {
    /// Method of the fit.
    #[schemars(extend("enum" = ["regression", "mean", "best", "spline"]))]
    pub gains: &'static str,
    /// Points of the piecewise linear functions, extrapolated beyond the outermost.
    pub points: Vec<ResolvedGains>,
    /// Slope \[per m/s\] and gain at rest of a regression; null for others.
    pub line: Option<ByKey<(f64, f64)>>,
    /// What else is known of a smoothing spline; null for others.
    pub spline: Option<SplineEntry>,
    /// Coefficient of determination; null for a gain that is equal in all rows.
    pub r_squared: ByKey<Option<f64>>,
}

/// Smoothing splines of the gains.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SplineEntry {
    /// Standard error of each gain at the points, in the gain's unit; null if the sets are too few for one.
    pub standard_errors: Vec<ByKey<Option<f64>>>,
    /// Effective degrees of freedom of each gain: 1 for a constant, 2 for a straight line, more for a curve.
    pub degrees_of_freedom: ByKey<f64>,
    /// Largest difference in the middle between two points of the spline and the straight line between them, in the
    /// gain's unit.
    pub sampling_error: ByKey<f64>,
}

impl SplineEntry {
    /// The splines of a table, sampled at the points of `schedule`.
    fn new(table: &RiderTable, schedule: &Schedule) -> Self {
        let splines = table.splines();
        let of = |value: &dyn Fn(&Spline) -> f64| -> ByKey<f64> {
            table.columns.iter().map(|&i| KEYS[i]).zip(splines.iter().map(value)).collect()
        };
        let errors = |v: f64| {
            let errors = splines.iter().map(|spline| spline.standard_error(v));
            table.columns.iter().map(|&i| KEYS[i]).zip(errors).collect()
        };
        let middles = || schedule.points().windows(2).map(|pair| f64::midpoint(pair[0].0, pair[1].0));
        let off = |(&i, spline): (&usize, &Spline)| {
            let off = middles().map(|v| (spline.at(v) - schedule.at(v).0[i]).abs());
            (KEYS[i], off.fold(0.0, f64::max))
        };
        Self {
            standard_errors: schedule.points().iter().map(|(v, _)| errors(*v)).collect(),
            degrees_of_freedom: of(&|spline| spline.degrees_of_freedom),
            sampling_error: table.columns.iter().zip(&splines).map(off).collect(),
        }
    }
}

impl FitEntry {
    /// The result of `fit` on a table.
    ///
    /// # Errors
    /// See [`RiderTable::schedule`].
    pub fn new(table: &RiderTable, fit: Fit) -> Result<Self, ScheduleError> {
        let schedule = table.schedule(fit, Outside::default())?;
        let line = table.line();
        let pairs = line.slope.0.into_iter().zip(line.intercept.0);
        Ok(Self {
            gains: fit.name(),
            points: schedule.points().iter().map(|(v, k)| ResolvedGains::new(*v, k)).collect(),
            line: (fit == Fit::Regression).then(|| KEYS.into_iter().zip(pairs).collect()),
            spline: (fit == Fit::Spline).then(|| SplineEntry::new(table, &schedule)),
            r_squared: KEYS.into_iter().zip(table.r_squared(&schedule)).collect(),
        })
    }
}

impl RiderDocument {
    /// The document of a table and the requested fits.
    pub fn new(table: &RiderTable, fits: Vec<FitEntry>) -> Self {
        let row = |r: &Row| RowEntry {
            run: r.run,
            group: r.group,
            vaf: r.vaf,
            standard_errors: standard_errors(table, r),
            at: ResolvedGains::new(r.speed_m_s, &r.gains),
        };
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            name: table.name.clone(),
            source: table.source.clone(),
            note: table.note.clone(),
            delay_s: table.delay_s,
            muscles: ResolvedMuscles {
                omega_rad_s: table.neuromuscular.omega_rad_s,
                zeta: table.neuromuscular.zeta,
            },
            rows: table.rows.iter().map(row).collect(),
            fits,
        }
    }
}

/// Standard error of each gain of a row, if its covariance is known.
pub fn standard_errors(table: &RiderTable, row: &Row) -> Option<ByKey<f64>> {
    let errors = row.covariance.as_ref()?.standard_errors();
    Some(table.columns.iter().map(|&i| KEYS[i]).zip(errors).collect())
}

/// One line of the table: a measured set, its standard errors, or a point of a fit.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct GainRow {
    /// "measured", "measured error" (standard errors of the row above, zero for gains without), or the fit.
    pub kind: &'static str,
    /// Forward speed.
    pub speed_m_s: f64,
    /// The experiment.
    pub run: Option<u32>,
    /// Its group.
    pub group: Option<u32>,
    /// Variance accounted for.
    pub vaf: Option<f64>,
    /// Roll.
    pub K_phi_p: f64,
    /// Roll integral.
    pub K_phi_i: f64,
    /// Roll rate.
    pub K_phi_d: f64,
    /// Roll acceleration.
    pub K_phi_dd: f64,
    /// Steer.
    pub K_delta_p: f64,
    /// Steer integral.
    pub K_delta_i: f64,
    /// Steer rate.
    pub K_delta_d: f64,
    /// Steer acceleration.
    pub K_delta_dd: f64,
    /// Heading.
    pub K_psi: f64,
    /// Lateral offset.
    pub K_y: f64,
}

impl GainRow {
    fn new(kind: &'static str, speed_m_s: f64, Gains(k): Gains) -> Self {
        let [K_phi_p, K_phi_i, K_phi_d, K_phi_dd, K_delta_p, K_delta_i, K_delta_d, K_delta_dd, K_psi, K_y] =
            k;
        Self {
            kind,
            speed_m_s,
            run: None,
            group: None,
            vaf: None,
            K_phi_p,
            K_phi_i,
            K_phi_d,
            K_phi_dd,
            K_delta_p,
            K_delta_i,
            K_delta_d,
            K_delta_dd,
            K_psi,
            K_y,
        }
    }
}

/// The measured sets, then the points of `fits`.
///
/// # Errors
/// See [`RiderTable::schedule`].
pub fn gain_rows(table: &RiderTable, fits: &[Fit]) -> Result<Vec<GainRow>, ScheduleError> {
    let mut rows = Vec::new();
    for r in &table.rows {
        let of = |kind, gains| GainRow {
            run: r.run,
            group: Some(r.group),
            vaf: r.vaf,
            ..GainRow::new(kind, r.speed_m_s, gains)
        };
        rows.push(of("measured", r.gains));
        if let Some(covariance) = &r.covariance {
            let mut errors = Gains::default();
            for (&i, error) in table.columns.iter().zip(covariance.standard_errors()) {
                errors.0[i] = error;
            }
            rows.push(of("measured error", errors));
        }
    }
    for fit in fits {
        let schedule = table.schedule(*fit, Outside::default())?;
        rows.extend(schedule.points().iter().map(|(v, k)| GainRow::new(fit.name(), *v, *k)));
    }
    Ok(rows)
}
