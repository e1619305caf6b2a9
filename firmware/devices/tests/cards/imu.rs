//! Registers of the IMU.

use devices::bmi160::{BURST, SET_UP, read, sample};

/// Registers from 0x0c on with a gyro sample, an accelerometer sample and a time.
fn bytes(gyro: [i16; 3], accel: [i16; 3], time: u32) -> [u8; BURST] {
    let mut bytes = [0; BURST];
    for (place, value) in gyro.into_iter().chain(accel).enumerate() {
        bytes[2 * place..2 * place + 2].copy_from_slice(&value.to_le_bytes());
    }
    bytes[12..15].copy_from_slice(&time.to_le_bytes()[..3]);
    bytes
}

/// Situation: the bicycle rolls at 100 degrees per second to the right, otherwise upright and at rest. Must hold:
/// these rates and forces, each on its own axis, and the flags of new values.
#[test]
fn a_sample_is_read() {
    let imu = sample(0xc0, &bytes([1640, 0, -1640], [0, 1024, -2048], 0x00ab_cdef));
    let hundred = 100.0_f64.to_radians();
    let [x, y, z] = imu.gyro_rad_s.map(f64::from);
    assert!((x - hundred).abs() < 1e-5 && y == 0.0 && (z + hundred).abs() < 1e-5, "{:?}", imu.gyro_rad_s);
    let [x, y, z] = imu.accel_m_s2.map(f64::from);
    assert!(x == 0.0 && (y - 4.903_325).abs() < 1e-5 && (z + 9.806_65).abs() < 1e-5, "{:?}", imu.accel_m_s2);
    assert_eq!((imu.time, imu.gyro_new, imu.accel_new), (0x00ab_cdef, true, true));
    let one = |status| {
        let imu = sample(status, &bytes([0; 3], [0; 3], 0));
        (imu.gyro_new, imu.accel_new)
    };
    assert_eq!(
        [0x00, 0x40, 0x80, 0x1f].map(one),
        [(false, false), (true, false), (false, true), (false, false)]
    );
}

/// Situation: a shock beyond the range; an unconfigured sensor, whose values are -32768. Must hold: no finite value
/// for either; one count less is a value near the end of the range.
#[test]
fn the_end_of_the_scale_is_no_value() {
    let imu = sample(0xc0, &bytes([i16::MAX, i16::MIN, i16::MAX - 1], [i16::MIN, i16::MAX, 0], 0));
    assert_eq!(imu.gyro_rad_s[0], f32::INFINITY);
    assert_eq!(imu.gyro_rad_s[1], f32::NEG_INFINITY);
    assert!((34.8..35.0).contains(&imu.gyro_rad_s[2]), "{}", imu.gyro_rad_s[2]);
    assert_eq!(imu.accel_m_s2, [f32::NEG_INFINITY, f32::INFINITY, 0.0]);
}

/// Situation: the bytes of the set-up. Must hold: none is a read, the reset comes first with its delay, and range and
/// rate are those assumed for the samples.
#[test]
fn the_set_up_is_the_one_that_samples_are_read_by() {
    assert!(SET_UP.iter().all(|step| read(step.register) != step.register && step.then_ms > 0));
    assert_eq!((SET_UP[0].register, SET_UP[0].value), (0x7e, 0xb6));
    let last = |register| SET_UP.iter().rev().find(|step| step.register == register).map(|step| step.value);
    assert_eq!([0x40, 0x41, 0x42, 0x43].map(last), [Some(0x1c), Some(0x0c), Some(0x1c), Some(0x00)]);
    let time_ms: u32 = SET_UP.iter().map(|step| u32::from(step.then_ms)).sum();
    assert!((190..300).contains(&time_ms), "{time_ms} ms");
}
