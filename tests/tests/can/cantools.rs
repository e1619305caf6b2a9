//! The shipped database in cantools, and the encoder's table behind it.

use super::product::{LIMITS, any_message, database};
use control::fault::CAUSES;
use control::sensors::polarity::PolarityStep;
use link::can::Message;
use proptest::strategy::{Strategy, ValueTree};
use serde_json::{Map, Value, json};
use std::ffi::OsStr;
use tests::draws::runner;
use tests::python;

/// Every signal of a message by its name in the database, with the values of the firmware's decoder.
fn signals(message: &Message) -> Map<String, Value> {
    let known = |value: Option<f32>| value.map_or(json!("not known"), |value| json!(value));
    let pairs: Vec<(String, Value)> = match Message::of(&message.frame()).expect("a message of the board") {
        Message::State(state) => {
            let limits = LIMITS
                .iter()
                .map(|(name, limit)| ((*name).to_owned(), json!(u8::from(state.limits.contains(*limit)))));
            let rest = [
                ("Mode", json!(state.mode.name())),
                ("Driven", json!(u8::from(state.driven))),
                ("EngageRequest", json!(u8::from(state.engage))),
                (
                    "PolarityMove",
                    json!(match state.polarity {
                        PolarityStep::Lean => "lean",
                        PolarityStep::Steer => "steer",
                        PolarityStep::Push => "push",
                        PolarityStep::Passed => "passed",
                        PolarityStep::Wrong => "wrong",
                    }),
                ),
                ("Authority", known(state.authority)),
                ("Speed", known(state.speed_m_s)),
                ("Steps", json!(state.steps)),
            ];
            limits.chain(rest.map(|(name, value)| (name.to_owned(), value))).collect()
        }
        Message::Motion(motion) => [
            ("RollRate", motion.roll_rate_rad_s),
            ("Steer", motion.steer_rad),
            ("TorqueCommanded", motion.commanded_nm),
            ("TorqueMeasured", motion.measured_nm),
        ]
        .map(|(name, value)| (name.to_owned(), known(value)))
        .to_vec(),
        Message::Causes(causes) => {
            CAUSES.map(|cause| (cause.name().to_owned(), json!(u8::from(causes.has(cause))))).to_vec()
        }
    };
    pairs.into_iter().collect()
}

/// Situation: the shipped database. Must hold: it is the one that `cargo xtask dbc` makes from the encoder's table.
#[test]
fn the_database_is_made_from_the_encoders_table() {
    let shipped = std::fs::read_to_string(database()).unwrap();
    assert!(shipped == xtask::dbc::text(), "run: cargo xtask dbc");
}

/// Situation: 600 messages of any content, encoded by the firmware's encoder.
/// Action: decode with the shipped database in cantools, and with its KCD, made by `cantools convert`.
/// Must hold: every signal has the value of the firmware's decoder, and there are no others; every message has its
/// cycle time and every signal a comment.
#[test]
fn cantools_reads_every_signal() {
    let Some(python) = python::venv("can") else { return };
    let mut runner = runner(1);
    let frames: Vec<Value> = (0..600)
        .map(|_| {
            let message = any_message().new_tree(&mut runner).expect("a message").current();
            let frame = message.frame();
            let bytes: String = frame.bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            json!({"id": frame.identifier, "bytes": bytes, "signals": signals(&message)})
        })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let list = folder.path().join("frames.json");
    std::fs::write(&list, json!(frames).to_string()).unwrap();
    let done = python::checked(&python, "can_database.py", &[database().as_os_str(), list.as_os_str()]);
    let compared: usize = done.trim().parse().expect("the number of compared values");
    // Two decoders; of each kind of message about 200, with 4 to 59 signals.
    assert!((20_000..60_000).contains(&compared), "{compared}");
}

/// Situation: an index where nothing answers.
/// Action: install a package from it, with pip as the environments of the tests do.
/// Must hold: it fails, and by its messages for want of a network; a version that does not exist is another failure.
#[test]
fn a_missing_network_is_recognised() {
    let Some(python) = python::venv("can") else { return };
    let pip = ["-m", "pip", "install", "--retries", "1", "--index-url", "http://127.0.0.1:9/", "no-such"];
    let done = python::run(&python, pip.map(OsStr::new));
    assert_ne!(done.code, Some(0));
    assert!(python::unreachable(&done.stderr), "{}", done.stderr);
    assert!(!python::unreachable("ERROR: No matching distribution found for cantools==999"));
}
