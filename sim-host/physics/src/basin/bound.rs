//! Relation of a computed number to the true one, where heights are lower bounds.

use super::{Basin, Column};

/// Relation of a computed number to the true one. A height is a lower bound if no ride fell up to the largest
/// disturbance tried; an area or mean that contains it is then one too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The true number, within the tolerance of the search.
    Measured,
    /// The true number is this or larger.
    AtLeast,
    /// The true number is this or smaller.
    AtMost,
    /// The true number may be larger or smaller.
    Unknown,
}

impl Bound {
    /// For a height, an area or a mean; `capped` if it is a lower bound.
    pub fn of(capped: bool) -> Self {
        if capped { Self::AtLeast } else { Self::Measured }
    }

    /// For a ratio of two such numbers.
    pub fn of_ratio(numerator_capped: bool, denominator_capped: bool) -> Self {
        match (numerator_capped, denominator_capped) {
            (false, false) => Self::Measured,
            (true, false) => Self::AtLeast,
            (false, true) => Self::AtMost,
            (true, true) => Self::Unknown,
        }
    }

    /// For the distance of two heights.
    pub(super) fn of_distance(a: &Column, b: &Column) -> Self {
        let bounded = match (a.capped, b.capped) {
            (false, false) => return Self::Measured,
            (true, true) => a.upper == b.upper,
            (true, false) => b.upper <= a.upper,
            (false, true) => a.upper <= b.upper,
        };
        if bounded { Self::AtLeast } else { Self::Unknown }
    }

    /// For a sum of numbers that are measured, lower bounds or unknown.
    pub(super) fn and(self, other: Self) -> Self {
        match (self, other) {
            (a, b) if a == b => a,
            (Self::Measured, one) | (one, Self::Measured) => one,
            _ => Self::Unknown,
        }
    }

    /// Prefix of the number: none, `>= `, `<= `, or `~ ` if unknown.
    pub fn sign(self) -> &'static str {
        match self {
            Self::Measured => "",
            Self::AtLeast => ">= ",
            Self::AtMost => "<= ",
            Self::Unknown => "~ ",
        }
    }

    /// Whether the number is measured.
    pub fn is_measured(self) -> bool {
        self == Self::Measured
    }
}

impl schemars::JsonSchema for Bound {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Bound".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({"type": "string", "enum": ["measured", "at_least", "at_most", "unknown"]})
    }
}

impl Basin {
    /// Whether any height is a lower bound, and so the area and the mean.
    pub fn capped(&self) -> bool {
        self.columns.iter().any(|c| c.capped)
    }
}
