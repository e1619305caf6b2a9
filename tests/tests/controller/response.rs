//! Sign checks of gyro and motor on the bicycle.

use control::{Cause, Config, Law, Limits, Mode, State};
use sim_host::bicycle::onboard;
use sim_host::plant::{Plant, Sensor};
use sim_host::ride::{Assist, Conditions, Start, frames, traced};
use sim_host::rider::{Fit, Outside, catalogue as riders};
use tests::basins::{alone, configured};

/// Law h without limits, as in the published basins, on a bicycle with every sensor and every check.
fn checked() -> Config {
    let mut config = Config { law: Law::H { cut: false }, limits: Limits::default(), ..Config::product() };
    config.calibration.polarity_checked = true;
    onboard::fit(&mut config, &alone().bicycle, Plant::default().sensors.imu.point_m);
    config
}

fn with_rider(name: Option<&str>, config: Config, plant: Plant) -> Conditions {
    let rider =
        name.map(|name| riders::load(name).unwrap().rider(Fit::Mean, Outside::Extrapolate, None).unwrap());
    Conditions { rider, plant, ..configured(config) }
}

/// A rough road and consumer sensors.
fn rough() -> Plant {
    let mut plant = Plant::default();
    plant.sensors.model_mut(Sensor::Gyro).noise = 0.02;
    plant.sensors.model_mut(Sensor::Accel).noise = 1.0;
    plant.sensors.model_mut(Sensor::Steer).noise = 0.001;
    plant.sensors.model_mut(Sensor::SteerRate).noise = 0.03;
    plant
}

/// Result of a ride.
#[derive(Debug)]
struct Outcomes {
    /// Least and largest gain of gyro and motor.
    slopes: [(f32, f32); 2],
    /// Time and kind of the first cause.
    first: Option<(f64, Cause)>,
    fell: bool,
    /// Whether torque may flow at the end.
    drives: bool,
}

fn outcomes_of(conditions: &Conditions, start: Start) -> Outcomes {
    let Assist::Firmware(plan) = &conditions.assist else { panic!() };
    let (outcome, trace) = traced(conditions, start);
    let mut state = State::default();
    let mut ranges = [(f32::MAX, f32::MIN); 2];
    for frame in frames(conditions, start, &trace) {
        let _ = control::step(plan, &mut state, &frame);
        for (range, slope) in ranges.iter_mut().zip(state.slopes()) {
            if let Some(slope) = slope {
                *range = (range.0.min(slope), range.1.max(slope));
            }
        }
    }
    let first = trace.iter().find(|p| p.causes != 0);
    let first = first.map(|p| (p.t, control::Causes(p.causes).iter().next().unwrap()));
    let last = trace.last().map(|p| p.mode);
    let drives = last == Some(Mode::Engaged as u8) || last == Some(Mode::Limp as u8);
    Outcomes { slopes: ranges, first, fell: outcome.fell(), drives }
}

const SPEEDS: [f64; 5] = [2.0, 3.0, 4.3, 5.5, 7.0];
const CREWS: [Option<&str>; 3] = [None, Some("young"), Some("smart")];

/// Knocks of the handlebar and of the roll \[rad/s\]; most rides recover.
const STARTS: [(f64, f64); 5] = [(0.5, 0.0), (2.0, 0.0), (5.0, 0.0), (0.0, 0.2), (0.0, 0.5)];

fn rides() -> Vec<(Option<&'static str>, Start)> {
    let mut rides = Vec::new();
    for crew in CREWS {
        for speed_m_s in SPEEDS {
            for (steer_rate_rad_s, roll_rate_rad_s) in STARTS {
                rides.push((crew, Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s }));
            }
        }
    }
    rides
}

/// Situation: all signs right, sensors exact or rough.
/// Action: ride.
/// Must hold: in every ride that does not fall no cause is reported. After a knock of the handlebar the gyro's gain
/// stays near 1; after a knock of the roll, which a gyro shows and the specific force at rest does not, it stays well
/// above the threshold; the motor's stays above 0. Both have a gain in many rides.
#[test]
fn right_signs_are_never_reported() {
    let mut wrong = Vec::new();
    let mut counts = [0, 0];
    for (name, plant, near) in [("exact", Plant::default(), 0.75), ("rough", rough(), 0.3)] {
        for (crew, start) in rides() {
            let ride = outcomes_of(&with_rider(crew, checked(), plant.clone()), start);
            if ride.fell {
                continue;
            }
            let [gyro, motor] = ride.slopes;
            for (count, (low, high)) in counts.iter_mut().zip(ride.slopes) {
                *count += usize::from(low <= high);
            }
            let least = if start.roll_rate_rad_s == 0.0 { near } else { -0.3 };
            if ride.first.is_some() || gyro.0 < least || motor.0 < 0.0 {
                wrong.push(format!("{name} {crew:?} {start:?}: {ride:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(counts[0] >= 80 && counts[1] > 30, "{counts:?} rides with a gain");
}

/// Situation: 20 ms after the knock a sign reverses permanently, and no sensor shows it by itself: an axis of the
/// IMU, all of the gyro, motor and its report together.
/// Action: ride with the flashed configuration.
/// Must hold: in a fall that would not have happened without assist there is no torque any more, except in one of
/// twenty; the intended check reports more than twenty, and half of the reports come within the stated time.
#[test]
fn a_reversed_sign_ends_without_torque() {
    let flashed = Config { law: Law::H { cut: true }, limits: Limits::product(), ..checked() };
    let alone =
        |crew| Conditions { assist: Assist::None, ..with_rider(crew, flashed.clone(), Plant::default()) };
    for (faults, meant) in [
        (["gyro.x:scale=-1@20ms"].as_slice(), Some((Cause::GyroDisagrees, 0.5))),
        (&["gyro.z:scale=-1@20ms"], Some((Cause::YawDisagrees, 0.35))),
        (&["gyro:flip@20ms"], Some((Cause::YawDisagrees, 0.6))),
        (&["motor:flip@20ms", "motor-report:flip@20ms"], Some((Cause::WrongResponse, 0.5))),
        // A balanced bicycle has almost no lateral specific force, whatever the sensor's sign.
        (&["accel.y:scale=-1@20ms"], None),
    ] {
        let plant = Plant { faults: faults.iter().map(|f| f.parse().unwrap()).collect(), ..Plant::default() };
        let (mut times, mut meant_reported, mut driven) = (Vec::new(), 0, Vec::new());
        for (crew, start) in rides() {
            let ride = outcomes_of(&with_rider(crew, flashed.clone(), plant.clone()), start);
            if let Some((t, cause)) = ride.first {
                times.push(t - 0.02);
                meant_reported += usize::from(meant.is_some_and(|(meant, _)| cause == meant));
            }
            if ride.fell && ride.drives && !traced(&alone(crew), start).0.fell() {
                driven.push((crew, start, ride));
            }
        }
        times.sort_by(f64::total_cmp);
        let reported = times.len();
        let median = times.get(reported / 2).copied().unwrap_or(f64::INFINITY);
        println!(
            "{faults:?}: reported {reported} times, {meant_reported} {meant:?}, median {median:.3} s; driven {driven:?}"
        );
        if let Some((_, within_s)) = meant {
            assert!(meant_reported > 20, "{faults:?}: {meant_reported} of {reported}");
            assert!((0.01..within_s).contains(&median), "{faults:?}: {median} s");
        }
        assert!(driven.len() * 20 <= rides().len(), "{faults:?}: {driven:?}");
    }
}
