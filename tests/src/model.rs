//! A predictor that is not flashed: the linear bicycle (Meijaard et al. 2007) propagates the delayed state, with the
//! torques commanded since, over the whole delay. The transition depends on the speed alone and is tabulated. In f32,
//! as on the chip; compared in `docs/delay.md`.

use control::estimate::Motion;
use control::maths::bounded;
use sim_host::bicycle::Parameters;
use sim_host::bicycle::linear::Linear;

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

impl LinearBicycle {
    /// From a bicycle's parameters.
    pub fn new(p: &Parameters) -> Self {
        let linear = Linear::new(p);
        // The state matrix is linear in v and in v squared.
        let (still, moving) = (linear.state_matrix(0.0, 0.0), linear.state_matrix(1.0, 0.0));
        let place = |i: usize| (2 + i / 2, i % 2);
        let by_rows = |value: &dyn Fn((usize, usize)) -> f64| std::array::from_fn(|i| value(place(i)) as f32);
        let torque = linear.steer_torque_response();
        Self {
            damping: by_rows(&|(row, column)| -moving[(row, 2 + column)]),
            gravity: by_rows(&|at| -still[at]),
            speed: by_rows(&|at| still[at] - moving[at]),
            torque: [torque[0] as f32, torque[1] as f32],
        }
    }

    /// One Runge-Kutta step of the linear bicycle, `x = [roll, steer, roll rate, steer rate]`.
    pub fn moved(&self, v: f32, torque: f32, x: [f32; 4], h: f32) -> [f32; 4] {
        let rate = |[r, d, rd, dd]: [f32; 4]| {
            let acceleration = |[c_r, c_d]: [f32; 2], [g_r, g_d]: [f32; 2], [k_r, k_d]: [f32; 2], t: f32| {
                t * torque - v * (c_r * rd + c_d * dd) - (g_r + v * v * k_r) * r - (g_d + v * v * k_d) * d
            };
            let [c1, c2, c3, c4] = self.damping;
            let [g1, g2, g3, g4] = self.gravity;
            let [k1, k2, k3, k4] = self.speed;
            let [t1, t2] = self.torque;
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
}

/// Speeds in the table, and their distance.
const SPEEDS: usize = 21;
const SPEED_STEP_M_S: f32 = 0.5;
/// Parts of the delay over each of which the torque counts with its mean.
const BLOCKS: usize = 4;
/// Runge-Kutta steps to a block.
const STEPS: usize = 4;
/// Numbers in a row: by roll, steer, their rates; by the torques, oldest block first.
const WEIGHTS: usize = 4 + BLOCKS;

/// Roll and roll rate after the delay, from the state before it.
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
                x = b.moved(v, torque, x, h);
            }
            [*roll, _, *roll_rate, _] = x;
        }
        to
    }
}

/// The predictor of one bicycle and delay.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    table: [Transition; SPEEDS],
    block_ticks: u16,
}

impl Model {
    /// For a bicycle, a delay and a control period \[s\].
    pub fn new(b: &LinearBicycle, delay_s: f32, period_s: f32) -> Self {
        let table = std::array::from_fn(|i| Transition::new(b, i as f32 * SPEED_STEP_M_S, delay_s));
        let ticks = (delay_s / period_s / BLOCKS as f32).round() as u16;
        Self { table, block_ticks: ticks.max(1) }
    }
}

/// The torques within the delay.
#[derive(Clone, Debug, Default)]
pub struct OnTheWay {
    /// Means of the last complete blocks, newest first \[N m\].
    means_nm: [f32; BLOCKS],
    /// Sum of the incomplete block.
    sum_nm: f32,
    ticks: u16,
}

impl OnTheWay {
    /// Adds the torque that was commanded in this period, after every limit \[N m\].
    pub fn commanded(&mut self, model: &Model, torque_nm: f32) {
        self.sum_nm += bounded(torque_nm, 1e3);
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks >= model.block_ticks {
            let [a, b, c, _] = self.means_nm;
            self.means_nm = [self.sum_nm / f32::from(self.ticks), a, b, c];
            (self.sum_nm, self.ticks) = (0.0, 0);
        }
    }

    /// Mean torques over the parts of the delay that end now, oldest first: a block across two of the stored ones is
    /// weighted by its shares.
    fn blocks(&self, model: &Model) -> [f32; BLOCKS] {
        let part = f32::from(self.ticks) / f32::from(model.block_ticks);
        let [a, b, c, d] = self.means_nm;
        let newest = self.sum_nm / f32::from(model.block_ticks) + (1.0 - part) * a;
        let mixed = |newer: f32, older: f32| part * newer + (1.0 - part) * older;
        [mixed(c, d), mixed(b, c), mixed(a, b), newest]
    }
}

impl Model {
    /// The motion with the predicted roll and roll rate at the instant at which the torque acts.
    pub fn ahead(&self, torques: &OnTheWay, now: &Motion) -> Motion {
        let [r, d, rd, dd] = [now.roll_rad, now.steer_rad, now.roll_rate_rad_s, now.steer_rate_rad_s];
        let [t1, t2, t3, t4] = torques.blocks(self);
        let from = [r, d, rd, dd, t1, t2, t3, t4];
        let place = bounded(now.speed_m_s.max(0.0) / SPEED_STEP_M_S, (SPEEDS - 1) as f32);
        let below = (place as usize).min(SPEEDS - 2);
        let part = place - below as f32;
        let (slow, fast) = (&self.table[below], &self.table[below + 1]);
        let row = |slow: &[f32; WEIGHTS], fast: &[f32; WEIGHTS]| -> f32 {
            slow.iter().zip(fast).zip(from).map(|((a, b), x)| (a + part * (b - a)) * x).sum()
        };
        Motion {
            roll_rad: row(&slow.roll, &fast.roll),
            roll_rate_rad_s: row(&slow.roll_rate, &fast.roll_rate),
            ..*now
        }
    }
}
