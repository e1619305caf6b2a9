//! Variables of a model: declared once, for the model description and for every check.

use std::ops::Range;

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number.
    Real,
    /// A whole number of 32 bits.
    Integer,
    /// 0 or 1.
    Boolean,
    /// One of these names, by its index.
    Choice(&'static [&'static str]),
}

/// Role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The time.
    Time,
    /// A constant of the model.
    Constant,
    /// Set before the start, then fixed.
    Parameter,
    /// Set between steps.
    Input,
    /// Computed by a step.
    Output,
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name, with the unit where the crate's own name has it.
    pub name: String,
    /// Meaning; may be empty.
    pub about: String,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Type.
    pub kind: Kind,
    /// Role.
    pub role: Role,
    /// Value at the start; an output's is the model's.
    pub start: f64,
    /// Smallest and largest allowed value.
    pub range: Option<[f64; 2]>,
    /// Whether an output depends on the inputs of the same instant.
    pub direct: bool,
}

impl Variable {
    /// A number without a range.
    pub fn real(role: Role, name: &str, unit: &'static str, about: &str) -> Self {
        let (name, about) = (name.into(), about.into());
        Self { name, about, unit, kind: Kind::Real, role, start: 0.0, range: None, direct: false }
    }

    /// A variable of another type, without a unit.
    pub fn of_kind(kind: Kind, role: Role, name: &str, about: &str) -> Self {
        Self { kind, ..Self::real(role, name, "", about) }
    }

    /// The same with a value at the start.
    pub fn starting(self, start: f64) -> Self {
        Self { start, ..self }
    }

    /// The same output, depending on the inputs of the same instant.
    pub fn direct(self) -> Self {
        Self { direct: true, ..self }
    }

    /// The same with a range.
    pub fn within(self, min: f64, max: f64) -> Self {
        Self { range: Some([min, max]), ..self }
    }

    /// Accepts a value that the variable can have.
    ///
    /// # Errors
    /// The name, the value, and what is expected.
    pub fn check(&self, value: f64) -> Result<(), String> {
        let name = &self.name;
        if !value.is_finite() {
            return Err(format!("{name} = {value} is not a finite number"));
        }
        if let Kind::Choice(names) = self.kind
            && !(0..names.len()).any(|number| number as f64 == value)
        {
            return Err(format!(
                "{name} = {value} is none of 0 to {}: {}",
                names.len() - 1,
                names.join(", ")
            ));
        }
        match self.range {
            Some([min, max]) if !(min..=max).contains(&value) => {
                let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
                Err(format!("{name} = {value} is outside {min} to {max}{unit}"))
            }
            _ => Ok(()),
        }
    }
}

/// The variables of a model, grouped by their role in the order of [`Role`]. An index is the value reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(Vec<Variable>);

impl Table {
    /// The time, and the variables of a model by their role.
    pub fn new(variables: Vec<Variable>) -> Self {
        let time = Variable::real(Role::Time, "time", "s", "time");
        let mut all: Vec<_> = [time].into_iter().chain(variables).collect();
        all.sort_by_key(|variable| variable.role as u8);
        Self(all)
    }

    /// All variables.
    pub fn variables(&self) -> &[Variable] {
        &self.0
    }

    /// Indices of the variables of a role.
    pub fn of(&self, role: Role) -> Range<usize> {
        let before = self.0.partition_point(|variable| (variable.role as u8) < role as u8);
        before..self.0.partition_point(|variable| variable.role as u8 <= role as u8)
    }

    /// Checksum of the variables in their order: the library of an FMU must have those of its model description.
    pub fn fingerprint(&self) -> u32 {
        crc32fast::hash(format!("{:?}", self.0).as_bytes())
    }

    /// The values at the start.
    pub fn start(&self) -> Vec<f64> {
        self.0.iter().map(|variable| variable.start).collect()
    }
}
