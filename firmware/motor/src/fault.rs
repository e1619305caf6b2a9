//! Faults that open the bridge, with fixed numbers.
//!
//! A number is never reused. Every fault latches; `docs/motor.md` has the table.

/// Reason for an open bridge. The number is the code that users see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// A phase current exceeded the trip.
    OverCurrent = 1,
    /// The modelled heat of the winding exceeded the value that the current limits permit.
    Overload = 2,
    /// A measured current is NaN or outside the sensor's range.
    CurrentSensor = 3,
    /// The current sensors' offsets are too large or vary.
    CurrentZero = 4,
    /// The sum of the three measured currents is not zero.
    CurrentSum = 5,
    /// The current does not follow its set-point, although the voltage suffices.
    CurrentTracking = 6,
    /// As above, and only phase a carries no current.
    PhaseALost = 7,
    /// As above, and only phase b carries no current.
    PhaseBLost = 8,
    /// As above, and only phase c carries no current.
    PhaseCLost = 9,
    /// Supply voltage too low.
    BusLow = 10,
    /// Supply voltage too high.
    BusHigh = 11,
    /// The measured supply voltage is NaN or implausible.
    BusSensor = 12,
    /// The bridge or the motor is too hot.
    Hot = 13,
    /// The measured temperature is NaN or implausible.
    HeatSensor = 14,
    /// No valid encoder sample within the timeout.
    EncoderLost = 15,
    /// The encoder's counts exceed one turn.
    EncoderRange = 16,
    /// The encoder's samples jump away from the extrapolated angle.
    EncoderJump = 17,
    /// The encoder's speed exceeds the motor's largest.
    EncoderSpeed = 18,
    /// Current and encoder speed do not explain the voltage: a stuck encoder, or an open phase.
    VoltageResidual = 19,
    /// The encoder does not follow the field by a quarter turn.
    AlignLag = 20,
    /// The encoder follows the field in the wrong direction.
    AlignReversed = 21,
    /// The encoder does not come to rest in a constant field.
    AlignRestless = 22,
    /// The requested torque is NaN or infinite.
    Command = 23,
    /// The direction of the back-EMF contradicts the encoder's angle: a slipped encoder, or the offset of another
    /// motor.
    AngleMismatch = 24,
}

/// Every fault, in the order of the codes.
#[rustfmt::skip]
pub const FAULTS: [Fault; 24] = {
    use Fault::*;
    [
        OverCurrent, Overload, CurrentSensor, CurrentZero, CurrentSum, CurrentTracking, PhaseALost, PhaseBLost, PhaseCLost,
        BusLow, BusHigh, BusSensor, Hot, HeatSensor, EncoderLost, EncoderRange, EncoderJump, EncoderSpeed,
        VoltageResidual, AlignLag, AlignReversed, AlignRestless, Command, AngleMismatch,
    ]
};

impl Fault {
    /// The code that users see and look up.
    pub const fn code(self) -> u8 {
        self as u8
    }
}

/// A set of faults: bit *n* is number *n*.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(pub u32);

impl Faults {
    /// No fault.
    pub const NONE: Faults = Faults(0);

    /// Adds `fault` when `present`.
    pub fn note(&mut self, fault: Fault, present: bool) {
        if present {
            self.0 |= 1 << fault.code();
        }
    }

    /// Adds a fault, if any.
    pub fn take(&mut self, fault: Option<Fault>) {
        if let Some(fault) = fault {
            self.note(fault, true);
        }
    }

    /// Union of both sets.
    pub const fn with(self, other: Faults) -> Self {
        Faults(self.0 | other.0)
    }

    /// Whether `fault` is in the set.
    pub const fn has(self, fault: Fault) -> bool {
        self.0 & (1 << fault.code()) != 0
    }

    /// Whether the set is empty.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The faults of the set, by rising code.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        FAULTS.into_iter().filter(move |fault| self.has(*fault))
    }
}
