#!/usr/bin/env bash
# python-can 4.6.1: a log in ASC whose header says `timestamps relative` is read as if the times were absolute.
#
# Vector's tools then write the time from one event to the next. The reader keeps the word in `timestamps_format` and never
# uses it ("what is this used for?" in `can/io/asc.py`), so frames of a bus at 100 Hz all get the time 0.01 s: no error, and
# every rate that is computed from them is wrong.
# Seen with: python-can 4.6.1: 0.01 0.01 0.01 for frames at 0.01, 0.02 and 0.03 s.
# Fails when it says something else.
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"
python3 -m venv venv
venv/bin/pip install --quiet python-can==4.6.1
cat >relative.asc <<'ASC'
date Wed Jun 7 10:00:00.000 2023
base hex  timestamps relative
internal events logged
Begin Triggerblock Wed Jun 7 10:00:00.000 2023
   0.000000 Start of measurement
   0.010000 1  304             Rx   d 2 90 01
   0.010000 1  304             Rx   d 2 91 01
   0.010000 1  304             Rx   d 2 92 01
End TriggerBlock
ASC
venv/bin/pip list 2>/dev/null | grep python-can
seen=$(venv/bin/python -c 'import can; print(*(message.timestamp for message in can.ASCReader("relative.asc")))')
echo "times of three frames 0.01 s apart: $seen"
[ "$seen" = "0.01 0.01 0.01" ] || { echo "changed: was 0.01 0.01 0.01" >&2; exit 1; }
