//! Rider models of quick rides, integrated with the bicycle in steps of any length.

use crate::bicycle::Geometry;
use crate::integrate::{AHEAD, STAGES, Stages, WEIGHT};
use crate::num::Lanes;
use crate::ride::rider_lanes::neural;
use crate::rider::{Instant, Rider, RiderState, SignalHistory};

/// Largest step relative to the time scale of the neuromuscular dynamics.
const LARGEST: f64 = 0.4;

/// Longest step of a quick ride with this rider \[s\]; with a neural delay also that of the ride's own
/// [`SignalHistory::longest_step_s`].
pub(super) fn longest_step_s(rider: &Rider) -> f64 {
    let scale_s = LARGEST / rider.neuromuscular.omega_rad_s;
    if rider.delay_s > 0.0 { scale_s.min(rider.delay_s) } else { scale_s }
}

/// Rider models in the lanes.
pub(super) struct QuickRiders<'a, const N: usize> {
    rider: &'a Rider,
    start: RiderState<Lanes<N>>,
    /// States at the current stage.
    at: RiderState<Lanes<N>>,
    /// States at the end of the step, complete after the last stage.
    end: RiderState<Lanes<N>>,
    /// Neural signals; `None` for a rider without delay.
    histories: Option<[SignalHistory; N]>,
    /// The signals that arrive at the start, middle and end of the step.
    arriving: [Lanes<N>; 3],
}

/// A rider at the start of a step.
pub(in crate::ride) struct RiderStart {
    pub(in crate::ride) state: RiderState<f64>,
    pub(in crate::ride) history: Option<SignalHistory>,
}

impl<'a, const N: usize> QuickRiders<'a, N> {
    /// The signals can jump at `jump_s` \[s\]: infinite if they do not.
    pub(super) fn new(rider: &'a Rider, jump_s: f64) -> Self {
        let fresh = RiderState::fresh();
        let delayed = rider.delay_s > 0.0;
        let history = || SignalHistory::new(rider.delay_s).with_jump(jump_s);
        Self {
            rider,
            start: fresh,
            at: fresh,
            end: fresh,
            histories: delayed.then(|| std::array::from_fn(|_| history())),
            arriving: [Lanes([0.0; N]); 3],
        }
    }

    /// Resets a lane for a new ride.
    pub(super) fn restart(&mut self, lane: usize) {
        self.end.set_lane(lane, &RiderState::fresh());
        if let Some(histories) = &mut self.histories {
            histories[lane].clear();
        }
    }

    /// The rider in a lane before its signal at the start of the step.
    pub(super) fn before(&self, lane: usize) -> RiderStart {
        let history = self.histories.as_ref().map(|histories| histories[lane].clone());
        RiderStart { state: self.start.lane(lane), history }
    }

    /// Continues in a lane from an earlier step's start.
    pub(super) fn resume(&mut self, lane: usize, from: RiderStart) {
        self.end.set_lane(lane, &from.state);
        if let (Some(histories), Some(history)) = (&mut self.histories, from.history) {
            histories[lane] = history;
        }
    }

    /// Makes the end of a step the start of the next.
    #[inline(always)]
    pub(super) fn turn(&mut self) {
        (self.start, self.at) = (self.end, self.end);
    }

    /// Whether the exact ride samples the riders' signals, at the control instants: with a neural delay.
    pub(super) fn sampled(&self) -> bool {
        self.histories.is_some()
    }

    /// Torques on the handlebar at the current stage \[N m\].
    #[inline(always)]
    pub(super) fn torque_nm(&self) -> Lanes<N> {
        self.at.torque
    }

    /// Longest step of a lane from `t` \[s\].
    pub(super) fn longest_step_s(&self, lane: usize, t: f64) -> f64 {
        self.histories.as_ref().map_or(f64::INFINITY, |histories| histories[lane].longest_step_s(t))
    }

    /// A stage of the step of `h` seconds from `t`, which is `None` in an empty lane; as
    /// [`super::super::rider_lanes::RiderLanes::end_stage`].
    #[inline(always)]
    pub(super) fn end_stage(
        &mut self,
        b: &Geometry,
        stage: usize,
        (t, h): (&[Option<f64>; N], Lanes<N>),
        now: &Instant<Lanes<N>>,
        speeds: &Lanes<N>,
    ) {
        let alpha = match &mut self.histories {
            Some(histories) => {
                if stage == 0 {
                    let signals = neural(self.rider, &self.at.signals(now), speeds);
                    for (lane, history) in histories.iter_mut().enumerate() {
                        let Some(t) = t[lane] else { continue };
                        history.push(t, signals.0[lane]);
                        for (to, signal) in self.arriving.iter_mut().zip(history.arriving(t, h.0[lane])) {
                            to.0[lane] = signal;
                        }
                    }
                }
                self.arriving[(2.0 * STAGES[stage]) as usize]
            }
            None => neural(self.rider, &self.at.signals(now), speeds),
        };
        let k = self.at.rate(b, now, &self.rider.neuromuscular, alpha);
        self.end = self.end.after(h * WEIGHT[stage], &k);
        self.at = self.start.after(h * AHEAD[stage], &k);
    }

    /// The rider in a lane at the start of the step of `h` seconds from `t`.
    pub(super) fn one(&mut self, lane: usize, (t, h): (f64, f64)) -> QuickRider<'_> {
        QuickRider {
            rider: self.rider,
            stages: Stages::new(self.start.lane(lane)),
            history: self.histories.as_mut().map(|histories| &mut histories[lane]),
            t,
            h,
            arriving: [0.0; 3],
        }
    }

    /// Sets the state of a lane at the end of the step.
    pub(super) fn set(&mut self, lane: usize, to: &RiderState<f64>) {
        self.end.set_lane(lane, to);
    }

    /// State of a lane at the end of the step, and its signals up to the step's start.
    pub(super) fn after(&self, lane: usize) -> (RiderState<f64>, Option<&SignalHistory>) {
        (self.end.lane(lane), self.histories.as_ref().map(|histories| &histories[lane]))
    }
}

/// One rider in a step with six speeds.
pub(super) struct QuickRider<'a> {
    rider: &'a Rider,
    stages: Stages<RiderState<f64>>,
    history: Option<&'a mut SignalHistory>,
    t: f64,
    h: f64,
    arriving: [f64; 3],
}

impl QuickRider<'_> {
    /// Torque on the handlebar at the current stage \[N m\].
    pub(super) fn torque_nm(&self) -> f64 {
        self.stages.at.torque
    }

    /// A stage; the lane stored the start's signal from the independent speeds, which is replaced.
    pub(super) fn end_stage(&mut self, b: &Geometry, stage: usize, now: &Instant<f64>, speed: f64) {
        let at = self.stages.at;
        let neural = || self.rider.schedule.at(speed).signal(&at.signals(now));
        let alpha = match &mut self.history {
            Some(history) => {
                if stage == 0 {
                    history.correct(neural());
                    self.arriving = history.arriving(self.t, self.h);
                }
                self.arriving[(2.0 * STAGES[stage]) as usize]
            }
            None => neural(),
        };
        let k = at.rate(b, now, &self.rider.neuromuscular, alpha);
        self.stages.next(stage, self.h, &k);
    }

    /// State at the end of the step.
    pub(super) fn end(&self) -> RiderState<f64> {
        self.stages.end
    }
}
