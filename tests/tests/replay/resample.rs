//! The controller's measurements between two samples.

use super::{SMALLEST, fed, sampled};
use sim_host::plant::Sensor;
use sim_host::replay::Resample;

/// Situation: a gyro of 200 Hz on a ramp, with a gap of 20 ms.
/// Action: hold it.
/// Must hold: at each millisecond the newest sample and its age, growing by one; nothing of later samples.
#[test]
fn held() {
    let text = "t,gx,gy,gz,rear\n0,0,0,0,4\n0.005,1,0,0,4\n0.025,2,0,0,4\n";
    let inputs = fed(&sampled(text, SMALLEST).unwrap(), Resample::Hold, 0.5);
    let gyro: Vec<_> = inputs.iter().map(|input| input.of(Sensor::Gyro)).collect();
    assert_eq!(gyro.len(), 26);
    for (tick, held) in gyro.iter().enumerate() {
        let (value, since) = match tick {
            0..5 => (0.0, 0),
            5..25 => (1.0, 5),
            _ => (2.0, 25),
        };
        assert_eq!((held.value[0], usize::from(held.age_ticks)), (value, tick - since), "{tick}");
    }
}

/// Situation: the same gyro.
/// Action: interpolate, over gaps up to 10 ms.
/// Must hold: on the line between two samples and always new; over the longer gap held, with a growing age.
#[test]
fn interpolated() {
    let text = "t,gx,gy,gz,rear\n0,0,0,0,4\n0.005,1,0,0,4\n0.025,2,0,0,4\n";
    let inputs = fed(&sampled(text, SMALLEST).unwrap(), Resample::Interpolate, 0.01);
    for (tick, input) in inputs.iter().enumerate() {
        let held = input.of(Sensor::Gyro);
        let (value, age) = match tick {
            0..5 => (0.2 * tick as f64, 0),
            5..25 => (1.0, tick - 5),
            _ => (2.0, 0),
        };
        assert!((held.value[0] - value).abs() < 1e-9, "{tick}: {held:?}");
        assert_eq!(usize::from(held.age_ticks), age, "{tick}");
    }
}

/// Situation: a wheel whose first sample comes 10 ms after the gyro's.
/// Action: feed it.
/// Must hold: before it there is none, at it there is.
#[test]
fn nothing_before_the_first_sample() {
    let text = "t,gx,gy,gz,rear\n0,0,0,0,\n0.01,1,0,0,4\n0.02,1,0,0,4\n";
    let inputs = fed(&sampled(text, SMALLEST).unwrap(), Resample::Hold, 0.5);
    let ages: Vec<u16> = inputs.iter().map(|input| input.of(Sensor::RearWheel).age_ticks).collect();
    assert!(ages[..10].iter().all(|age| *age == u16::MAX) && ages[10] == 0, "{ages:?}");
}
