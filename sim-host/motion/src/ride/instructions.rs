//! The loops over rides, compiled for the vector instructions of each kind of processor; the bits are the same.
#![allow(unsafe_code)]

use super::backend::Backend;
use super::lanes::{self, Needed};
use super::quick::{self, Begin, Quick, QuickRide};
use super::{Conditions, Ride, Start};
use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use crate::num::{Lanes, Scalar};

/// Lanes of one register of AVX2.
#[cfg(target_arch = "x86_64")]
const SOME: usize = 4;

/// Lanes of one register of AVX-512. Exact rides in two registers take twice the time of one.
#[cfg(target_arch = "x86_64")]
const MANY: usize = 8;

/// Time of exact rides in [`MANY`] lanes relative to that in [`SOME`]: 1.3 without assist, 1.4 with a law, 1.6 with the product's controller.
#[cfg(target_arch = "x86_64")]
const MANY_TIME: f64 = 1.4;

/// Lanes of two registers of AVX-512, in which a quick ride takes a tenth less time than in one.
#[cfg(target_arch = "x86_64")]
const MOST: usize = 16;

/// The lanes of processors without the instructions below: NEON's registers hold two numbers.
const ANY_LANES: usize = if cfg!(target_arch = "aarch64") { 4 } else { 1 };

/// The vector instructions of a processor. Fused multiply-add is never used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Instructions {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Those of every processor of the target.
    Any,
}

/// Functions that are compiled for these instructions.
macro_rules! compiled {
    ($features:literal $($function:item)+) => {$(
        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $features)]
        $function
    )+};
}
compiled! { "avx2"
    fn some_rides(conditions: &Conditions, starts: &[Start], needed: Needed) -> Vec<Ride> {
        lanes::run::<SOME>(conditions, starts, needed, &mut Backend::Local)
    }
    fn some_quick_rides(quick: &Quick, begin: Vec<Begin>) -> Vec<QuickRide> {
        quick::run::<SOME>(quick, begin)
    }
    fn some_accelerations(
        b: &Geometry,
        states: &[State<f64>],
        torques: &Torques<f64>,
    ) -> Vec<Accelerations<f64>> {
        accelerations::<SOME>(b, states, torques)
    }
    /// Instructions with three operands need no copies of registers.
    fn one_ride(
        conditions: &Conditions,
        starts: &[Start],
        needed: Needed,
        backend: &mut Backend<'_>,
    ) -> Vec<Ride> {
        lanes::run::<1>(conditions, starts, needed, backend)
    }
}
compiled! { "avx512f,avx512vl,avx512dq,avx512bw"
    fn many_rides(conditions: &Conditions, starts: &[Start], needed: Needed) -> Vec<Ride> {
        lanes::run::<MANY>(conditions, starts, needed, &mut Backend::Local)
    }
    fn many_quick_rides(quick: &Quick, begin: Vec<Begin>) -> Vec<QuickRide> {
        quick::run::<MANY>(quick, begin)
    }
    fn most_quick_rides(quick: &Quick, begin: Vec<Begin>) -> Vec<QuickRide> {
        quick::run::<MOST>(quick, begin)
    }
    fn most_accelerations(
        b: &Geometry,
        states: &[State<f64>],
        torques: &Torques<f64>,
    ) -> Vec<Accelerations<f64>> {
        accelerations::<MOST>(b, states, torques)
    }
}

impl Instructions {
    /// The widest of this processor.
    pub(super) fn of_this_processor() -> Self {
        #[cfg(target_arch = "x86_64")]
        if std::is_x86_feature_detected!("avx2") {
            let avx512 = std::is_x86_feature_detected!("avx512f")
                && std::is_x86_feature_detected!("avx512vl")
                && std::is_x86_feature_detected!("avx512dq")
                && std::is_x86_feature_detected!("avx512bw");
            return if avx512 { Self::Avx512 } else { Self::Avx2 };
        }
        Self::Any
    }

    /// All that this processor has.
    #[cfg(test)]
    pub(super) fn available() -> Vec<Self> {
        match Self::of_this_processor() {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => vec![Self::Avx512, Self::Avx2, Self::Any],
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => vec![Self::Avx2, Self::Any],
            Self::Any => vec![Self::Any],
        }
    }

    /// Number of rides side by side.
    pub(super) fn lanes(self) -> usize {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => MOST,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => SOME,
            Self::Any => ANY_LANES,
        }
    }

    /// Every ride, in the order of `starts`; `lasts_s` are about their durations \[s\], by which the number of lanes is chosen.
    pub(super) fn rides(
        self,
        conditions: &Conditions,
        starts: &[Start],
        needed: Needed,
        lasts_s: impl Iterator<Item = f64> + Clone,
    ) -> Vec<Ride> {
        if starts.len() <= 1 {
            return self.in_turn(conditions, starts, needed, &mut Backend::Local);
        }
        match self {
            // SAFETY: the processor has these instructions, in all functions of this file; with AVX-512 it has AVX2.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if MANY_TIME * busy_s::<MANY>(lasts_s.clone()) < busy_s::<SOME>(lasts_s) => unsafe {
                many_rides(conditions, starts, needed)
            },
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 | Self::Avx2 => unsafe { some_rides(conditions, starts, needed) },
            Self::Any => rides_of_any(conditions, starts, needed),
        }
    }

    /// Every quick ride, in the order in which they `begin`.
    pub(super) fn quick_rides(self, quick: &Quick, begin: Vec<Begin>) -> Vec<QuickRide> {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if begin.len() > MANY => unsafe { most_quick_rides(quick, begin) },
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if begin.len() > SOME => unsafe { many_quick_rides(quick, begin) },
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 | Self::Avx2 => unsafe { some_quick_rides(quick, begin) },
            Self::Any => quick::run::<ANY_LANES>(quick, begin),
        }
    }

    /// The accelerations at every state.
    pub(super) fn accelerations(
        self,
        b: &Geometry,
        states: &[State<f64>],
        torques: &Torques<f64>,
    ) -> Vec<Accelerations<f64>> {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { most_accelerations(b, states, torques) },
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { some_accelerations(b, states, torques) },
            Self::Any => accelerations::<ANY_LANES>(b, states, torques),
        }
    }

    /// Rides one after the other.
    pub(super) fn in_turn(
        self,
        conditions: &Conditions,
        starts: &[Start],
        needed: Needed,
        backend: &mut Backend<'_>,
    ) -> Vec<Ride> {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 | Self::Avx2 => unsafe { one_ride(conditions, starts, needed, backend) },
            Self::Any => in_turn(conditions, starts, needed, backend),
        }
    }
}

/// Time until the last of some lanes is empty, if rides of these durations begin in turn, each in the first lane that is empty \[s\].
#[cfg(target_arch = "x86_64")]
fn busy_s<const N: usize>(lasts_s: impl Iterator<Item = f64>) -> f64 {
    let mut lanes = [0.0_f64; N];
    for lasts_s in lasts_s {
        let first = (0..N).min_by(|&a, &b| lanes[a].total_cmp(&lanes[b]));
        first.into_iter().for_each(|lane| lanes[lane] += lasts_s);
    }
    lanes.into_iter().fold(0.0, f64::max)
}

fn in_turn(
    conditions: &Conditions,
    starts: &[Start],
    needed: Needed,
    backend: &mut Backend<'_>,
) -> Vec<Ride> {
    lanes::run::<1>(conditions, starts, needed, backend)
}

#[cfg(target_arch = "aarch64")]
fn rides_of_any(conditions: &Conditions, starts: &[Start], needed: Needed) -> Vec<Ride> {
    lanes::run::<ANY_LANES>(conditions, starts, needed, &mut Backend::Local)
}

/// One lane: not compiled a second time.
#[cfg(not(target_arch = "aarch64"))]
fn rides_of_any(conditions: &Conditions, starts: &[Start], needed: Needed) -> Vec<Ride> {
    in_turn(conditions, starts, needed, &mut Backend::Local)
}

#[inline(always)]
fn accelerations<const N: usize>(
    b: &Geometry,
    states: &[State<f64>],
    torques: &Torques<f64>,
) -> Vec<Accelerations<f64>> {
    let torques = Torques { roll: Lanes::constant(torques.roll), steer: Lanes::constant(torques.steer) };
    let mut all = Vec::with_capacity(states.len());
    for states in states.chunks(N) {
        let mut side_by_side = State::upright(b, Lanes([0.0; N]));
        for (lane, state) in states.iter().enumerate() {
            side_by_side.set_lane(lane, state);
        }
        let found = Motion::new(b, &side_by_side).accelerations(b, &torques);
        all.extend((0..states.len()).map(|lane| Accelerations {
            roll: found.roll.0[lane],
            steer: found.steer.0[lane],
            rear_wheel: found.rear_wheel.0[lane],
        }));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bicycle::Parameters;
    use crate::ride::Assist;
    use crate::ride::batch::equal;
    use crate::ride::quick::disturbed;
    use control::{Config, Law};

    /// Rides from gentle to violent, more than fill the lanes, with a law and with the product's controller, on every set of
    /// instructions that this processor has: the same bits as one after the other.
    #[test]
    fn every_set_of_instructions_gives_the_same_rides() {
        let shipped = physics::bicycle::catalogue::load("rigid_jason").unwrap().parameters.to_values();
        let b = Geometry::new(&Parameters::from_values(&shipped));
        let start =
            |i: u32| Start { speed_m_s: 4.0, steer_rate_rad_s: 0.6 * f64::from(i), ..Start::default() };
        let starts: Vec<Start> = (1..=40).map(start).collect();
        let mut product = Config::product();
        product.calibration.polarity_checked = true;
        for config in [Config::thesis(Law::H { cut: false }), product] {
            let plan = config.plan().unwrap();
            let conditions = Conditions::thesis(b, Assist::Firmware(Box::new(plan)));
            let quick = Quick::new(&conditions).unwrap();
            let one_by_one = in_turn(&conditions, &starts, Needed::Effort, &mut Backend::Local);
            let quick_one_by_one = quick::run::<1>(&quick, disturbed(&starts));
            let fell = one_by_one.iter().filter(|ride| ride.fell()).count();
            assert!((5..=35).contains(&fell), "{fell} of {} rides fall", starts.len());
            for set in Instructions::available() {
                assert_eq!(
                    set.rides(&conditions, &starts, Needed::Effort, equal(starts.len())),
                    one_by_one,
                    "{set:?}"
                );
                assert_eq!(set.quick_rides(&quick, disturbed(&starts)), quick_one_by_one, "{set:?}");
                for few in [1, 2, 4, 5, 8, 9] {
                    assert_eq!(
                        set.rides(&conditions, &starts[..few], Needed::Effort, equal(few)),
                        one_by_one[..few],
                        "{set:?}, {few}"
                    );
                    let quick = set.quick_rides(&quick, disturbed(&starts[..few]));
                    assert_eq!(quick, quick_one_by_one[..few], "{set:?}, {few}");
                }
            }
        }
    }
}
