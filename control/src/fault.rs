//! Everything that can stand in the way of a torque, numbered once and for ever.
//!
//! A number is never given to anything else, even when its cause is gone from the program. A page
//! of `docs/faults` explains each.

/// Why torque is refused, reduced or watched. The number is the code that users see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[rustfmt::skip]
pub enum Cause {
    /// The gyro brought no believable sample in time.
    GyroLost = 1,
    /// The gyro's samples are NaN or beyond its range.
    GyroRange = 2,
    /// The gyro's samples jump faster than a bicycle can move.
    GyroJump = 3,
    /// The gyro repeats one sample while the bicycle moves.
    GyroStuck = 4,
    /// The accelerometer brought no believable sample in time.
    AccelLost = 5,
    /// The accelerometer's samples are NaN or beyond its range.
    AccelRange = 6,
    /// The accelerometer's samples jump.
    AccelJump = 7,
    /// The accelerometer repeats one sample while the bicycle moves.
    AccelStuck = 8,
    /// The steer angle sensor brought no believable sample in time.
    SteerLost = 9,
    /// The steer angle is NaN or beyond its range.
    SteerRange = 10,
    /// The steer angle jumps.
    SteerJump = 11,
    /// The steer angle stays the same while the handlebar turns.
    SteerStuck = 12,
    /// The steer rate sensor brought no believable sample in time.
    SteerRateLost = 13,
    /// The steer rate is NaN or beyond its range.
    SteerRateRange = 14,
    /// The steer rate jumps.
    SteerRateJump = 15,
    /// The steer rate stays the same while the handlebar turns.
    SteerRateStuck = 16,
    /// The front wheel's sensor brought no believable sample in time.
    FrontWheelLost = 17,
    /// The front wheel's speed is NaN or beyond its range.
    FrontWheelRange = 18,
    /// The front wheel's speed jumps.
    FrontWheelJump = 19,
    /// The front wheel's speed stays the same while the bicycle moves.
    FrontWheelStuck = 20,
    /// The rear wheel's sensor brought no believable sample in time.
    RearWheelLost = 21,
    /// The rear wheel's speed is NaN or beyond its range.
    RearWheelRange = 22,
    /// The rear wheel's speed jumps.
    RearWheelJump = 23,
    /// The rear wheel's speed stays the same while the bicycle moves.
    RearWheelStuck = 24,
    /// The rider's torque sensor brought no believable sample in time.
    RiderTorqueLost = 25,
    /// The rider's torque is NaN or beyond its range.
    RiderTorqueRange = 26,
    /// The rider's torque jumps.
    RiderTorqueJump = 27,
    /// The rider's torque stays the same while the handlebar turns.
    RiderTorqueStuck = 28,
    /// The drive does not say what torque it gives.
    MotorLost = 29,
    /// The drive's torque is NaN or beyond its range.
    MotorRange = 30,
    /// The drive's torque jumps.
    MotorJump = 31,
    /// The drive's torque stays the same while the command changes.
    MotorStuck = 32,
    /// The two wheels' speeds do not fit the steer angle.
    WheelsDisagree = 33,
    /// The gyro's rates have the opposite sign of what another sensor makes of them.
    GyroDisagrees = 34,
    /// The steer rate and the steer angle do not fit each other.
    SteerDisagrees = 35,
    /// The drive gives another torque than it is asked for.
    MotorDisagrees = 36,
    /// The bicycle answers to the torque the wrong way round.
    WrongResponse = 37,
    /// The yaw rate and the steer angle have opposite signs.
    YawDisagrees = 38,
    /// The guard saw a torque that is not a number.
    GuardNotFinite = 39,
    /// The guard saw a torque without permission.
    GuardPermission = 40,
    /// The guard saw a torque beyond the largest allowed.
    GuardTorque = 41,
    /// The guard saw a torque change faster than allowed.
    GuardRate = 42,
    /// The guard saw a torque change further within its window than allowed.
    GuardWindow = 43,
    /// The guard saw a torque against the rider beyond what is allowed.
    GuardOverride = 44,
    /// The guard saw a torque towards the steer's end-stop.
    GuardEndStop = 45,
    /// No polarity check has been passed since the last calibration.
    PolarityUnchecked = 46,
    /// The sensors' histories do not overlap yet.
    Filling = 47,
    /// The bicycle lies on its side.
    Fallen = 48,
    /// The bicycle is lifted: both wheels' speeds and the forces do not belong to riding.
    Lifted = 49,
    /// The bicycle rolls backwards.
    Backwards = 50,
    /// The bicycle stands.
    Parked = 51,
    /// The switch was not released for long enough since it was last on: no press counts yet.
    SwitchHeld = 52,
    /// The rider has not asked for assist.
    SwitchOff = 53,
    /// The self-test is not over.
    SelfTest = 54,
    /// A control period was much longer than planned, or its time lay before the last one's.
    Timing = 55,
    /// The path's errors are missing or too old.
    PathLost = 56,
    /// The polarity check found a wrong sign.
    PolarityWrong = 57,
    /// The roll angle is not known well enough to tell whether the bicycle has fallen.
    RollUnknown = 58,
    /// The bicycle tumbles: forces and rates together are those of no ride.
    Crash = 59,
}

/// Every cause, in the order of the codes.
#[rustfmt::skip]
pub const CAUSES: [Cause; 59] = {
    use Cause::*;
    [
        GyroLost, GyroRange, GyroJump, GyroStuck, AccelLost, AccelRange, AccelJump, AccelStuck,
        SteerLost, SteerRange, SteerJump, SteerStuck, SteerRateLost, SteerRateRange, SteerRateJump, SteerRateStuck,
        FrontWheelLost, FrontWheelRange, FrontWheelJump, FrontWheelStuck, RearWheelLost, RearWheelRange, RearWheelJump,
        RearWheelStuck, RiderTorqueLost, RiderTorqueRange, RiderTorqueJump, RiderTorqueStuck, MotorLost, MotorRange,
        MotorJump, MotorStuck, WheelsDisagree, GyroDisagrees, SteerDisagrees, MotorDisagrees, WrongResponse, YawDisagrees,
        GuardNotFinite, GuardPermission, GuardTorque, GuardRate, GuardWindow, GuardOverride, GuardEndStop,
        PolarityUnchecked, Filling, Fallen, Lifted, Backwards, Parked, SwitchHeld, SwitchOff, SelfTest, Timing, PathLost,
        PolarityWrong, RollUnknown, Crash,
    ]
};

impl Cause {
    /// The number that users see and look up.
    pub const fn code(self) -> u8 {
        self as u8
    }
}

/// A set of causes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Causes(pub u64);

impl Causes {
    /// No cause.
    pub const NONE: Causes = Causes(0);

    /// The set of one.
    pub const fn of(cause: Cause) -> Self {
        Causes(1 << cause.code())
    }

    /// The set of several.
    pub const fn all(causes: &[Cause]) -> Self {
        let mut set = Self::NONE;
        let mut rest = causes;
        while let [first, others @ ..] = rest {
            set = set.with(Self::of(*first));
            rest = others;
        }
        set
    }

    /// Both sets together.
    pub const fn with(self, other: Causes) -> Self {
        Causes(self.0 | other.0)
    }

    /// What is in both sets.
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

    /// Whether there is none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// With `cause` added if it is not in it, else taken away.
    pub const fn turned(self, cause: Cause) -> Self {
        Causes(self.0 ^ Self::of(cause).0)
    }

    /// Adds `cause` when `present`.
    pub fn note(&mut self, cause: Cause, present: bool) {
        if present {
            self.0 |= Self::of(cause).0;
        }
    }

    /// The causes in it, by rising code.
    pub fn iter(self) -> impl Iterator<Item = Cause> {
        CAUSES.into_iter().filter(move |cause| self.has(*cause))
    }
}
