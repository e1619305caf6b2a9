//! Visits every parameter as one number; listing, reading, setting and storing use the same visitor.

use crate::key::Key;
use control::Config;
use control::param::{ParamSpec, ParamVisitor};

control::numbered! {
    /// Meaning of a parameter's number.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Kind {
        /// A number.
        Number = 0,
        /// A number that can be off.
        Limit = 1,
        /// An integer.
        Count = 2,
        /// 0 is off, 1 is on.
        Switch = 3,
        /// Index of a name in [`ParameterView::names`].
        Choice = 4,
    }
}

/// A parameter as the visitor receives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterView {
    /// Name and range.
    pub leaf: ParamSpec,
    /// Meaning of its number.
    pub kind: Kind,
    /// Names of a choice; empty for other kinds.
    pub names: &'static [&'static str],
    /// Value; `None` for a limit that is off.
    pub value: Option<f32>,
}

impl ParameterView {
    /// Key of the parameter.
    pub fn key(&self) -> Key<'static> {
        Key::of(&self.leaf)
    }
}

/// Calls `to` with every parameter, the law first, and sets each to the returned value.
///
/// A value that the parameter can't have (off, if it is not a limit) leaves it unchanged. A value inside a group that
/// is off is lost with the group. A law that needs more than a name is set as a whole; see [`crate::law`].
pub fn each(config: &mut Config, mut to: impl FnMut(&ParameterView) -> Option<f32>) {
    config.law.visit_params(&mut Walk(&mut to));
    walk(config, &mut to);
}

/// As [`each`], without the law.
pub fn each_but_law(config: &mut Config, mut to: impl FnMut(&ParameterView) -> Option<f32>) {
    walk(config, &mut to);
}

/// Not inlined, as the generated code is large: one copy in the image.
#[inline(never)]
fn walk(config: &mut Config, to: Each<'_>) {
    config.visit_params(&mut Walk(to));
}

/// Parameter by its key; `None` if unknown.
pub fn get(config: &Config, key: Key<'_>) -> Option<ParameterView> {
    let mut found = None;
    each(&mut config.clone(), |view| {
        if view.key() == key {
            found = Some(*view);
        }
        view.value
    });
    found
}

type Each<'a> = &'a mut dyn FnMut(&ParameterView) -> Option<f32>;

struct Walk<'a>(Each<'a>);

impl Walk<'_> {
    fn show(&mut self, leaf: &ParamSpec, kind: Kind, value: Option<f32>) -> Option<f32> {
        (self.0)(&ParameterView { leaf: *leaf, kind, names: &[], value })
    }
}

impl ParamVisitor for Walk<'_> {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        if let Some(x) = self.show(leaf, Kind::Number, Some(*value)) {
            *value = x;
        }
    }
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>) {
        *value = self.show(leaf, Kind::Limit, *value);
    }
    fn count(&mut self, leaf: &ParamSpec, value: &mut u16) {
        if let Some(x) = self.show(leaf, Kind::Count, Some(f32::from(*value))) {
            *value = x as u16;
        }
    }
    fn switch(&mut self, leaf: &ParamSpec, value: &mut bool) {
        if let Some(x) = self.show(leaf, Kind::Switch, Some(f32::from(u8::from(*value)))) {
            *value = x == 1.0;
        }
    }
    fn choice(&mut self, leaf: &ParamSpec, names: &'static [&'static str], value: &mut u8) {
        let value_now = Some(f32::from(*value));
        let view = ParameterView { leaf: *leaf, kind: Kind::Choice, names, value: value_now };
        if let Some(x) = (self.0)(&view) {
            *value = x as u8;
        }
    }
}
