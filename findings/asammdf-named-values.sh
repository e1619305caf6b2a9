#!/usr/bin/env bash
# asammdf 8.8.28: whether a signal of a CAN log is numbers or text depends on the values that happen to be in the log.
#
# A DBC can name single values of a quantity (`VAL_ 801 Torque -32768 "not known" ;`). extract_bus_logging gives numbers with
# NaN for the named ones, as long as one sample has no name. If all have one, as of a sensor that is not fitted, the same
# signal is an array of bytes, b'not known', whatever `ignore_value2text_conversion` is. Programs that do arithmetic on it fail
# only on such logs: test `samples.dtype.kind == "S"` first.
# Seen with: asammdf 8.8.28: "mixed f, all named S". Fails when it says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
python3 -m venv venv
venv/bin/pip install --quiet asammdf==8.8.28 cantools==45.1.0 python-can==4.6.1
cat >one.dbc <<'DBC'
VERSION ""

NS_ :

BS_:

BU_: Node

BO_ 801 Motion: 2 Node
 SG_ Torque : 0|16@1- (0.002,0) [-65.534|65.534] "N m" Node

VAL_ 801 Torque -32768 "not known" ;
DBC
cat >read.py <<'PY'
import can
from asammdf import MDF

kinds = []
for name, frames in (("mixed", ["0080", "0100"]), ("named", ["0080", "0080"])):
    with can.Logger(f"{name}.mf4") as log:
        for n, data in enumerate(frames):
            log(can.Message(timestamp=1.7e9 + n, arbitration_id=801, is_extended_id=False, data=bytes.fromhex(data), channel=0))
    signals = MDF(f"{name}.mf4").extract_bus_logging({"CAN": [("one.dbc", 0)]}, ignore_value2text_conversion=True)
    kinds.append(signals.get("Torque").samples.dtype.kind)
print("mixed {}, all named {}".format(*kinds))
PY
venv/bin/pip list 2>/dev/null | grep asammdf
seen=$(venv/bin/python read.py)
echo "$seen"
[ "$seen" = "mixed f, all named S" ] || { echo "changed: was mixed f, all named S" >&2; exit 1; }
