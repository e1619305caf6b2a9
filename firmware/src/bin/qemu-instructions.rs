//! Counts the instructions of every control step over the rides of `rides.bin`, and the stack they take.
//!
//! Under `-icount shift=10` an instruction lasts 1.024 us, 172 counts of SysTick, so that a
//! difference of counts is a whole number of instructions. Instructions are not cycles: there are
//! no wait states of the flash and no multi-cycle divisions in QEMU.
#![no_std]
#![no_main]

use control::wire::{FRAME_BYTES, decode_frame};
use control::{Command, Plan, SensorFrame, State, step};
use core::hint::black_box;
use core::sync::atomic::{Ordering, compiler_fence};
use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::hprintln;
use firmware::board::Exit;
use firmware::board::recording::{BLOCK, Recording};
use firmware::board::semihosting::exit;
use firmware::board::stack;
use firmware::failure;
use static_cell::ConstStaticCell;

static FRAMES: ConstStaticCell<[[u8; FRAME_BYTES]; BLOCK]> = ConstStaticCell::new([[0; FRAME_BYTES]; BLOCK]);

const RELOAD: u32 = 0x00ff_ffff;
const COUNTS_PER_INSTRUCTION: f32 = 168.0 * 1.024;

/// The step as the control task calls it: by reference, result through memory.
#[inline(never)]
fn measured(plan: &Plan, state: &mut State, frame: &SensorFrame, command: &mut Option<Command>) {
    *command = Some(step(plan, state, frame));
}

#[inline(never)]
fn nothing(_: &Plan, _: &mut State, _: &SensorFrame, command: &mut Option<Command>) {
    black_box(command);
}

fn instructions(run: impl FnOnce()) -> u32 {
    let before = SYST::get_current();
    compiler_fence(Ordering::SeqCst);
    run();
    compiler_fence(Ordering::SeqCst);
    let counts = before.wrapping_sub(SYST::get_current()) & RELOAD;
    (counts as f32 / COUNTS_PER_INSTRUCTION + 0.5) as u32
}

#[cortex_m_rt::entry]
fn main() -> ! {
    hprintln!("{}", firmware::identity!());
    failure::enable();
    let mut systick = Peripherals::take().expect("taken once").SYST;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(RELOAD);
    systick.clear_current();
    systick.enable_counter();

    let block = FRAMES.take();
    let mut recording = Recording::open();
    while let Some(mut ride) = recording.next_ride() {
        let (mut state, mut command) = (State::default(), None);
        let (mut steps, mut sum, mut max, mut deep) = (0_u32, 0_u64, 0_u32, 0_u32);
        loop {
            let frames = recording.next_block(&mut ride, block);
            if frames.is_empty() {
                break;
            }
            let top = stack::paint();
            for frame in frames {
                let frame = decode_frame(frame);
                let (plan, frame) = (black_box(&ride.plan), black_box(&frame));
                let around = instructions(|| nothing(plan, &mut state, frame, &mut command));
                let whole = instructions(|| measured(plan, &mut state, frame, &mut command));
                black_box(&command);
                let step = whole.saturating_sub(around);
                (steps, sum, max) = (steps + 1, sum + u64::from(step), max.max(step));
            }
            deep = deep.max(stack::depth(top));
        }
        hprintln!("steps={} mean={} max={} stack={}", steps, sum / u64::from(steps.max(1)), max, deep);
    }
    exit(Exit::Success)
}
