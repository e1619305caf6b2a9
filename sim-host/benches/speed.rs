//! How fast: `cargo bench -p sim-host`. Figures of one machine stand in docs/performance.md.

use control::{Config, Law};
use divan::{Bencher, black_box};
use sim_host::basin::{Axis, Method, Search, basin};
use sim_host::bicycle::{Geometry, Motion, State, Torques, catalogue, pitch_from_upright};
use sim_host::integrate::rk4;
use sim_host::ride::{Assist, Conditions, Start, frames, rides, traced};
use sim_host::rider::{self, Fit, Outside};

fn main() {
    divan::main();
}

fn thesis_bicycle() -> Geometry {
    Geometry::new(&catalogue::load("rigid_jason").expect("it ships").parameters)
}

fn flashed() -> Conditions {
    let plan = Config::thesis(Law::H { cut: false }).plan().expect("in range");
    Conditions::thesis(thesis_bicycle(), Assist::Firmware(Box::new(plan)))
}

/// The young rider, 30 ms late, by linear regression, without assist.
fn ridden() -> Conditions {
    let young = rider::catalogue::load("young").expect("it ships");
    let young = young.rider(Fit::Regression, Outside::Extrapolate, None).expect("in range");
    Conditions { rider: Some(young), ..Conditions::thesis(thesis_bicycle(), Assist::None) }
}

/// States all over a ride, so that nothing can be computed once for all.
fn states(b: &Geometry) -> Vec<State<f64>> {
    (0..1000)
        .map(|i| {
            let t = f64::from(i) * 1e-2;
            let (roll, steer) = (0.5 * libm::sin(1.7 * t), 0.7 * libm::sin(2.3 * t));
            State {
                roll,
                steer,
                roll_rate: 2.0 * libm::cos(3.1 * t),
                steer_rate: 4.0 * libm::cos(0.7 * t),
                rear_wheel_rate: -10.0 - t,
                pitch: pitch_from_upright(b, roll, steer).expect("both wheels reach the ground"),
            }
        })
        .collect()
}

/// A thousand right-hand sides, one bicycle at a time.
#[divan::bench]
fn right_hand_side_scalar_x1000(bencher: Bencher) {
    let b = thesis_bicycle();
    let states = states(&b);
    let torques = Torques { roll: 0.0, steer: 1.0 };
    bencher.bench_local(|| {
        for state in &states {
            black_box(Motion::new(&b, black_box(state)).accelerations(&b, &torques));
        }
    });
}

/// A thousand Runge-Kutta steps in a row, one bicycle: four right-hand sides each, each waiting for
/// the one before.
#[divan::bench]
fn runge_kutta_step_scalar_x1000(bencher: Bencher) {
    let b = thesis_bicycle();
    let start = State { steer_rate: 1.0, ..State::upright(&b, 7.0) };
    bencher.bench_local(|| {
        let mut state = black_box(start);
        for _ in 0..1000 {
            state = rk4(&b, &state, 1e-3, &mut Torques { roll: 0.0, steer: 0.0 });
        }
        black_box(state)
    });
}

fn eight_rides(bencher: Bencher, conditions: &Conditions) {
    let starts: Vec<Start> = (1..=8).map(|i| Axis::SteerRate.start(5.0, f64::from(i))).collect();
    bencher.bench_local(|| rides(conditions, black_box(&starts)));
}

/// Eight rides of 6 s abreast under the control crate: 8 x 24000 right-hand sides.
#[divan::bench]
fn eight_rides_of_6_s(bencher: Bencher) {
    eight_rides(bencher, &flashed());
}

/// The same with a delayed rider in place of the assist; the ride at 5 m/s keeps upright up to 8 rad/s.
#[divan::bench]
fn eight_rides_of_6_s_with_a_rider(bencher: Bencher) {
    eight_rides(bencher, &ridden());
}

/// The last thousand control steps of a ride of 6 s with the flashed configuration and every sensor.
#[divan::bench]
fn control_step_x1000(bencher: Bencher) {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    let plan = config.plan().expect("in range");
    let conditions = Conditions::thesis(thesis_bicycle(), Assist::Firmware(Box::new(plan.clone())));
    let start = Axis::SteerRate.start(4.0, 3.0);
    let mut before = frames(&conditions, start, &traced(&conditions, start).1);
    let last = before.split_off(before.len() - 1000);
    let mut ready = control::State::default();
    for frame in &before {
        control::step(&plan, &mut ready, frame);
    }
    assert_eq!(ready.authority(), 1.0, "it assists");
    bencher.bench_local(|| {
        let mut state = ready.clone();
        for frame in &last {
            black_box(control::step(&plan, &mut state, black_box(frame)));
        }
    });
}

/// The basin at tenths of m/s, up to 30 rad/s, within 0.01 rad/s, all cores.
fn whole_basin(bencher: Bencher, conditions: &Conditions, tenths: std::ops::RangeInclusive<u8>) {
    let search = Search {
        speeds: tenths.map(|i| f64::from(i) / 10.0).collect(),
        axis: Axis::SteerRate,
        max_rate: 30.0,
        scan_step: 0.25,
        tolerance: 0.01,
        method: Method::Fast,
        efforts: false,
    };
    bencher.bench_local(|| basin(conditions, &search, |_| (), || false));
}

/// 0 to 10 m/s under law h as flashed.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn basin_of_h(bencher: Bencher) {
    whole_basin(bencher, &flashed(), 0..=100);
}

/// 2 to 7.5 m/s with a delayed rider and no assist.
#[divan::bench(sample_count = 3, sample_size = 1)]
fn basin_of_the_young_rider(bencher: Bencher) {
    whole_basin(bencher, &ridden(), 20..=75);
}
