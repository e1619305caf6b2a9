"""Sends the frames of a candump log on a CAN interface, at their times. Arguments: interface, log. Standard library only."""

import socket
import struct
import sys
import time
from pathlib import Path

interface, log = sys.argv[1:]
bus = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
bus.bind((interface,))
start, first = time.monotonic(), None
for line in Path(log).read_text().splitlines():
    stamp, _, frame = line.split()
    at = float(stamp.strip("()"))
    first = at if first is None else first
    time.sleep(max(0.0, at - first - (time.monotonic() - start)))
    identifier, data = frame.split("#")
    data = bytes.fromhex(data)
    bus.send(struct.pack("=IB3x8s", int(identifier, 16), len(data), data))
