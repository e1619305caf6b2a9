//! May torque flow, how much of it, and if not, why not.
//!
//! Permission is off at boot, given only on a deliberate press of the rider's switch ([`crate::safety::press`]), and taken away
//! by any listed cause. A press that is refused is used up. All causes present are told at once.

use crate::estimate::RollError;
use crate::fault::{Cause, Causes};
use crate::param::{ParamSpec, ParamVisitor};
use crate::safety::press::{Press, PressConfig, PressState};
use crate::sensors::monitor::Loss;
use crate::sensors::validation::ValidationConfig;
use core::hint::cold_path;

/// Where the controller stands. The number is the one on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Mode {
    /// Not stepped yet.
    #[default]
    Off = 0,
    /// Waits for the sensors' first good samples.
    Initialise = 1,
    /// All sensors must stay good for a while.
    SelfTest = 2,
    /// Ready; waits for the rider's switch.
    Standby = 3,
    /// Torque flows.
    Engaged = 4,
    /// Reduced torque flows, because something is missing that can be done without.
    Limp = 5,
    /// No torque until the causes are gone, the switch was released, and all begins anew.
    Fault = 6,
}

impl Mode {
    /// Its name.
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

    /// Whether torque may flow.
    pub const fn drives(self) -> bool {
        matches!(self, Mode::Engaged | Mode::Limp)
    }
}

/// Conditions of the permission. The default lets everything pass: no self-test, no ramps, no polarity check.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngagementConfig {
    /// How long all sensors must be good before standby \[control periods\].
    pub self_test_ticks: u16,
    /// From no to full authority after the switch, or after a pause \[control periods\].
    pub ramp_in_ticks: u16,
    /// From full to no authority when the switch is released, or in a pause \[control periods\].
    pub ramp_out_ticks: u16,
    /// Which press of the rider's switch is deliberate.
    pub press: PressConfig,
    /// Refuse to engage until a polarity check was passed.
    pub need_polarity: bool,
    /// Roll angle, either way, beyond which the bicycle has fallen, as far as the angle is sure \[rad\].
    pub fallen_rad: Option<f32>,
    /// Bound of the roll angle beyond which nobody can say whether the bicycle has fallen \[rad\]; only told.
    pub roll_unknown_rad: Option<f32>,
    /// Specific force beyond which, together with a fast roll or steer rate, the bicycle tumbles \[m/s^2\].
    pub crash_m_s2: Option<f32>,
    /// Speed below which the bicycle is parked \[m/s\]; torque pauses.
    pub parked_m_s: Option<f32>,
    /// Speed backwards beyond which torque pauses \[m/s\].
    pub backwards_m_s: Option<f32>,
    /// Specific force below which the bicycle is in the air \[m/s^2\].
    pub lifted_m_s2: Option<f32>,
    /// How long any of the four must last \[control periods\].
    pub persist_ticks: u16,
}

impl EngagementConfig {
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

/// For how long after the force of a crash its rate may come \[s\].
const CRASH_S: f32 = 0.1;
/// Roll rate and steer rate of a tumble \[rad/s\]: beyond those of calm riding; hard riding has them without the force.
const CRASH_RAD_S: [f32; 2] = [2.0, 8.0];

/// What each cause does, from the sensors' declarations and for the rest once and for all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reactions {
    /// Fault: no torque, and all begins anew.
    pub fault: Causes,
    /// Back to standby: a fresh press is needed.
    pub disengage: Causes,
    /// No torque while it lasts.
    pub pause: Causes,
    /// Reduced torque while it lasts.
    pub limp: Causes,
    /// Of these, what counts until the rider asks anew: who is wrong is not known.
    pub lasting: Causes,
}

/// What follows from the conditions alone: a condition that is off can't be met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngagementPlan {
    fallen_rad: f32,
    roll_unknown_rad: f32,
    crash_m_s2: f32,
    /// How long after it a force counts \[control periods\].
    crash_ticks: u16,
    parked_m_s: f32,
    backwards_m_s: f32,
    lifted_m_s2: f32,
}

impl EngagementPlan {
    /// Of checked conditions.
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
    /// The reactions under these declarations.
    pub fn new(input: &ValidationConfig) -> Self {
        use Cause::*;
        let fault = Causes::all(&[
            GyroDisagrees,
            // One of the suspects is the gyro, without which nothing is sure.
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
            lasting: limp,
        }
    }

    /// What refuses a press of the switch in standby.
    pub fn refusals(&self) -> Causes {
        self.disengage.with(self.pause)
    }
}

/// What the permission remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngagementState {
    mode: Mode,
    /// Control periods in this mode.
    ticks: u16,
    switch: PressState,
    authority: f32,
    /// Causes since the fault began.
    latched: Causes,
    /// Disagreements since the rider asked.
    lasting: Causes,
    position: Debounced,
    /// For how long the last force of a crash still counts \[control periods\].
    struck_ticks: u16,
}

/// The permission of one control period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngagementOutput {
    /// Where the controller stands.
    pub mode: Mode,
    /// The part of the torque that may flow, 0 to 1.
    pub authority: f32,
    /// Every cause that is present, and in a fault every one since it began.
    pub causes: Causes,
}

/// What the permission looks at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngagementInput {
    /// What is wrong with the inputs, and what the guard found in the last period.
    pub causes: Causes,
    /// The rider's switch.
    pub engage: bool,
    /// A polarity check was passed.
    pub polarity_checked: bool,
    /// Roll angle \[rad\] and by how much it may be wrong, if it is estimated.
    pub roll_rad: Option<(f32, RollError)>,
    /// Roll rate, and steer rate as far as known \[rad/s\].
    pub rates_rad_s: [f32; 2],
    /// Forward speed \[m/s\], if known.
    pub speed_m_s: Option<f32>,
    /// Size of the specific force \[m/s^2\], if known.
    pub force_m_s2: Option<f32>,
}

/// The causes of the bicycle's position and motion: each counts once it has lasted, and no longer when it has been
/// gone as long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Debounced {
    holds: Causes,
    /// For how long each has been other than it counts \[control periods\].
    ticks: [u16; 4],
}

impl Debounced {
    fn step(&mut self, now: Causes, persist_ticks: u16) -> Causes {
        // As nearly always.
        if now == self.holds && self.ticks == [0; 4] {
            return now;
        }
        cold_path();
        let causes = [Cause::Fallen, Cause::Lifted, Cause::Backwards, Cause::Parked];
        for (cause, ticks) in causes.into_iter().zip(&mut self.ticks) {
            *ticks = if now.has(cause) == self.holds.has(cause) { 0 } else { ticks.saturating_add(1) };
            if *ticks > persist_ticks {
                (self.holds, *ticks) = (self.holds.toggled(cause), 0);
            }
        }
        self.holds
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
    let causes = state.causes(config, plan, input, press).with(state.lasting);
    state.lasting = if state.mode.drives() { causes.and(reactions.lasting) } else { Causes::NONE };
    let mode = state.next(config, reactions, press, causes);
    if press.is_closed() && (mode != Mode::Standby || causes.any(reactions.refusals())) {
        state.switch.spend();
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
        towards(state.authority, 1.0, config.ramp_in_ticks)
    } else {
        towards(state.authority, 0.0, config.ramp_out_ticks)
    };
    let causes = if mode == Mode::Fault { causes.with(state.latched) } else { causes };
    EngagementOutput { mode, authority: state.authority, causes }
}

impl EngagementState {
    /// The part of the torque that is permitted, 0 to 1.
    pub fn authority(&self) -> f32 {
        self.authority
    }

    /// Everything that stands in the way now.
    fn causes(
        &mut self,
        config: &EngagementConfig,
        plan: &EngagementPlan,
        input: &EngagementInput,
        press: Press,
    ) -> Causes {
        let mut now = Causes::NONE;
        let mut motion_causes = Causes::NONE;
        if let Some((roll, error)) = input.roll_rad {
            // The bound only where it matters.
            let lies = roll.abs() > plan.fallen_rad && roll.abs() - error.bound_rad() > plan.fallen_rad;
            now.note(Cause::Fallen, lies);
            motion_causes.note(Cause::RollUnknown, error.is_beyond(plan.roll_unknown_rad));
        }
        if let Some(force) = input.force_m_s2 {
            now.note(Cause::Lifted, force < plan.lifted_m_s2);
            motion_causes.note(Cause::Crash, self.crashes(plan, force, input.rates_rad_s));
        }
        if let Some(speed) = input.speed_m_s {
            now.note(Cause::Backwards, -speed > plan.backwards_m_s);
            now.note(Cause::Parked, speed.abs() < plan.parked_m_s);
        }
        let mut causes = input.causes.with(motion_causes).with(self.position.step(now, config.persist_ticks));
        causes.note(Cause::PolarityUnchecked, config.need_polarity && !input.polarity_checked);
        causes.note(Cause::SwitchOff, !input.engage);
        causes.note(Cause::SwitchHeld, matches!(press, Press::Held | Press::Opened) && !self.mode.drives());
        let testing = matches!(self.mode, Mode::Off | Mode::Initialise | Mode::SelfTest);
        causes.note(Cause::SelfTest, testing);
        causes
    }

    /// Whether a force of no ride came, and with it or within a tenth of a second after it a rate of no calm one.
    fn crashes(&mut self, plan: &EngagementPlan, force_m_s2: f32, [roll, steer]: [f32; 2]) -> bool {
        if force_m_s2 > plan.crash_m_s2 {
            self.struck_ticks = plan.crash_ticks;
        }
        // As nearly always.
        if self.struck_ticks == 0 {
            return false;
        }
        cold_path();
        self.struck_ticks -= 1;
        roll.abs() > CRASH_RAD_S[0] || steer.abs() > CRASH_RAD_S[1]
    }

    /// The mode that follows.
    fn next(
        &mut self,
        config: &EngagementConfig,
        reactions: &Reactions,
        press: Press,
        causes: Causes,
    ) -> Mode {
        // At boot sensors are expected to be missing; that is no fault yet.
        let broken = causes.and(reactions.fault);
        let started = !matches!(self.mode, Mode::Off | Mode::Initialise);
        if started && !broken.is_empty() {
            self.latched = if self.mode == Mode::Fault { self.latched.with(broken) } else { broken };
            return Mode::Fault;
        }
        match self.mode {
            Mode::Off => Mode::Initialise,
            Mode::Initialise if broken.is_empty() => Mode::SelfTest,
            Mode::SelfTest if self.ticks >= config.self_test_ticks => Mode::Standby,
            Mode::Standby if press == Press::Pressed && !causes.any(reactions.refusals()) => {
                engaged(reactions, causes)
            }
            Mode::Engaged | Mode::Limp if causes.any(reactions.disengage) => Mode::Standby,
            Mode::Engaged | Mode::Limp => engaged(reactions, causes),
            Mode::Fault if press == Press::Released => Mode::Initialise,
            same => same,
        }
    }
}

/// The mode in which torque flows under these causes.
fn engaged(reactions: &Reactions, causes: Causes) -> Mode {
    if causes.any(reactions.limp) { Mode::Limp } else { Mode::Engaged }
}

/// A step of a ramp that takes `ticks` from 0 to 1; none is at once.
fn towards(from: f32, to: f32, ticks: u16) -> f32 {
    if from == to {
        return to;
    }
    let step = 1.0 / f32::from(ticks.max(1));
    // So that rounding does not leave it a hair from where it goes.
    if (to - from).abs() < 1.5 * step {
        to
    } else if from < to {
        from + step
    } else {
        from - step
    }
}
