//! Sensitivity of the height of the basin to gains and bicycle parameters.

use sim_host::basin::{Axis, Method, Quantity, Search, border, sensitivities};
use sim_host::bicycle::{self, Geometry, Parameters};
use sim_host::ride::Conditions;
use sim_host::rider::{Fit, KEYS, Outside, Schedule, catalogue};
use tests::basins::alone;
use tests::rides::shipped;

const SPEED: f64 = 4.3;

fn height(conditions: &Conditions) -> f64 {
    let search = Search {
        speeds: vec![SPEED],
        axis: Axis::SteerRate,
        max_rate: 15.0,
        scan_step: 0.25,
        tolerance: 1e-4,
        method: Method::Fast,
        efforts: false,
    };
    border(conditions, &search, SPEED).upper
}

/// Situation: the old cyclist at 4.3 m/s.
/// Action: find the sensitivity of the height to a gain and to a parameter of the bicycle; and each from two whole
/// basin searches with the quantity 1 % less and more.
/// Must hold: both give the same elasticity, which is not zero; quantities on which the height cannot depend do not
/// exist: all seven gains, three of the body, 26 of the bicycle.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn elasticities_are_those_of_whole_searches() {
    let parameters = shipped("rigid_jason").parameters;
    let table = catalogue::load("smart").unwrap_or_else(|e| panic!("{e}"));
    let rider = table.rider(Fit::Mean, Outside::Extrapolate, None).expect("a rider");
    assert_eq!(Quantity::all(&rider).len(), 7 + 3 + 26);
    let conditions = Conditions { rider: Some(rider.clone()), ..alone() };
    let gain = KEYS.iter().position(|k| *k == "K_phi_dd").expect("a gain");
    let mass = bicycle::KEYS.iter().position(|k| *k == "zB").expect("a parameter");
    let with_gain = |factor: f64| {
        let mut points = rider.schedule.points().to_vec();
        points.iter_mut().for_each(|(_, gains)| gains.0[gain] *= factor);
        let schedule = Schedule::new(points, Outside::Extrapolate).expect("a schedule");
        Conditions { rider: Some(sim_host::rider::Rider { schedule, ..rider.clone() }), ..conditions.clone() }
    };
    let with_mass = |factor: f64| {
        let mut values = parameters.to_values();
        values[mass] *= factor;
        Conditions { bicycle: Geometry::new(&Parameters::from_values(&values)), ..conditions.clone() }
    };
    let quantities = [Quantity::Gain(gain), Quantity::Bicycle(mass)];
    let found = sensitivities(&conditions, &parameters, &quantities, SPEED, 1e-4).expect("can be done");
    let base = height(&conditions);
    let pairs = [[with_gain(0.99), with_gain(1.01)], [with_mass(0.99), with_mass(1.01)]];
    for (sensitivity, [low, high]) in found.iter().zip(pairs) {
        let direct = (height(&high) - height(&low)) / 0.02 / base;
        let (name, elasticity) = (sensitivity.quantity.name(), sensitivity.elasticity());
        println!("{name}: elasticity {elasticity:+.3}, by whole searches {direct:+.3}");
        assert!((elasticity - direct).abs() < 0.01, "{name}: {elasticity} against {direct}");
        assert!(elasticity.abs() > 0.05, "{name}: {elasticity}");
    }
}
