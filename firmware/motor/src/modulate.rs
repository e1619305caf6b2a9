//! Modulation: from a voltage vector to three duty cycles.

use crate::transform::{Vector, phases};
use control::maths::bounded;
use control::param::{ParamSpec, ParamVisitor};

/// Parameters of the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridge {
    /// Smallest duty cycle of the upper switch.
    pub duty_min: f32,
    /// Largest duty cycle. Low-side shunts need a value below 1, for the time of a sample.
    pub duty_max: f32,
    /// Dead time: both switches of a phase are open at each transition \[s\]; 0 disables the compensation.
    pub dead_time_s: f32,
    /// Phase current below which the dead time is compensated only in part \[A\], as the sign of a smaller current is
    /// uncertain.
    pub dead_time_a: f32,
}

impl Bridge {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("bridge", "duty_min", 0.0, 0.4), &mut self.duty_min);
        to.number(&ParamSpec::new("bridge", "duty_max", 0.6, 1.0), &mut self.duty_max);
        to.number(&ParamSpec::new("bridge", "dead_time_s", 0.0, 2e-6), &mut self.dead_time_s);
        to.number(&ParamSpec::new("bridge", "dead_time_a", 0.01, 50.0), &mut self.dead_time_a);
    }

    /// Largest voltage vector in any direction, per volt of the bus.
    pub fn max_voltage_ratio(&self) -> f32 {
        (self.duty_max - self.duty_min) * 0.577_350_26
    }

    /// Duty cycle lost to the dead time at a PWM frequency `rate_hz`.
    pub fn dead_duty(&self, rate_hz: f32) -> f32 {
        self.dead_time_s * rate_hz
    }
}

/// Duty cycles for a voltage in stator axes, from a bus of `bus_v`.
///
/// The mean of the largest and smallest phase is subtracted from all three (min-max injection: the waveform of space
/// vector modulation), which gives 15 % more voltage than sines. `current` is the current at that time, for the
/// compensation of `dead_duty` ([`Bridge::dead_duty`]). The result is inside the bridge's limits for all inputs.
pub fn duties(bridge: &Bridge, dead_duty: f32, voltage: Vector, current: Vector, bus_v: f32) -> [f32; 3] {
    let [a, b, c] = phases(voltage);
    let [ia, ib, ic] = phases(current);
    let common = 0.5 * (a.max(b).max(c) + a.min(b).min(c));
    let (middle, half) =
        (0.5 * (bridge.duty_max + bridge.duty_min), 0.5 * (bridge.duty_max - bridge.duty_min));
    let duty = |v: f32, i: f32| {
        let lost = dead_duty * bounded(i / bridge.dead_time_a, 1.0);
        (middle + bounded((v - common) / bus_v + lost, half)).max(bridge.duty_min).min(bridge.duty_max)
    };
    [duty(a, ia), duty(b, ib), duty(c, ic)]
}
