//! The control step on the chip and on the host: the same bits for all sensor values.

use control::safety::press::PressConfig;
use control::wire::{COMMAND_BYTES, encode_command, encode_frame};
use control::{Cause, Command, Config, Plan, SensorFrame, State, step};
use sim_host::bicycle::onboard::fit;
use sim_host::ride::{Conditions, Start, frames, traced};
use tests::basins::{H, assisted, configured};
use tests::cli::Bench;
use tests::sets::whole;
use xtask::{image, qemu, rides};

/// Least parts of the random frames in which a configuration must drive, and must reject a sensor. The flashed ones
/// have cross-checks, which random frames seldom pass.
fn least(name: &str) -> (f64, f64) {
    if name.starts_with("product") { (0.001, 0.5) } else { (0.9, 0.01) }
}

/// Every configuration with presses that count in their first period: random frames never open the switch for long
/// enough.
fn pressed_at_once() -> impl Iterator<Item = (&'static str, Config)> {
    rides::configurations().into_iter().map(|(name, mut config)| {
        config.permit.press = PressConfig::default();
        (name, config)
    })
}

/// Pseudo-random frames for a configuration: a million for the published one and the flashed ones, a tenth of that
/// for those that differ little from them.
fn random_frames(name: &str) -> usize {
    if name == "h" || name.starts_with("product") { 1_000_000 } else { 100_000 }
}

fn plan(config: &Config) -> Plan {
    config.clone().plan().expect("a valid configuration")
}

fn on_host(rides: &[(&Config, &[SensorFrame])]) -> Vec<[u8; COMMAND_BYTES]> {
    let mut commands = Vec::new();
    for (config, frames) in rides {
        let (plan, mut state) = (plan(config), State::default());
        commands.extend(frames.iter().map(|frame| encode_command(&step(&plan, &mut state, frame))));
    }
    commands
}

fn on_chip(name: &str, rides: &[(&Config, &[SensorFrame])]) -> Vec<[u8; COMMAND_BYTES]> {
    let directory = qemu::directory(name).unwrap();
    std::fs::write(directory.join("rides.bin"), rides::encode(rides)).unwrap();
    let outcome = qemu::run("qemu-replay", &[], &directory, qemu::UNTIMED, qemu::LIMIT).unwrap();
    assert_eq!(outcome.status, Some(0), "{outcome:?}");
    let bytes = std::fs::read(directory.join("commands.bin")).unwrap();
    let (commands, rest) = bytes.as_chunks();
    assert!(rest.is_empty(), "a whole number of commands");
    commands.to_vec()
}

/// Fails at the first command that differs, with the context.
fn assert_same_bits(name: &str, rides: &[(&Config, &[SensorFrame])]) {
    let (host, chip) = (on_host(rides), on_chip(name, rides));
    assert_eq!(host.len(), chip.len(), "commands");
    if let Some(at) = host.iter().zip(&chip).position(|(a, b)| a != b) {
        let frame = rides.iter().flat_map(|(_, frames)| *frames).nth(at).unwrap();
        panic!(
            "command {at}: host {:02x?}, chip {:02x?}, of frame {frame:?} = {:02x?}",
            host[at],
            chip[at],
            encode_frame(frame)
        );
    }
}

/// Situation: rides of the simulator: the recorded one, and rides at other speeds and disturbances, some of which
/// fall; and an artificial one whose wheel pulses are up to 19 ms old.
/// Action: every law, the product, and sensors of different latency, on host and chip.
/// Must hold: every bit of every command is equal.
#[test]
fn recorded_rides_give_the_same_bits_on_host_and_chip() {
    if !image::ready() {
        return;
    }
    let configurations = rides::configurations();
    let swinging = rides::swinging_ride();
    let mut recorded = vec![rides::border_ride(), rides::fresh(&swinging), swinging];
    for (speed, steer_rate) in [(1.0, 3.0), (2.5, -8.0), (6.0, 7.9), (8.0, 7.7), (3.0, 12.0)] {
        recorded.push(simulated(speed, steer_rate));
    }
    let mut rides: Vec<_> = configurations
        .iter()
        .flat_map(|(_, config)| recorded.iter().map(move |ride| (config, ride.as_slice())))
        .collect();
    let (product, fitted) = flashed();
    let whole: Vec<Vec<SensorFrame>> = [(4.0, 6.0), (2.5, -5.0), (6.5, 7.0), (1.0, 20.0)]
        .map(|(speed_m_s, steer_rate_rad_s)| {
            let start = Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
            frames(&product, start, &traced(&product, start).1)
        })
        .into();
    rides.extend(whole.iter().map(|ride| (&fitted, ride.as_slice())));
    assert_same_bits("ride", &rides);
}

/// The flashed configuration on the thesis bicycle, every sensor fitted, with the ride's conditions.
fn flashed() -> (Conditions, Config) {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    let conditions = configured(config.clone());
    fit(&mut config, &conditions.bicycle, conditions.plant.sensors.imu.point_m);
    (configured(config.clone()), config)
}

fn simulated(speed_m_s: f64, steer_rate_rad_s: f64) -> Vec<SensorFrame> {
    let start = Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
    let conditions = assisted(H);
    frames(&conditions, start, &traced(&conditions, start).1)
}

/// Situation: the ride in data/all_sensors.frames, made by the command line's options.
/// Action: ride it again.
/// Must hold: every bit of the declared sensors' values is equal; the controller engages, and no cause is reported
/// after it.
#[test]
fn the_recorded_ride_with_every_sensor_is_reproduced() {
    let bench = Bench::new(env!("CARGO_BIN_EXE_sim-host-under-test"));
    let run =
        bench.run("ride --preset product --speed 4 --steer-rate 5 --time-limit 1.25 --frames again.frames");
    assert_eq!(run.code, Some(0), "{run:?}");
    let again = std::fs::read(bench.path("again.frames")).unwrap();
    assert!(again == include_bytes!("../../../data/all_sensors.frames"), "{} bytes", again.len());
    let plan = rides::product().plan().unwrap();
    let mut state = control::State::default();
    let commands: Vec<_> =
        rides::all_sensors_ride().iter().map(|frame| control::step(&plan, &mut state, frame)).collect();
    let engaged = commands.iter().position(|c| c.mode == control::Mode::Engaged).expect("engages");
    assert!((200..900).contains(&engaged), "{engaged}");
    assert!(commands[engaged..].iter().all(|c| c.causes == control::Causes::NONE));
}

/// Situation: the ride in data/border_ride.frames.
/// Action: simulate it again.
/// Must hold: every bit of every frame is equal, on any machine; and it is a border ride with large assist torques
/// that does not fall.
#[test]
fn the_recorded_border_ride_is_reproduced() {
    let recorded = rides::border_ride();
    let again = simulated(4.0, 8.42);
    assert_eq!(recorded.len(), again.len());
    for (tick, (a, b)) in recorded.iter().zip(&again).enumerate() {
        assert_eq!(encode_frame(a), encode_frame(b), "tick {tick}");
    }
    let peak = recorded.iter().map(|f| f.gyro_rad_s.value[0].abs()).fold(0.0, f32::max);
    let pre_roll = recorded.len() - 6000;
    assert!((1..100).contains(&pre_roll) && (1.0..6.0).contains(&peak), "{pre_roll} frames, {peak} rad/s");
}

/// Situation: arbitrary sensor values: any bit pattern, NaN of every kind, denormals, infinities, the ranges' edges,
/// late and missing samples, between stretches in which the law runs.
/// Action: a million such frames for the published and the flashed configurations, 100,000 for each other, on host
/// and chip; by default a tenth as many.
/// Must hold: every bit of every command is equal.
#[test]
fn a_million_random_frames_give_the_same_bits_on_host_and_chip() {
    if !image::ready() {
        return;
    }
    for (seed, (name, config)) in (1..).zip(pressed_at_once()) {
        let frames = random_frames(name) / if whole() { 1 } else { 10 };
        assert_same_bits("random", &[(&config, &rides::random_frames(seed, frames))]);
    }
}

/// Situation: the random frames of the test above.
/// Action: count the covered conditions.
/// Must hold: the published ones drive in nine tenths of them and reject a sensor in a hundredth, the flashed ones in
/// a thousandth and half; every reason to lose gyro or wheel but jump and stuck occurs; every torque is finite.
#[test]
fn the_random_frames_reach_the_law_and_every_rejection() {
    for (seed, (name, config)) in (1..).zip(pressed_at_once()) {
        let (plan, mut state) = (plan(&config), State::default());
        let commands: Vec<Command> = rides::random_frames(seed, random_frames(name))
            .iter()
            .map(|f| step(&plan, &mut state, f))
            .collect();
        let share = |expected: &dyn Fn(&Command) -> bool| {
            commands.iter().filter(|c| expected(c)).count() as f64 / commands.len() as f64
        };
        let driving = share(&|c| c.mode.drives());
        let rejected = share(&|c| c.causes.iter().any(|cause| (1..=36).contains(&cause.code())));
        println!("{name}: {driving} driving, {rejected} with a sensor refused");
        let least = least(name);
        assert!(driving > least.0 && rejected > least.1, "{name}: {driving} driving, {rejected} refused");
        let wheel = match config.input.wheel {
            control::Wheel::Front => [Cause::FrontWheelLost, Cause::FrontWheelRange],
            control::Wheel::Rear => [Cause::RearWheelLost, Cause::RearWheelRange],
        };
        for cause in [Cause::GyroLost, Cause::GyroRange, wheel[0], wheel[1]] {
            assert!(commands.iter().any(|c| c.causes.has(cause)), "{name}: never {cause:?}");
        }
        assert!(commands.iter().all(|c| c.torque_nm.is_finite()), "{name}");
    }
}
