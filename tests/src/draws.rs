//! Random states, the same ones in every run.

use crate::rides::all_shipped;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use sim_host::bicycle::catalogue::Bicycle;
use sim_host::bicycle::{Geometry, Parameters, State, Torques, pitch_from_upright};

/// One situation of a shipped bicycle.
#[derive(Clone, Debug)]
pub struct Draw {
    /// The bicycle's name.
    pub name: String,
    /// Its parameters.
    pub parameters: Parameters,
    /// Its constants.
    pub geometry: Geometry,
    /// The state, its pitch solved.
    pub state: State<f64>,
    /// The applied torques.
    pub torques: Torques<f64>,
}

/// A runner of `cases` cases from a fixed seed.
pub fn runner(cases: u32) -> TestRunner {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha))
}

/// Any shipped bicycle in any of [`situations_of`].
pub fn situations(angle: f64) -> impl Strategy<Value = Draw> {
    select(all_shipped()).prop_flat_map(move |bicycle| situations_of(bicycle, angle))
}

/// Roll and steer up to `angle` \[rad\], rates up to 5 rad/s, speeds from -3 to 10 m/s, torques up
/// to 50 N m in roll and 10 N m at the steer. Attitudes in which the front wheel can't be put on the
/// ground are left out.
pub fn situations_of(bicycle: Bicycle, angle: f64) -> impl Strategy<Value = Draw> {
    let (angles, rates) = (-angle..angle, -5.0..5.0);
    let state = (angles.clone(), angles, rates.clone(), rates, -3.0..10.0);
    let torques = (-50.0..50.0, -10.0..10.0);
    (state, torques).prop_filter_map("no pitch", move |(state, torques)| {
        let (roll, steer, roll_rate, steer_rate, v): (_, _, _, _, f64) = state;
        let parameters = bicycle.parameters;
        let geometry = Geometry::new(&parameters);
        let pitch = pitch_from_upright(&geometry, roll, steer)?;
        let rear_wheel_rate = -v / parameters.rR;
        let state = State { roll, steer, roll_rate, steer_rate, rear_wheel_rate, pitch };
        let torques = Torques { roll: torques.0, steer: torques.1 };
        Some(Draw { name: bicycle.name.clone(), parameters, geometry, state, torques })
    })
}
