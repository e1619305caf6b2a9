//! The bicycle with all six speeds as state; which three of them are independent is chosen at every instant.
//!
//! Roll rate, steer rate and rear wheel rate determine the other speeds except at two singular
//! configurations: the front wheel across the path (the rear wheel can't roll), and the front wheel beside
//! the rear wheel (only pitch moves). The motion passes these smoothly, and there the yaw rate and the pitch rate determine the
//! others. `docs/bicycle.md`, section 9.

use super::dynamics::solve;
use super::inertia::{Inertia, Momenta};
use super::pitch::Attitude;
use super::{Geometry, Motion, Pose, State, Torques, Velocities};
use crate::num::{Moves, Vec3, sin_cos};

/// A state with redundant speeds, which satisfy the constraints.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FullState {
    /// Roll, pitch and steer \[rad\].
    pub angles: [f64; 3],
    /// Rates of roll, pitch, yaw, steer, rear wheel and front wheel \[rad/s\].
    pub speeds: [f64; 6],
}

impl FullState {
    /// The state with its dependent speeds, from a motion away from the singular configurations.
    pub fn new(motion: &Motion<f64>, state: &State<f64>) -> Self {
        let v = &motion.actual;
        Self {
            angles: [state.roll, motion.pose.attitude.pitch, state.steer],
            speeds: [v.roll, v.pitch, v.yaw, v.steer, v.rear_spin, v.front_spin],
        }
    }

    /// The independent state.
    pub fn state(&self) -> State<f64> {
        State {
            roll: self.angles[0],
            pitch: self.angles[1],
            steer: self.angles[2],
            roll_rate: self.speeds[0],
            steer_rate: self.speeds[3],
            rear_wheel_rate: self.speeds[4],
        }
    }

    /// The pose at the stored pitch.
    #[inline(always)]
    pub fn pose(&self, b: &Geometry) -> Pose<f64> {
        let [roll, pitch, steer] = self.angles;
        let tilt = sin_cos(pitch + b.lam);
        Pose::new(b, Attitude { roll: sin_cos(roll), steer: sin_cos(steer), tilt, pitch })
    }

    /// The velocities, with the stored dependent ones.
    #[inline(always)]
    pub fn velocities(&self, b: &Geometry) -> Velocities<f64> {
        velocities(&self.pose(b), &self.speeds)
    }

    /// Time derivative of every entry under `torques`, in the same fields. `None` if the equations are
    /// singular, which does not occur near a ride.
    #[inline(always)]
    pub fn rate(&self, b: &Geometry, torques: &Torques<f64>) -> Option<FullState> {
        let pose = self.pose(b);
        self.rate_under(b, &pose, &Constraints::new(b, &pose), torques)
    }

    /// As [`Self::rate`], with a choice of the independent speeds.
    #[inline(always)]
    fn rate_under(
        &self,
        b: &Geometry,
        pose: &Pose<f64>,
        constraints: &Constraints,
        torques: &Torques<f64>,
    ) -> Option<FullState> {
        let actual = velocities(pose, &self.speeds);
        let inertia = Inertia::new(b, pose);
        let (bias, free) = super::bias::bias(b, pose, &actual, &inertia, None);
        let steer = Vec3::new(-pose.trail.y, pose.trail.x, 0.0);
        let [across, along] = constraints.by_independent;
        let closed = |units: [f64; 3], free| velocities(pose, &constraints.speeds(b, pose, units, free));
        let u = closed([1.0, 0.0, 0.0], across);
        let v = closed([0.0, 1.0, 0.0], steer);
        let w = closed([0.0, 0.0, 1.0], along);
        // Without independent accelerations, the dependent ones close the contact.
        let closing = closed([0.0; 3], free);

        let momenta = |v: &Velocities<f64>| inertia.momenta::<true, true, true>(b, pose, v);
        let power = |v: &Velocities<f64>, f: &Momenta<f64>| v.power::<true, true, true>(b, pose, f);
        let (of_u, of_v, of_w, of_closing) = (momenta(&u), momenta(&v), momenta(&w), momenta(&closing));
        let mass = [
            power(&u, &of_u),
            power(&u, &of_v),
            power(&u, &of_w),
            power(&v, &of_v),
            power(&v, &of_w),
            power(&w, &of_w),
        ];
        let force = [&u, &v, &w].map(|v| {
            v.roll * torques.roll + v.steer * torques.steer - power(v, &bias) - power(v, &of_closing)
        });
        let [by_u, by_v, by_w] = solve(&mass, force);
        let sum =
            |of: fn(&Velocities<f64>) -> f64| by_u * of(&u) + by_v * of(&v) + by_w * of(&w) + of(&closing);
        let speeds = [
            sum(|v| v.roll),
            sum(|v| v.pitch),
            sum(|v| v.yaw),
            sum(|v| v.steer),
            sum(|v| v.rear_spin),
            sum(|v| v.front_spin),
        ];
        let angles = [actual.roll, actual.pitch, actual.steer];
        speeds.iter().all(|x| x.is_finite()).then_some(FullState { angles, speeds })
    }
}

/// Indices in [`FullState::speeds`].
const ROLL: usize = 0;
const PITCH: usize = 1;
const YAW: usize = 2;
const STEER: usize = 3;
const REAR: usize = 4;
const FRONT: usize = 5;

/// The rolling constraints at the front contact, solved for roll or pitch rate, yaw or rear wheel rate, and the front wheel's rate.
/// Of either pair that speed is dependent which moves the contact more: no divisor is small in both singular configurations.
struct Constraints {
    /// The two dependent speeds, and the independent one of either pair.
    dependent: [usize; 2],
    independent: [usize; 2],
    /// Velocity of the material point at the front contact per unit of the dependent speeds, and of the independent ones.
    by_dependent: [Vec3<f64>; 2],
    by_independent: [Vec3<f64>; 2],
    /// One over the vertical and lateral components of the dependent ones.
    per: [f64; 2],
}

impl Constraints {
    #[inline(always)]
    fn new(b: &Geometry, pose: &Pose<f64>) -> Self {
        let [roll, pitch, yaw, rear] = moved(b, pose);
        let more = |a: Vec3<f64>, b: Vec3<f64>, along: Vec3<f64>| along.dot(a).abs() >= along.dot(b).abs();
        Self::with(b, pose, more(pitch, roll, pose.k), more(yaw, rear, pose.lateral))
    }

    /// With the pitch rate dependent instead of the roll rate, and the yaw rate instead of the rear wheel's, or not.
    #[inline(always)]
    fn with(b: &Geometry, pose: &Pose<f64>, pitch: bool, yaw: bool) -> Self {
        let [by_roll, by_pitch, by_yaw, by_rear] = moved(b, pose);
        let (roll, pitching) = ((ROLL, by_roll), (PITCH, by_pitch));
        let (yawing, rear) = ((YAW, by_yaw), (REAR, by_rear));
        let (first, across) = if pitch { (pitching, roll) } else { (roll, pitching) };
        let (second, along) = if yaw { (yawing, rear) } else { (rear, yawing) };
        Self {
            dependent: [first.0, second.0],
            independent: [across.0, along.0],
            by_dependent: [first.1, second.1],
            by_independent: [across.1, along.1],
            per: [1.0 / pose.k.dot(first.1), 1.0 / pose.lateral.dot(second.1)],
        }
    }

    /// All six speeds (or accelerations) from the independent ones, in the order of roll or pitch, steer, rear wheel or yaw; `free` is
    /// the velocity (or acceleration) of the material point at the contact without the dependent ones.
    ///
    /// Solved in sequence: only roll, pitch and steer rate move the point vertically, the front wheel's only along its heading.
    #[inline(always)]
    fn speeds(
        &self,
        b: &Geometry,
        pose: &Pose<f64>,
        [across, steer, along]: [f64; 3],
        free: Vec3<f64>,
    ) -> [f64; 6] {
        let first = -(pose.k.dot(free) * self.per[0]);
        let free = free + self.by_dependent[0].scaled(first);
        let second = -(pose.lateral.dot(free) * self.per[1]);
        let free = free + self.by_dependent[1].scaled(second);
        let mut speeds = [0.0; 6];
        (speeds[self.dependent[0]], speeds[self.dependent[1]]) = (first, second);
        (speeds[self.independent[0]], speeds[self.independent[1]]) = (across, along);
        (speeds[STEER], speeds[FRONT]) = (steer, pose.heading.dot(free) * (-1.0 / b.rF));
        speeds
    }
}

/// Velocities of the material point at the front contact at unit rates of roll, pitch, yaw and rear wheel.
#[inline(always)]
fn moved(b: &Geometry, pose: &Pose<f64>) -> [Vec3<f64>; 4] {
    let base = pose.base;
    [pose.e1.cross(base), Vec3::new(base.z, 0.0, -base.x), pose.k.cross(base), pose.e1.scaled(-b.rR)]
}

#[inline(always)]
fn velocities(
    pose: &Pose<f64>,
    &[roll, pitch, yaw, steer, rear_spin, front_spin]: &[f64; 6],
) -> Velocities<f64> {
    let mut omega = pose.e1.scaled(roll) + pose.k.scaled(yaw);
    omega.y += pitch;
    Velocities { roll, pitch, yaw, steer, rear_spin, front_spin, omega, rolling: omega.y + rear_spin }
}

impl Moves for FullState {
    fn moved(&self, h: f64, rate: &Self) -> Self {
        let mut to = *self;
        to.angles.iter_mut().zip(rate.angles).for_each(|(x, r)| *x += h * r);
        to.speeds.iter_mut().zip(rate.speeds).for_each(|(x, r)| *x += h * r);
        to
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bicycle::Parameters;

    /// Situation: roll, steer and speeds away from singular configurations.
    /// Action: the accelerations with each choice of the independent speeds, and those of the three-speed equations.
    /// Must hold: all are the same.
    #[test]
    fn every_choice_of_independent_speeds_gives_the_same_accelerations() {
        let shipped = physics::bicycle::catalogue::load("rigid_jason").unwrap().parameters.to_values();
        let b = Geometry::new(&Parameters::from_values(&shipped));
        let torques = Torques { roll: 4.0, steer: -3.0 };
        let mut compared = 0;
        for (roll, steer, roll_rate, steer_rate) in
            [(0.3, -0.5, 1.0, -2.0), (-0.9, 0.8, -3.0, 4.0), (0.6, 0.4, 0.2, 9.0), (1.1, -0.7, -2.0, 1.0)]
        {
            let pitch = crate::bicycle::pitch_from_upright(&b, roll, steer).unwrap();
            let upright = State::upright(&b, 4.0);
            let state = State { roll, steer, pitch, roll_rate, steer_rate, ..upright };
            let motion = Motion::new(&b, &state);
            let three = motion.accelerations(&b, &torques);
            let full = FullState::new(&motion, &state);
            let pose = full.pose(&b);
            for (pitch, yaw) in [(true, true), (true, false), (false, true), (false, false)] {
                let constraints = Constraints::with(&b, &pose, pitch, yaw);
                let rate = full.rate_under(&b, &pose, &constraints, &torques).unwrap().speeds;
                let pairs =
                    [(rate[ROLL], three.roll), (rate[STEER], three.steer), (rate[REAR], three.rear_wheel)];
                for (six, three) in pairs {
                    assert!(
                        (six - three).abs() < 1e-9 * (1.0 + three.abs()),
                        "{six} for {three}: {pitch} {yaw}"
                    );
                }
                compared += 1;
            }
        }
        assert_eq!(compared, 16);
    }
}
