//! Speed and its bounds from wheel pulses.

use control::sensors::wheel_speed::{
    Direction, WheelPulses, WheelPulsesConfig, WheelPulsesState, WheelSpeed, step,
};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A wheel turned at a given speed, with unevenly spaced magnets.
struct Wheel {
    config: WheelPulsesConfig,
    distance: f64,
    edges: Vec<f64>,
    now: f64,
}

impl Wheel {
    fn new(config: WheelPulsesConfig) -> Self {
        Self { config, distance: 0.0, edges: Vec::new(), now: 0.0 }
    }

    /// Distance at which the `n`th pulse occurs \[m\].
    fn place(&self, n: usize) -> f64 {
        let pulse = TAU * f64::from(self.config.radius_m) / f64::from(self.config.pulses_per_turn);
        let spacing_error =
            0.49 * f64::from(self.config.spacing_error) * if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        (n as f64 + 0.3 + spacing_error) * pulse
    }

    /// Rolls for one millisecond at `speed`.
    fn roll(&mut self, speed: f64) {
        let to = self.distance + speed * 1e-3;
        while speed > 0.0 && self.place(self.edges.len()) <= to {
            let part = (self.place(self.edges.len()) - self.distance) / (to - self.distance);
            self.edges.push(self.now + part.max(0.0) * 1e-3);
        }
        self.distance = to;
        self.now += 1e-3;
    }

    fn reading(&self) -> WheelPulses {
        let us = |s: f64| (s * 1e6) as u32;
        let (last, before) = (self.edges.last(), self.edges.iter().rev().nth(1));
        WheelPulses {
            count: (self.edges.len() % 65_536) as u16,
            last_edge_age_us: last.map_or(u32::MAX, |t| us(self.now - t)),
            last_period_us: last.zip(before).map_or(0, |(a, b)| us(a - b)),
            direction: Direction::Unknown,
        }
    }
}

/// True speeds \[m/s\] every millisecond of a ride, and the estimated ones.
fn ridden(
    config: WheelPulsesConfig,
    seconds: f64,
    speed: impl Fn(f64) -> f64,
) -> Vec<(f64, f64, WheelSpeed)> {
    let (mut wheel, mut state) = (Wheel::new(config), WheelPulsesState::default());
    (0..(seconds * 1e3) as usize)
        .map(|i| {
            let t = (i + 1) as f64 * 1e-3;
            wheel.roll(speed(t - 5e-4));
            (t, speed(t), step(&config, &mut state, &wheel.reading(), 1000))
        })
        .collect()
}

/// Starts, rides at 5.4 m/s, brakes hard to a stop.
fn start_and_stop(t: f64) -> f64 {
    match t {
        t if t < 1.0 => 0.0,
        t if t < 4.0 => 1.8 * (t - 1.0),
        t if t < 6.0 => 5.4,
        t => (5.4 - 5.5 * (t - 6.0)).max(0.0),
    }
}

/// Situation: sensors of 1, 16 and 192 pulses per turn; a start, a ride, a hard stop.
/// Action: follow the speed.
/// Must hold: the true speed is always between the bounds; in steady riding the estimate is near it; after the stop the
/// estimate soon becomes 0.
#[test]
fn the_speed_lies_between_its_bounds() {
    for (pulses_per_turn, settled, seconds_to_zero) in [(1, 0.3, 12.0), (16, 0.3, 1.0), (192, 0.25, 0.2)] {
        let config = WheelPulsesConfig { pulses_per_turn, ..WheelPulsesConfig::default() };
        let ride = ridden(config, 20.0, start_and_stop);
        let (mut widest, mut tightest) = (0.0_f32, f32::MAX);
        for (t, true_speed, reading) in &ride {
            let slack = 0.01 + 0.002 * true_speed;
            let (low, high) = (f64::from(reading.low_m_s), f64::from(reading.high_m_s));
            assert!(
                low - slack <= *true_speed && *true_speed <= high + slack,
                "{pulses_per_turn} {t}: {true_speed} {reading:?}"
            );
            assert!(
                reading.low_m_s <= reading.speed_m_s && reading.speed_m_s <= reading.high_m_s,
                "{t}: {reading:?}"
            );
            if (5.0..6.0).contains(t) {
                assert!(
                    (f64::from(reading.speed_m_s) - true_speed).abs() < settled,
                    "{pulses_per_turn} {t}: {reading:?}"
                );
                let width = reading.high_m_s - reading.low_m_s;
                (widest, tightest) = (widest.max(width), tightest.min(width));
            }
        }
        println!(
            "{pulses_per_turn} pulses a turn: bounds {tightest:.2} to {widest:.2} m/s apart when steady"
        );
        assert!(tightest > 0.01, "{tightest}");
        let stopped = 6.0 + 5.4 / 5.5;
        let zero =
            ride.iter().find(|(t, _, reading)| *t > stopped && reading.speed_m_s == 0.0).expect("stands");
        assert!(zero.0 - stopped < seconds_to_zero, "{pulses_per_turn}: {}", zero.0 - stopped);
    }
}

/// Situation: a wheel that stops between two pulses.
/// Action: wait.
/// Must hold: estimate and upper bound never rise; the upper bound ends at the speed that the wheel could have reached
/// from rest.
#[test]
fn without_a_pulse_the_speed_only_falls() {
    let config = WheelPulsesConfig::default();
    let ride = ridden(config, 8.0, |t| if t < 3.0 { 4.0 } else { 0.0 });
    let after_stop: Vec<_> = ride.iter().filter(|(t, ..)| *t > 3.05).collect();
    for pair in after_stop.windows(2) {
        assert!(pair[1].2.speed_m_s <= pair[0].2.speed_m_s);
        if pair[0].0 > 3.4 {
            assert!(pair[1].2.high_m_s <= pair[0].2.high_m_s + 1e-6, "{pair:?}");
        }
    }
    let last = after_stop.last().expect("waits").2;
    assert_eq!((last.speed_m_s, last.low_m_s), (0.0, 0.0));
    assert!((0.3..1.2).contains(&last.high_m_s), "{last:?}");
}

/// Situation: pulses of a wheel, with the direction unknown, forward and backward.
/// Action: step.
/// Must hold: the speed is negative only for a known backward direction.
#[test]
fn negative_only_when_known_to_be_backward() {
    let config = WheelPulsesConfig::default();
    let reading = WheelPulses {
        count: 9,
        last_edge_age_us: 5_000,
        last_period_us: 50_000,
        direction: Direction::Unknown,
    };
    let with = |direction| {
        let mut state = WheelPulsesState::default();
        let _ = step(&config, &mut state, &WheelPulses { direction, ..reading }, 1000);
        step(&config, &mut state, &WheelPulses { direction, ..reading }, 1000)
    };
    let (unknown, forward, backward) =
        (with(Direction::Unknown), with(Direction::Forward), with(Direction::Backward));
    assert!(unknown == forward && forward.speed_m_s > 2.0, "{forward:?}");
    assert_eq!(backward.speed_m_s, -forward.speed_m_s);
    assert_eq!((backward.low_m_s, backward.high_m_s), (-forward.high_m_s, -forward.low_m_s));
}

fn any_pulses() -> impl Strategy<Value = (WheelPulses, u32)> {
    let direction =
        prop_oneof![Just(Direction::Unknown), Just(Direction::Forward), Just(Direction::Backward)];
    let time = || prop_oneof![any::<u32>(), 0_u32..100_000, Just(u32::MAX)];
    (any::<u16>(), time(), time(), direction, time()).prop_map(|(count, age, period, direction, elapsed)| {
        (WheelPulses { count, last_edge_age_us: age, last_period_us: period, direction }, elapsed)
    })
}

proptest! {
    /// Situation: arbitrary pulses in any order.
    /// Action: step.
    /// Must hold: every speed is finite and within 50 m/s, the estimate between the bounds.
    #[test]
    fn every_speed_is_finite(sequence in proptest::collection::vec(any_pulses(), 1..60)) {
        let (config, mut state) = (WheelPulsesConfig::default(), WheelPulsesState::default());
        for (reading, elapsed) in sequence {
            let speed = step(&config, &mut state, &reading, elapsed);
            prop_assert!(speed.low_m_s.abs() <= 50.0 && speed.high_m_s.abs() <= 50.0, "{speed:?}");
            prop_assert!(speed.low_m_s <= speed.speed_m_s && speed.speed_m_s <= speed.high_m_s, "{speed:?}");
        }
    }
}
