//! Causes that forbid, reduce or accompany torque, each with a permanent number.
//!
//! A number is never reused, even after its cause is removed. `docs/faults` has one page per cause.

/// Declares every cause once: its meaning (the doc comment, one sentence), its name and its number.
macro_rules! causes {
    ($(#[doc = $meaning:literal] $name:ident = $code:literal,)*) => {
        /// Reason why torque is forbidden or reduced, or a condition that is only reported. The number is the code
        /// shown to users.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
        #[repr(u8)]
        pub enum Cause {
            $(#[doc = $meaning] $name = $code,)*
        }

        /// Every cause, in the order of the codes.
        pub const CAUSES: [Cause; [$($code),*].len()] = [$(Cause::$name),*];

        impl Cause {
            /// Name shown to users.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Cause::$name => stringify!($name),)*
                }
            }

            /// Meaning, in one sentence.
            pub const fn meaning(self) -> &'static str {
                match self {
                    $(Cause::$name => $meaning.trim_ascii_start(),)*
                }
            }
        }
    };
}

causes! {
    /// The gyro delivered no valid sample within its timeout.
    GyroLost = 1,
    /// The gyro's samples are NaN or beyond its range.
    GyroRange = 2,
    /// The gyro's samples change faster than a bicycle can move.
    GyroJump = 3,
    /// The gyro repeats the same sample while the bicycle moves.
    GyroStuck = 4,
    /// The accelerometer delivered no valid sample within its timeout.
    AccelLost = 5,
    /// The accelerometer's samples are NaN or beyond its range.
    AccelRange = 6,
    /// The accelerometer's samples jump.
    AccelJump = 7,
    /// The accelerometer repeats the same sample while the bicycle moves.
    AccelStuck = 8,
    /// The steer angle sensor delivered no valid sample within its timeout.
    SteerLost = 9,
    /// The steer angle is NaN or beyond its range.
    SteerRange = 10,
    /// The steer angle jumps.
    SteerJump = 11,
    /// The steer angle does not change while the handlebar turns.
    SteerStuck = 12,
    /// The steer rate sensor delivered no valid sample within its timeout.
    SteerRateLost = 13,
    /// The steer rate is NaN or beyond its range.
    SteerRateRange = 14,
    /// The steer rate jumps.
    SteerRateJump = 15,
    /// The steer rate does not change while the handlebar turns.
    SteerRateStuck = 16,
    /// The front wheel's sensor delivered no valid sample within its timeout.
    FrontWheelLost = 17,
    /// The front wheel's speed is NaN or beyond its range.
    FrontWheelRange = 18,
    /// The front wheel's speed jumps.
    FrontWheelJump = 19,
    /// The front wheel's speed does not change while the bicycle moves.
    FrontWheelStuck = 20,
    /// The rear wheel's sensor delivered no valid sample within its timeout.
    RearWheelLost = 21,
    /// The rear wheel's speed is NaN or beyond its range.
    RearWheelRange = 22,
    /// The rear wheel's speed jumps.
    RearWheelJump = 23,
    /// The rear wheel's speed does not change while the bicycle moves.
    RearWheelStuck = 24,
    /// The rider's torque sensor delivered no valid sample within its timeout.
    RiderTorqueLost = 25,
    /// The rider's torque is NaN or beyond its range.
    RiderTorqueRange = 26,
    /// The rider's torque jumps.
    RiderTorqueJump = 27,
    /// The rider's torque does not change while the handlebar turns.
    RiderTorqueStuck = 28,
    /// The drive did not report its torque within the timeout.
    MotorLost = 29,
    /// The drive's reported torque is NaN or beyond its range.
    MotorRange = 30,
    /// The drive's reported torque jumps.
    MotorJump = 31,
    /// The drive's reported torque does not change while the command changes.
    MotorStuck = 32,
    /// The two wheels' speeds are inconsistent with the steer angle.
    WheelsDisagree = 33,
    /// The gyro's rates have the opposite sign of those expected from another sensor.
    GyroDisagrees = 34,
    /// The steer rate and the steer angle are inconsistent.
    SteerDisagrees = 35,
    /// The drive reports a torque other than the requested one.
    MotorDisagrees = 36,
    /// The steer acceleration is opposite to the motor's torque.
    WrongResponse = 37,
    /// The yaw rate is inconsistent with the speed and the steer angle.
    YawDisagrees = 38,
    /// The guard found a torque that is NaN or infinite.
    GuardNotFinite = 39,
    /// The guard found a torque without permission.
    GuardPermission = 40,
    /// The guard found a torque above the largest allowed.
    GuardTorque = 41,
    /// The guard found a torque that changed faster than allowed.
    GuardRate = 42,
    /// The guard found a torque that changed further within its window than allowed.
    GuardWindow = 43,
    /// The guard found more torque against the rider than allowed.
    GuardOverride = 44,
    /// The guard found a torque towards the steer's end-stop.
    GuardEndStop = 45,
    /// No polarity check has been passed since the last calibration.
    PolarityUnchecked = 46,
    /// The sensors' histories, aligned by latency, do not overlap yet.
    Filling = 47,
    /// The bicycle lies on its side.
    Fallen = 48,
    /// The bicycle is lifted: the specific force is below that of riding.
    Lifted = 49,
    /// The bicycle rolls backwards.
    Backwards = 50,
    /// The bicycle is parked.
    Parked = 51,
    /// The switch was not released for long enough since it was last closed: no press is accepted yet.
    SwitchHeld = 52,
    /// The rider's switch is off.
    SwitchOff = 53,
    /// The self-test is not complete.
    SelfTest = 54,
    /// A control period was much longer than planned, its time was before that of the previous one, or the time stands.
    Timing = 55,
    /// The path's errors are missing or too old.
    PathLost = 56,
    /// The polarity check found a wrong sign.
    PolarityWrong = 57,
    /// The error bound of the roll angle is too large to detect a fall.
    RollUnknown = 58,
    /// The bicycle tumbles: forces and rates together exceed those of any ride.
    Crash = 59,
}

impl Cause {
    /// The code shown to users.
    pub const fn code(self) -> u8 {
        self as u8
    }
}

/// A set of causes, bit *n* for code *n*. [`crate::wire`] encodes it with room for codes up to 127.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct Causes(pub u64);

const _: () = assert!(
    CAUSES.len() < u64::BITS as usize,
    "a wider set needs more instructions in each step, and columns and CAN frames for the codes from 64 on"
);

impl Causes {
    /// No cause.
    pub const NONE: Causes = Causes(0);

    /// The set of one cause.
    pub const fn of(cause: Cause) -> Self {
        Causes(1 << cause.code())
    }

    /// The set of several causes.
    pub const fn all(causes: &[Cause]) -> Self {
        let mut set = Self::NONE;
        let mut rest = causes;
        while let [first, others @ ..] = rest {
            set = set.with(Self::of(*first));
            rest = others;
        }
        set
    }

    /// Union of both sets.
    pub const fn with(self, other: Causes) -> Self {
        Causes(self.0 | other.0)
    }

    /// Intersection of both sets.
    pub const fn and(self, other: Causes) -> Self {
        Causes(self.0 & other.0)
    }

    /// Whether `cause` is in the set.
    pub const fn has(self, cause: Cause) -> bool {
        self.0 & Self::of(cause).0 != 0
    }

    /// Whether any cause of `other` is in the set.
    pub const fn any(self, other: Causes) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether the set is empty.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The set with `cause` added if absent, removed if present.
    pub const fn toggled(self, cause: Cause) -> Self {
        Causes(self.0 ^ Self::of(cause).0)
    }

    /// Adds `cause` when `present`.
    pub fn note(&mut self, cause: Cause, present: bool) {
        if present {
            self.0 |= Self::of(cause).0;
        }
    }

    /// The causes of the set, by rising code.
    pub fn iter(self) -> impl Iterator<Item = Cause> {
        CAUSES.into_iter().filter(move |cause| self.has(*cause))
    }
}
