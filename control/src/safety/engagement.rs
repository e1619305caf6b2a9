//! Decides whether torque is permitted, which fraction of it, and for which causes it is not.
//!
//! Permission is off at boot, requires a deliberate press of the rider's switch ([`crate::safety::press`]), and is
//! withdrawn by any listed cause. A rejected press is consumed. All present causes are reported at once.

use crate::estimate::RollError;
use crate::fault::{Cause, Causes};
use crate::param::{ParamSpec, ParamVisitor};
use crate::safety::press::{Press, PressConfig, PressState};
use crate::sensors::monitor::Loss;
use crate::sensors::validation::ValidationConfig;
use core::hint::cold_path;

crate::numbered! {
    /// Mode of the controller. The discriminant is its number on the wire.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
    #[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
    pub enum Mode {
        /// Before the first step.
        #[default]
        Off = 0,
        /// Waiting for the sensors' first good samples.
        Initialise = 1,
        /// All sensors must stay valid for the self-test time.
        SelfTest = 2,
        /// Ready; waiting for the rider's switch.
        Standby = 3,
        /// Engaged: torque is permitted.
        Engaged = 4,
        /// Reduced torque is permitted, because a dispensable sensor is lost or sensors disagree.
        Limp = 5,
        /// No torque until the causes are gone and the switch has been released; initialisation and self-test then repeat.
        Fault = 6,
    }
}

impl Mode {
    /// Name of the mode.
    pub const fn name(self) -> &'static str {
        match self {
            Mode::Off => "off",
            Mode::Initialise => "initialise",
            Mode::SelfTest => "self-test",
            Mode::Standby => "standby",
            Mode::Engaged => "engaged",
            Mode::Limp => "limp",
            Mode::Fault => "fault",
        }
    }

    /// Whether the mode permits torque.
    pub const fn drives(self) -> bool {
        matches!(self, Mode::Engaged | Mode::Limp)
    }
}

/// Conditions of engagement. The default has none: no self-test, no ramps, no polarity check.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngagementConfig {
    /// Time for which all sensors must be valid before standby \[control periods\].
    pub self_test_ticks: u16,
    /// Ramp of the authority from 0 to 1, after engagement or a pause \[control periods\].
    pub ramp_in_ticks: u16,
    /// Ramp of the authority from 1 to 0, at disengagement or in a pause \[control periods\].
    pub ramp_out_ticks: u16,
    /// Durations of a deliberate press of the rider's switch.
    pub press: PressConfig,
    /// Whether engagement requires a passed polarity check.
    pub need_polarity: bool,
    /// Roll angle, either way and less its error bound, beyond which the bicycle has fallen \[rad\].
    pub fallen_rad: Option<f32>,
    /// Error bound of the roll angle beyond which a fall cannot be detected \[rad\]; it is only reported.
    pub roll_unknown_rad: Option<f32>,
    /// Specific force that, together with a fast roll or steer rate, means that the bicycle tumbles \[m/s^2\].
    pub crash_m_s2: Option<f32>,
    /// Speed below which the bicycle is parked \[m/s\]; torque pauses.
    pub parked_m_s: Option<f32>,
    /// Backward speed above which torque pauses \[m/s\].
    pub backwards_m_s: Option<f32>,
    /// Specific force below which the bicycle is in the air \[m/s^2\].
    pub lifted_m_s2: Option<f32>,
    /// Persistence of fallen, lifted, backwards and parked, before they are set or cleared \[control periods\].
    pub persist_ticks: u16,
}

impl EngagementConfig {
    /// Whether a condition needs the estimated roll angle.
    pub fn needs_motion(&self) -> bool {
        self.fallen_rad.is_some() || self.roll_unknown_rad.is_some()
    }

    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let g = "permit";
        to.count(&ParamSpec::new(g, "self_test_ticks", 0.0, 10_000.0), &mut self.self_test_ticks);
        to.count(&ParamSpec::new(g, "ramp_in_ticks", 0.0, 20_000.0), &mut self.ramp_in_ticks);
        to.count(&ParamSpec::new(g, "ramp_out_ticks", 0.0, 20_000.0), &mut self.ramp_out_ticks);
        self.press.visit_params(g, to);
        to.switch(&ParamSpec::switch(g, "need_polarity"), &mut self.need_polarity);
        to.optional_number(&ParamSpec::new(g, "fallen_rad", 0.3, 3.2), &mut self.fallen_rad);
        to.optional_number(&ParamSpec::new(g, "roll_unknown_rad", 0.05, 3.2), &mut self.roll_unknown_rad);
        to.optional_number(&ParamSpec::new(g, "crash_m_s2", 20.0, 1000.0), &mut self.crash_m_s2);
        to.optional_number(&ParamSpec::new(g, "parked_m_s", 0.01, 3.0), &mut self.parked_m_s);
        to.optional_number(&ParamSpec::new(g, "backwards_m_s", 0.01, 3.0), &mut self.backwards_m_s);
        to.optional_number(&ParamSpec::new(g, "lifted_m_s2", 0.1, 9.0), &mut self.lifted_m_s2);
        to.count(&ParamSpec::new(g, "persist_ticks", 0.0, 1000.0), &mut self.persist_ticks);
    }
}

/// Time after the force of a crash in which its rate can follow \[s\].
const CRASH_S: f32 = 0.1;
/// Roll rate and steer rate of a tumble \[rad/s\]: above those of calm riding; hard riding reaches them without the
/// force.
const CRASH_RAD_S: [f32; 2] = [2.0, 8.0];

/// Reaction to each cause: by the sensors' declarations, fixed for the other causes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reactions {
    /// Fault: no torque; initialisation and self-test repeat.
    pub fault: Causes,
    /// Standby: a new press is needed.
    pub disengage: Causes,
    /// Pause: no torque while the cause is present.
    pub pause: Causes,
    /// Limp mode: reduced torque while the cause is present.
    pub limp: Causes,
    /// Limp causes that stay set until the rider engages again, because the faulty sensor is unknown.
    pub until_reengaged: Causes,
}

/// Constants derived from the conditions; a condition that is off has an unreachable threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngagementPlan {
    fallen_rad: f32,
    roll_unknown_rad: f32,
    crash_m_s2: f32,
    /// Time for which a crash force counts \[control periods\].
    crash_ticks: u16,
    parked_m_s: f32,
    backwards_m_s: f32,
    lifted_m_s2: f32,
}

impl EngagementPlan {
    /// For validated conditions.
    pub fn new(config: &EngagementConfig, rate_hz: f32) -> Self {
        Self {
            fallen_rad: config.fallen_rad.unwrap_or(f32::INFINITY),
            roll_unknown_rad: config.roll_unknown_rad.unwrap_or(f32::INFINITY),
            crash_m_s2: config.crash_m_s2.unwrap_or(f32::INFINITY),
            crash_ticks: (CRASH_S * rate_hz) as u16,
            parked_m_s: config.parked_m_s.unwrap_or(0.0),
            backwards_m_s: config.backwards_m_s.unwrap_or(f32::INFINITY),
            lifted_m_s2: config.lifted_m_s2.unwrap_or(0.0),
        }
    }
}

impl Reactions {
    /// The reactions for these declarations.
    pub fn new(input: &ValidationConfig) -> Self {
        use Cause::*;
        let fault = Causes::all(&[
            GyroDisagrees,
            // The gyro is possibly at fault, and without it no other check is reliable.
            YawDisagrees,
            MotorDisagrees,
            WrongResponse,
            GuardNotFinite,
            GuardPermission,
            GuardTorque,
            GuardRate,
            GuardWindow,
            GuardOverride,
            GuardEndStop,
            Timing,
            Crash,
        ]);
        let limp = Causes::all(&[WheelsDisagree, SteerDisagrees]);
        Self {
            fault: fault.with(input.causes_of(Loss::Fault)),
            disengage: Causes::all(&[Fallen, Lifted, PolarityUnchecked, PolarityWrong, SwitchOff]),
            pause: Causes::all(&[Backwards, Parked]),
            limp: limp.with(input.causes_of(Loss::Limp)),
            until_reengaged: limp,
        }
    }

    /// Causes that reject a press of the switch in standby.
    pub fn rejections(&self) -> Causes {
        self.disengage.with(self.pause)
    }
}

/// State of the engagement logic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct EngagementState {
    mode: Mode,
    /// Control periods in this mode.
    ticks: u16,
    switch: PressState,
    authority: f32,
    /// Causes of the fault since it began.
    latched: Causes,
    /// Disagreements since the rider engaged.
    disagreements: Causes,
    position: Debounced,
    /// Remaining time for which the last crash force counts \[control periods\].
    crash_force_ticks: u16,
}

/// Permission in one control period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngagementOutput {
    /// Mode of the controller.
    pub mode: Mode,
    /// Permitted fraction of the torque, 0 to 1.
    pub authority: f32,
    /// Every present cause; in a fault also those of [`Reactions::fault`] since it began.
    pub causes: Causes,
}

/// Inputs of the engagement logic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngagementInput {
    /// Causes of the sensors, and of the guard in the previous period.
    pub causes: Causes,
    /// The rider's switch.
    pub engage: bool,
    /// Whether a polarity check was passed.
    pub polarity_checked: bool,
    /// Roll angle \[rad\] and its error, if estimated.
    pub roll_rad: Option<(f32, RollError)>,
    /// Roll rate and steer rate, 0 where unknown \[rad/s\].
    pub rates_rad_s: [f32; 2],
    /// Forward speed \[m/s\], if known.
    pub speed_m_s: Option<f32>,
    /// Magnitude of the specific force \[m/s^2\], if known.
    pub force_m_s2: Option<f32>,
}

/// Debounced causes of the bicycle's position and motion: set after more than `persist_ticks` periods of presence,
/// cleared after as many of absence.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
struct Debounced {
    active: Causes,
    /// Time for which each cause has differed from its debounced state \[control periods\].
    ticks: [u16; 4],
}

impl Debounced {
    fn step(&mut self, present: Causes, persist_ticks: u16) -> Causes {
        // The common case.
        if present == self.active && self.ticks == [0; 4] {
            return present;
        }
        cold_path();
        let causes = [Cause::Fallen, Cause::Lifted, Cause::Backwards, Cause::Parked];
        for (cause, ticks) in causes.into_iter().zip(&mut self.ticks) {
            *ticks = if present.has(cause) == self.active.has(cause) { 0 } else { ticks.saturating_add(1) };
            if *ticks > persist_ticks {
                (self.active, *ticks) = (self.active.toggled(cause), 0);
            }
        }
        self.active
    }
}

/// One control period.
pub fn step(
    config: &EngagementConfig,
    plan: &EngagementPlan,
    reactions: &Reactions,
    state: &mut EngagementState,
    input: &EngagementInput,
) -> EngagementOutput {
    let press = state.switch.step(&config.press, input.engage);
    let causes = state.causes(config, plan, input, press).with(state.disagreements);
    state.disagreements =
        if state.mode.drives() { causes.and(reactions.until_reengaged) } else { Causes::NONE };
    let mode = state.next(config, reactions, press, causes);
    if press.is_closed() && (mode != Mode::Standby || causes.any(reactions.rejections())) {
        state.switch.consume();
    }
    if mode != state.mode {
        (state.mode, state.ticks) = (mode, 0);
    } else {
        state.ticks = state.ticks.saturating_add(1);
    }
    let paused = causes.any(reactions.pause);
    state.authority = if mode == Mode::Fault {
        0.0
    } else if mode.drives() && !paused {
        ramp_step(state.authority, 1.0, config.ramp_in_ticks)
    } else {
        ramp_step(state.authority, 0.0, config.ramp_out_ticks)
    };
    let causes = if mode == Mode::Fault { causes.with(state.latched) } else { causes };
    EngagementOutput { mode, authority: state.authority, causes }
}

impl EngagementState {
    /// Permitted fraction of the torque, 0 to 1.
    pub fn authority(&self) -> f32 {
        self.authority
    }

    /// All causes present in this period.
    fn causes(
        &mut self,
        config: &EngagementConfig,
        plan: &EngagementPlan,
        input: &EngagementInput,
        press: Press,
    ) -> Causes {
        let mut present = Causes::NONE;
        let mut motion_causes = Causes::NONE;
        if let Some((roll, error)) = input.roll_rad {
            // The error bound is computed only where it is needed.
            let fallen = roll.abs() > plan.fallen_rad && roll.abs() - error.bound_rad() > plan.fallen_rad;
            present.note(Cause::Fallen, fallen);
            motion_causes.note(Cause::RollUnknown, error.is_beyond(plan.roll_unknown_rad));
        }
        if let Some(force) = input.force_m_s2 {
            present.note(Cause::Lifted, force < plan.lifted_m_s2);
            motion_causes.note(Cause::Crash, self.detect_crash(plan, force, input.rates_rad_s));
        }
        if let Some(speed) = input.speed_m_s {
            present.note(Cause::Backwards, -speed > plan.backwards_m_s);
            present.note(Cause::Parked, speed.abs() < plan.parked_m_s);
        }
        let mut causes =
            input.causes.with(motion_causes).with(self.position.step(present, config.persist_ticks));
        causes.note(Cause::PolarityUnchecked, config.need_polarity && !input.polarity_checked);
        causes.note(Cause::SwitchOff, !input.engage);
        causes.note(Cause::SwitchHeld, matches!(press, Press::Held | Press::Opened) && !self.mode.drives());
        let testing = matches!(self.mode, Mode::Off | Mode::Initialise | Mode::SelfTest);
        causes.note(Cause::SelfTest, testing);
        causes
    }

    /// Whether the bicycle tumbles: a crash force, and with it or within [`CRASH_S`] after it a crash rate.
    fn detect_crash(&mut self, plan: &EngagementPlan, force_m_s2: f32, [roll, steer]: [f32; 2]) -> bool {
        if force_m_s2 > plan.crash_m_s2 {
            self.crash_force_ticks = plan.crash_ticks;
        }
        // The common case.
        if self.crash_force_ticks == 0 {
            return false;
        }
        cold_path();
        self.crash_force_ticks -= 1;
        roll.abs() > CRASH_RAD_S[0] || steer.abs() > CRASH_RAD_S[1]
    }

    /// The next mode.
    fn next(
        &mut self,
        config: &EngagementConfig,
        reactions: &Reactions,
        press: Press,
        causes: Causes,
    ) -> Mode {
        // At boot the sensors have no samples yet, which is not a fault.
        let faults = causes.and(reactions.fault);
        let started = !matches!(self.mode, Mode::Off | Mode::Initialise);
        if started && !faults.is_empty() {
            self.latched = if self.mode == Mode::Fault { self.latched.with(faults) } else { faults };
            return Mode::Fault;
        }
        match self.mode {
            Mode::Off => Mode::Initialise,
            Mode::Initialise if faults.is_empty() => Mode::SelfTest,
            Mode::SelfTest if self.ticks >= config.self_test_ticks => Mode::Standby,
            Mode::Standby if press == Press::Pressed && !causes.any(reactions.rejections()) => {
                engaged_mode(reactions, causes)
            }
            Mode::Engaged | Mode::Limp if causes.any(reactions.disengage) => Mode::Standby,
            Mode::Engaged | Mode::Limp => engaged_mode(reactions, causes),
            Mode::Fault if press == Press::Released => Mode::Initialise,
            mode => mode,
        }
    }
}

/// The engaged mode under these causes: limp or full.
fn engaged_mode(reactions: &Reactions, causes: Causes) -> Mode {
    if causes.any(reactions.limp) { Mode::Limp } else { Mode::Engaged }
}

/// One step of a ramp that takes `ticks` periods from 0 to 1; 0 ticks is a jump.
fn ramp_step(from: f32, to: f32, ticks: u16) -> f32 {
    if from == to {
        return to;
    }
    let step = 1.0 / f32::from(ticks.max(1));
    // Snaps to the target, so that rounding leaves no residue.
    if (to - from).abs() < 1.5 * step {
        to
    } else if from < to {
        from + step
    } else {
        from - step
    }
}
