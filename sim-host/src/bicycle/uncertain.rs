//! Measured parameters with uncertainties: parsing, propagation and random draws.

use super::combine::{RIDER_KEYS, combined};
use super::error::{NumberError, ParameterError};
use super::{KEYS, Parameters, check};
use crate::num::RandomStream;
use toml::Value;

/// A value and its standard deviation, in the value's unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Uncertain {
    /// The value.
    pub value: f64,
    /// Its standard deviation; 0 if none is given.
    pub sd: f64,
}

impl Uncertain {
    /// A value without uncertainty.
    pub fn exact(value: f64) -> Self {
        Self { value, sd: 0.0 }
    }

    /// Parses `1.12+/-0.02`; `±` is accepted too.
    ///
    /// # Errors
    /// States the text and the fault.
    pub fn parse(text: &str) -> Result<Self, NumberError> {
        let wrong = || NumberError::Form(text.into());
        let (value, sd) = text.split_once("+/-").or_else(|| text.split_once('±')).ok_or_else(wrong)?;
        let number = |part: &str| part.trim().parse::<f64>().map_err(|_| wrong());
        let (value, sd) = (number(value)?, number(sd)?);
        if !(sd >= 0.0 && sd.is_finite()) {
            return Err(NumberError::Deviation(text.into()));
        }
        Ok(Self { value, sd })
    }

    /// A number from a file, with or without uncertainty.
    ///
    /// # Errors
    /// The value is not a number.
    pub(super) fn of_value(value: &Value) -> Result<Self, NumberError> {
        match value {
            Value::Float(x) => Ok(Self::exact(*x)),
            Value::Integer(i) => Ok(Self::exact(*i as f64)),
            Value::String(text) if text.contains("+/-") || text.contains('±') => Self::parse(text),
            other => Err(NumberError::Type { found: other.type_str(), value: other.to_string() }),
        }
    }
}

/// Uncertain parameters of a bicycle, and of the rider's body combined with it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Measured {
    /// In the order of [`KEYS`].
    pub bicycle: Vec<Uncertain>,
    /// In the order of [`RIDER_KEYS`]; none without a combined rider.
    pub rider: Option<Vec<Uncertain>>,
}

/// Largest number of draws for one bicycle; impossible ones are drawn again.
const TRIES: usize = 1000;

/// None of the drawn bicycles can exist.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("none of {TRIES} draws can exist: {}", .last.as_ref().map(ToString::to_string).unwrap_or_default())]
pub struct DrawError {
    /// The reason of the last draw.
    pub last: Option<ParameterError>,
}

impl Measured {
    /// Whether any value has an uncertainty.
    pub fn is_uncertain(&self) -> bool {
        self.bicycle.iter().chain(self.rider.iter().flatten()).any(|one| one.sd > 0.0)
    }

    /// The parameters, each value mapped by `of`.
    fn parameters_of(&self, of: &mut dyn FnMut(&Uncertain) -> f64) -> Parameters {
        let mut values = [0.0; KEYS.len()];
        values.iter_mut().zip(&self.bicycle).for_each(|(value, one)| *value = of(one));
        let Some(rider) = &self.rider else { return Parameters::from_values(&values) };
        let mut body = [0.0; RIDER_KEYS.len()];
        body.iter_mut().zip(rider).for_each(|(value, one)| *value = of(one));
        combined(&Parameters::from_values(&values), &body)
    }

    /// The parameters at the mean values.
    pub fn parameters(&self) -> Parameters {
        self.parameters_of(&mut |one| one.value)
    }

    /// Standard deviations of [`Measured::parameters`] in the order of [`KEYS`], to first order.
    pub fn deviations(&self) -> [f64; KEYS.len()] {
        let (count, middle) =
            (self.bicycle.len() + self.rider.as_ref().map_or(0, Vec::len), self.parameters());
        let mut squares = [0.0; KEYS.len()];
        for varied in 0..count {
            let mut at = 0;
            let moved = self.parameters_of(&mut |one| {
                let here = at == varied;
                at += 1;
                one.value + if here { one.sd } else { 0.0 }
            });
            let changes = moved.to_values().into_iter().zip(middle.to_values());
            squares.iter_mut().zip(changes).for_each(|(sum, (a, b))| *sum += (a - b).powi(2));
        }
        squares.map(f64::sqrt)
    }

    /// Bicycle `i` of those drawn with `seed`. Every value has an independent normal distribution, as the
    /// files have no correlations. An impossible bicycle is drawn again.
    ///
    /// # Errors
    /// None of the draws is possible; states the reason of the last.
    pub fn draw(&self, seed: u64, i: u64) -> Result<Parameters, DrawError> {
        let mut random = RandomStream::new(seed, [0.0; 3], PURPOSE + i);
        let mut last = None;
        for _ in 0..TRIES {
            let drawn = self.parameters_of(&mut |one| one.value + one.sd * random.normal());
            match check::check(&drawn) {
                Ok(_) => return Ok(drawn),
                Err(error) => last = Some(error),
            }
        }
        Err(DrawError { last })
    }
}

/// First random-number stream not used by rides.
const PURPOSE: u64 = 1 << 32;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_with_a_deviation_is_read_and_nothing_else() {
        let read = |text| Uncertain::parse(text);
        assert_eq!(read("1.12+/-0.02"), Ok(Uncertain { value: 1.12, sd: 0.02 }));
        assert_eq!(read(" -0.5 ± 1e-3 "), Ok(Uncertain { value: -0.5, sd: 1e-3 }));
        for wrong in ["1.12", "1.12+/-", "+/-1", "1+/--1", "1+/-nan", "1+/-inf", "a+/-1", "1+/-2+/-3"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
