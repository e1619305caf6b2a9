#!/usr/bin/env bash
# mdf4-rs 0.6.0: of an unsorted file with records of variable length, as loggers of CAN write, records are lost without a word.
#
# Such a file has the bytes of a frame in records of a channel group of variable length (`cg_flags` bit 0: a length of 4 bytes,
# then the bytes). The crate takes the length of those records from the group's block, which says 0 for them, finds itself
# amid the bytes and goes on at the next one that looks like a record's number (`raw_channel.rs`: "try to resync by scanning").
# No error. asammdf reads the file rightly.
# Seen with: mdf4-rs 0.6.0, asammdf 8.8.28: values 10 20 30 40 of group 1 and 7 of group 3; by mdf4-rs 10 30, and none.
# Fails when either says something else.
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


def channel(following, name, kind, sync, data_type, byte, bits, data=0):
    text = put(b"##TX", [], name.encode().ljust(8, b"\0"))
    fields = struct.pack("<BBBBIIIIBBHdddddd", kind, sync, data_type, 0, byte, bits, 0, 0, 0, 0, 0, *[0.0] * 6)
    return put(b"##CN", [following, 0, text, 0, 0, data, 0, 0], fields)


def group(following, first, number, count, flags, size):
    return put(b"##CG", [following, first, 0, 0, 0, 0], struct.pack("<QQHHIII", number, count, flags, 0, 0, size, 0))


# Bytes such as 3 and 2 look like the number of a group.
texts = [bytes([9]), bytes([3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 9]), bytes([9]), bytes([3])]
header = put(b"##HD", [0] * 6, struct.pack("<QhhBBBBdd", 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0))
history = put(b"##FH", [0, 0], bytes(16))
other = group(0, channel(channel(0, "Other", 0, 0, 0, 8, 8), "Time", 2, 1, 4, 0, 64), 3, 1, 0, 9)
variable = group(other, 0, 2, len(texts), 1, sum(4 + len(text) for text in texts))
text = channel(0, "Bytes", 1, 0, 10, 9, 64, variable)
value = channel(text, "Value", 0, 0, 0, 8, 8)
first = group(variable, channel(value, "Time", 2, 1, 4, 0, 64), 1, len(texts), 0, 17)
data_group = put(b"##DG", [0, first, 0, 0], struct.pack("<B7x", 1))
records, at = b"", 0
for n, text in enumerate(texts):
    records += struct.pack("<BdBQ", 1, 0.01 * n, 10 * (n + 1), at) + struct.pack("<BI", 2, len(text)) + text
    at += 4 + len(text)
records += struct.pack("<BdB", 3, 0.05, 7)
data = put(b"##DT", [], records)
struct.pack_into("<QQ", file, header + 24, data_group, history)
struct.pack_into("<Q", file, data_group + 40, data)
open("unsorted.mf4", "wb").write(file)
mdf = asammdf.MDF("unsorted.mf4")
print(*mdf.get("Value").samples, "and", *mdf.get("Other").samples)
PYTHON
cargo init --quiet --name finding --vcs none
cargo add --quiet --ignore-rust-version mdf4-rs@=0.6.0
cat >src/main.rs <<'RUST'
use mdf4_rs::{DecodedValue, MDF};

fn main() {
    let mdf = MDF::from_file("unsorted.mf4").unwrap();
    let values = |name: &str| {
        let groups = mdf.channel_groups();
        let channels = groups.iter().flat_map(|group| group.channels()).collect::<Vec<_>>();
        let channel = channels.iter().find(|channel| channel.name().unwrap().as_deref() == Some(name)).unwrap();
        let text = |value: &Option<DecodedValue>| match value {
            Some(DecodedValue::UnsignedInteger(n)) => n.to_string(),
            other => format!("{other:?}"),
        };
        channel.values().unwrap().iter().map(text).collect::<Vec<_>>().join(" ")
    };
    println!("{} and {}", values("Value"), values("Other"));
}
RUST
rustc --version
right=$(venv/bin/python make.py)
seen=$(cargo run --quiet --ignore-rust-version)
echo "asammdf: $right; mdf4-rs: $seen"
[ "$right" = "10 20 30 40 and 7" ] || { echo "changed: asammdf no longer reads all" >&2; exit 1; }
[ "$seen" = "10 30 and " ] || { echo "changed: was 10 30, and none" >&2; exit 1; }
