//! What switches the bridge off, numbered once and for ever.
//!
//! A number is never given to anything else. Every fault latches; `docs/motor.md` has the table.

/// Why the bridge is off. The number is the code that users see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// A phase current was beyond the trip.
    OverCurrent = 1,
    /// The winding's heat by the measured current is beyond what the limits would ever have asked for.
    Overload = 2,
    /// A measured current is not a number or beyond the sensor's range.
    CurrentSensor = 3,
    /// The current sensors' zeros are too far off, or restless.
    CurrentZero = 4,
    /// The three measured currents do not add up to nothing.
    CurrentSum = 5,
    /// The current does not follow what is asked for, though the voltage would suffice.
    CurrentAstray = 6,
    /// The same, and phase a alone carries nothing.
    PhaseALost = 7,
    /// The same, and phase b alone carries nothing.
    PhaseBLost = 8,
    /// The same, and phase c alone carries nothing.
    PhaseCLost = 9,
    /// The supply is too low.
    BusLow = 10,
    /// The supply is too high.
    BusHigh = 11,
    /// The measured supply is not a number or no voltage at all.
    BusSensor = 12,
    /// The bridge or the motor is too hot.
    Hot = 13,
    /// The measured temperature is not a number or not of this world.
    HeatSensor = 14,
    /// The encoder brought no believable sample in time.
    EncoderLost = 15,
    /// The encoder's counts are beyond its turn.
    EncoderRange = 16,
    /// The encoder's samples jump away from where the speed led.
    EncoderJump = 17,
    /// The encoder turns faster than the motor can.
    EncoderSpeed = 18,
    /// The voltage is not that which current and encoder speed explain: an encoder that stands, or a phase that is cut.
    VoltageAstray = 19,
    /// The encoder does not follow the field, or not as far.
    AlignLag = 20,
    /// The encoder follows the field the wrong way.
    AlignReversed = 21,
    /// The encoder does not come to rest in a field that rests.
    AlignRestless = 22,
    /// The torque asked for is not a number.
    Command = 23,
    /// The back-EMF does not lie where the encoder's angle puts it: an encoder that slipped, or an offset of another motor.
    AngleAstray = 24,
}

/// Every fault, in the order of the codes.
#[rustfmt::skip]
pub const FAULTS: [Fault; 24] = {
    use Fault::*;
    [
        OverCurrent, Overload, CurrentSensor, CurrentZero, CurrentSum, CurrentAstray, PhaseALost, PhaseBLost, PhaseCLost,
        BusLow, BusHigh, BusSensor, Hot, HeatSensor, EncoderLost, EncoderRange, EncoderJump, EncoderSpeed,
        VoltageAstray, AlignLag, AlignReversed, AlignRestless, Command, AngleAstray,
    ]
};

impl Fault {
    /// The number that users see and look up.
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

    /// Adds a fault, if there is one.
    pub fn take(&mut self, fault: Option<Fault>) {
        if let Some(fault) = fault {
            self.note(fault, true);
        }
    }

    /// Both sets together.
    pub const fn with(self, other: Faults) -> Self {
        Faults(self.0 | other.0)
    }

    /// Whether `fault` is in the set.
    pub const fn has(self, fault: Fault) -> bool {
        self.0 & (1 << fault.code()) != 0
    }

    /// Whether there is none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The faults in it, by rising code.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        FAULTS.into_iter().filter(move |fault| self.has(*fault))
    }
}
