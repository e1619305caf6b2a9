//! Each action of docs/hardware.md on the virtual board.

use super::table::{Flashed, G_M_S2, Table};
use crate::boards::START_MS;
use control::safety::press::PressConfig;
use link::Key;
use link::message::Message;
use virtual_board::power::Axis;
use virtual_board::wiring::Wiring;

/// The action; none where the page only observes.
type Action = Option<fn(&mut Table)>;

/// Every action of the page, by its text.
pub(super) const ACTIONS: &[(&str, Action)] = &[
    ("Power on", Some(|table| table.flash(Flashed::Product, without_motor()))),
    ("Read on", None),
    ("Lower the supply to 15 V for a second", Some(lower_the_supply)),
    ("Lay it flat and still", Some(|_| ())),
    ("Turn it about x, 1 rad/s to the positive side", Some(|table| table.gyro_rad_s = [1.0, 0.0, 0.0])),
    ("About y", Some(|table| table.gyro_rad_s = [0.0, 1.0, 0.0])),
    ("About z", Some(|table| table.gyro_rad_s = [0.0, 0.0, 1.0])),
    (
        "Handlebar to the left, 1 rad",
        Some(|table| {
            table.gyro_rad_s = [0.0; 3];
            table.steer(-1.0, 0.0);
        }),
    ),
    ("Straight ahead", Some(|table| table.steer(0.0, 0.0))),
    ("To the right, 1 rad", Some(|table| table.steer(1.0, 0.0))),
    ("Pull the sensor's plug", Some(|table| table.wire(|wiring| wiring.analog.steer_connected = false))),
    ("Push at a walk of 1.5 m/s", Some(|table| table.wheels_m_s = [1.5; 2])),
    ("Stand", Some(|table| table.wheels_m_s = [0.0; 2])),
    ("Hold the switch", Some(press)),
    ("Release it, or cut its wire", Some(|table| switch(table, false))),
    ("Nothing on the port", None),
    ("An adapter on the port", Some(|table| table.wire(|wiring| wiring.can.network.node = true))),
    ("H shorted to L", Some(|table| table.wire(|wiring| wiring.can.network.shorted = true))),
    ("The short taken away", Some(|table| table.wire(|wiring| wiring.can.network.shorted = false))),
    ("A scope on PA8 and PB13", None),
    ("Short PB7 to ground", Some(|table| table.wire(|wiring| wiring.gate_driver.fault_pin_shorted = true))),
    ("Flash and run the image that aligns", Some(|table| table.flash(Flashed::Align, Wiring::new()))),
    ("Release and hold it again", Some(hold_again)),
    ("And a third time", Some(hold_again)),
    (
        "The encoder counts against the field, fault 21: exchange two phases, or set `encoder.reversed`",
        Some(|table| misaligned(table, |wiring| wiring.power.encoder_reversed = true)),
    ),
    (
        "The sign of every current, fault 7 at once: set `SHUNT.reversed`",
        Some(|table| misaligned(table, |wiring| wiring.analog.current_reversed = [true; 3])),
    ),
    (
        "A phase's current on another's pin, fault 1 at once: exchange them",
        Some(|table| misaligned(table, |wiring| wiring.analog.current_wiring = [1, 0, 2])),
    ),
    (
        "The rotor slips or is held, fault 20: friction, or `motor.pole_pairs`",
        Some(|table| misaligned(table, |wiring| wiring.power.set_axis(Axis::Held))),
    ),
    ("Flash and run the product's image", Some(|table| table.flash(Flashed::Product, Wiring::new()))),
    ("Turn the handlebar to the right by hand, 0.5 rad/s", Some(|table| table.steer(0.0, 0.5))),
    (
        "`sim-host param set calibration.imu_roll_rad 3.14159`",
        Some(|table| {
            table.steer(0.0, 0.0);
            set(table, "calibration.imu_roll_rad", "3.14159");
        }),
    ),
    ("Lean to the right, 0.4 rad", Some(|table| lean(table, 0.8, 500))),
    ("Upright again; turn the handlebar to the right, 0.5 rad", Some(turn_the_handlebar)),
    ("Straight again; push at 1 m/s", Some(push)),
    (
        "`sim-host param set limits.max_torque_nm 0.5`",
        Some(|table| set(table, "limits.max_torque_nm", "0.5")),
    ),
    ("Turn both wheels at 2 m/s", Some(|table| table.wheels_m_s = [2.0; 2])),
    ("Hold the switch to engage", Some(engage)),
    ("Lean to the right by hand, the handlebar goes into the fall", Some(fall)),
    ("Let go of the switch, free within 0.2 s", Some(let_go)),
    ("Engage again", Some(engage)),
    ("Pull the encoder's plug, free at once", Some(pull_the_encoders_plug)),
];

/// A supply of 24 V, no motor on the bridge; its encoder is wired.
fn without_motor() -> Wiring {
    let mut wiring = Wiring::new();
    (0..3).for_each(|phase| wiring.power.cut_phase(phase));
    wiring.power.set_source_v(24.0);
    wiring
}

/// Runs for a time \[ms\].
fn wait(table: &mut Table, ms: u32) {
    (0..ms).for_each(|_| table.step());
}

fn lower_the_supply(table: &mut Table) {
    table.wire(|wiring| wiring.power.set_source_v(15.0));
    wait(table, 1010);
    table.wire(|wiring| wiring.power.set_source_v(24.0));
}

fn switch(table: &mut Table, closed: bool) {
    table.wire(move |wiring| wiring.analog.switch_closed = closed);
}

fn hold_again(table: &mut Table) {
    switch(table, false);
    press(table);
}

/// Waits until an open switch counts as released, and closes it.
fn press(table: &mut Table) {
    wait(table, START_MS + u32::from(PressConfig::product().release_ticks));
    switch(table, true);
}

/// The alignment with a fault.
fn misaligned(table: &mut Table, wrong: fn(&mut Wiring)) {
    let mut wiring = Wiring::new();
    wrong(&mut wiring);
    table.flash(Flashed::Align, wiring);
    press(table);
}

fn set(table: &mut Table, key: &'static str, value: &str) {
    let value = value.parse().expect("a number, as it is typed");
    table.send(&Message::Set { key: Key::whole(key), value: Some(value) });
}

/// Leans the bicycle at a rate to the right \[rad/s\] for a time \[ms\], and holds it there. The board lies with z up
/// and x forward, so that y is to the left.
fn lean(table: &mut Table, rate_rad_s: f64, ms: u32) {
    for _ in 0..ms {
        table.lean_rad += 1e-3 * rate_rad_s;
        let (sin, cos) = table.lean_rad.sin_cos();
        table.gyro_rad_s = [rate_rad_s, 0.0, 0.0];
        table.accel_m_s2 = [0.0, G_M_S2 * sin, G_M_S2 * cos];
        table.step();
    }
    table.gyro_rad_s = [0.0; 3];
}

fn turn_the_handlebar(table: &mut Table) {
    lean(table, -0.8, 500);
    table.steer(0.0, 1.0);
    wait(table, 500);
    table.steer(0.5, 0.0);
}

fn push(table: &mut Table) {
    table.steer(0.5, -1.0);
    wait(table, 500);
    table.steer(0.0, 0.0);
    table.wheels_m_s = [1.0; 2];
}

/// Upright, straight, hands off the handlebar; then the switch is held.
fn engage(table: &mut Table) {
    let upright_ms = (table.lean_rad / 0.8 * 1e3).round() as u32;
    lean(table, -0.8, upright_ms);
    table.steer(0.0, 0.0);
    wait(table, 300);
    table.wire(|wiring| wiring.power.set_axis(Axis::Free));
    press(table);
}

/// Leans and continues to lean.
fn fall(table: &mut Table) {
    lean(table, 0.4, 150);
    table.gyro_rad_s = [0.4, 0.0, 0.0];
}

fn let_go(table: &mut Table) {
    table.gyro_rad_s = [0.0; 3];
    switch(table, false);
    wait(table, 200);
    table.begin();
}

/// The motor's loop tolerates ten calls without an angle, half a millisecond.
fn pull_the_encoders_plug(table: &mut Table) {
    table.wire(|wiring| wiring.encoder.cut = true);
    wait(table, 1);
    table.begin();
}
