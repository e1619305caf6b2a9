//! Many rides on one core: the widest vector instructions this machine has.
#![allow(unsafe_code)]

use super::backend::Backend;
use super::lanes::{WIDTH, run};
use super::{Conditions, Remote, RemoteError, Ride, Start, TracePoint};

/// Every ride to its end, in the order of `starts`.
///
/// Eight abreast if the machine has AVX2 (used without fused multiply-add), else one after the
/// other: the bits are the same either way.
pub fn rides(conditions: &Conditions, starts: &[Start]) -> Vec<Ride> {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine was just seen to have AVX2.
        return unsafe { rides_avx2(conditions, starts) };
    }
    run::<1>(conditions, starts, None, &mut Backend::Local)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn rides_avx2(conditions: &Conditions, starts: &[Start]) -> Vec<Ride> {
    run::<WIDTH>(conditions, starts, None, &mut Backend::Local)
}

/// One ride with every control period written down; the same bits as in a batch.
pub fn traced(conditions: &Conditions, start: Start) -> (Ride, Vec<TracePoint>) {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut done = run::<1>(conditions, &[start], Some(&mut trace), &mut Backend::Local);
    (done.remove(0), trace)
}

/// As [`rides`], one after the other, the control step on a processor of its own.
///
/// # Errors
/// The processor's.
pub fn rides_on(
    conditions: &Conditions,
    starts: &[Start],
    remote: &mut dyn Remote,
) -> Result<Vec<Ride>, RemoteError> {
    let mut backend = Backend::away(remote);
    let done = run::<1>(conditions, starts, None, &mut backend);
    backend.end().map(|()| done)
}

/// As [`traced`], the control step on a processor of its own.
///
/// # Errors
/// The processor's.
pub fn traced_on(
    conditions: &Conditions,
    start: Start,
    remote: &mut dyn Remote,
) -> Result<(Ride, Vec<TracePoint>), RemoteError> {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut backend = Backend::away(remote);
    let mut done = run::<1>(conditions, &[start], Some(&mut trace), &mut backend);
    backend.end().map(|()| (done.remove(0), trace))
}
