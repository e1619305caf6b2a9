//! Counts of a 12-bit converter to what they stand for.

/// The largest count: the converter's reference.
pub const FULL_SCALE: u16 = 4095;

/// Counts that close to either rail are a broken wire or a short, never a sample.
const RAIL_COUNTS: u16 = 16;

/// A shunt with an amplifier whose output rests at half of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shunt {
    /// Its resistance \[ohm\].
    pub resistance_ohm: f32,
    /// Gain of the amplifier.
    pub gain: f32,
    /// Reference of the converter \[V\].
    pub reference_v: f32,
    /// Whether counts fall when current flows into the motor.
    pub reversed: bool,
}

impl Shunt {
    /// Current of one count \[A\], negative where reversed.
    pub const fn ampere_per_count(&self) -> f32 {
        let step = self.reference_v / (FULL_SCALE as f32 * self.resistance_ohm * self.gain);
        if self.reversed { -step } else { step }
    }

    /// Current into the motor \[A\], but for the amplifier's own zero. NaN at either rail: the current is beyond what can
    /// be told.
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

/// A thermistor to the reference, above a resistor to ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermistor {
    /// The resistor to ground \[ohm\].
    pub lower_ohm: f32,
    /// The thermistor at 25 deg C \[ohm\].
    pub nominal_ohm: f32,
    /// Its constant beta \[K\].
    pub beta_k: f32,
}

impl Thermistor {
    /// The temperature \[deg C\]; NaN where it is cut or shorted.
    pub fn celsius(&self, counts: u16) -> f32 {
        if counts <= RAIL_COUNTS || counts >= FULL_SCALE - RAIL_COUNTS {
            return f32::NAN;
        }
        let ohm = self.lower_ohm * (f32::from(FULL_SCALE) / f32::from(counts) - 1.0);
        1.0 / (libm::logf(ohm / self.nominal_ohm) / self.beta_k + 1.0 / 298.15) - 273.15
    }
}

/// A sensor whose output is linear between two counts, and never beyond them while it is whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauge {
    /// Least count of a whole sensor.
    pub least_counts: u16,
    /// Largest count of a whole sensor.
    pub most_counts: u16,
    /// What the least count stands for, in the sensor's unit.
    pub max: f32,
    /// What the largest count stands for, in the sensor's unit.
    pub min: f32,
}

impl Gauge {
    /// The value; `None` where the counts are beyond a whole sensor's.
    pub fn value(&self, counts: u16) -> Option<f32> {
        let span = f32::from(self.most_counts) - f32::from(self.least_counts);
        let part = (f32::from(counts) - f32::from(self.least_counts)) / span;
        (self.least_counts..=self.most_counts)
            .contains(&counts)
            .then_some(self.max + part * (self.min - self.max))
    }
}
