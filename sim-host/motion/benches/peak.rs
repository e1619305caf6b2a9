//! Peak double-precision rate of one core, and the rates of right-hand sides and of a small basin in the same run.
//! Prints lines of name=value.
#![allow(unsafe_code)]

mod work;

use std::hint::black_box;
use std::time::Instant;

/// Independent chains: twelve vectors, more than two units with a latency of three to four cycles need.
const VECTORS: usize = 12;
/// Operations on each chain.
const LENGTH: u32 = 1 << 14;
/// Measurements of each rate, of which the fastest counts.
const TIMES: usize = 41;

fn main() {
    // In turn, so that a change of the clock rate acts on all of them.
    let b = work::bicycle();
    let states = work::states(&b, 8000);
    let conditions = work::conditions();
    let (mut sums, mut fused, mut sides, mut basins) = (f64::MAX, f64::MAX, f64::MAX, f64::MAX);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first pool");
    let found = work::small_basin(&conditions).work();
    for _ in 0..TIMES {
        sums = sums.min(per_operation(products_and_sums));
        fused = fused.min(per_operation(fused_products));
        sides = sides.min(seconds(|| work::right_hand_sides(&b, &states)));
        basins = basins.min(seconds(|| work::small_basin(&conditions)));
    }
    println!("name=products_and_sums operations_per_s={}", 1.0 / sums);
    println!("name=fused operations_per_s={}", 1.0 / fused);
    println!("name=right_hand_side right_hand_sides_per_s={}", states.len() as f64 / sides);
    println!("name=basin right_hand_sides_per_s={}", found.right_hand_sides as f64 / basins);
}

fn seconds<X>(work: impl FnOnce() -> X) -> f64 {
    let begin = Instant::now();
    black_box(work());
    begin.elapsed().as_secs_f64()
}

/// Seconds for each operation of a function that returns the number of chains on which it executed [`LENGTH`] products and sums.
fn per_operation(chains: impl FnOnce() -> usize) -> f64 {
    let mut count = 0;
    let s = seconds(|| count = chains());
    s / (2.0 * f64::from(LENGTH) * count as f64)
}

/// A product and a sum in turn on every chain.
fn products_and_sums() -> usize {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx512f") {
        // SAFETY: the machine was just checked to have AVX-512.
        return unsafe { products_and_sums_avx512() };
    }
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine was just checked to have AVX2.
        return unsafe { products_and_sums_avx2() };
    }
    each::<VECTORS>(|x| x * 0.999 + 0.001)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn products_and_sums_avx512() -> usize {
    each::<{ 8 * VECTORS }>(|x| x * 0.999 + 0.001)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn products_and_sums_avx2() -> usize {
    each::<{ 4 * VECTORS }>(|x| x * 0.999 + 0.001)
}

/// A fused product and sum on every chain; the rides use none.
fn fused_products() -> usize {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx512f") {
        // SAFETY: the machine was just checked to have AVX-512.
        return unsafe { fused_products_avx512() };
    }
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma") {
        // SAFETY: the machine was just checked to have both.
        return unsafe { fused_products_fma() };
    }
    each::<VECTORS>(|x| x * 0.999 + 0.001)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn fused_products_avx512() -> usize {
    each::<{ 8 * VECTORS }>(|x| x.mul_add(0.999, 0.001))
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fused_products_fma() -> usize {
    each::<{ 4 * VECTORS }>(|x| x.mul_add(0.999, 0.001))
}

#[inline(always)]
fn each<const CHAINS: usize>(op: impl Fn(f64) -> f64) -> usize {
    let mut chains = black_box([1.0; CHAINS]);
    for _ in 0..LENGTH {
        for x in &mut chains {
            *x = op(*x);
        }
    }
    black_box(chains).len()
}
