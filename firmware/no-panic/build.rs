//! Keeps the proof's link strict: only what `_start` reaches may stay in the image.
fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-link-arg-bins=--gc-sections");
}
