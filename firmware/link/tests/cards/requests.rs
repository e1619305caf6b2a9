//! Reading and setting parameters over the link.

use control::Config;
use control::law::LAWS;
use link::Key;
use link::message::Message;
use link::page::PAGE_BYTES;
use link::parameter_list::{each, get};
use link::rejection::{RejectReason, Rejection};
use link::requests::{answer, set};
use proptest::prelude::*;

/// Sends a request and passes the answer to `read`.
pub(crate) fn answer_to<T>(
    config: &mut Config,
    engaged: bool,
    request: &Message<'_>,
    read: impl FnOnce(Option<Message<'_>>) -> T,
) -> T {
    read(answer(&Config::product(), config, engaged, request, &mut [0; PAGE_BYTES]))
}

/// Sends a request that must be rejected; returns the rejection and checks that nothing changed.
fn rejection(config: &Config, engaged: bool, request: &Message<'_>) -> (RejectReason, String) {
    let mut changed = config.clone();
    let rejection = answer_to(&mut changed, engaged, request, |answer| match answer {
        Some(Message::Rejected(rejection)) => (rejection.reason, rejection.to_string()),
        other => panic!("{request:?}: {other:?}"),
    });
    assert_eq!(changed, *config, "{request:?}");
    rejection
}

fn to(key: &'static str, value: impl Into<Option<f32>>) -> Message<'static> {
    Message::Set { key: Key::whole(key), value: value.into() }
}

/// Situation: every listed parameter.
/// Action: read each, set it to its value, to its limits, and slightly beyond them.
/// Must hold: the value; beyond the limits rejected as out of range with key, value and range; a limit is accepted, or
/// rejected with the reason; a rejection changes nothing.
#[test]
fn every_parameter_is_read_and_set() {
    let mut parameters = Vec::new();
    each(&mut Config::product(), |one| {
        parameters.push(*one);
        one.value
    });
    let (mut taken, mut not) = (0, 0);
    for one in parameters {
        let key = one.key();
        let value = answer_to(&mut Config::product(), true, &Message::Get { key }, |answer| {
            answer.map(|a| format!("{a:?}"))
        });
        assert_eq!(value, Some(format!("{:?}", Message::Value { key, value: one.value })));
        for end in [one.leaf.min, one.leaf.max] {
            let mut config = Config::product();
            match set(&mut config, key, Some(end)) {
                Ok(()) => {
                    assert_eq!(get(&config, key).and_then(|now| now.value), Some(end), "{key}");
                    assert!(config.plan().is_ok());
                    taken += 1;
                }
                Err(rejection) => {
                    assert_ne!(rejection.to_string(), "");
                    assert_eq!(config, Config::product(), "{key}");
                    not += 1;
                }
            }
        }
        let above = one.leaf.max + one.leaf.max.abs().max(1.0) * 0.01;
        for beyond in [above, one.leaf.min - 1.0, f32::NAN, f32::INFINITY] {
            let mut config = Config::product();
            let rejection = set(&mut config, key, Some(beyond)).expect_err("out of range");
            assert_eq!(
                (rejection.reason, rejection.key, rejection.min, rejection.max),
                (RejectReason::OutOfRange, key, one.leaf.min, one.leaf.max)
            );
            assert_eq!(rejection.value.to_bits(), beyond.to_bits());
            assert_eq!(config, Config::product());
        }
    }
    println!("limits: {taken} accepted, {not} rejected");
    assert!(taken > 250 && not > 20, "{taken} {not}");
}

/// Situation: torque can flow.
/// Action: set, set the law, store, reset; get, list.
/// Must hold: every change is rejected as such, every read is answered.
#[test]
fn nothing_is_changed_while_engaged() {
    let config = Config::product();
    for request in [
        to("rate_hz", 500.0),
        to("nonsense", 1.0),
        Message::SetLaw(&[0, 0, 0, 0, 0, 0]),
        Message::Store,
        Message::Reset,
    ] {
        assert_eq!(
            rejection(&config, true, &request),
            (RejectReason::Engaged, "rejected while engaged".into())
        );
    }
    for request in [Message::List { from: 0 }, Message::Get { key: Key::whole("law") }, Message::GetLaw] {
        answer_to(&mut config.clone(), true, &request, |answer| {
            assert!(!matches!(answer, Some(Message::Rejected(_)) | None))
        });
    }
}

/// Situation: requests with every kind of mistake.
/// Action: send each.
/// Must hold: rejected with a text that names key, value and range; nothing changed.
#[test]
fn a_mistake_is_named() {
    let config = Config::product();
    let mut untapered = config.clone();
    untapered.limits.taper = None;
    let beyond = LAWS.len();
    let no_law = |number: usize| format!("law = {number} is outside 0 to {}", beyond - 1);
    let (first_beyond, far_beyond) = (no_law(beyond), no_law(200));
    for (config, request, why, text) in [
        (&config, to("limits.max_torque", 1.0), RejectReason::UnknownKey, "no parameter limits.max_torque"),
        (&config, Message::Get { key: Key::whole("") }, RejectReason::UnknownKey, "no parameter "),
        (&config, to("law.cl2.k", 1.0), RejectReason::UnknownKey, "no parameter law.cl2.k"),
        (&config, to("rate_hz", 99.0), RejectReason::OutOfRange, "rate_hz = 99 is outside 100 to 10000"),
        (&config, to("rate_hz", None), RejectReason::NeverOff, "rate_hz can't be off, only 100 to 10000"),
        (
            &config,
            to("rate_hz", 100.0),
            RejectReason::OutOfRange,
            "input.max_gap_ms = 5 is outside 10 to 1000",
        ),
        (
            &config,
            to("input.max_gap_ms", 0.1),
            RejectReason::OutOfRange,
            "input.max_gap_ms = 0.1 is outside 1 to 1000",
        ),
        (
            &config,
            to("permit.ramp_in_ticks", 0.5),
            RejectReason::NotWhole,
            "permit.ramp_in_ticks = 0.5 is not a whole number of 0 to 20000",
        ),
        (
            &config,
            to("calibration.motor_reversed", 0.5),
            RejectReason::NotWhole,
            "calibration.motor_reversed = 0.5 is not a whole number of 0 to 1",
        ),
        (&config, to("rate_hz", 500.0), RejectReason::OutOfRange, "rate_hz = 500 is outside 1000 to 1000"),
        (&config, to("law", beyond as f32), RejectReason::OutOfRange, first_beyond.as_str()),
        (&config, to("law", 6.0), RejectReason::OutOfRange, "law.cl2.k = 0 is outside 0.001 to 20"),
        (&config, to("law", 7.0), RejectReason::OutOfRange, "law.table.points = 0 is outside 1 to 32"),
        (
            &config,
            to("calibration.polarity_checked", 1.0),
            RejectReason::OnlyByCheck,
            "calibration.polarity_checked is set by the polarity check alone",
        ),
        (
            &untapered,
            to("limits.taper.full_m_s", 2.0),
            RejectReason::GroupOff,
            "limits.taper.full_m_s is in a group that is off; switch that on first",
        ),
        (&config, Message::SetLaw(&[0, 0]), RejectReason::Malformed, "the request can't be read"),
        (&config, Message::SetLaw(&[200, 0, 0, 0, 0, 0]), RejectReason::OutOfRange, far_beyond.as_str()),
        (
            &config,
            Message::SetLaw(&[6, 0, 0, 0, 0, 0]),
            RejectReason::OutOfRange,
            "law.cl2.k = 0 is outside 0.001 to 20",
        ),
    ] {
        assert_eq!(rejection(config, false, &request), (why, text.into()), "{request:?}");
    }
}

/// Situation: two parameters that must be consistent, each set within its own range.
/// Action: set one to a value that is inconsistent with the other.
/// Must hold: rejected by the check of the configuration; nothing changed.
#[test]
fn the_configuration_is_checked_as_a_whole() {
    let config = Config::product();
    let taper = config.limits.taper.expect("a taper");
    let request = to("limits.taper.full_m_s", taper.zero_m_s / 2.0);
    let (why, text) = rejection(&config, false, &request);
    assert_eq!(why, RejectReason::OutOfRange);
    assert!(text.contains("limits.taper"), "{text}");
}

/// Situation: a bicycle whose polarity check was passed.
/// Action: set a calibration parameter; another parameter; `polarity_checked` to off.
/// Must hold: the calibration's change clears `polarity_checked`, the other does not; off is allowed, on is not.
#[test]
fn a_changed_calibration_is_an_unchecked_one() {
    let mut checked = Config::product();
    checked.calibration.polarity_checked = true;
    for (key, value, stays) in [
        ("calibration.motor_reversed", 1.0, false),
        ("calibration.steer_zero_rad", 0.1, false),
        ("calibration.polarity_checked", 0.0, false),
        ("calibration.steer_zero_rad", 0.0, true),
        ("calibration.polarity_checked", 1.0, true),
        ("permit.ramp_in_ticks", 300.0, true),
    ] {
        let mut config = checked.clone();
        set(&mut config, Key::whole(key), Some(value)).expect("allowed");
        assert_eq!(config.calibration.polarity_checked, stays, "{key}");
        assert_eq!(get(&config, Key::whole(key)).and_then(|parameter| parameter.value), Some(value));
    }
    answer_to(&mut checked, false, &Message::Reset, |answer| assert_eq!(answer, Some(Message::Done)));
    assert_eq!(checked, Config::product());
}

/// Situation: requests that the caller has to answer, and messages that are no requests.
/// Action: send them.
/// Must hold: no answer from this function, nothing changed.
#[test]
fn requests_to_others_are_not_answered() {
    for request in [
        Message::AskHello,
        Message::Store,
        Message::ListFaults { from: 0 },
        Message::ClearFaults,
        Message::PilReset,
        Message::Done,
        Message::WrongVersion { theirs: 2 },
    ] {
        let mut config = Config::product();
        answer_to(&mut config, false, &request, |answer| assert_eq!(answer, None));
        assert_eq!(config, Config::product());
    }
}

proptest! {
    /// Situation: any sequence of sets of any parameter to anything.
    /// Action: carry them out one after the other.
    /// Must hold: after each the configuration passes `plan`, and is unchanged if the request was rejected.
    #[test]
    fn no_set_leaves_an_invalid_configuration(
        sets in prop::collection::vec((any::<prop::sample::Index>(), any::<u32>(), 0.0_f32..1.0, 0..4_u8), 1..12)
    ) {
        let mut config = Config::product();
        for (which, bits, share, how) in sets {
            let mut parameters = Vec::new();
            each(&mut config.clone(), |one| {
                parameters.push(*one);
                one.value
            });
            let one = parameters[which.index(parameters.len())];
            let inside = one.leaf.min + share * (one.leaf.max - one.leaf.min);
            let value = [None, Some(f32::from_bits(bits)), Some(inside), Some(inside.round())][usize::from(how)];
            let before = config.clone();
            let done = set(&mut config, one.key(), value).map_err(|Rejection { reason, .. }| reason);
            prop_assert!(config.clone().plan().is_ok(), "{} {:?}", one.key(), value);
            prop_assert!(done.is_ok() || config == before, "{} {:?}", one.key(), value);
        }
    }
}
