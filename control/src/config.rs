//! All parameters of the controller.

use crate::estimate::predict::PredictConfig;
use crate::estimate::smooth::SmoothConfig;
use crate::estimate::{EstimateConfig, Source};
use crate::law::Law;
use crate::law::capsize::Capsize;
use crate::law::dead_band::DeadBand;
use crate::law::path_tracking::PathTracking;
use crate::param::{ParamSpec, ParamVisitor, optional};
use crate::safety::engagement::EngagementConfig;
use crate::safety::limits::Limits;
use crate::safety::press::PressConfig;
use crate::sensors::calibration::Calibration;
use crate::sensors::cross_check::CrossCheckConfig;
use crate::sensors::latency::Latency;
use crate::sensors::monitor::{Loss, Sensor};
use crate::sensors::sign_check::{SignCheckConfig, SteerModel};
use crate::sensors::validation::ValidationConfig;

/// All parameters of the controller. Plain data; [`Config::plan`] validates them.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Call rate of [`crate::step`] \[Hz\], 100..=10000.
    pub rate_hz: f32,
    /// Roll-rate law.
    pub law: Law,
    /// Dead band of the roll rate, in front of the roll-rate law.
    pub dead_band: DeadBand,
    /// Capsize term, added to the roll-rate law.
    pub capsize: Capsize,
    /// Mounting, zeros and signs of sensors and motor.
    pub calibration: Calibration,
    /// Declared sensors.
    pub input: ValidationConfig,
    /// Motion estimator.
    pub estimate: EstimateConfig,
    /// Cross-check tolerances between sensors.
    pub cross: CrossCheckConfig,
    /// Online sign checks of gyro and motor.
    pub response: SignCheckConfig,
    /// Conditions of engagement.
    pub permit: EngagementConfig,
    /// Known latency of each sensor.
    pub latency: Latency,
    /// Prediction over the delay of sensors and actuator.
    pub predict: PredictConfig,
    /// Smoothing of the roll rate before the law.
    pub smooth: SmoothConfig,
    /// Path tracking; `None` is off.
    pub track: Option<PathTracking>,
    /// Limits of the torque.
    pub limits: Limits,
}

impl Config {
    /// Conditions of the published basins: the law alone, every limit and check off, engagement without conditions.
    pub fn thesis(law: Law) -> Self {
        Self {
            rate_hz: 1000.0,
            law,
            dead_band: DeadBand::default(),
            capsize: Capsize::default(),
            calibration: Calibration::default(),
            input: ValidationConfig::default(),
            estimate: EstimateConfig::default(),
            cross: CrossCheckConfig::default(),
            response: SignCheckConfig::default(),
            permit: EngagementConfig::default(),
            latency: Latency::default(),
            predict: PredictConfig::default(),
            smooth: SmoothConfig::default(),
            track: None,
            limits: Limits::default(),
        }
    }

    /// Configuration as flashed: `h` cut to zero above 7.5 m/s; every sensor declared and monitored except the rider's
    /// torque and the path; all limits and checks on ([`Limits::product`]). Engagement requires a passed polarity
    /// check.
    ///
    /// Largest slopes are at least twice, ranges and steps 1.4 times the maxima of rides inside the basins of `h`,
    /// without and with riders (`data/motion.toml`). The steps are those of the disturbance, which acts at once, and of
    /// a wheel that starts to turn, whose first pulses change the speed by up to 1 m/s at once.
    pub fn product() -> Self {
        let sensor = |max, slope_per_s, timeout_ticks, loss| Sensor {
            slope_per_s: Some(slope_per_s),
            timeout_ticks,
            stuck_ticks: 100,
            qualify_samples: 50,
            loss,
            ..Sensor::exact(max)
        };
        let wheel = |slope| Sensor {
            step: 1.0,
            stuck_ticks: 500,
            qualify_samples: 3,
            ..sensor(30.0, slope, 250, Loss::Limp)
        };
        let input = ValidationConfig {
            recent_samples: 3,
            drift_m_s2: 10.0,
            drift_after_ticks: 30,
            max_gap_ms: Some(5.0),
            gyro: Sensor { step: 4.0, ..sensor(35.0, 500.0, 10, Loss::Fault) },
            accel: Sensor { slope_per_s: None, ..sensor(160.0, 0.0, 20, Loss::Limp) },
            steer: sensor(1.6, 40.0, 20, Loss::Limp),
            steer_rate: Sensor { step: 20.0, ..sensor(40.0, 1000.0, 20, Loss::Limp) },
            front_wheel: wheel(300.0),
            rear_wheel: wheel(100.0),
            motor: Sensor { slope_per_s: None, ..sensor(20.0, 0.0, 20, Loss::Fault) },
            ..ValidationConfig::default()
        };
        let cross = CrossCheckConfig {
            wheels_m_s: Some(0.8),
            yaw_rad_s: Some(2.0),
            yaw_slow_rad_s: Some(0.5),
            yaw_slope: true,
            roll_correlation: true,
            steer_rad: Some(0.1),
            motor_nm: Some(2.0),
            persist_ticks: 50,
            slow_ticks: 300,
            same_checks: 2,
            ..CrossCheckConfig::default()
        };
        let response = SignCheckConfig { gyro: true, motor: Some(SteerModel::default()) };
        let permit = EngagementConfig {
            self_test_ticks: 200,
            ramp_in_ticks: 500,
            ramp_out_ticks: 200,
            press: PressConfig::product(),
            need_polarity: true,
            fallen_rad: Some(1.05),
            roll_unknown_rad: Some(0.5),
            crash_m_s2: Some(60.0),
            parked_m_s: Some(0.3),
            backwards_m_s: Some(0.3),
            lifted_m_s2: Some(3.0),
            persist_ticks: 100,
        };
        let estimate = EstimateConfig { roll_rate: Source::Estimate, ..EstimateConfig::default() };
        // Removes vibration at hardly any extra delay: `docs/delay.md`.
        let predict = PredictConfig { lead_s: 0.012, ..PredictConfig::default() };
        let smooth = SmoothConfig { interpolate: true, lag_s: 0.022, most_rad_s: Some(0.08) };
        let limits = Limits::product();
        Self {
            input,
            estimate,
            cross,
            response,
            permit,
            predict,
            smooth,
            limits,
            ..Self::thesis(Law::H { cut: true })
        }
    }

    /// Visits every parameter except the law's.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("", "rate_hz", 100.0, 10_000.0), &mut self.rate_hz);
        self.dead_band.visit_params(to);
        self.capsize.visit_params(to);
        self.calibration.visit_params(to);
        self.input.visit_params(to);
        self.estimate.visit_params(to);
        self.cross.visit_params(to);
        self.response.visit_params(to);
        self.permit.visit_params(to);
        self.latency.visit_params(to);
        self.predict.visit_params(to);
        self.smooth.visit_params(to);
        optional(to, &ParamSpec::switch("", "track"), &mut self.track, PathTracking::visit_params);
        self.limits.visit_params(to);
    }
}
