#!/usr/bin/env bash
# toml 1.2.1: from a text, a field of two numbers (`[f64; 2]`) is read from an array of three; the third is left out without an error.
#
# From a `toml::Table` of the same text the array is refused ("invalid length 3"), as serde_json 1.0.154 refuses it. A struct with
# `deny_unknown_fields` and a tuple behave alike.
# Seen with: toml 1.2.1, serde 1.0.229, serde_json 1.0.154: text accepted, table refused, JSON refused.
# Fails when one of them is otherwise.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
mkdir src
cat >Cargo.toml <<'TOML'
[package]
name = "arrays"
version = "0.0.0"
edition = "2021"

[dependencies]
serde = { version = "=1.0.229", features = ["derive"] }
serde_json = "=1.0.154"
toml = "=1.2.1"

[workspace]
TOML
cat >src/main.rs <<'RUST'
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Limits {
    #[allow(dead_code)]
    window: [f64; 2],
}

fn main() {
    let text = "window = [1.0, 2.0, 3.0]";
    let word = |read: bool| if read { "accepted" } else { "refused" };
    let table: toml::Table = text.parse().unwrap();
    println!(
        "{} {} {}",
        word(toml::from_str::<Limits>(text).is_ok()),
        word(table.try_into::<Limits>().is_ok()),
        word(serde_json::from_str::<Limits>(r#"{"window": [1.0, 2.0, 3.0]}"#).is_ok()),
    );
}
RUST
CARGO_TARGET_DIR="$place/target" cargo build --quiet
cargo tree --quiet --depth 1 --prefix none | grep -E "^(toml|serde_json|serde) "
seen=$(target/debug/arrays)
echo "text, table, JSON: $seen"
[ "$seen" = "accepted refused refused" ] || { echo "changed: was accepted refused refused" >&2; exit 1; }
