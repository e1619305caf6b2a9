//! Quick rides: outcomes of rides with steps as long as the motion permits, under a law in continuous time or a controller
//! that is executed in every control period.
//!
//! The exact rides ([`super::rides`]) have the control period as their step and record the effort. These have a step of
//! their own in each lane, up to 20 ms, and end as soon as the linear model decides ([`super::forecast`]).

mod calm;
mod controller;
mod forecast;
mod held;
mod lag;
mod lane;
mod limited;
mod limits;
mod linear;
mod riders;
mod settled;
mod source;

use super::hardware::{self, lane_frame};
use super::instructions::Instructions;
use super::sensor::readings;
use super::substeps::{nearer, stiffness};
use super::warm_start::WarmStart;
use super::{Assist, Conditions, Outcome, Start};
use crate::bicycle::{FullState, Geometry, Motion, State, Torques};
use crate::integrate::{AHEAD, STAGES, WEIGHT, rate};
use crate::num::{Aligned, Lanes};
use crate::plant::Frame;
use crate::rider::Instant;
use calm::{CalmPlan, CalmStart};
use controller::{Controllers, Pace, StepStart};
use forecast::{Forecast, Now};
use held::Held;
use lane::Lane;
use limited::{LateLaw, Limited};
use riders::QuickRiders;
pub(super) use riders::RiderStart;
pub use settled::Foreseen;
use settled::remains_settled;
pub(super) use settled::{Settled, has_settled, interval};
use source::{Given, Source};
use std::sync::{Arc, Mutex};

/// Longest step \[s\].
const LONGEST_S: f64 = 20e-3;
/// Smallest ratio of the longest step to the control period at which quick rides are worth their inaccuracy.
const WORTH: f64 = 5.0;
/// Largest step relative to the time scale of the motion.
const LARGEST: f64 = 0.1;
/// The same with a rider, whose signals add their own errors.
const LARGEST_RIDDEN: f64 = 0.06;
/// Part of it with three speeds within [`NEAR`] of a singular configuration, where an error grows.
const PART_NEAR: f64 = 0.5;
/// Distance from a singular configuration, as a fraction of the upright bicycle's distance.
const NEAR: f64 = 0.25;
/// Time after a singular configuration from which a ride is ridden again in shorter steps \[s\]: the smallest error before it
/// grows after it.
const SENSITIVE_S: f64 = 0.3;
/// These steps, relative to the usual ones.
const SHORTER: f64 = 0.5;
/// Largest of fine steps, relative to the time scale of the motion.
const LARGEST_FINE: f64 = 0.025;
/// With a rider, the cosine of roll down to which the step shortens with it: nearer to the ground mostly the yaw rate grows,
/// which is counted already. Without a rider more falls bounce there, and their times need the shorter steps.
const LEAST_COS: f64 = 0.2;
/// Shortest step \[s\]: close to 90 degrees of roll the time scale is arbitrarily short.
const SHORTEST_S: f64 = 1e-6;
/// Smallest distance from a singular configuration at which the independent speeds are used, as a fraction of the
/// upright bicycle's distance.
const NEAREST: f64 = 0.1;
/// Steps per second of the time limit after which a ride is left to the exact method.
const STEPS_PER_S: f64 = 2000.0;
/// The end of a ride is decided if the late amplitude differs from the limit by this factor, in usual and in fine steps. Near the
/// limit late amplitudes differ from the exact ride's by 0.03 % in the median, 1 in 300 by more than 1 % and 2.4 % at most; in fine
/// steps 1 in 100 by 0.17 %, and 0.9 % at most.
const CLEAR: [f64; 2] = [1.05, 1.005];
/// The same of a controller that is executed in every control period: 0.03 %, 1 in 100 by 0.12 %, 0.9 % at most; and beside it one of
/// calm motion: 0.02 %, 1 in 100 by 0.48 %, 0.54 % at most.
const CLEAR_SAMPLED: [f64; 2] = [1.015; 2];
/// The same with a rider, or with limits, delays or a lag of the torque: a few in 1000 by more than 10 %, in fine steps by more than 3 %.
const CLEAR_ROUGH: [f64; 2] = [1.15, 1.03];

/// The same with a dead band, and under an own law, which may jump: a bicycle that sways around such a place goes on changing with the
/// smallest error.
const CLEAR_JUMPING: [f64; 2] = [2.0; 2];

/// The result of a quick ride.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuickRide {
    /// The outcome; `None` if it is too close to a limit, or the motion too fast, for this method.
    pub outcome: Option<Outcome>,
    /// Whether it did not fall within the time limit, while it is too close to the limit between recovered and undecided.
    pub upright: bool,
    /// Steps taken.
    pub steps: u32,
    /// Whether the motion went on for long after a singular configuration.
    sensitive: bool,
}

/// Quick rides under the conditions of exact ones.
#[derive(Clone, Debug)]
pub struct Quick<'a> {
    conditions: &'a Conditions,
    source: Source<'a>,
    forecast: Option<Forecast>,
    /// The controller in calm motion, if its steps are otherwise executed in every control period.
    calm: Option<CalmPlan<'a>>,
    pace: Pace,
    /// Warm starts of earlier rides.
    warm: Arc<Mutex<WarmStart>>,
    /// Largest step relative to the time scale of the motion.
    largest: f64,
    /// Factor between late amplitudes and the limit that decides.
    clear: f64,
    /// Whether the steps are fine. Otherwise sensitive rides, and those that are not decided, are ridden again.
    fine: bool,
}

impl<'a> Quick<'a> {
    /// Quick rides under these conditions. `None` if more acts than controller, constant delays, a motor's lag and rider: errors of
    /// sensors, a motor with a voltage, friction or an end-stop; or if a rider's delay needs steps that are hardly longer than the
    /// exact ride's.
    ///
    /// A law that is sampled and held is the continuous law, delayed by half a control period; constant limits, delays and the lag act
    /// in continuous time, too. A controller with any other function is executed in every control period, with sensors and a motor that
    /// are exact and not late.
    pub fn new(conditions: &'a Conditions) -> Option<Self> {
        let actuator = &conditions.plant.actuator;
        let source = Source::new(conditions);
        let late_or_exact = match &conditions.assist {
            Assist::Firmware(_) if source.law().is_some() => {
                conditions.plant.reads_exactly() && actuator.supply.is_none()
            }
            Assist::None => true,
            _ => conditions.plant.exact() && conditions.sensor_delay_ticks == 0,
        };
        let bare = late_or_exact && !actuator.friction.acts() && actuator.stop.is_none();
        let of_rider_s = conditions.rider.as_ref().map_or(f64::INFINITY, riders::longest_step_s);
        let pace = match source.sampled() {
            Some(_) => Pace::of_controller(hardware::needed(conditions), of_rider_s),
            None => Pace::unlimited(LONGEST_S.min(of_rider_s)),
        };
        let calm = source.sampled().and_then(|plan| CalmPlan::new(plan, conditions.step_s));
        if !bare || pace.longest_s < WORTH * conditions.step_s {
            return None;
        }
        let forecast = Forecast::new(conditions, &source);
        let largest = if conditions.rider.is_some() { LARGEST_RIDDEN } else { LARGEST };
        let [clear, _] = clear(conditions, &source);
        Some(Self {
            conditions,
            source,
            forecast,
            calm,
            pace,
            warm: Arc::default(),
            largest,
            clear,
            fine: false,
        })
    }

    /// The same in fine steps, which narrow a border.
    pub fn fine(&self) -> Self {
        let pace = if self.source.sampled().is_some() { self.pace.fine() } else { self.pace };
        let [_, clear] = clear(self.conditions, &self.source);
        Self { largest: LARGEST_FINE, pace, clear, fine: true, ..self.clone() }
    }
}

/// The factors between late amplitudes and the limit that decide, in usual and in fine steps.
fn clear(conditions: &Conditions, source: &Source) -> [f64; 2] {
    match source {
        _ if source.jumps() => CLEAR_JUMPING,
        _ if conditions.rider.is_some() || source.limited() => CLEAR_ROUGH,
        Source::Sampled(_) => CLEAR_SAMPLED,
        _ => CLEAR,
    }
}

impl Quick<'_> {
    /// Simulates every ride; results in the order of `starts`. A ride that goes on for long after a singular configuration is
    /// ridden again in shorter steps, one that is not decided in fine ones if that is quicker than an exact ride.
    pub fn rides(&self, starts: &[Start]) -> Vec<QuickRide> {
        let mut done = Instructions::of_this_processor().quick_rides(self, disturbed(starts));
        if self.fine {
            return done;
        }
        let shorter = Self { largest: SHORTER * self.largest, ..self.clone() };
        shorter.again(starts, &mut done, |ride| ride.sensitive);
        // A controller makes fine steps as slow as exact rides.
        if self.source.sampled().is_none() {
            self.fine().again(starts, &mut done, |ride| ride.outcome.is_none());
        }
        done
    }

    /// Replaces the rides that are `chosen`.
    fn again(&self, starts: &[Start], done: &mut [QuickRide], chosen: impl Fn(&QuickRide) -> bool) {
        let again: Vec<usize> = (0..done.len()).filter(|&i| chosen(&done[i])).collect();
        let starts: Vec<Start> = again.iter().map(|&i| starts[i]).collect();
        for (i, ride) in
            again.into_iter().zip(Instructions::of_this_processor().quick_rides(self, disturbed(&starts)))
        {
            done[i] = QuickRide { steps: done[i].steps + ride.steps, ..ride };
        }
    }
}

/// Quick rides that begin with disturbances.
pub(super) fn disturbed(starts: &[Start]) -> Vec<Begin> {
    starts.iter().copied().map(Begin::Disturbance).collect()
}

/// What a quick ride begins with.
pub(super) enum Begin {
    Disturbance(Start),
    Settled(Box<Settled>),
}

/// Simulates every ride once; results in the order in which they `begin`.
#[inline(always)]
pub(super) fn run<const N: usize>(quick: &Quick, begin: Vec<Begin>) -> Vec<QuickRide> {
    let Quick { conditions, source, forecast, calm, pace, warm, largest, clear, .. } = quick;
    let b = &conditions.bicycle;
    let least_cos = if conditions.rider.is_some() { LEAST_COS } else { 0.0 };
    let most_steps = (STEPS_PER_S * conditions.time_limit_s.max(1.0)) as u32;
    let mut done = vec![QuickRide { outcome: None, upright: false, steps: 0, sensitive: false }; begin.len()];
    let mut waiting = begin.into_iter().enumerate();
    let still = Lanes([0.0; N]);
    let mut state = Aligned(State::upright(b, still));
    let mut initial = still;
    let (mut held, half_held_s) = (Held::unknown(), source.half_held_s());
    let jump_s = source.law().map_or(f64::INFINITY, LateLaw::jump_s);
    let mut riders = conditions.rider.as_ref().map(|rider| QuickRiders::<N>::new(rider, jump_s));
    let mut controllers =
        source.sampled().map(|plan| Controllers::<N>::new(conditions, plan, calm.as_ref(), warm));
    let mut limited = source.law().and_then(Limited::<N>::new);
    let mut lanes: [Option<Lane>; N] = std::array::from_fn(|_| None);
    let mut calm_starts: [Option<CalmStart>; N] = std::array::from_fn(|_| None);
    loop {
        for (lane, ride) in lanes.iter_mut().enumerate().filter(|(_, ride)| ride.is_none()) {
            let next = waiting.next();
            let start = match &next {
                Some((_, Begin::Disturbance(start))) => *start,
                Some((_, Begin::Settled(settled))) => settled.ride.start,
                None => Start::default(),
            };
            state.0.set_lane(lane, &start.state(b));
            initial.0[lane] = start.speed_m_s;
            held.set_lane(lane, &Held::unknown());
            if let Some(riders) = &mut riders {
                riders.restart(lane);
            }
            if let Some(controllers) = &mut controllers {
                controllers.restart(lane, &start);
            }
            if let Some(limited) = &mut limited {
                limited.restart(lane);
            }
            *ride = next.map(|(index, begin)| match begin {
                Begin::Disturbance(_) => Lane::new(index),
                Begin::Settled(settled) => {
                    let Settled { ride, state: settled, rider } = *settled;
                    state.0.set_lane(lane, &settled);
                    if let (Some(riders), Some(rider)) = (&mut riders, rider) {
                        riders.resume(lane, rider);
                    }
                    Lane::continuing(index, &ride)
                }
            });
        }
        if lanes.iter().all(Option::is_none) {
            return done;
        }

        // The step of all lanes, in one loop so that the binary contains the equations of motion once.
        let held_before = held;
        let t: [Option<f64>; N] = std::array::from_fn(|lane| lanes[lane].as_ref().map(|ride| ride.t));
        if let Some(riders) = &mut riders {
            riders.turn();
        }
        let (mut start, mut end, mut at) = (state, state, state.0);
        let (mut h, mut stiff) = (still, [still; 4]);
        for (stage, part) in STAGES.into_iter().enumerate() {
            let motion = Motion::new(b, &at);
            let measured = readings(conditions, &motion.actual, initial);
            let read = match half_held_s {
                Some(half_s) => held.stage(stage, h, half_s, measured),
                None => measured,
            };
            if stage == 0 {
                // The pitch solved from roll and steer, not the predicted one.
                start.0.pitch = motion.pose.attitude.pitch;
                (end, stiff) = (start, stiffness(b, &motion));
                h = steps(
                    (conditions.time_limit_s, *largest, least_cos),
                    &t,
                    &stiff,
                    |lane, t, rate_rad_s| {
                        let of_rider = riders.as_ref().map(|riders| riders.longest_step_s(lane, t));
                        let of_law = limited.as_ref().map(|limited| limited.longest_step_s(lane, t));
                        let longest_s = match &controllers {
                            Some(controllers) => controllers.longest_step_s(lane, pace, rate_rad_s),
                            None => pace.longest_s,
                        };
                        of_rider.into_iter().chain(of_law).fold(longest_s, f64::min)
                    },
                );
                if let Some(limited) = &mut limited {
                    let wanted_nm = source.torques(read, None);
                    for (lane, t) in t.iter().enumerate() {
                        let Some(t) = *t else { continue };
                        h.0[lane] = limited.begin(lane, (t, h.0[lane]), wanted_nm.0[lane]);
                    }
                }
                if let Some(controllers) = &mut controllers {
                    // Copies: what no other function refers to can stay in registers.
                    let (seen, steer_rad) = (Aligned(motion), Aligned(start.0.steer));
                    for (lane, ride) in lanes.iter().enumerate() {
                        let Some(ride) = ride else { continue };
                        let (frame, measured) = match &ride.full {
                            Some(full) => {
                                let velocities = full.velocities(b);
                                let frame = Frame::new(&full.pose(b), &velocities, full.angles[2]);
                                (frame, readings(conditions, &velocities, initial.0[lane]))
                            }
                            None => {
                                let frame = lane_frame(&seen.0, lane, steer_rad.0.0[lane]);
                                (frame, (measured.0.0[lane], measured.1.0[lane]))
                            }
                        };
                        let rider_torque_nm =
                            riders.as_ref().map_or(0.0, |riders| riders.torque_nm().0[lane]);
                        let instant = StepStart { t_s: ride.t, frame, measured, rider_torque_nm };
                        h.0[lane] = controllers.begin(lane, h.0[lane], &instant);
                        if let Some(controller) = controllers.executed(lane) {
                            let rider = riders.as_ref().map(|riders| riders.before(lane));
                            let (state, ride) = (start.0.lane(lane), ride.clone());
                            calm_starts[lane] = Some(CalmStart { state, ride, rider, controller });
                        }
                    }
                    controllers.run_calm();
                }
            }
            let sampled_nm = controllers.as_ref().map(|controllers| controllers.line.at(part));
            let mut assist_nm = source.torques(read, sampled_nm);
            if let Some(limited) = &mut limited {
                assist_nm = limited.torques(stage, assist_nm);
            }
            let steer = riders.as_ref().map_or(assist_nm, |riders| assist_nm + riders.torque_nm());
            let torques = Torques { roll: still, steer };
            let (acc, by_steer) = motion.accelerations_by_steer(b, &torques);
            if let Some(riders) = &mut riders {
                let mut sensed = acc;
                if stage == 0 && riders.sampled() {
                    // The accelerations in a sampled rider's signals contain the torque that was computed from the same sample.
                    let held_nm = controllers.as_ref().map(|controllers| controllers.held_nm);
                    let mut later_nm = source.torques(measured, held_nm);
                    if let Some(limited) = &limited {
                        later_nm = limited.held(&t, later_nm);
                    }
                    let later_nm = later_nm - assist_nm;
                    sensed.roll = sensed.roll + by_steer.roll * later_nm;
                    sensed.steer = sensed.steer + by_steer.steer * later_nm;
                }
                riders.end_stage(b, stage, (&t, h), &Instant::new(&at, &motion, &sensed), &measured.1);
            }
            let k = rate(&at, &motion, &acc);
            end.0 = end.0.after(h * WEIGHT[stage], &k);
            at = start.0.after(h * AHEAD[stage], &k);
        }

        for (lane, slot) in lanes.iter_mut().enumerate() {
            let Some(ride) = slot else { continue };
            if let Some(controllers) = &mut controllers
                && controllers.stirred(lane)
                && let Some(earlier) = calm_starts[lane].take()
            {
                *ride = earlier.ride.with_steps(ride.steps + 1);
                end.0.set_lane(lane, &earlier.state);
                controllers.resume(lane, earlier.controller);
                if let (Some(riders), Some(rider)) = (&mut riders, earlier.rider) {
                    riders.resume(lane, rider);
                }
                continue;
            }
            let (before, h) = (start.0.lane(lane), h.0[lane]);
            let mut after = end.0.lane(lane);
            if nearer(stiff.map(|q| q.0[lane]), NEAREST) {
                let from = ride.full.unwrap_or_else(|| six_speeds(b, &before));
                let mut of_lane = held_before.lane(lane);
                let mut rider = riders.as_mut().map(|riders| riders.one(lane, (ride.t, h)));
                let given = match (&controllers, &mut limited) {
                    (Some(controllers), _) => Given::Line(controllers.line.of(lane)),
                    (None, Some(limited)) => Given::Limited(limited.one(lane)),
                    (None, None) => Given::Law,
                };
                let at = (initial.0[lane], &mut of_lane, given);
                ride.full = source.full_step(conditions, &from, h, at, rider.as_mut());
                let rider_state = rider.map(|rider| rider.end());
                if let (Some(riders), Some(rider_state)) = (&mut riders, rider_state) {
                    riders.set(lane, &rider_state);
                }
                held.set_lane(lane, &of_lane);
                after = ride.full.map_or(State { rear_wheel_rate: f64::NAN, ..before }, |next| next.state());
                end.0.set_lane(lane, &after);
            } else if ride.full.take().is_some() {
                ride.passed_s = ride.passed_s.or(Some(ride.t));
            }
            ride.steps += 1;
            let ended = match ride.book(conditions, *clear, (&before, &after), h) {
                None if ride.steps >= most_steps => Some(None),
                None if ride.continues && !remains_settled(conditions, &after) => Some(None),
                None => {
                    let rider = riders.as_ref().map(|riders| riders.after(lane));
                    let engaged = controllers.as_ref().is_none_or(|controllers| controllers.engaged(lane));
                    let free = limited.as_ref().is_none_or(|limited| limited.free(lane));
                    let (engaged, initial_m_s) = (engaged && free, initial.0[lane]);
                    let now = Now { t_s: ride.t, engaged, state: &after, rider, initial_m_s };
                    ride.decide_early(conditions, forecast, &now).map(Some)
                }
                ended => ended,
            };
            if let Some(outcome) = ended {
                let upright = outcome.is_none() && ride.over(conditions);
                let (steps, sensitive) = (ride.steps, ride.sensitive());
                done[ride.index] = QuickRide { outcome, upright, steps, sensitive };
                *slot = None;
            }
        }
        state = end;
    }
}

/// The steps of all lanes \[s\] from their times, `None` in an empty lane; `largest` is relative to the time scale, `longest_s`
/// of lane, time and the root of the sum of the squared angular rates \[rad/s\].
#[inline(always)]
fn steps<const N: usize>(
    (time_limit_s, largest, least_cos): (f64, f64, f64),
    t: &[Option<f64>; N],
    stiff: &[Lanes<N>; 4],
    longest_s: impl Fn(usize, f64, f64) -> f64,
) -> Lanes<N> {
    let mut h = Lanes([LONGEST_S; N]);
    for (i, t) in t.iter().enumerate() {
        let Some(t) = *t else { continue };
        let stiff = stiff.map(|q| q.0[i]);
        let [squares, cos_roll, ..] = stiff;
        let rate_rad_s = squares.sqrt();
        let part = if nearer(stiff, NEAR) && !nearer(stiff, NEAREST) { PART_NEAR } else { 1.0 };
        let scale_s = part * largest * cos_roll.abs().max(least_cos) / rate_rad_s;
        h.0[i] = scale_s.max(SHORTEST_S).min(longest_s(i, t, rate_rad_s)).min(time_limit_s - t);
    }
    h
}

/// The state with its dependent speeds.
#[inline(never)]
fn six_speeds(b: &Geometry, state: &State<f64>) -> FullState {
    FullState::new(&Motion::new(b, state), state)
}
