//! Plausibility of samples: remarks on values that suggest another unit or orientation.

use super::map::quantity_of;
use super::samples::Track;
use crate::plant::Sensor;
use crate::recording::Remark;

/// Adds a remark for values that suggest another unit or orientation.
pub(super) fn plausible(track: &Track, remarks: &mut Vec<Remark>) {
    let name = track.sensor.name();
    let mut sizes: Vec<f64> =
        track.samples.iter().map(|sample| sample.value.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
    sizes.sort_by(f64::total_cmp);
    let part = |share: f64| sizes[((sizes.len() - 1) as f64 * share) as usize];
    if let Some((most, unit)) = quantity_of(track.sensor).implausible()
        && part(0.95) > most
        && track.sensor != Sensor::Path
    {
        remarks.push(Remark::of_column(
            None,
            format!(
                "{name}: one sample in twenty is beyond {:.3} in SI units; are these {unit}?",
                part(0.95)
            ),
        ));
    }
    if track.sensor == Sensor::Gyro
        && let Some(period_s) = track.period_s()
        && !(1e-4..0.25).contains(&period_s)
    {
        let what = format!("{name}: samples are {period_s} s apart; is the unit of the time right?");
        remarks.push(Remark::of_column(None, what));
    }
    if track.sensor == Sensor::Accel {
        let down: f64 = track.samples.iter().map(|sample| sample.value[2]).sum::<f64>() / sizes.len() as f64;
        if part(0.5) < 2.0 {
            let what =
                format!("{name}: half of the samples are below {:.3} m/s^2; is the unit g?", part(0.5));
            remarks.push(Remark::of_column(None, what));
        } else if down > -0.5 * part(0.5) {
            let what = format!(
                "{name}: the mean along z is {down:.2} m/s^2; upright and at rest it must be -9.81: are the axes right?"
            );
            remarks.push(Remark::of_column(None, what));
        }
    }
}
