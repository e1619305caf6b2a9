//! Records effort, fall and outcome of one ride while it is simulated.

use super::backend::Backend;
use super::event::{at_fall, fallen, time_of_fall};
use super::hardware::RideHardware;
use super::sensor::{Reading, Sensors, frame};
use super::substeps::Segment;
use super::warm_start::Ready;
use super::{Assist, Conditions, Effort, FallCause, FinalState, Outcome, Ride, Start};
use crate::bicycle::{FullState, State};
use control::{Causes, Mode, Plan, SensorFrame};

/// Torques on the steer axis at the start of a control period.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SteerTorques {
    pub(super) assist_nm: f64,
    pub(super) rider_nm: f64,
}

/// Output of the controller at a control instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct ControllerOutput {
    /// Its input frame.
    pub(super) frame: SensorFrame,
    /// Commanded steer torque \[N m\].
    pub(super) torque_nm: f64,
    pub(super) limits: u16,
    pub(super) mode: Mode,
    pub(super) causes: Causes,
}

impl ControllerOutput {
    /// Output without a controller.
    const NONE: Self = Self {
        frame: SensorFrame::missing(),
        torque_nm: 0.0,
        limits: 0,
        mode: Mode::Off,
        causes: Causes::NONE,
    };
}

/// Record of the ride in a lane.
pub(super) struct RideRecorder {
    /// Index in the starts.
    pub(super) index: usize,
    pub(super) start: Start,
    /// Control periods simulated.
    pub(super) step: u32,
    pub(super) sensors: Sensors,
    /// The controller and the control periods since its boot; `None` without one.
    controller: Option<Ready>,
    /// Sensors and motor, if they are not exact.
    pub(super) hardware: Option<Box<RideHardware>>,
    /// Six-speed state, while the motion is near a singular configuration of the independent speeds.
    pub(super) full: Option<FullState>,
    before: SteerTorques,
    effort: Effort,
    /// Sums over the control periods: squares of both torques, and periods in which they opposed each other.
    squares: [f64; 2],
    opposed: u32,
    /// Largest roll and steer in the last second.
    late: [f64; 2],
    /// Control periods since roll first passed [`super::LaidFlat::roll_rad`], from 1; 0 before.
    flat_ticks: u32,
    /// Remaining number of substeps.
    pub(super) substeps_left: u32,
}

impl RideRecorder {
    pub(super) fn new(
        conditions: &Conditions,
        index: usize,
        start: Start,
        controller: Option<Ready>,
        hardware: Option<Box<RideHardware>>,
    ) -> Self {
        Self {
            index,
            start,
            step: 0,
            sensors: Sensors::new(conditions, &start),
            controller,
            hardware,
            full: None,
            before: SteerTorques::default(),
            effort: Effort::default(),
            squares: [0.0; 2],
            opposed: 0,
            late: [0.0; 2],
            flat_ticks: 0,
            substeps_left: conditions.most_substeps(),
        }
    }

    /// The controller's output for this instant's reading of exact sensors.
    pub(super) fn command(
        &mut self,
        assist: &Assist,
        backend: &mut Backend,
        measured: &Reading,
    ) -> ControllerOutput {
        match assist {
            Assist::None => ControllerOutput::NONE,
            Assist::Firmware(plan) => {
                let frame = frame(plan, measured, self.ticks(), true);
                self.output(plan, backend, frame)
            }
            Assist::Ideal(law) => ControllerOutput {
                torque_nm: law.torque_nm(measured.roll_rate_rad_s, measured.speed_m_s),
                ..ControllerOutput::NONE
            },
            Assist::Own(law) => ControllerOutput {
                torque_nm: law.torque_nm(measured.roll_rate_rad_s, measured.speed_m_s),
                ..ControllerOutput::NONE
            },
        }
    }

    /// Control periods since boot.
    pub(super) fn ticks(&self) -> u32 {
        self.controller.as_ref().map_or(0, |ready| ready.ticks)
    }

    /// The controller's output for a frame.
    pub(super) fn output(
        &mut self,
        plan: &Plan,
        backend: &mut Backend,
        frame: SensorFrame,
    ) -> ControllerOutput {
        let Some(Ready { controller, ticks }) = &mut self.controller else { return ControllerOutput::NONE };
        let command = backend.step(plan, controller, &frame).command;
        *ticks = ticks.wrapping_add(1);
        ControllerOutput {
            frame,
            torque_nm: f64::from(command.torque_nm),
            limits: command.limits.0,
            mode: command.mode,
            causes: command.causes,
        }
    }

    /// Records one control period that began with `steer_torques`, from `start` to the end of its `last`
    /// segment; returns the finished ride after the last period.
    ///
    /// The effort of the period in which the bicycle falls is not counted.
    pub(super) fn book(
        &mut self,
        conditions: &Conditions,
        steer_torques: SteerTorques,
        start: &State<f64>,
        last: &Segment,
    ) -> Option<Ride> {
        let (h, end) = (conditions.step_s, &last.end);
        if fallen(&conditions.fall, end) {
            let (tau, by) = time_of_fall(&conditions.fall, (&last.start, end), last.h);
            let time_s = f64::from(self.step) * h + last.offset + tau;
            let end = at_fall(&last.start, end, tau, last.h);
            self.step += 1;
            return Some(self.finish(Outcome::Fallen { time_s, by }, time_s, &end));
        }
        let e = &mut self.effort;
        let SteerTorques { assist_nm, rider_nm } = steer_torques;
        e.peak_torque_nm = e.peak_torque_nm.max(assist_nm.abs());
        if self.step > 0 {
            e.peak_slew_nm_s = e.peak_slew_nm_s.max((assist_nm - self.before.assist_nm).abs() / h);
        }
        e.peak_roll_rad = e.peak_roll_rad.max(end.roll.abs());
        e.peak_steer_rad = e.peak_steer_rad.max(end.steer.abs());
        let turned = end.steer - start.steer;
        e.motor_energy_j += assist_nm * turned;
        e.motor_energy_out_j += (assist_nm * turned).max(0.0);
        e.rider_peak_torque_nm = e.rider_peak_torque_nm.max(rider_nm.abs());
        e.rider_energy_j += rider_nm * turned;
        self.squares = [self.squares[0] + assist_nm * assist_nm, self.squares[1] + rider_nm * rider_nm];
        self.opposed += u32::from(assist_nm * rider_nm < 0.0);
        self.before = steer_torques;
        self.step += 1;
        let t = f64::from(self.step) * h;
        if t > conditions.time_limit_s - 1.0 {
            self.late = [self.late[0].max(end.roll.abs()), self.late[1].max(end.steer.abs())];
        }
        if let Some(by) = self.lies(conditions, last) {
            let time_s = t - h + last.offset + last.h;
            return Some(self.finish(Outcome::Fallen { time_s, by }, time_s, end));
        }
        (self.step >= conditions.steps()).then(|| self.finish(self.outlasted(conditions), t, end))
    }

    /// Other causes of a fall than the angles, after a control period that ended in `last`.
    fn lies(&mut self, conditions: &Conditions, last: &Segment) -> Option<FallCause> {
        self.substeps_left = self.substeps_left.saturating_sub(last.substeps);
        if self.substeps_left == 0 {
            return Some(FallCause::TooQuick);
        }
        let flat = conditions.fall.flat?;
        let beyond = last.end.roll.abs() > flat.roll_rad;
        self.flat_ticks += u32::from(beyond || self.flat_ticks > 0);
        let over = f64::from(self.flat_ticks) * conditions.step_s > flat.lasting_s;
        let came_back = self.flat_ticks > 0 && !beyond && self.step >= conditions.steps();
        (over || came_back).then_some(FallCause::LaidFlat)
    }

    fn finish(&self, outcome: Outcome, t: f64, state: &State<f64>) -> Ride {
        let mut effort = self.effort;
        let fell = matches!(outcome, Outcome::Fallen { .. });
        let booked = self.step.saturating_sub(u32::from(fell));
        let mean = |sum: f64| sum / f64::from(booked.max(1));
        effort.rms_torque_nm = mean(self.squares[0]).sqrt();
        effort.rider_rms_torque_nm = mean(self.squares[1]).sqrt();
        effort.opposed = mean(f64::from(self.opposed));
        let end = FinalState {
            t,
            roll: state.roll,
            steer: state.steer,
            roll_rate: state.roll_rate,
            steer_rate: state.steer_rate,
            rear_wheel_rate: state.rear_wheel_rate,
        };
        Ride { start: self.start, outcome, end, effort, steps: self.step }
    }

    /// Whether roll has passed [`super::LaidFlat::roll_rad`]: then even a ride that comes back falls in the end.
    pub(super) fn lay_flat(&self) -> bool {
        self.flat_ticks > 0
    }

    /// The ride up to now, its outcome open.
    pub(super) fn until_now(&self, conditions: &Conditions, state: &State<f64>) -> Ride {
        self.finish(Outcome::Undecided, f64::from(self.step) * conditions.step_s, state)
    }

    fn outlasted(&self, conditions: &Conditions) -> Outcome {
        let peak = [self.effort.peak_roll_rad, self.effort.peak_steer_rad];
        let outcome = Outcome::of_amplitudes(conditions.recovered_below, self.late, peak, 1.0);
        outcome.unwrap_or(Outcome::Undecided)
    }
}
