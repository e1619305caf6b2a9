//! Path tracking: a small torque, added to the law's, that returns a balancing bicycle to a path.
//!
//! Full state feedback of roll, steer, their rates, heading error, lateral error and its integral, with gains from a
//! table over speed. A bicycle must first steer away from its target; feedback of the errors alone cannot do that and
//! stay upright, state feedback can. The gains of [`PathTracking::default`] are computed by `sim_host::tracking`: the
//! linear-quadratic regulator of the linear bicycle with the law `h-cut` in the loop, which is zero at the highest of these speeds.
//!
//! Tracking has the lowest priority. It is bounded in size and slope, and fades out while the rider pushes or turns
//! against the assist, below its lowest speed, and when the path is lost. Its integral is frozen whenever a limit, the
//! fade or the authority changes the tracking torque.

use crate::maths::{bounded, max, min};
use crate::param::{ParamError, ParamSpec, ParamVisitor};
use crate::safety::limits::ActiveLimits;

/// Number of points of the gain table.
pub const TRACK_POINTS: usize = 4;
/// Number of gains of a point: of roll, steer, roll rate, steer rate, heading, lateral error and its integral.
pub const TRACK_GAINS: usize = 7;

/// Parameters of path tracking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTracking {
    /// Speeds of the table \[m/s\], each at least 0.1 above the previous one; no tracking below the first.
    pub speed_m_s: [f32; TRACK_POINTS],
    /// Gain of each quantity, in the order of [`TRACK_GAINS`]: N m per rad, rad, rad/s, rad/s, rad, m and m s. The
    /// torque is the negative sum of gain times quantity. Linear between the points, constant above the last.
    pub gains: [[f32; TRACK_GAINS]; TRACK_POINTS],
    /// Largest torque, either way \[N m\].
    pub max_torque_nm: f32,
    /// Largest rate of change of the torque \[N m/s\].
    pub slew_nm_s: f32,
    /// Limit of the heading error \[rad\].
    pub heading_max_rad: f32,
    /// Limit of the lateral error \[m\]; it bounds the angle at which the path is approached.
    pub lateral_max_m: f32,
    /// Limit of the lateral error for the integral \[m\].
    pub integrate_max_m: f32,
    /// Largest integral \[m s\].
    pub integral_max_m_s: f32,
    /// Rider's torque, either way, above which tracking fades out \[N m\].
    pub rider_nm: f32,
    /// Time of the fade from full torque to none, and back \[ms\].
    pub fade_ms: u16,
}

impl Default for PathTracking {
    /// The computed gains. Errors are limited to 0.3 rad and 1 m, so that a distant path is approached at 0.1 to 0.2
    /// rad; 2 N m leave the rest of 7 N m for balance.
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
        let spec = |name, min, max| ParamSpec::new("track", name, min, max);
        to.number(&spec("max_torque_nm", 0.0, 10.0), &mut self.max_torque_nm);
        to.number(&spec("slew_nm_s", 0.1, 1000.0), &mut self.slew_nm_s);
        to.number(&spec("heading_max_rad", 0.01, 1.0), &mut self.heading_max_rad);
        to.number(&spec("lateral_max_m", 0.01, 10.0), &mut self.lateral_max_m);
        to.number(&spec("integrate_max_m", 0.0, 10.0), &mut self.integrate_max_m);
        to.number(&spec("integral_max_m_s", 0.0, 100.0), &mut self.integral_max_m_s);
        to.number(&spec("rider_nm", 0.0, 50.0), &mut self.rider_nm);
        to.count(&spec("fade_ms", 10.0, 5000.0), &mut self.fade_ms);
    }

    /// Checks that the speeds rise.
    ///
    /// # Errors
    /// The speed, and the range allowed by the previous one.
    pub fn cross(&self) -> Result<(), ParamError> {
        for (group, pair) in GROUPS.into_iter().skip(1).zip(self.speed_m_s.windows(2)) {
            if let [previous, next] = *pair {
                ParamSpec::new(group, "speed_m_s", previous + 0.1, 30.0).check(next)?;
            }
        }
        Ok(())
    }

    /// Sum of gain times error at a speed \[N m\].
    fn weighted_sum(&self, speed: f32, errors: &[f32; TRACK_GAINS]) -> f32 {
        let mut previous: Option<(f32, &[f32; TRACK_GAINS])> = None;
        for (&v, gains) in self.speed_m_s.iter().zip(&self.gains) {
            if speed <= v {
                return previous.map_or_else(
                    || dot(gains, errors),
                    |(v0, g0)| {
                        let low = dot(g0, errors);
                        low + (dot(gains, errors) - low) * ((speed - v0) / (v - v0))
                    },
                );
            }
            previous = Some((v, gains));
        }
        previous.map_or(0.0, |(_, gains)| dot(gains, errors))
    }
}

/// Deviation from the path. Positive: to the right of the path, heading to the right of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct PathError {
    /// Heading less the path's direction \[rad\].
    pub heading_rad: f32,
    /// Distance of the rear contact from the path \[m\].
    pub lateral_m: f32,
}

/// Inputs of path tracking in one control period.
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
    /// Path errors, if valid.
    pub path: Option<PathError>,
    /// The rider's torque \[N m\], if valid.
    pub rider_torque_nm: Option<f32>,
    /// Limits that were active in the last period.
    pub acted: ActiveLimits,
    /// Permitted fraction of the torque, 0 to 1.
    pub authority: f32,
    /// Time since the last step \[us\].
    pub elapsed_us: u32,
}

/// State of path tracking. The default is one that has not followed a path yet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct PathTrackingState {
    path: PathError,
    integral_m_s: f32,
    fade: f32,
    torque_nm: f32,
}

/// Limit of the time of a step \[us\].
const MAX_STEP_US: u32 = 20_000;

/// Tracking torque, to be added to the law's \[N m\]. Finite, and odd in its inputs.
pub fn step(track: &PathTracking, state: &mut PathTrackingState, input: &TrackingInput) -> f32 {
    let elapsed_s = input.elapsed_us.min(MAX_STEP_US) as f32 * 1e-6;
    let path = input.path.filter(|p| p.heading_rad.is_finite() && p.lateral_m.is_finite());
    let rider_pushes = input.rider_torque_nm.is_some_and(|t| t.abs() > track.rider_nm);
    let overridden = input.acted.0 & (ActiveLimits::RIDER_TORQUE.0 | ActiveLimits::RIDER_MOTION.0) != 0;
    let permitted = input.authority > 0.0 && input.speed_m_s >= track.speed_m_s[0];
    let tracking = path.is_some() && permitted && !rider_pushes && !overridden;

    let change = elapsed_s / (f32::from(track.fade_ms) * 1e-3);
    state.fade = if tracking { min(1.0, state.fade + change) } else { max(0.0, state.fade - change) };
    // The last errors of a lost path are held while the torque fades out.
    state.path = path.unwrap_or(state.path);
    if state.fade == 0.0 {
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
    let unlimited_nm = -track.weighted_sum(input.speed_m_s, &errors);
    let faded = bounded(unlimited_nm, track.max_torque_nm) * state.fade;
    let slew = track.slew_nm_s * elapsed_s;
    let torque = clamp(faded, state.torque_nm - slew, state.torque_nm + slew);

    let unrestricted = state.fade == 1.0 && input.authority >= 1.0 && input.acted.is_empty();
    if unrestricted && torque == unlimited_nm {
        let rate = bounded(lateral_m, track.integrate_max_m);
        state.integral_m_s = bounded(state.integral_m_s + rate * elapsed_s, track.integral_max_m_s);
    }
    state.torque_nm = torque;
    torque
}

fn dot(gains: &[f32; TRACK_GAINS], errors: &[f32; TRACK_GAINS]) -> f32 {
    gains.iter().zip(errors).map(|(gain, error)| gain * error).sum()
}

/// `f32::clamp` without its panic on unordered bounds; NaN stays NaN.
fn clamp(x: f32, low: f32, high: f32) -> f32 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}
