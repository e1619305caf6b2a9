//! What the motion will be when the torque acts: sensors and actuator are late, the bicycle is not.
//!
//! The linear bicycle (Meijaard et al. 2007) takes the state as it was, and the torques that have been
//! commanded since, over the whole delay. That transition depends on the speed alone; it is tabulated
//! once, when the plan is made.

use crate::estimate::Motion;
use crate::maths::bounded;
use crate::param::{Leaf, Visit};

/// How the delay is made up for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Predict {
    /// Not at all.
    #[default]
    Off = 0,
    /// By the roll acceleration: `rate + delay * acceleration`.
    Lead = 1,
    /// By the linear bicycle.
    Model = 2,
}

/// The names of [`Predict`]'s values.
pub const PREDICTORS: &[&str] = &["off", "lead", "model"];

/// The linear bicycle solved for its accelerations, `q = [roll, steer]`:
/// `q'' = -v damping q' - (gravity + v^2 speed) q + torque T`, matrices by rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearBicycle {
    /// `M^-1 C1` \[1/m\].
    pub damping: [f32; 4],
    /// `M^-1 g K0` \[1/s^2\].
    pub gravity: [f32; 4],
    /// `M^-1 K2` \[1/m^2\].
    pub speed: [f32; 4],
    /// Accelerations per steer torque \[rad/s^2 per N m\].
    pub torque: [f32; 2],
}

/// What the predictor is told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PredictConfig {
    /// How.
    pub by: Predict,
    /// The delay that is made up for, sensors and actuator together \[s\].
    pub delay_s: f32,
    /// The bicycle with its rider.
    pub bicycle: LinearBicycle,
}

impl PredictConfig {
    /// Shows every parameter.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        let mut by = self.by as u8;
        to.choice(&Leaf::new("predict", "by", 0.0, 2.0), PREDICTORS, &mut by);
        self.by = match by {
            1 => Predict::Lead,
            2 => Predict::Model,
            _ => Predict::Off,
        };
        to.number(&Leaf::new("predict", "delay_s", 0.0, 0.1), &mut self.delay_s);
        const PLACES: [&str; 4] = ["roll_by_roll", "roll_by_steer", "steer_by_roll", "steer_by_steer"];
        let b = &mut self.bicycle;
        for (group, matrix, most) in [
            ("predict.damping", &mut b.damping, 1e3),
            ("predict.gravity", &mut b.gravity, 1e4),
            ("predict.speed", &mut b.speed, 1e3),
        ] {
            for (name, value) in PLACES.into_iter().zip(matrix) {
                to.number(&Leaf::new(group, name, -most, most), value);
            }
        }
        for (name, value) in ["roll", "steer"].into_iter().zip(&mut b.torque) {
            to.number(&Leaf::new("predict.torque", name, -1e3, 1e3), value);
        }
    }

    /// The tables for a controller that is called `rate_hz` times a second.
    pub fn plan(&self, rate_hz: f32) -> PredictPlan {
        let mut table = [Transition::default(); SPEEDS];
        if self.by == Predict::Model {
            for (i, transition) in table.iter_mut().enumerate() {
                *transition = Transition::new(&self.bicycle, i as f32 * SPEED_STEP_M_S, self.delay_s);
            }
        }
        let ticks = (rate_hz * self.delay_s / BLOCKS as f32 + 0.5) as u16;
        PredictPlan { by: self.by, delay_s: self.delay_s, table, block_ticks: ticks.max(1) }
    }
}

/// Speeds in the table, and how far they are apart.
const SPEEDS: usize = 21;
const SPEED_STEP_M_S: f32 = 0.5;
/// Parts of the delay over each of which the torque counts with its mean.
const BLOCKS: usize = 4;
/// Runge-Kutta steps to a block.
const STEPS: usize = 4;
/// Numbers to a row: by roll, steer, their rates; by the torques, oldest block first.
const WEIGHTS: usize = 4 + BLOCKS;

/// Roll and roll rate after the delay, by what there was before it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Transition {
    roll: [f32; WEIGHTS],
    roll_rate: [f32; WEIGHTS],
}

impl Transition {
    fn new(b: &LinearBicycle, v: f32, delay_s: f32) -> Self {
        let mut to = Self::default();
        let h = delay_s / (BLOCKS * STEPS) as f32;
        for (i, (roll, roll_rate)) in to.roll.iter_mut().zip(&mut to.roll_rate).enumerate() {
            let mut x = [0.0; 4];
            if let Some(x) = x.get_mut(i) {
                *x = 1.0;
            }
            for step in 0..BLOCKS * STEPS {
                let torque = if 4 + step / STEPS == i { 1.0 } else { 0.0 };
                x = moved(b, v, torque, x, h);
            }
            [*roll, _, *roll_rate, _] = x;
        }
        to
    }
}

/// One Runge-Kutta step of the linear bicycle, `x = [roll, steer, roll rate, steer rate]`.
fn moved(b: &LinearBicycle, v: f32, torque: f32, x: [f32; 4], h: f32) -> [f32; 4] {
    let rate = |[r, d, rd, dd]: [f32; 4]| {
        let acceleration = |[c_r, c_d]: [f32; 2], [g_r, g_d]: [f32; 2], [k_r, k_d]: [f32; 2], t: f32| {
            t * torque - v * (c_r * rd + c_d * dd) - (g_r + v * v * k_r) * r - (g_d + v * v * k_d) * d
        };
        let [c1, c2, c3, c4] = b.damping;
        let [g1, g2, g3, g4] = b.gravity;
        let [k1, k2, k3, k4] = b.speed;
        let [t1, t2] = b.torque;
        [
            rd,
            dd,
            acceleration([c1, c2], [g1, g2], [k1, k2], t1),
            acceleration([c3, c4], [g3, g4], [k3, k4], t2),
        ]
    };
    let ahead = |x: [f32; 4], h: f32, k: [f32; 4]| {
        let mut to = x;
        to.iter_mut().zip(k).for_each(|(x, k)| *x += h * k);
        to
    };
    let k1 = rate(x);
    let k2 = rate(ahead(x, 0.5 * h, k1));
    let k3 = rate(ahead(x, 0.5 * h, k2));
    let k4 = rate(ahead(x, h, k3));
    ahead(ahead(ahead(ahead(x, h / 6.0, k1), h / 3.0, k2), h / 3.0, k3), h / 6.0, k4)
}

/// A [`PredictConfig`] with its tables.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictPlan {
    by: Predict,
    delay_s: f32,
    table: [Transition; SPEEDS],
    block_ticks: u16,
}

/// The torques that are on their way.
#[derive(Clone, Debug, Default)]
pub struct PredictState {
    /// Means of the last whole blocks, newest first \[N m\].
    means_nm: [f32; BLOCKS],
    /// The block under way.
    sum_nm: f32,
    ticks: u16,
}

impl PredictState {
    /// Takes in the torque that was commanded in this period, after every limit \[N m\].
    pub fn commanded(&mut self, plan: &PredictPlan, torque_nm: f32) {
        self.sum_nm += bounded(torque_nm, 1e3);
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks >= plan.block_ticks {
            let [a, b, c, _] = self.means_nm;
            self.means_nm = [self.sum_nm / f32::from(self.ticks), a, b, c];
            (self.sum_nm, self.ticks) = (0.0, 0);
        }
    }

    /// Mean torques over the parts of the delay that end now, oldest first: a block that lies across
    /// two of those kept counts them by its shares.
    fn blocks(&self, plan: &PredictPlan) -> [f32; BLOCKS] {
        let part = f32::from(self.ticks) / f32::from(plan.block_ticks);
        let [a, b, c, d] = self.means_nm;
        let newest = self.sum_nm / f32::from(plan.block_ticks) + (1.0 - part) * a;
        let mixed = |newer: f32, older: f32| part * newer + (1.0 - part) * older;
        [mixed(c, d), mixed(b, c), mixed(a, b), newest]
    }
}

/// The motion when the torque will act, as far as a law uses it: roll and roll rate ahead.
///
/// Unchanged bits with [`Predict::Off`], and with [`Predict::Model`] while a steer sensor or the roll
/// angle is missing (`complete` is false).
pub fn step(plan: &PredictPlan, state: &PredictState, now: &Motion, complete: bool) -> Motion {
    match plan.by {
        Predict::Lead => Motion {
            roll_rad: now.roll_rad + plan.delay_s * now.roll_rate_rad_s,
            roll_rate_rad_s: now.roll_rate_rad_s + plan.delay_s * now.roll_accel_rad_s2,
            ..*now
        },
        Predict::Model if complete => {
            let [r, d, rd, dd] = [now.roll_rad, now.steer_rad, now.roll_rate_rad_s, now.steer_rate_rad_s];
            let [t1, t2, t3, t4] = state.blocks(plan);
            let from = [r, d, rd, dd, t1, t2, t3, t4];
            let place = bounded(now.speed_m_s.max(0.0) / SPEED_STEP_M_S, (SPEEDS - 1) as f32);
            let below = (place as usize).min(SPEEDS - 2);
            let part = place - below as f32;
            let mut ends = plan.table.iter().skip(below);
            let (Some(slow), Some(fast)) = (ends.next(), ends.next()) else { return *now };
            let row = |slow: &[f32; WEIGHTS], fast: &[f32; WEIGHTS]| {
                let mut sum = 0.0;
                for ((a, b), x) in slow.iter().zip(fast).zip(from) {
                    sum += (a + part * (b - a)) * x;
                }
                sum
            };
            Motion {
                roll_rad: row(&slow.roll, &fast.roll),
                roll_rate_rad_s: row(&slow.roll_rate, &fast.roll_rate),
                ..*now
            }
        }
        Predict::Off | Predict::Model => *now,
    }
}
