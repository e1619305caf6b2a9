//! Exact sensors compared with the bicycle's path in space.

use nalgebra::{Rotation3, Vector3};
use sim_host::bicycle::{Geometry, Motion, State};
use sim_host::plant::{Frame, Odometry, Reading};
use sim_host::ride::Imu;
use tests::rides::{FREE, knocked, ride, shipped};

const PERIOD_S: f64 = 1e-3;
const IMU_M: [f64; 3] = [0.5, 0.1, -0.3];

/// Position of the rear frame: attitude from the ground, position of the IMU, and heading and offset.
struct Place {
    attitude: Rotation3<f64>,
    imu: Vector3<f64>,
    heading: f64,
    lateral: f64,
}

/// The positions of a ride every `PERIOD_S / fine` seconds: path of the rear contact by the trapezoidal rule, the
/// rest by Euler angles.
fn places(b: &Geometry, start: State<f64>, fine: usize, periods: usize) -> Vec<Place> {
    let h = PERIOD_S / fine as f64;
    let mut before: Option<[f64; 3]> = None;
    let [mut heading, mut ahead, mut lateral] = [0.0; 3];
    let mut places = Vec::new();
    ride(b, start, &FREE, h, fine * periods, |s| {
        let motion = Motion::new(b, s);
        let (v, pitch) = (&motion.actual, motion.pose.attitude.pitch);
        if let Some([yaw_rate, ..]) = before {
            heading += 0.5 * h * (yaw_rate + v.yaw);
        }
        let speed = -(v.pitch + v.rear_spin) * b.rR;
        let velocity = [speed * heading.cos(), speed * heading.sin()];
        if let Some([_, x, y]) = before {
            ahead += 0.5 * h * (x + velocity[0]);
            lateral += 0.5 * h * (y + velocity[1]);
        }
        before = Some([v.yaw, velocity[0], velocity[1]]);
        let about = |axis: Vector3<f64>, angle: f64| Rotation3::from_scaled_axis(axis * angle);
        let leaned = about(Vector3::z(), heading) * about(Vector3::x(), s.roll);
        let attitude = leaned * about(Vector3::y(), pitch);
        let axle = Vector3::new(ahead, lateral, 0.0) + leaned * Vector3::new(0.0, 0.0, -b.rR);
        places.push(Place { attitude, imu: axle + attitude * Vector3::from(IMU_M), heading, lateral });
    });
    places
}

/// Situation: the benchmark bicycle after a knock at 5 m/s, 2 s of riding with roll, steer, pitch and yaw.
/// Action: read the exact sensors every millisecond.
/// Must hold: gyro and accelerometer are the numerical derivatives, in a fiftieth of the period, of the IMU's
/// position and attitude in space; heading and offset are the integrated ones. The rates and forces are not
/// negligible.
#[test]
fn exact_sensors_are_those_of_the_path() {
    const FINE: usize = 50;
    const PERIODS: usize = 2000;
    let b = Geometry::new(&shipped("benchmark").parameters);
    let start = knocked(&b, 5.0, 2.0);
    let places = places(&b, start, FINE, PERIODS);
    let h = PERIOD_S / FINE as f64;
    let mut odometry = Odometry::default();
    let (mut worst, mut largest, mut index) = ([0.0_f64; 4], [0.0_f64; 4], 0);
    ride(&b, start, &FREE, PERIOD_S, PERIODS, |s| {
        let motion = Motion::new(&b, s);
        let frame = Frame::new(&motion.pose, &motion.actual, s.steer);
        let r = odometry.read(&b, Imu::Body, IMU_M, PERIOD_S, &frame);
        let at = index * FINE;
        index += 1;
        if at == 0 || at + FINE >= places.len() {
            return;
        }
        let p = &places[at];
        // The antisymmetric part of a small rotation.
        let turn = |from: usize| {
            let r = (places[from].attitude.inverse() * places[from + 1].attitude).into_inner();
            Vector3::new(r.m32 - r.m23, r.m13 - r.m31, r.m21 - r.m12) / (2.0 * h)
        };
        let gyro = 0.5 * (turn(at - 1) + turn(at));
        let velocity = |at: usize| (places[at + 1].imu - places[at - 1].imu) / (2.0 * h);
        let middle = places[at - FINE / 2].attitude.inverse();
        let change = if at > FINE { velocity(at) - velocity(at - FINE) } else { Vector3::zeros() };
        let accel = middle * (change / PERIOD_S - Vector3::new(0.0, 0.0, b.g));
        let errors = [
            (gyro - Vector3::from(r.gyro_rad_s)).amax(),
            if at > FINE { (accel - Vector3::from(r.accel_m_s2)).amax() } else { 0.0 },
            (r.heading_rad - p.heading).abs(),
            (r.lateral_m - p.lateral).abs(),
        ];
        let sizes = [gyro.amax(), (accel + Vector3::z() * b.g).amax(), p.heading.abs(), p.lateral.abs()];
        worst = std::array::from_fn(|i| worst[i].max(errors[i]));
        largest = std::array::from_fn(|i| largest[i].max(sizes[i]));
        assert_eq!((r.steer_rad, r.steer_rate_rad_s), (s.steer, s.steer_rate));
        assert_eq!(r.rear_wheel_m_s, s.rear_wheel_rate * -b.rR);
        assert_eq!(r.front_wheel_m_s, motion.actual.front_spin * -b.rF);
    });
    println!("worst {worst:?} of {largest:?}");
    for (worst, most) in worst.into_iter().zip([1e-6, 2e-4, 2e-6, 2e-5]) {
        assert!(worst > 0.0 && worst < most, "{worst:e} {most:e}");
    }
    assert!(largest[0] > 0.5 && largest[1] > 1.0 && largest[2] > 0.2 && largest[3] > 0.2, "{largest:?}");
}

/// Situation: a steady straight ride, and a frame at rest leant over by 0.3 rad.
/// Action: read.
/// Must hold: straight, the reading is [`Reading::steady`]'s; leant over, the accelerometer measures gravity only, to
/// its left and up.
#[test]
fn steady_riding_shows_gravity_only() {
    let b = Geometry::new(&shipped("rigid_jason").parameters);
    let read = |odometry: &mut Odometry, state: &State<f64>| {
        let motion = Motion::new(&b, state);
        odometry.read(&b, Imu::Euler, IMU_M, PERIOD_S, &Frame::new(&motion.pose, &motion.actual, 0.0))
    };
    let mut odometry = Odometry::default();
    let steady = Reading::steady(4.0, b.g);
    for _ in 0..3 {
        let r = read(&mut odometry, &State::upright(&b, 4.0));
        let error = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        assert!(
            error(r.accel_m_s2, steady.accel_m_s2) < 1e-12 && error(r.gyro_rad_s, steady.gyro_rad_s) == 0.0
        );
        assert!((r.front_wheel_m_s - 4.0).abs() < 1e-14 && (r.rear_wheel_m_s - 4.0).abs() < 1e-14);
        assert_eq!((r.heading_rad, r.lateral_m), (0.0, 0.0));
    }
    let leant = State { roll: 0.3, ..State::upright(&b, 0.0) };
    let pitch = sim_host::bicycle::pitch_from_upright(&b, 0.3, 0.0).expect("stands");
    let [x, y, z] = read(&mut Odometry::default(), &State { pitch, ..leant }).accel_m_s2;
    assert!((y + b.g * 0.3_f64.sin()).abs() < 1e-9 && (z + b.g * 0.3_f64.cos()).abs() < 1e-3, "{x} {y} {z}");
}

/// Situation: the same motion, x by the Euler angle or by the gyro.
/// Must hold: they differ by yaw rate times sine of pitch, and nothing else does.
#[test]
fn the_published_roll_rate_is_the_euler_angles() {
    let b = Geometry::new(&shipped("rigid_jason").parameters);
    let pitch = sim_host::bicycle::pitch_from_upright(&b, 0.4, 0.6).expect("stands");
    let upright = State::upright(&b, 3.0);
    let state = State { roll: 0.4, steer: 0.6, roll_rate: 0.7, steer_rate: -1.0, pitch, ..upright };
    let motion = Motion::new(&b, &state);
    let frame = Frame::new(&motion.pose, &motion.actual, state.steer);
    let [euler, body] =
        [Imu::Euler, Imu::Body].map(|imu| Odometry::default().read(&b, imu, IMU_M, PERIOD_S, &frame));
    assert_eq!(euler.gyro_rad_s[0], 0.7);
    let v = &motion.actual;
    let expected = v.roll * pitch.cos() - v.yaw * state.roll.cos() * pitch.sin();
    assert!((body.gyro_rad_s[0] - expected).abs() < 1e-12 && (body.gyro_rad_s[0] - 0.7).abs() > 1e-3);
    assert_eq!(Reading { gyro_rad_s: euler.gyro_rad_s, ..body }, euler);
}
