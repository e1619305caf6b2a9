//! Constants derived from a configuration, computed once before the first step.

use crate::command::Command;
use crate::config::Config;
use crate::estimate::smooth::SmoothPlan;
use crate::fault::{Cause, Causes};
use crate::law::path_tracking::PathTracking;
use crate::param::{Checker, ParamError};
use crate::safety::engagement::{EngagementPlan, Mode, Reactions};
use crate::safety::guard::GuardPlan;
use crate::safety::limiter::LimiterPlan;
use crate::sensors::calibration::CalibrationPlan;
use crate::sensors::cross_check::CrossCheckPlan;
use crate::sensors::polarity;
use crate::sensors::sign_check::SignCheckPlan;
use crate::sensors::validation::ValidationPlan;

/// A validated [`Config`] and the constants derived from it. Read-only while the controller runs.
///
/// The field order in memory matters, for the reason given at [`crate::State`]; the long configuration last.
#[derive(Clone, Debug, PartialEq)]
#[repr(C)]
pub struct Plan {
    pub(crate) period_s: f32,
    pub(crate) period_us: u32,
    /// Longest time between two steps \[us\]; the largest number without a limit.
    pub(crate) max_gap_us: u32,
    pub(crate) calibration: CalibrationPlan,
    pub(crate) validation: ValidationPlan,
    pub(crate) cross_check: CrossCheckPlan,
    pub(crate) sign_check: SignCheckPlan,
    pub(crate) engagement: EngagementPlan,
    pub(crate) smooth: SmoothPlan,
    pub(crate) reactions: Reactions,
    pub(crate) limiter: LimiterPlan,
    pub(crate) guard: GuardPlan,
    /// Whether the polarity check must still be passed.
    pub(crate) polarity_check_due: bool,
    /// Gain of the law at [`polarity::GAIN_SPEED_M_S`], for the polarity check \[N m s/rad\].
    pub(crate) polarity_gain_nm_s_rad: f32,
    /// Whether any function needs the estimated motion; otherwise the sensors' values are used as they are.
    pub(crate) needs_estimate: bool,
    /// Number of short control periods in succession that are no fault; the largest number without a limit.
    pub(crate) most_short_periods: u16,
    pub(crate) config: Config,
}

impl Config {
    /// Validates every value and computes the plan for [`crate::step`].
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn plan(mut self) -> Result<Plan, ParamError> {
        let mut checker = Checker::default();
        self.visit_params(&mut checker);
        checker.note(self.law.validate());
        checker.note(self.limits.cross());
        checker.note(self.input.cross(self.rate_hz));
        checker.note(self.track.as_ref().map_or(Ok(()), PathTracking::cross));
        checker.verdict()?;
        Ok(Plan::new(self))
    }
}

impl Plan {
    /// Computes the plan of a validated configuration.
    fn new(config: Config) -> Self {
        let c = &config;
        // Rounded, as 1e3 times 0.502 is below 502.
        let max_gap_us = c.input.max_gap_ms.map_or(u32::MAX, |ms| (1e3 * ms + 0.5) as u32);
        Self {
            period_s: 1.0 / c.rate_hz,
            period_us: (1e6 / c.rate_hz) as u32,
            max_gap_us,
            most_short_periods: (max_gap_us as f32 / (1e6 / c.rate_hz)) as u16,
            calibration: c.calibration.plan(),
            validation: ValidationPlan::new(&c.input, 1.0 / c.rate_hz),
            cross_check: CrossCheckPlan::new(&c.cross, &c.estimate.balance, c.rate_hz),
            sign_check: SignCheckPlan::new(&c.response, &c.estimate, c.rate_hz),
            engagement: EngagementPlan::new(&c.permit, c.rate_hz),
            smooth: SmoothPlan::new(&c.smooth, 1.0 / c.rate_hz),
            reactions: Reactions::new(&c.input),
            limiter: LimiterPlan::new(&c.limits, c.rate_hz),
            guard: GuardPlan::new(&c.limits, c.rate_hz),
            polarity_check_due: c.permit.need_polarity && !c.calibration.polarity_checked,
            polarity_gain_nm_s_rad: c.law.gain(polarity::GAIN_SPEED_M_S),
            needs_estimate: needs_motion(c),
            config,
        }
    }

    /// The configuration that this plan was built from.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Whether a press of the switch that begins or continues in the period after `command` would engage if nothing
    /// else changes: the mode is standby and only the press is missing.
    pub fn ready(&self, command: &Command) -> bool {
        let rejections = self.reactions.rejections().with(Causes::of(Cause::SwitchHeld));
        let blocking = command.causes.and(rejections);
        command.mode == Mode::Standby && (blocking.is_empty() || blocking == Causes::of(Cause::SwitchOff))
    }

    /// Control periods from boot to full authority, if every sensor is valid from the start and the switch is pressed
    /// as soon as a press is accepted.
    pub fn ticks_to_engage(&self) -> u32 {
        let Config { input, permit, latency, .. } = &self.config;
        let tests = u32::from(permit.self_test_ticks) + u32::from(permit.persist_ticks);
        let waits = tests + u32::from(permit.press.release_ticks) + u32::from(permit.press.press_ticks);
        let ramp = u32::from(permit.ramp_in_ticks);
        let history = u32::from(latency.roll_rate_ticks.max(latency.speed_ticks));
        8 + input.slowest_to_qualify() + waits + ramp + history
    }
}

/// Whether any function needs the estimated motion. Every field is named, so a new field does not compile without a
/// decision.
fn needs_motion(config: &Config) -> bool {
    let Config {
        rate_hz: _,
        law: _,
        dead_band: _,
        capsize,
        calibration: _,
        input: _,
        estimate,
        cross,
        response,
        permit,
        latency: _,
        predict,
        smooth: _,
        track,
        limits: _,
    } = config;
    estimate.needs_motion()
        || capsize.is_on()
        || cross.needs_motion()
        || response.needs_motion()
        || permit.needs_motion()
        || predict.needs_motion()
        || track.is_some()
}
