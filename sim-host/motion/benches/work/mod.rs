//! The work that is counted and timed.
#![allow(dead_code)]

use control::{Config, Law, Plan, SensorFrame, step};
use motion::bicycle::{Geometry, State, Torques, pitch_from_upright};
use motion::ride::{Assist, Conditions, Start, accelerations, frames, traced};
use physics::basin::{Axis, Basin, Method, Search, basin};
use physics::bicycle::catalogue;
use std::hint::black_box;

/// Rides that are counted together.
pub(crate) const WIDTH: usize = 8;

/// The bicycle of the thesis.
pub(crate) fn bicycle() -> Geometry {
    Geometry::new(&catalogue::load("rigid_jason").expect("it ships").parameters)
}

/// Law h by the control crate at 1 kHz, without limits.
pub(crate) fn conditions() -> Conditions {
    let plan = Config::thesis(Law::H { cut: false }).plan().expect("in range");
    Conditions::thesis(bicycle(), Assist::Firmware(Box::new(plan)))
}

/// Eight rides that do not fall.
pub(crate) fn starts() -> [Start; WIDTH] {
    std::array::from_fn(|lane| Axis::SteerRate.start(5.0, (lane + 1) as f64))
}

/// States all over a ride.
pub(crate) fn states(b: &Geometry, count: usize) -> Vec<State<f64>> {
    let one = |i: usize| {
        let t = i as f64 * 1e-2;
        let (roll, steer) = (0.5 * libm::sin(1.7 * t), 0.7 * libm::sin(2.3 * t));
        State {
            roll,
            steer,
            roll_rate: 2.0 * libm::cos(3.1 * t),
            steer_rate: 4.0 * libm::cos(0.7 * t),
            rear_wheel_rate: -10.0 - t,
            pitch: pitch_from_upright(b, roll, steer).expect("both wheels reach the ground"),
        }
    };
    (0..count).map(one).collect()
}

/// The right-hand side at each state, as many side by side as in the rides.
pub(crate) fn right_hand_sides(b: &Geometry, states: &[State<f64>]) {
    black_box(accelerations(b, black_box(states), &Torques { roll: 0.0, steer: 1.0 }));
}

/// A small basin by the fast search: seven speeds, coarse.
pub(crate) fn small_basin(conditions: &Conditions) -> Basin {
    let search = Search {
        speeds: (2..9).map(f64::from).collect(),
        axis: Axis::SteerRate,
        max_rate: 12.0,
        scan_step: 0.5,
        tolerance: 0.1,
        method: Method::Fast,
        efforts: false,
    };
    basin(conditions, &search, |_| (), || false).expect("in range")
}

/// A controller and the sensor frames of its ride.
pub(crate) struct Controller {
    plan: Plan,
    state: control::State,
    frames: Vec<SensorFrame>,
}

impl Controller {
    /// A controller that has ridden up to the last `count` periods of a ride of 6 s.
    pub(crate) fn new(config: Config, count: usize) -> Self {
        let plan = config.plan().expect("in range");
        let conditions = Conditions::thesis(bicycle(), Assist::Firmware(Box::new(plan.clone())));
        let start = Axis::SteerRate.start(4.0, 3.0);
        let mut frames = frames(&conditions, start, &traced(&conditions, start).1);
        let rest = frames.split_off(frames.len() - count);
        let mut state = control::State::default();
        for frame in &frames {
            step(&plan, &mut state, frame);
        }
        assert_eq!(state.authority(), 1.0, "it assists");
        Self { plan, state, frames: rest }
    }

    /// The last control steps.
    pub(crate) fn steps(&mut self) {
        for frame in &self.frames {
            black_box(step(&self.plan, &mut self.state, black_box(frame)));
        }
    }
}
