//! The assist's torque in quick rides, and their steps near singular configurations.

use super::controller::Line;
use super::limited::{LateLaw, LimitedRide};
use super::riders::QuickRider;
use crate::bicycle::{FullState, Geometry, Torques};
use crate::integrate::{STAGES, Stages};
use crate::num::Lanes;
use crate::ride::assist::{IdealLaw, OwnLaw};
use crate::ride::sensor::readings;
use crate::ride::{Assist, Conditions};
use crate::rider::Instant;
use control::estimate::{EstimateConfig, Source as RollRate};
use control::{Config, Limits, Plan};

/// The law of quick rides.
#[derive(Clone, Debug)]
pub(super) enum Source<'a> {
    None,
    /// A law. With a delay to first order it acts on roll rate and speed minus this time times their slopes.
    Law(Box<LateLaw>),
    Own(&'a OwnLaw),
    /// A controller with more than a law and constant limits.
    Sampled(&'a Plan),
}

/// What gives the torque of one ride in a step with six speeds.
pub(super) enum Given<'a> {
    /// The law alone.
    Law,
    /// The law, late or limited.
    Limited(LimitedRide<'a>),
    /// The torques of a controller.
    Line(Line<f64>),
}

impl<'a> Source<'a> {
    /// The law under these conditions.
    pub(super) fn new(conditions: &'a Conditions) -> Self {
        match &conditions.assist {
            Assist::None => Self::None,
            Assist::Ideal(law) => Self::Law(Box::new(LateLaw::ideal((**law).clone()))),
            Assist::Own(law) => Self::Own(law),
            Assist::Firmware(plan) => match continuous(plan) {
                Some(law) => Self::Law(Box::new(LateLaw::sampled(conditions, law, &plan.config().limits))),
                None => Self::Sampled(plan),
            },
        }
    }

    /// The law, if there is one in continuous time.
    pub(super) fn law(&self) -> Option<&LateLaw> {
        if let Self::Law(law) = self { Some(law) } else { None }
    }

    /// The controller, if its steps are executed.
    pub(super) fn sampled(&self) -> Option<&'a Plan> {
        if let Self::Sampled(plan) = self { Some(plan) } else { None }
    }
}

/// The law of a controller without any other function than constant limits.
fn continuous(plan: &Plan) -> Option<IdealLaw> {
    let config = plan.config();
    let mut bare = Config::thesis(config.law.clone());
    bare.dead_band = config.dead_band;
    let Limits { max_torque_nm, rise_nm_s, fall_nm_s, .. } = config.limits;
    bare.limits = Limits { max_torque_nm, rise_nm_s, fall_nm_s, ..Limits::default() };
    // Without limits, checks and conditions for engagement these values act on nothing.
    bare.estimate = EstimateConfig { roll_rate: RollRate::GyroX, ..config.estimate };
    bare.cross.wheelbase_m = config.cross.wheelbase_m;
    bare.cross.tilt_rad = config.cross.tilt_rad;
    bare.calibration.polarity_checked = config.calibration.polarity_checked;
    (bare == *config).then(|| IdealLaw { law: config.law.clone(), dead_band: config.dead_band })
}

impl Source<'_> {
    /// The steer torques at a stage \[N m\], from roll rate and speed and their slopes over time; of a controller `sampled_nm`.
    #[inline(always)]
    pub(super) fn torques<const N: usize>(
        &self,
        (rate, speed): (Lanes<N>, Lanes<N>),
        slopes: [Lanes<N>; 2],
        sampled_nm: Option<Lanes<N>>,
    ) -> Lanes<N> {
        if let Some(sampled_nm) = sampled_nm {
            return sampled_nm;
        }
        if let Self::Law(late) = self {
            let LateLaw { law, first_order_s, .. } = &**late;
            let delayed = [rate - slopes[0] * *first_order_s, speed - slopes[1] * *first_order_s];
            if let Some(torques_nm) = law.formula(delayed[0], delayed[1]) {
                return torques_nm;
            }
        }
        Lanes(std::array::from_fn(|lane| {
            self.torque((rate.0[lane], speed.0[lane]), slopes.map(|slope| slope.0[lane]))
        }))
    }

    /// The steer torque of one ride \[N m\].
    #[inline(always)]
    fn torque(&self, (rate, speed): (f64, f64), slope: [f64; 2]) -> f64 {
        match self {
            Self::None | Self::Sampled(_) => 0.0,
            Self::Law(late) => {
                let LateLaw { law, first_order_s, .. } = &**late;
                law.torque_nm(rate - first_order_s * slope[0], speed - first_order_s * slope[1])
            }
            Self::Own(law) => law.torque_nm(rate, speed),
        }
    }

    /// One Runge-Kutta step with six speeds, with the rider; `slope` as in [`Self::torques`].
    #[inline(always)]
    pub(super) fn full_step(
        &self,
        conditions: &Conditions,
        from: &FullState,
        h: f64,
        (initial, slope, mut given): (f64, &mut [f64; 2], Given),
        mut rider: Option<&mut QuickRider>,
    ) -> Option<FullState> {
        let b: &Geometry = &conditions.bicycle;
        let mut stages = Stages::new(*from);
        let at_start = readings(conditions, &from.velocities(b), initial);
        for (stage, part) in STAGES.into_iter().enumerate() {
            let at = stages.at;
            let (pose, velocities) = (at.pose(b), at.velocities(b));
            let measured = readings(conditions, &velocities, initial);
            if stage > 0 {
                let elapsed_s = h * part;
                *slope = [(measured.0 - at_start.0) / elapsed_s, (measured.1 - at_start.1) / elapsed_s];
            }
            let assist_nm = match &mut given {
                Given::Law => self.torque(measured, *slope),
                Given::Limited(limited) => limited.torque_nm(stage, self.torque(measured, *slope)),
                Given::Line(line) => line.at(part),
            };
            let steer = rider.as_ref().map_or(assist_nm, |rider| assist_nm + rider.torque_nm());
            let k = at.rate(b, &Torques { roll: 0.0, steer })?;
            if let Some(rider) = &mut rider {
                let now = Instant::full(&at, (&pose, &velocities), &k);
                rider.end_stage(b, stage, &now, measured.1);
            }
            stages.next(stage, h, &k);
        }
        Some(stages.end)
    }
}
