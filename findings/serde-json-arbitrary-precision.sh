#!/usr/bin/env bash
# serde_json 1.0.154: its feature `arbitrary_precision` changes what other crates' types read from JSON, and any crate of a build may turn it on.
#
# With the feature a number comes as a map with one private key, which only serde_json's own types take back for a number. The
# line that reads {"w": 1.02} into toml 1.2.1's `Value` as a float then reads a table, without an error.
# Cargo unites features over a build, so a program changes when a crate such as defmt-decoder 1.2.0, which turns the feature on,
# is built beside it: green alone, red with the whole workspace.
# Seen with: serde_json 1.0.154, toml 1.2.1: "float" without the feature, "table" with it, "table" beside defmt-decoder 1.2.0.
# Fails when one of them says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
cargo init --quiet --name finding --vcs none
cargo add --quiet --ignore-rust-version serde_json@=1.0.154 toml@=1.2.1
cat >src/main.rs <<'RUST'
fn main() {
    let set: std::collections::BTreeMap<String, toml::Value> = serde_json::from_str(r#"{"w": 1.02}"#).unwrap();
    println!("{}", set["w"].type_str());
}
RUST
rustc --version
alone=$(cargo run --quiet --ignore-rust-version)
cargo add --quiet --ignore-rust-version serde_json@=1.0.154 --features arbitrary_precision
precise=$(cargo run --quiet --ignore-rust-version)
cargo remove --quiet serde_json
cargo add --quiet --ignore-rust-version serde_json@=1.0.154 defmt-decoder@=1.2.0
beside=$(cargo run --quiet --ignore-rust-version)
echo "alone: $alone; with the feature: $precise; beside defmt-decoder: $beside"
[ "$alone $precise $beside" = "float table table" ] || { echo "changed: was float, table, table" >&2; exit 1; }
