//! The database of the product's own frames.

use super::{column, group, read_with, remarks};
use control::fault::CAUSES;
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, Causes, Mode};
use link::can::{self, Message, Motion, State};
use proptest::prelude::*;
use sim_host::recording::database::Database;
use sim_host::recording::frames::Id;
use std::path::{Path, PathBuf};
use tests::draws::runner;

pub(crate) fn database() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/can/assist.dbc")
}

fn parsed() -> Database {
    Database::parse(&std::fs::read(database()).unwrap()).unwrap()
}

/// The signals of a frame of the board, by name.
fn signals(database: &Database, message: &Message) -> Vec<(String, f64)> {
    let frame = message.frame();
    let id = Id { number: u32::from(frame.identifier), extended: false };
    let (_, layout) = database.message(id).expect("a message of the board");
    let names = layout.signals.iter().map(|signal| signal.name.clone());
    names.zip(layout.values(&frame.bytes)).collect()
}

fn value(signals: &[(String, f64)], name: &str) -> f64 {
    signals.iter().find(|(other, _)| other == name).unwrap_or_else(|| panic!("no {name}")).1
}

/// Whether a signal is the board's own decoded value, to the rounding of an f32; NaN if unknown.
fn is(got: f64, value: Option<f32>) -> bool {
    match value {
        Some(value) => (got - f64::from(value)).abs() <= 1e-6 * (1.0 + got.abs()),
        None => got.is_nan(),
    }
}

fn any_value() -> impl Strategy<Value = Option<f32>> {
    prop_oneof![
        Just(None),
        (-70.0_f32..70.0).prop_map(Some),
        (-0.01_f32..1.01).prop_map(Some),
        Just(Some(f32::NAN))
    ]
}

/// Any message of the board.
pub(crate) fn any_message() -> impl Strategy<Value = Message> {
    use Mode::*;
    let modes = prop::sample::select(vec![Off, Initialise, SelfTest, Standby, Engaged, Limp, Fault]);
    let moves = prop::sample::select(vec![
        PolarityStep::Lean,
        PolarityStep::Steer,
        PolarityStep::Push,
        PolarityStep::Passed,
        PolarityStep::Wrong,
    ]);
    let rest = any::<(bool, bool, u16, u8)>();
    let state = (any_value(), any_value(), modes, moves, rest).prop_map(
        |(authority, speed_m_s, mode, polarity, (driven, engage, limits, steps))| {
            let limits = ActiveLimits(limits);
            Message::State(State { mode, driven, engage, polarity, limits, authority, speed_m_s, steps })
        },
    );
    let motion = prop::array::uniform4(any_value()).prop_map(
        |[roll_rate_rad_s, steer_rad, commanded_nm, measured_nm]| {
            Message::Motion(Motion { roll_rate_rad_s, steer_rad, commanded_nm, measured_nm })
        },
    );
    prop_oneof![state, motion, any::<u64>().prop_map(|causes| Message::Causes(Causes(causes)))]
}

/// Situation: any state, motion and causes.
/// Action: encode with the firmware's encoder, decode with the database.
/// Must hold: every number is that of the firmware's decoder; unknown values are NaN.
#[test]
fn the_database_reads_what_the_firmware_writes() {
    let database = parsed();
    runner(2000)
        .run(&any_message(), |sent| {
            let got = signals(&database, &sent);
            match Message::of(&sent.frame()).expect("a message of the board") {
                Message::State(state) => {
                    prop_assert!(is(value(&got, "Authority"), state.authority), "{got:?}");
                    prop_assert!(is(value(&got, "Speed"), state.speed_m_s), "{got:?}");
                    let whole = [
                        ("Mode", state.mode as u8 as f64),
                        ("Driven", f64::from(state.driven)),
                        ("EngageRequest", f64::from(state.engage)),
                        ("PolarityMove", state.polarity as u8 as f64),
                        ("Steps", f64::from(state.steps)),
                    ];
                    prop_assert!(
                        whole.iter().all(|(name, expected)| value(&got, name) == *expected),
                        "{got:?}"
                    );
                    for (name, bit) in LIMITS {
                        prop_assert_eq!(value(&got, name), f64::from(state.limits.contains(bit)), "{}", name);
                    }
                }
                Message::Motion(motion) => {
                    for (name, expected) in [
                        ("RollRate", motion.roll_rate_rad_s),
                        ("Steer", motion.steer_rad),
                        ("TorqueCommanded", motion.commanded_nm),
                        ("TorqueMeasured", motion.measured_nm),
                    ] {
                        prop_assert!(is(value(&got, name), expected), "{name}: {got:?}, {expected:?}");
                    }
                }
                Message::Causes(causes) => {
                    for cause in CAUSES {
                        prop_assert_eq!(
                            value(&got, cause.name()),
                            f64::from(causes.has(cause)),
                            "{:?}",
                            cause
                        );
                    }
                }
            }
            Ok(())
        })
        .unwrap();
}

pub(crate) const LIMITS: [(&str, ActiveLimits); 10] = [
    ("LimitTaper", ActiveLimits::TAPER),
    ("LimitMagnitude", ActiveLimits::MAGNITUDE),
    ("LimitRate", ActiveLimits::RATE),
    ("LimitSpeed", ActiveLimits::SPEED),
    ("LimitRiderTorque", ActiveLimits::RIDER_TORQUE),
    ("LimitRiderMotion", ActiveLimits::RIDER_MOTION),
    ("LimitWindow", ActiveLimits::WINDOW),
    ("LimitEndStop", ActiveLimits::END_STOP),
    ("LimitLimp", ActiveLimits::LIMP),
    ("LimitAuthority", ActiveLimits::AUTHORITY),
];

/// Situation: the shipped database.
/// Action: check its content.
/// Must hold: three messages, no signal that the firmware does not have, one for every cause, nothing unused; units
/// as in docs/link.md.
#[test]
fn the_database_has_the_boards_signals_and_no_others() {
    let database = parsed();
    let ids: Vec<u32> = database.messages.iter().map(|message| message.id.number).collect();
    assert_eq!(ids, [can::STATE, can::MOTION, can::CAUSES].map(u32::from));
    let counts: Vec<usize> = database.messages.iter().map(|message| message.signals.len()).collect();
    assert_eq!(counts, [7 + LIMITS.len(), 4, CAUSES.len()]);
    assert!(database.messages.iter().all(|message| message.unused.is_empty() && message.bytes() == 8));
    let units: Vec<&str> = database.messages[1].signals.iter().map(|signal| signal.unit.as_str()).collect();
    assert_eq!(units, ["rad/s", "rad", "N m", "N m"]);
    let steps: Vec<f32> = database.messages[1].signals.iter().map(|signal| signal.factor as f32).collect();
    let unit = [can::ROLL_RATE_RAD_S, can::STEER_RAD, can::TORQUE_NM, can::TORQUE_NM];
    assert_eq!(steps, unit);
}

/// Situation: a log of the board's own frames.
/// Action: read it with the shipped database.
/// Must hold: three groups, the numbers of the example frames in docs/link.md.
#[test]
fn a_log_of_the_board_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("board.log");
    let text = "(12.000000) can0 320#040D040296CC10FE\n(12.000100) can0 321#0CFEE80354F20080\n\
                (12.000200) can0 322#0807060504030201\n";
    std::fs::write(&log, text).unwrap();
    let recording = read_with(&log, &[database()]).unwrap();
    assert_eq!(remarks(&recording), [] as [String; 0]);
    let at = |message, signal| column(group(&recording, message), signal)[0];
    assert_eq!((at("State", "Mode"), at("State", "LimitWindow")), (4.0, 0.0));
    assert!((at("State", "Speed") - 4.3).abs() < 1e-9 && (at("State", "Authority") - 0.75).abs() < 1e-9);
    assert!((at("Motion", "RollRate") + 0.5).abs() < 1e-9 && (at("Motion", "Steer") - 0.1).abs() < 1e-9);
    assert!(at("Motion", "TorqueMeasured").is_nan());
    assert_eq!(at("Causes", "GyroJump"), 1.0);
}
