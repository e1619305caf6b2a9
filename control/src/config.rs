//! Everything a user may choose, in one place.

use crate::calibrate::Calibration;
use crate::capsize::Capsize;
use crate::controller::Plan;
use crate::cross::CrossConfig;
use crate::estimate::EstimateConfig;
use crate::history::Latency;
use crate::input::InputConfig;
use crate::law::Law;
use crate::limits::{Limits, Taper};
use crate::param::{Checker, Leaf, ParamError, Visit};
use crate::permit::PermitConfig;
use crate::watch::{Loss, Sensor};

/// Everything a user may choose. Plain data; [`Config::plan`] checks it.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How often [`crate::step`] is called \[Hz\], 100..=10000.
    pub rate_hz: f32,
    /// The roll-rate law.
    pub law: Law,
    /// The capsize term added to it.
    pub capsize: Capsize,
    /// How sensors and motor sit on this bicycle.
    pub calibration: Calibration,
    /// The declared sensors.
    pub input: InputConfig,
    /// How the motion is estimated.
    pub estimate: EstimateConfig,
    /// How far sensors may disagree.
    pub cross: CrossConfig,
    /// When torque may flow.
    pub permit: PermitConfig,
    /// How late each sensor is known to be.
    pub latency: Latency,
    /// Limits on the torque.
    pub limits: Limits,
}

impl Config {
    /// The conditions of the published basins: the law alone, every limit and check off, permission
    /// for the asking.
    pub fn thesis(law: Law) -> Self {
        Self {
            rate_hz: 1000.0,
            law,
            capsize: Capsize::default(),
            calibration: Calibration::default(),
            input: InputConfig::default(),
            estimate: EstimateConfig::default(),
            cross: CrossConfig::default(),
            permit: PermitConfig::default(),
            latency: Latency::default(),
            limits: Limits::default(),
        }
    }

    /// What is flashed: `h` cut to zero above 7.5 m/s, 7 N m (the largest torque of the published
    /// balance-assist prototype), 100 N m/s (above the 91 N m/s that border rides of unlimited `h`
    /// reach), nothing below 0.5 m/s and all of it from 1.5 m/s, samples up to 10 ms (gyro) and
    /// 250 ms (wheel pulses) old. It refuses to engage until a polarity check was passed.
    pub fn product() -> Self {
        let gyro =
            Sensor { timeout_ticks: 10, qualify_samples: 100, loss: Loss::Fault, ..Sensor::exact(60.0) };
        let wheel =
            Sensor { timeout_ticks: 250, qualify_samples: 3, loss: Loss::Fault, ..Sensor::exact(30.0) };
        let input = InputConfig { gyro, front_wheel: wheel, ..InputConfig::default() };
        let permit = PermitConfig {
            self_test_ticks: 200,
            ramp_in_ticks: 500,
            ramp_out_ticks: 200,
            need_polarity: true,
            ..PermitConfig::default()
        };
        let limits = Limits {
            max_torque_nm: Some(7.0),
            rise_nm_s: Some(100.0),
            fall_nm_s: Some(100.0),
            taper: Some(Taper { zero_m_s: 0.5, full_m_s: 1.5 }),
            ..Limits::default()
        };
        Self { input, permit, limits, ..Self::thesis(Law::H { cut: true }) }
    }

    /// Shows every parameter but the law's.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        to.number(&Leaf::new("", "rate_hz", 100.0, 10_000.0), &mut self.rate_hz);
        self.capsize.leaves(to);
        self.calibration.leaves(to);
        self.input.leaves(to);
        self.estimate.leaves(to);
        self.cross.leaves(to);
        self.permit.leaves(to);
        self.latency.leaves(to);
        self.limits.leaves(to);
    }

    /// Checks every value and readies what [`crate::step`] needs.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn plan(mut self) -> Result<Plan, ParamError> {
        let mut checker = Checker::default();
        self.leaves(&mut checker);
        checker.note(self.law.validate());
        checker.note(self.limits.cross());
        checker.verdict()?;
        Ok(Plan::new(self))
    }
}
