#!/usr/bin/env bash
# cargo 1.95.0: two clones that share one CARGO_TARGET_DIR can run each other's tests.
#
# The file name of a build's result depends on the package and on its path inside the workspace, not on the workspace's own folder, and a
# result is fresh if no source is newer than it. A second clone whose files are older than the first clone's build is therefore
# not compiled: `cargo test` in the second folder runs the first folder's tests, without a word.
# A review that builds two states of a project into one folder to save time can pass on the wrong one.
# Seen with: cargo 1.95.0 (f2d3ce0bd 2026-03-21): "tests of first" in both folders; "tests of second" with a folder of its own.
# Fails when one of them says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
for name in second first; do
  mkdir -p "$place/$name/src"
  printf '[package]\nname = "one"\nversion = "0.1.0"\nedition = "2024"\n' >"$place/$name/Cargo.toml"
  printf '#[test]\nfn of_which_folder() {\n    println!("tests of %s");\n}\n' "$name" >"$place/$name/src/lib.rs"
done
sleep 2
printed() {
  cd "$place/$1"
  CARGO_TARGET_DIR="$place/$2" cargo test --offline --quiet -- --nocapture 2>/dev/null | grep -o 'tests of .*'
}
cargo --version
first=$(printed first shared)
second=$(printed second shared)
alone=$(printed second own)
echo "shared, first folder: $first; shared, second folder: $second; second folder alone: $alone"
[ "$first/$second/$alone" = "tests of first/tests of first/tests of second" ] || { echo "changed" >&2; exit 1; }
