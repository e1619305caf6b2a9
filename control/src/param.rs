//! Declaration of parameters: name, unit and range of each, once, beside the field that holds it.
//!
//! A group of parameters is a struct with a `visit_params` function that passes each of its fields to a visitor.
//! Checking, encoding, listing, getting and setting are visitors, so none of them can omit a parameter.

use core::fmt;

/// Name and range of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamSpec {
    /// Group, dotted: `limits.end_stop`.
    pub group: &'static str,
    /// Name within the group, unit included: `soft_rad`.
    pub name: &'static str,
    /// Smallest allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

impl ParamSpec {
    /// A number or a count, `min..=max`.
    pub const fn new(group: &'static str, name: &'static str, min: f32, max: f32) -> Self {
        Self { group, name, min, max }
    }

    /// A switch: on (1) or off (0).
    pub const fn switch(group: &'static str, name: &'static str) -> Self {
        Self::new(group, name, 0.0, 1.0)
    }

    /// The error of a `value` outside the range.
    pub const fn error(&self, value: f32) -> ParamError {
        ParamError { leaf: *self, value }
    }

    /// Accepts a `value` inside the range; NaN is outside.
    ///
    /// # Errors
    /// The parameter, its value and the range.
    pub fn check(&self, value: f32) -> Result<(), ParamError> {
        if value >= self.min && value <= self.max { Ok(()) } else { Err(self.error(value)) }
    }
}

/// Error: a parameter outside its range. `value` can be NaN or infinite, as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamError {
    /// The parameter.
    pub leaf: ParamSpec,
    /// The value given.
    pub value: f32,
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ParamSpec { group, name, min, max } = self.leaf;
        let dot = if group.is_empty() { "" } else { "." };
        if self.value == f32::INFINITY && (group, name) == ("limits", "max_torque_nm") {
            return write!(
                f,
                "{group}.{name} = none, but limits.rider_torque is on and needs it: {min} to {max}"
            );
        }
        if self.value == 0.0 && (group, name) == ("input", "wheel") {
            return write!(
                f,
                "{group}.{name} = front, but input.front_wheel.fitted is off, and without input.steer its speed cannot be computed from the rear wheel's: rear"
            );
        }
        write!(f, "{group}{dot}{name} = {} is outside {min} to {max}", self.value)
    }
}

impl core::error::Error for ParamError {}

/// A function over all parameters, in the order of their declaration.
pub trait ParamVisitor {
    /// A number.
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32);
    /// A number that can be off.
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>);
    /// A whole number.
    fn count(&mut self, leaf: &ParamSpec, value: &mut u16);
    /// A switch.
    fn switch(&mut self, leaf: &ParamSpec, value: &mut bool);
    /// One of `names`, given by its index.
    fn choice(&mut self, leaf: &ParamSpec, names: &'static [&'static str], value: &mut u8);
}

/// Visits a group that can be off: first the switch, then the group's parameters by `inside`.
pub fn optional<T: Default, V: ParamVisitor>(
    to: &mut V,
    leaf: &ParamSpec,
    value: &mut Option<T>,
    inside: impl FnOnce(&mut T, &mut V),
) {
    let mut on = value.is_some();
    let mut group = value.take().unwrap_or_default();
    to.switch(leaf, &mut on);
    inside(&mut group, to);
    *value = on.then_some(group);
}

/// A visitor that finds the first parameter outside its range.
#[derive(Clone, Copy, Debug, Default)]
pub struct Checker(Option<ParamError>);

impl Checker {
    /// The result of the check.
    ///
    /// # Errors
    /// The first parameter outside its range.
    pub fn verdict(self) -> Result<(), ParamError> {
        self.0.map_or(Ok(()), Err)
    }

    /// Adds a result; the first error is kept.
    pub fn note(&mut self, result: Result<(), ParamError>) {
        if self.0.is_none() {
            self.0 = result.err();
        }
    }
}

impl ParamVisitor for Checker {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        self.note(leaf.check(*value));
    }
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>) {
        if let Some(value) = value {
            self.note(leaf.check(*value));
        }
    }
    fn count(&mut self, leaf: &ParamSpec, value: &mut u16) {
        self.note(leaf.check(f32::from(*value)));
    }
    fn switch(&mut self, _: &ParamSpec, _: &mut bool) {}
    fn choice(&mut self, leaf: &ParamSpec, _: &'static [&'static str], value: &mut u8) {
        self.note(leaf.check(f32::from(*value)));
    }
}
