//! Simulates many rides on one core with the widest available vector instructions.
#![allow(unsafe_code)]

use super::backend::Backend;
use super::lanes::{WIDTH, run};
use super::quick::{self, Quick, QuickRide};
use super::{Conditions, Remote, RemoteError, Ride, Start, TracePoint};

/// Simulates every ride to its end; results in the order of `starts`.
///
/// Eight in parallel if the machine has AVX2 (without fused multiply-add), otherwise one after the other. The
/// bits are the same.
pub fn rides(conditions: &Conditions, starts: &[Start]) -> Vec<Ride> {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine was just checked to have AVX2.
        return unsafe { rides_avx2(conditions, starts) };
    }
    run::<1>(conditions, starts, None, &mut Backend::Local)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn rides_avx2(conditions: &Conditions, starts: &[Start]) -> Vec<Ride> {
    run::<WIDTH>(conditions, starts, None, &mut Backend::Local)
}

impl Quick<'_> {
    /// Simulates every ride; results in the order of `starts`.
    pub fn rides(&self, starts: &[Start]) -> Vec<QuickRide> {
        #[cfg(target_arch = "x86_64")]
        if std::is_x86_feature_detected!("avx2") {
            // SAFETY: the machine was just checked to have AVX2.
            return unsafe { quick_rides_avx2(self, starts) };
        }
        quick::run::<1>(self, starts)
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn quick_rides_avx2(quick: &Quick, starts: &[Start]) -> Vec<QuickRide> {
    quick::run::<WIDTH>(quick, starts)
}

/// Simulates one ride and records every control period; the bits are the same as in a batch.
pub fn traced(conditions: &Conditions, start: Start) -> (Ride, Vec<TracePoint>) {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut done = alone(conditions, start, &mut trace, &mut Backend::Local);
    (done.remove(0), trace)
}

/// As [`traced`]; `stop` is called in every control period, and there is no ride once it returns true.
pub fn traced_until(
    conditions: &Conditions,
    start: Start,
    stop: &dyn Fn() -> bool,
) -> Option<(Ride, Vec<TracePoint>)> {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut done = alone(conditions, start, &mut trace, &mut Backend::Until(stop));
    done.pop().map(|ride| (ride, trace))
}

fn alone(
    conditions: &Conditions,
    start: Start,
    trace: &mut Vec<TracePoint>,
    backend: &mut Backend<'_>,
) -> Vec<Ride> {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine was just checked to have AVX2.
        return unsafe { alone_avx2(conditions, start, trace, backend) };
    }
    run::<1>(conditions, &[start], Some(trace), backend)
}

/// One ride in instructions with three operands, which need no copies of registers.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn alone_avx2(
    conditions: &Conditions,
    start: Start,
    trace: &mut Vec<TracePoint>,
    backend: &mut Backend<'_>,
) -> Vec<Ride> {
    run::<1>(conditions, &[start], Some(trace), backend)
}

/// As [`rides`], one after the other, with the control step on an external processor.
///
/// # Errors
/// The processor fails.
pub fn rides_on(
    conditions: &Conditions,
    starts: &[Start],
    remote: &mut dyn Remote,
) -> Result<Vec<Ride>, RemoteError> {
    let mut backend = Backend::remote(remote);
    let done = run::<1>(conditions, starts, None, &mut backend);
    backend.end().map(|()| done)
}

/// As [`traced`], with the control step on an external processor.
///
/// # Errors
/// The processor fails.
pub fn traced_on(
    conditions: &Conditions,
    start: Start,
    remote: &mut dyn Remote,
) -> Result<(Ride, Vec<TracePoint>), RemoteError> {
    let mut trace = Vec::with_capacity(conditions.steps() as usize);
    let mut backend = Backend::remote(remote);
    let mut done = run::<1>(conditions, &[start], Some(&mut trace), &mut backend);
    backend.end().map(|()| (done.remove(0), trace))
}
