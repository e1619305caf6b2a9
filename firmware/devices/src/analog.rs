//! Conversion of 12-bit ADC counts to physical units.

/// Largest count: the converter's reference.
pub const FULL_SCALE: u16 = 4095;

/// Distance from either rail within which counts indicate a broken wire or a short \[counts\].
const RAIL_COUNTS: u16 = 16;

/// A shunt with an amplifier whose output at zero current is half of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shunt {
    /// Resistance \[ohm\].
    pub resistance_ohm: f32,
    /// Gain of the amplifier.
    pub gain: f32,
    /// Reference of the converter \[V\].
    pub reference_v: f32,
    /// Whether the counts decrease when current flows into the motor.
    pub reversed: bool,
}

impl Shunt {
    /// Current of one count \[A\], negative where reversed.
    pub const fn ampere_per_count(&self) -> f32 {
        let step = self.reference_v / (FULL_SCALE as f32 * self.resistance_ohm * self.gain);
        if self.reversed { -step } else { step }
    }

    /// Current into the motor \[A\], including the amplifier's offset. NaN at either rail: the current is out of range.
    pub fn ampere(&self, counts: u16) -> f32 {
        let inside = counts > RAIL_COUNTS && counts < FULL_SCALE - RAIL_COUNTS;
        let from_middle = f32::from(counts) - 0.5 * f32::from(FULL_SCALE);
        if inside { from_middle * self.ampere_per_count() } else { f32::NAN }
    }
}

/// A voltage divider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divider {
    /// Resistor to the measured voltage \[ohm\].
    pub upper_ohm: f32,
    /// Resistor to ground \[ohm\].
    pub lower_ohm: f32,
    /// Reference of the converter \[V\].
    pub reference_v: f32,
}

impl Divider {
    /// The measured voltage \[V\].
    pub fn volt(&self, counts: u16) -> f32 {
        let ratio = (self.upper_ohm + self.lower_ohm) / self.lower_ohm;
        f32::from(counts) / f32::from(FULL_SCALE) * self.reference_v * ratio
    }
}

/// A thermistor between reference and ADC input, with a resistor from the input to ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermistor {
    /// Resistor to ground \[ohm\].
    pub lower_ohm: f32,
    /// Thermistor's resistance at 25 deg C \[ohm\].
    pub nominal_ohm: f32,
    /// Thermistor's constant beta \[K\].
    pub beta_k: f32,
}

impl Thermistor {
    /// Temperature \[deg C\]; NaN if the thermistor is open or shorted.
    pub fn celsius(&self, counts: u16) -> f32 {
        if counts <= RAIL_COUNTS || counts >= FULL_SCALE - RAIL_COUNTS {
            return f32::NAN;
        }
        let ohm = self.lower_ohm * (f32::from(FULL_SCALE) / f32::from(counts) - 1.0);
        1.0 / (libm::logf(ohm / self.nominal_ohm) / self.beta_k + 1.0 / 298.15) - 273.15
    }
}

/// A sensor with a linear output between two counts; an intact sensor stays within them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauge {
    /// Smallest count of an intact sensor.
    pub least_counts: u16,
    /// Largest count of an intact sensor.
    pub most_counts: u16,
    /// Value at the smallest count, in the sensor's unit.
    pub value_at_least_counts: f32,
    /// Value at the largest count, in the sensor's unit.
    pub value_at_most_counts: f32,
}

impl Gauge {
    /// Measured value; `None` if the counts are outside an intact sensor's range.
    pub fn value(&self, counts: u16) -> Option<f32> {
        let span = f32::from(self.most_counts) - f32::from(self.least_counts);
        let part = (f32::from(counts) - f32::from(self.least_counts)) / span;
        (self.least_counts..=self.most_counts).contains(&counts).then_some(
            self.value_at_least_counts + part * (self.value_at_most_counts - self.value_at_least_counts),
        )
    }
}
