//! Which controllers have a calm form, and when their motion is calm.

use crate::plant::Reading;
use control::safety::limits::Window;
use control::sensors::cross_check::CrossCheckConfig;
use control::{Calibration, Command, Config, EngagementConfig, Limits, Mode, Plan, State, ValidationConfig};
use std::f64::consts::SQRT_2;

/// Largest steer angle \[rad\], steer rate and angular rate of the frame \[rad/s\] of calm motion, in which no check has been found
/// to end a ride.
const STEER_RAD: f64 = 0.5;
const STEER_RATE_RAD_S: f64 = 3.0;
const FRAME_RAD_S: f64 = 1.5;
/// Largest estimated roll angle \[rad\].
pub(super) const ROLL_RAD: f64 = 0.8;
/// Time for which the motion must have been calm \[s\].
pub(in crate::ride::quick) const SETTLED_S: f64 = 0.1;
/// Factor of this time for a ride whose motion did not remain calm.
pub(in crate::ride::quick) const LONGER: f64 = 4.0;

/// What acts in calm motion, of a controller that has no other function between its sensors and its torque.
#[derive(Clone, Debug)]
pub(in crate::ride::quick) struct CalmPlan<'a> {
    pub(super) config: &'a Config,
    pub(super) period_s: f64,
    /// Low-pass: its angle in a control period \[rad\], and 1 over its bound \[s/rad\].
    pub(super) angle_rad: f64,
    pub(super) per_bound: f64,
    /// Largest torque, and its largest change away from zero and towards it in a control period \[N m\].
    pub(super) largest_nm: f64,
    pub(super) rise_nm: f64,
    pub(super) fall_nm: f64,
    /// Steer rate against the torque \[rad/s\], and the time for which the limits permit it \[s\].
    pub(super) against: (f64, f64),
}

impl<'a> CalmPlan<'a> {
    /// `None` if the controller has other functions, or its sensors are not mounted as the bicycle's axes.
    pub(in crate::ride::quick) fn new(plan: &'a Plan, period_s: f64) -> Option<Self> {
        // Every field is named, so that a new function of the controller is considered here.
        let config @ Config {
            rate_hz: _,
            law: _,
            dead_band: _,
            capsize,
            calibration,
            input: sensors,
            estimate,
            cross,
            response: _,
            permit,
            latency,
            predict: _,
            smooth,
            track,
            limits,
        } = plan.config();
        let polarity_checked = calibration.polarity_checked;
        let Limits {
            max_torque_nm,
            speed_cap,
            taper: _,
            rise_nm_s,
            fall_nm_s,
            rider_torque: _,
            rider_motion,
            window,
            end_stop,
            limp_fraction: _,
        } = limits;
        let change_nm = |rate: &Option<f32>| rate.map_or(f64::INFINITY, |rate| f64::from(rate) * period_s);
        let rise_nm = change_nm(rise_nm_s);
        // The limit of the change acts before the window does.
        let idle = |window: &Window| {
            rise_nm / period_s * f64::from(window.longest_s(period_s as f32)) <= window.nm.into()
        };
        // Sensors, ranges and conditions with which no check was found to act in calm motion.
        let Config { input: usual, cross: usual_cross, permit: usual_permit, .. } = Config::product();
        let CrossCheckConfig { wheelbase_m, tilt_rad, .. } = *cross;
        let need_polarity = permit.need_polarity;
        let checked = *sensors == ValidationConfig { wheel: sensors.wheel, ..usual }
            && *cross == CrossCheckConfig { wheelbase_m, tilt_rad, ..usual_cross }
            && *permit == EngagementConfig { need_polarity, ..usual_permit };
        let bare = !capsize.is_on()
            && track.is_none()
            && *latency == Default::default()
            && *calibration == Calibration { polarity_checked, ..Default::default() }
            && estimate.needs_motion()
            && smooth.lag_s > 0.0
            && checked
            && speed_cap.is_none()
            && window.as_ref().is_none_or(idle)
            && end_stop.is_none_or(|stop| f64::from(stop.soft_rad) >= STEER_RAD);
        bare.then(|| Self {
            config,
            period_s,
            angle_rad: SQRT_2 * period_s / f64::from(smooth.lag_s),
            per_bound: smooth.most_rad_s.map_or(0.0, |most| 1.0 / f64::from(most)),
            largest_nm: max_torque_nm.map_or(f64::INFINITY, f64::from),
            rise_nm,
            fall_nm: change_nm(fall_nm_s),
            against: rider_motion.map_or((f64::INFINITY, f64::INFINITY), |rider| {
                (rider.steer_rate_rad_s.into(), 1e-3 * f64::from(rider.after_ms))
            }),
        })
    }

    /// Whether the motion is calm by its sensors.
    pub(in crate::ride::quick) fn covers(&self, now: &Reading) -> bool {
        now.steer_rad.abs() < STEER_RAD
            && now.steer_rate_rad_s.abs() < STEER_RATE_RAD_S
            && now.gyro_rad_s.iter().all(|rate| rate.abs() < FRAME_RAD_S)
    }

    /// Whether nothing but limits reduces the torque.
    pub(in crate::ride::quick) fn free(&self, state: &State, command: &Command) -> bool {
        command.mode == Mode::Engaged
            && state.authority() == 1.0
            && command.causes.is_empty()
            && state.estimate().riding().is_some()
    }

    /// The torque that the limits permit after another one \[N m\].
    #[inline(always)]
    pub(super) fn limited_nm(&self, wanted_nm: f64, last_nm: f64) -> f64 {
        let change_nm = wanted_nm.min(self.largest_nm).max(-self.largest_nm) - last_nm;
        let largest_nm = if change_nm * last_nm < 0.0 { self.fall_nm } else { self.rise_nm };
        last_nm + change_nm.min(largest_nm).max(-largest_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control::Wheel;

    const PERIOD_S: f64 = 1e-3;

    /// Given the product's controller, when a function is switched on that acts in calm motion, then it has no calm form.
    #[test]
    fn only_functions_that_are_computed_act() {
        let mut product = Config::product();
        product.calibration.polarity_checked = true;
        let is_calm = |change: &dyn Fn(&mut Config)| {
            let mut config = product.clone();
            change(&mut config);
            CalmPlan::new(&config.plan().expect("a valid configuration"), PERIOD_S).is_some()
        };
        assert!(is_calm(&|_| ()));
        assert!(is_calm(&|config| config.limits.window = None));
        // 100 N m/s reach 5.7 N m in the longest window of 50 ms.
        assert!(is_calm(&|config| config.limits.window = Some(Window { ms: 50, nm: 5.8 })));
        assert!(!is_calm(&|config| config.limits.window = Some(Window { ms: 50, nm: 5.7 })));
        assert!(!is_calm(&|config| config.limits.rise_nm_s = None));
        assert!(!is_calm(&|config| config.limits.speed_cap = Some(Default::default())));
        assert!(!is_calm(&|config| config.smooth.lag_s = 0.0));
        // Checks of other ranges may act in calm motion.
        assert!(!is_calm(&|config| config.permit.fallen_rad = Some(0.6)));
        assert!(!is_calm(&|config| config.cross.yaw_rad_s = Some(0.2)));
        assert!(!is_calm(&|config| config.input.gyro.fitted = false));
        assert!(is_calm(&|config| config.input.wheel = Wheel::Rear));
        assert!(is_calm(&|config| config.cross.wheelbase_m = 1.2));
    }
}
