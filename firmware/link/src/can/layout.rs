//! The frames as data: the encoder, the decoder and `data/can/assist.dbc` are made from these tables.

use super::signal::{Content, Element, Quantity, Signal};
use super::{AUTHORITY, CAUSES, MOTION, ROLL_RATE_RAD_S, SPEED_M_S, STATE, STEER_RAD, TORQUE_NM};
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, LIMITS, Mode};

/// Layout of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Name in databases.
    pub name: &'static str,
    /// Identifier, 11 bits.
    pub identifier: u16,
    /// Its signals.
    pub signals: &'static [Signal],
    /// Meaning, in one or two sentences.
    pub meaning: &'static str,
}

/// Every frame, the most urgent first.
pub const LAYOUTS: [Layout; 3] = [
    Layout {
        name: "State",
        identifier: STATE,
        signals: &[MODE, DRIVEN, ENGAGE, POLARITY, LIMITED, AUTHORITY_PART, SPEED, STEPS],
        meaning: "State of the controller. Unknown after 100 ms without a frame, and while Steps does not change.",
    },
    Layout {
        name: "Motion",
        identifier: MOTION,
        signals: &[ROLL_RATE, STEER, COMMANDED, MEASURED],
        meaning: "Motion of the bicycle in its own axes, positive to the right, by its sensors before validation.",
    },
    Layout {
        name: "Causes",
        identifier: CAUSES,
        signals: &[PRESENT],
        meaning: "Causes that prevent or reduce torque, or are reported: the bit of each cause's number.",
    },
];

pub(super) const MODE: Signal = Signal {
    name: "Mode",
    start: 0,
    bits: 8,
    content: Content::Choice(mode),
    meaning: "Mode of the controller.",
};
pub(super) const DRIVEN: Signal = flag("Driven", 8, "The motor accepts torque.");
pub(super) const ENGAGE: Signal = flag("EngageRequest", 9, "The rider's switch requests assist.");
pub(super) const POLARITY: Signal = Signal {
    name: "PolarityMove",
    start: 10,
    bits: 3,
    content: Content::Choice(polarity),
    meaning: "Next move of the polarity check.",
};
pub(super) const LIMITED: Signal = Signal {
    name: "Limits",
    start: 16,
    bits: 16,
    content: Content::Set(limit),
    meaning: "Limits that changed the torque.",
};
pub(super) const PART: Quantity = Quantity { step: AUTHORITY, unit: "", codes: (0, 200), unknown: 255 };
pub(super) const AUTHORITY_PART: Signal =
    quantity("Authority", 32, 8, PART, "Fraction of the torque that is permitted.");
pub(super) const FORWARD: Quantity = word(SPEED_M_S, "m/s");
pub(super) const SPEED: Signal =
    quantity("Speed", 40, 16, FORWARD, "Rate of the rear wheel times its radius, positive forward.");
pub(super) const STEPS: Signal = Signal {
    name: "Steps",
    start: 56,
    bits: 8,
    content: Content::Count,
    meaning: "Lowest byte of the number of control steps; while it does not change, control has stopped.",
};

pub(super) const RATE: Quantity = word(ROLL_RATE_RAD_S, "rad/s");
pub(super) const ROLL_RATE: Signal =
    quantity("RollRate", 0, 16, RATE, "Rate about the forward axis, by the gyro.");
pub(super) const ANGLE: Quantity = word(STEER_RAD, "rad");
pub(super) const STEER: Signal = quantity("Steer", 16, 16, ANGLE, "Steer angle.");
pub(super) const TORQUE: Quantity = word(TORQUE_NM, "N m");
pub(super) const COMMANDED: Signal =
    quantity("TorqueCommanded", 32, 16, TORQUE, "Steer torque requested from the motor.");
pub(super) const MEASURED: Signal =
    quantity("TorqueMeasured", 48, 16, TORQUE, "Steer torque reported by the motor.");

const PRESENT: Signal = Signal {
    name: "Causes",
    start: 0,
    bits: 64,
    content: Content::Set(cause),
    meaning: "Causes that prevent or reduce torque, or are reported.",
};

const fn flag(name: &'static str, start: u8, meaning: &'static str) -> Signal {
    Signal { name, start, bits: 1, content: Content::Flag, meaning }
}

const fn quantity(
    name: &'static str,
    start: u8,
    bits: u8,
    quantity: Quantity,
    meaning: &'static str,
) -> Signal {
    Signal { name, start, bits, content: Content::Quantity(quantity), meaning }
}

/// A quantity of 16 bits.
const fn word(step: f32, unit: &'static str) -> Quantity {
    Quantity { step, unit, codes: (-i16::MAX, i16::MAX), unknown: i16::MIN }
}

fn mode(number: u8) -> Option<&'static str> {
    Mode::numbered(number).map(Mode::name)
}

fn polarity(number: u8) -> Option<&'static str> {
    Some(match PolarityStep::numbered(number)? {
        PolarityStep::Lean => "lean",
        PolarityStep::Steer => "steer",
        PolarityStep::Push => "push",
        PolarityStep::Passed => "passed",
        PolarityStep::Wrong => "wrong",
    })
}

fn limit(bit: u8) -> Option<Element> {
    const NAMES: [(ActiveLimits, &str); LIMITS.len()] = [
        (ActiveLimits::TAPER, "LimitTaper"),
        (ActiveLimits::MAGNITUDE, "LimitMagnitude"),
        (ActiveLimits::RATE, "LimitRate"),
        (ActiveLimits::SPEED, "LimitSpeed"),
        (ActiveLimits::RIDER_TORQUE, "LimitRiderTorque"),
        (ActiveLimits::RIDER_MOTION, "LimitRiderMotion"),
        (ActiveLimits::WINDOW, "LimitWindow"),
        (ActiveLimits::END_STOP, "LimitEndStop"),
        (ActiveLimits::LIMP, "LimitLimp"),
        (ActiveLimits::AUTHORITY, "LimitAuthority"),
    ];
    let named = LIMITS.iter().find(|named| u32::from(named.limit.0) == 1 << bit)?;
    let (_, name) = NAMES.iter().find(|(limit, _)| *limit == named.limit)?;
    Some(Element { name, meaning: named.meaning })
}

fn cause(bit: u8) -> Option<Element> {
    let cause = control::CAUSES.iter().find(|cause| cause.code() == bit)?;
    Some(Element { name: cause.name(), meaning: cause.meaning() })
}
