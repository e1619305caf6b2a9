//! Sine and cosine of an angle together, without branches, so that lanes of angles compile to vector code.

use super::Scalar;

/// pi/2 in three parts; the first two have 33 significant bits, so their products with the
/// quadrant number are exact (fdlibm, `e_rem_pio2.c`).
const PIO2: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer, ties to even, and leaves that
/// integer in the low bits of the sum.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine of `x` in radians, |x| < 1e5; error below 1.5 units in the last place.
///
/// Exactly odd and even: `sin_cos(-x)` is `(-s, c)` bit for bit.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    let (s, c, quadrant) = reduced(x);
    by_quadrant(s, c, quadrant.to_bits())
}

/// Sine and cosine of `x` reduced by the nearest multiple of pi/2; the low bits of the third value hold the
/// quadrant.
#[inline(always)]
pub(super) fn reduced<S: Scalar>(x: S) -> (S, S, S) {
    let quadrant = x * std::f64::consts::FRAC_2_PI + ROUND;
    let n = quadrant + -ROUND;
    let r = ((x - n * PIO2[0]) - n * PIO2[1]) - n * PIO2[2];
    let (s, c) = kernel(r);
    (s, c, quadrant)
}

/// Odd quadrants swap sine and cosine; the signs follow from the quadrant's two low bits.
#[inline(always)]
pub(super) fn by_quadrant(s: f64, c: f64, quadrant: u64) -> (f64, f64) {
    let swap = 0u64.wrapping_sub(quadrant & 1);
    let (s, c) = (s.to_bits(), c.to_bits());
    let (sin, cos) = ((s & !swap) | (c & swap), (c & !swap) | (s & swap));
    let sin_sign = (quadrant & 2) << 62;
    let cos_sign = ((quadrant ^ (quadrant << 1)) & 2) << 62;
    (f64::from_bits(sin ^ sin_sign), f64::from_bits(cos ^ cos_sign))
}

/// A polynomial of five degrees, lowest coefficient first.
#[inline(always)]
fn series<S: Scalar>(z: S, c: &[f64; 6]) -> S {
    z * (z * (z * (z * (z * c[5] + c[4]) + c[3]) + c[2]) + c[1]) + c[0]
}

/// The fdlibm polynomials for [-pi/4, pi/4].
#[inline(always)]
#[allow(clippy::excessive_precision)]
fn kernel<S: Scalar>(r: S) -> (S, S) {
    const SIN: [f64; 6] = [
        -1.666_666_666_666_663_243_48e-01,
        8.333_333_333_322_489_461_24e-03,
        -1.984_126_982_985_794_931_34e-04,
        2.755_731_370_707_006_767_89e-06,
        -2.505_076_025_340_686_341_95e-08,
        1.589_690_995_211_550_102_21e-10,
    ];
    const COS: [f64; 6] = [
        4.166_666_666_666_660_190_37e-02,
        -1.388_888_888_887_410_957_49e-03,
        2.480_158_728_947_672_941_78e-05,
        -2.755_731_435_139_066_330_35e-07,
        2.087_572_321_298_174_827_90e-09,
        -1.135_964_755_778_819_482_65e-11,
    ];
    let z = r * r;
    let half = z * 0.5;
    let w = -half + 1.0;
    (r + r * z * series(z, &SIN), w + ((-w + 1.0) - half + z * z * series(z, &COS)))
}

#[cfg(test)]
mod tests {
    use super::sin_cos;

    #[test]
    #[allow(clippy::disallowed_methods)]
    fn agrees_with_the_standard_library_and_is_exactly_odd() {
        for i in 0..2_000_001 {
            let x = (i - 1_000_000) as f64 * 1.234_567_89e-4;
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() < 2.3e-16 && (c - x.cos()).abs() < 2.3e-16, "at {x}");
            let (s_mirror, c_mirror) = sin_cos(-x);
            assert_eq!((s_mirror, c_mirror), (-s, c), "at {x}");
        }
    }
}
