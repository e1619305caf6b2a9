//! The engineer's line: no request is lost, whatever the load of the chip.

use crate::bed::{Listener, board, product, request};
use link::message::Message;
use rigless::soc::stm32f427::generated::usart6::Register;
use virtual_board::Bench;

/// Requests of each test, their beginnings spread evenly over the millisecond of the control step.
const REQUESTS: u16 = 100;

/// Sends this number of requests at this baud rate, each in another phase of the millisecond; returns the numbers of
/// the answered ones.
fn answered(baud: u32, apart_ms: f64) -> Option<Vec<u16>> {
    let mut bench = board(&product()?);
    bench.run_ms(300.0).expect("no gap");
    // As a debugger would: the image always starts with 115,200. APB1 runs at 42 MHz (RM0090 30.3.4).
    let divider = u64::from((42_000_000 + baud / 2) / baud);
    bench.with(move |board| board.chip.library.serial_port(2).1.set(Register::Brr, divider));
    let (mut listener, mut answers) = (Listener::default(), Vec::new());
    // The rate may have changed within a frame; the frames from here on are whole.
    bench.run_ms(30.0).expect("no gap");
    listener.take(&bench.received(), |_, _| ());
    let before = listener.damaged();
    for number in 0..REQUESTS {
        let phase_ms = f64::from(number) / f64::from(REQUESTS);
        let next_ms = bench.now_ms().floor() + 1.0 + phase_ms;
        bench.run_ms(next_ms - bench.now_ms()).expect("no gap");
        bench.send(&request(&Message::AskHello, 1000 + number));
        bench.run_ms(apart_ms).expect("no gap");
        take(&mut bench, &mut listener, &mut answers);
    }
    bench.run_ms(30.0).expect("no gap");
    take(&mut bench, &mut listener, &mut answers);
    assert_eq!(listener.damaged(), before, "frames from the board");
    Some(answers)
}

fn take(bench: &mut Bench, listener: &mut Listener, answers: &mut Vec<u16>) {
    listener.take(&bench.received(), |number, message| {
        if matches!(message, Message::Hello(_)) {
            answers.push(number);
        }
    });
}

fn all_numbers() -> Vec<u16> {
    (1000..1000 + REQUESTS).collect()
}

/// Situation: the product image under load, 115,200 baud: a byte every 87 us, while control occupies the core for a
/// third of each millisecond.
/// Action: a hundred requests, beginning in every hundredth of the millisecond.
/// Must hold: each is answered once, in order.
#[test]
fn no_request_is_lost_at_115200_baud() {
    let Some(answers) = answered(115_200, 12.0) else { return };
    assert_eq!(answers, all_numbers());
}

/// Situation: the same at 921,600 baud: a byte every 11 us. Action and what must hold as before.
#[test]
fn no_request_is_lost_at_921600_baud() {
    let Some(answers) = answered(921_600, 5.0) else { return };
    assert_eq!(answers, all_numbers());
}
