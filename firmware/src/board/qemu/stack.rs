//! Measures stack depth: fills unused stack with a pattern and finds how much was overwritten.
#![allow(unsafe_code)]

use core::hint::black_box;

const PAINT: u32 = 0xa5c3_96e7;
/// Number of words filled: 4 KiB of the stack's 32.
const WORDS: usize = 1024;
/// Gap below the caller, for the frame of [`paint`] itself \[bytes\].
const GAP: usize = 64;

/// Fills the stack below the caller; returns the reference address of the depth.
#[inline(never)]
pub fn paint() -> usize {
    let here = 0_u32;
    let top = (&raw const *black_box(&here)) as usize & !3;
    for word in 0..WORDS {
        // SAFETY: memory below this function's frame is unused, an interrupt writes there only when it occurs, and
        // the stack is eight times as deep.
        unsafe { ((top - GAP - 4 * word) as *mut u32).write_volatile(PAINT) }
    }
    top
}

/// Number of bytes below `top` overwritten since [`paint`]; at least its gap.
#[inline(never)]
pub fn depth(top: usize) -> u32 {
    let lowest = top - GAP - 4 * (WORDS - 1);
    // SAFETY: reads words of the stack that `paint` wrote.
    let painted = |word: &usize| unsafe { ((lowest + 4 * word) as *const u32).read_volatile() == PAINT };
    let whole = (0..WORDS).take_while(painted).count();
    (GAP + 4 * (WORDS - whole)) as u32
}

unsafe extern "C" {
    static mut _stack_end: u32;
}

/// Fills the whole stack below the caller.
#[inline(never)]
pub fn paint_all() {
    let here = 0_u32;
    let top = (&raw const *black_box(&here)) as usize & !3;
    let mut word = &raw mut _stack_end;
    while (word as usize) < top - GAP {
        // SAFETY: inside the stack's memory, below the frame of this function.
        unsafe {
            word.write_volatile(PAINT);
            word = word.add(1);
        }
    }
}

/// Number of bytes at the stack's end not overwritten since [`paint_all`].
#[inline(never)]
pub fn never_used() -> u32 {
    let end = &raw const _stack_end;
    // SAFETY: inside the stack's memory: this function's frame is above the filled part.
    let whole = (0..).take_while(|word| unsafe { end.add(*word).read_volatile() } == PAINT).count();
    4 * whole as u32
}
