//! The control crate's parameter table as FMI parameters, and back.
//!
//! A number that can be off has a switch beside it, `NAME_on`.

use crate::variable::{Kind, Role, Variable};
use control::law::{LAW_NAMES, LAWS};
use control::param::{ParamSpec, ParamVisitor};
use control::{Config, Law};
use link::key::Key;

/// The control rate is the time step of the FMU: a constant.
pub(crate) const RATE: &str = "rate_hz";

/// Every parameter except the law's, with the values of `config`; a number that is off has the flashed value.
pub(crate) fn declared(config: &Config) -> Vec<Variable> {
    let mut flashed = Numbers::default();
    Config::product().visit_params(&mut flashed);
    let mut declarer = Declarer { flashed: flashed.0.into_iter(), variables: Vec::new() };
    config.clone().visit_params(&mut declarer);
    declarer.variables
}

/// Sets every parameter except the law's, from values in the order of [`declared`].
pub(crate) fn set(config: &mut Config, values: &[f64]) {
    let rate_hz = config.rate_hz;
    config.visit_params(&mut Setter(values.iter()));
    config.rate_hz = rate_hz;
}

/// The nearest number with the fewest digits: 0.1 for the f32 that is nearest to 0.1.
pub(crate) fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

fn variable(leaf: &ParamSpec, kind: Kind, start: f64) -> Variable {
    let key = Key::of(leaf);
    let unit = if kind == Kind::Real { key.unit() } else { "" };
    Variable { kind, ..Variable::real(Role::Parameter, &key.to_string(), unit, "") }.starting(start)
}

fn ranged(leaf: &ParamSpec, kind: Kind, start: f64) -> Variable {
    variable(leaf, kind, start).within(decimal(leaf.min), decimal(leaf.max))
}

/// Values of the optional numbers.
#[derive(Default)]
struct Numbers(Vec<Option<f32>>);

impl ParamVisitor for Numbers {
    fn number(&mut self, _: &ParamSpec, _: &mut f32) {}
    fn optional_number(&mut self, _: &ParamSpec, value: &mut Option<f32>) {
        self.0.push(*value);
    }
    fn count(&mut self, _: &ParamSpec, _: &mut u16) {}
    fn switch(&mut self, _: &ParamSpec, _: &mut bool) {}
    fn choice(&mut self, _: &ParamSpec, _: &'static [&'static str], _: &mut u8) {}
}

struct Declarer {
    flashed: std::vec::IntoIter<Option<f32>>,
    variables: Vec<Variable>,
}

impl ParamVisitor for Declarer {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        let declared = ranged(leaf, Kind::Real, decimal(*value));
        let role = if declared.name == RATE { Role::Constant } else { Role::Parameter };
        self.variables.push(Variable { role, ..declared });
    }
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>) {
        let number = value.or(self.flashed.next().flatten()).unwrap_or(leaf.min);
        let number = ranged(leaf, Kind::Real, decimal(number));
        let on = Variable {
            name: format!("{}_on", number.name),
            about: format!("whether {} acts", number.name),
            ..variable(leaf, Kind::Boolean, f64::from(u8::from(value.is_some())))
        };
        self.variables.extend([on, number]);
    }
    fn count(&mut self, leaf: &ParamSpec, value: &mut u16) {
        self.variables.push(ranged(leaf, Kind::Integer, f64::from(*value)));
    }
    fn switch(&mut self, leaf: &ParamSpec, value: &mut bool) {
        self.variables.push(variable(leaf, Kind::Boolean, f64::from(u8::from(*value))));
    }
    fn choice(&mut self, leaf: &ParamSpec, names: &'static [&'static str], value: &mut u8) {
        self.variables.push(variable(leaf, Kind::Choice(names), f64::from(*value)));
    }
}

/// Takes the values in order; the rate is not among them.
struct Setter<'a>(std::slice::Iter<'a, f64>);

impl Setter<'_> {
    fn next(&mut self) -> f64 {
        self.0.next().copied().unwrap_or(f64::NAN)
    }
}

impl ParamVisitor for Setter<'_> {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        if Key::of(leaf).to_string() != RATE {
            *value = self.next() as f32;
        }
    }
    fn optional_number(&mut self, _: &ParamSpec, value: &mut Option<f32>) {
        let (on, number) = (self.next() == 1.0, self.next() as f32);
        *value = on.then_some(number);
    }
    fn count(&mut self, _: &ParamSpec, value: &mut u16) {
        *value = self.next() as u16;
    }
    fn switch(&mut self, _: &ParamSpec, value: &mut bool) {
        *value = self.next() == 1.0;
    }
    fn choice(&mut self, _: &ParamSpec, _: &'static [&'static str], value: &mut u8) {
        *value = self.next() as u8;
    }
}

/// The law and the slope of a law with one.
pub(crate) fn law_variables(law: &Law) -> [Variable; 2] {
    let slope = if law.slope() > 0.0 { law.slope() } else { 4.0 };
    let sloped = || LAWS.iter().filter_map(|spec| Some((spec.name, spec.parameter?)));
    let names: Vec<&str> = sloped().map(|(name, _)| name).collect();
    let least = sloped().map(|(_, slope)| slope.min).fold(f32::INFINITY, f32::min);
    let most = sloped().map(|(_, slope)| slope.max).fold(f32::NEG_INFINITY, f32::max);
    [
        Variable::of_kind(
            Kind::Choice(LAW_NAMES),
            Role::Parameter,
            "law",
            "roll-rate law; table: the points of the export",
        )
        .starting(f64::from(law.number())),
        Variable::real(
            Role::Parameter,
            "law_slope",
            "N s^2/rad",
            &format!("slope of the gain over speed of {}", names.join(" and ")),
        )
        .starting(decimal(slope))
        .within(decimal(least), decimal(most)),
    ]
}
