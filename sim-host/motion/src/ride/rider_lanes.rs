//! Rider models of the rides in the lanes: neuromuscular dynamics integrated with the bicycle, and delay
//! lines.

use super::quick::RiderStart;
use crate::bicycle::Geometry;
use crate::integrate::{STAGES, Stages};
use crate::num::Lanes;
use crate::rider::{DelayLine, Instant, Rider, RiderState, Signals};

/// Rider models in the lanes.
pub(super) struct RiderLanes<'a, const N: usize> {
    rider: &'a Rider,
    /// Rider states at the start of the step, and in the stages of the current step.
    pub(super) rider_state: Stages<RiderState<Lanes<N>>>,
    /// Neural delays; `None` for a rider without delay.
    delay_line: Option<[DelayLine; N]>,
    /// The signals that arrive at the start, middle and end of the step.
    arriving: [Lanes<N>; 3],
}

impl<'a, const N: usize> RiderLanes<'a, N> {
    /// Riders with a neural delay of `delay` steps.
    pub(super) fn new(rider: &'a Rider, delay: usize) -> Self {
        Self {
            rider,
            rider_state: Stages::new(RiderState::fresh()),
            delay_line: (delay > 0).then(|| std::array::from_fn(|_| DelayLine::new(delay))),
            arriving: [Lanes([0.0; N]); 3],
        }
    }

    /// Resets a lane for a new ride.
    pub(super) fn restart(&mut self, lane: usize) {
        self.set(lane, &RiderState::fresh());
        if let Some(delay_line) = &mut self.delay_line {
            delay_line[lane].clear();
        }
    }

    /// A stage of the step of `h` seconds: stores the feedback signals at `now`, with gains at the `speeds`
    /// \[m/s\], and advances the rider states. Empty lanes store no signals.
    #[inline(always)]
    pub(super) fn end_stage(
        &mut self,
        b: &Geometry,
        stage: usize,
        h: f64,
        now: &Instant<Lanes<N>>,
        speeds: &Lanes<N>,
        occupied: [bool; N],
    ) {
        let rider_state = self.rider_state.at;
        let alpha = match &mut self.delay_line {
            Some(delay_line) => {
                if stage == 0 {
                    let signals = rider_state.signals(now);
                    push(self.rider, delay_line, &signals, speeds, occupied);
                    arrive(delay_line, &mut self.arriving, occupied);
                }
                self.arriving[(2.0 * STAGES[stage]) as usize]
            }
            None => neural(self.rider, &rider_state.signals(now), speeds),
        };
        let k = rider_state.rate(b, now, &self.rider.neuromuscular, alpha);
        self.rider_state.next(stage, h, &k);
    }

    /// The rider in a lane, at the start of the step.
    pub(super) fn one(&mut self, lane: usize) -> RiderLane<'_> {
        let rider_state = self.rider_state.start().lane(lane);
        let delay_line = self.delay_line.as_mut().map(|delay_line| &mut delay_line[lane]);
        RiderLane { rider: self.rider, rider_state: Stages::new(rider_state), delay_line }
    }

    /// State of a lane at the end of the step of `h` seconds, and its signals up to the step's start.
    pub(super) fn after(&self, lane: usize, h: f64) -> RiderStart {
        let history = self.delay_line.as_ref().map(|delay_line| delay_line[lane].history(h));
        RiderStart { state: self.rider_state.end.lane(lane), history }
    }

    /// Sets the rider state of a lane at the end of the step.
    pub(super) fn set(&mut self, lane: usize, to: &RiderState<f64>) {
        self.rider_state.end.set_lane(lane, to);
    }

    /// Makes the end of a step the start of the next.
    #[inline(always)]
    pub(super) fn turn(&mut self) {
        self.rider_state = Stages::new(self.rider_state.end);
    }
}

/// Neural signals before their delay, each with the gains at its speed.
#[inline(always)]
pub(super) fn neural<const N: usize>(
    rider: &Rider,
    signals: &Signals<Lanes<N>>,
    speeds: &Lanes<N>,
) -> Lanes<N> {
    let mut out = Lanes([0.0; N]);
    for lane in 0..N {
        out.0[lane] = rider.schedule.at(speeds.0[lane]).signal(&lane_of(signals, lane));
    }
    out
}

pub(super) fn lane_of<const N: usize>(signals: &Signals<Lanes<N>>, lane: usize) -> Signals<f64> {
    let mut one = [0.0; 10];
    for (to, from) in one.iter_mut().zip(&signals.0) {
        *to = from.0[lane];
    }
    Signals(one)
}

fn push<const N: usize>(
    rider: &Rider,
    delay_line: &mut [DelayLine; N],
    signals: &Signals<Lanes<N>>,
    speeds: &Lanes<N>,
    occupied: [bool; N],
) {
    for lane in (0..N).filter(|&lane| occupied[lane]) {
        delay_line[lane].push(rider.schedule.at(speeds.0[lane]).signal(&lane_of(signals, lane)));
    }
}

fn arrive<const N: usize>(delay_line: &[DelayLine; N], to: &mut [Lanes<N>; 3], occupied: [bool; N]) {
    for lane in (0..N).filter(|&lane| occupied[lane]) {
        for (to, signal) in to.iter_mut().zip(delay_line[lane].arriving()) {
            to.0[lane] = signal;
        }
    }
}

/// One rider in the substeps of a control period.
pub(super) struct RiderLane<'a> {
    rider: &'a Rider,
    pub(super) rider_state: Stages<RiderState<f64>>,
    /// `None` without delay.
    delay_line: Option<&'a mut DelayLine>,
}

impl RiderLane<'_> {
    /// A stage at the fraction `s` of the control period, in a substep of `h` seconds.
    pub(super) fn end_stage(
        &mut self,
        b: &Geometry,
        (stage, h, s): (usize, f64, f64),
        now: &Instant<f64>,
        speed: f64,
    ) {
        let rider_state = self.rider_state.at;
        let neural = || self.rider.schedule.at(speed).signal(&rider_state.signals(now));
        let alpha = match &mut self.delay_line {
            Some(delay_line) => {
                if stage == 0 && s == 0.0 {
                    // The lane stored this instant's signal from the independent speeds; replaced here.
                    delay_line.correct(neural());
                }
                delay_line.arriving_at(s)
            }
            None => neural(),
        };
        let k = rider_state.rate(b, now, &self.rider.neuromuscular, alpha);
        self.rider_state.next(stage, h, &k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bicycle::{Motion, Parameters, State};
    use crate::rider::{Gains, Neuromuscular, Schedule};
    use nalgebra::{Complex, ComplexField};
    use std::f64::consts::TAU;

    const STEP_S: f64 = 1e-3;
    const DELAY_STEPS: usize = 60;
    /// Lanes for every processor.
    const LANES: usize = 4;

    /// Torques of four riders over time while roll, steer and yaw oscillate at `omega` with small
    /// amplitudes, with the bicycle kept upright at 5 m/s.
    fn swung(rider: &Rider, delay: usize, omega: f64, seconds: f64) -> Vec<f64> {
        let shipped = physics::bicycle::catalogue::load("rigid_jason").unwrap().parameters.to_values();
        let b = Geometry::new(&Parameters::from_values(&shipped));
        let state = State::upright(&b, Lanes([5.0; LANES]));
        let mut riders = RiderLanes::<LANES>::new(rider, delay);
        let mut torques = Vec::new();
        for n in 0..(seconds / STEP_S) as usize {
            torques.push(riders.rider_state.end.torque.0[3]);
            riders.turn();
            for (stage, part) in STAGES.into_iter().enumerate() {
                let phase = omega * (n as f64 + part) * STEP_S;
                let (sin, cos) = libm::sincos(phase);
                let same = |x: f64| Lanes([x; LANES]);
                let mut motion = Motion::new(&b, &state);
                motion.actual.roll = same(ROLL * omega * cos);
                motion.actual.steer = same(STEER * omega * cos);
                motion.actual.yaw = same(YAW * omega * cos);
                let acc = |amplitude: f64| same(-amplitude * omega * omega * sin);
                let now = Instant {
                    angles: [same(ROLL * sin), same(STEER * sin)],
                    accelerations: [acc(ROLL), acc(STEER)],
                    pose: &motion.pose,
                    velocities: &motion.actual,
                };
                riders.end_stage(&b, stage, STEP_S, &now, &same(5.0), [true; LANES]);
            }
        }
        torques
    }

    const ROLL: f64 = 1e-6;
    const STEER: f64 = -2e-6;
    const YAW: f64 = 0.5e-6;

    /// Situation: the complete rider model, all gains in use, the motion a small sine. Action: take the
    /// torque's Fourier coefficient once it has settled. Must hold: it equals that of G_nm exp(-tau s) K(s).
    #[test]
    fn frequency_response() {
        let gains = Gains([-8.0, -0.5, 7.0, 4.2, 12.0, 3.0, 1.3, -0.09, -0.6, 0.0]);
        for delay in [0, 30, DELAY_STEPS] {
            for periods in [1_usize, 3, 10] {
                let (neuromuscular, tau) = (Neuromuscular::SHOULDERS, delay as f64 * STEP_S);
                let rider = Rider { schedule: Schedule::constant(gains), delay_s: tau, neuromuscular };
                // Whole periods in the last second.
                let omega = TAU * periods as f64;
                let torques = swung(&rider, delay, omega, 4.0);
                let s = Complex::new(0.0, omega);
                let k = |at: usize| {
                    let [p, i, d, dd] = [0, 1, 2, 3].map(|j| Complex::from(gains.0[at + j]));
                    p + i / s + d * s + dd * s * s
                };
                let filter = neuromuscular.omega_rad_s.powi(2)
                    / (s * s
                        + s * 2.0 * neuromuscular.zeta * neuromuscular.omega_rad_s
                        + neuromuscular.omega_rad_s.powi(2));
                let feedback = k(0) * ROLL + k(4) * STEER + Complex::from(gains.0[8] * YAW);
                let expected = feedback * ComplexField::exp(-s * tau) * filter;
                let mut simulated = Complex::new(0.0, 0.0);
                for (n, torque) in torques.iter().enumerate().skip(3000) {
                    let turn = ComplexField::exp(Complex::new(0.0, -omega * n as f64 * STEP_S));
                    // A sine is the imaginary part of the exponential.
                    simulated += turn * *torque * Complex::new(0.0, 2.0) / 1000.0;
                }
                let error = (simulated - expected).modulus() / expected.modulus();
                assert!(
                    (1e-13..5e-7).contains(&error),
                    "{delay} ms, {periods} Hz: {simulated} {expected} {error:e}"
                );
            }
        }
    }
}
