#!/usr/bin/env bash
# micromath 2.1.0: the natural logarithm is a thousand times less exact below 1 than above it.
#
# Its test allows an error of 0.001, and tries whole numbers only, all of them 1 or more. Below 1 the function takes the
# logarithm of the reciprocal, and the reciprocal is the approximation that is off by up to 12.5 %, although the comment
# above the line says that one is not exact enough for it. A thermistor read through it is off by degrees.
# Seen with: micromath 2.1.0, rustc 1.95.0: largest error 0.0001 from 1 to 1000, 0.118 from 0.001 to 1.
# Fails when either number is another.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
cargo init --quiet --name finding --vcs none
cargo add --quiet micromath@=2.1.0
cat >src/main.rs <<'RUST'
use micromath::F32Ext;

fn largest(from: f32, to: f32) -> f64 {
    let steps = 100_000;
    (0..=steps)
        .map(|step| from * (to / from).powf(step as f32 / steps as f32))
        .map(|x: f32| (f64::from(F32Ext::ln(x)) - f64::from(x).ln()).abs())
        .fold(0.0, f64::max)
}

fn main() {
    println!("{:.4} {:.3}", largest(1.0, 1000.0), largest(0.001, 0.999));
}
RUST
rustc --version
seen=$(cargo run --quiet --release)
echo "largest error of ln from 1 to 1000, from 0.001 to 1: $seen"
[ "$seen" = "0.0001 0.118" ] || { echo "changed: was 0.0001 0.118" >&2; exit 1; }
