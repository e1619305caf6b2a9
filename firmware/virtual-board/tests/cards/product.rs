//! Faults of the components wired to the product's board, and of its tasks, as reported to the engineer's computer.

use crate::boards::{PRODUCT, log_has, powered, query};
use control::SensorFrame;
use link::message::Message;
use link::report::FaultKind;
use rigless::device::Level;
use rigless::soc::st::tim::Channel;
use rigless::time::VirtualNanos;
use virtual_board::Bench;
use virtual_board::wiring::Wiring;

/// Sensors and steps of the next telemetry.
fn next_telemetry(bench: &mut Bench) -> (SensorFrame, u32) {
    let telemetry = |message: &Message<'_>| match message {
        Message::Telemetry(t) => Some((t.frame, t.steps)),
        _ => None,
    };
    query(bench, &Message::AskHello, 200.0, telemetry)
}

/// The board after its start, sending telemetry.
fn running(wiring: Wiring) -> Bench {
    let mut bench = powered(PRODUCT, wiring);
    bench.run_ms(280.0).unwrap();
    next_telemetry(&mut bench);
    bench
}

/// Situation: the product runs, a second node is on CAN. In this order, each over before the next:
/// - Noise of 600 bytes on the serial line: the next request is answered.
/// - The IMU does not answer for 30 ms: its age rises with the time, and is at most 1 when it answers again.
/// - The front wheel's line carries 100 kHz for 10 ms: no speed. A magnet every 40 ms: the speed of that.
/// - CAN is shorted for 300 ms: the node is off the bus, control continues; after the short, frames come within 1 s.
///   The other node goes: no frame counts, control continues.
#[test]
fn external_components_may_fail_and_recover() {
    let mut wiring = Wiring::new();
    wiring.can.network.node = true;
    let mut bench = running(wiring);
    noise_on_the_line_loses_no_later_request(&mut bench);
    the_age_of_a_silent_imu_rises(&mut bench);
    a_noisy_wheel_line_is_no_speed(&mut bench);
    a_shorted_can_bus_is_left_and_rejoined(&mut bench);
}

fn noise_on_the_line_loses_no_later_request(bench: &mut Bench) {
    let mut state = 12_345_u32;
    let noise = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    });
    bench.send(&noise.take(600).collect::<Vec<_>>());
    bench.run_ms(60.0).unwrap();
    let hello = |message: &Message<'_>| matches!(message, Message::Hello(_)).then_some(());
    query(bench, &Message::AskHello, 100.0, hello);
}

fn the_age_of_a_silent_imu_rises(bench: &mut Bench) {
    assert!(next_telemetry(bench).0.gyro_rad_s.age_ticks <= 1);
    bench.with(|board| board.chip.wiring.imu.silent = true);
    bench.run_ms(30.0).unwrap();
    let age = next_telemetry(bench).0.gyro_rad_s.age_ticks;
    assert!((20..=60).contains(&age), "{age}");
    bench.with(|board| board.chip.wiring.imu.silent = false);
    bench.run_ms(30.0).unwrap();
    assert!(next_telemetry(bench).0.gyro_rad_s.age_ticks <= 1);
}

fn a_noisy_wheel_line_is_no_speed(bench: &mut Bench) {
    for _ in 0..1000 {
        front_wheel(bench, Level::Low);
        bench.run_ms(0.005).unwrap();
        front_wheel(bench, Level::High);
        bench.run_ms(0.005).unwrap();
    }
    let front_m_s = next_telemetry(bench).0.front_wheel_m_s.value;
    assert_eq!(front_m_s, 0.0);
    for _ in 0..6 {
        front_wheel(bench, Level::Low);
        bench.run_ms(10.0).unwrap();
        front_wheel(bench, Level::High);
        bench.run_ms(30.0).unwrap();
    }
    let front_m_s = next_telemetry(bench).0.front_wheel_m_s.value;
    // 16 magnets on a wheel of 0.35 m: 3.4 m/s, as near as the limit of acceleration permits.
    assert!((2.0..=3.6).contains(&front_m_s), "{front_m_s}");
}

/// The level on the front wheel's pin, channel 1 of TIM4.
fn front_wheel(bench: &mut Bench, level: Level) {
    const TIM4: usize = 2;
    let at = VirtualNanos((bench.now_ms() * 1e6).round() as u64);
    bench.with(move |board| {
        let channel = Channel::new(1).expect("a channel");
        board.chip.library.drive_timer(at, TIM4, |timer, registers, context| {
            timer.drive_input(channel, level, registers, context);
        });
    });
}

fn a_shorted_can_bus_is_left_and_rejoined(bench: &mut Bench) {
    let frames = |bench: &mut Bench| bench.with(|board| board.chip.wiring.can.network.received.len());
    let before = frames(bench);
    bench.run_ms(100.0).unwrap();
    let sent = frames(bench) - before;
    assert!((13..=17).contains(&sent), "{sent} in 100 ms");
    bench.with(|board| board.chip.wiring.can.network.shorted = true);
    let (_, steps) = next_telemetry(bench);
    bench.run_ms(300.0).unwrap();
    let shorted = frames(bench);
    let (_, later) = next_telemetry(bench);
    assert!((290..=360).contains(&(later - steps)), "{} steps", later - steps);
    bench.with(|board| board.chip.wiring.can.network.shorted = false);
    let from_ms = bench.now_ms();
    bench.run_until(1000.0, "frame on CAN", |bench| frames(bench) > shorted + 2).unwrap();
    println!("CAN: back after {:.1} ms", bench.now_ms() - from_ms);
    bench.with(|board| board.chip.wiring.can.network.node = false);
    let (alone, (_, steps)) = (frames(bench), next_telemetry(bench));
    bench.run_ms(100.0).unwrap();
    let (_, later) = next_telemetry(bench);
    assert!((90..=160).contains(&(later - steps)), "{} steps", later - steps);
    assert!(frames(bench) <= alone + 1);
}

/// Situation: power-on with an IMU that does not answer.
/// Must hold: the log reports it, control runs, and its sample has the largest age.
#[test]
fn an_imu_that_never_answers_is_missing() {
    let mut wiring = Wiring::new();
    wiring.imu.silent = true;
    let mut bench = running(wiring);
    assert!(log_has(&bench, 0.0, "imu: chip=0xff, wanted 0xd1"), "{:#?}", bench.log());
    let (frame, steps) = next_telemetry(&mut bench);
    assert!(frame.gyro_rad_s.age_ticks as u32 >= steps.min(20), "{} at {steps}", frame.gyro_rad_s.age_ticks);
}

/// Situation: the product runs.
/// Action: a bit of USART3 is lost, so that no byte is sent any more and the task of the line waits without end; then
/// the interrupt of control's executor returns at once, so that control waits without end.
/// Must hold: the watchdog resets the chip 100 to 260 ms after each; the log of the next start and the list of faults
/// on the serial line name the task.
#[test]
fn a_blocked_task_is_named_over_the_serial_line() {
    const USART3_CR1: u32 = 0x4000_480c;
    const UE: u32 = 1 << 13;
    const RETURN: u16 = 0x4770;
    let mut bench = running(Wiring::new());
    bench.force_register(USART3_CR1, |cr1| cr1 & !UE);
    resets_by_watchdog(&mut bench, "line");
    bench.run_ms(280.0).unwrap();
    bench.damage("UART5", &[RETURN]).unwrap();
    resets_by_watchdog(&mut bench, "control");
    bench.run_ms(280.0).unwrap();
    let stored = [0, 1].map(|from| {
        let stored = |message: &Message<'_>| match message {
            Message::StoredFault(stored) if stored.place == from => {
                stored.record.map(|record| (stored.total, record.kind, record.boot, record.text.to_owned()))
            }
            _ => None,
        };
        query(&mut bench, &Message::ListFaults { from }, 200.0, stored)
    });
    let expected =
        [(2, FaultKind::Watchdog, 2, "control".to_owned()), (2, FaultKind::Watchdog, 1, "line".to_owned())];
    assert_eq!(stored, expected);
}

fn resets_by_watchdog(bench: &mut Bench, task: &str) {
    let (from_ms, resets) = (bench.now_ms(), bench.resets().len());
    bench.run_until(260.0, "reset", |bench| bench.resets().len() > resets).unwrap();
    let after_ms = bench.now_ms() - from_ms;
    println!("{task}: reset after {after_ms:.1} ms");
    assert!((100.0..=260.0).contains(&after_ms), "{after_ms} ms");
    bench.run_ms(3.0).unwrap();
    assert!(log_has(bench, from_ms, &format!("watchdog: {task}")), "{:#?}", bench.log());
}
