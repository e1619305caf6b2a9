//! Monitor of one declared sensor: rejects late, out-of-range, jumping and stuck samples. The last good sample is held
//! until the sensor is lost; a lost sensor must requalify.

use crate::fault::{Cause, Causes};
use crate::param::{ParamSpec, ParamVisitor};
use crate::sensors::frame::MISSING;
use core::hint::cold_path;

/// Consequence of losing a sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loss {
    /// The loss is reported; functions that need the value are off.
    #[default]
    Note,
    /// Reduced assist.
    Limp,
    /// No assist until the sensor is back and the rider engages again.
    Fault,
}

/// Declaration of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Whether the bicycle has the sensor. A sensor that is not fitted is never valid and never lost.
    pub fitted: bool,
    /// Largest valid magnitude, in the sensor's unit.
    pub max: f32,
    /// Largest valid change at once, as by an impact, in the sensor's unit.
    pub step: f32,
    /// Largest additional change per second, in the sensor's unit; `None` is unlimited.
    pub slope_per_s: Option<f32>,
    /// Timeout: oldest valid age of a held sample \[control periods\].
    pub timeout_ticks: u16,
    /// Time of equal samples while the measured quantity changes, at which the sensor is stuck \[control periods\]; 0
    /// is unlimited.
    pub stuck_ticks: u16,
    /// Consecutive good samples that qualify a sensor, at start-up and after its loss.
    pub qualify_samples: u16,
    /// Consequence of the sensor's loss.
    pub loss: Loss,
}

impl Default for Sensor {
    /// Not fitted. Otherwise: any finite value up to 1e6, only fresh samples.
    fn default() -> Self {
        Self {
            fitted: false,
            max: 1e6,
            step: 0.0,
            slope_per_s: None,
            timeout_ticks: 0,
            stuck_ticks: 0,
            qualify_samples: 1,
            loss: Loss::Note,
        }
    }
}

/// Names of [`Loss`], in its order.
pub const LOSSES: &[&str] = &["note", "limp", "fault"];

impl Sensor {
    /// A fitted sensor with range `max`, valid only while its samples are fresh.
    pub fn exact(max: f32) -> Self {
        Self { fitted: true, max, ..Self::default() }
    }

    /// Visits every parameter, in the sensor's `group`.
    pub fn visit_params<V: ParamVisitor>(&mut self, group: &'static str, to: &mut V) {
        to.switch(&ParamSpec::switch(group, "fitted"), &mut self.fitted);
        to.number(&ParamSpec::new(group, "max", 1e-3, 1e6), &mut self.max);
        to.number(&ParamSpec::new(group, "step", 0.0, 1e6), &mut self.step);
        to.optional_number(&ParamSpec::new(group, "slope_per_s", 1e-3, 1e6), &mut self.slope_per_s);
        to.count(&ParamSpec::new(group, "timeout_ticks", 0.0, 10_000.0), &mut self.timeout_ticks);
        to.count(&ParamSpec::new(group, "stuck_ticks", 0.0, 10_000.0), &mut self.stuck_ticks);
        to.count(&ParamSpec::new(group, "qualify_samples", 1.0, 10_000.0), &mut self.qualify_samples);
        let mut loss = self.loss as u8;
        to.choice(&ParamSpec::new(group, "loss", 0.0, 2.0), LOSSES, &mut loss);
        self.loss = match loss {
            0 => Loss::Note,
            1 => Loss::Limp,
            _ => Loss::Fault,
        };
    }
}

/// Causes of a sensor's rejection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorCauses {
    /// No valid sample within the timeout, and no other cause.
    pub lost: Cause,
    /// The newest sample is NaN or out of range.
    pub range: Cause,
    /// The newest sample is too far from the last good one.
    pub jump: Cause,
    /// The samples do not change while the measured quantity does.
    pub stuck: Cause,
}

impl SensorCauses {
    /// The set of all four.
    pub const fn set(&self) -> Causes {
        Causes::all(&[self.lost, self.range, self.jump, self.stuck])
    }
}

/// Constants derived from a sensor's declaration and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPlan {
    fitted: bool,
    max: f32,
    timeout_ticks: u16,
    /// [`STUCK`] if equal samples are allowed without limit.
    stuck_ticks: u16,
    qualify_samples: u16,
    /// Largest change from the last good sample, one control period after it, in the sensor's unit.
    first_change: f32,
    /// Increase of that change per period without a sample.
    change_per_period: f32,
    causes: SensorCauses,
}

impl SensorPlan {
    /// For one call every `period_s` seconds; rejections are reported as `causes`.
    pub fn new(sensor: &Sensor, causes: SensorCauses, period_s: f32) -> Self {
        let (first_change, change_per_period) = match sensor.slope_per_s {
            Some(slope) => (sensor.step + slope * period_s, slope * period_s),
            None => (f32::INFINITY, 0.0),
        };
        Self {
            fitted: sensor.fitted,
            max: sensor.max,
            timeout_ticks: sensor.timeout_ticks,
            stuck_ticks: if sensor.stuck_ticks == 0 { STUCK } else { sensor.stuck_ticks },
            qualify_samples: sensor.qualify_samples,
            first_change,
            change_per_period,
            causes,
        }
    }
}

/// State of the monitor of a sensor with `N` axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct SensorMonitor<const N: usize> {
    /// The last good sample.
    value: [f32; N],
    /// Largest accepted change of the next sample (infinite at first). Grows in each control period without a new
    /// sample; after a rejected sample it stays until a sample is good, so repeating a jump does not make it valid.
    max_change: f32,
    /// `max_change` while the short path applies: the sensor is valid and its newest sample is present and good; -1
    /// otherwise.
    short_path_change: f32,
    /// Age of the last good sample \[control periods\].
    age: u16,
    /// Age of the sample in the previous frame \[control periods\].
    reported_age: u16,
    /// Number of consecutive good samples.
    good_samples: u16,
    /// Control periods with motion since the samples last changed; [`STUCK`] if another check found the sensor stuck.
    unchanged_ticks: u16,
    /// Whether the sensor is valid.
    valid: bool,
    /// Cause for which the newest sample was rejected.
    reject_cause: Option<Cause>,
}

impl<const N: usize> Default for SensorMonitor<N> {
    fn default() -> Self {
        Self {
            value: [0.0; N],
            max_change: f32::INFINITY,
            short_path_change: -1.0,
            age: 0,
            reported_age: MISSING,
            good_samples: 0,
            unchanged_ticks: 0,
            valid: false,
            reject_cause: None,
        }
    }
}

/// Result of a sensor's monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckedSample<const N: usize> {
    /// Value and age \[control periods\], while the sensor is valid.
    pub value: Option<([f32; N], u16)>,
    /// Cause for which the sensor is not valid.
    pub lost: Option<Cause>,
}

impl<const N: usize> SensorMonitor<N> {
    /// Invalidates the sensor for a cause found by another check, until it requalifies. A `stuck` sensor requalifies
    /// only after its samples change.
    #[cold]
    pub fn invalidate(&mut self, cause: Cause, stuck: bool) {
        (self.reject_cause, self.good_samples, self.valid, self.short_path_change) =
            (Some(cause), 0, false, -1.0);
        if stuck {
            self.unchanged_ticks = STUCK;
        }
    }

    /// One control period. `moving` is true if other sensors show the measured quantity to change; it counts only in
    /// periods without a new good value.
    #[inline(always)]
    pub fn step(
        &mut self,
        plan: &SensorPlan,
        sample: ([f32; N], u16),
        moving: impl Fn() -> bool,
    ) -> CheckedSample<N> {
        let (value, age) = sample;
        // The common case: a good sample in this period.
        if age == 0 && in_range(plan, &value) && self.is_within(&value, self.short_path_change) {
            let mut passes = true;
            if !self.repeats(&value) {
                self.unchanged_ticks = 0;
            } else if moving() {
                cold_path();
                let unchanged_ticks = count_unchanged(self.unchanged_ticks, true);
                passes = !is_stuck(plan, unchanged_ticks);
                self.unchanged_ticks = if passes { unchanged_ticks } else { self.unchanged_ticks };
            }
            if passes {
                self.value = value;
                if self.age > 0 {
                    self.accept(plan, age);
                }
                return CheckedSample { value: Some((value, age)), lost: None };
            }
        }
        // The last good sample is held. A sensor whose newest sample is good is fitted.
        if self.short_path_change >= 0.0 && age == self.age.saturating_add(1) && age <= plan.timeout_ticks {
            (self.age, self.reported_age) = (age, age);
            self.max_change += plan.change_per_period;
            self.short_path_change = self.max_change;
            if moving() {
                self.unchanged_ticks = count_unchanged(self.unchanged_ticks, true);
                if is_stuck(plan, self.unchanged_ticks) {
                    self.short_path_change = -1.0;
                }
            }
            return CheckedSample { value: Some((self.value, age)), lost: None };
        }
        if !plan.fitted {
            return CheckedSample { value: None, lost: None };
        }
        self.check(plan, &{ value }, age, moving());
        if self.valid {
            CheckedSample { value: Some((self.value, self.age)), lost: None }
        } else {
            CheckedSample { value: None, lost: Some(self.reject_cause.unwrap_or(plan.causes.lost)) }
        }
    }

    /// The complete check.
    #[inline(never)]
    fn check(&mut self, plan: &SensorPlan, value: &[f32; N], age: u16, moving: bool) {
        // Another good sample of a sensor that is qualifying, as all are at start-up.
        if !self.valid && age == 0 && in_range(plan, value) && self.is_within(value, self.max_change) {
            let unchanged_ticks =
                if self.repeats(value) { count_unchanged(self.unchanged_ticks, moving) } else { 0 };
            if !is_stuck(plan, unchanged_ticks) {
                (self.value, self.unchanged_ticks, self.reject_cause) = (*value, unchanged_ticks, None);
                self.good_samples = self.good_samples.saturating_add(1);
                self.accept(plan, age);
                self.valid = self.good_samples >= plan.qualify_samples;
                self.short_path_change = if self.valid { self.max_change } else { -1.0 };
                return;
            }
        }
        let next_age = self.age.saturating_add(1);
        if age != self.reported_age.saturating_add(1) && age != MISSING {
            self.age = next_age;
            self.classify(plan, value, age, moving);
        } else {
            // After a rejected sample the accepted change does not grow.
            let rejected = self.valid && self.reject_cause.is_some();
            self.hold(if rejected { 0.0 } else { plan.change_per_period }, next_age, moving);
        }
        self.reported_age = age;
        if self.age > plan.timeout_ticks {
            self.valid = false;
            self.good_samples = 0;
        } else if self.good_samples >= plan.qualify_samples {
            self.valid = true;
        }
        self.short_path_change = -1.0;
        if self.valid && self.reject_cause.is_none() && age != MISSING {
            // A held sample can be stuck.
            if self.age == 0 || !is_stuck(plan, self.unchanged_ticks) {
                self.short_path_change = self.max_change;
            }
        }
    }

    /// Holds the last sample, now of this `age`; the accepted change grows by `change_per_period`.
    #[inline(always)]
    fn hold(&mut self, change_per_period: f32, age: u16, moving: bool) {
        self.age = age;
        self.unchanged_ticks = count_unchanged(self.unchanged_ticks, moving);
        self.max_change += change_per_period;
    }

    /// Accepts a good sample of this `age`.
    #[inline(always)]
    fn accept(&mut self, plan: &SensorPlan, age: u16) {
        (self.age, self.reported_age) = (age, age);
        self.max_change = plan.first_change;
        self.short_path_change = self.max_change;
    }

    /// Classifies a new sample.
    fn classify(&mut self, plan: &SensorPlan, value: &[f32; N], age: u16, moving: bool) {
        let jumps = !self.is_within(value, self.max_change);
        // An invalid sensor is not rejected for a jump from its old value.
        let rejection = if !in_range(plan, value) {
            Some(plan.causes.range)
        } else {
            Some(plan.causes.jump).filter(|_| jumps && self.valid)
        };
        if rejection.is_some() {
            self.unchanged_ticks = count_unchanged(self.unchanged_ticks, moving);
            (self.reject_cause, self.good_samples) = (rejection, 0);
            return;
        }
        (self.reject_cause, self.good_samples) = (None, self.good_samples.saturating_add(1));
        if jumps {
            (self.reject_cause, self.good_samples) = (Some(plan.causes.jump), 0);
        }
        self.unchanged_ticks = self.unchanged_with(value, || moving);
        if is_stuck(plan, self.unchanged_ticks) {
            (self.reject_cause, self.good_samples, self.valid) = (Some(plan.causes.stuck), 0, false);
        }
        self.value = *value;
        self.accept(plan, age);
    }

    /// Whether every axis is within `max_change` of the last good sample.
    #[inline(always)]
    fn is_within(&self, value: &[f32; N], max_change: f32) -> bool {
        value.iter().zip(&self.value).all(|(a, b)| (a - b).abs() <= max_change)
    }

    /// Count of unchanged periods after this sample \[control periods\].
    #[inline(always)]
    fn unchanged_with(&self, value: &[f32; N], moving: impl Fn() -> bool) -> u16 {
        if !self.repeats(value) { 0 } else { count_unchanged(self.unchanged_ticks, moving()) }
    }

    /// Whether this sample equals the last good one.
    #[inline(always)]
    fn repeats(&self, value: &[f32; N]) -> bool {
        value.iter().zip(&self.value).all(|(a, b)| a == b)
    }
}

/// Count of a sensor that another check found stuck; counting never reaches it.
const STUCK: u16 = u16::MAX;

/// The count of unchanged periods, one period later.
#[inline(always)]
fn count_unchanged(unchanged_ticks: u16, moving: bool) -> u16 {
    if unchanged_ticks < STUCK - 1 { unchanged_ticks + u16::from(moving) } else { unchanged_ticks }
}

/// Whether the count of unchanged periods has reached the declared limit.
#[inline(always)]
fn is_stuck(plan: &SensorPlan, unchanged_ticks: u16) -> bool {
    unchanged_ticks >= plan.stuck_ticks
}

/// Whether a sample is in range. NaN compares false and is out of range.
#[inline(always)]
fn in_range<const N: usize>(plan: &SensorPlan, value: &[f32; N]) -> bool {
    value.iter().all(|x| x.abs() <= plan.max)
}
