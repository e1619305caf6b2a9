#!/usr/bin/env bash
# clap 4.6.7, derive: an optional group of options is None, whatever is given, if the group has a flattened group of its own.
#
# `#[command(flatten)] group: Option<Group>` is Some if one of the group's options is on the command line. Not so if `Group` has a
# `#[command(flatten)]` field, too: then its own options are parsed, listed by --help and dropped, without an error or a
# warning, even if one of them is required. A group with a default that is not optional is the way around.
# Known to its authors: clap-rs/clap issue 4697, open.
# Seen with: clap 4.6.7: "plain Some, nested None". Fails when it says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
cargo init --quiet --name finding --vcs none
cargo add --quiet --ignore-rust-version clap@=4.6.7 --features derive
cat >src/main.rs <<'RUST'
use clap::{Args, Parser};

#[derive(Args)]
struct Speed {
    #[arg(long)]
    speed: Option<f64>,
}

#[derive(Args)]
struct Ride {
    #[arg(long, required = true)]
    record: Option<String>,
    #[command(flatten)]
    speed: Speed,
}

#[derive(Parser)]
struct Plain {
    #[command(flatten)]
    group: Option<Speed>,
}

#[derive(Parser)]
struct Nested {
    #[command(flatten)]
    group: Option<Ride>,
}

fn main() {
    let named = |there: bool| if there { "Some" } else { "None" };
    let plain = Plain::parse_from(["finding", "--speed", "3"]).group;
    let plain = named(plain.is_some_and(|group| group.speed == Some(3.0)));
    let nested = Nested::parse_from(["finding", "--record", "a.csv", "--speed", "3"]).group;
    let nested = named(nested.is_some_and(|group| group.record.is_some() && group.speed.speed.is_some()));
    println!("plain {plain}, nested {nested}");
}
RUST
rustc --version
seen=$(cargo run --quiet --ignore-rust-version)
echo "$seen"
[ "$seen" = "plain Some, nested None" ] || { echo "changed: was plain Some, nested None" >&2; exit 1; }
