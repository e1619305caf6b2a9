//! Exact discretisation of the open loop over one interval, for disturbances that are straight lines and a delayed
//! neural signal that is a polynomial in each interval.

use super::gray_box::{GAINS, GrayBox, INPUTS, OpenLoop, STATES};
use crate::exponential::exponential_of;
use nalgebra::SMatrix;

/// Points of an interval at which the neural signal is stored: Chebyshev-Lobatto points, both ends included, so that
/// the jumps of the signal where the force jumps lie between two intervals.
pub(super) const NODES: usize = 5;
/// What the state in an interval depends on: the state at its start, the neural signal at the nodes of two past
/// intervals (the older first), and the disturbances at start and end.
pub(super) const SOURCES: usize = STATES + 2 * NODES + 2 * INPUTS;
const OLDER: usize = STATES;
const NEWER: usize = STATES + NODES;
const DISTURBANCES: usize = STATES + 2 * NODES;
/// State, and the derivatives of polynomial inputs.
const AUGMENTED: usize = STATES + NODES + 2 * INPUTS;

type StateOfSources = SMatrix<f64, STATES, SOURCES>;

/// The interval's end and the signals at its nodes as linear functions of [`SOURCES`].
pub(super) struct Interval {
    /// Length \[s\].
    pub(super) length_s: f64,
    /// Number of intervals by which the newer source precedes.
    pub(super) lag: usize,
    /// State at the end.
    pub(super) end: StateOfSources,
    /// Feedback signals at the nodes.
    pub(super) signals: [SMatrix<f64, GAINS, SOURCES>; NODES],
}

/// Position of node `i` in the interval, from 0 to 1.
fn node(i: usize) -> f64 {
    (1.0 - libm::cos(std::f64::consts::PI * i as f64 / (NODES - 1) as f64)) / 2.0
}

/// From the values at the nodes to the value and the derivatives (per interval length) at `at`.
fn derivatives(at: f64) -> SMatrix<f64, NODES, NODES> {
    let powers = SMatrix::<f64, NODES, NODES>::from_fn(|i, j| node(i).powi(j as i32));
    let mut of_coefficients = SMatrix::<f64, NODES, NODES>::zeros();
    for order in 0..NODES {
        for power in order..NODES {
            let falling: f64 = (0..order).map(|k| (power - k) as f64).product();
            of_coefficients[(order, power)] = falling * at.powi((power - order) as i32);
        }
    }
    // The nodes differ, so their powers are independent.
    of_coefficients * powers.lu().try_inverse().unwrap_or_default()
}

/// State after `duration_s` with a neural signal that takes its polynomial from the nodes at column `nodes`, starting at
/// the position `from` of that interval; `start` is the state at the start, `position` that in the present interval.
fn flow(
    system: &OpenLoop,
    length_s: f64,
    start: &StateOfSources,
    position: f64,
    duration_s: f64,
    (nodes, from): (usize, f64),
) -> StateOfSources {
    let mut generator = SMatrix::<f64, AUGMENTED, AUGMENTED>::zeros();
    generator.fixed_view_mut::<STATES, STATES>(0, 0).copy_from(&system.a);
    generator.fixed_view_mut::<STATES, 1>(0, STATES).copy_from(&system.alpha);
    for i in 0..NODES - 1 {
        generator[(STATES + i, STATES + i + 1)] = 1.0 / length_s;
    }
    for input in 0..INPUTS {
        let place = STATES + NODES + 2 * input;
        generator.fixed_view_mut::<STATES, 1>(0, place).copy_from(&system.input.column(input));
        generator[(place, place + 1)] = 1.0 / length_s;
    }
    let mut initial = SMatrix::<f64, AUGMENTED, SOURCES>::zeros();
    initial.fixed_view_mut::<STATES, SOURCES>(0, 0).copy_from(start);
    initial.fixed_view_mut::<NODES, NODES>(STATES, nodes).copy_from(&derivatives(from));
    for input in 0..INPUTS {
        let (place, source) = (STATES + NODES + 2 * input, DISTURBANCES + 2 * input);
        (initial[(place, source)], initial[(place, source + 1)]) = (1.0 - position, position);
        (initial[(place + 1, source)], initial[(place + 1, source + 1)]) = (-1.0, 1.0);
    }
    (exponential_of(&(generator * duration_s)) * initial).fixed_view::<STATES, SOURCES>(0, 0).into_owned()
}

impl Interval {
    /// The longest interval that divides `sample_s` and is no longer than the delay; if several lengths down to an eighth
    /// of it are possible, one of which the delay is a multiple. `None` without a delay.
    pub(super) fn new(model: &GrayBox, sample_s: f64) -> Option<Self> {
        if model.delay_s <= 0.0 {
            return None;
        }
        let fewest = (sample_s / model.delay_s * (1.0 - 1e-9)).ceil().max(1.0) as u32;
        let whole = |n: &u32| {
            let intervals = model.delay_s * f64::from(*n) / sample_s;
            (intervals - intervals.round()).abs() < 1e-9
        };
        let parts = (fewest..fewest * 8).find(whole).unwrap_or(fewest);
        let length_s = sample_s / f64::from(parts);
        let intervals = model.delay_s / length_s;
        let lag = (intervals + 1e-9).floor();
        // The part of an interval in which the delayed signal is still that of the older one.
        let older = if intervals - lag < 1e-9 { 0.0 } else { intervals - lag };
        let system = model.open_loop();
        let start = StateOfSources::identity();
        let at = |position: f64| -> StateOfSources {
            let first = position.min(older);
            let mut state = flow(&system, length_s, &start, 0.0, first * length_s, (OLDER, 1.0 - older));
            if position > older {
                state = flow(&system, length_s, &state, older, (position - older) * length_s, (NEWER, 0.0));
            }
            state
        };
        let signals = std::array::from_fn(|i| {
            let mut signals = system.c * at(node(i));
            for input in 0..INPUTS {
                let source = DISTURBANCES + 2 * input;
                for (column, share) in [(source, 1.0 - node(i)), (source + 1, node(i))] {
                    let sum = signals.column(column) + system.d.column(input) * share;
                    signals.set_column(column, &sum);
                }
            }
            signals
        });
        Some(Self { length_s, lag: lag as usize, end: at(1.0), signals })
    }
}
