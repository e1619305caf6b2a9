"""Compares every signal that cantools decodes with the firmware's decoder. Arguments: DBC, JSON list of frames.

Each frame has `id`, `bytes` (hexadecimal) and `signals` (name to number, or to the name of a value). The same with the KCD
that `cantools convert` makes of the DBC. Prints the number of compared values.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import cantools

dbc, frames = sys.argv[1:]
frames = json.loads(Path(frames).read_text())


def same(got, expected):
    if isinstance(expected, str):
        return str(got) == expected
    return not isinstance(got, str) and abs(float(got) - expected) <= 1e-6 * (1 + abs(expected))


def compared(database):
    count = 0
    for frame in frames:
        got = database.decode_message(frame["id"], bytes.fromhex(frame["bytes"]))
        assert got.keys() == frame["signals"].keys(), (got.keys() ^ frame["signals"].keys(), frame)
        for name, expected in frame["signals"].items():
            assert same(got[name], expected), (name, got[name], expected, frame["bytes"])
        count += len(got)
    return count


database = cantools.database.load_file(dbc)
units = {"Speed": "m/s", "RollRate": "rad/s", "Steer": "rad", "TorqueCommanded": "N m", "TorqueMeasured": "N m"}
for message in database.messages:
    assert message.cycle_time == 20 and message.length == 8 and message.comment, message
    for signal in message.signals:
        assert signal.comment and signal.minimum is not None and signal.maximum is not None, signal
        assert (signal.unit or "") == units.get(signal.name, ""), signal
causes = {message.name: message for message in database.messages}["Causes"]
assert {bit: name for bit, name in database.dbc.value_tables["Cause"].items()} == {
    signal.start: signal.name for signal in causes.signals
}

with tempfile.TemporaryDirectory() as folder:
    kcd = str(Path(folder) / "assist.kcd")
    subprocess.run([sys.executable, "-m", "cantools", "convert", dbc, kcd], check=True)
    print(compared(database) + compared(cantools.database.load_file(kcd)))
