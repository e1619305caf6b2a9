//! Analog inputs: physical values to counts of 12 bits at 3.3 V.

use devices::vesc6::{BOARD_TEMPERATURE, RIDER_NM, SHUNT, STEER_RAD, SUPPLY};

const FULL_SCALE: f64 = 4095.0;

/// Sensors on analog pins.
#[derive(Clone, Debug)]
pub struct Analog {
    /// Offsets of the three current amplifiers from mid-range \[counts\].
    pub current_zero_counts: [f64; 3],
    /// Phase whose current reaches each amplifier.
    pub current_wiring: [usize; 3],
    /// Amplifier with a reversed shunt.
    pub current_reversed: [bool; 3],
    /// Whether the rider's switch is closed.
    pub switch_closed: bool,
    /// Torque of the rider \[N m\]; `None`: no such sensor, the input reads 0.
    pub rider_torque_nm: Option<f64>,
    /// Whether the steer sensor is connected.
    pub steer_connected: bool,
    /// Temperature beside the bridge's switches \[deg C\].
    pub board_c: f64,
}

impl Default for Analog {
    /// A board at 25 deg C with amplifier offsets of a few counts; everything connected but a torque sensor.
    fn default() -> Self {
        Self {
            current_zero_counts: [3.0, -4.0, 2.0],
            current_wiring: [0, 1, 2],
            current_reversed: [false; 3],
            switch_closed: false,
            rider_torque_nm: None,
            steer_connected: true,
            board_c: 25.0,
        }
    }
}

impl Analog {
    pub(crate) fn current_counts(&self, phases_a: [f64; 3], amplifier: usize) -> u16 {
        let current_a = phases_a[self.current_wiring[amplifier]];
        let sign = if self.current_reversed[amplifier] { -1.0 } else { 1.0 };
        let counts = sign * current_a / f64::from(SHUNT.ampere_per_count());
        clamped(0.5 * FULL_SCALE + counts + self.current_zero_counts[amplifier])
    }

    pub(crate) fn steer_counts(&self, steer_rad: f64) -> u16 {
        if self.steer_connected { gauge(&STEER_RAD, steer_rad) } else { 0 }
    }

    pub(crate) fn rider_torque_counts(&self) -> u16 {
        self.rider_torque_nm.map_or(0, |torque_nm| gauge(&RIDER_NM, torque_nm))
    }

    /// A contact to ground with a pull-up.
    pub(crate) fn switch_counts(&self) -> u16 {
        if self.switch_closed { 0 } else { FULL_SCALE as u16 }
    }

    pub(crate) fn board_temperature_counts(&self) -> u16 {
        let kelvin = self.board_c + 273.15;
        let ohm = f64::from(BOARD_TEMPERATURE.nominal_ohm)
            * (f64::from(BOARD_TEMPERATURE.beta_k) * (1.0 / kelvin - 1.0 / 298.15)).exp();
        clamped(
            FULL_SCALE * f64::from(BOARD_TEMPERATURE.lower_ohm)
                / (f64::from(BOARD_TEMPERATURE.lower_ohm) + ohm),
        )
    }

    pub(crate) fn supply_counts(&self, bus_v: f64) -> u16 {
        let part = f64::from(SUPPLY.lower_ohm) / f64::from(SUPPLY.upper_ohm + SUPPLY.lower_ohm);
        clamped(FULL_SCALE * bus_v * part / f64::from(SUPPLY.reference_v))
    }
}

fn gauge(gauge: &devices::analog::Gauge, value: f64) -> u16 {
    let part = (value - f64::from(gauge.value_at_least_counts))
        / f64::from(gauge.value_at_most_counts - gauge.value_at_least_counts);
    let span = f64::from(gauge.most_counts - gauge.least_counts);
    clamped(f64::from(gauge.least_counts) + part * span)
}

fn clamped(counts: f64) -> u16 {
    counts.round().clamp(0.0, FULL_SCALE) as u16
}
