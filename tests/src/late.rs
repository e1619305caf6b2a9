//! Rides with late sensors and a slow actuator, and a controller that can compensate for both.

use crate::estimator_inputs::{Noise, Truth, truth};
use crate::model::{LinearBicycle, Model, OnTheWay};
use control::Law;
use control::estimate::predict::{self, PredictConfig};
use control::estimate::{self, EstimateConfig, EstimateState, EstimatorInput, Motion};
use sim_host::bicycle::{self, Accelerations, Geometry, State, Torques};
use sim_host::integrate::{Actuation, STAGES, Stages, rk4};
use sim_host::ride::Start;
use sim_host::rider::{DelayLine, Instant, Rider, RiderState};
use std::collections::VecDeque;
use std::f64::consts::FRAC_PI_2;

/// The time step, and the control period \[s\].
const STEP_S: f64 = 1e-3;
/// The same \[us\].
const STEP_US: u32 = 1000;
/// Duration for which the estimator runs before the disturbance \[steps\].
const BEFORE: usize = 1000;

/// Compensation of the delay in the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PredictedMotion {
    /// Not at all.
    Off,
    /// By extrapolation with the roll acceleration, as flashed, over this time \[s\].
    Lead(f64),
    /// By a linear bicycle, over this time \[s\].
    Model(LinearBicycle, f64),
}

/// Common conditions of the rides of a comparison.
#[derive(Clone, Debug)]
pub struct Late<'a> {
    /// The bicycle.
    pub bicycle: &'a Geometry,
    /// The rider.
    pub rider: Option<&'a Rider>,
    /// The law; its gain by the front wheel's speed, as published.
    pub law: &'a Law,
    /// Delay of every sensor \[ms\].
    pub sensors_ms: usize,
    /// Time constant of the actuator \[s\].
    pub actuator_s: f64,
    /// The controller's estimator of the attitude.
    pub estimate: EstimateConfig,
    /// Compensation of the delay.
    pub ahead: PredictedMotion,
    /// The noise of the sensors, by its seed.
    pub noise: Option<u64>,
    /// Duration of a ride \[s\].
    pub seconds: f64,
}

/// Result of a ride.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ridden {
    /// Roll or steer reached 90 degrees.
    pub fell: bool,
    /// Root mean square of the requested torque \[N m\].
    pub rms_nm: f64,
    /// Root mean square of its change from one control period to the next, by time \[N m/s\].
    pub rms_nm_s: f64,
}

impl Late<'_> {
    /// A ride, to its end or the fall.
    pub fn ride(&self, start: Start) -> Ridden {
        let b = self.bicycle;
        let mut state = start.state(b);
        let mut controller = Controller::new(self, start.speed_m_s);
        let mut push = Push::new(self);
        let free = Torques { roll: 0.0, steer: 0.0 };
        let mut before = truth(b, &state, &free, &self.estimate.imu);
        let (mut squares, mut changes, mut last) = (0.0, 0.0, 0.0);
        let steps = (self.seconds / STEP_S) as usize;
        for i in 0..steps {
            let torques = Torques { roll: 0.0, steer: push.assist_nm + push.body.end.torque };
            let now = truth(b, &state, &torques, &self.estimate.imu);
            let expected = controller.step(self, &Truth::between(&before, &now));
            squares += expected * expected;
            changes += ((expected - last) / STEP_S).powi(2);
            last = expected;
            let share = if self.actuator_s > 0.0 { 1.0 - (-STEP_S / self.actuator_s).exp() } else { 1.0 };
            push.assist_nm += share * (expected - push.assist_nm);
            push.body = Stages::new(push.body.end);
            state = rk4(b, &state, STEP_S, &mut push);
            // The negation also counts a NaN state as a fall.
            if !(state.roll.abs() < FRAC_PI_2 && state.steer.abs() < FRAC_PI_2) {
                let n = (i + 1) as f64;
                return Ridden { fell: true, rms_nm: (squares / n).sqrt(), rms_nm_s: (changes / n).sqrt() };
            }
            before = now;
        }
        let n = steps as f64;
        Ridden { fell: false, rms_nm: (squares / n).sqrt(), rms_nm_s: (changes / n).sqrt() }
    }

    /// The largest steer rate \[rad/s\] up to `most` below which no ride at `speed` \[m/s\] falls, to 0.05.
    pub fn height(&self, speed_m_s: f64, most: f64) -> f64 {
        let falls =
            |steer_rate_rad_s| self.ride(Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 }).fell;
        let mut low = 0.0;
        while !falls(low + 1.0) {
            low += 1.0;
            if low >= most {
                return low;
            }
        }
        let mut high = low + 1.0;
        while high - low > 0.05 {
            let middle = 0.5 * (low + high);
            if falls(middle) { high = middle } else { low = middle }
        }
        low
    }
}

/// The controller of one ride.
struct Controller {
    estimator: EstimateState,
    lead: PredictConfig,
    model: Option<Model>,
    torques: OnTheWay,
    noise: Option<Noise>,
    arriving: VecDeque<(EstimatorInput, f32)>,
}

impl Controller {
    fn new(late: &Late<'_>, speed: f64) -> Self {
        let steady = truth(
            late.bicycle,
            &bicycle::State::upright(late.bicycle, speed),
            &Torques { roll: 0.0, steer: 0.0 },
            &late.estimate.imu,
        );
        let first = (steady.estimator_input(STEP_US), steady.front_speed as f32);
        let mut controller = Self {
            estimator: EstimateState::default(),
            lead: PredictConfig {
                lead_s: if let PredictedMotion::Lead(s) = late.ahead { s as f32 } else { 0.0 },
                ..PredictConfig::default()
            },
            model: match &late.ahead {
                PredictedMotion::Model(bicycle, delay) => {
                    Some(Model::new(bicycle, *delay as f32, STEP_S as f32))
                }
                PredictedMotion::Off | PredictedMotion::Lead(_) => None,
            },
            torques: OnTheWay::default(),
            noise: late.noise.map(Noise::new),
            arriving: vec![first; late.sensors_ms].into(),
        };
        for _ in 0..BEFORE {
            let _ = controller.step(late, &steady);
        }
        controller.torques = OnTheWay::default();
        controller
    }

    /// The requested torque \[N m\].
    fn step(&mut self, late: &Late<'_>, now: &Truth) -> f64 {
        let mut input = now.estimator_input(STEP_US);
        if let Some(noise) = &mut self.noise {
            noise.on(&mut input);
        }
        self.arriving.push_back((input, now.front_speed as f32));
        let Some((input, front_speed)) = self.arriving.pop_front() else { return 0.0 };
        let motion: Motion = estimate::step(&late.estimate, &mut self.estimator, &input);
        let roll_rate_rad_s = match &self.model {
            Some(model) => model.ahead(&self.torques, &motion).roll_rate_rad_s,
            None => predict::step(&self.lead, &motion).roll_rate_rad_s,
        };
        let torque = late.law.gain(front_speed) * roll_rate_rad_s;
        if let Some(model) = &self.model {
            self.torques.commanded(model, torque);
        }
        f64::from(torque)
    }
}

/// The torques on the handlebar.
struct Push<'a> {
    rider: Option<&'a Rider>,
    delay_line: Option<DelayLine>,
    arriving: [f64; 3],
    body: Stages<RiderState<f64>>,
    assist_nm: f64,
}

impl<'a> Push<'a> {
    fn new(late: &Late<'a>) -> Self {
        let delay_line = late.rider.map(|rider| DelayLine::new(rider.delay_steps(STEP_S)));
        Self {
            rider: late.rider,
            delay_line,
            arriving: [0.0; 3],
            body: Stages::new(RiderState::fresh()),
            assist_nm: 0.0,
        }
    }
}

impl Actuation<f64> for Push<'_> {
    fn torques(&self, _: usize, _: &bicycle::Motion<f64>) -> Torques<f64> {
        Torques { roll: 0.0, steer: self.assist_nm + self.body.at.torque }
    }

    fn end_stage(
        &mut self,
        b: &Geometry,
        stage: usize,
        state: &State<f64>,
        motion: &bicycle::Motion<f64>,
        acc: &Accelerations<f64>,
    ) {
        let (Some(rider), Some(delay_line)) = (self.rider, &mut self.delay_line) else { return };
        let (now, body) = (Instant::new(state, motion, acc), self.body.at);
        if stage == 0 {
            let speed = motion.actual.front_spin * -b.rF;
            delay_line.push(rider.schedule.at(speed).signal(&body.signals(&now)));
            self.arriving = delay_line.arriving();
        }
        let k = body.rate(b, &now, &rider.neuromuscular, self.arriving[(2.0 * STAGES[stage]) as usize]);
        self.body.next(stage, STEP_S, &k);
    }
}
