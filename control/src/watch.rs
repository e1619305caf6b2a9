//! One declared sensor, watched: late, out of range, jumping or stuck samples are not believed, the
//! last good one is held until the sensor counts as lost, and a lost sensor must prove itself anew.

use crate::fault::{Cause, Causes};
use crate::frame::MISSING;
use crate::param::{Leaf, Visit};
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
    /// Time for which new samples may be equal to the bit while what they measure moves
    /// \[control periods\]; 0 is for ever.
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
    pub fn leaves<V: Visit>(&mut self, group: &'static str, to: &mut V) {
        to.switch(&Leaf::switch(group, "fitted"), &mut self.fitted);
        to.number(&Leaf::new(group, "max", 1e-3, 1e6), &mut self.max);
        to.number(&Leaf::new(group, "step", 0.0, 1e6), &mut self.step);
        to.limit(&Leaf::new(group, "slope_per_s", 1e-3, 1e6), &mut self.slope_per_s);
        to.count(&Leaf::new(group, "timeout_ticks", 0.0, 10_000.0), &mut self.timeout_ticks);
        to.count(&Leaf::new(group, "stuck_ticks", 0.0, 10_000.0), &mut self.stuck_ticks);
        to.count(&Leaf::new(group, "qualify_samples", 1.0, 10_000.0), &mut self.qualify_samples);
        let mut loss = self.loss as u8;
        to.choice(&Leaf::new(group, "loss", 0.0, 2.0), LOSSES, &mut loss);
        self.loss = match loss {
            0 => Loss::Note,
            1 => Loss::Limp,
            _ => Loss::Fault,
        };
    }
}

/// What is wrong with a sensor, as its four codes.
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

/// What is remembered of a sensor with `N` axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch<const N: usize> {
    /// The last good sample.
    value: [f32; N],
    /// Its age \[control periods\].
    age: u16,
    /// The age that the frame gave for its sample.
    told_age: u16,
    /// Good samples in a row.
    good: u16,
    /// Control periods without any sample since the last good one.
    gap: u16,
    /// Control periods in which something moved since the last sample, ...
    moved: u16,
    /// ... and in which the samples stood still meanwhile.
    still: u16,
    /// Whether it is believed.
    trusted: bool,
    /// Change up to which a fresh sample is as good as the last one; -1 unless that was fresh, believed, and not one of
    /// several that stood still.
    near: f32,
    /// Why the newest sample was not good.
    doubt: Option<Cause>,
}

impl<const N: usize> Default for Watch<N> {
    fn default() -> Self {
        Self {
            value: [0.0; N],
            age: MISSING,
            told_age: MISSING,
            good: 0,
            gap: 0,
            moved: 0,
            still: 0,
            trusted: false,
            near: -1.0,
            doubt: None,
        }
    }
}

/// What a sensor's watch says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told<const N: usize> {
    /// The value and its age, while the sensor is believed.
    pub value: Option<([f32; N], u16)>,
    /// Why it is not.
    pub lost: Option<Cause>,
}

impl<const N: usize> Watch<N> {
    /// One control period: the frame's sample, and whether what it measures `moves` by what other
    /// sensors say.
    #[inline(always)]
    pub fn step(
        &mut self,
        sensor: &Sensor,
        codes: &Codes,
        period_s: f32,
        sample: ([f32; N], u16),
        moves: bool,
    ) -> Told<N> {
        let (value, age) = sample;
        // As nearly always: one good sample after the other.
        if age == 0 && inside(sensor, &value) && self.near(&value) && !self.stands(&value, moves) {
            self.value = value;
            return Told { value: Some((value, 0)), lost: None };
        }
        if !sensor.fitted {
            return Told { value: None, lost: None };
        }
        self.judge(sensor, codes, period_s, &{ value }, age, moves);
        if self.trusted {
            Told { value: Some((self.value, self.age)), lost: None }
        } else {
            Told { value: None, lost: Some(self.doubt.unwrap_or(codes.lost)) }
        }
    }

    /// The long way.
    #[inline(never)]
    fn judge(
        &mut self,
        sensor: &Sensor,
        codes: &Codes,
        period_s: f32,
        value: &[f32; N],
        age: u16,
        moves: bool,
    ) {
        self.age = self.age.saturating_add(1);
        self.moved = self.moved.saturating_add(u16::from(moves));
        if age != self.told_age.saturating_add(1) && age != MISSING {
            self.take(sensor, codes, period_s, value, age);
        } else {
            self.gap = self.gap.saturating_add(1);
        }
        self.told_age = age;
        let stuck = sensor.stuck_ticks > 0 && self.still >= sensor.stuck_ticks;
        if stuck {
            self.doubt = Some(codes.stuck);
        }
        if stuck || self.age > sensor.timeout_ticks {
            self.trusted = false;
            self.good = 0;
        } else if self.good >= sensor.qualify_samples {
            self.trusted = true;
        }
        let steady = self.trusted && self.age == 0 && self.still == 0;
        self.near = if steady { most_change(sensor, period_s, 1.0) } else { -1.0 };
    }

    /// A new sample.
    fn take(&mut self, sensor: &Sensor, codes: &Codes, period_s: f32, value: &[f32; N], age: u16) {
        if !inside(sensor, value) {
            self.doubt = Some(codes.range);
            self.good = 0;
            return;
        }
        // Samples that were refused give a jump no more time.
        let between = f32::from(self.gap.saturating_add(1));
        let most = most_change(sensor, period_s, between);
        let change = |(a, b): (&f32, &f32)| (a - b).abs();
        let jumps =
            self.age != MISSING && value.iter().zip(&self.value).map(change).any(|moved| moved > most);
        if jumps && self.trusted {
            self.doubt = Some(codes.jump);
            self.good = 0;
            return;
        }
        // One that is not trusted is judged by what it says from now on.
        if jumps {
            self.doubt = Some(codes.jump);
            self.good = 0;
        } else {
            self.doubt = None;
            self.good = self.good.saturating_add(1);
        }
        self.still = if self.repeats(value) { self.still.saturating_add(self.moved) } else { 0 };
        self.moved = 0;
        self.gap = 0;
        self.value = *value;
        self.age = age;
    }

    /// Whether no axis is further from the last good sample than [`Watch::near`].
    #[inline(always)]
    fn near(&self, value: &[f32; N]) -> bool {
        value.iter().zip(&self.value).all(|(a, b)| (a - b).abs() <= self.near)
    }

    /// Whether a sample is the last good one again although something `moves`.
    #[inline(always)]
    fn stands(&self, value: &[f32; N], moves: bool) -> bool {
        if *value == self.value {
            cold_path();
            moves
        } else {
            false
        }
    }

    /// Whether a sample is the last good one in every bit.
    #[inline(always)]
    fn repeats(&self, value: &[f32; N]) -> bool {
        value.iter().zip(&self.value).all(|(a, b)| a.to_bits() == b.to_bits())
    }
}

/// The largest believable change in so many control periods; infinite where any is.
fn most_change(sensor: &Sensor, period_s: f32, periods: f32) -> f32 {
    sensor.slope_per_s.map_or(f32::INFINITY, |slope| sensor.step + slope * period_s * periods)
}

/// Whether a sample is in range; written so that NaN, which compares false, is not.
#[inline(always)]
fn inside<const N: usize>(sensor: &Sensor, value: &[f32; N]) -> bool {
    value.iter().all(|x| x.abs() <= sensor.max)
}
