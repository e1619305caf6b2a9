//! One declared sensor, watched: late, out of range, jumping or stuck samples are not believed, the
//! last good one is held until the sensor counts as lost, and a lost sensor must prove itself anew.

use crate::fault::{Cause, Causes};
use crate::param::{ParamSpec, ParamVisitor};
use crate::sensors::frame::MISSING;
use core::hint::cold_path;

/// What the loss of a sensor means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loss {
    /// It is reported; who needs the value goes without.
    #[default]
    Note,
    /// Reduced assist.
    Limp,
    /// No assist until the sensor is back and the rider asks anew.
    Fault,
}

/// A sensor as declared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Whether the bicycle has it. What is not fitted is never believed and never lost.
    pub fitted: bool,
    /// Largest believable value, either way, in the sensor's unit.
    pub max: f32,
    /// Largest believable change at once, as by a blow, in the sensor's unit.
    pub step: f32,
    /// Largest believable change per second beyond it, in the sensor's unit; `None` is any.
    pub slope_per_s: Option<f32>,
    /// Age at which a held sample is too old \[control periods\].
    pub timeout_ticks: u16,
    /// Time for which new samples may be equal while what they measure moves \[control periods\]; 0 is for ever.
    pub stuck_ticks: u16,
    /// Good samples in a row after which a lost sensor, or one just started, is believed.
    pub qualify_samples: u16,
    /// What its loss means.
    pub loss: Loss,
}

impl Default for Sensor {
    /// Not fitted; if it were: any finite value up to 1e6, only fresh samples.
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
    /// A fitted sensor of which only fresh samples up to `max` are believed.
    pub fn exact(max: f32) -> Self {
        Self { fitted: true, max, ..Self::default() }
    }

    /// Shows every parameter, in the group of the sensor's name.
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

/// What is wrong with a sensor, as its four plan.codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Codes {
    /// No believable sample in time, and nothing else known.
    pub lost: Cause,
    /// The newest sample is NaN or out of range.
    pub range: Cause,
    /// The newest sample is too far from the last good one.
    pub jump: Cause,
    /// The samples stand still while what they measure moves.
    pub stuck: Cause,
}

impl Codes {
    /// All four.
    pub const fn set(&self) -> Causes {
        Causes::all(&[self.lost, self.range, self.jump, self.stuck])
    }
}

/// What follows from a sensor's declaration and the rate of calls alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorPlan {
    fitted: bool,
    max: f32,
    timeout_ticks: u16,
    /// [`STUCK`] if its samples may stand still for ever.
    stuck_ticks: u16,
    qualify_samples: u16,
    /// How far a sample may be from the last good one in the control period after that one, in the sensor's unit.
    fresh: f32,
    /// Further by each period without any sample.
    growth: f32,
    codes: Codes,
}

impl SensorPlan {
    /// For one call every `period_s`, told by these plan.codes.
    pub fn new(sensor: &Sensor, codes: Codes, period_s: f32) -> Self {
        let (fresh, growth) = match sensor.slope_per_s {
            Some(slope) => (sensor.step + slope * period_s, slope * period_s),
            None => (f32::INFINITY, 0.0),
        };
        Self {
            fitted: sensor.fitted,
            max: sensor.max,
            timeout_ticks: sensor.timeout_ticks,
            stuck_ticks: if sensor.stuck_ticks == 0 { STUCK } else { sensor.stuck_ticks },
            qualify_samples: sensor.qualify_samples,
            fresh,
            growth,
            codes,
        }
    }
}

/// What is remembered of a sensor with `N` axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorMonitor<const N: usize> {
    /// The last good sample.
    value: [f32; N],
    /// Change up to which the next one is believed, any at first. It grows with each control period without a new sample; from
    /// a refused one on it does not, until a sample is good again: a jump that stays gets no more time by being repeated.
    most: f32,
    /// The same while the short way will do, the sensor being believed and its newest sample there and good; -1 otherwise.
    near: f32,
    /// Age of the last good sample \[control periods\].
    age: u16,
    /// The age that the frame gave for its sample.
    reported_age: u16,
    /// Good samples in a row.
    good: u16,
    /// Control periods in which something moved since the samples changed; [`STUCK`] if that was found in another way.
    still: u16,
    /// Whether it is believed.
    trusted: bool,
    /// Why the newest sample was not good.
    reject_cause: Option<Cause>,
}

impl<const N: usize> Default for SensorMonitor<N> {
    fn default() -> Self {
        Self {
            value: [0.0; N],
            most: f32::INFINITY,
            near: -1.0,
            age: 0,
            reported_age: MISSING,
            good: 0,
            still: 0,
            trusted: false,
            reject_cause: None,
        }
    }
}

/// What a sensor's watch says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckedSample<const N: usize> {
    /// The value and its age, while the sensor is believed.
    pub value: Option<([f32; N], u16)>,
    /// Why it is not.
    pub lost: Option<Cause>,
}

impl<const N: usize> SensorMonitor<N> {
    /// The sensor is not believed any more for this reason, found elsewhere, until it qualifies anew; where its samples stand
    /// still, not before they change.
    #[cold]
    pub fn invalidate(&mut self, cause: Cause, stuck: bool) {
        (self.reject_cause, self.good, self.trusted, self.near) = (Some(cause), 0, false, -1.0);
        if stuck {
            self.still = STUCK;
        }
    }

    /// One control period: the frame's sample, and whether what it measures `moves` by what other
    /// sensors say, which only counts when no new value comes.
    #[inline(always)]
    pub fn step(
        &mut self,
        plan: &SensorPlan,
        sample: ([f32; N], u16),
        moves: impl Fn() -> bool,
    ) -> CheckedSample<N> {
        let (value, age) = sample;
        // As nearly always: a good sample in this very period.
        if age == 0 && inside(plan, &value) && self.near(&value, self.near) {
            let mut passes = true;
            if !self.repeats(&value) {
                self.still = 0;
            } else if moves() {
                cold_path();
                let still = longer(self.still, true);
                passes = !stuck(plan, still);
                self.still = if passes { still } else { self.still };
            }
            if passes {
                self.value = value;
                if self.age > 0 {
                    self.renew(plan, age);
                }
                return CheckedSample { value: Some((value, age)), lost: None };
            }
        }
        // The last good one still. One of which the newest sample is good is fitted.
        if self.near >= 0.0 && age == self.age.saturating_add(1) && age <= plan.timeout_ticks {
            (self.age, self.reported_age) = (age, age);
            self.most += plan.growth;
            self.near = self.most;
            if moves() {
                self.still = longer(self.still, true);
                if stuck(plan, self.still) {
                    self.near = -1.0;
                }
            }
            return CheckedSample { value: Some((self.value, age)), lost: None };
        }
        if !plan.fitted {
            return CheckedSample { value: None, lost: None };
        }
        self.check(plan, &{ value }, age, moves());
        if self.trusted {
            CheckedSample { value: Some((self.value, self.age)), lost: None }
        } else {
            CheckedSample { value: None, lost: Some(self.reject_cause.unwrap_or(plan.codes.lost)) }
        }
    }

    /// The long way.
    #[inline(never)]
    fn check(&mut self, plan: &SensorPlan, value: &[f32; N], age: u16, moves: bool) {
        // One good sample more of a sensor that is to qualify, as of all of them at the start.
        if !self.trusted && age == 0 && inside(plan, value) && self.near(value, self.most) {
            let still = if self.repeats(value) { longer(self.still, moves) } else { 0 };
            if !stuck(plan, still) {
                (self.value, self.still, self.reject_cause) = (*value, still, None);
                self.good = self.good.saturating_add(1);
                self.renew(plan, age);
                self.trusted = self.good >= plan.qualify_samples;
                self.near = if self.trusted { self.most } else { -1.0 };
                return;
            }
        }
        let older = self.age.saturating_add(1);
        if age != self.reported_age.saturating_add(1) && age != MISSING {
            self.age = older;
            self.take(plan, value, age, moves);
        } else {
            // The newest sample was refused.
            let refused = self.trusted && self.reject_cause.is_some();
            self.hold(if refused { 0.0 } else { plan.growth }, older, moves);
        }
        self.reported_age = age;
        if self.age > plan.timeout_ticks {
            self.trusted = false;
            self.good = 0;
        } else if self.good >= plan.qualify_samples {
            self.trusted = true;
        }
        self.near = -1.0;
        if self.trusted && self.reject_cause.is_none() && age != MISSING {
            // What is held may be stuck.
            if self.age == 0 || !stuck(plan, self.still) {
                self.near = self.most;
            }
        }
    }

    /// No new sample: the last one is of this age now, and the next may be further from it by `growth`.
    #[inline(always)]
    fn hold(&mut self, growth: f32, age: u16, moves: bool) {
        self.age = age;
        self.still = longer(self.still, moves);
        self.most += growth;
    }

    /// A good sample of this age.
    #[inline(always)]
    fn renew(&mut self, plan: &SensorPlan, age: u16) {
        (self.age, self.reported_age) = (age, age);
        self.most = plan.fresh;
        self.near = self.most;
    }

    /// A new sample.
    fn take(&mut self, plan: &SensorPlan, value: &[f32; N], age: u16, moves: bool) {
        let jumps = !self.near(value, self.most);
        // One that is not trusted is judged by what it says from now on.
        let refused = if !inside(plan, value) {
            Some(plan.codes.range)
        } else {
            Some(plan.codes.jump).filter(|_| jumps && self.trusted)
        };
        if refused.is_some() {
            self.still = longer(self.still, moves);
            (self.reject_cause, self.good) = (refused, 0);
            return;
        }
        (self.reject_cause, self.good) = (None, self.good.saturating_add(1));
        if jumps {
            (self.reject_cause, self.good) = (Some(plan.codes.jump), 0);
        }
        self.still = self.still(value, || moves);
        if stuck(plan, self.still) {
            (self.reject_cause, self.good, self.trusted) = (Some(plan.codes.stuck), 0, false);
        }
        self.value = *value;
        self.renew(plan, age);
    }

    /// Whether no axis is further than this from the last good sample.
    #[inline(always)]
    fn near(&self, value: &[f32; N], most: f32) -> bool {
        value.iter().zip(&self.value).all(|(a, b)| (a - b).abs() <= most)
    }

    /// For how long something has moved with a sample that may be the last good one again.
    #[inline(always)]
    fn still(&self, value: &[f32; N], moves: impl Fn() -> bool) -> u16 {
        if !self.repeats(value) { 0 } else { longer(self.still, moves()) }
    }

    /// Whether this is the last good sample again.
    #[inline(always)]
    fn repeats(&self, value: &[f32; N]) -> bool {
        value.iter().zip(&self.value).all(|(a, b)| a == b)
    }
}

/// In place of the time for which samples have stood still: for too long.
const STUCK: u16 = u16::MAX;

/// The time for which samples have stood still, a period later.
#[inline(always)]
fn longer(still: u16, moves: bool) -> u16 {
    if still < STUCK - 1 { still + u16::from(moves) } else { still }
}

/// Whether samples have stood still for too long.
#[inline(always)]
fn stuck(plan: &SensorPlan, still: u16) -> bool {
    still >= plan.stuck_ticks
}

/// Whether a sample is in range; written so that NaN, which compares false, is not.
#[inline(always)]
fn inside<const N: usize>(plan: &SensorPlan, value: &[f32; N]) -> bool {
    value.iter().all(|x| x.abs() <= plan.max)
}
