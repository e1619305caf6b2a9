//! A delayed rider's ride and basin, timed beside Python programs of the same ride by `cargo xtask
//! bench`. Prints lines of name=value, those of `reference/ride.py`.

use sim_host::basin::{Axis, Method, Search, basin};
use sim_host::bicycle::{Geometry, catalogue};
use sim_host::ride::{Assist, Conditions, Ride, Start, rides, traced};
use sim_host::rider::{self, Fit, Outside};
use std::time::Instant;

/// The ride: at 4 m/s, steer rate 5 rad/s.
fn start() -> Start {
    Axis::SteerRate.start(4.0, 5.0)
}

fn main() {
    let parameters = catalogue::load("rigid_jason").expect("it ships").parameters;
    let young = rider::catalogue::load("young").expect("it ships");
    let young = young.rider(Fit::Regression, Outside::Extrapolate, Some(0.03)).expect("in range");
    let alone = Conditions::thesis(Geometry::new(&parameters), Assist::None);
    let conditions = Conditions { rider: Some(young), ..alone };

    report("scalar", 15, || vec![traced(&conditions, start()).0]);
    let starts: Vec<Start> = (1..=8).map(|i| Start { steer_rate_rad_s: f64::from(i), ..start() }).collect();
    report("eight", 15, || {
        let mut done = rides(&conditions, &starts);
        done.swap(0, 4);
        done
    });

    let search = Search {
        speeds: (20..=75).map(|i| f64::from(i) / 10.0).collect(),
        axis: Axis::SteerRate,
        max_rate: 30.0,
        scan_step: 0.25,
        tolerance: 0.01,
        method: Method::Fast,
        efforts: false,
    };
    let (seconds, found) = timed(3, || basin(&conditions, &search, |_| (), || false).expect("in range"));
    let work = found.work();
    println!(
        "name=basin median_s={} least_s={} rides={} right_hand_sides={} end=",
        seconds[1], seconds[0], work.rides, work.right_hand_sides
    );
}

/// Times `rides`, whose first one is the ride.
fn report(name: &str, times: usize, rides: impl Fn() -> Vec<Ride>) {
    let (seconds, done) = timed(times, rides);
    let (median, least) = (seconds[times / 2], seconds[0]);
    let right_hand_sides: u32 = done.iter().map(|ride| 4 * ride.steps).sum();
    let e = &done[0].end;
    println!(
        "name={name} median_s={median} least_s={least} rides={} right_hand_sides={right_hand_sides} end={},{},{},{},{}",
        done.len(),
        e.roll,
        e.steer,
        e.roll_rate,
        e.steer_rate,
        e.rear_wheel_rate
    );
}

/// Seconds of `times` runs, sorted, after one that warms up; the last result.
fn timed<X>(times: usize, run: impl Fn() -> X) -> (Vec<f64>, X) {
    let mut result = run();
    let mut seconds: Vec<f64> = (0..times)
        .map(|_| {
            let begin = Instant::now();
            result = run();
            begin.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    (seconds, result)
}
