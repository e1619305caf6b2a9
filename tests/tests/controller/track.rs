//! A balanced bicycle returns to its path, and path tracking has the lowest priority.

use control::Law;
use control::law::path_tracking::{
    PathError, PathTracking, PathTrackingState, TRACK_POINTS, TrackingInput, step,
};
use control::safety::limits::ActiveLimits;
use proptest::prelude::*;
use sim_host::bicycle::{Geometry, Motion, Parameters, State, Torques, catalogue};
use sim_host::integrate::rk4;
use sim_host::tracking::{Weights, gains, on_path};

const H: f64 = 1e-3;
const LAW: Law = Law::H { cut: true };

fn bicycle() -> Parameters {
    catalogue::load("rigid_jason").expect("ships").parameters
}

/// One instant of a ride along a straight path.
#[derive(Clone, Copy, Debug)]
struct Point {
    t: f64,
    lateral: f64,
    roll: f64,
    tracking: f64,
}

/// 12 s of the nonlinear bicycle, hands off, under the law within 7 N m and, if given, path tracking.
fn ride(speed: f64, from: PathError, track: Option<&PathTracking>) -> Vec<Point> {
    let b = Geometry::new(&bicycle());
    let mut state = State::upright(&b, speed);
    let (mut heading, mut lateral) = (f64::from(from.heading_rad), f64::from(from.lateral_m));
    let mut tracked = PathTrackingState::default();
    let mut points = Vec::new();
    for i in 0..12_000 {
        let motion = Motion::new(&b, &state);
        let now = &motion.actual;
        let (front, rear) = (-now.front_spin * b.rF, -now.rear_spin * b.rR);
        let mut torque = LAW.gain(front as f32) * now.roll as f32;
        let input = TrackingInput {
            roll_rad: state.roll as f32,
            steer_rad: state.steer as f32,
            roll_rate_rad_s: now.roll as f32,
            steer_rate_rad_s: now.steer as f32,
            speed_m_s: rear as f32,
            path: Some(PathError { heading_rad: heading as f32, lateral_m: lateral as f32 }),
            authority: 1.0,
            elapsed_us: 1000,
            ..TrackingInput::default()
        };
        let tracking = track.map_or(0.0, |track| step(track, &mut tracked, &input));
        torque = (torque + tracking).clamp(-7.0, 7.0);
        points.push(Point { t: f64::from(i) * H, lateral, roll: state.roll, tracking: f64::from(tracking) });
        let mut torques = Torques { roll: 0.0, steer: f64::from(torque) };
        state = rk4(&b, &state, H, &mut torques);
        lateral += rear * heading.sin() * H;
        heading += now.yaw * H;
    }
    points
}

/// Time at which the lateral error was last larger than 5 cm \[s\].
fn settled(points: &[Point]) -> f64 {
    points.iter().rev().find(|p| p.lateral.abs() > 0.05).map_or(0.0, |p| p.t)
}

fn extremes(points: &[Point], of: fn(&Point) -> f64) -> (f64, f64) {
    points.iter().map(of).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)))
}

/// Situation: the nonlinear bicycle upright, 0.5 m to the right of its path and along it, 3 to 6 m/s, the law in the
/// loop, hands off.
/// Action: ride with path tracking.
/// Must hold: it first moves further away (a bicycle must countersteer), is within 5 cm after a time that is shorter
/// the faster it goes, overshoots by no more than 12 cm, and requests less than 1 N m.
#[test]
fn a_lateral_offset_decays() {
    for (speed, within_s) in [(3.0, 3.0..7.5), (4.0, 2.5..6.5), (5.0, 2.5..6.0), (6.0, 2.0..5.5)] {
        let points =
            ride(speed, PathError { heading_rad: 0.0, lateral_m: 0.5 }, Some(&PathTracking::default()));
        let ((left, right), torque) =
            (extremes(&points, |p| p.lateral), extremes(&points, |p| p.tracking.abs()).1);
        println!("{speed} m/s: {:.2} s, {left:.3} to {right:.3} m, {torque:.2} N m", settled(&points));
        assert!(within_s.contains(&settled(&points)), "{speed}: {}", settled(&points));
        assert!((0.505..0.56).contains(&right) && (-0.12..-0.01).contains(&left), "{speed}: {left} {right}");
        assert!((0.3..1.0).contains(&torque), "{speed}: {torque}");
    }
}

/// Situation: the same, on the path but with a heading of 0.1 rad to the right of it.
/// Action: ride.
/// Must hold: the same, with a deviation no larger than the distance of 1.5 s at that angle.
#[test]
fn a_heading_error_decays() {
    for (speed, within_s) in [(3.0, 3.0..8.0), (4.0, 3.0..7.0), (5.0, 2.5..6.5), (6.0, 2.0..6.0)] {
        let points =
            ride(speed, PathError { heading_rad: 0.1, lateral_m: 0.0 }, Some(&PathTracking::default()));
        let ((left, right), torque) =
            (extremes(&points, |p| p.lateral), extremes(&points, |p| p.tracking.abs()).1);
        println!("{speed} m/s: {:.2} s, {left:.3} to {right:.3} m, {torque:.2} N m", settled(&points));
        assert!(within_s.contains(&settled(&points)), "{speed}: {}", settled(&points));
        assert!(
            (0.05 * speed..0.15 * speed).contains(&right) && (-0.12..-0.01).contains(&left),
            "{speed}: {left} {right}"
        );
        assert!((0.5..1.5).contains(&torque), "{speed}: {torque}");
    }
}

/// Situation: as above without path tracking, and 5 m off with it.
/// Action: ride.
/// Must hold: without, it stays off; with, it approaches at a bounded angle, never beyond its own torque, and rolls
/// by less than 15 degrees.
#[test]
fn large_errors_are_approached_with_care() {
    let off = ride(4.0, PathError { heading_rad: 0.0, lateral_m: 0.5 }, None);
    assert!(settled(&off) > 11.9 && off.iter().all(|p| p.tracking == 0.0));
    let far = ride(5.0, PathError { heading_rad: 0.0, lateral_m: 5.0 }, Some(&PathTracking::default()));
    let roll = extremes(&far, |p| p.roll.abs()).1.to_degrees();
    let torque = extremes(&far, |p| p.tracking.abs()).1;
    assert!((2.0..15.0).contains(&roll) && (0.8..2.0001).contains(&torque), "{roll} {torque}");
    assert!(far.last().is_some_and(|p| p.lateral.abs() < 1.0), "{:?}", far.last());
}

/// Situation: the table of gains.
/// Action: compute it again.
/// Must hold: equal to the third decimal; and at every speed from 2 to 8 m/s, between the points too, the linear
/// bicycle with it returns with a time constant below 10 s.
#[test]
fn the_gains_are_the_computed_ones() {
    let (parameters, track) = (bicycle(), PathTracking::default());
    let computed = |v: f64| gains(&parameters, v, LAW.gain(v), &Weights::default());
    track.speed_m_s.iter().for_each(|v| println!("{v} m/s: {:.3}", computed(f64::from(*v))));
    for (speed, row) in track.speed_m_s.iter().zip(&track.gains) {
        let v = f64::from(*speed);
        for (typed, computed) in row.iter().zip(computed(v).iter()) {
            assert!((f64::from(*typed) - computed).abs() < 1e-3, "{v} m/s: {typed} {computed}");
        }
    }
    for i in 0..=24 {
        let v = 2.0 + 0.25 * f64::from(i);
        let place = (v / 2.0 - 1.0).min(TRACK_POINTS as f64 - 1.001);
        let (at, part) = (place as usize, place.fract());
        let (a, b) = on_path(&parameters, v, LAW.gain(v));
        let mut closed = a;
        for j in 0..7 {
            let [low, high] = [at, at + 1].map(|k| f64::from(track.gains[k][j]));
            let column = closed.column(j) - b * (low + (high - low) * part);
            closed.set_column(j, &column);
        }
        let slowest = closed.complex_eigenvalues().iter().map(|z| z.re).fold(f64::MIN, f64::max);
        assert!((-1.0..-0.1).contains(&slowest), "{v} m/s: {slowest}");
    }
}

/// At 5 m/s, 0.5 m off.
fn input() -> TrackingInput {
    let path = Some(PathError { heading_rad: 0.0, lateral_m: 0.5 });
    TrackingInput { speed_m_s: 5.0, path, authority: 1.0, elapsed_us: 1000, ..TrackingInput::default() }
}

/// The torques of a sequence of inputs, each for a number of steps.
fn torques(sequence: &[(usize, TrackingInput)]) -> Vec<f32> {
    let (track, mut state) = (PathTracking::default(), PathTrackingState::default());
    let all = sequence.iter().flat_map(|(steps, input)| std::iter::repeat_n(*input, *steps));
    all.map(|input| step(&track, &mut state, &input)).collect()
}

/// Situation: path tracking with its whole torque; then the path is lost, the rider pushes, a limit of the rider
/// acts, permission ends, or the bicycle is slow.
/// Action: 400 steps.
/// Must hold: the torque fades to exactly zero over its 300 ms, not before half of them, never faster than its slew,
/// and returns when the cause is gone.
#[test]
fn tracking_fades_out() {
    for cause in [
        TrackingInput { path: None, ..input() },
        TrackingInput { path: Some(PathError { heading_rad: f32::NAN, lateral_m: 0.0 }), ..input() },
        TrackingInput { rider_torque_nm: Some(-3.1), ..input() },
        TrackingInput { acted: ActiveLimits::RIDER_MOTION, ..input() },
        TrackingInput { acted: ActiveLimits::RIDER_TORQUE, ..input() },
        TrackingInput { authority: 0.0, ..input() },
        TrackingInput { speed_m_s: 1.9, ..input() },
    ] {
        let all = torques(&[(500, input()), (400, cause), (500, input())]);
        assert!(all[499] > 0.5 && all[650] > 0.1 && all[850] == 0.0 && all[1399] > 0.5, "{cause:?}");
        assert!(all.windows(2).all(|w| (w[1] - w[0]).abs() < 0.0201));
    }
    let quiet = TrackingInput { rider_torque_nm: Some(2.9), ..input() };
    assert_eq!(torques(&[(500, quiet)]), torques(&[(500, input())]));
}

/// Situation: 0.5 m off for a minute, the bicycle at rest as if held; the same with a limit acting, and with half the
/// authority.
/// Action: step.
/// Must hold: the integral's torque grows to no more than its bound's 0.7 N m, and not at all where the torque is not
/// only that of path tracking.
#[test]
fn the_integral_has_no_windup() {
    let free = torques(&[(60_000, input())]);
    assert!((0.6..0.9).contains(&(free[59_999] - free[400])), "{}", free[59_999] - free[400]);
    for held in [
        TrackingInput { acted: ActiveLimits::MAGNITUDE, ..input() },
        TrackingInput { authority: 0.5, ..input() },
    ] {
        let all = torques(&[(60_000, held)]);
        assert_eq!(all[59_999].to_bits(), all[400].to_bits());
    }
    // Beyond its own torque, too: back from 2 N m without delay.
    let far = TrackingInput { roll_rad: 0.3, ..input() };
    let all = torques(&[(60_000, far), (200, input())]);
    assert_eq!(all[59_999], 2.0);
    assert!((all[60_199] - free[400]).abs() < 0.01, "{} {}", all[60_199], free[400]);
}

fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![4 => -2.0_f32..2.0, 1 => any::<u32>().prop_map(f32::from_bits)]
}

fn any_tracking_input() -> impl Strategy<Value = TrackingInput> {
    let path = proptest::option::weighted(0.9, (any_float(), any_float()))
        .prop_map(|path| path.map(|(heading_rad, lateral_m)| PathError { heading_rad, lateral_m }));
    let rider = proptest::option::weighted(0.2, any_float());
    let speed = prop_oneof![4 => 0.0_f32..10.0, 1 => any_float()];
    let elapsed = prop_oneof![4 => Just(1000_u32), 1 => any::<u32>()];
    ((any_float(), any_float(), any_float(), any_float()), speed, path, rider, any_float(), elapsed).prop_map(
        |(
            (roll_rad, steer_rad, roll_rate_rad_s, steer_rate_rad_s),
            speed_m_s,
            path,
            rider,
            authority,
            elapsed_us,
        )| TrackingInput {
            roll_rad,
            steer_rad,
            roll_rate_rad_s,
            steer_rate_rad_s,
            speed_m_s,
            path,
            rider_torque_nm: rider,
            acted: ActiveLimits::default(),
            authority,
            elapsed_us,
        },
    )
}

proptest! {
    /// Situation: any input.
    /// Action: step.
    /// Must hold: finite and within its own torque; mirrored, to the bit.
    #[test]
    fn any_input_gives_a_bounded_torque(sequence in proptest::collection::vec(any_tracking_input(), 1..300)) {
        let track = PathTracking::default();
        let (mut right, mut left) = (PathTrackingState::default(), PathTrackingState::default());
        for input in &sequence {
            let mirrored = TrackingInput {
                roll_rad: -input.roll_rad,
                steer_rad: -input.steer_rad,
                roll_rate_rad_s: -input.roll_rate_rad_s,
                steer_rate_rad_s: -input.steer_rate_rad_s,
                path: input.path.map(|p| PathError { heading_rad: -p.heading_rad, lateral_m: -p.lateral_m }),
                rider_torque_nm: input.rider_torque_nm.map(|t| -t),
                ..*input
            };
            let (a, b) = (step(&track, &mut right, input), step(&track, &mut left, &mirrored));
            prop_assert!(a.is_finite() && a.abs() <= track.max_torque_nm && a == -b, "{a} {b}");
        }
    }
}
