//! The conditions of a basin search, as a small hashable key.

use super::cyclist::Cyclist;
use crate::basin::{Axis, Column, Method, Search, borders, columns};
use crate::bicycle::Geometry;
use crate::ride::{Assist, Conditions, ScheduleSpeed};
use control::Law;

/// Conditions of a basin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// The steer assist's law.
    pub law: Assisted,
    /// The rider; `None` for a rigid rider.
    pub rider: Option<Cyclist>,
    /// The speed that schedules the gains.
    pub schedule: ScheduleSpeed,
    /// The range of speeds.
    pub span: Span,
    /// Whether the scan goes on beyond the first fall, for a map of the falls.
    pub map: bool,
}

/// A law of the thesis, continuous and without limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Assisted {
    /// No assist.
    Alone,
    /// CL1.
    Cl1,
    /// CL2 with an integer K.
    Cl2(u8),
    /// Eq. 3.11.
    F,
    /// Eq. 3.12.
    G,
    /// Eq. 3.13.
    H,
}

/// A range of forward speeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Span {
    /// 0 to 10 m/s: the range over which the steer assist is evaluated.
    All,
    /// 2 to 7.5 m/s: where the riders were measured.
    Ridden,
}

impl Assisted {
    /// The law.
    pub fn law(self) -> Law {
        match self {
            Assisted::Alone => Law::None,
            Assisted::Cl1 => Law::Cl1,
            Assisted::Cl2(k) => Law::Cl2 { k: f32::from(k) },
            Assisted::F => Law::F,
            Assisted::G => Law::G,
            Assisted::H => Law::H { cut: false },
        }
    }

    /// Its name in the report.
    pub fn name(self) -> String {
        match self {
            Assisted::Alone => "uncontrolled".into(),
            Assisted::Cl1 => "CL1".into(),
            Assisted::Cl2(k) => format!("CL2, K = {k}"),
            Assisted::F => "f".into(),
            Assisted::G => "g".into(),
            Assisted::H => "h".into(),
        }
    }

    fn assist(self) -> Assist {
        match self {
            Assisted::Alone => Assist::None,
            _ => Assist::Ideal(Box::new(self.law().into())),
        }
    }
}

impl Case {
    /// The basin of a law over all speeds, scheduled by the front wheel's speed.
    pub fn of(law: Assisted) -> Self {
        Self { law, rider: None, schedule: ScheduleSpeed::Front, span: Span::All, map: false }
    }

    /// The basin of a rider alone over the speeds riders were measured at.
    pub fn ridden(rider: Cyclist) -> Self {
        Self { rider: Some(rider), span: Span::Ridden, ..Self::of(Assisted::Alone) }
    }

    /// The case with an assist.
    pub fn aided(self, law: Assisted) -> Self {
        Self { law, ..self }
    }

    /// The case with a map of the falls beyond the border.
    pub fn mapped(self) -> Self {
        Self { map: true, ..self }
    }

    /// The case scheduled by another speed.
    pub fn scheduled(self, schedule: ScheduleSpeed) -> Self {
        Self { schedule, ..self }
    }

    /// The conditions of its rides.
    pub fn conditions(&self, bicycle: &Geometry) -> Conditions {
        let thesis = Conditions::thesis(*bicycle, self.law.assist());
        Conditions { schedule_speed: self.schedule, rider: self.rider.map(|r| r.rider()), ..thesis }
    }

    /// The basins at some speeds, under its [`Self::conditions`] and with its [`Self::search`].
    pub fn columns(&self, conditions: &Conditions, search: &Search, speeds: &[f64]) -> Vec<Column> {
        let find = if self.map { columns } else { borders };
        find(conditions, search, speeds)
    }

    /// The search of the basin.
    pub fn search(&self, resolution: &Resolution) -> Search {
        let (from, to, step) = match self.span {
            Span::All => (0.0, 10.0, resolution.assist_speed_step),
            Span::Ridden => (2.0, 7.5, resolution.rider_speed_step),
        };
        let n = ((to - from) / step + 1e-9) as usize;
        let speed = |i: usize| ((from + i as f64 * step) * 1e9).round() / 1e9;
        Search {
            speeds: (0..=n).map(speed).collect(),
            axis: Axis::SteerRate,
            max_rate: 30.0,
            scan_step: resolution.scan_step,
            tolerance: resolution.tolerance,
            method: Method::Fast,
            efforts: false,
        }
    }
}

/// Resolution of basin searches.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Resolution {
    /// Step of the speeds from 0 to 10 m/s \[m/s\].
    pub assist_speed_step: f64,
    /// Step of the speeds from 2 to 7.5 m/s, where riders were measured \[m/s\].
    pub rider_speed_step: f64,
    /// Step of the scan \[rad/s\]; a whole part of [`GRID`].
    pub scan_step: f64,
    /// Accuracy of borders \[rad/s\].
    pub tolerance: f64,
}

/// The grid of disturbances the thesis probably used \[rad/s\].
pub const GRID: f64 = 0.5;

impl Resolution {
    /// Resolution of the report.
    pub const FULL: Self =
        Self { assist_speed_step: 0.1, rider_speed_step: 0.1, scan_step: 0.25, tolerance: 0.01 };
    /// Resolution of `--quick`.
    pub const QUICK: Self =
        Self { assist_speed_step: 1.0, rider_speed_step: 0.5, scan_step: 0.5, tolerance: 0.05 };
}
