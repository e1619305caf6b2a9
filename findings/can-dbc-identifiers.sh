#!/usr/bin/env bash
# can-dbc 10.0.0: the place where Vector's tools keep signals of no message becomes the message of the extended identifier 0.
#
# `BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG` is in most databases of those tools; its number, 0xC0000000, is no identifier.
# The crate takes the lower 29 bits, so a bus on which the identifier 0 is used gets signals that were never on it. cantools
# 45.1.0 leaves the message out. (An identifier above 2047 without the mark of 29 bits, which cantools refuses, is cut to
# 16 bits in the same function.)
# Seen with: can-dbc 10.0.0: Extended(0) VECTOR__INDEPENDENT_SIG_MSG; cantools 45.1.0: no message.
# Fails when either says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
cat >independent.dbc <<'DBC'
VERSION ""

NS_ :

BS_:

BU_: A

BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX
 SG_ Nowhere : 0|8@1+ (1,0) [0|0] "" Vector__XXX
DBC
python3 -m venv venv
venv/bin/pip install --quiet cantools==45.1.0
cargo init --quiet --name finding --vcs none
cargo add --quiet can-dbc@=10.0.0
cat >src/main.rs <<'RUST'
fn main() {
    let dbc = can_dbc::Dbc::try_from(std::fs::read_to_string("independent.dbc").unwrap().as_str()).unwrap();
    for message in dbc.messages {
        println!("{:?} {}", message.id, message.name);
    }
}
RUST
rustc --version
seen=$(cargo run --quiet --release)
other=$(venv/bin/python -c 'import cantools; print(len(cantools.database.load_file("independent.dbc").messages))')
echo "can-dbc: $seen; cantools: $other messages"
[ "$seen" = "Extended(0) VECTOR__INDEPENDENT_SIG_MSG" ] || { echo "changed: was Extended(0)" >&2; exit 1; }
[ "$other" = 0 ] || { echo "changed: cantools had no message" >&2; exit 1; }
