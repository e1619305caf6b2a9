//! Comparison of the torques of two rides.

use sim_host::ride::TracePoint;

/// Motor torque of a ride, as the mean of each control period \[N m\].
pub fn torques_nm(trace: &[TracePoint], steps_a_period: usize) -> Vec<f64> {
    let mean = |steps: &[TracePoint]| steps.iter().map(|p| p.motor_torque).sum::<f64>() / steps.len() as f64;
    trace.chunks_exact(steps_a_period.max(1)).map(mean).collect()
}

/// Difference of two torques.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Largest magnitude of the first \[N m\].
    pub peak_nm: f64,
    /// Root mean square of the first \[N m\].
    pub rms_nm: f64,
    /// Largest magnitude of the difference \[N m\].
    pub largest_nm: f64,
    /// Root mean square of the difference \[N m\].
    pub rms_difference_nm: f64,
}

impl Difference {
    /// Compares two torques period by period, over the shorter length.
    pub fn new(torque_nm: &[f64], from_nm: &[f64]) -> Self {
        let both = torque_nm.len().min(from_nm.len());
        let difference: Vec<f64> = torque_nm.iter().zip(from_nm).map(|(a, b)| a - b).collect();
        let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / both.max(1) as f64).sqrt();
        let largest = |x: &[f64]| x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        Self {
            peak_nm: largest(&torque_nm[..both]),
            rms_nm: rms(&torque_nm[..both]),
            largest_nm: largest(&difference),
            rms_difference_nm: rms(&difference),
        }
    }
}
