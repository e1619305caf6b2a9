//! A rider as a model: the bicycle's motion in, the torque on the handlebar out, after the neural delay.

use crate::model::{from_bytes, to_bytes};
use crate::setup::Setup;
use crate::variable::{Role, Variable};
use motion::ride::ScheduleSpeed;
use motion::rider::{MAX_DELAY_S, Neuromuscular, Rider as Model, RiderSample, Schedule, SteppedRider};

pub(crate) fn variables(delay_s: f64, muscles: &Neuromuscular, speed: ScheduleSpeed) -> Vec<Variable> {
    let parameter = |name, unit, about| Variable::real(Role::Parameter, name, unit, about);
    let input = |name, unit, about| Variable::real(Role::Input, name, unit, about);
    let output = |name, unit, about| Variable::real(Role::Output, name, unit, about);
    let wheel = match speed {
        ScheduleSpeed::Front | ScheduleSpeed::Initial => "front_wheel_m_s",
        ScheduleSpeed::Rear => "rear_wheel_m_s",
    };
    vec![
        parameter("delay_s", "s", "neural delay, a whole number of steps")
            .starting(delay_s)
            .within(0.0, MAX_DELAY_S),
        parameter("muscle_omega_rad_s", "rad/s", "undamped natural frequency of the neuromuscular dynamics")
            .starting(muscles.omega_rad_s)
            .within(0.1, 200.0),
        parameter("muscle_zeta", "", "damping ratio of the neuromuscular dynamics")
            .starting(muscles.zeta)
            .within(0.01, 10.0),
        input("roll_rad", "rad", "roll angle, right positive"),
        input("roll_rate_rad_s", "rad/s", "roll rate"),
        input("roll_acceleration_rad_s2", "rad/s^2", "roll acceleration"),
        input("steer_rad", "rad", "steer angle, right positive"),
        input("steer_rate_rad_s", "rad/s", "steer rate"),
        input("steer_acceleration_rad_s2", "rad/s^2", "steer acceleration"),
        input("heading_rad", "rad", "heading of the rear frame relative to the start, right positive"),
        input("front_lateral_m", "m", "lateral deviation of the front contact from the line of the start"),
        input(wheel, "m/s", "speed that schedules the gains"),
        output("rider_torque_nm", "N m", "torque on the handlebar at this instant, right positive"),
        output("rider_torque_rate_nm_s", "N m/s", "its rate"),
    ]
}

/// The rider.
#[derive(Clone, Debug)]
pub(crate) struct Rider {
    model: Model,
    step_s: f64,
    rider: Option<SteppedRider>,
}

impl Rider {
    /// From its setup; `None` for another model's.
    ///
    /// # Errors
    /// The gains are wrong.
    pub(crate) fn new(setup: &Setup) -> Result<Option<Self>, String> {
        let Setup::Rider { gains, outside, delay_s, neuromuscular, step_s, .. } = setup else {
            return Ok(None);
        };
        let schedule = Schedule::new(gains.clone(), *outside).map_err(|e| e.to_string())?;
        let model = Model { schedule, delay_s: *delay_s, neuromuscular: *neuromuscular };
        Ok(Some(Self { model, step_s: *step_s, rider: None }))
    }

    pub(crate) fn begin(&mut self, values: &[f64]) -> Result<(), String> {
        let &[delay_s, omega_rad_s, zeta] = values else { return Err("parameters are missing".into()) };
        self.model.delay_s = delay_s;
        self.model.neuromuscular = Neuromuscular { omega_rad_s, zeta };
        self.model.check(self.step_s).map_err(|e| format!("delay_s: {e}"))?;
        self.rider = Some(SteppedRider::new(&self.model, self.step_s));
        Ok(())
    }

    pub(crate) fn step(&mut self, inputs: &[f64]) {
        let Some(rider) = &mut self.rider else { return };
        let &[
            roll,
            roll_rate,
            roll_acc,
            steer,
            steer_rate,
            steer_acc,
            heading_rad,
            front_lateral_m,
            speed_m_s,
        ] = inputs
        else {
            return;
        };
        let now = RiderSample {
            roll: [roll, roll_rate, roll_acc],
            steer: [steer, steer_rate, steer_acc],
            heading_rad,
            front_lateral_m,
            speed_m_s,
        };
        rider.step(&self.model, self.step_s, &now);
    }

    pub(crate) fn outputs(&self, to: &mut [f64]) {
        if let Some(rider) = &self.rider {
            to.copy_from_slice(&rider.torque());
        }
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        to_bytes(&self.rider)
    }

    pub(crate) fn load(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.rider = from_bytes(bytes)?;
        Ok(())
    }
}
