//! Simulates rides side by side, one in each lane; when a ride ends, its lane takes the next.

use super::backend::Backend;
use super::hardware::{self, lane_frame};
use super::quick::{Settled, has_settled, interval};
use super::recorder::{RideRecorder, SteerTorques};
use super::rider_lanes::{RiderLane, RiderLanes};
use super::sensor::{Reading, readings};
use super::steer_torque::{self, PerRide};
use super::substeps::{Period, Segment, refined, stiffness, too_stiff};
use super::warm_start::WarmStart;
use super::{Assist, Conditions, Ride, Start, TracePoint};
use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use crate::integrate::{Actuation, STAGES, rk4};
use crate::num::{Aligned, Lanes};
use crate::plant::{Frame, Plant};
use crate::rider::Instant;

/// What is needed of rides beside their outcomes.
pub(super) enum Needed<'a> {
    /// Effort and final state.
    Effort,
    /// The same, and a record of every control period of lane 0's rides.
    Trace(&'a mut Vec<TracePoint>),
    /// Nothing: from the time at its index on \[s\] a ride ends once its motion has settled, which is stored at the same index.
    Outcome(&'a [f64], &'a mut [Option<Box<Settled>>]),
}

/// The rides in the lanes, as the source of their torques.
struct LaneBatch<'a, 'p, const N: usize> {
    conditions: &'a Conditions,
    backend: &'a mut Backend<'p>,
    /// The plant, with all delays included.
    plant: Plant,
    lanes: [Option<RideRecorder>; N],
    /// Speeds at t = 0 \[m/s\].
    initial: Lanes<N>,
    /// Assist torques \[N m\]; at the middle of the step if they change within it.
    assist: Lanes<N>,
    /// The riders.
    riders: Option<RiderLanes<'a, N>>,
    /// Rider torques at the start of the step \[N m\].
    rider_nm: Lanes<N>,
    /// The quantities of [`stiffness`] of each lane.
    stiffness: [Lanes<N>; 4],
    /// Whether sensors or motor are not exact, or the controller reads more of them than roll rate and one speed.
    needs_hardware: bool,
    needed: Needed<'a>,
}

impl<const N: usize> LaneBatch<'_, '_, N> {
    /// Control instant at the start of a step: sensors, controllers, new torques, from the exact roll rates and speeds; sensors and trace
    /// need the whole motion.
    fn control(
        &mut self,
        b: &Geometry,
        (rate, speed): (Lanes<N>, Lanes<N>),
        motion: Option<&Motion<Lanes<N>>>,
    ) {
        if let Some(riders) = &self.riders {
            self.rider_nm = riders.rider_state.at.torque;
        }
        for (lane, ride) in self.lanes.iter_mut().enumerate() {
            let Some(ride) = ride else { continue };
            // Near singular configurations only the six-speed state is accurate.
            let (measured, output) = match (ride.hardware.take(), &self.conditions.assist, motion) {
                (Some(mut hardware), Assist::Firmware(plan), Some(motion)) => {
                    let at = match &ride.full {
                        Some(full) => Frame::new(&full.pose(b), &full.velocities(b), full.angles[2]),
                        None => {
                            let (sin, cos) = motion.pose.attitude.steer;
                            lane_frame(motion, lane, libm::atan2(sin.0[lane], cos.0[lane]))
                        }
                    };
                    let also = (self.rider_nm.0[lane], self.initial.0[lane]);
                    let read = (&**plan, &self.plant);
                    let (frame, measured) = hardware.measured(self.conditions, read, &at, also, ride.ticks());
                    let output = ride.output(plan, self.backend, frame);
                    hardware.commanded(self.conditions, &self.plant, output.torque_nm);
                    let middle_s = 0.5 * self.conditions.step_s;
                    self.assist.0[lane] =
                        hardware.motor.torque(&self.plant.actuator, middle_s, at.velocities.steer);
                    ride.hardware = Some(hardware);
                    (measured, output)
                }
                _ => {
                    let (rate, speed) = match &ride.full {
                        Some(full) => readings(self.conditions, &full.velocities(b), self.initial.0[lane]),
                        None => (rate.0[lane], speed.0[lane]),
                    };
                    let measured = ride.sensors.delayed(Reading { roll_rate_rad_s: rate, speed_m_s: speed });
                    let output = ride.command(&self.conditions.assist, self.backend, &measured);
                    self.assist.0[lane] = output.torque_nm;
                    (measured, output)
                }
            };
            if let (0, Needed::Trace(trace), Some(motion)) = (lane, &mut self.needed, motion) {
                // Rounded to whole nanoseconds: the nearest number to 5.999 s, not 5999 times the nearest to 1 ms.
                let t = (f64::from(ride.step) * self.conditions.step_s * 1e9).round() / 1e9;
                let steer_torques =
                    SteerTorques { assist_nm: self.assist.0[0], rider_nm: self.rider_nm.0[0] };
                trace.push(TracePoint::new(b, t, motion, &measured, &output, steer_torques));
            }
        }
    }

    /// The assist's torques on the steer axis at a stage of the step.
    #[inline(always)]
    fn given(&self, stage: usize, motion: &Motion<Lanes<N>>) -> Lanes<N> {
        let mut given = self.assist;
        if let Assist::Ideal(law) = &self.conditions.assist {
            if stage > 0 {
                let (rate, speed) = readings(self.conditions, &motion.actual, self.initial);
                given = rate.zip(speed, |p, v| law.torque_nm(p, v));
            }
        } else if let Assist::Own(law) = &self.conditions.assist {
            if stage > 0 {
                let (rate, speed) = readings(self.conditions, &motion.actual, self.initial);
                given = rate.zip(speed, |p, v| law.torque_nm(p, v));
            }
        } else if !self.plant.actuator.exact() {
            let elapsed_s = STAGES[stage] * self.conditions.step_s;
            for (lane, ride) in self.lanes.iter().enumerate() {
                if let Some(hardware) = ride.as_ref().and_then(|ride| ride.hardware.as_ref()) {
                    let rate = motion.actual.steer.0[lane];
                    given.0[lane] = hardware.motor.torque(&self.plant.actuator, elapsed_s, rate);
                }
            }
        }
        given
    }
}

impl<const N: usize> Actuation<Lanes<N>> for LaneBatch<'_, '_, N> {
    #[inline(always)]
    fn begin_step(&mut self, b: &Geometry, motion: &Motion<Lanes<N>>) {
        self.stiffness = stiffness(b, motion);
        let exact = readings(self.conditions, &motion.actual, self.initial);
        if self.needs_hardware || matches!(self.needed, Needed::Trace(_)) {
            // A copy: what no other function refers to can stay in registers.
            let seen = Aligned(*motion);
            self.control(b, exact, Some(&seen.0));
        } else {
            self.control(b, exact, None);
        }
    }

    #[inline(always)]
    fn torques(&self, stage: usize, motion: &Motion<Lanes<N>>) -> Torques<Lanes<N>> {
        let rider_nm = self.riders.as_ref().map(|riders| riders.rider_state.at.torque);
        let (sin, cos) = motion.pose.attitude.steer;
        let steer_rad = || sin.zip(cos, libm::atan2);
        let assist_nm = self.given(stage, motion);
        steer_torque::torques(&self.plant.actuator, assist_nm, rider_nm, steer_rad, motion.actual.steer)
    }

    #[inline(always)]
    fn end_stage(
        &mut self,
        b: &Geometry,
        stage: usize,
        state: &State<Lanes<N>>,
        motion: &Motion<Lanes<N>>,
        acc: &Accelerations<Lanes<N>>,
    ) {
        if let Some(riders) = &mut self.riders {
            let mut occupied = [false; N];
            for (occupied, lane) in occupied.iter_mut().zip(&self.lanes) {
                *occupied = lane.is_some();
            }
            let (_, speed) = readings(self.conditions, &motion.actual, self.initial);
            let now = Instant::new(state, motion, acc);
            riders.end_stage(b, stage, self.conditions.step_s, &now, &speed, occupied);
        }
    }
}

/// Simulates every ride as far as is `needed`; results in the order of `starts`. If the external processor fails, unfinished rides are
/// left out.
///
/// A lane's arithmetic does not depend on its neighbours, so a ride has the same bits in any lane.
#[inline(always)]
pub(super) fn run<const N: usize>(
    conditions: &Conditions,
    starts: &[Start],
    needed: Needed<'_>,
    backend: &mut Backend<'_>,
) -> Vec<Ride> {
    let (b, h) = (&conditions.bicycle, conditions.step_s);
    let mut waiting = starts.iter().copied().enumerate();
    let still = Lanes([0.0; N]);
    let mut state = Aligned(State::upright(b, still));
    let mut batch = LaneBatch {
        conditions,
        backend,
        plant: conditions.plant.delayed(conditions.sensor_delay_ticks),
        lanes: std::array::from_fn(|_| None),
        initial: still,
        assist: still,
        riders: conditions.rider.as_ref().map(|rider| RiderLanes::new(rider, rider.delay_steps(h))),
        rider_nm: still,
        stiffness: [still; 4],
        needs_hardware: hardware::needed(conditions),
        needed,
    };
    let interval = interval(conditions);
    let mut done = Vec::with_capacity(starts.len());
    let mut warm_start = WarmStart::default();
    loop {
        for lane in 0..N {
            if batch.lanes[lane].is_some() {
                continue;
            }
            // An empty lane is upright at rest; its computing time equals that of any other state.
            let next = waiting.next();
            let start = next.map_or_else(Start::default, |(_, start)| start);
            state.0.set_lane(lane, &start.state(b));
            batch.initial.0[lane] = start.speed_m_s;
            batch.assist.0[lane] = 0.0;
            if let Some(riders) = &mut batch.riders {
                riders.restart(lane);
            }
            batch.lanes[lane] = next.map(|(index, start)| {
                let backend = &mut *batch.backend;
                if let Assist::Firmware(plan) = &conditions.assist {
                    backend.begin(plan, &start);
                }
                let warm = warm_start.at(conditions, (&batch.plant, batch.needs_hardware), backend, &start);
                let (ready, hardware) = warm.map_or((None, None), |warm| (Some(warm.ready), warm.hardware));
                backend.disturb();
                RideRecorder::new(conditions, index, start, ready, hardware)
            });
        }
        if batch.lanes.iter().all(Option::is_none) || batch.backend.failed() {
            break;
        }
        if let Some(riders) = &mut batch.riders {
            riders.turn();
        }
        let mut after = Aligned(rk4(b, &state.0, h, &mut batch));
        for lane in 0..N {
            let steer_torques =
                SteerTorques { assist_nm: batch.assist.0[lane], rider_nm: batch.rider_nm.0[lane] };
            let Some(ride) = &mut batch.lanes[lane] else { continue };
            let before = state.0.lane(lane);
            let last = if too_stiff(batch.stiffness.map(|q| q.0[lane]), h) {
                let rider = batch.riders.as_mut().map(|riders| riders.one(lane));
                let mut period = Period {
                    conditions,
                    most_substeps: ride.substeps_left,
                    full: &mut ride.full,
                    assist_nm: steer_torques.assist_nm,
                    roll_nm: 0.0,
                    motor: ride.hardware.as_ref().map(|hardware| &hardware.motor),
                    initial_m_s: batch.initial.0[lane],
                    rider,
                };
                let last = refined(&mut period, &before);
                let rider_state = period.rider.map(|rider: RiderLane| rider.rider_state.end);
                after.0.set_lane(lane, &last.end);
                if let (Some(riders), Some(rider_state)) = (&mut batch.riders, rider_state) {
                    riders.set(lane, &rider_state);
                }
                last
            } else {
                ride.full = None;
                Segment { start: before, end: after.0.lane(lane), offset: 0.0, h, substeps: 0 }
            };
            let mut finished = ride.book(conditions, steer_torques, &before, &last);
            let t = f64::from(ride.step) * h;
            if let (None, Needed::Outcome(exact_s, settled)) = (&finished, &mut batch.needed)
                && ride.step.is_multiple_of(interval)
                && t >= exact_s[ride.index]
                && !ride.lay_flat()
                && has_settled(conditions, t, &last.end)
            {
                let rider = batch.riders.as_ref().map(|riders| riders.after(lane, h));
                let until_now = ride.until_now(conditions, &last.end);
                settled[ride.index] = Some(Box::new(Settled { ride: until_now, state: last.end, rider }));
                finished = Some(until_now);
            }
            if let Some(finished) = finished {
                done.push((ride.index, finished));
                batch.lanes[lane] = None;
            }
        }
        state = after;
    }
    done.sort_by_key(|(index, _): &(usize, Ride)| *index);
    done.into_iter().map(|(_, ride)| ride).collect()
}
