//! Each fault opens the bridge in time, with its number, and latches.

use crate::bench::{Bench, Record, last, opened};
use motor::{FAULTS, Fault, Faults, Inputs, Mode, MotorCommand, Phases, State};

fn one(fault: Fault) -> Faults {
    let mut set = Faults::NONE;
    set.note(fault, true);
    set
}

/// A handlebar that turns at a constant `rate`, with 4 N m applied.
fn turning(rate: f64) -> Bench {
    let mut bench = Bench::ready(|_| ());
    bench.machine.params.inertia_kg_m2 = 1e6;
    bench.machine.steer_rate_rad_s = rate;
    let _ = bench.run(600, MotorCommand::Off);
    let records = bench.run(400, MotorCommand::Torque(4.0));
    assert_eq!(opened(&records), None, "{:?}", last(&records).out);
    bench
}

/// Checks that the bridge opens with this fault alone, in a call from `least` to `most`.
fn opens(name: &str, records: &[Record], fault: Fault, least: usize, most: usize) {
    let (call, out) = (opened(records), last(records).out);
    assert!(call.is_some_and(|n| (least..=most).contains(&n)), "{name}: {call:?} {out:?}");
    assert_eq!(out.faults, one(fault), "{name}: {:?}", out.faults.iter().collect::<Vec<_>>());
    assert_eq!(out.mode, Mode::Off);
    println!("{name}: {fault:?} in call {}", call.unwrap_or(0));
}

/// Situation: 4 N m at 2 rad/s; one input is wrong from one call on. Must hold: its fault, within its number of calls.
#[test]
fn an_input_that_is_wrong() {
    type Tamper = fn(u64, &mut Inputs);
    fn phase(i: &mut Inputs, x: usize, to: f32) {
        let mut all = i.phases.all();
        all[x] = to;
        i.phases = Phases::Three(all);
    }
    let cases: [(&str, Tamper, Fault, usize); 18] = [
        ("a current of NaN", |_, i| phase(i, 0, f32::NAN), Fault::CurrentSensor, 1),
        ("a sensor that ends at -165 A", |_, i| phase(i, 1, -165.0), Fault::CurrentSensor, 1),
        ("a bus of NaN", |_, i| i.bus_v = f32::NAN, Fault::BusSensor, 1),
        ("a bus of 0 V", |_, i| i.bus_v = 0.0, Fault::BusSensor, 1),
        ("a bus of 15 V", |_, i| i.bus_v = 15.0, Fault::BusLow, 3),
        ("a bus of 33 V", |_, i| i.bus_v = 33.0, Fault::BusHigh, 3),
        ("a temperature of NaN", |_, i| i.temperature_c = f32::NAN, Fault::HeatSensor, 1),
        ("a temperature sensor cut", |_, i| i.temperature_c = -100.0, Fault::HeatSensor, 1),
        ("101 deg C", |_, i| i.temperature_c = 101.0, Fault::Hot, 1),
        ("a command of NaN", |_, i| i.command = MotorCommand::Torque(f32::NAN), Fault::Command, 1),
        ("a command of infinity", |_, i| i.command = MotorCommand::Torque(f32::INFINITY), Fault::Command, 1),
        ("an encoder that is silent", |n, i| i.angle_age_calls = n as u16 + 1, Fault::EncoderLost, 11),
        ("an encoder that has nothing", |_, i| i.angle_age_calls = u16::MAX, Fault::EncoderLost, 11),
        ("an encoder that is always late", |_, i| i.angle_age_calls = 50, Fault::EncoderLost, 11),
        ("counts beyond a turn", |_, i| i.angle_counts = 16_384, Fault::EncoderRange, 11),
        (
            "a jump of 300 counts",
            |_, i| i.angle_counts = (i.angle_counts + 300) % 16_384,
            Fault::EncoderJump,
            11,
        ),
        (
            "a jump by half a turn",
            |_, i| i.angle_counts = (i.angle_counts + 8192) % 16_384,
            Fault::EncoderJump,
            11,
        ),
        (
            "an encoder that accelerates without end",
            |n, i| i.angle_counts = (n * 150 % 16_384) as u16,
            Fault::EncoderJump,
            11,
        ),
    ];
    for (name, tamper, fault, call) in cases {
        let records = turning(2.0).tampered(100, MotorCommand::Torque(4.0), tamper);
        opens(name, &records, fault, call, call + 1);
    }
}

/// Situation: 4 N m; the encoder accelerates beyond the motor's largest speed. Must hold: a speed fault.
#[test]
fn an_encoder_that_is_too_fast() {
    let mut bench = Bench::ready(|c| c.encoder.speed_max_turns_s = 20.0);
    bench.machine.load_nm = 30.0;
    let records = bench.run(4000, MotorCommand::Torque(4.0));
    opens("too fast", &records, Fault::EncoderSpeed, 10, 4000);
    let rate = records[opened(&records).unwrap_or(1) - 1].out.steer_rate_rad_s * 36.0 / std::f32::consts::TAU;
    assert!((20.0..=20.5).contains(&rate), "{rate}");
}

/// Situation: a jump of one encoder sample. Must hold: no fault; the torque stays within 10 %.
#[test]
fn one_bad_sample_is_left_out() {
    let mut bench = turning(2.0);
    let records = bench.tampered(100, MotorCommand::Torque(4.0), |n, i| {
        if n == 10 {
            i.angle_counts = (i.angle_counts + 4000) % 16_384;
        }
    });
    assert_eq!(opened(&records), None);
    assert!(records.iter().all(|r| (r.torque_nm - 4.0).abs() < 0.4));
}

/// Situation: 4 N m; an impact changes the handlebar's rate by 8 rad/s in 5 ms or in 2 ms. Must hold: no fault, a
/// torque error below 3 N m meanwhile and below 0.4 N m after 5 ms more.
#[test]
fn an_impact_on_the_handlebar() {
    let off = |records: &[Record]| records.iter().map(|r| (r.torque_nm - 4.0).abs()).fold(0.0, f64::max);
    for (blow, calls) in [(8.0, 100), (-8.0, 100), (8.0, 40), (-8.0, 40)] {
        let mut bench = turning(0.0);
        let mut during = Vec::new();
        for call in 1..=calls {
            bench.machine.steer_rate_rad_s = blow * f64::from(call) / f64::from(calls);
            during.push(bench.call(MotorCommand::Torque(4.0), |_, _| ()));
        }
        let after = bench.run(200, MotorCommand::Torque(4.0));
        assert_eq!(opened(&after), None, "{blow}: {:?}", last(&after).out);
        println!(
            "{blow} rad/s in {calls} calls: {:.2} N m, then {:.2} N m",
            off(&during),
            off(&after[100..])
        );
        assert!(off(&after[100..]) < 0.4 && (0.05..3.0).contains(&off(&during)));
    }
}

/// Situation: 4 N m; the encoder repeats one sample as fresh while hands turn the handlebar. Must hold: from 1 rad/s
/// on voltage or current detect it, within 20 ms from 2 rad/s on, else within 50. At 0.3 rad/s it is undetected: a
/// limit stated in docs/motor.md.
#[test]
fn an_encoder_that_is_stuck() {
    for (rate, detected) in
        [(0.3, false), (1.0, true), (2.0, true), (4.0, true), (6.0, true), (10.0, true), (-6.0, true)]
    {
        let mut bench = turning(rate);
        let counts = bench.inputs(MotorCommand::Off).angle_counts;
        let records = bench.tampered(4000, MotorCommand::Torque(4.0), |_, i| i.angle_counts = counts);
        let most = records.iter().map(|r| r.torque_nm.abs()).fold(0.0, f64::max);
        println!(
            "stuck at {rate} rad/s: call {:?}, {:?}, {most:.1} N m",
            opened(&records),
            last(&records).out.faults
        );
        if detected {
            let latest = if rate.abs() < 2.0 { 1000 } else { 400 };
            assert!(opened(&records).is_some_and(|n| (2..=latest).contains(&n)));
            let faults = last(&records).out.faults;
            let may = [Fault::VoltageResidual, Fault::CurrentTracking, Fault::AngleMismatch];
            assert!(faults.iter().all(|fault| may.contains(&fault)), "{faults:?}");
        } else {
            assert_eq!(opened(&records), None, "{rate}");
        }
        assert!(most < 8.0, "{rate}: {most}");
    }
}

/// Situation: a phase opens, at rest and at 3 rad/s, with 4 N m. Must hold: bridge open within 10 ms; while turning,
/// the fault number identifies the phase; at rest it never names another one.
#[test]
fn a_phase_is_cut() {
    for (cut, fault) in [Fault::PhaseALost, Fault::PhaseBLost, Fault::PhaseCLost].into_iter().enumerate() {
        let mut bench = turning(3.0);
        bench.machine.cut[cut] = true;
        let records = bench.run(400, MotorCommand::Torque(4.0));
        opens("cut, turning", &records, fault, 5, 200);
        for angle in 0..6 {
            let mut bench = Bench::ready(|_| ());
            bench.machine.motor_turns = f64::from(angle) / 6.0 / 8.0 + 0.003;
            bench.machine.held = true;
            bench.machine.cut[cut] = true;
            let _ = bench.run(12, MotorCommand::Off);
            let records = bench.run(400, MotorCommand::Torque(4.0));
            let out = last(&records).out;
            assert!(opened(&records).is_some_and(|n| (5..=200).contains(&n)), "{cut} {angle}: {out:?}");
            let may = [fault, Fault::CurrentTracking, Fault::VoltageResidual, Fault::AngleMismatch];
            assert!(out.faults.iter().all(|f| may.contains(&f)), "{out:?}");
        }
    }
    let mut bench = turning(3.0);
    bench.machine.cut = [true; 3];
    let records = bench.run(400, MotorCommand::Torque(4.0));
    opens("all three cut", &records, Fault::CurrentTracking, 5, 200);
}

/// Situation: a current sensor reads only its offset, with 4 N m at 2 rad/s. Must hold: the sum detects it within
/// half an electrical turn (109 calls); no phase carries more than 15 A until then.
#[test]
fn a_current_sensor_is_dead() {
    for x in 0..3 {
        let mut bench = turning(2.0);
        let zero = bench.zeros_a[x] as f32;
        let records = bench.tampered(500, MotorCommand::Torque(4.0), |_, i| {
            let mut all = i.phases.all();
            all[x] = zero;
            i.phases = Phases::Three(all);
        });
        opens("dead sensor", &records, Fault::CurrentSum, 5, 115);
        assert!(records.iter().all(|r| r.largest_phase_a < 15.0));
    }
}

/// Situation: the winding's inductance falls to a twentieth (shorted turns) while 7 N m are held; the loop
/// oscillates. Must hold: the bridge opens in the first or second call after a phase exceeds 15 A, and no phase
/// exceeds 40 A.
#[test]
fn a_winding_that_shorts() {
    let mut bench = Bench::ready(|_| ());
    bench.machine.held = true;
    let _ = bench.run(400, MotorCommand::Torque(7.0));
    bench.machine.params.inductance_d_h /= 20.0;
    bench.machine.params.inductance_q_h /= 20.0;
    let records = bench.run(400, MotorCommand::Torque(7.0));
    let beyond = records.iter().position(|r| r.largest_phase_a > 15.0).expect("it swings") + 1;
    let most = records.iter().map(|r| r.largest_phase_a).fold(0.0, f64::max);
    opens("shorted", &records, Fault::OverCurrent, beyond, beyond + 1);
    assert!((15.0..=40.0).contains(&most), "{most}");
    println!("{most:.1} A");
}

/// Situation: the battery is disconnected while the motor brakes the handlebar at 10 rad/s. Must hold: the capacitor
/// charges to 32 V, then the bridge opens; the bus stays below 34 V.
#[test]
fn braking_without_a_battery() {
    let mut bench = turning(10.0);
    bench.machine.params.source_ohm = 1e9;
    let records = bench.run(2000, MotorCommand::Torque(-7.0));
    opens("no battery", &records, Fault::BusHigh, 20, 2000);
    assert!((32.0..=34.0).contains(&bench.machine.bus_v), "{}", bench.machine.bus_v);
    println!("bus {:.2} V", bench.machine.bus_v);
}

/// Situation: the battery falls to 12 V behind 1 ohm while turning. Must hold: a fault when the bus is below 16 V.
#[test]
fn a_falling_battery_is_an_undervoltage() {
    let mut bench = turning(3.0);
    (bench.machine.params.source_v, bench.machine.params.source_ohm) = (12.0, 1.0);
    let records = bench.run(2000, MotorCommand::Torque(4.0));
    opens("breakdown", &records, Fault::BusLow, 5, 400);
    assert!(bench.machine.bus_v < 16.0);
}

/// Situation: twice the permitted current for a long time (a shunt read as half). Must hold: an overload fault when
/// the mean square exceeds 1.1 of the allowed one.
#[test]
fn a_mean_current_above_the_limit_is_an_overload() {
    let mut bench = Bench::ready(|c| {
        c.overload.time_s = 0.1;
        (c.overload.continuous_a, c.follow.error_a) = (2.0, 100.0);
        (c.emf.error_v, c.angle.error_v) = (50.0, 50.0);
    });
    bench.machine.held = true;
    let records = bench.tampered(4000, MotorCommand::Torque(1.0), |_, i| {
        // With the current offsets of the bench.
        i.phases = Phases::Three([5.0 + 0.9, -2.5 - 1.3, -2.5 + 0.4]);
    });
    // 25 (1 - exp(-t / 0.1 s)) = 1.1 * 4 at 19.3 ms.
    opens("overload", &records, Fault::Overload, 340, 460);
}

/// Situation: the current sensors' offsets are too large, varying, or NaN. Must hold: never ready.
#[test]
fn invalid_current_offsets_are_rejected() {
    let cases: [fn(u64, &mut Inputs); 3] = [
        |_, i| i.phases = Phases::Three([5.5, 0.0, 0.0]),
        |n, i| i.phases = Phases::Three([0.0, if n == 700 { 2.5 } else { 0.0 }, 0.0]),
        |n, i| i.phases = Phases::Two([0.0, if n == 700 { f32::NAN } else { 0.0 }]),
    ];
    for tamper in cases {
        let mut bench = Bench::ready(|_| ());
        bench.state = State::default();
        let records = bench.tampered(2100, MotorCommand::Off, tamper);
        assert_eq!(last(&records).out.faults, one(Fault::CurrentZero));
        let records = bench.run(100, MotorCommand::Torque(1.0));
        assert!(records.iter().all(|r| r.out.duties.is_none() && r.out.mode == Mode::Off));
    }
}

/// Situation: a fault condition that lasts one call; then any command. Must hold: the bridge stays open, the number
/// stays; a new start begins with the offset measurement.
#[test]
fn a_fault_latches() {
    let mut bench = turning(2.0);
    let _ = bench.call(MotorCommand::Torque(4.0), |_, i| i.temperature_c = 101.0);
    for command in
        [MotorCommand::Torque(4.0), MotorCommand::Off, MotorCommand::Align, MotorCommand::Torque(0.0)]
    {
        for r in bench.run(500, command) {
            assert!(r.out.duties.is_none() && r.out.mode == Mode::Off && r.out.faults == one(Fault::Hot));
        }
    }
    bench.state = State::default();
    assert_eq!(last(&bench.run(1, MotorCommand::Torque(1.0))).out.mode, Mode::Zeroing);
    assert_eq!(last(&bench.run(2100, MotorCommand::Off)).out.mode, Mode::Ready);
}

/// Situation: the list of faults. Must hold: numbers 1 to 24 in order, as printed in docs/motor.md, each with its name.
#[test]
fn the_numbers_stay() {
    let page = include_str!("../../../../docs/motor.md");
    for (i, fault) in FAULTS.into_iter().enumerate() {
        assert_eq!(usize::from(fault.code()), i + 1);
        let row = format!("| {} | `{fault:?}` |", fault.code());
        assert!(page.contains(&row), "docs/motor.md has no row {row}");
    }
}
