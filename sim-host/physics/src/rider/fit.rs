//! From measured sets of gains to gains as functions of speed (Kuipers 2020, section 2.3.3; `spline` is not his).

use super::spline::{Point, Spline, Variances};
use super::table::{RiderTable, Row};
use super::{Covariance, Gains, KEYS, Line, Outside, Rider, Schedule, ScheduleError};

/// Method that makes gains continuous over speed.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Fit {
    /// One straight line per gain (LR in the thesis): the table's own `regression`, otherwise least squares
    /// over all sets.
    Regression,
    /// Straight lines through the groups' means, at the mean of their speeds (LI, mean).
    #[default]
    Mean,
    /// Straight lines through each group's best set, at that set's speed (LI, HV).
    Best,
    /// A cubic smoothing spline per gain through all sets, weighted by their standard errors or the scatter in their
    /// groups, as rough as is likeliest (REML); straight beyond the outermost sets.
    Spline,
}

impl Fit {
    /// All methods.
    pub const ALL: [Self; 4] = [Self::Regression, Self::Mean, Self::Best, Self::Spline];
    /// Those of the thesis.
    pub const THESIS: [Self; 3] = [Self::Regression, Self::Mean, Self::Best];

    /// Name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Regression => "regression",
            Self::Mean => "mean",
            Self::Best => "best",
            Self::Spline => "spline",
        }
    }
}

/// Most intervals in which a spline is sampled.
const SAMPLED: f64 = 128.0;
/// Degrees of freedom that the groups' common variance has in each group: few sets give a variance no precision.
const COMMON: f64 = 4.0;

/// Mean speed \[m/s\] and gains of some rows.
pub fn mean(rows: &[Row]) -> (f64, Gains) {
    let n = rows.len() as f64;
    let gains = std::array::from_fn(|i| rows.iter().map(|r| r.gains.0[i]).sum::<f64>() / n);
    (rows.iter().map(|r| r.speed_m_s).sum::<f64>() / n, Gains(gains))
}

impl RiderTable {
    /// Least-squares line of each gain over all rows; constant if all rows have the same speed.
    pub fn least_squares(&self) -> Line {
        let (speed, gains) = mean(&self.rows);
        let square: f64 = self.rows.iter().map(|r| (r.speed_m_s - speed).powi(2)).sum();
        let slope = std::array::from_fn(|i| {
            let product = |r: &Row| (r.speed_m_s - speed) * (r.gains.0[i] - gains.0[i]);
            if square > 0.0 { self.rows.iter().map(product).sum::<f64>() / square } else { 0.0 }
        });
        let intercept = std::array::from_fn(|i| gains.0[i] - slope[i] * speed);
        Line { slope: Gains(slope), intercept: Gains(intercept) }
    }

    /// The line of [`Fit::Regression`]: the table's own, otherwise least squares.
    pub fn line(&self) -> Line {
        self.regression.unwrap_or_else(|| self.least_squares())
    }

    /// Gains as functions of speed.
    ///
    /// # Errors
    /// States the value and its range. [`Fit::Best`] needs a VAF for every set of a group, or `best_runs`, or
    /// groups of one set.
    pub fn schedule(&self, fit: Fit, outside: Outside) -> Result<Schedule, ScheduleError> {
        let points = match fit {
            Fit::Regression => {
                let (first, last) = (&self.rows[0], &self.rows[self.rows.len() - 1]);
                let line = self.line();
                let mut speeds = vec![first.speed_m_s, last.speed_m_s];
                speeds.dedup();
                speeds.into_iter().map(|v| (v, line.at(v))).collect()
            }
            Fit::Mean => self.groups().map(mean).collect(),
            Fit::Best => self.groups().map(|g| self.best(g)).collect::<Result<_, _>>()?,
            Fit::Spline => {
                let splines = self.splines();
                self.sampled_speeds().map(|v| (v, self.gains_of(|j| splines[j].at(v)))).collect()
            }
        };
        Schedule::new(points, outside)
    }

    /// The smoothing spline of each gain that has a column, through all sets, each at the mean speed of its group: the
    /// small differences of speed inside a group have no meaning for a slope.
    pub fn splines(&self) -> Vec<Spline> {
        let speeds: Vec<f64> = self.groups().flat_map(|group| vec![mean(group).0; group.len()]).collect();
        let one = |(j, &i): (usize, &usize)| {
            let (variances, kind) = self.variances(j);
            let points = self.rows.iter().zip(&speeds).zip(variances);
            let point =
                |((row, &x), variance): ((&Row, &f64), f64)| Point { x, value: row.gains.0[i], variance };
            Spline::new(&points.map(point).collect::<Vec<_>>(), kind)
        };
        self.columns.iter().enumerate().map(one).collect()
    }

    /// Gains from a value for each column.
    fn gains_of(&self, value: impl Fn(usize) -> f64) -> Gains {
        let mut gains = Gains::default();
        self.columns.iter().enumerate().for_each(|(j, &i)| gains.0[i] = value(j));
        gains
    }

    /// Speeds at which a spline is sampled \[m/s\]: evenly over the mean speeds of the groups, at least 2 mm/s apart.
    fn sampled_speeds(&self) -> impl Iterator<Item = f64> + use<> {
        let (first, last) = self.groups().fold((f64::INFINITY, 0.0), |(first, _): (f64, f64), group| {
            let (speed, _) = mean(group);
            (first.min(speed), speed)
        });
        let intervals = if last > first { ((last - first) / 2e-3).clamp(1.0, SAMPLED) as usize } else { 0 };
        let width = last - first;
        (0..=intervals)
            .map(move |i| if i == intervals { last } else { first + width * i as f64 / intervals as f64 })
    }

    /// Variance of each row's gain in column `j`: its squared standard error, if all rows have one, not below
    /// 1e-6 of the largest; otherwise that of its group, as if the groups' common variance had been measured in it with
    /// [`COMMON`] more degrees of freedom.
    fn variances(&self, j: usize) -> (Vec<f64>, Variances) {
        let variance = |c: &Covariance| c.matrix()[(j, j)];
        let known: Option<Vec<f64>> = self.rows.iter().map(|r| r.covariance.as_ref().map(variance)).collect();
        if let Some(known) = known {
            let largest = known.iter().fold(0.0, |a: f64, b| a.max(*b));
            if largest > 0.0 {
                return (known.into_iter().map(|v| v.max(1e-6 * largest)).collect(), Variances::Known);
            }
        }
        let i = self.columns[j];
        let squares = |group: &[Row]| {
            let (_, mean) = mean(group);
            group.iter().map(|r| (r.gains.0[i] - mean.0[i]).powi(2)).sum::<f64>()
        };
        let free = (self.rows.len() - self.groups().count()) as f64;
        let common = self.groups().map(squares).sum::<f64>() / free;
        if free == 0.0 || common == 0.0 {
            return (vec![1.0; self.rows.len()], Variances::Relative);
        }
        let of = |group: &[Row]| {
            let free = group.len() as f64 - 1.0 + COMMON;
            vec![(squares(group) + COMMON * common) / free; group.len()]
        };
        (self.groups().flat_map(of).collect(), Variances::Relative)
    }

    fn best(&self, group: &[Row]) -> Result<(f64, Gains), ScheduleError> {
        let named = |r: &&Row| self.best_runs.iter().flatten().any(|run| r.run == Some(*run));
        let highest = || {
            let vafs: Option<Vec<f64>> = group.iter().map(|r| r.vaf).collect();
            let (i, _) = vafs?.into_iter().enumerate().rev().max_by(|a, b| a.1.total_cmp(&b.1))?;
            Some(&group[i])
        };
        let best = match group {
            [one] => Some(one),
            _ => group.iter().find(named).or_else(highest),
        };
        let none = || ScheduleError::NoBest { sets: group.len(), speed_m_s: group[0].speed_m_s };
        best.map(|r| (r.speed_m_s, r.gains)).ok_or_else(none)
    }

    /// Coefficient of determination of each gain: `1 - sum (K - f)^2 / sum (K - mean K)^2` over the rows,
    /// with `f` the schedule at the row's speed; `None` if all rows have the same gain.
    ///
    /// Eq. 2.21 is printed as `1 - sum (K - mean K)^2 / sum (f - mean K)^2`. For the regression of Table F.1
    /// that gives -195 to -0.2, but 0.005 to 0.855 is printed; the form used here gives the printed values.
    pub fn r_squared(&self, schedule: &Schedule) -> [Option<f64>; KEYS.len()] {
        let (_, mean) = mean(&self.rows);
        std::array::from_fn(|i| {
            let first = self.rows[0].gains.0[i];
            if self.rows.iter().all(|r| r.gains.0[i] == first) {
                return None;
            }
            let sum = |f: &dyn Fn(&Row) -> f64| -> f64 {
                self.rows.iter().map(|r| (r.gains.0[i] - f(r)).powi(2)).sum()
            };
            Some(1.0 - sum(&|r| schedule.at(r.speed_m_s).0[i]) / sum(&|_| mean.0[i]))
        })
    }

    /// The rider with these gains; `delay_s` \[s\] replaces the table's own.
    ///
    /// # Errors
    /// As [`RiderTable::schedule`].
    pub fn rider(&self, fit: Fit, outside: Outside, delay_s: Option<f64>) -> Result<Rider, ScheduleError> {
        let schedule = self.schedule(fit, outside)?;
        Ok(Rider { schedule, delay_s: delay_s.unwrap_or(self.delay_s), neuromuscular: self.neuromuscular })
    }
}
