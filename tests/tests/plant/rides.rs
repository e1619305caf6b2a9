//! Rides with sensors, motors and faults.

use control::{Causes, Config, Loss, Mode, Sensor as Declared};
use sim_host::bicycle::{Motion, State};
use sim_host::plant::catalogue::load;
use sim_host::plant::{ActuatorConfig, Plant, Sensor, SensorModel, SteerStop};
use sim_host::ride::{Conditions, Ride, Start, TracePoint, frames, rides, traced};
use tests::basins::{H, alone, assisted, configured, ideal};

const KNOCK: Start = Start { speed_m_s: 4.0, steer_rate_rad_s: 3.0, roll_rate_rad_s: 0.0 };

/// Law h in the control crate with this plant.
fn with(plant: Plant) -> Conditions {
    Conditions { plant, ..assisted(H) }
}

fn faulty(fault: &str) -> Conditions {
    with(Plant { faults: vec![fault.parse().unwrap()], ..Plant::default() })
}

fn actuated(actuator: ActuatorConfig) -> Conditions {
    with(Plant { actuator, ..Plant::default() })
}

/// A plant in which every part has a small error.
fn worn(seed: u64) -> Plant {
    let mut plant = Plant { seed, ..Plant::default() };
    let model =
        SensorModel { noise: 0.01, dropout: 0.05, delay_ticks: 2, every_ticks: 3, ..SensorModel::default() };
    for sensor in Sensor::ALL {
        *plant.sensors.model_mut(sensor) = model;
    }
    plant.sensors.imu.turned_rad = [0.01, -0.02, 0.03];
    plant.actuator = ActuatorConfig { delay_ticks: 1, time_constant_s: 0.01, ..load("davis").unwrap() };
    plant
}

/// A configuration that holds samples for a while.
fn holding() -> Config {
    let mut config = Config::thesis(H);
    let holding = Declared { timeout_ticks: 50, ..Declared::exact(100.0) };
    config.input.gyro = holding;
    config.input.front_wheel = holding;
    config
}

/// All sensors declared.
fn all_declared() -> Config {
    let mut config = Config::thesis(H);
    let exact = Declared::exact(1e5);
    let i = &mut config.input;
    (i.accel, i.steer, i.steer_rate, i.rear_wheel) = (exact, exact, exact, exact);
    (i.rider_torque, i.motor, i.path) = (exact, exact, exact);
    config
}

/// Situation: exact sensors, all of them declared, and a plant whose only departure is a fault after the ride.
/// Action: rides that recover and fall, also where only all six speeds are exact.
/// Must hold: the same bits as without a plant.
#[test]
fn an_exact_plant_changes_no_bit() {
    let starts: Vec<Start> = [(4.0, 3.0), (4.0, 5.0), (1.0, 25.0), (7.0, 8.0), (3.0, -9.0)]
        .map(|(speed_m_s, steer_rate_rad_s)| Start { speed_m_s, steer_rate_rad_s, ..KNOCK })
        .into();
    let plain = rides(&assisted(H), &starts);
    assert!(plain.iter().any(Ride::fell) && !plain.iter().all(Ride::fell));
    assert_eq!(rides(&configured(all_declared()), &starts), plain);
    assert_eq!(rides(&faulty("gyro:bias=1@100s"), &starts), plain);
}

/// Situation: a worn plant with noise.
/// Action: many rides in a batch, backwards, and each alone.
/// Must hold: the same bits in any batch; another seed gives another ride; the mirrored start too.
#[test]
fn noise_does_not_depend_on_the_batch() {
    let conditions = |seed| Conditions { plant: worn(seed), ..configured(holding()) };
    let starts: Vec<Start> =
        (0..24).map(|i| Start { speed_m_s: 2.0 + 0.2 * f64::from(i), ..KNOCK }).collect();
    let together = rides(&conditions(7), &starts);
    let backwards: Vec<Start> = starts.iter().rev().copied().collect();
    let mut turned = rides(&conditions(7), &backwards);
    turned.reverse();
    assert_eq!(together, turned);
    for (start, ride) in starts.iter().zip(&together) {
        assert_eq!(traced(&conditions(7), *start).0, *ride);
    }
    let other = rides(&conditions(8), &starts);
    assert!(together.iter().zip(&other).all(|(a, b)| a.end != b.end));
    assert!(together.iter().filter(|ride| !ride.fell()).count() > 6);
}

fn same(a: &TracePoint, b: &TracePoint) -> bool {
    (a.roll, a.steer, a.torque, a.motor_torque) == (b.roll, b.steer, b.torque, b.motor_torque)
}

/// Situation: law h at 4 m/s; faults of every channel that the controller uses, from 0.2 s on.
/// Action: ride with and without.
/// Must hold: both rides are the same until the control instant at 0.2 s, and differ in the controller's measurements
/// or the motor's torque from that instant on.
#[test]
fn a_fault_changes_the_ride_from_its_instant_on() {
    let plain = traced(&faulty("gyro:bias=1@100s"), KNOCK).1;
    for fault in [
        "gyro:bias=0.1",
        "gyro.x:flip",
        "gyro:stuck",
        "gyro:missing",
        "gyro:nan",
        "front-wheel:value=1",
        "front-wheel:missing",
        "motor:dead",
        "motor:scale=0.5",
        "motor:value=-3",
        "engage:missing",
    ] {
        let (_, faulty_trace) = traced(&faulty(&format!("{fault}@200ms")), KNOCK);
        let measured = |p: &TracePoint| {
            (p.frame.gyro_rad_s.value.map(f32::to_bits), p.frame.front_wheel_m_s, p.frame.engage)
        };
        let aged = |p: &TracePoint| (p.frame.gyro_rad_s.age_ticks, p.motor_torque);
        let differs = |(a, b): (&TracePoint, &TracePoint)| {
            measured(a) != measured(b) || aged(a) != aged(b) || !same(a, b)
        };
        let first = plain.iter().zip(&faulty_trace).position(differs);
        assert_eq!(first, Some(200), "{fault}");
    }
}

/// Situation: the gyro is lost permanently, and for 20 ms while the controller holds samples for 50.
/// Must hold: permanently, the causes name it and the torque is zero from there on; for a while, torque continues.
/// The trace has the mode.
#[test]
fn a_lost_gyro_stops_the_assist() {
    let mut config = holding();
    config.input.gyro.loss = Loss::Fault;
    let fault = |text: &str| {
        let plant = Plant { faults: vec![text.parse().unwrap()], ..Plant::default() };
        traced(&Conditions { plant, ..configured(config.clone()) }, KNOCK).1
    };
    let lost = fault("gyro:missing@300ms");
    assert!(lost[..350].iter().all(|p| p.mode == Mode::Engaged as u8) && lost[349].torque != 0.0);
    let after = &lost[360..];
    assert!(after.iter().all(|p| p.mode == Mode::Fault as u8 && p.torque == 0.0 && p.causes != 0));
    let hole = fault("gyro:missing@300ms..320ms");
    assert!(hole.iter().all(|p| p.mode == Mode::Engaged as u8 && Causes(p.causes) == Causes::NONE));
    assert!(hole[310].frame.gyro_rad_s.age_ticks == 11 && hole[321].frame.gyro_rad_s.age_ticks == 0);
}

/// Situation: motors with reversed sign, dead, weak and slow.
/// Action: the knock from which h recovers.
/// Must hold: the first makes it fall sooner than no assist, the second falls as without assist, to the bit; half the
/// torque constant still recovers; a lag of 200 ms does not.
#[test]
fn faulty_motors_change_the_ride() {
    let fallen = |conditions: &Conditions| traced(conditions, KNOCK).0.outcome.time_to_fall_s();
    let none = fallen(&alone()).expect("falls");
    let wrong = fallen(&actuated(ActuatorConfig { scale: -1.0, ..ActuatorConfig::default() }));
    assert!(wrong.expect("falls") < none);
    assert_eq!(fallen(&actuated(ActuatorConfig { scale: 0.0, ..ActuatorConfig::default() })), Some(none));
    assert_eq!(fallen(&faulty("motor:dead")), Some(none));
    assert_eq!(fallen(&actuated(ActuatorConfig { scale: 0.7, ..ActuatorConfig::default() })), None);
    let slow = ActuatorConfig { time_constant_s: 0.2, ..ActuatorConfig::default() };
    assert!(fallen(&actuated(slow)).is_some());
}

/// Situation: a lag of 20 ms and a delay of 3 ms under a ride.
/// Must hold: the acting torque follows from the commanded one by the closed form, period by period, at each period's
/// middle; its largest change is smaller.
#[test]
fn the_torque_given_is_the_response_to_the_commands() {
    let lag = ActuatorConfig { time_constant_s: 0.02, delay_ticks: 3, ..ActuatorConfig::default() };
    let (ride, trace) = traced(&actuated(lag), KNOCK);
    let (half, whole) = ((-0.5e-3_f64 / 0.02).exp(), (-1e-3_f64 / 0.02).exp());
    let (mut response, mut largest) = (0.0, 0.0_f64);
    for (tick, p) in trace.iter().enumerate() {
        let target = if tick < 3 { 0.0 } else { trace[tick - 3].torque };
        let middle = target + (response - target) * half;
        assert!((p.motor_torque - middle).abs() < 1e-9, "{tick}: {} {middle}", p.motor_torque);
        response = target + (response - target) * whole;
        largest = largest.max(p.motor_torque.abs());
    }
    assert_eq!(ride.effort.peak_torque_nm, largest);
    assert!(largest > 0.5);
}

/// Situation: the bicycle without assist, under the ideal law and under the firmware, with the friction of the Davis
/// bicycle.
/// Action: a knock at 6 m/s.
/// Must hold: without assist, the energy falls, and by no more than the friction's work; under either assist friction
/// changes the ride.
#[test]
fn friction_acts_under_every_assist() {
    let start = Start { speed_m_s: 6.0, ..KNOCK };
    let actuator = load("davis").unwrap();
    let rubbed = |c: Conditions| Conditions { plant: Plant { actuator, ..Plant::default() }, ..c };
    let conditions = rubbed(alone());
    let b = &conditions.bicycle;
    let energy = |s: &State<f64>| Motion::new(b, s).energy(b, s);
    let (ride, trace) = traced(&conditions, start);
    let end = State {
        roll: ride.end.roll,
        steer: ride.end.steer,
        roll_rate: ride.end.roll_rate,
        steer_rate: ride.end.steer_rate,
        rear_wheel_rate: ride.end.rear_wheel_rate,
        pitch: trace.last().unwrap().pitch,
    };
    let change = energy(&end) - energy(&start.state(b));
    // The trapezoidal rule over the trace, without the last period.
    let power = |p: &TracePoint| actuator.friction.torque(p.steer_rate) * p.steer_rate;
    let work: f64 = trace.windows(2).map(|w| 0.5e-3 * (power(&w[0]) + power(&w[1]))).sum();
    println!("{:?}: energy {change} J, work of friction {work} J", ride.outcome);
    assert!(change < -0.1 && (change - work).abs() < 0.01 * work.abs());
    for c in [assisted(H), ideal(H)] {
        let (with, without) = (traced(&rubbed(c.clone()), start).0, traced(&c, start).0);
        assert!(!with.fell() && !without.fell() && with.end != without.end);
        assert!(with.effort.peak_steer_rad < without.effort.peak_steer_rad);
    }
}

/// Situation: a worn plant.
/// Action: step the controller again with the frames of the ride.
/// Must hold: the torques of the trace, to the bit.
#[test]
fn the_frames_of_a_worn_ride_replay() {
    let config = holding();
    let conditions = Conditions { plant: worn(3), ..configured(config.clone()) };
    let (_, trace) = traced(&conditions, KNOCK);
    let frames = frames(&conditions, KNOCK, &trace);
    assert!(frames.len() > trace.len());
    let (plan, mut state) = (config.plan().unwrap(), control::State::default());
    let torques: Vec<f64> =
        frames.iter().map(|frame| f64::from(control::step(&plan, &mut state, frame).torque_nm)).collect();
    let ridden: Vec<f64> = trace.iter().map(|p| p.torque).collect();
    assert_eq!(torques[frames.len() - trace.len()..], ridden);
}

/// Situation: the ideal law with a noisy sensor, a weak motor or a fault.
/// Must hold: rejected, with the reason.
#[test]
fn the_ideal_law_has_an_exact_plant() {
    let weak = ActuatorConfig { scale: 0.5, ..ActuatorConfig::default() };
    for plant in [worn(0), Plant { actuator: weak, ..Plant::default() }] {
        let rejected = Conditions { plant, ..ideal(H) }.check().expect_err("refused").to_string();
        assert!(rejected.contains("only friction"), "{rejected}");
    }
}

/// Situation: a knock that turns the steer beyond 0.5 rad without a fall, to the right and to the left; the same with
/// a stop there.
/// Action: ride, alone and in a batch.
/// Must hold: with the stop the steer goes no more than 3 degrees beyond it, where without it goes further; until
/// then both rides have the same bits; left mirrors right; the batch has the bits of the single ride.
#[test]
fn the_stop_holds_the_steer() {
    let start = |side: f64| Start { speed_m_s: 2.5, steer_rate_rad_s: 6.0 * side, roll_rate_rad_s: 0.0 };
    let stop = SteerStop::at(0.5);
    let stopped = actuated(ActuatorConfig { stop: Some(stop), ..ActuatorConfig::default() });
    let (free, free_trace) = traced(&assisted(H), start(1.0));
    let (ride, trace) = traced(&stopped, start(1.0));
    let most = |trace: &[TracePoint]| trace.iter().map(|p| p.steer.abs()).fold(0.0, f64::max);
    println!("{} {} fell {} {}", most(&free_trace), most(&trace), free.fell(), ride.fell());
    assert!(!free.fell() && most(&free_trace) > 0.5 + 0.1);
    assert!((0.5..0.5 + 3f64.to_radians()).contains(&most(&trace)));
    let before = trace.iter().position(|p| p.steer.abs() > 0.49).unwrap();
    assert!(before > 20 && trace[..before] == free_trace[..before]);
    let batch = rides(&stopped, &[start(1.0), start(-1.0), start(0.5)]);
    assert_eq!(batch[0], ride);
    let mirrored = (batch[1].end.roll + ride.end.roll).abs();
    assert!(mirrored < 1e-9, "{mirrored}");
}

/// Situation: the front wheel's speed through a lag of 0.5 s, and 2 s late.
/// Action: a knock.
/// Must hold: the measured speed follows the first-order closed recursion of the exact readings; with the delay it is
/// the speed of the start for the whole second of the test, and its sample counts as fresh.
#[test]
fn a_speed_lags_and_is_late() {
    let (_, exact) = traced(&faulty("gyro:bias=1@100s"), KNOCK);
    let front = |p: &TracePoint| p.front_speed;
    assert!(exact.iter().any(|p| (front(p) - 4.0).abs() > 0.05));
    let (_, lagged) = traced(&faulty("front-wheel:slow=500ms"), KNOCK);
    let (mut output, keeps) = (4.0, (-1e-3_f64 / 0.5).exp());
    for p in lagged.iter().take(1000) {
        output = front(p) + (output - front(p)) * keeps;
        assert!((p.measured_speed - output).abs() < 1e-6, "{} {output}", p.measured_speed);
    }
    let mut plant = Plant::default();
    plant.sensors.model_mut(Sensor::FrontWheel).delay_ticks = 2000;
    let (_, late) = traced(&with(plant), KNOCK);
    assert!(late.iter().take(1000).all(|p| p.measured_speed == 4.0 && p.causes == 0));
}
