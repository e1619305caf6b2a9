//! Faults as text, and the times of their effects.

use proptest::prelude::*;
use proptest::sample::select;
use sim_host::plant::{Channel, Fault, Kind, Measured, Plant, Reading, Sensor, SensorSuite};
use sim_host::ride::Start;
use tests::draws::runner;

const PERIOD_S: f64 = 1e-3;
const START: Start = Start { speed_m_s: 4.0, steer_rate_rad_s: 5.0, roll_rate_rad_s: 0.0 };

/// Every fault that can be written.
fn faults() -> impl Strategy<Value = Fault> {
    let amount = -1e6..1e6;
    let kinds = prop_oneof![
        select(vec![Kind::Stuck, Kind::Missing, Kind::Flip, Kind::Nan, Kind::Dead]),
        (0.0..10.0).prop_map(Kind::Late),
        (1e-3..10.0).prop_map(Kind::Slow),
        (0.0..1e6).prop_map(Kind::Noise),
        (0.0..1.0).prop_map(Kind::Dropout),
        (0.0..1.0).prop_map(Kind::Value),
        amount.prop_flat_map(|x| select(vec![
            Kind::Bias(x),
            Kind::Drift(x),
            Kind::Scale(x),
            Kind::Jump(x),
            Kind::Spike(x),
            Kind::Value(x)
        ])),
    ];
    let channels: Vec<Channel> = Channel::all().collect();
    let when = (0.0..3000.0, prop_oneof![Just(f64::INFINITY), 0.001..600.0]);
    (select(channels), proptest::option::of(0..3u8), kinds, when).prop_map(
        |(channel, axis, kind, (from_s, long))| Fault { channel, axis, kind, from_s, to_s: from_s + long },
    )
}

/// Situation: any fault.
/// Action: write it and parse it.
/// Must hold: an accepted text is the same fault; a rejected one is a fault that its channel cannot have, and the
/// message names the text.
#[test]
fn a_written_fault_reads_back() {
    let accepted = std::cell::Cell::new(0);
    runner(4000)
        .run(&faults(), |fault| {
            let text = fault.to_string();
            match text.parse::<Fault>() {
                Ok(read) => {
                    // An axis that the channel does not have is not written.
                    let written = Fault { axis: read.axis, ..fault };
                    prop_assert_eq!(read, written, "{}", text);
                    prop_assert_eq!(read.to_string(), text);
                    accepted.set(accepted.get() + 1);
                }
                Err(e) => prop_assert!(e.to_string().contains(&text), "{e}"),
            }
            Ok(())
        })
        .unwrap();
    assert!(accepted.get() > 1000, "{}", accepted.get());
}

/// Situation: any text, and random combinations of parts of faults.
/// Must hold: no panic.
#[test]
fn no_text_makes_the_fault_parser_panic() {
    let pieces = [
        "gyro", "path", ".x", ".", ":", "bias", "late", "=", "5ms", "-", "nan", "@", "1s", "..", "é",
        "1e400", "/s",
    ];
    let mixed = proptest::collection::vec(select(pieces.to_vec()), 0..9).prop_map(|p| p.concat());
    runner(4000)
        .run(&prop_oneof![any::<String>(), mixed], |text| {
            if let Ok(fault) = text.parse::<Fault>() {
                prop_assert_eq!(fault.to_string().parse::<Fault>().unwrap(), fault);
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: faults with an error each.
/// Must hold: the message names it, and the allowed values.
#[test]
fn an_invalid_fault_names_the_allowed_ones() {
    for (text, says) in [
        ("gyro", "gyro needs a kind of fault; there are stuck, missing, late=TIME"),
        ("x", "the channels are gyro, accel, steer, steer-rate"),
        ("gyros:stuck", "gyro, accel, steer"),
        ("gyro.w:stuck", "x, y, z"),
        ("steer.x:stuck", "one axis only"),
        ("gyro:stuk", "stuck, missing, late=TIME"),
        ("gyro:dead", "no kind `dead` of gyro"),
        ("motor:missing", "dead, stuck"),
        ("gyro:bias", "bias needs a value: bias=X"),
        ("gyro:stuck=1", "takes no value"),
        ("gyro:bias=x", "`x` is not a number"),
        ("gyro:bias=nan", "outside -1000000 to 1000000"),
        ("gyro:dropout=1.5", "outside 0 to 1"),
        ("gyro:late=5", "is not a time"),
        ("gyro:late=5min", "is not a time"),
        ("gyro:stuck@1", "is not a time"),
        ("gyro:stuck@2s..1s", "its end, 1 s, is not after 2 s"),
        ("gyro:jump=1@1s..2s", "permanent"),
        ("gyro.x:missing", "leave out the axis"),
        ("motor:slow=0s", "above 0 s"),
    ] {
        let message = text.parse::<Fault>().expect_err(text).to_string();
        assert!(message.contains(says) && message.contains(text), "{message}");
    }
}

/// The controller's measurements from t = 0 of a ride whose every reading at tick t is `truth(t)`.
fn measured(faults: &[&str], ticks: i64, truth: impl Fn(f64) -> Reading) -> Vec<Measured> {
    let faults = faults.iter().map(|text| text.parse().unwrap()).collect();
    let plant = Plant { faults, ..Plant::default() };
    let mut sensors = SensorSuite::new(&plant, PERIOD_S, &START, &Reading::steady(4.0, 9.81));
    sensors.begin();
    (0..ticks).map(|tick| sensors.measure(&plant, &truth(tick as f64), true)).collect()
}

/// Steer rate counts the ticks; the gyro counts them on every axis, by 1, 10 and 100.
fn counting(t: f64) -> Reading {
    Reading { steer_rate_rad_s: t, gyro_rad_s: [t, 10.0 * t, 100.0 * t], ..Reading::steady(4.0, 9.81) }
}

/// Situation: no fault.
/// Must hold: exactly the true values, fresh, and the clock counts microseconds.
#[test]
fn without_a_fault_the_true_values_are_measured() {
    for (tick, m) in measured(&[], 50, counting).iter().enumerate() {
        let t = tick as f64;
        assert_eq!((m.of(Sensor::Gyro).value, m.of(Sensor::Gyro).age_ticks), ([t, 10.0 * t, 100.0 * t], 0));
        assert_eq!(m.of(Sensor::SteerRate).value[0], t);
        assert_eq!((m.now_us, m.engage), (1000 * tick as u32, true));
    }
}

/// Situation: each kind of fault on the steer rate from 10 ms to 20 ms.
/// Action: 30 ticks.
/// Must hold: before tick 10 and from tick 20 on the true value; in between exactly the definition of the kind.
#[test]
fn a_fault_acts_at_exactly_its_instants() {
    type Effect = fn(f64) -> Option<f64>;
    let kinds: [(&str, Effect); 9] = [
        ("stuck", |_| Some(9.0)),
        ("missing", |_| None),
        ("late=4ms", |t| (t >= 14.0).then_some(t - 4.0)),
        ("bias=0.5", |t| Some(t + 0.5)),
        ("drift=2/s", |t| Some(t + 2.0 * ((t - 10.0) * 1e-3))),
        ("scale=3", |t| Some(3.0 * t)),
        ("flip", |t| Some(-t)),
        ("spike=7", |t| Some(if t == 10.0 { t + 7.0 } else { t })),
        ("value=-2", |_| Some(-2.0)),
    ];
    for (kind, says) in kinds {
        let values = measured(&[&format!("steer-rate:{kind}@10ms..20ms")], 30, counting);
        let (mut last, mut age) = (0.0, 0);
        for (tick, m) in values.iter().enumerate() {
            let t = tick as f64;
            let output = if (10..20).contains(&tick) { says(t) } else { Some(t) };
            age = if output.is_some() { 0 } else { age + 1 };
            last = output.unwrap_or(last);
            let held = m.of(Sensor::SteerRate);
            assert_eq!((held.value[0], held.age_ticks), (last, age), "{kind} at {tick}");
            assert_eq!(m.of(Sensor::Gyro).value[0], t, "{kind}: another sensor");
        }
    }
    let jumped = measured(&["steer-rate:jump=5@10ms"], 30, counting);
    assert_eq!(jumped[9].of(Sensor::SteerRate).value[0], 9.0);
    assert!((10..30).all(|t| jumped[t].of(Sensor::SteerRate).value[0] == t as f64 + 5.0));
    let nan = measured(&["steer-rate:nan@10ms"], 30, counting);
    assert!((0..30).all(|t| nan[t].of(Sensor::SteerRate).value[0].is_nan() == (t >= 10)));
}

/// Situation: faults on one axis, two faults on one sensor, faults on switch and clock.
/// Must hold: the other axes have the true values; faults act in their order; the switch opens; the clock stops, runs
/// fast from there on, or jumps.
#[test]
fn faults_act_on_their_axis_in_their_order() {
    let axis = measured(&["gyro.y:value=3@5ms"], 10, counting);
    assert_eq!(axis[7].of(Sensor::Gyro).value, [7.0, 3.0, 700.0]);
    let [a, b] = [["scale=2", "bias=1"], ["bias=1", "scale=2"]].map(|kinds| {
        measured(&kinds.map(|k| format!("steer-rate:{k}")).each_ref().map(|s| s.as_str()), 5, counting)
    });
    assert_eq!((a[4].of(Sensor::SteerRate).value[0], b[4].of(Sensor::SteerRate).value[0]), (9.0, 10.0));
    for fault in ["engage:missing@5ms..8ms", "engage:flip@5ms..8ms", "engage:value=0@5ms..8ms"] {
        let switch = measured(&[fault], 10, counting);
        assert!((0..10).all(|t| switch[t].engage != (5..8).contains(&t)), "{fault}");
    }
    let clock = |fault| measured(&[fault], 10, counting).iter().map(|m| m.now_us).collect::<Vec<_>>();
    assert_eq!(clock("clock:stuck@5ms")[3..8], [3000, 4000, 4000, 4000, 4000]);
    assert_eq!(clock("clock:scale=1.5@5ms")[3..8], [3000, 4000, 5000, 6500, 8000]);
    assert_eq!(clock("clock:jump=-0.01@5ms")[4..6], [4000, (-5000_i32) as u32]);
}

/// Situation: noise, and dropouts with a probability of 0.3, from 1 s on. Action: 21,000 ticks.
/// Must hold: nothing before; then a standard deviation and a share of lost samples within five standard
/// errors, on three axes that do not move together; the same numbers again with the same seed and start,
/// others with another.
#[test]
fn random_faults_have_their_statistics_and_their_seed() {
    let still = |_: f64| Reading::steady(4.0, 9.81);
    let n = 20_000.0_f64;
    let noisy = measured(&["gyro:noise=0.2@1s"], 21_000, still);
    assert!(noisy[..1000].iter().all(|m| m.of(Sensor::Gyro).value == [0.0; 3]));
    let after = &noisy[1000..];
    let mean =
        |f: &dyn Fn([f64; 3]) -> f64| after.iter().map(|m| f(m.of(Sensor::Gyro).value)).sum::<f64>() / n;
    for axis in 0..3 {
        let other = (axis + 1) % 3;
        assert!(mean(&|v| v[axis]).abs() < 5.0 * 0.2 / n.sqrt());
        let deviation = mean(&|v| v[axis] * v[axis]).sqrt();
        assert!((deviation - 0.2).abs() < 5.0 * 0.2 / (2.0 * n).sqrt(), "{deviation}");
        assert!(mean(&|v| v[axis] * v[other]).abs() < 5.0 * 0.04 / n.sqrt());
    }
    let lossy = measured(&["gyro:dropout=0.3@1s"], 21_000, still);
    let lost = lossy[1000..].iter().filter(|m| m.of(Sensor::Gyro).age_ticks > 0).count() as f64 / n;
    assert!((lost - 0.3).abs() < 5.0 * (0.21 / n).sqrt(), "{lost}");
    assert_eq!(measured(&["gyro:noise=0.2@1s"], 21_000, still), noisy);
    let first = |seed, start: Start| {
        let plant = Plant { faults: vec!["gyro:noise=1".parse().unwrap()], seed, ..Plant::default() };
        let mut sensors = SensorSuite::new(&plant, PERIOD_S, &start, &Reading::steady(4.0, 9.81));
        sensors.begin();
        sensors.measure(&plant, &still(0.0), true).of(Sensor::Gyro).value[0]
    };
    let other = Start { speed_m_s: 4.1, ..START };
    assert!(first(0, START) != first(1, START) && first(0, START) != first(0, other));
    assert_eq!(first(3, START), first(3, START));
}

/// Situation: faults of the motor on a command of 2 N m.
/// Must hold: dead is zero, a slow motor rises as `1 - exp(-t / T)`, the rest as named.
#[test]
fn motor_faults_act_on_the_command() {
    let given = |fault: &str, ticks: i64| {
        let plant = Plant { faults: vec![fault.parse().unwrap()], ..Plant::default() };
        let mut sensors = SensorSuite::new(&plant, PERIOD_S, &START, &Reading::steady(4.0, 9.81));
        sensors.begin();
        let mut one = |tick| {
            sensors.measure(&plant, &Reading::steady(4.0, 9.81), true);
            sensors.command(&plant, if tick < 3 { 1.0 } else { 2.0 })
        };
        (0..ticks).map(&mut one).collect::<Vec<_>>()
    };
    assert_eq!(given("motor:dead@2ms..4ms", 5), [1.0, 1.0, 0.0, 0.0, 2.0]);
    assert_eq!(given("motor:stuck@2ms", 5), [1.0; 5]);
    assert_eq!(given("motor:value=6@2ms", 4), [1.0, 1.0, 6.0, 6.0]);
    assert_eq!(given("motor:flip@2ms", 4), [1.0, 1.0, -1.0, -2.0]);
    assert_eq!(given("motor:late=2ms@1ms", 6), [1.0, 1.0, 1.0, 1.0, 1.0, 2.0]);
    for (tick, torque) in given("motor:slow=50ms@3ms", 200).into_iter().enumerate().skip(3) {
        let expected = 2.0 - (-((tick as f64 - 2.0) * 1e-3) / 0.05).exp();
        assert!((torque - expected).abs() < 1e-12, "{tick}: {torque} {expected}");
    }
}
