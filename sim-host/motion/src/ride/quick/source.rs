//! The assist's torque in quick rides, and their steps near singular configurations.

use super::controller::Line;
use super::held::Held;
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
    /// A law. If it is sampled and held, it acts on what [`Held`] gives.
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

    /// Half a control period of a law that is sampled and held \[s\]; `None` of what reads the signals as they are.
    pub(super) fn half_held_s(&self) -> Option<f64> {
        self.law().map(|law| law.half_held_s).filter(|half_s| *half_s > 0.0)
    }

    /// Whether the torque has kinks or jumps over the roll rate, or can have: with a dead band, and of an own law.
    pub(super) fn jumps(&self) -> bool {
        matches!(self, Self::Own(_)) || self.law().is_some_and(|law| law.law.dead_band.is_on())
    }

    /// Whether a law is late, limited or behind a motor's lag.
    pub(super) fn limited(&self) -> bool {
        self.law().is_some_and(LateLaw::limited)
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
    /// The steer torques at a stage \[N m\], from roll rate and speed as a law reads them; of a controller `sampled_nm`.
    #[inline(always)]
    pub(super) fn torques<const N: usize>(
        &self,
        (rate, speed): (Lanes<N>, Lanes<N>),
        sampled_nm: Option<Lanes<N>>,
    ) -> Lanes<N> {
        if let Some(sampled_nm) = sampled_nm {
            return sampled_nm;
        }
        if let Self::Law(late) = self
            && let Some(torques_nm) = late.law.formula(rate, speed)
        {
            return torques_nm;
        }
        Lanes(std::array::from_fn(|lane| self.torque((rate.0[lane], speed.0[lane]))))
    }

    /// The steer torque of one ride \[N m\].
    #[inline(always)]
    fn torque(&self, (rate, speed): (f64, f64)) -> f64 {
        match self {
            Self::None | Self::Sampled(_) => 0.0,
            Self::Law(late) => late.law.torque_nm(rate, speed),
            Self::Own(law) => law.torque_nm(rate, speed),
        }
    }

    /// One Runge-Kutta step with six speeds, with the rider.
    #[inline(always)]
    pub(super) fn full_step(
        &self,
        conditions: &Conditions,
        from: &FullState,
        h: f64,
        (initial, held, mut given): (f64, &mut Held<f64>, Given),
        mut rider: Option<&mut QuickRider>,
    ) -> Option<FullState> {
        let b: &Geometry = &conditions.bicycle;
        let half_held_s = self.half_held_s();
        let mut stages = Stages::new(*from);
        for (stage, part) in STAGES.into_iter().enumerate() {
            let at = stages.at;
            let (pose, velocities) = (at.pose(b), at.velocities(b));
            let measured = readings(conditions, &velocities, initial);
            let read = match half_held_s {
                Some(half_s) => held.stage(stage, h, half_s, measured),
                None => measured,
            };
            let assist_nm = match &mut given {
                Given::Law => self.torque(read),
                Given::Limited(limited) => limited.torque_nm(stage, self.torque(read)),
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
