//! Rides side by side, one in each lane; a lane whose ride ends takes the next.

use super::human::{Human, Humans};
use super::logbook::{Logbook, Pushes};
use super::outfit::{self, Outfit, lane_frame, told_signals};
use super::preroll::Readied;
use super::processor::Processor;
use super::refine::{Period, Segment, quickness, refined, too_quick};
use super::sensor::{Reading, readings};
use super::{Assist, Conditions, Ride, Start, TracePoint};
use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use crate::integrate::{Actuation, STAGES, rk4};
use crate::num::Lanes;
use crate::plant::{Frame, Plant};
use crate::rider::Instant;

/// How many rides go side by side: two AVX2 registers a number, which hides the latencies.
pub(super) const WIDTH: usize = 8;

/// The rides in the lanes, as what acts on their bicycles.
struct Abreast<'a, 'p, const N: usize> {
    conditions: &'a Conditions,
    processor: &'a mut Processor<'p>,
    /// The conditions' plant, every delay in it.
    plant: Plant,
    lanes: [Option<Logbook>; N],
    /// Speeds at the start \[m/s\].
    initial: Lanes<N>,
    /// The assist's torques, in the step's middle where they change in it \[N m\].
    assist: Lanes<N>,
    /// The riders.
    humans: Option<Humans<'a, N>>,
    /// The riders' torques at the step's start \[N m\].
    human: Lanes<N>,
    /// How quick each lane's motion is, by [`quickness`].
    quickness: [Lanes<N>; 4],
    /// Where lane 0 is written down.
    trace: Option<&'a mut Vec<TracePoint>>,
}

impl<const N: usize> Abreast<'_, '_, N> {
    /// The control instant at a step's start: sensors, controllers, new torques.
    fn control(&mut self, b: &Geometry, motion: &Motion<Lanes<N>>) {
        self.quickness = quickness(b, motion);
        if let Some(humans) = &self.humans {
            self.human = humans.body.at.torque;
        }
        let (rate, speed) = readings(self.conditions, &motion.actual, self.initial);
        for (lane, ride) in self.lanes.iter_mut().enumerate() {
            let Some(ride) = ride else { continue };
            // Near singular places only all six speeds tell the truth.
            let (told, answer) = match (ride.outfit.take(), &self.conditions.assist) {
                (Some(mut outfit), Assist::Firmware(plan)) => {
                    let at = match &ride.full {
                        Some(full) => Frame::new(&full.pose(b), &full.velocities(b), full.angles[2]),
                        None => lane_frame(motion, lane),
                    };
                    let (rider_nm, initial) = (self.human.0[lane], self.initial.0[lane]);
                    let told = outfit.told(self.conditions, &self.plant, &at, rider_nm, initial);
                    let answer = ride.answer(plan, self.processor, outfit::frame(plan, &told));
                    outfit.commanded(self.conditions, &self.plant, answer.torque_nm);
                    let middle_s = 0.5 * self.conditions.step_s;
                    self.assist.0[lane] =
                        outfit.motor.torque(&self.plant.actuator, middle_s, at.velocities.steer);
                    ride.outfit = Some(outfit);
                    (told_signals(plan, &told), answer)
                }
                _ => {
                    let (rate, speed) = match &ride.full {
                        Some(full) => readings(self.conditions, &full.velocities(b), self.initial.0[lane]),
                        None => (rate.0[lane], speed.0[lane]),
                    };
                    let told = ride.sensors.delayed(Reading { roll_rate_rad_s: rate, speed_m_s: speed });
                    let answer = ride.command(&self.conditions.assist, self.processor, &told);
                    self.assist.0[lane] = answer.torque_nm;
                    (told, answer)
                }
            };
            if let (0, Some(trace)) = (lane, &mut self.trace) {
                // Whole nanoseconds: the nearest number to 5.999 s, not 5999 times the nearest to 1 ms.
                let t = (f64::from(ride.step) * self.conditions.step_s * 1e9).round() / 1e9;
                let pushes = Pushes { assist_nm: self.assist.0[0], rider_nm: self.human.0[0] };
                trace.push(TracePoint::new(b, t, motion, &told, &answer, pushes));
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
                given = speed.map(|v| law.gain(v)) * rate;
            }
        } else if !self.plant.actuator.exact() {
            let elapsed_s = STAGES[stage] * self.conditions.step_s;
            for (lane, ride) in self.lanes.iter().enumerate() {
                if let Some(outfit) = ride.as_ref().and_then(|ride| ride.outfit.as_ref()) {
                    let rate = motion.actual.steer.0[lane];
                    given.0[lane] = outfit.motor.torque(&self.plant.actuator, elapsed_s, rate);
                }
            }
        }
        given
    }
}

impl<const N: usize> Actuation<Lanes<N>> for Abreast<'_, '_, N> {
    #[inline(always)]
    fn torques(&mut self, b: &Geometry, stage: usize, motion: &Motion<Lanes<N>>) -> Torques<Lanes<N>> {
        if stage == 0 {
            self.control(b, motion);
        }
        let mut steer = self.given(stage, motion);
        if let Some(humans) = &self.humans {
            steer = steer + humans.body.at.torque;
        }
        let friction = &self.plant.actuator.friction;
        if friction.acts() {
            steer = steer + friction.torque(motion.actual.steer);
        }
        if let Some(stop) = &self.plant.actuator.stop {
            let (sin, cos) = motion.pose.attitude.steer;
            for (lane, steer) in steer.0.iter_mut().enumerate() {
                *steer += stop.torque(libm::atan2(sin.0[lane], cos.0[lane]), motion.actual.steer.0[lane]);
            }
        }
        Torques { roll: Lanes([0.0; N]), steer }
    }

    #[inline(always)]
    fn felt(
        &mut self,
        b: &Geometry,
        stage: usize,
        state: &State<Lanes<N>>,
        motion: &Motion<Lanes<N>>,
        acc: &Accelerations<Lanes<N>>,
    ) {
        if let Some(humans) = &mut self.humans {
            let mut taken = [false; N];
            for (taken, lane) in taken.iter_mut().zip(&self.lanes) {
                *taken = lane.is_some();
            }
            let (_, speed) = readings(self.conditions, &motion.actual, self.initial);
            let now = Instant::new(state, motion, acc);
            humans.felt(b, stage, self.conditions.step_s, &now, &speed, taken);
        }
    }
}

/// Every ride to its end, in the order of `starts`; with `trace`, every instant of lane 0's rides. When the
/// processor fails, the rides under way are not among them.
///
/// A lane's arithmetic does not depend on its neighbours, so a ride has the same bits in any lane.
#[inline(always)]
pub(super) fn run<const N: usize>(
    conditions: &Conditions,
    starts: &[Start],
    trace: Option<&mut Vec<TracePoint>>,
    processor: &mut Processor<'_>,
) -> Vec<Ride> {
    let (b, h) = (&conditions.bicycle, conditions.step_s);
    let mut waiting = starts.iter().copied().enumerate();
    let still = Lanes([0.0; N]);
    let mut state = State::upright(b, still);
    let mut abreast = Abreast {
        conditions,
        processor,
        plant: conditions.plant.delayed(conditions.sensor_delay_ticks),
        lanes: std::array::from_fn(|_| None),
        initial: still,
        assist: still,
        humans: conditions.rider.as_ref().map(|rider| Humans::new(rider, rider.delay_steps(h))),
        human: still,
        quickness: [still; 4],
        trace,
    };
    let mut done = Vec::with_capacity(starts.len());
    let mut readied = Readied::default();
    let fitted_out = outfit::needed(conditions);
    loop {
        for lane in 0..N {
            if abreast.lanes[lane].is_some() {
                continue;
            }
            // An empty lane stands upright and still, which costs what any other state costs.
            let next = waiting.next();
            let start = next.map_or_else(Start::default, |(_, start)| start);
            set(&mut state, lane, &start.state(b));
            abreast.initial.0[lane] = start.speed_m_s;
            abreast.assist.0[lane] = 0.0;
            if let Some(humans) = &mut abreast.humans {
                humans.restart(lane);
            }
            abreast.lanes[lane] = next.map(|(index, start)| {
                let processor = &mut *abreast.processor;
                if let Assist::Firmware(plan) = &conditions.assist {
                    processor.begin(plan, &start);
                }
                let (outfit, ready) = match &conditions.assist {
                    Assist::Firmware(plan) if fitted_out => {
                        let plant = &abreast.plant;
                        let (outfit, ready) = Outfit::new(conditions, plan, plant, &start, processor, |_| ());
                        (Some(Box::new(outfit)), Some(ready))
                    }
                    _ => (None, readied.at(conditions, processor, start.speed_m_s)),
                };
                processor.disturb();
                Logbook::new(conditions, index, start, ready, outfit)
            });
        }
        if abreast.lanes.iter().all(Option::is_none) || abreast.processor.failed() {
            break;
        }
        if let Some(humans) = &mut abreast.humans {
            humans.turn();
        }
        let mut after = rk4(b, &state, h, &mut abreast);
        for lane in 0..N {
            let pushes = Pushes { assist_nm: abreast.assist.0[lane], rider_nm: abreast.human.0[lane] };
            let Some(ride) = &mut abreast.lanes[lane] else { continue };
            let was = get(&state, lane);
            let last = if too_quick(abreast.quickness.map(|q| q.0[lane]), h) {
                let human = abreast.humans.as_mut().map(|humans| humans.one(lane));
                let mut period = Period {
                    conditions,
                    most_pieces: ride.pieces_left,
                    full: &mut ride.full,
                    assist_nm: pushes.assist_nm,
                    motor: ride.outfit.as_ref().map(|outfit| &outfit.motor),
                    initial_m_s: abreast.initial.0[lane],
                    human,
                };
                let last = refined(&mut period, &was);
                let body = period.human.map(|human: Human| human.body.end);
                set(&mut after, lane, &last.is);
                if let (Some(humans), Some(body)) = (&mut abreast.humans, body) {
                    humans.set(lane, &body);
                }
                last
            } else {
                ride.full = None;
                Segment { was, is: get(&after, lane), offset: 0.0, h, pieces: 0 }
            };
            if let Some(finished) = ride.book(conditions, pushes, &was, &last) {
                done.push((ride.index, finished));
                abreast.lanes[lane] = None;
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
