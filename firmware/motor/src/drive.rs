//! One call of the motor interrupt: from measurements and command to duty cycles.

use crate::align::{self, Align, AlignState};
use crate::angle::Angle;
use crate::config::{DELAY_TICKS, Plan};
use crate::current::{self, CurrentState};
use crate::current_offset::{self, CurrentOffsetState};
use crate::encoder::{self, EncoderReading, EncoderState};
use crate::fault::{Fault, Faults};
use crate::modulate;
use crate::protect::overload::OverloadState;
use crate::protect::sensors::Phases;
use crate::protect::stall::StallState;
use crate::protect::supply::SupplyState;
use crate::protect::{angle, back_emf, current_tracking, overload, sensors, stall, supply, temperature};
use crate::torque_limit;
use crate::transform::{Vector, clarke, park, stator};
use core::f32::consts::TAU;

/// Command to the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MotorCommand {
    /// Bridge open.
    #[default]
    Off,
    /// Find the encoder's offset, once per request. The motor first moves by at most half an electrical turn, then a
    /// quarter turn forward and back.
    Align,
    /// Torque on the steer axis, positive to the right \[N m\].
    Torque(f32),
}

/// Measurements, sampled in the middle of a PWM period, and the command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Phase currents.
    pub phases: Phases,
    /// Bus voltage \[V\].
    pub bus_v: f32,
    /// Newest encoder counts.
    pub angle_counts: u16,
    /// Age of the counts \[calls\]; `control::sensors::frame::MISSING` for none.
    pub angle_age_calls: u16,
    /// Highest measured temperature \[deg C\].
    pub temperature_c: f32,
    /// Command.
    pub command: MotorCommand,
}

/// Mode of the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Mode {
    /// Bridge open; the current sensors' offsets are being measured.
    #[default]
    Zeroing = 0,
    /// Bridge open; the encoder's offset is unknown, no torque is possible.
    Unaligned = 1,
    /// Bridge open; torque follows on request.
    Ready = 2,
    /// Alignment is running.
    Aligning = 3,
    /// Torque is applied.
    Running = 4,
    /// Bridge open after a fault. Only a new [`State`] leaves this mode.
    Off = 5,
}

/// State of the motor loop. `State::default()` is that of a start: no offsets, no faults.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    faults: Faults,
    /// Mode of the previous call.
    mode: Mode,
    zero: CurrentOffsetState,
    encoder: EncoderState,
    overload: OverloadState,
    stall: StallState,
    /// Offset found by alignment.
    offset: Option<Angle>,
    /// Whether the requested alignment has completed.
    aligned: bool,
    drive: Drive,
}

/// State that is reset when the mode changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Drive {
    align: AlignState,
    current: CurrentState,
    torque_nm: f32,
    voltage: Vector,
    sum_beyond: u16,
    supply: SupplyState,
    follow: current_tracking::CurrentTrackingState,
    emf_v: f32,
    angle: angle::AngleState,
}

/// Output of one call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output {
    /// Duty cycles of the upper switches of a, b and c; `None`: all six switches open.
    pub duties: Option<[f32; 3]>,
    /// Mode of the motor.
    pub mode: Mode,
    /// All faults since the start.
    pub faults: Faults,
    /// Torque on the steer axis from the measured current, positive to the right \[N m\].
    pub torque_nm: f32,
    /// Measured d current \[A\].
    pub id_a: f32,
    /// Measured q current \[A\].
    pub iq_a: f32,
    /// Set-point of the q current \[A\].
    pub iq_wanted_a: f32,
    /// Current limit due to temperature, overload, supply, stall and an unconfirmed angle \[A\].
    pub limit_a: f32,
    /// Whether a stall limits the current to the holding current.
    pub stalled: bool,
    /// Steer rate from the encoder, positive to the right \[rad/s\].
    pub steer_rate_rad_s: f32,
    /// Encoder offset in use, to be stored as `encoder.offset_turns`.
    pub offset_turns: Option<f32>,
    /// Whether the requested alignment has found the offset; cleared by another command.
    pub aligned: bool,
}

/// One call, once per PWM period. The duty cycles apply to the whole next period; an open bridge must be opened at
/// once.
///
/// For all inputs, the duty cycles are inside the bridge's limits, and a fault opens the bridge in the call that
/// detects it.
pub fn step(plan: &Plan, state: &mut State, inputs: &Inputs) -> Output {
    let reading =
        encoder::step(&plan.encoder, &mut state.encoder, inputs.angle_counts, inputs.angle_age_calls);
    let raw = inputs.phases.all();
    let offset = state.offset.or(plan.config.encoder.offset_turns.map(Angle::of));
    let mode = match (state.zero.zeros_a(), inputs.command, offset) {
        _ if !state.faults.is_empty() => Mode::Off,
        (None, ..) => {
            state.faults.take(current_offset::step(&plan.config.zero, &mut state.zero, raw));
            if state.faults.is_empty() { Mode::Zeroing } else { Mode::Off }
        }
        (_, MotorCommand::Align, _) if !state.aligned => Mode::Aligning,
        (_, MotorCommand::Torque(_), Some(_)) => Mode::Running,
        (_, _, Some(_)) => Mode::Ready,
        (_, _, None) => Mode::Unaligned,
    };
    state.aligned &= inputs.command == MotorCommand::Align;
    if mode != state.mode {
        (state.mode, state.drive) = (mode, Drive::default());
    }
    let closed = matches!(mode, Mode::Aligning | Mode::Running);
    let zeros = state.zero.zeros_a().unwrap_or_default();
    let offset = offset.unwrap_or_default();
    let mut out = if closed {
        close(plan, state, inputs, mode, &reading, core::array::from_fn(|i| raw[i] - zeros[i]), offset)
    } else {
        overload::step(&plan.config.overload, &mut state.overload, plan.period_s, 0.0, 0.0);
        stall::step(&plan.config.stall, &mut state.stall, plan.period_s, 0.0, reading.speed_turns_s, 0.0);
        Output { mode, ..Output::default() }
    };
    if !state.faults.is_empty() {
        out = Output { mode: Mode::Off, ..Output::default() };
    }
    out.faults = state.faults;
    out.offset_turns = state.offset.map(Angle::signed).or(plan.config.encoder.offset_turns);
    out.aligned = state.aligned;
    let sign = if plan.config.motor.reversed { -TAU } else { TAU };
    out.steer_rate_rad_s = sign * reading.speed_turns_s / plan.config.motor.ratio;
    out
}

/// Angle and speed of the field in this call, and the current set-point.
struct Field {
    angle: Angle,
    omega_rad_s: f32,
    wanted: Vector,
}

/// A call with the bridge active. Faults are added to the state; the output is then invalid.
fn close(
    plan: &Plan,
    state: &mut State,
    inputs: &Inputs,
    mode: Mode,
    reading: &EncoderReading,
    phases_a: [f32; 3],
    offset: Angle,
) -> Output {
    let c = &plan.config;
    let mut faults = sensors::step(&c.sensors, &mut state.drive.sum_beyond, phases_a);
    let (supply_share, low) = supply::step(&c.supply, &mut state.drive.supply, inputs.bus_v);
    let (temperature_share, hot) = temperature::check(&c.temperature, inputs.temperature_c);
    faults.take(low);
    faults.take(hot);
    faults = faults.with(reading.faults);
    faults.note(Fault::Command, matches!(inputs.command, MotorCommand::Torque(nm) if !nm.is_finite()));
    if !faults.is_empty() {
        state.faults = faults;
        return Output::default();
    }
    let most = c.current.max_a * supply_share.min(temperature_share);
    let measured = clarke(phases_a);
    let (limit, overload) =
        overload::step(&c.overload, &mut state.overload, plan.period_s, measured.square(), most);
    state.faults.take(overload);
    let (field, limit_a) = match mode {
        Mode::Aligning => (aligning(plan, state, reading, limit), limit),
        _ => running(plan, state, inputs.command, reading, offset, limit),
    };
    let Some(Field { angle, omega_rad_s, wanted }) = field else {
        return Output { mode: Mode::Ready, ..Output::default() };
    };
    let wanted = wanted.inside(limit_a);

    let measured = park(measured, angle.sin_cos());
    // During alignment the rotor oscillates about the field; without voltage along q its own back-EMF damps it.
    let wanted = if mode == Mode::Aligning { Vector::new(wanted.d, measured.q) } else { wanted };
    let max_v = inputs.bus_v * plan.max_voltage_ratio;
    let reachable = plan.gains.steady(wanted, omega_rad_s).square() < (0.9 * max_v) * (0.9 * max_v);
    let error_a = wanted.minus(measured).length();
    let drive = &mut state.drive;
    state.faults.take(current_tracking::step(&c.follow, &mut drive.follow, error_a, phases_a, reachable));
    if mode == Mode::Running {
        let unexplained = drive.voltage.minus(plan.gains.steady(measured, omega_rad_s));
        let resistive_v = c.motor.resistance_ohm * measured.length();
        let dead_v = plan.dead_duty * inputs.bus_v;
        state.faults.take(back_emf::step(&c.emf, &mut drive.emf_v, unexplained, resistive_v, dead_v));
        let voltages = angle::Voltages {
            unexplained,
            magnets: omega_rad_s * c.motor.flux_wb,
            resistive: resistive_v,
            dead: dead_v,
        };
        state.faults.take(angle::step(&c.angle, &mut drive.angle, &voltages));
    }
    drive.voltage = current::step(&plan.gains, &mut drive.current, wanted, measured, omega_rad_s, max_v);

    let ahead = Angle::of(omega_rad_s / TAU * DELAY_TICKS * plan.period_s);
    let then = angle.plus(ahead).sin_cos();
    let (voltage, current) = (stator(drive.voltage, then), stator(wanted, then));
    Output {
        duties: Some(modulate::duties(&c.bridge, plan.dead_duty, voltage, current, inputs.bus_v)),
        mode,
        torque_nm: plan.torque_nm_a * measured.q,
        id_a: measured.d,
        iq_a: measured.q,
        iq_wanted_a: if mode == Mode::Aligning { 0.0 } else { wanted.q },
        limit_a,
        stalled: mode == Mode::Running && state.stall.stalled,
        ..Output::default()
    }
}

/// Field of the alignment; `None` when it has ended.
fn aligning(plan: &Plan, state: &mut State, reading: &EncoderReading, limit_a: f32) -> Option<Field> {
    let electrical = reading.angle.times(plan.config.motor.pole_pairs);
    match align::step(&plan.config.align, &mut state.drive.align, electrical) {
        Align::Field(angle, d) => {
            Some(Field { angle, omega_rad_s: 0.0, wanted: Vector::new(d.min(limit_a), 0.0) })
        }
        Align::Found(offset) => {
            (state.offset, state.aligned) = (Some(offset), true);
            None
        }
        Align::Failed(fault) => {
            state.faults.take(Some(fault));
            None
        }
    }
}

/// Rotor-fixed field that produces the requested torque, within the current limit `limit_a` and that of a stall.
fn running(
    plan: &Plan,
    state: &mut State,
    command: MotorCommand,
    reading: &EncoderReading,
    offset: Angle,
    limit_a: f32,
) -> (Option<Field>, f32) {
    let c = &plan.config;
    let requested_nm = if let MotorCommand::Torque(nm) = command { nm } else { 0.0 };
    let speed = reading.speed_turns_s;
    let requested_a = requested_nm / plan.torque_nm_a;
    let limit_a = stall::step(&c.stall, &mut state.stall, plan.period_s, requested_a, speed, limit_a);
    let limit_a =
        if state.drive.angle.is_proved() { limit_a } else { limit_a.min(plan.unverified_angle_limit_a) };
    let torque = &mut state.drive.torque_nm;
    *torque = torque_limit::step(&c.demand, plan.period_s, *torque, requested_nm, limit_a, plan.torque_nm_a);
    let field = Field {
        angle: reading.angle.times(c.motor.pole_pairs).minus(offset),
        omega_rad_s: TAU * f32::from(c.motor.pole_pairs) * speed,
        wanted: Vector::new(0.0, *torque / plan.torque_nm_a),
    };
    (Some(field), limit_a)
}
