#!/usr/bin/env bash
# mf4-rs 3.8.0 and mdf4-rs 0.6.0: a record that begins in one data block and ends in the next is lost, and so is the place of
# all that follow it: wrong numbers, and no error.
#
# MDF 4 takes the data blocks of a list as one stretch of bytes; a writer may cut it wherever its buffer is full. Both crates
# cut each block into records by itself (`raw_channel.rs`: "trims any partial record at the end of each block"). The file
# below has six records of 12 bytes in blocks of 30 and 42; asammdf reads all six.
# Seen with: mf4-rs 3.8.0, mdf4-rs 0.6.0, asammdf 8.8.28: 1 1001 -1202590843 2061584302 -1717986919 from both.
# Fails when any of the three says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
python3 -m venv venv
venv/bin/pip install --quiet asammdf==8.8.28
cat >make.py <<'PYTHON'
import struct

import asammdf

file = bytearray(b"MDF     4.10    by hand\0" + bytes(4) + struct.pack("<H", 410) + bytes(34))


def put(name, links, data):
    file.extend(b"\0" * (-len(file) % 8))
    at = len(file)
    file.extend(name + struct.pack("<IQQ", 0, 24 + 8 * len(links) + len(data), len(links)))
    file.extend(b"".join(struct.pack("<Q", link) for link in links) + data)
    return at


def channel(following, name, kind, sync, data_type, byte, bits):
    text = put(b"##TX", [], name.encode().ljust(8, b"\0"))
    fields = struct.pack("<BBBBIIIIBBHdddddd", kind, sync, data_type, 0, byte, bits, 0, 0, 0, 0, 0, *[0.0] * 6)
    return put(b"##CN", [following, 0, text, 0, 0, 0, 0, 0], fields)


header = put(b"##HD", [0] * 6, struct.pack("<QhhBBBBdd", 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0))
history = put(b"##FH", [0, 0], bytes(16))
value = channel(0, "Value", 0, 0, 2, 8, 32)
time = channel(value, "Time", 2, 1, 4, 0, 64)
group = put(b"##CG", [0, time, 0, 0, 0, 0], struct.pack("<QQHHIII", 0, 6, 0, 0, 0, 12, 0))
data_group = put(b"##DG", [0, group, 0, 0], bytes(8))
records = b"".join(struct.pack("<di", 0.01 * k, 1000 * k + 1) for k in range(6))
parts = [put(b"##DT", [], records[:30]), put(b"##DT", [], records[30:])]
blocks = put(b"##DL", [0, *parts], struct.pack("<BBHIQQ", 0, 0, 0, 2, 0, 30))
struct.pack_into("<QQ", file, header + 24, data_group, history)
struct.pack_into("<Q", file, data_group + 40, blocks)
open("split.mf4", "wb").write(file)
print(*asammdf.MDF("split.mf4").get("Value").samples)
PYTHON
cargo init --quiet --name finding --vcs none
cargo add --quiet --ignore-rust-version mf4-rs@=3.8.0 mdf4-rs@=0.6.0
cat >src/main.rs <<'RUST'
fn main() {
    let mdf = mf4_rs::api::mdf::MDF::from_file("split.mf4").unwrap();
    let values = mdf.channel_groups()[0].channels()[1].values().unwrap();
    let numbers = values.iter().map(|value| match value {
        Some(mf4_rs::parsing::decoder::DecodedValue::SignedInteger(n)) => n.to_string(),
        other => format!("{other:?}"),
    });
    println!("{}", numbers.collect::<Vec<_>>().join(" "));
    let mdf = mdf4_rs::MDF::from_file("split.mf4").unwrap();
    let values = mdf.channel_groups()[0].channels()[1].values().unwrap();
    let numbers = values.iter().map(|value| match value {
        Some(mdf4_rs::DecodedValue::SignedInteger(n)) => n.to_string(),
        other => format!("{other:?}"),
    });
    println!("{}", numbers.collect::<Vec<_>>().join(" "));
}
RUST
rustc --version
right=$(venv/bin/python make.py)
seen=$(cargo run --quiet --ignore-rust-version)
echo "asammdf: $right"
echo "mf4-rs, then mdf4-rs: $seen"
[ "$right" = "1 1001 2001 3001 4001 5001" ] || { echo "changed: asammdf no longer reads the six" >&2; exit 1; }
wrong="1 1001 -1202590843 2061584302 -1717986919"
[ "$seen" = "$wrong"$'\n'"$wrong" ] || { echo "changed: both were $wrong" >&2; exit 1; }
