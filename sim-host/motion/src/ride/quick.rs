//! Quick rides: outcomes of rides under a law in continuous time, with steps as long as the motion permits.
//!
//! The exact rides ([`super::rides`]) have the control period as their step and record the effort. These have a step of
//! their own in each lane, up to 20 ms, and end as soon as the linear model decides ([`super::forecast`]).

use super::assist::{IdealLaw, OwnLaw};
use super::event::{fallen, time_of_fall};
use super::forecast::Forecast;
use super::sensor::readings;
use super::substeps::{nearer, stiffness};
use super::{Assist, Conditions, FallCause, Outcome, Start};
use crate::bicycle::{FullState, Geometry, Motion, State, Torques};
use crate::integrate::{AHEAD, STAGES, Stages, WEIGHT, rate};
use crate::num::Lanes;
use control::estimate::{EstimateConfig, Source as RollRate};
use control::{Config, Law, Plan};

/// Longest step \[s\].
const LONGEST_S: f64 = 20e-3;
/// Largest step relative to the time scale of the motion.
const LARGEST: f64 = 0.05;
/// Shortest step \[s\]: close to 90 degrees of roll the time scale is arbitrarily short.
const SHORTEST_S: f64 = 1e-6;
/// Smallest distance from a singular configuration at which the independent speeds are used, as a fraction of the
/// upright bicycle's distance.
const NEAREST: f64 = 0.1;
/// Steps per second of the time limit after which a ride is left to the exact method.
const STEPS_PER_S: f64 = 2000.0;
/// The end of a ride is decided if the late amplitude differs from the limit by this factor.
const CLEAR: f64 = 1.03;

/// The result of a quick ride.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuickRide {
    /// The outcome; `None` if it is too close to a limit, or the motion too fast, for this method.
    pub outcome: Option<Outcome>,
    /// Steps taken.
    pub steps: u32,
}

/// The law of quick rides.
#[derive(Clone, Debug)]
enum Source<'a> {
    None,
    /// A law and the delay of its torque \[s\], to first order: it acts on roll rate and speed minus this time times
    /// their slopes.
    Ideal(Box<IdealLaw>, f64),
    Own(&'a OwnLaw),
}

/// Quick rides under the conditions of exact ones.
#[derive(Clone, Debug)]
pub struct Quick<'a> {
    conditions: &'a Conditions,
    source: Source<'a>,
    forecast: Option<Forecast>,
}

impl<'a> Quick<'a> {
    /// Quick rides under these conditions. `None` if the law is not all that acts: with a rider, limits, filters or checks
    /// of the controller, errors or delays of sensors and motor, friction or an end-stop.
    ///
    /// A law that is sampled and held is the continuous law, delayed by half a control period.
    pub fn new(conditions: &'a Conditions) -> Option<Self> {
        let actuator = &conditions.plant.actuator;
        let bare = conditions.rider.is_none()
            && conditions.plant.exact()
            && conditions.sensor_delay_ticks == 0
            && !actuator.friction.acts()
            && actuator.stop.is_none();
        let source = match &conditions.assist {
            Assist::None => Source::None,
            Assist::Ideal(law) => Source::Ideal(law.clone(), 0.0),
            Assist::Own(law) => Source::Own(law),
            Assist::Firmware(plan) => Source::Ideal(Box::new(continuous(plan)?), 0.5 * conditions.step_s),
        };
        let forecast = match &source {
            Source::None => Forecast::new(conditions, &IdealLaw::from(Law::None), 0.0),
            Source::Ideal(law, delay_s) => Forecast::new(conditions, law, *delay_s),
            Source::Own(_) => None,
        };
        bare.then_some(Self { conditions, source, forecast })
    }
}

/// The law of a controller without any other function.
fn continuous(plan: &Plan) -> Option<IdealLaw> {
    let config = plan.config();
    let mut bare = Config::thesis(config.law.clone());
    bare.dead_band = config.dead_band;
    // Without limits, checks and conditions for engagement these values act on nothing.
    bare.estimate = EstimateConfig { roll_rate: RollRate::GyroX, ..config.estimate };
    bare.cross.wheelbase_m = config.cross.wheelbase_m;
    bare.cross.tilt_rad = config.cross.tilt_rad;
    bare.calibration.polarity_checked = config.calibration.polarity_checked;
    (bare == *config).then(|| IdealLaw { law: config.law.clone(), dead_band: config.dead_band })
}

/// One ride in its lane.
struct Lane {
    index: usize,
    /// Time since the disturbance \[s\].
    t: f64,
    steps: u32,
    /// Largest roll and steer \[rad\].
    peak: [f64; 2],
    /// Largest roll and steer in the last second \[rad\].
    late: [f64; 2],
    /// Time at which the roll first passed [`super::LaidFlat::roll_rad`].
    flat_s: Option<f64>,
    /// Six-speed state near singular configurations.
    full: Option<FullState>,
    /// Earliest time of the next forecast \[s\].
    forecast_s: f64,
}

/// Simulates every ride; results in the order of `starts`.
#[inline(always)]
pub(super) fn run<const N: usize>(quick: &Quick, starts: &[Start]) -> Vec<QuickRide> {
    let Quick { conditions, source, forecast } = quick;
    let b = &conditions.bicycle;
    let most_steps = (STEPS_PER_S * conditions.time_limit_s.max(1.0)) as u32;
    let mut done = vec![QuickRide { outcome: None, steps: 0 }; starts.len()];
    let mut waiting = starts.iter().copied().enumerate();
    let still = Lanes([0.0; N]);
    let mut state = State::upright(b, still);
    let mut initial = still;
    let mut slopes = [still; 2];
    let mut lanes: [Option<Lane>; N] = std::array::from_fn(|_| None);
    loop {
        for (lane, ride) in lanes.iter_mut().enumerate().filter(|(_, ride)| ride.is_none()) {
            let next = waiting.next();
            let start = next.map_or_else(Start::default, |(_, start)| start);
            state.set_lane(lane, &start.state(b));
            initial.0[lane] = start.speed_m_s;
            slopes.iter_mut().for_each(|slope| slope.0[lane] = 0.0);
            *ride = next.map(|(index, _)| Lane::new(index));
        }
        if lanes.iter().all(Option::is_none) {
            return done;
        }

        // The step of all lanes, in one loop so that the binary contains the equations of motion once.
        let slopes_before = slopes;
        let (mut start, mut end, mut at) = (state, state, state);
        let (mut h, mut stiff, mut at_start) = (still, [still; 4], (still, still));
        for (stage, part) in STAGES.into_iter().enumerate() {
            let motion = Motion::new(b, &at);
            let measured = readings(conditions, &motion.actual, initial);
            if stage == 0 {
                // The pitch solved from roll and steer, not the predicted one.
                start.pitch = motion.pose.attitude.pitch;
                (end, at_start, stiff) = (start, measured, stiffness(b, &motion));
                h = steps(conditions, &lanes, &stiff);
            } else {
                let per_s = Lanes([1.0; N]) / (h * part);
                slopes = [(measured.0 - at_start.0) * per_s, (measured.1 - at_start.1) * per_s];
            }
            let steer = source.torques(measured, slopes);
            let acc = motion.accelerations(b, &Torques { roll: still, steer });
            let k = rate(&at, &motion, &acc);
            end = end.after(h * WEIGHT[stage], &k);
            at = start.after(h * AHEAD[stage], &k);
        }

        for (lane, slot) in lanes.iter_mut().enumerate() {
            let Some(ride) = slot else { continue };
            let (before, h) = (start.lane(lane), h.0[lane]);
            let mut after = end.lane(lane);
            if nearer(stiff.map(|q| q.0[lane]), NEAREST) {
                let from = ride.full.unwrap_or_else(|| six_speeds(b, &before));
                let mut slope = slopes_before.map(|slope| slope.0[lane]);
                ride.full = source.full_step(conditions, &from, h, (initial.0[lane], &mut slope));
                (slopes[0].0[lane], slopes[1].0[lane]) = (slope[0], slope[1]);
                after = ride.full.map_or(State { rear_wheel_rate: f64::NAN, ..before }, |next| next.state());
                end.set_lane(lane, &after);
            } else {
                ride.full = None;
            }
            ride.steps += 1;
            let ended = match ride.book(conditions, (&before, &after), h) {
                None if ride.steps >= most_steps => Some(None),
                None => ride.decide_early(conditions, forecast, &after, initial.0[lane]).map(Some),
                ended => ended,
            };
            if let Some(outcome) = ended {
                done[ride.index] = QuickRide { outcome, steps: ride.steps };
                *slot = None;
            }
        }
        state = end;
    }
}

/// The steps of all lanes \[s\].
#[inline(always)]
fn steps<const N: usize>(
    conditions: &Conditions,
    lanes: &[Option<Lane>; N],
    stiff: &[Lanes<N>; 4],
) -> Lanes<N> {
    let mut h = Lanes([LONGEST_S; N]);
    for (i, ride) in lanes.iter().enumerate() {
        let Some(ride) = ride else { continue };
        let [squares, cos_roll, ..] = stiff.map(|q| q.0[i]);
        let scale_s = LARGEST * cos_roll.abs() / squares.sqrt();
        let left_s = conditions.time_limit_s - ride.t;
        h.0[i] = scale_s.clamp(SHORTEST_S, LONGEST_S).min(left_s);
    }
    h
}

/// The state with its dependent speeds.
#[inline(never)]
fn six_speeds(b: &Geometry, state: &State<f64>) -> FullState {
    FullState::new(&Motion::new(b, state), state)
}

impl Source<'_> {
    /// The steer torques at a stage \[N m\], from roll rate and speed and their slopes over time.
    #[inline(always)]
    fn torques<const N: usize>(
        &self,
        (rate, speed): (Lanes<N>, Lanes<N>),
        slopes: [Lanes<N>; 2],
    ) -> Lanes<N> {
        Lanes(std::array::from_fn(|lane| {
            self.torque((rate.0[lane], speed.0[lane]), slopes.map(|slope| slope.0[lane]))
        }))
    }

    /// The steer torque of one ride \[N m\].
    #[inline(always)]
    fn torque(&self, (rate, speed): (f64, f64), slope: [f64; 2]) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Ideal(law, delay_s) => law.torque_nm(rate - delay_s * slope[0], speed - delay_s * slope[1]),
            Self::Own(law) => law.torque_nm(rate, speed),
        }
    }

    /// One Runge-Kutta step with six speeds; `slope` as in [`Self::torques`].
    fn full_step(
        &self,
        conditions: &Conditions,
        from: &FullState,
        h: f64,
        (initial, slope): (f64, &mut [f64; 2]),
    ) -> Option<FullState> {
        let b: &Geometry = &conditions.bicycle;
        let mut stages = Stages::new(*from);
        let at_start = readings(conditions, &from.velocities(b), initial);
        for (stage, part) in STAGES.into_iter().enumerate() {
            let measured = readings(conditions, &stages.at.velocities(b), initial);
            if stage > 0 {
                let elapsed_s = h * part;
                *slope = [(measured.0 - at_start.0) / elapsed_s, (measured.1 - at_start.1) / elapsed_s];
            }
            let steer = self.torque(measured, *slope);
            let k = stages.at.rate(b, &Torques { roll: 0.0, steer })?;
            stages.next(stage, h, &k);
        }
        Some(stages.end)
    }
}

impl Lane {
    fn new(index: usize) -> Self {
        Self {
            index,
            t: 0.0,
            steps: 0,
            peak: [0.0; 2],
            late: [0.0; 2],
            flat_s: None,
            full: None,
            forecast_s: 0.0,
        }
    }

    /// Records a step of `h` seconds; the outcome if the ride has ended, or `Some(None)` if it is not decided.
    fn book(
        &mut self,
        conditions: &Conditions,
        (before, after): (&State<f64>, &State<f64>),
        h: f64,
    ) -> Option<Option<Outcome>> {
        if fallen(&conditions.fall, after) {
            let (tau, by) = time_of_fall(&conditions.fall, (before, after), h);
            return Some(Some(Outcome::Fallen { time_s: self.t + tau, by }));
        }
        self.t += h;
        let angles = [after.roll.abs(), after.steer.abs()];
        // The exact ride's last second begins with the end of its first control period.
        let since_s = self.t - (conditions.time_limit_s - 1.0 + conditions.step_s);
        for (i, (angle, before)) in angles.into_iter().zip([before.roll, before.steer]).enumerate() {
            self.peak[i] = self.peak[i].max(angle);
            if since_s >= 0.0 {
                let at_begin = angle + (before.abs() - angle) * (since_s / h).min(1.0);
                self.late[i] = self.late[i].max(angle).max(at_begin);
            }
        }
        let over = self.t >= conditions.time_limit_s - 1e-9;
        if let Some(flat) = conditions.fall.flat {
            let beyond = angles[0] > flat.roll_rad;
            if beyond && self.flat_s.is_none() {
                // The exact ride counts from the end of the control period in which the angle is passed.
                let part = (flat.roll_rad - before.roll.abs()) / (angles[0] - before.roll.abs());
                let passed = self.t - h * (1.0 - part.clamp(0.0, 1.0));
                self.flat_s = Some((passed / conditions.step_s).ceil() * conditions.step_s);
            }
            if let Some(since) = self.flat_s {
                let by = FallCause::LaidFlat;
                if self.t >= since + flat.lasting_s {
                    return Some(Some(Outcome::Fallen { time_s: since + flat.lasting_s, by }));
                }
                if over && !beyond {
                    return Some(Some(Outcome::Fallen { time_s: conditions.time_limit_s, by }));
                }
            }
        }
        over.then(|| Outcome::of_amplitudes(conditions.recovered_below, self.late, self.peak, CLEAR))
    }

    /// The outcome by the linear model, if the motion is small and the model decides.
    fn decide_early(
        &mut self,
        conditions: &Conditions,
        forecast: &Option<Forecast>,
        state: &State<f64>,
        initial_m_s: f64,
    ) -> Option<Outcome> {
        let forecast = forecast.as_ref()?;
        if self.t < self.forecast_s || self.flat_s.is_some() || !Forecast::covers(state) {
            return None;
        }
        self.forecast_s = self.t + Forecast::INTERVAL_S;
        let (late, peak) = forecast.amplitudes(state, initial_m_s, conditions.time_limit_s - self.t)?;
        let larger = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        let (late, peak) = (larger(self.late, late), larger(self.peak, peak));
        forecast.outcome(conditions.recovered_below, late, peak)
    }
}
