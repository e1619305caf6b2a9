//! What follows from a configuration alone, computed once before the first step.

use crate::config::Config;
use crate::controller::Command;
use crate::estimate;
use crate::estimate::smooth::SmoothPlan;
use crate::fault::{Cause, Causes};
use crate::safety::engagement::{EngagementPlan, Mode, Reactions};
use crate::safety::guard::GuardPlan;
use crate::safety::limiter::LimiterPlan;
use crate::sensors::calibration::CalibrationPlan;
use crate::sensors::cross_check::CrossCheckPlan;
use crate::sensors::polarity;
use crate::sensors::sign_check::SignCheckPlan;
use crate::sensors::validation::ValidationPlan;

/// A checked [`Config`] with what is derived from it. Read-only while the controller runs.
///
/// In this order in memory, for the reason given at [`crate::State`]; the long configuration last.
#[derive(Clone, Debug, PartialEq)]
#[repr(C)]
pub struct Plan {
    pub(crate) period_s: f32,
    pub(crate) period_us: u32,
    /// Longest time between two steps \[us\]; infinite without a limit.
    pub(crate) max_gap_us: f32,
    pub(crate) calibration: CalibrationPlan,
    pub(crate) input: ValidationPlan,
    pub(crate) cross: CrossCheckPlan,
    pub(crate) response: SignCheckPlan,
    pub(crate) permit: EngagementPlan,
    pub(crate) smooth: SmoothPlan,
    pub(crate) reactions: Reactions,
    pub(crate) shape: LimiterPlan,
    pub(crate) guard: GuardPlan,
    /// The polarity check is still to be passed.
    pub(crate) check_polarity: bool,
    /// The law's gain that the polarity check shows.
    pub(crate) shown_gain_nm_s_rad: f32,
    /// Whether anything needs more of the motion than the gyro's x axis.
    pub(crate) estimates: bool,
    pub(crate) config: Config,
}

impl Plan {
    /// Of a configuration that was checked.
    pub(crate) fn new(config: Config) -> Self {
        let c = &config;
        let crosses = c.cross.wheels_m_s.is_some()
            || c.cross.yaw_rad_s.is_some()
            || c.cross.yaw_slow_rad_s.is_some()
            || c.cross.yaw_slope
            || c.cross.roll_correlation;
        Self {
            period_s: 1.0 / c.rate_hz,
            period_us: (1e6 / c.rate_hz) as u32,
            max_gap_us: c.input.max_gap_ms.map_or(f32::INFINITY, |ms| 1e3 * ms),
            calibration: c.calibration.plan(),
            input: ValidationPlan::new(&c.input, 1.0 / c.rate_hz),
            cross: CrossCheckPlan::new(&c.cross, &c.estimate.balance, c.rate_hz),
            response: SignCheckPlan::new(&c.response, &c.estimate, c.rate_hz),
            permit: EngagementPlan::new(&c.permit, c.rate_hz),
            smooth: SmoothPlan::new(&c.smooth, 1.0 / c.rate_hz),
            reactions: Reactions::new(&c.input),
            shape: LimiterPlan::new(&c.limits, c.rate_hz),
            guard: GuardPlan::new(&c.limits, c.rate_hz),
            check_polarity: c.permit.need_polarity && !c.calibration.polarity_checked,
            shown_gain_nm_s_rad: c.law.gain(polarity::SHOWN_AT_M_S),
            estimates: c.estimate.roll_rate == estimate::Source::Estimate
                || c.capsize.is_on()
                || c.permit.fallen_rad.is_some()
                || c.predict.lead_s > 0.0
                || c.track.is_some()
                || c.response.motor.is_some()
                || crosses,
            config,
        }
    }

    /// The configuration it was made from.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Whether a press of the switch that begins in the period after this command, or goes on in it, would engage, if
    /// nothing changes: in standby, and nothing is missing but the press.
    pub fn ready(&self, command: &Command) -> bool {
        let missing = self.reactions.refusals().with(Causes::of(Cause::SwitchHeld));
        let refusing = command.causes.and(missing);
        command.mode == Mode::Standby && (refusing.is_empty() || refusing == Causes::of(Cause::SwitchOff))
    }

    /// Control periods from boot to full authority, if every sensor is good from the start and the
    /// switch is pressed at once when it may be.
    pub fn ticks_to_engage(&self) -> u32 {
        let Config { input, permit, latency, .. } = &self.config;
        let tests = u32::from(permit.self_test_ticks) + u32::from(permit.persist_ticks);
        let waits = tests + u32::from(permit.press.release_ticks) + u32::from(permit.press.press_ticks);
        let ramp = u32::from(permit.ramp_in_ticks);
        let filling = u32::from(latency.roll_rate_ticks.max(latency.speed_ticks));
        8 + input.slowest_to_qualify() + waits + ramp + filling
    }
}
