//! Image that fails in the way its first argument names, to test that every failure is reported.
#![no_std]
#![no_main]
#![allow(unsafe_code)]

use core::hint::black_box;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_semihosting::hprintln;
use firmware::board::Exit;
use firmware::board::semihosting::{command_line, exit};
use firmware::failure;
use stm32_metapac::Interrupt;

#[expect(unconditional_recursion, reason = "to run out of stack")]
fn recurse(depth: u32) -> u32 {
    let frame = black_box([depth; 64]);
    recurse(depth + 1) + frame[63]
}

#[cortex_m_rt::entry]
fn main() -> ! {
    hprintln!("{}", firmware::identity!());
    failure::enable();
    match command_line().split(' ').nth(1) {
        Some("panic") => panic!("on purpose"),
        Some("stack") => {
            black_box(recurse(0));
        }
        Some("undefined") => cortex_m::asm::udf(),
        // SAFETY: there is no memory at this address; the bus fault is the point.
        Some("bus") => unsafe {
            black_box((0x6000_0000 as *const u32).read_volatile());
        },
        // SAFETY: this interrupt is unused; it has no handler, which is the point.
        Some("interrupt") => unsafe {
            NVIC::unmask(Interrupt::SPI3);
            NVIC::pend(Interrupt::SPI3);
            hprintln!("interrupt {} has passed unnoticed", Interrupt::SPI3.number());
        },
        other => hprintln!("no such failure: {:?}", other),
    }
    exit(Exit::Success)
}
