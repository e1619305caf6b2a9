#!/usr/bin/env bash
# asammdf 8.8.28: of a signal that a DBC puts on several pages (`SG_MUL_VAL_ ... 2-9`), only the first page is extracted.
#
# `extract_bus_logging` gives no error and no NaN: the samples of the other pages are missing from the signal. cantools 45.1.0
# decodes all of them.
# Seen with: asammdf 8.8.28, cantools 45.1.0: frames on pages 2, 3 and 9 of a signal on 2 to 9: asammdf 1 sample, cantools 3.
# Fails when either number is another.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
python3 -m venv venv
venv/bin/pip install --quiet asammdf==8.8.28 cantools==45.1.0 canmatrix==1.2 python-can==4.6.1
cat >pages.dbc <<'DBC'
VERSION ""

NS_ :

BS_:

BU_: A

BO_ 261 Paged: 8 A
 SG_ Page M : 0|8@1+ (1,0) [0|255] "" A
 SG_ Value m2 : 8|16@1+ (1,0) [0|65535] "" A

SG_MUL_VAL_ 261 Value Page 2-9;
DBC
cat >pages.py <<'PYTHON'
import can
import cantools
from asammdf import MDF
from can.io.mf4 import MF4Writer

frames = [bytes([page, 7, 0, 0, 0, 0, 0, 0]) for page in (2, 3, 9)]
writer = MF4Writer("pages.mf4", compression_level=0)
writer._start_time = 0.0
for n, data in enumerate(frames):
    writer.on_message_received(can.Message(timestamp=0.01 * n, arbitration_id=261, is_extended_id=False, data=data, channel=0))
writer.stop()
database = cantools.database.load_file("pages.dbc")
decoded = [database.decode_message(261, data) for data in frames]
extracted = MDF("pages.mf4").extract_bus_logging(database_files={"CAN": [("pages.dbc", 0)]})
print(len(extracted.get("Value").samples), sum("Value" in values for values in decoded))
PYTHON
venv/bin/pip list 2>/dev/null | grep -E "^(asammdf|cantools) "
seen=$(venv/bin/python pages.py 2>/dev/null | tail -n 1)
echo "samples of the signal: asammdf, cantools: $seen"
[ "$seen" = "1 3" ] || { echo "changed: was 1 3" >&2; exit 1; }
