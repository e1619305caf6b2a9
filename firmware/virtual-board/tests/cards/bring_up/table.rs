//! The board on the engineer's table: its connections and the instruments.

use super::monitor::Monitor;
use super::pattern::Line;
use link::message::Message;
use std::collections::VecDeque;
use std::path::PathBuf;
use virtual_board::bicycle::{Wheel, wheel};
use virtual_board::parts::bmi160::Motion;
use virtual_board::power::Axis;
use virtual_board::wiring::Wiring;
use virtual_board::{Bench, Options};

/// Ports and pins of the LEDs.
const GREEN: (usize, u8) = (1, 0);
const RED: (usize, u8) = (1, 1);
/// At rest with its z axis up \[m/s^2\].
const LEVEL_M_S2: [f64; 3] = [0.0, 0.0, G_M_S2];
pub(super) const G_M_S2: f64 = 9.806_65;
/// History of the LEDs, and how long one must have been on or off \[ms\].
const REMEMBERED: usize = 2100;
const STEADY: usize = 600;

/// A board and its surroundings.
pub(super) struct Table {
    images: [PathBuf; 2],
    bench: Option<Bench>,
    /// Speeds of the front and the rear wheel's rims \[m/s\].
    pub(super) wheels_m_s: [f64; 2],
    wheels: [Wheel; 2],
    /// Lean of the bicycle to the right \[rad\].
    pub(super) lean_rad: f64,
    /// Sensed by the IMU, in its own axes \[rad/s\], \[m/s^2\].
    pub(super) gyro_rad_s: [f64; 3],
    pub(super) accel_m_s2: [f64; 3],
    shake: u32,
    /// Beginning of the last action \[ms\].
    since_ms: f64,
    /// Green and red, each millisecond.
    leds: VecDeque<[bool; 2]>,
    /// The computer on the serial line.
    monitor: Monitor,
}

/// The flashed image.
#[derive(Clone, Copy)]
pub(super) enum Flashed {
    Product = 0,
    Align = 1,
}

impl Table {
    /// An empty table, with the images of the product and of the alignment.
    pub(super) fn new(images: [PathBuf; 2]) -> Self {
        Self {
            images,
            bench: None,
            wheels_m_s: [0.0; 2],
            wheels: [Wheel::default(); 2],
            lean_rad: 0.0,
            gyro_rad_s: [0.0; 3],
            accel_m_s2: LEVEL_M_S2,
            shake: 0,
            since_ms: 0.0,
            leds: VecDeque::new(),
            monitor: Monitor::default(),
        }
    }

    /// Flashes an image, which leaves the parameters' flash unchanged, and powers the board.
    pub(super) fn flash(&mut self, image: Flashed, wiring: Wiring) {
        let store = self.bench.as_mut().map(Bench::store);
        let image = &self.images[image as usize];
        let bench = Bench::power_on_with_store(image, Options::default(), wiring, store.as_deref());
        self.bench = Some(bench.expect("the board starts"));
        (self.wheels_m_s, self.wheels, self.lean_rad, self.since_ms) = Default::default();
        (self.gyro_rad_s, self.accel_m_s2) = ([0.0; 3], LEVEL_M_S2);
        self.leds.clear();
        self.monitor = Monitor::default();
    }

    /// Begins an action: what was shown before does not count.
    pub(super) fn begin(&mut self) {
        self.since_ms = self.bench.as_ref().map_or(0.0, Bench::now_ms);
    }

    /// The powered board.
    pub(super) fn bench(&mut self) -> &mut Bench {
        self.bench.as_mut().expect("the page powers the board first")
    }

    /// Changes what is connected.
    pub(super) fn wire<T: Send + 'static>(
        &mut self,
        change: impl FnOnce(&mut Wiring) -> T + Send + 'static,
    ) -> T {
        self.bench().with(|board| change(&mut board.chip.wiring))
    }

    /// The handlebar is at an angle and turns at a rate, both positive to the right \[rad\], \[rad/s\].
    pub(super) fn steer(&mut self, steer_rad: f64, rate_rad_s: f64) {
        self.wire(move |wiring| {
            wiring.power.set_axis(Axis::Driven);
            wiring.power.drive(steer_rad, rate_rad_s);
        });
    }

    /// Sends a request on the serial line.
    pub(super) fn send(&mut self, request: &Message<'_>) {
        let bytes = crate::bed::request(request, 1);
        self.bench().send(&bytes);
    }

    /// Advances by a millisecond: the wheels roll, and the IMU's values vary by a few counts, like those of a real
    /// one, which is never quite at rest.
    pub(super) fn step(&mut self) {
        let speeds = self.wheels_m_s;
        for (number, speed_m_s) in speeds.into_iter().enumerate() {
            for edge in self.wheels[number].roll(speed_m_s, 1e-3) {
                wheel::line(self.bench(), number, edge.high);
            }
        }
        self.bench().run_ms(1.0).unwrap_or_else(|error| panic!("{error}"));
        let bytes = self.bench().received();
        self.monitor.take(&bytes);
        self.shake = (self.shake + 1) % 7;
        let now_ns = self.bench().now_ns();
        let (gyro, accel, shake) = (self.gyro_rad_s, self.accel_m_s2, f64::from(self.shake) - 3.0);
        let leds = self.wire(move |wiring| {
            let values = [gyro.map(|rate| rate + 2e-3 * shake), accel.map(|force| force - 1e-2 * shake)];
            wiring.imu.moves(Motion { at_ns: now_ns, values, slopes: [[0.0; 3]; 2] });
            [GREEN, RED].map(|(port, pin)| wiring.level(port, pin) == Some(true))
        });
        self.leds.push_back(leds);
        if self.leds.len() > REMEMBERED {
            self.leds.pop_front();
        }
    }

    /// The log's lines, newest first, preceded by the present readings of the other instruments.
    pub(super) fn shown(&mut self) -> Vec<Line> {
        let since_us = (self.since_ms * 1e3) as u64;
        let instruments = [self.leds(), self.scope(), self.candump(), self.monitor.line()];
        let mut lines: Vec<Line> = instruments.into_iter().map(|text| Line { text, new: true }).collect();
        let log = self.bench().log().iter().rev();
        lines.extend(log.map(|line| Line { text: line.text.clone(), new: line.at_us >= since_us }));
        lines
    }

    fn leds(&self) -> String {
        let led = |number: usize| led_text(self.leds.iter().map(|leds| leds[number]));
        format!("green={} red={}", led(0), led(1))
    }

    /// The bridge's pins since the last action.
    fn scope(&mut self) -> String {
        let since_ns = (self.since_ms * 1e6) as u64;
        self.wire(move |wiring| {
            let changed = wiring.main_output.iter().any(|(at_ns, _)| *at_ns >= since_ns);
            let level = if wiring.tim1.main_output() || changed { "switching" } else { "low" };
            format!("PA8={level} PB13={level}")
        })
    }

    /// The frames on CAN in the last second, by identifier.
    fn candump(&mut self) -> String {
        let now_ns = self.bench().now_ns();
        self.wire(move |wiring| {
            let frames = &mut wiring.can.network.received;
            frames.retain(|frame| frame.at_ns + 1_000_000_000 > now_ns);
            let count = |identifier| frames.iter().filter(|frame| frame.identifier == identifier).count();
            let [state, motion, causes] = [0x320, 0x321, 0x322].map(count);
            format!("candump: 320={state} 321={motion} 322={causes} a second")
        })
    }
}

/// Description of an LED from its levels in each millisecond.
fn led_text(levels: impl Iterator<Item = bool>) -> String {
    let levels: Vec<bool> = levels.collect();
    let rises: Vec<usize> = (1..levels.len()).filter(|at| levels[*at] && !levels[at - 1]).collect();
    let lately = &levels[levels.len().saturating_sub(STEADY)..];
    match rises.as_slice() {
        _ if lately.iter().all(|on| *on) => "on".into(),
        _ if lately.iter().all(|on| !on) => "off".into(),
        [first, second] if (950..=1050).contains(&(second - first)) => "blinking".into(),
        rises => format!("changing at {rises:?} ms"),
    }
}
