//! Follows a path: a small torque that is added to the law's, so that a balancing bicycle comes back to a path.
//!
//! Full feedback of roll, steer, their rates, heading error, lateral error and its integral, with gains
//! from a table over speed. A bicycle must first steer away from where it is to go; feedback of the
//! errors alone can't do that and stay upright, feedback of the whole state does it by itself. The
//! gains of [`PathTracking::default`] are computed by `sim_host::tracking`: the linear-quadratic regulator
//! of the linear bicycle with the law `h` in the loop.
//!
//! It is the weakest voice: bounded in size and slope, it fades out while the rider pushes or turns
//! against the assist, below its slowest speed, and when the path is lost. Its integral stands still whenever
//! the torque is not wholly its own.

use crate::maths::{bounded, max, min};
use crate::param::{ParamError, ParamSpec, ParamVisitor};
use crate::safety::limits::ActiveLimits;

/// Points of the gain table.
pub const TRACK_POINTS: usize = 4;
/// Gains of a point: of roll, steer, roll rate, steer rate, heading, lateral error and its integral.
pub const TRACK_GAINS: usize = 7;

/// How a path is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTracking {
    /// Speeds of the table \[m/s\], each at least 0.1 above the one before; below the first there is no tracking.
    pub speed_m_s: [f32; TRACK_POINTS],
    /// Torque against each quantity: N m per rad, rad, rad/s, rad/s, rad, m and m s, in the order of [`TRACK_GAINS`].
    /// Linear between the points, constant above the last.
    pub gains: [[f32; TRACK_GAINS]; TRACK_POINTS],
    /// Largest torque, either way \[N m\].
    pub max_torque_nm: f32,
    /// Largest change of the torque \[N m/s\].
    pub slew_nm_s: f32,
    /// Heading error beyond which it counts no more \[rad\].
    pub heading_max_rad: f32,
    /// Lateral error beyond which it counts no more \[m\]: so the path is approached at a bounded angle.
    pub lateral_max_m: f32,
    /// Lateral error beyond which the integral grows no faster \[m\].
    pub integrate_max_m: f32,
    /// Largest integral \[m s\].
    pub integral_max_m_s: f32,
    /// Torque of the rider, either way, above which tracking gives way \[N m\].
    pub rider_nm: f32,
    /// From all to none when it gives way, and back \[ms\].
    pub fade_ms: u16,
}

impl Default for PathTracking {
    /// The computed gains. Errors count up to 0.3 rad and 1 m, so that a path far away is approached at 0.1 to
    /// 0.2 rad; 2 N m leave the rest of 7 N m to balance.
    fn default() -> Self {
        Self {
            speed_m_s: [2.0, 4.0, 6.0, 8.0],
            gains: [
                [-28.758, 2.039, -2.756, 0.343, -6.556, -1.387, -0.141],
                [-20.355, 1.953, -2.834, 0.292, -9.529, -1.293, -0.141],
                [-14.399, 6.495, -3.208, 0.480, -10.828, -1.227, -0.141],
                [-13.837, 11.415, -3.768, 0.612, -13.591, -1.215, -0.141],
            ],
            max_torque_nm: 2.0,
            slew_nm_s: 20.0,
            heading_max_rad: 0.3,
            lateral_max_m: 1.0,
            integrate_max_m: 0.1,
            integral_max_m_s: 5.0,
            rider_nm: 3.0,
            fade_ms: 300,
        }
    }
}

const GROUPS: [&str; TRACK_POINTS] = ["track.point_1", "track.point_2", "track.point_3", "track.point_4"];

const NAMES: [&str; TRACK_GAINS] = [
    "roll_nm_rad",
    "steer_nm_rad",
    "roll_rate_nm_s_rad",
    "steer_rate_nm_s_rad",
    "heading_nm_rad",
    "lateral_nm_m",
    "integral_nm_m_s",
];

impl PathTracking {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let points = self.speed_m_s.iter_mut().zip(&mut self.gains);
        for (group, (speed, gains)) in GROUPS.into_iter().zip(points) {
            to.number(&ParamSpec::new(group, "speed_m_s", 0.5, 30.0), speed);
            for (name, gain) in NAMES.into_iter().zip(gains) {
                to.number(&ParamSpec::new(group, name, -200.0, 200.0), gain);
            }
        }
        let leaf = |name, min, max| ParamSpec::new("track", name, min, max);
        to.number(&leaf("max_torque_nm", 0.0, 10.0), &mut self.max_torque_nm);
        to.number(&leaf("slew_nm_s", 0.1, 1000.0), &mut self.slew_nm_s);
        to.number(&leaf("heading_max_rad", 0.01, 1.0), &mut self.heading_max_rad);
        to.number(&leaf("lateral_max_m", 0.01, 10.0), &mut self.lateral_max_m);
        to.number(&leaf("integrate_max_m", 0.0, 10.0), &mut self.integrate_max_m);
        to.number(&leaf("integral_max_m_s", 0.0, 100.0), &mut self.integral_max_m_s);
        to.number(&leaf("rider_nm", 0.0, 50.0), &mut self.rider_nm);
        to.count(&leaf("fade_ms", 10.0, 5000.0), &mut self.fade_ms);
    }

    /// Checks that the speeds rise.
    ///
    /// # Errors
    /// The speed, and the range that the one before leaves it.
    pub fn cross(&self) -> Result<(), ParamError> {
        for (group, pair) in GROUPS.into_iter().skip(1).zip(self.speed_m_s.windows(2)) {
            if let [before, after] = *pair {
                ParamSpec::new(group, "speed_m_s", before + 0.1, 30.0).check(after)?;
            }
        }
        Ok(())
    }

    /// The torque against errors at a speed \[N m\].
    fn against(&self, speed: f32, errors: &[f32; TRACK_GAINS]) -> f32 {
        let mut before: Option<(f32, &[f32; TRACK_GAINS])> = None;
        for (&v, gains) in self.speed_m_s.iter().zip(&self.gains) {
            if speed <= v {
                return before.map_or_else(
                    || dot(gains, errors),
                    |(v0, g0)| {
                        let low = dot(g0, errors);
                        low + (dot(gains, errors) - low) * ((speed - v0) / (v - v0))
                    },
                );
            }
            before = Some((v, gains));
        }
        before.map_or(0.0, |(_, gains)| dot(gains, errors))
    }
}

/// Where the bicycle is, seen from the path. Positive: to the right of it, pointing to the right of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathError {
    /// Heading less the path's direction \[rad\].
    pub heading_rad: f32,
    /// Distance of the rear contact from the path \[m\].
    pub lateral_m: f32,
}

/// What tracking goes by in one control period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackingInput {
    /// Roll, right positive \[rad\].
    pub roll_rad: f32,
    /// Steer, right positive \[rad\].
    pub steer_rad: f32,
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f32,
    /// Steer rate \[rad/s\].
    pub steer_rate_rad_s: f32,
    /// Forward speed \[m/s\].
    pub speed_m_s: f32,
    /// The path's errors, if they are known and fresh.
    pub path: Option<PathError>,
    /// The rider's torque \[N m\], if it is known.
    pub rider_torque_nm: Option<f32>,
    /// The limits that acted in the last period.
    pub acted: ActiveLimits,
    /// The part of the torque that is permitted, 0 to 1.
    pub authority: f32,
    /// Time since the last step \[us\].
    pub elapsed_us: u32,
}

/// What tracking remembers. The default has not followed anything yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathTrackingState {
    path: PathError,
    integral_m_s: f32,
    strength: f32,
    torque_nm: f32,
}

/// Longest time that a step reckons with \[us\].
const LONGEST_US: u32 = 20_000;

/// The torque that leads back to the path, to be added to the law's \[N m\]. Finite, and odd.
pub fn step(track: &PathTracking, state: &mut PathTrackingState, input: &TrackingInput) -> f32 {
    let elapsed_s = input.elapsed_us.min(LONGEST_US) as f32 * 1e-6;
    let path = input.path.filter(|p| p.heading_rad.is_finite() && p.lateral_m.is_finite());
    let pushed = input.rider_torque_nm.is_some_and(|t| t.abs() > track.rider_nm);
    let overridden = input.acted.0 & (ActiveLimits::RIDER_TORQUE.0 | ActiveLimits::RIDER_MOTION.0) != 0;
    let permitted = input.authority > 0.0 && input.speed_m_s >= track.speed_m_s[0];
    let follows = path.is_some() && permitted && !pushed && !overridden;

    let change = elapsed_s / (f32::from(track.fade_ms) * 1e-3);
    state.strength =
        if follows { min(1.0, state.strength + change) } else { max(0.0, state.strength - change) };
    // A lost path is held while it fades.
    state.path = path.unwrap_or(state.path);
    if state.strength == 0.0 {
        state.integral_m_s = 0.0;
    }

    let PathError { heading_rad, lateral_m } = state.path;
    let errors = [
        input.roll_rad,
        input.steer_rad,
        input.roll_rate_rad_s,
        input.steer_rate_rad_s,
        bounded(heading_rad, track.heading_max_rad),
        bounded(lateral_m, track.lateral_max_m),
        state.integral_m_s,
    ];
    let wanted = -track.against(input.speed_m_s, &errors);
    let faded = bounded(wanted, track.max_torque_nm) * state.strength;
    let slew = track.slew_nm_s * elapsed_s;
    let torque = within(faded, state.torque_nm - slew, state.torque_nm + slew);

    let whole = state.strength == 1.0 && input.authority >= 1.0 && input.acted.is_empty();
    if whole && torque == wanted {
        let rate = bounded(lateral_m, track.integrate_max_m);
        state.integral_m_s = bounded(state.integral_m_s + rate * elapsed_s, track.integral_max_m_s);
    }
    state.torque_nm = torque;
    torque
}

fn dot(gains: &[f32; TRACK_GAINS], errors: &[f32; TRACK_GAINS]) -> f32 {
    gains.iter().zip(errors).map(|(gain, error)| gain * error).sum()
}

/// `f32::clamp` without its panic on disordered bounds; NaN stays what it is.
fn within(x: f32, low: f32, high: f32) -> f32 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}
