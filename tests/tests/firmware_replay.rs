//! The control step on the chip and on the host: the same bits, whatever the sensors say.

use control::wire::{COMMAND_BYTES, decode_status, encode_command, encode_frame};
use control::{Config, Plan, SensorFrame, State, Status, step};
use sim_host::ride::{Start, frames, traced};
use std::time::Duration;
use tests::basins::{H, assisted};
use xtask::{image, qemu, rides};

/// Pseudo-random frames for each configuration.
const RANDOM_FRAMES: usize = 1_000_000;

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
    let outcome = qemu::run("qemu-replay", &[], &directory, qemu::UNTIMED, Duration::from_secs(300)).unwrap();
    assert_eq!(outcome.status, Some(0), "{outcome:?}");
    let bytes = std::fs::read(directory.join("commands.bin")).unwrap();
    let (commands, rest) = bytes.as_chunks();
    assert!(rest.is_empty(), "a whole number of commands");
    commands.to_vec()
}

/// Fails at the first command that differs, with all that is known about it.
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

/// Situation: rides of the simulator: the recorded one, and rides at other speeds and disturbances,
/// some of which fall; and a made-up one whose wheel pulses are up to 19 ms old.
/// Action: every law, the product, and sensors of different latency, on host and chip.
/// Must hold: every bit of every command alike.
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
    let rides: Vec<_> = configurations
        .iter()
        .flat_map(|(_, config)| recorded.iter().map(move |ride| (config, ride.as_slice())))
        .collect();
    assert_same_bits("ride", &rides);
}

fn simulated(speed_m_s: f64, steer_rate_rad_s: f64) -> Vec<SensorFrame> {
    let start = Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
    frames(&traced(&assisted(H), start).1)
}

/// Situation: the ride in data/border_ride.frames. Action: simulate it again. Must hold: every bit
/// of every frame alike, on any machine; and it is a border ride, hard on the assist and not a fall.
#[test]
fn the_recorded_border_ride_is_what_the_simulator_rides() {
    let recorded = rides::border_ride();
    let again = simulated(4.0, 8.42);
    assert_eq!(recorded.len(), again.len());
    for (tick, (a, b)) in recorded.iter().zip(&again).enumerate() {
        assert_eq!(encode_frame(a), encode_frame(b), "tick {tick}");
    }
    let peak = recorded.iter().map(|f| f.roll_rate_rad_s.value.abs()).fold(0.0, f32::max);
    assert!(recorded.len() == 6000 && (1.0..6.0).contains(&peak), "{} frames, {peak} rad/s", recorded.len());
}

/// Situation: sensors gone mad: any bit pattern, NaN of every kind, denormals, infinities, the
/// ranges' edges, late and missing samples, between stretches in which the law runs.
/// Action: a million such frames for every configuration, on host and chip.
/// Must hold: every bit of every command alike.
#[test]
fn a_million_random_frames_give_the_same_bits_on_host_and_chip() {
    if !image::ready() {
        return;
    }
    for (seed, (_, config)) in (1..).zip(rides::configurations()) {
        assert_same_bits("random", &[(&config, &rides::random_frames(seed, RANDOM_FRAMES))]);
    }
}

/// Situation: the random frames of the test above.
/// Action: look at what they exercise.
/// Must hold: each configuration runs its law in at least a third of them and refuses at least a
/// twentieth; every reason to refuse occurs; every torque is finite.
#[test]
fn the_random_frames_reach_the_law_and_every_refusal() {
    for (seed, (name, config)) in (1..).zip(rides::configurations()) {
        let frames = rides::random_frames(seed, RANDOM_FRAMES);
        let commands = on_host(&[(&config, &frames)]);
        let share = |wanted: fn(&Status) -> bool| {
            let statuses = commands.iter().map(|command| decode_status(command[COMMAND_BYTES - 1]).unwrap());
            statuses.filter(wanted).count() as f64 / commands.len() as f64
        };
        let active = share(|s| *s == Status::Active);
        let rejected = share(|s| matches!(s, Status::Rejected(_)));
        assert!(active > 1.0 / 3.0 && rejected > 0.05, "{name}: {active} active, {rejected} rejected");
        for reason in 17..=20 {
            assert!(
                commands.iter().any(|c| c[COMMAND_BYTES - 1] == reason),
                "{name}: never refused by {reason}"
            );
        }
        let finite = |c: &[u8; COMMAND_BYTES]| f32::from_le_bytes([c[0], c[1], c[2], c[3]]).is_finite();
        assert!(commands.iter().all(finite), "{name}");
    }
}
