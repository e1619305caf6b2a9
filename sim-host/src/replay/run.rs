//! Runs frames through the control step and summarises modes, causes, torque and checks.

use super::checks::{Check, Checks};
use super::compare::{Compared, Comparison, held};
use super::row::{Row, row};
use control::wire::{FRAME_BYTES, decode_frame};
use control::{ActiveLimits, Cause, Causes, Command, Mode, Plan, SensorFrame, State};
use schemars::JsonSchema;
use serde::Serialize;

/// When the rider's switch is pressed, for a recording without a switch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Press {
    /// Whenever a press would engage, also after a fault.
    #[default]
    Again,
    /// Only the first time that a press would engage.
    Once,
}

/// Options of a run.
#[derive(Clone, Debug)]
pub struct RunOptions<'a> {
    /// When the switch is pressed.
    pub press: Press,
    /// Time between two rows of the table \[s\].
    pub every_s: f64,
    /// The recording's own roll angle \[rad\] and torque \[N m\] over time \[s\].
    pub roll_rad: &'a [(f64, f64)],
    /// See `roll_rad`.
    pub torque_nm: &'a [(f64, f64)],
}

/// Start of a mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ModeRecord {
    /// Time in the recording \[s\].
    pub from_s: f64,
    /// Its name.
    pub mode: &'static str,
}

/// One cause over the whole recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CauseRecord {
    /// Its number.
    pub number: u8,
    /// Its name.
    pub name: &'static str,
    /// Time of its first occurrence \[s\].
    pub first_s: f64,
    /// Times that it began.
    pub count: u32,
    /// Total time that it was present \[s\].
    pub total_s: f64,
    /// Times that it began while the bicycle rode or the assist was engaged, after the controller was first ready. Zero
    /// for causes that describe a state, such as the switch being off.
    pub alarms: u32,
    /// Times at which these began \[s\].
    #[serde(skip)]
    pub alarms_s: Vec<f64>,
}

/// Result of a replay.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Replayed {
    /// First and last control instant \[s\].
    pub span_s: (f64, f64),
    /// Control periods.
    pub periods: u64,
    /// Time engaged \[s\].
    pub engaged_s: f64,
    /// Time in limp mode \[s\].
    pub limp_s: f64,
    /// Time in fault \[s\].
    pub fault_s: f64,
    /// Time ridden faster than 1 m/s \[s\].
    pub riding_s: f64,
    /// The modes in order of time.
    pub modes: Vec<ModeRecord>,
    /// The causes that occurred, by number.
    pub causes: Vec<CauseRecord>,
    /// Largest torque commanded \[N m\].
    pub peak_torque_nm: f64,
    /// Root mean square of the torque while engaged \[N m\].
    pub rms_torque_nm: f64,
    /// Part of the engaged periods in which the rate limit acted.
    pub rate_limited: f64,
    /// Margin of each check.
    pub checks: Vec<Check>,
    /// Estimated roll angle against the recorded one while riding \[rad\]; null if none was recorded.
    pub roll: Option<Compared>,
    /// Part of these instants in which the recorded roll angle lay inside the estimate's bound.
    pub roll_inside_bound: Option<f64>,
    /// Torque against the recorded one while engaged \[N m\]; null if none was recorded.
    pub torque: Option<Compared>,
    /// The table.
    #[serde(skip)]
    pub rows: Vec<Row>,
}

/// Causes that describe a state without torque rather than a fault.
const STATES: Causes = Causes::all(&[
    Cause::PolarityUnchecked,
    Cause::Filling,
    Cause::Parked,
    Cause::SwitchHeld,
    Cause::SwitchOff,
    Cause::SelfTest,
    Cause::RollUnknown,
]);

/// Speed above which a bicycle counts as riding \[m/s\].
const RIDING_M_S: f32 = 1.0;

/// A file that is no whole number of frames.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{bytes} bytes are no whole number of frames of {FRAME_BYTES} bytes")]
pub struct FramesError {
    /// Size of the file \[bytes\].
    pub bytes: usize,
}

/// The frames in a file of `ride --frames` or `replay --frames`, each with its time \[s\], the first at 0.
///
/// # Errors
/// The bytes are not a whole number of frames, or there is no frame.
pub fn frames(bytes: &[u8]) -> Result<Vec<(f64, SensorFrame)>, FramesError> {
    let (whole, rest) = bytes.as_chunks::<FRAME_BYTES>();
    if whole.is_empty() || !rest.is_empty() {
        return Err(FramesError { bytes: bytes.len() });
    }
    let mut t_s = 0.0;
    let mut before_us: Option<u32> = None;
    let at = |bytes: &[u8; FRAME_BYTES]| {
        let frame = decode_frame(bytes);
        t_s += before_us.map_or(0.0, |before| f64::from(frame.now_us.wrapping_sub(before)) * 1e-6);
        before_us = Some(frame.now_us);
        (t_s, frame)
    };
    Ok(whole.iter().map(at).collect())
}

/// Runs the controller over the sequence from `next`: time \[s\] and frame of each control instant. The argument of
/// `next` is the switch, used where none was recorded.
pub fn run(
    plan: &Plan,
    options: &RunOptions<'_>,
    mut next: impl FnMut(bool) -> Option<(f64, SensorFrame)>,
) -> Replayed {
    let period_s = 1.0 / f64::from(plan.config().rate_hz);
    let (mut state, mut account) = (State::default(), Account::new(plan));
    let mut pressed = Pressed { press: options.press, engaged: false, ended: false };
    let (mut next_roll, mut next_torque, mut next_row_s) = (0, 0, f64::NEG_INFINITY);
    let mut command: Option<Command> = None;
    while let Some((t_s, frame)) = next(command.is_some_and(|command| pressed.next(plan, &command))) {
        let now = control::step(plan, &mut state, &frame);
        let log =
            [held(options.roll_rad, &mut next_roll, t_s), held(options.torque_nm, &mut next_torque, t_s)];
        account.take(t_s, period_s, &frame, &state, &now, log);
        if t_s >= next_row_s {
            next_row_s = t_s + options.every_s - 0.5 * period_s;
            account.done.rows.push(row(t_s, &frame, &state, &now, log));
        }
        command = Some(now);
    }
    account.finish()
}

/// Simulated operation of the rider's switch.
struct Pressed {
    press: Press,
    engaged: bool,
    ended: bool,
}

impl Pressed {
    /// Whether the switch is on in the period after this command.
    fn next(&mut self, plan: &Plan, command: &Command) -> bool {
        let drives = command.mode.drives();
        self.ended |= self.engaged && !drives;
        self.engaged |= drives;
        drives || (plan.ready(command) && !(self.ended && self.press == Press::Once))
    }
}

/// Sums of a replay.
struct Account {
    done: Replayed,
    checks: Checks,
    mode: Mode,
    causes: Causes,
    /// Whether the controller was ready before.
    started: bool,
    speed_m_s: f32,
    limited: u64,
    engaged: u64,
    squares: f64,
    roll: Comparison,
    inside: u64,
    torque: Comparison,
}

impl Account {
    fn new(plan: &Plan) -> Self {
        Self {
            done: Replayed { span_s: (f64::NAN, f64::NAN), ..Replayed::default() },
            checks: Checks::new(plan.config()),
            mode: Mode::Off,
            causes: Causes::NONE,
            started: false,
            speed_m_s: 0.0,
            limited: 0,
            engaged: 0,
            squares: 0.0,
            roll: Comparison::default(),
            inside: 0,
            torque: Comparison::default(),
        }
    }

    #[allow(clippy::too_many_arguments, reason = "one control period, which has so many sides")]
    fn take(
        &mut self,
        t_s: f64,
        period_s: f64,
        frame: &SensorFrame,
        state: &State,
        command: &Command,
        [log_roll, log_torque]: [Option<f64>; 2],
    ) {
        let done = &mut self.done;
        if done.periods == 0 {
            done.span_s.0 = t_s;
        }
        done.span_s.1 = t_s;
        done.periods += 1;
        for sample in [&frame.front_wheel_m_s, &frame.rear_wheel_m_s] {
            if sample.age_ticks == 0 {
                self.speed_m_s = sample.value;
            }
        }
        let rides = self.speed_m_s > RIDING_M_S;
        done.riding_s += if rides { period_s } else { 0.0 };
        // Engaged periods count at any reported speed: the speed itself may be wrong.
        let counts = self.started && (rides || self.mode.drives());
        self.started |= command.mode >= Mode::Standby;
        causes(&mut done.causes, t_s, period_s, command.causes, self.causes, counts);
        self.causes = command.causes;
        if command.mode != self.mode || done.modes.is_empty() {
            done.modes.push(ModeRecord { from_s: t_s, mode: command.mode.name() });
            self.mode = command.mode;
        }
        let torque_nm = f64::from(command.torque_nm);
        done.peak_torque_nm = done.peak_torque_nm.max(torque_nm.abs());
        match command.mode {
            Mode::Engaged => done.engaged_s += period_s,
            Mode::Limp => done.limp_s += period_s,
            Mode::Fault => done.fault_s += period_s,
            _ => {}
        }
        if command.mode.drives() {
            self.engaged += 1;
            self.limited += u64::from(command.limits.0 & ActiveLimits::RATE.0 != 0);
            self.squares += torque_nm * torque_nm;
            if let Some(theirs) = log_torque {
                self.torque.take(f64::from(state.torque_nm()), theirs);
            }
        }
        if let Some(theirs) = log_roll.filter(|_| rides) {
            let roll = state.roll();
            self.roll.take(f64::from(roll.angle_rad), theirs);
            self.inside +=
                u64::from((f64::from(roll.angle_rad) - theirs).abs() <= f64::from(roll.error.bound_rad()));
        }
        self.checks.take(t_s, frame, state);
    }

    fn finish(self) -> Replayed {
        let engaged = self.engaged.max(1) as f64;
        let roll = self.roll.done();
        Replayed {
            checks: self.checks.done(),
            rate_limited: self.limited as f64 / engaged,
            rms_torque_nm: (self.squares / engaged).sqrt(),
            roll_inside_bound: roll.map(|compared| self.inside as f64 / compared.count as f64),
            roll,
            torque: self.torque.done(),
            ..self.done
        }
    }
}

/// Counts the causes of a period; `before` are those of the previous one.
fn causes(
    records: &mut Vec<CauseRecord>,
    t_s: f64,
    period_s: f64,
    now: Causes,
    before: Causes,
    counts: bool,
) {
    for cause in now.iter() {
        let number = cause.code();
        let at = records.partition_point(|record| record.number < number);
        if records.get(at).is_none_or(|record| record.number != number) {
            let record = CauseRecord {
                number,
                name: cause.name(),
                first_s: t_s,
                count: 0,
                total_s: 0.0,
                alarms: 0,
                alarms_s: Vec::new(),
            };
            records.insert(at, record);
        }
        let record = &mut records[at];
        record.total_s += period_s;
        if !before.has(cause) {
            record.count += 1;
            if counts && !STATES.has(cause) {
                record.alarms += 1;
                record.alarms_s.push(t_s);
            }
        }
    }
}
