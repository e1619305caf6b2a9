#!/usr/bin/env bash
# nalgebra 0.34.2: with its default feature `std` the last bits of a matrix product depend on the processor.
#
# `std` adds the crate matrixmultiply, which takes the products of larger matrices of f64 whose size is known at run time, and selects
# a kernel with fused multiply-add when the processor has it. The feature `libm-force`, which makes the functions independent of the
# machine, does not change this. With `alloc` instead of `std` nalgebra's own loops multiply; the matrix exponential is missing then.
# Seen with: nalgebra 0.34.2 with matrixmultiply 0.3.11, rustc 1.95, the same program under QEMU 7.2 (user mode): a product of 12 x 12
# has other bits on a Haswell than on a Nehalem with `std` and `libm-force`, the same with `alloc` and `libm-force`.
# Fails when either is another.
set -euo pipefail
[ "$(uname -m)" = x86_64 ] || { echo "skipped: the processor is no x86-64"; exit 0; }
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
chmod 755 .
apt-get download --quiet "qemu-user-static=1:7.2*"
dpkg -x qemu-user-static_*.deb qemu
mkdir src
cat >Cargo.toml <<'TOML'
[package]
name = "product"
version = "0.1.0"
edition = "2024"
[features]
std = ["nalgebra/std"]
[dependencies]
nalgebra = { version = "=0.34.2", default-features = false, features = ["alloc", "libm-force"] }
matrixmultiply = { version = "=0.3.11", optional = true }
[workspace]
TOML
cat >src/main.rs <<'RUST'
use nalgebra::DMatrix;

fn main() {
    let a = DMatrix::from_fn(12, 12, |i, j| 1.0 / (i + j + 1) as f64);
    let product = &a * &a;
    println!("{:x}", product.iter().fold(0_u64, |sum, x| sum.rotate_left(5) ^ x.to_bits()));
}
RUST
# Without link-time or processor options of the user's own.
unset RUSTFLAGS CARGO_TARGET_DIR
bits() {
  cargo build --quiet --release "$@"
  for cpu in Nehalem Haswell; do qemu/usr/bin/qemu-x86_64-static -cpu $cpu target/release/product 2>/dev/null; done | sort -u | wc -l
}
cargo tree --quiet --features std --prefix none | grep -E "^(nalgebra|matrixmultiply) " | sort -u
seen="$(bits --features std) $(bits)"
echo "different results of two processors: with std, without: $seen"
[ "$seen" = "2 1" ] || { echo "changed: was 2 1" >&2; exit 1; }
