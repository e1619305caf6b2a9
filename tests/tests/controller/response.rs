//! Flight cards: gyro and motor judged by what follows from them.

use control::{Cause, Config, Law, Limits, Mode, State};
use sim_host::bicycle::onboard;
use sim_host::plant::{Plant, Sensor};
use sim_host::ride::{Assist, Conditions, Start, frames, traced};
use sim_host::rider::{Fit, Outside, catalogue as riders};
use tests::basins::{alone, configured};

/// Law h without limits, as in the published basins, on a bicycle with every sensor and every check.
fn watched() -> Config {
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

/// A rough road and sensors as they are bought.
fn rough() -> Plant {
    let mut plant = Plant::default();
    plant.sensors.model_mut(Sensor::Gyro).noise = 0.02;
    plant.sensors.model_mut(Sensor::Accel).noise = 1.0;
    plant.sensors.model_mut(Sensor::Steer).noise = 0.001;
    plant.sensors.model_mut(Sensor::SteerRate).noise = 0.03;
    plant
}

/// What came of a ride.
#[derive(Debug)]
struct Judged {
    /// Least and largest slope of gyro and motor.
    slopes: [(f32, f32); 2],
    /// When the first cause was told, and which.
    first: Option<(f64, Cause)>,
    fell: bool,
    /// Torque may flow at the end.
    drives: bool,
}

fn judged(conditions: &Conditions, start: Start) -> Judged {
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
    Judged { slopes: ranges, first, fell: outcome.fell(), drives }
}

const SPEEDS: [f64; 5] = [2.0, 3.0, 4.3, 5.5, 7.0];
const CREWS: [Option<&str>; 3] = [None, Some("young"), Some("smart")];

/// Knocks of the handlebar and blows to the roll \[rad/s\]; most rides hold them.
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

/// Situation: all signs right, sensors exact or rough. Action: ride.
/// Must hold: in every ride that does not fall no cause is told. After a knock of the handlebar the gyro's slope stays near
/// 1, after a blow to the roll, which a gyro shows and a force at rest does not, well above where it counts as wrong; the
/// motor's stays above 0. Both are judged in many rides.
#[test]
fn right_signs_are_never_accused() {
    let mut wrong = Vec::new();
    let mut counts = [0, 0];
    for (name, plant, near) in [("exact", Plant::default(), 0.75), ("rough", rough(), 0.3)] {
        for (crew, start) in rides() {
            let ride = judged(&with_rider(crew, watched(), plant.clone()), start);
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
    assert!(counts[0] >= 80 && counts[1] > 30, "{counts:?} rides judged");
}

/// Situation: 20 ms after the blow a sign turns round for good, and no sensor tells it by itself: an axis of the IMU, all of
/// the gyro, motor and its report together. Action: ride with what is flashed.
/// Must hold: who falls and would not have fallen alone has no torque any more when he does, but for one in twenty; the
/// check meant for it tells more than twenty, and half of what is told is told within the stated time.
#[test]
fn a_sign_that_turns_round_ends_safe() {
    let flashed = Config { law: Law::H { cut: true }, limits: Limits::product(), ..watched() };
    let alone =
        |crew| Conditions { assist: Assist::None, ..with_rider(crew, flashed.clone(), Plant::default()) };
    for (faults, meant) in [
        (["gyro.x:scale=-1@20ms"].as_slice(), Some((Cause::GyroDisagrees, 0.5))),
        (&["gyro.z:scale=-1@20ms"], Some((Cause::YawDisagrees, 0.35))),
        (&["gyro:flip@20ms"], Some((Cause::YawDisagrees, 0.6))),
        (&["motor:flip@20ms", "motor-report:flip@20ms"], Some((Cause::WrongResponse, 0.5))),
        // A bicycle in balance feels next to no sideways force, whatever its sign.
        (&["accel.y:scale=-1@20ms"], None),
    ] {
        let plant = Plant { faults: faults.iter().map(|f| f.parse().unwrap()).collect(), ..Plant::default() };
        let (mut times, mut meant_told, mut driven) = (Vec::new(), 0, Vec::new());
        for (crew, start) in rides() {
            let ride = judged(&with_rider(crew, flashed.clone(), plant.clone()), start);
            if let Some((t, cause)) = ride.first {
                times.push(t - 0.02);
                meant_told += usize::from(meant.is_some_and(|(meant, _)| cause == meant));
            }
            if ride.fell && ride.drives && !traced(&alone(crew), start).0.fell() {
                driven.push((crew, start, ride));
            }
        }
        times.sort_by(f64::total_cmp);
        let told = times.len();
        let median = times.get(told / 2).copied().unwrap_or(f64::INFINITY);
        println!(
            "{faults:?}: told {told} times, {meant_told} {meant:?}, median {median:.3} s; driven {driven:?}"
        );
        if let Some((_, within_s)) = meant {
            assert!(meant_told > 20, "{faults:?}: {meant_told} of {told}");
            assert!((0.01..within_s).contains(&median), "{faults:?}: {median} s");
        }
        assert!(driven.len() * 20 <= rides().len(), "{faults:?}: {driven:?}");
    }
}
