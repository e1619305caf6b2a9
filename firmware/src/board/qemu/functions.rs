//! Mathematical functions of one argument beside micromath's, for the table of docs/motor.md.

use core::f32::consts::TAU;
use core::hint::black_box;
use micromath::F32;
use motor::angle::Angle;

/// Number of arguments per function.
pub const ARGUMENTS: u32 = 1000;

/// Calls `count` with each function's name and, per argument, with its call (0) or an empty call (1).
pub fn each(mut count: impl FnMut(&'static str, &dyn Fn(usize, u32))) {
    for (name, function, argument) in NUMBERS {
        let functions = black_box::<[Function; 2]>([function, same]);
        count(name, &|which, i| _ = black_box(functions[which](argument(i))));
    }
    let functions = black_box::<[fn(Angle) -> (f32, f32); 2]>([Angle::sin_cos, no_sin_cos]);
    count("sine and cosine, today", &|which, i| _ = black_box(functions[which](angle(i))));
    let functions = black_box::<[fn(f32) -> (f32, f32); 2]>([rough_sin_cos, twice]);
    count("sine and cosine, micromath", &|which, i| _ = black_box(functions[which](angle(i).signed() * TAU)));
}

/// Function of one number.
type Function = fn(f32) -> f32;
/// The argument of a call.
type Argument = fn(u32) -> f32;

/// Functions with their arguments.
const NUMBERS: [(&str, Function, Argument); 7] = [
    ("rounding, today", libm::roundf, to_be_sent),
    ("rounding, micromath", |x| F32(x).round().0, to_be_sent),
    ("logarithm, today", libm::logf, resistance),
    ("logarithm, micromath", |x| F32(x).ln().0, resistance),
    ("root, today", libm::sqrtf, square),
    ("root, micromath", |x| F32(x).sqrt().0, square),
    ("root, micromath and two steps of Newton", |x| newton(x, newton(x, F32(x).sqrt().0)), square),
];

fn rough_sin_cos(x: f32) -> (f32, f32) {
    (F32(x).sin().0, F32(x).cos().0)
}

fn same(x: f32) -> f32 {
    x
}

fn twice(x: f32) -> (f32, f32) {
    (x, x)
}

fn no_sin_cos(angle: Angle) -> (f32, f32) {
    twice(f32::from_bits(angle.0))
}

fn newton(x: f32, root: f32) -> f32 {
    0.5 * (root + x / root)
}

/// One turn.
fn angle(i: u32) -> Angle {
    Angle(i.wrapping_mul(u32::MAX / ARGUMENTS))
}

/// Over the range of 16 bits.
fn to_be_sent(i: u32) -> f32 {
    65.43 * (i as f32 - 500.0)
}

/// Thermistor resistance relative to that at 25 degrees, over the converter's counts.
fn resistance(i: u32) -> f32 {
    4095.0 / (20.0 + 4.0 * i as f32) - 1.0
}

/// Squared lengths up to 32 V.
fn square(i: u32) -> f32 {
    1.0 + i as f32
}
