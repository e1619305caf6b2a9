//! A wheel with magnets and a hall switch: from the distance rolled to edges of the line.

use crate::Bench;
use rigless::device::Level;
use rigless::soc::st::tim::Channel;
use rigless::time::VirtualNanos;
use std::f64::consts::TAU;

/// Index of the wheels' timers in the library, and their channels: front TIM4 channel 1, rear TIM3 channel 2.
const TIMERS: [(usize, u8); 2] = [(2, 1), (1, 2)];

/// An edge of the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Time from the start of the step \[s\].
    pub after_s: f64,
    /// New level; a magnet pulls the line low.
    pub high: bool,
}

/// A wheel with the magnets and radius that the board is made for ([`devices::vesc6::wheel`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wheel {
    /// Distance rolled, in halves of the magnet spacing. The line is high in even halves.
    halves: f64,
}

impl Wheel {
    /// Rolls for `step_s` at a speed, positive forward \[m/s\]; returns the edges in order.
    pub fn roll(&mut self, speed_m_s: f64, step_s: f64) -> Vec<Edge> {
        let config = devices::vesc6::wheel();
        let half_m = 0.5 * TAU * f64::from(config.radius_m) / f64::from(config.pulses_per_turn);
        let (from, way) = (self.halves, speed_m_s * step_s / half_m);
        self.halves = from + way;
        let (first, last) = (from.floor(), self.halves.floor());
        let edge = |number: f64, half: f64| Edge {
            after_s: step_s * (number - from) / way,
            high: half.rem_euclid(2.0) == 0.0,
        };
        if way >= 0.0 {
            (first as i64 + 1..=last as i64).map(|n| edge(n as f64, n as f64)).collect()
        } else {
            (last as i64 + 1..=first as i64).rev().map(|n| edge(n as f64, n as f64 - 1.0)).collect()
        }
    }
}

/// Changes the line of a wheel's hall switch; the front wheel is number 0.
pub fn line(bench: &mut Bench, wheel: usize, high: bool) {
    let (timer, channel) = TIMERS[wheel];
    let (at, level) = (VirtualNanos(bench.now_ns()), Level::from(high));
    bench.with(move |board| {
        board.chip.library.drive_timer(at, timer, |timer, registers, context| {
            if let Some(channel) = Channel::new(channel) {
                timer.drive_input(channel, level, registers, context);
            }
        });
    });
}
