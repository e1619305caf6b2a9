//! Every parameter as one number: listing, getting, setting and storing are the same walk over them.

use crate::key::Key;
use control::law::LAW_NAMES;
use control::param::{ParamSpec, ParamVisitor};
use control::{Config, Law};

/// The law by its name. A law that needs more than its name is set as a whole; see [`crate::law`].
pub const LAW: ParamSpec = ParamSpec::new("", "law", 0.0, (LAW_NAMES.len() - 1) as f32);
const CL2: ParamSpec = ParamSpec::new("law", "cl2.k", 1e-3, 20.0);
const BALANCE: ParamSpec = ParamSpec::new("law", "balance-assist.kappa", 1e-3, 20.0);

/// What a parameter's number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// A number.
    Number = 0,
    /// A number that may be off.
    Limit = 1,
    /// A whole number.
    Count = 2,
    /// 0 is off, 1 is on.
    Switch = 3,
    /// The place of a name among [`ParameterView::names`].
    Choice = 4,
}

impl Kind {
    /// The kind of a number on the wire.
    pub const fn numbered(number: u8) -> Option<Self> {
        Some(match number {
            0 => Kind::Number,
            1 => Kind::Limit,
            2 => Kind::Count,
            3 => Kind::Switch,
            4 => Kind::Choice,
            _ => return None,
        })
    }
}

/// A parameter as the walk shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterView {
    /// Name and range.
    pub leaf: ParamSpec,
    /// What its number means.
    pub kind: Kind,
    /// The names of a choice; empty for all others.
    pub names: &'static [&'static str],
    /// Its value; `None` for a limit that is off.
    pub value: Option<f32>,
}

impl ParameterView {
    /// Its key.
    pub fn key(&self) -> Key<'static> {
        Key::of(&self.leaf)
    }
}

/// Shows every parameter to `to`, the law first, and gives each the value that `to` returns.
///
/// What can't be that value (off, for what is no limit) leaves it as it was. A value inside a group
/// that is off is forgotten with the group.
pub fn each(config: &mut Config, mut to: impl FnMut(&ParameterView) -> Option<f32>) {
    law(&mut config.law, &mut Walk(&mut to));
    walk(config, &mut to);
}

/// As [`each`], but not the law's.
pub fn each_but_law(config: &mut Config, mut to: impl FnMut(&ParameterView) -> Option<f32>) {
    walk(config, &mut to);
}

/// One copy in the image for whatever is done with the parameters: there are many of them.
#[inline(never)]
fn walk(config: &mut Config, to: Each<'_>) {
    config.visit_params(&mut Walk(to));
}

/// The parameter of a key; `None` if there is none.
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

fn law(law: &mut Law, to: &mut Walk<'_>) {
    let (mut number, mut slope) = (law.number(), law.slope());
    to.choice(&LAW, LAW_NAMES, &mut number);
    match law {
        Law::Cl2 { .. } => to.number(&CL2, &mut slope),
        Law::BalanceAssist { .. } => to.number(&BALANCE, &mut slope),
        _ => {}
    }
    let table = match law {
        Law::Table(table) => core::mem::take(table),
        _ => Default::default(),
    };
    *law = Law::numbered(number, slope, table).unwrap_or_default();
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
