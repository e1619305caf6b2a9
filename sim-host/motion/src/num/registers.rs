//! Registers: the arithmetic of one number, or of several in one instruction.
#![allow(unsafe_code)]

use super::sincos::by_quadrant;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// Numbers in registers. Every operation rounds each number as that of an `f64` does.
///
/// The functions of vector registers must be called only on a processor that has the instructions, and are fast only in a function
/// that is compiled for them, into which they are inlined.
pub(in crate::num) trait Registers: Copy {
    /// The same number in every lane.
    fn constant(value: f64) -> Self;
    /// Sum.
    fn add(self, other: Self) -> Self;
    /// Difference.
    fn sub(self, other: Self) -> Self;
    /// Product.
    fn mul(self, other: Self) -> Self;
    /// Quotient.
    fn div(self, other: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The opposite sign.
    fn neg(self) -> Self;
    /// Sine and cosine of angles from those of the reduced angles, as [`super::sincos::by_quadrant`].
    fn by_quadrant(s: Self, c: Self, quadrant: Self) -> (Self, Self);

    /// The registers with these numbers, which must be as many.
    #[inline(always)]
    fn load<const N: usize>(numbers: [f64; N]) -> Self {
        // SAFETY: registers and array have the same size, and any bits are numbers.
        unsafe { Bits { numbers }.registers }
    }

    /// The numbers in the registers.
    #[inline(always)]
    fn numbers<const N: usize>(self) -> [f64; N] {
        // SAFETY: as above.
        unsafe { Bits { registers: self }.numbers }
    }
}

/// The same bits as an array and as registers. A union, since functions of the standard library would be compiled anew for each of
/// some thousand operations.
union Bits<R: Copy, const N: usize> {
    numbers: [f64; N],
    registers: R,
}

/// One number. A loop over one lane does the same, but some thousand loops are a third of the compiler's time.
#[derive(Clone, Copy)]
pub(in crate::num) struct One(f64);

impl Registers for One {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(value)
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
    #[inline(always)]
    fn by_quadrant(s: Self, c: Self, quadrant: Self) -> (Self, Self) {
        let (sin, cos) = by_quadrant(s.0, c.0, quadrant.0.to_bits());
        (Self(sin), Self(cos))
    }
}

/// Numbers in as many registers as indices are listed. Two have more independent operations, which hide part of the latencies, and with
/// AVX2 too few registers; with one, fewer lanes remain empty.
#[cfg(target_arch = "x86_64")]
macro_rules! vector_registers {
    (
        $name:ident: [$number:ident; $count:literal] at [$($i:literal),+],
        $constant:ident, $add:ident $sub:ident $mul:ident $div:ident $sqrt:ident,
        $bits:ident $of_bits:ident $integers:ident $minus:ident $and:ident $and_not:ident $or:ident $xor:ident $left:ident
    ) => {
        #[derive(Clone, Copy)]
        pub(in crate::num) struct $name([$number; $count]);

        // SAFETY of every block: the caller's processor has the instructions.
        impl Registers for $name {
            #[inline(always)]
            fn constant(value: f64) -> Self {
                Self(unsafe { [$constant(value); $count] })
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(unsafe { [$($add(self.0[$i], other.0[$i])),+] })
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(unsafe { [$($sub(self.0[$i], other.0[$i])),+] })
            }
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self(unsafe { [$($mul(self.0[$i], other.0[$i])),+] })
            }
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                Self(unsafe { [$($div(self.0[$i], other.0[$i])),+] })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(unsafe { [$($sqrt(self.0[$i])),+] })
            }
            #[inline(always)]
            fn neg(self) -> Self {
                Self(unsafe { [$($of_bits($xor($bits(self.0[$i]), $integers(i64::MIN)))),+] })
            }
            #[inline(always)]
            fn by_quadrant(s: Self, c: Self, quadrant: Self) -> (Self, Self) {
                let pairs = [$(Self::one_by_quadrant(s.0[$i], c.0[$i], quadrant.0[$i])),+];
                (Self([$(pairs[$i].0),+]), Self([$(pairs[$i].1),+]))
            }
        }

        impl $name {
            /// Of one register. No closure, which would be compiled for every processor.
            #[inline(always)]
            fn one_by_quadrant(s: $number, c: $number, quadrant: $number) -> ($number, $number) {
                unsafe {
                    let (s, c, q) = ($bits(s), $bits(c), $bits(quadrant));
                    let swap = $minus($integers(0), $and(q, $integers(1)));
                    let (swapped_s, swapped_c) =
                        ($or($and_not(swap, s), $and(swap, c)), $or($and_not(swap, c), $and(swap, s)));
                    let sin_sign = $left::<62>($and(q, $integers(2)));
                    let cos_sign = $left::<62>($and($xor(q, $left::<1>(q)), $integers(2)));
                    ($of_bits($xor(swapped_s, sin_sign)), $of_bits($xor(swapped_c, cos_sign)))
                }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
vector_registers! {
    Avx2: [__m256d; 1] at [0], _mm256_set1_pd, _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_sqrt_pd,
    _mm256_castpd_si256 _mm256_castsi256_pd _mm256_set1_epi64x _mm256_sub_epi64 _mm256_and_si256 _mm256_andnot_si256
    _mm256_or_si256 _mm256_xor_si256 _mm256_slli_epi64
}
#[cfg(target_arch = "x86_64")]
vector_registers! {
    TwoOfAvx512: [__m512d; 2] at [0, 1], _mm512_set1_pd, _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_sqrt_pd,
    _mm512_castpd_si512 _mm512_castsi512_pd _mm512_set1_epi64 _mm512_sub_epi64 _mm512_and_si512 _mm512_andnot_si512
    _mm512_or_si512 _mm512_xor_si512 _mm512_slli_epi64
}
#[cfg(target_arch = "x86_64")]
vector_registers! {
    Avx512: [__m512d; 1] at [0], _mm512_set1_pd, _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_sqrt_pd,
    _mm512_castpd_si512 _mm512_castsi512_pd _mm512_set1_epi64 _mm512_sub_epi64 _mm512_and_si512 _mm512_andnot_si512
    _mm512_or_si512 _mm512_xor_si512 _mm512_slli_epi64
}
