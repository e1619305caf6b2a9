//! The controller in calm motion, where no check acts: the estimator's roll rate, prediction, smoothing, law and limits alone, in
//! all lanes together.
//!
//! The readings between the starts of the steps are those of parabolas. What acts only in products with other small quantities is
//! constant or a straight line over a step: the covariance, the pitch and the gain.

mod plan;
mod start;

pub(super) use plan::{CalmPlan, LONGER, SETTLED_S};
pub(super) use start::CalmStart;

use super::controller::Line;
use crate::num::{Lanes, Scalar, sin_cos};
use crate::plant::Reading;
use control::estimate::{self, MAX_INNOVATION_RAD, OBSERVATION_LAG_S};
use control::maths::G;
use control::{State, Wheel};
use plan::ROLL_RAD;
use std::f64::consts::SQRT_2;

/// The controllers in calm motion.
pub(super) struct CalmLanes<'a, const N: usize> {
    pub(super) plan: &'a CalmPlan<'a>,
    /// Control periods of the step; 0 in a lane whose motion is not calm.
    periods: [u32; N],
    signals: Signals<Lanes<N>>,
    step: Step<Lanes<N>>,
    slow: [Slow; N],
}

/// What changes in every control period.
#[derive(Clone, Copy)]
struct Signals<S> {
    /// Estimated roll angle \[rad\], and bias of the gyro about x \[rad/s\].
    roll_rad: S,
    bias_rad_s: S,
    /// Unexplained lateral force, smoothed \[m/s^2\].
    unexplained_m_s2: S,
    /// Rates about x and z, smoothed \[rad/s\].
    smooth_rad_s: [S; 2],
    /// Roll rate, smoothed for the roll acceleration \[rad/s\].
    slow_rad_s: S,
    /// Output of the low-pass, and its rate divided by the low-pass' angular frequency \[rad/s\].
    low_rad_s: [S; 2],
    torque_nm: S,
}

/// The readings in a step, and what is constant in it.
#[derive(Clone, Copy)]
struct Step<S> {
    /// Angular rates, those about y and z without their biases \[rad/s\].
    gyro_rad_s: [Parabola<S>; 3],
    rear_m_s: Parabola<S>,
    /// Lateral specific force \[m/s^2\].
    force_m_s2: Parabola<S>,
    pitch_rad: Parabola<S>,
    /// Sine of the roll angle as a straight line: its value at zero, and its slope.
    roll_sin: [S; 2],
    /// Weights of an observation in roll angle and bias.
    weights: [S; 2],
    /// Gain of the law with the taper \[N m s/rad\].
    gain_nm_s_rad: S,
}

/// What changes from step to step in a lane.
#[derive(Clone, Copy, Default)]
struct Slow {
    /// Biases of the gyros about y and z \[rad/s\].
    bias_rad_s: [f64; 2],
    /// Variance of the roll angle, covariance, variance of the bias.
    covariance: [f64; 3],
    /// Timer of the handlebar turning against the torque \[s\].
    against_s: f64,
}

/// A polynomial of the time since the step's start \[s\].
#[derive(Clone, Copy)]
struct Parabola<S>([S; 3]);

impl<'a, const N: usize> CalmLanes<'a, N> {
    pub(super) fn new(plan: &'a CalmPlan<'a>) -> Self {
        let zero = Lanes([0.0; N]);
        let none = Parabola([zero; 3]);
        Self {
            plan,
            periods: [0; N],
            signals: Signals {
                roll_rad: zero,
                bias_rad_s: zero,
                unexplained_m_s2: zero,
                smooth_rad_s: [zero; 2],
                slow_rad_s: zero,
                low_rad_s: [zero; 2],
                torque_nm: zero,
            },
            step: Step {
                gyro_rad_s: [none; 3],
                rear_m_s: none,
                force_m_s2: none,
                pitch_rad: none,
                roll_sin: [zero; 2],
                weights: [zero; 2],
                gain_nm_s_rad: zero,
            },
            slow: [Slow::default(); N],
        }
    }

    /// Continues the controller in a lane from this state.
    pub(super) fn enter(&mut self, lane: usize, state: &State) {
        let Some(riding) = state.estimate().riding() else { return };
        let (low, change) = state.smooth().low_pass().unwrap_or((riding.slow_rad_s, 0.0));
        let [x, y, z] = riding.bias_rad_s.map(f64::from);
        self.slow[lane] =
            Slow { bias_rad_s: [y, z], covariance: riding.covariance.map(f64::from), against_s: 0.0 };
        let s = &mut self.signals;
        s.roll_rad.0[lane] = riding.roll_rad.into();
        s.bias_rad_s.0[lane] = x;
        s.unexplained_m_s2.0[lane] = riding.unexplained_m_s2.into();
        for (signal, value) in s.smooth_rad_s.iter_mut().zip(riding.smooth_rad_s) {
            signal.0[lane] = value.into();
        }
        s.slow_rad_s.0[lane] = riding.slow_rad_s.into();
        (s.low_rad_s[0].0[lane], s.low_rad_s[1].0[lane]) = (low.into(), change.into());
        s.torque_nm.0[lane] = state.torque_nm().into();
    }

    /// Begins a lane's step of some control periods with the readings at the starts of the last three steps, latest first; whether
    /// the motion is still calm.
    pub(super) fn begin(&mut self, lane: usize, past: &[(f64, Reading); 3], periods: u32) -> bool {
        self.periods[lane] = periods;
        let CalmPlan { config, period_s, against: (against_rad_s, most_s), .. } = self.plan;
        let (c, signals, slow) = (&config.estimate, &self.signals, &mut self.slow[lane]);
        let h = f64::from(periods) * period_s;
        let [(t0, now), (t1, before), (t2, earlier)] = past;
        let elapsed_s = t0 - t1;
        let through = |of: &dyn Fn(&Reading) -> f64| {
            Parabola::through([*t0, *t1, *t2], [of(now), of(before), of(earlier)])
        };
        let (roll_rad, bias_rad_s) = (signals.roll_rad.0[lane], signals.bias_rad_s.0[lane]);

        let gyro = [0.0, slow.bias_rad_s[0], slow.bias_rad_s[1]];
        for (axis, bias) in gyro.into_iter().enumerate() {
            self.step.gyro_rad_s[axis].set(lane, through(&|reading| reading.gyro_rad_s[axis] - bias));
        }
        let rear_m_s = through(&|reading| reading.rear_wheel_m_s);
        self.step.rear_m_s.set(lane, rear_m_s);
        // The forces are means over the times before the readings; in the control step over the last period.
        let force_slope = (now.accel_m_s2[1] - before.accel_m_s2[1]) / (0.5 * (t0 - t2));
        let force = now.accel_m_s2[1] + 0.5 * force_slope * (elapsed_s - period_s);
        self.step.force_m_s2.set(lane, Parabola([force, force_slope, 0.0]));
        let roll_before_rad = roll_rad - (now.gyro_rad_s[0] - bias_rad_s) * elapsed_s;
        let pitch = |reading: &Reading, roll_rad: f64| {
            f64::from(estimate::pitch(&c.pitch, roll_rad as f32, reading.steer_rad as f32))
        };
        let (pitch_rad, pitch_before_rad) = (pitch(now, roll_rad), pitch(before, roll_before_rad));
        self.step.pitch_rad.set(lane, Parabola([pitch_rad, (pitch_rad - pitch_before_rad) / elapsed_s, 0.0]));
        let (sin, cos) = sin_cos(roll_rad);
        (self.step.roll_sin[0].0[lane], self.step.roll_sin[1].0[lane]) = (sin - cos * roll_rad, cos);

        let [x, _, z] = now.gyro_rad_s;
        let lever = f64::from(c.imu.up_m) * (x - bias_rad_s - signals.smooth_rad_s[0].0[lane])
            + f64::from(c.imu.forward_m) * (z - slow.bias_rad_s[1] - signals.smooth_rad_s[1].0[lane]);
        let lever_m_s2 = lever / f64::from(OBSERVATION_LAG_S);
        let pull_m_s2 = now.accel_m_s2.iter().map(|force| force * force).sum::<f64>().sqrt() - f64::from(G);
        let violence = (lever_m_s2 * lever_m_s2 + pull_m_s2 * pull_m_s2) / f64::from(c.violent_m_s2).powi(2);
        let variance = f64::from(c.accel_noise_rad).powi(2) * (1.0 + violence) / period_s;
        let weights = slow.weights(self.plan, variance, periods);
        (self.step.weights[0].0[lane], self.step.weights[1].0[lane]) = (weights[0], weights[1]);

        let middle_m_s = match config.input.wheel {
            Wheel::Front => through(&|reading| reading.front_wheel_m_s).at(0.5 * h),
            Wheel::Rear => rear_m_s.at(0.5 * h),
        } as f32;
        let part = config.limits.taper.map_or(1.0, |taper| {
            ((middle_m_s - taper.zero_m_s) / (taper.full_m_s - taper.zero_m_s)).clamp(0.0, 1.0)
        });
        self.step.gain_nm_s_rad.0[lane] =
            f64::from(part * config.law.gain_towards_zero(middle_m_s, middle_m_s));

        let turns_back = now.steer_rate_rad_s * signals.torque_nm.0[lane] < 0.0;
        let turns_against = turns_back && now.steer_rate_rad_s.abs() > *against_rad_s;
        slow.against_s = (slow.against_s + if turns_against { elapsed_s } else { -elapsed_s }).max(0.0);
        roll_rad.abs() < ROLL_RAD && slow.against_s < *most_s
    }

    /// The control periods of the steps that have begun; writes the torques of these lanes: over the step, and of its first period
    /// \[N m\].
    #[inline(always)]
    pub(super) fn run(&mut self, line: &mut Line<Lanes<N>>, held_nm: &mut Lanes<N>) {
        let most = self.periods.into_iter().max().unwrap_or(0);
        if most == 0 {
            return;
        }
        let zero = Lanes([0.0; N]);
        let (mut first_nm, mut sum, mut moment) = (zero, zero, zero);
        for period in 0..most {
            let after = self.signals.after(self.plan, &self.step, f64::from(period) * self.plan.period_s);
            // 1 in a lane whose step has this period.
            let on = Lanes(self.periods.map(|periods| if period < periods { 1.0 } else { 0.0 }));
            self.signals = self.signals.towards(&after, on);
            if period == 0 {
                first_nm = after.torque_nm;
            }
            let torque_nm = after.torque_nm * on;
            sum = sum + torque_nm;
            moment = moment + torque_nm * (f64::from(period) + 0.5);
        }
        for (lane, periods) in self.periods.iter_mut().enumerate().filter(|(_, periods)| **periods > 0) {
            let periods = f64::from(std::mem::take(periods));
            let (sum, moment) = (sum.0[lane], moment.0[lane]);
            line.set(lane, sum, moment - 0.5 * periods * sum, periods);
            held_nm.0[lane] = first_nm.0[lane];
        }
    }
}

impl Slow {
    /// Weights of an observation with this variance in roll angle and bias; the covariance proceeds by some control periods.
    fn weights(&mut self, plan: &CalmPlan, variance: f64, periods: u32) -> [f64; 2] {
        let c = &plan.config.estimate;
        let [p11, p12, p22] = self.covariance;
        let per = 1.0 / (p11 + variance);
        let [k1, k2] = [p11 * per, p12 * per];
        let (walk, bias_walk) = (f64::from(c.gyro_walk_rad), f64::from(c.bias_walk_rad_s));
        let periods = f64::from(periods);
        let h = periods * plan.period_s;
        self.covariance = [
            p11 + h * (walk * walk - 2.0 * p12) - periods * k1 * p11,
            p12 - h * p22 - periods * k2 * p11,
            p22 + h * bias_walk * bias_walk - periods * k2 * p12,
        ];
        [k1, k2]
    }
}

impl<const N: usize> Signals<Lanes<N>> {
    /// One control period `ahead_s` after the step's start, as the estimator, the prediction, the smoothing and the limits.
    #[inline(always)]
    fn after(&self, plan: &CalmPlan, step: &Step<Lanes<N>>, ahead_s: f64) -> Self {
        let (config, c, dt) = (plan.config, &plan.config.estimate, plan.period_s);
        let (up_m, forward_m) = (f64::from(c.imu.up_m), f64::from(c.imu.forward_m));
        let radius_m = f64::from(c.wheel_radius_m);
        let [gyro_x, wy, wz] = [0, 1, 2].map(|axis| step.gyro_rad_s[axis].at(ahead_s));
        let wx = gyro_x - self.bias_rad_s;
        let pitch = step.pitch_rad.at(ahead_s);
        let rate = wx + (wz - pitch * wx * 0.5) * pitch;
        let roll = self.roll_rad + rate * dt;

        let sin_roll = step.roll_sin[0] + step.roll_sin[1] * roll;
        let rolling = step.rear_m_s.at(ahead_s) - wy * radius_m;
        let swing = wy * (wx * forward_m + wz * (radius_m - up_m));
        let unexplained =
            step.force_m_s2.at(ahead_s) - rolling * (wz - wx * pitch) + sin_roll * f64::from(G) - swing;
        let weight = dt / (f64::from(OBSERVATION_LAG_S) + dt);
        let unexplained_m_s2 = self.unexplained_m_s2 + (unexplained - self.unexplained_m_s2) * weight;
        let [x, z] = self.smooth_rad_s;
        let smooth_rad_s = [x + (wx - x) * weight, z + (wz - z) * weight];
        let lever = (wx - smooth_rad_s[0]) * up_m + (wz - smooth_rad_s[1]) * forward_m;
        let innovation =
            (lever * (1.0 / f64::from(OBSERVATION_LAG_S)) - unexplained_m_s2) * (1.0 / f64::from(G));
        let error = bounded(innovation, MAX_INNOVATION_RAD.into());
        let slow_rad_s = self.slow_rad_s + (rate - self.slow_rad_s) * (dt / (f64::from(c.accel_lag_s) + dt));

        let lead = f64::from(config.predict.lead_s / c.accel_lag_s);
        let predicted = rate + bounded((rate - slow_rad_s) * lead, config.predict.max_rad_s.into());
        let [low, change] = self.low_rad_s;
        let angle = plan.angle_rad;
        let factor = 1.0 / (1.0 + SQRT_2 * angle + angle * angle);
        let change = (change + (predicted - low) * angle) * factor;
        let low = low + change * angle;
        let fast = predicted - low;
        let ratio = fast * plan.per_bound;
        let smoothed = predicted - fast / (ratio * ratio + 1.0);
        let excess =
            if config.dead_band.is_on() { smoothed.map(|x| config.dead_band.excess(x)) } else { smoothed };
        let wanted_nm = excess * step.gain_nm_s_rad;
        Self {
            roll_rad: roll + step.weights[0] * error,
            bias_rad_s: bounded(self.bias_rad_s + step.weights[1] * error, c.bias_max_rad_s.into()),
            unexplained_m_s2,
            smooth_rad_s,
            slow_rad_s,
            low_rad_s: [low, change],
            torque_nm: Lanes(std::array::from_fn(|i| plan.limited_nm(wanted_nm.0[i], self.torque_nm.0[i]))),
        }
    }

    /// These where `on` is 0, those `after` where it is 1.
    #[inline(always)]
    fn towards(&self, after: &Self, on: Lanes<N>) -> Self {
        let one = |a: Lanes<N>, b: Lanes<N>| a + (b - a) * on;
        let two = |a: [Lanes<N>; 2], b: [Lanes<N>; 2]| [one(a[0], b[0]), one(a[1], b[1])];
        Self {
            roll_rad: one(self.roll_rad, after.roll_rad),
            bias_rad_s: one(self.bias_rad_s, after.bias_rad_s),
            unexplained_m_s2: one(self.unexplained_m_s2, after.unexplained_m_s2),
            smooth_rad_s: two(self.smooth_rad_s, after.smooth_rad_s),
            slow_rad_s: one(self.slow_rad_s, after.slow_rad_s),
            low_rad_s: two(self.low_rad_s, after.low_rad_s),
            torque_nm: one(self.torque_nm, after.torque_nm),
        }
    }
}

impl Parabola<f64> {
    /// Through three values at their times \[s\], latest first.
    fn through([t0, t1, t2]: [f64; 3], [y0, y1, y2]: [f64; 3]) -> Self {
        let (slope, before) = ((y0 - y1) / (t0 - t1), (y1 - y2) / (t1 - t2));
        let curvature = (slope - before) / (t0 - t2);
        Self([y0, slope + (t0 - t1) * curvature, curvature])
    }
}

impl<const N: usize> Parabola<Lanes<N>> {
    fn set(&mut self, lane: usize, one: Parabola<f64>) {
        self.0.iter_mut().zip(one.0).for_each(|(all, one)| all.0[lane] = one);
    }
}

impl<S: Scalar> Parabola<S> {
    /// The value `ahead_s` seconds after the step's start.
    #[inline(always)]
    fn at(&self, ahead_s: f64) -> S {
        let [value, slope, curvature] = self.0;
        value + (slope + curvature * ahead_s) * ahead_s
    }
}

/// Limited to `most`, either way.
#[inline(always)]
fn bounded<const N: usize>(x: Lanes<N>, most: f64) -> Lanes<N> {
    x.map(|x| x.min(most).max(-most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ride::hardware::exact_frame;
    use crate::ride::warm_start::{Engaged, engaged};
    use control::Config;
    use std::f64::consts::TAU;

    const SPEED_M_S: f64 = 4.0;
    const PERIOD_S: f64 = 1e-3;
    const HEIGHT_M: f64 = 0.8;

    /// Readings at `t_s` of a bicycle that sways, steering into the fall; the specific force is that of the earlier time `force_s`.
    fn swaying(t_s: f64, force_s: f64) -> Reading {
        let rate = TAU * 0.8;
        let (sin, cos) = sin_cos(rate * t_s);
        let roll = 0.05 * sin;
        let yaw_rad_s = 0.4 * sin;
        let force_sin = sin_cos(rate * force_s).0;
        let accel = 0.4 * force_sin * SPEED_M_S
            - f64::from(G) * 0.05 * force_sin
            - HEIGHT_M * 0.05 * rate * rate * force_sin;
        Reading {
            gyro_rad_s: [0.05 * rate * cos, yaw_rad_s * roll, yaw_rad_s],
            accel_m_s2: [0.0, accel, -f64::from(G)],
            steer_rad: 0.11 * sin,
            steer_rate_rad_s: 0.11 * rate * cos,
            ..Reading::steady(SPEED_M_S, G.into())
        }
    }

    /// Given the product's controller in calm motion, when it is computed in steps of twelve control periods, then the mean torque
    /// of every step is that of the control step within 0.5 % of the largest torque.
    #[test]
    fn the_torque_is_that_of_the_control_step() {
        let mut config = Config::product();
        config.calibration.polarity_checked = true;
        // The bicycle of this motion is no linear bicycle.
        config.response.motor = None;
        let plan = config.plan().expect("a valid configuration");
        let calm = CalmPlan::new(&plan, PERIOD_S).expect("a controller without other functions");
        let mut lanes = CalmLanes::<1>::new(&calm);
        let Engaged { mut state, mut ticks, mut command } = engaged(&plan, SPEED_M_S, G.into());
        let zero = Lanes([0.0]);
        let mut line = Line::straight(zero, zero);
        let mut held_nm = zero;
        let (mut largest_nm, mut worst_nm) = (0.0_f64, 0.0_f64);
        for step in 0..300 {
            let at = |step: i32| 0.012 * f64::from(step);
            if step == 80 {
                assert!(calm.free(&state, &command), "{command:?}");
                lanes.enter(0, &state);
            }
            if step >= 80 {
                let past =
                    [step, step - 1, step - 2].map(|step| (at(step), swaying(at(step), at(step) - 0.006)));
                assert!(calm.covers(&past[0].1));
                assert!(lanes.begin(0, &past, 12));
                lanes.run(&mut line, &mut held_nm);
            }
            let mut sum = 0.0;
            for period in 0..12 {
                let t_s = at(step) + PERIOD_S * f64::from(period);
                let motor_torque_nm = command.torque_nm.into();
                let reading = Reading { motor_torque_nm, ..swaying(t_s, t_s - 0.5 * PERIOD_S) };
                command = control::step(&plan, &mut state, &exact_frame(&plan, &reading, ticks, true));
                ticks += 1;
                sum += f64::from(command.torque_nm) / 12.0;
            }
            if step >= 80 {
                largest_nm = largest_nm.max(sum.abs());
                worst_nm = worst_nm.max((line.at(0.5).0[0] - sum).abs());
            }
        }
        assert!(largest_nm > 1.0, "{largest_nm}");
        assert!(worst_nm < 0.005 * largest_nm, "{worst_nm} of {largest_nm} N m");
    }
}
