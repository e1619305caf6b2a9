//! A wheel with magnets beside a hall switch: the way it rolls to the edges of a line.

use crate::Bench;
use rigless::device::Level;
use rigless::soc::st::tim::Channel;
use rigless::time::VirtualNanos;
use std::f64::consts::TAU;

/// The wheels' timers among the library's, and their channels: front TIM4 channel 1, rear TIM3 channel 2.
const TIMERS: [(usize, u8); 2] = [(2, 1), (1, 2)];

/// An edge of the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// When, from the start of the step \[s\].
    pub after_s: f64,
    /// The level from then on; a magnet pulls it low.
    pub high: bool,
}

/// A wheel; its magnets and its radius are those the board is made for ([`devices::vesc6::wheel`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wheel {
    /// How far it rolled, in halves of the way from magnet to magnet. The line is high in even ones.
    halves: f64,
}

impl Wheel {
    /// Rolls on for `step_s` at a speed, forward positive \[m/s\]; the edges meanwhile, in order.
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

/// The line of a wheel's hall switch changes now; the front wheel is number 0.
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
