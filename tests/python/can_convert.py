"""Writes the frames of a CAN log again, in the formats that python-can knows by the names. Arguments: log, copies."""

import sys

import can

source, *copies = sys.argv[1:]
for copy in copies:
    with can.LogReader(source) as frames, can.Logger(copy) as log:
        for frame in frames:
            frame.channel = 0
            log(frame)
