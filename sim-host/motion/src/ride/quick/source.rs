//! The assist's torque in quick rides, and their steps near singular configurations.

use super::controller::Line;
use super::riders::QuickRider;
use crate::bicycle::{FullState, Geometry, Torques};
use crate::integrate::{STAGES, Stages};
use crate::num::Lanes;
use crate::ride::assist::{IdealLaw, OwnLaw};
use crate::ride::sensor::readings;
use crate::ride::{Assist, Conditions};
use crate::rider::Instant;
use control::estimate::{EstimateConfig, Source as RollRate};
use control::{Config, Plan};

/// The law of quick rides.
#[derive(Clone, Debug)]
pub(super) enum Source<'a> {
    None,
    /// A law and the delay of its torque \[s\], to first order: it acts on roll rate and speed minus this time times
    /// their slopes.
    Ideal(Box<IdealLaw>, f64),
    Own(&'a OwnLaw),
    /// A controller with more than a law.
    Sampled(&'a Plan),
}

impl<'a> Source<'a> {
    /// The law under these conditions.
    pub(super) fn new(conditions: &'a Conditions) -> Self {
        match &conditions.assist {
            Assist::None => Self::None,
            Assist::Ideal(law) => Self::Ideal(law.clone(), 0.0),
            Assist::Own(law) => Self::Own(law),
            Assist::Firmware(plan) => match continuous(plan) {
                Some(law) => Self::Ideal(Box::new(law), 0.5 * conditions.step_s),
                None => Self::Sampled(plan),
            },
        }
    }

    /// The controller, if its steps are executed.
    pub(super) fn sampled(&self) -> Option<&'a Plan> {
        if let Self::Sampled(plan) = self { Some(plan) } else { None }
    }
}

/// The law of a controller without any other function.
fn continuous(plan: &Plan) -> Option<IdealLaw> {
    let config = plan.config();
    let mut bare = Config::thesis(config.law.clone());
    bare.dead_band = config.dead_band;
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
        if let Self::Ideal(law, delay_s) = self {
            let delayed = [rate - slopes[0] * *delay_s, speed - slopes[1] * *delay_s];
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
            Self::Ideal(law, delay_s) => law.torque_nm(rate - delay_s * slope[0], speed - delay_s * slope[1]),
            Self::Own(law) => law.torque_nm(rate, speed),
        }
    }

    /// One Runge-Kutta step with six speeds, with the rider; `slope` as in [`Self::torques`], `line` the torque of a controller.
    pub(super) fn full_step(
        &self,
        conditions: &Conditions,
        from: &FullState,
        h: f64,
        (initial, slope, line): (f64, &mut [f64; 2], Option<Line<f64>>),
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
            let assist_nm = line.map_or_else(|| self.torque(measured, *slope), |line| line.at(part));
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
