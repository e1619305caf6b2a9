//! Rides side by side, one in each lane; a lane whose ride ends takes the next.

use super::refine::{Segment, quickness, refined, too_quick};
use super::rider::Rider;
use super::sensor::{Reading, readings};
use super::{Assist, Conditions, Ride, Start, TracePoint};
use crate::bicycle::{Geometry, Motion, State, Torques};
use crate::integrate::{Actuation, rk4};
use crate::num::Lanes;

/// How many rides go side by side: two AVX2 registers a number, which hides the latencies.
pub(super) const WIDTH: usize = 8;

/// The rides in the lanes, as what acts on their bicycles.
struct Riders<'a, const N: usize> {
    conditions: &'a Conditions,
    lanes: [Option<Rider>; N],
    /// Speeds at the start \[m/s\].
    initial: Lanes<N>,
    /// Torques at the step's start \[N m\].
    torque: Lanes<N>,
    /// How quick each lane's motion is, by [`quickness`].
    quickness: [Lanes<N>; 4],
    /// Where lane 0 is written down.
    trace: Option<&'a mut Vec<TracePoint>>,
}

impl<const N: usize> Riders<'_, N> {
    /// The control instant at a step's start: sensors, controllers, new torques.
    fn control(&mut self, b: &Geometry, motion: &Motion<Lanes<N>>) {
        self.quickness = quickness(b, motion);
        let (rate, speed) = readings(self.conditions, &motion.actual, self.initial);
        for (lane, rider) in self.lanes.iter_mut().enumerate() {
            let Some(rider) = rider else { continue };
            // Near singular places only all six speeds tell the truth.
            let (rate, speed) = match &rider.full {
                Some(full) => readings(self.conditions, &full.velocities(b), self.initial.0[lane]),
                None => (rate.0[lane], speed.0[lane]),
            };
            let now = Reading { roll_rate_rad_s: rate, speed_m_s: speed };
            let told = rider.sensors.delayed(now);
            let (torque_nm, limits) = rider.command(&self.conditions.assist, &told);
            self.torque.0[lane] = torque_nm;
            if let (0, Some(trace)) = (lane, &mut self.trace) {
                let t = f64::from(rider.step) * self.conditions.step_s;
                trace.push(TracePoint::new(b, t, motion, &told, torque_nm, limits));
            }
        }
    }
}

impl<const N: usize> Actuation<Lanes<N>> for Riders<'_, N> {
    #[inline(always)]
    fn torques(&mut self, b: &Geometry, stage: usize, motion: &Motion<Lanes<N>>) -> Torques<Lanes<N>> {
        let mut steer = self.torque;
        if stage == 0 {
            self.control(b, motion);
            steer = self.torque;
        } else if let Assist::Ideal(law) = &self.conditions.assist {
            let (rate, speed) = readings(self.conditions, &motion.actual, self.initial);
            steer = speed.map(|v| law.gain(v)) * rate;
        }
        Torques { roll: Lanes([0.0; N]), steer }
    }
}

/// Every ride to its end, in the order of `starts`; with `trace`, every instant of lane 0's rides.
///
/// A lane's arithmetic does not depend on its neighbours, so a ride has the same bits in any lane.
#[inline(always)]
pub(super) fn run<const N: usize>(
    conditions: &Conditions,
    starts: &[Start],
    trace: Option<&mut Vec<TracePoint>>,
) -> Vec<Ride> {
    let (b, h) = (&conditions.bicycle, conditions.step_s);
    let mut waiting = starts.iter().copied().enumerate();
    let still = Lanes([0.0; N]);
    let mut state = State::upright(b, still);
    let lanes = std::array::from_fn(|_| None);
    let mut riders =
        Riders { conditions, lanes, initial: still, torque: still, quickness: [still; 4], trace };
    let mut done = Vec::with_capacity(starts.len());
    loop {
        for lane in 0..N {
            if riders.lanes[lane].is_some() {
                continue;
            }
            // An empty lane stands upright and still, which costs what any other state costs.
            let next = waiting.next();
            let start = next.map_or_else(Start::default, |(_, start)| start);
            set(&mut state, lane, &start.state(b));
            riders.initial.0[lane] = start.speed_m_s;
            riders.torque.0[lane] = 0.0;
            riders.lanes[lane] = next.map(|(index, start)| Rider::new(conditions, index, start));
        }
        if riders.lanes.iter().all(Option::is_none) {
            break;
        }
        let mut after = rk4(b, &state, h, &mut riders);
        for lane in 0..N {
            let torque_nm = riders.torque.0[lane];
            let Some(rider) = &mut riders.lanes[lane] else { continue };
            let was = get(&state, lane);
            let last = if too_quick(riders.quickness.map(|q| q.0[lane]), h) {
                let last = refined(conditions, &was, &mut rider.full, torque_nm, riders.initial.0[lane]);
                set(&mut after, lane, &last.is);
                last
            } else {
                rider.full = None;
                Segment { was, is: get(&after, lane), offset: 0.0, h }
            };
            if let Some(ride) = rider.book(conditions, torque_nm, &was, &last) {
                done.push((rider.index, ride));
                riders.lanes[lane] = None;
            }
        }
        state = after;
    }
    done.sort_by_key(|(index, _): &(usize, Ride)| *index);
    done.into_iter().map(|(_, ride)| ride).collect()
}

fn get<const N: usize>(s: &State<Lanes<N>>, lane: usize) -> State<f64> {
    State {
        roll: s.roll.0[lane],
        steer: s.steer.0[lane],
        roll_rate: s.roll_rate.0[lane],
        steer_rate: s.steer_rate.0[lane],
        rear_wheel_rate: s.rear_wheel_rate.0[lane],
        pitch: s.pitch.0[lane],
    }
}

fn set<const N: usize>(s: &mut State<Lanes<N>>, lane: usize, to: &State<f64>) {
    s.roll.0[lane] = to.roll;
    s.steer.0[lane] = to.steer;
    s.roll_rate.0[lane] = to.roll_rate;
    s.steer_rate.0[lane] = to.steer_rate;
    s.rear_wheel_rate.0[lane] = to.rear_wheel_rate;
    s.pitch.0[lane] = to.pitch;
}

impl Start {
    /// The state it stands for.
    pub fn state(&self, b: &Geometry) -> State<f64> {
        State {
            roll_rate: self.roll_rate_rad_s,
            steer_rate: self.steer_rate_rad_s,
            ..State::upright(b, self.speed_m_s)
        }
    }
}
