//! Frames on CAN.

use control::sensors::frame::{MISSING, Sample, Triple};
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, Calibration, Causes, Command, Mode, SensorFrame};
use link::can::*;
use proptest::prelude::*;

/// A value as a receiver must decode it: saturated to the range of a word, unknown if it was unknown.
fn expected(value: Option<f32>, unit: f32) -> Option<f64> {
    let most = 32_767.0 * f64::from(unit);
    value.filter(|value| !value.is_nan()).map(|value| f64::from(value).clamp(-most, most))
}

/// Whether a value is within half a unit, plus the rounding of an f32.
fn arrived(sent: Option<f32>, got: Option<f32>, unit: f32) -> bool {
    match (expected(sent, unit), got) {
        (Some(sent), Some(got)) => (sent - f64::from(got)).abs() <= 0.505 * f64::from(unit),
        (sent, got) => sent.is_none() && got.is_none(),
    }
}

/// Any bits, half of the time a value inside the range of every word.
fn any_value() -> impl Strategy<Value = Option<f32>> {
    prop_oneof![
        Just(None),
        any::<u32>().prop_map(|bits| Some(f32::from_bits(bits))),
        (-40.0_f32..40.0).prop_map(Some),
        (-0.01_f32..1.01).prop_map(Some),
    ]
}

fn any_mode() -> impl Strategy<Value = Mode> {
    use Mode::*;
    prop::sample::select(vec![Off, Initialise, SelfTest, Standby, Engaged, Limp, Fault])
}

fn any_move() -> impl Strategy<Value = PolarityStep> {
    use PolarityStep::*;
    prop::sample::select(vec![Lean, Steer, Push, Passed, Wrong])
}

fn state(speed_m_s: Option<f32>, authority: Option<f32>) -> State {
    State {
        mode: Mode::Engaged,
        driven: true,
        engage: false,
        polarity: PolarityStep::Passed,
        limits: ActiveLimits(0x0204),
        authority,
        speed_m_s,
        steps: 0xfe,
    }
}

/// Situation: one of each message, with values of known bytes. Must hold: the bytes are those of the table in
/// docs/link.md, worked out by hand.
#[test]
fn bytes_are_as_documented() {
    let state = Message::State(state(Some(4.3), Some(0.75)));
    let bytes = [4, 0b0000_1101, 0x04, 0x02, 150, 0xcc, 0x10, 0xfe];
    assert_eq!(state.frame(), Frame { identifier: 0x320, bytes });
    let motion = Message::Motion(Motion {
        roll_rate_rad_s: Some(-0.5),
        steer_rad: Some(0.1),
        commanded_nm: Some(-7.0),
        measured_nm: None,
    });
    let bytes = [0x0c, 0xfe, 0xe8, 0x03, 0x54, 0xf2, 0x00, 0x80];
    assert_eq!(motion.frame(), Frame { identifier: 0x321, bytes });
    let bytes = [8, 7, 6, 5, 4, 3, 2, 1];
    let causes = Message::Causes(Causes(0x0102_0304_0506_0708));
    assert_eq!(causes.frame(), Frame { identifier: 0x322, bytes });
}

/// Situation: the page that describes the frames. Must hold: its identifiers, units, ranges and times are the
/// program's.
#[test]
fn the_page_has_the_programs_numbers() {
    let page = include_str!("../../../../docs/link.md").split_whitespace().collect::<Vec<_>>().join(" ");
    let range = |unit: f32| 32_767.0 * f64::from((unit * 1e4).round()) / 1e4;
    // The longest frame of eight bytes, with the bits that are stuffed in and the pause after it.
    let ms = 3.0 * 1e3 * 135.0 / f64::from(BIT_HZ);
    for text in [
        format!("{} kbit/s", BIT_HZ / 1000),
        format!(
            "every {PERIOD_MS} ms (at most {ms:.2} ms of the bus, {:.0} %)",
            100.0 * ms / PERIOD_MS as f64
        ),
        format!("rises by {PERIOD_MS} or"),
        format!("| {STATE:#x} state | 0 |"),
        format!("| {MOTION:#x} motion | 0..2 |"),
        format!("| {CAUSES:#x} causes | 0..8 |"),
        format!("| 4 | authority, u8 | {AUTHORITY} |"),
        format!("wheel, i16 | {SPEED_M_S} m/s | -{0} to {0}, forward + |", range(SPEED_M_S)),
        format!("gyro, i16 | {ROLL_RATE_RAD_S} rad/s | -{0} to {0}, right + |", range(ROLL_RATE_RAD_S)),
        format!("steer angle, i16 | {STEER_RAD} rad | -{0} to {0}, right + |", range(STEER_RAD)),
        format!("commanded, i16 | {TORQUE_NM} N m | -{0} to {0}, right + |", range(TORQUE_NM)),
        format!("motor, i16 | {TORQUE_NM} N m | -{0} to {0}, right + |", range(TORQUE_NM)),
        format!("no sample for {STALE_TICKS} ms"),
    ] {
        assert!(page.contains(&text), "docs/link.md does not contain {text:?}");
    }
}

/// Situation: a calibration that reverses every sign and shifts the steer's zero, fresh and stale samples, a motor
/// without report. Must hold: the frame has the bicycle's values; stale or missing ones are unknown.
#[test]
fn motion_is_the_bicycles() {
    let reversed = Calibration {
        imu_rad: [0.0, 0.0, std::f32::consts::PI],
        steer_zero_rad: 0.25,
        steer_reversed: true,
        motor_reversed: true,
        ..Calibration::default()
    };
    let mut frame = SensorFrame::missing();
    frame.gyro_rad_s = Triple::fresh([0.5, 0.0, 0.0]);
    frame.steer_rad = Sample { value: 0.5, age_ticks: STALE_TICKS - 1 };
    let command = Command {
        torque_nm: 3.0,
        gain_nm_s_rad: 0.0,
        limits: ActiveLimits::default(),
        mode: Mode::Engaged,
        causes: Causes::NONE,
    };
    let motion = Motion::of(&reversed.plan(), &frame, &command);
    assert!(motion.roll_rate_rad_s.is_some_and(|rate| (rate + 0.5).abs() < 1e-5), "{motion:?}");
    assert_eq!((motion.steer_rad, motion.commanded_nm), (Some(-0.25), Some(-3.0)));
    assert_eq!(motion.measured_nm, None);
    frame.steer_rad.age_ticks = STALE_TICKS;
    frame.motor_torque_nm = Sample::fresh(3.0);
    let motion = Motion::of(&reversed.plan(), &frame, &command);
    assert_eq!((motion.steer_rad, motion.measured_nm), (None, Some(-3.0)));
    assert_eq!((fresh(1.0, 0), fresh(1.0, MISSING)), (Some(1.0), None));
}

proptest! {
    /// Situation: any numbers, NaN and infinities included. Must hold: every value is decoded within half a unit of
    /// its saturated value; NaN and unknown values are decoded as unknown; everything else is unchanged.
    #[test]
    fn messages_arrive(
        values in prop::array::uniform6(any_value()),
        (mode, polarity) in (any_mode(), any_move()),
        (driven, engage) in any::<(bool, bool)>(),
        (limits, steps, causes) in any::<(u16, u8, u64)>(),
    ) {
        let [authority, speed_m_s, roll_rate_rad_s, steer_rad, commanded_nm, measured_nm] = values;
        let limits = ActiveLimits(limits);
        let sent = State { mode, driven, engage, polarity, limits, authority, speed_m_s, steps };
        let Some(Message::State(got)) = Message::of(&Message::State(sent).frame()) else {
            return Err(TestCaseError::fail("no state"));
        };
        let rest = (got.mode, got.driven, got.engage, got.polarity, got.limits, got.steps);
        prop_assert_eq!(rest, (mode, driven, engage, polarity, limits, steps));
        prop_assert!(arrived(speed_m_s, got.speed_m_s, SPEED_M_S), "{:?} {:?}", sent, got);
        prop_assert!(arrived(authority.map(|part| part.clamp(0.0, 1.0)), got.authority, AUTHORITY), "{:?} {:?}", sent, got);

        let sent = Motion { roll_rate_rad_s, steer_rad, commanded_nm, measured_nm };
        let Some(Message::Motion(got)) = Message::of(&Message::Motion(sent).frame()) else {
            return Err(TestCaseError::fail("no motion"));
        };
        prop_assert!(arrived(roll_rate_rad_s, got.roll_rate_rad_s, ROLL_RATE_RAD_S), "{:?} {:?}", sent, got);
        prop_assert!(arrived(steer_rad, got.steer_rad, STEER_RAD), "{:?} {:?}", sent, got);
        prop_assert!(arrived(commanded_nm, got.commanded_nm, TORQUE_NM), "{:?} {:?}", sent, got);
        prop_assert!(arrived(measured_nm, got.measured_nm, TORQUE_NM), "{:?} {:?}", sent, got);

        let sent = Message::Causes(Causes(causes));
        prop_assert_eq!(Message::of(&sent.frame()), Some(sent));
    }

    /// Situation: any frame of any identifier. Must hold: it is rejected, or encoding its content gives the same
    /// content; other identifiers are rejected.
    #[test]
    fn any_frame_is_decoded_or_rejected(identifier in prop_oneof![0x320_u16..0x323, 0_u16..0x800], bytes: [u8; 8]) {
        match Message::of(&Frame { identifier, bytes }) {
            Some(message) => {
                prop_assert_eq!(message.frame().identifier, identifier);
                // Arbitrary bytes are not preserved: authorities beyond 1 come back as 1, spare bits as 0.
                let decoded = Message::of(&message.frame());
                prop_assert_eq!(decoded, decoded.and_then(|message| Message::of(&message.frame())));
            }
            None => prop_assert!(identifier == STATE || !(STATE..=CAUSES).contains(&identifier)),
        }
    }
}
