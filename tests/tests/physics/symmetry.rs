//! Left-right symmetry, equilibrium without disturbance, and proportionality of small deviations.

use proptest::prop_assert_eq;
use sim_host::bicycle::linear::Linear;
use sim_host::bicycle::{Geometry, Motion, State, Torques};
use sim_host::ride::accelerations;
use tests::draws::{runner, situations, situations_of};
use tests::rides::{FREE, all_shipped, knocked, ride, shipped};

/// The bits of an acceleration or a state, -0 counted as 0.
fn bits<const N: usize>(values: [f64; N]) -> [u64; N] {
    values.map(|x| (x + 0.0).to_bits())
}

fn mirrored(s: &State<f64>) -> State<f64> {
    State { roll: -s.roll, steer: -s.steer, roll_rate: -s.roll_rate, steer_rate: -s.steer_rate, ..*s }
}

fn entries(s: &State<f64>) -> [f64; 6] {
    [s.roll, s.steer, s.roll_rate, s.steer_rate, s.rear_wheel_rate, s.pitch]
}

#[test]
fn upright_and_straight_stays_so_exactly() {
    for bicycle in all_shipped() {
        let b = Geometry::new(&bicycle.parameters);
        for v in [-2.0, 0.0, 1.0, 5.0, 10.0] {
            let start = State::upright(&b, v);
            let end = ride(&b, start, &FREE, 1e-3, 6000, |s| {
                let lateral = [s.roll, s.steer, s.roll_rate, s.steer_rate];
                assert_eq!(lateral, [0.0; 4], "{} at {v} m/s", bicycle.name);
            });
            let change = (end.rear_wheel_rate - start.rear_wheel_rate).abs();
            assert!(change < 1e-10, "{} at {v} m/s: wheel rate changed by {change:e}", bicycle.name);
        }
    }
}

/// The responses to 1e-8 and 1e-7 of each kind differ by the factor 10, and are the linear model's.
#[test]
fn tiny_deviations_act_in_proportion() {
    let bicycle = shipped("benchmark").parameters;
    let (b, linear) = (Geometry::new(&bicycle), Linear::new(&bicycle));
    let deviations: [fn(f64, &mut State<f64>); 4] =
        [|x, s| s.roll = x, |x, s| s.steer = x, |x, s| s.roll_rate = x, |x, s| s.steer_rate = x];
    let mut worst = [0.0_f64; 2];
    for v in [2.0, 5.0, 8.0] {
        let matrix = linear.state_matrix(v, 0.0);
        for (column, deviate) in deviations.iter().enumerate() {
            let [small, large] = [1e-8, 1e-7].map(|size| {
                let mut start = State::upright(&b, v);
                deviate(size, &mut start);
                let a = Motion::new(&b, &start).accelerations(&b, &FREE);
                for (row, acceleration) in [(2, a.roll), (3, a.steer)] {
                    let off = (acceleration / size - matrix[(row, column)]).abs();
                    worst[0] = worst[0].max(off);
                    assert!(off < 1e-7, "{v} m/s, deviation {column} of {size}: {off:e}");
                }
                ride(&b, start, &FREE, 1e-3, 1000, |_| {})
            });
            for (small, large) in entries(&small)[..4].iter().zip(&entries(&large)[..4]) {
                let off = (large / small / 10.0 - 1.0).abs();
                worst[1] = worst[1].max(off);
                assert!(off < 1e-6, "{v} m/s, deviation {column}: ratio {:e}", large / small);
            }
        }
    }
    println!("against the linear model {:.1e}, ratio after 1 s off 10 by {:.1e}", worst[0], worst[1]);
}

#[test]
fn mirrored_states_accelerate_mirrored_to_the_bit() {
    runner(1000)
        .run(&situations(60_f64.to_radians()), |d| {
            let torques = Torques { roll: -d.torques.roll, steer: -d.torques.steer };
            let (b, mirror) = (&d.geometry, mirrored(&d.state));
            let here = Motion::new(b, &d.state).accelerations(b, &d.torques);
            let there = Motion::new(b, &mirror).accelerations(b, &torques);
            prop_assert_eq!(
                bits([here.roll, here.steer, here.rear_wheel]),
                bits([-there.roll, -there.steer, there.rear_wheel])
            );
            Ok(())
        })
        .unwrap();
}

#[test]
fn a_ride_knocked_to_the_left_mirrors_one_to_the_right_to_the_bit() {
    let b = Geometry::new(&shipped("rigid_jason").parameters);
    let path = |steer_rate: f64| {
        let mut path = Vec::new();
        ride(&b, knocked(&b, 8.0, steer_rate), &FREE, 1e-3, 6000, |s| path.push(*s));
        path
    };
    let (right, left) = (path(5.0), path(-5.0));
    assert_eq!(right.len(), 6001);
    assert!(right[6000].roll != 0.0);
    for (r, l) in right.iter().zip(&left) {
        assert_eq!(bits(entries(r)), bits(entries(&mirrored(l))));
    }
}

/// Many states side by side and one after the other: accelerations.
#[test]
fn lanes_have_the_bits_of_scalars() {
    let bicycle = shipped("rigid_jason");
    let b = Geometry::new(&bicycle.parameters);
    runner(200)
        .run(&proptest::array::uniform32(situations_of(bicycle, 60_f64.to_radians())), |draws| {
            let torques = draws[0].torques;
            let states = draws.map(|draw| draw.state);
            let together = accelerations(&b, &states, &torques);
            prop_assert_eq!(together.len(), states.len());
            for (state, together) in states.iter().zip(together) {
                let alone = Motion::new(&b, state).accelerations(&b, &torques);
                prop_assert_eq!(
                    [together.roll, together.steer, together.rear_wheel].map(f64::to_bits),
                    [alone.roll, alone.steer, alone.rear_wheel].map(f64::to_bits)
                );
            }
            Ok(())
        })
        .unwrap();
}
