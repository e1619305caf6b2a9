"""Makes the recordings beside this file, and the values that their signals must have.

    python3 -m venv venv && venv/bin/pip install -r requirements.txt && venv/bin/python make.py

Needs can-utils (log2asc, log2long), too. Every number is made up here; none was recorded.
"""
import csv
import random
import struct
import subprocess
from datetime import datetime, timezone
from math import cos, sin
from pathlib import Path

import can
import cantools
import numpy as np
from asammdf import MDF, Signal
from can.io.asc import ASCWriter
from can.io.blf import BLFWriter
from can.io.canutils import CanutilsLogWriter
from can.io.mf4 import MF4Writer

HERE = Path(__file__).parent
START = 1_700_000_000.0


def raw(value, scale, offset=0.0):
    return round((value - offset) / scale)


def ride():
    """Twenty cycles of 10 ms: four messages 0.25 ms apart, the steer sensor's 4 ms before them."""
    for k in range(20):
        t = 0.00425 + 0.01 * k
        steer = 32767 if k == 7 else raw(8.0 * sin(6.0 * t), 0.1)
        rate = 255 if k == 7 else raw(abs(48.0 * cos(6.0 * t)), 4)
        yield t - 0.00425, 0x2B0, struct.pack("<hBBBBBB", steer, rate, 7, k % 16, 0, 0, 0)
        rates = [raw(a * cos(6.0 * t + p), 0.001) for a, p in ((0.9, 0), (0.1, 1), (1.2, 2))]
        yield t, 0x301, struct.pack(">hhh", *rates)
        accel = [raw(0.4 * sin(9.0 * t), 0.0005), raw(2.0 * sin(6.0 * t), 0.0005), raw(-9.7, 0.0005, -9.81)]
        yield t + 0.00025, 0x302, struct.pack("<hhh", *accel)
        angles = [raw(0.15 * sin(6.0 * t), 0.0001), raw(-0.034, 0.0001), raw(1.9 + 0.2 * t, 0.0001)]
        yield t + 0.0005, 0x303, struct.pack(">hhh", *angles)
        speed = 65535 if k == 19 else raw(4.0 + 0.5 * t, 0.01)
        yield t + 0.00075, 0x304, struct.pack("<H", speed)


def ride_messages():
    return [
        can.Message(timestamp=START + t, arbitration_id=i, is_extended_id=False, data=d, channel="can0")
        for t, i, d in ride()
    ]


def odd_messages():
    """Any bytes for every message of odd.dbc, with every page, both ends and every value that is not known."""
    dice = random.Random(1)
    t, messages = START, []

    def put(i, data, extended=False, **more):
        nonlocal t
        t += 0.0015
        message = can.Message(
            timestamp=round(t, 6), arbitration_id=i, is_extended_id=extended, data=data, channel="can1", **more
        )
        messages.append(message)

    def any_bytes(n):
        return bytes(dice.randrange(256) for _ in range(n))

    for _ in range(6):
        put(0x18FF1234, any_bytes(8), True)
        put(0, any_bytes(2), True)
        put(0x100, any_bytes(8))
        put(0x101, any_bytes(8))
        put(0x102, struct.pack("<f", dice.uniform(-1e3, 1e3)) + struct.pack(">f", dice.uniform(-1e-3, 1e-3)))
        put(0x103, struct.pack("<d", dice.uniform(-1e9, 1e9)))
        put(0x107, any_bytes(64), is_fd=True, bitrate_switch=True)
    for fill in (b"\x00", b"\xff", b"\x80"):
        put(0x18FF1234, fill * 8, True)
        put(0x100, fill * 8)
        put(0x101, fill * 8)
        put(0x107, fill * 64, is_fd=True)
    for page in (0, 1, 0, 1, 2):
        put(0x104, bytes([page]) + any_bytes(7))
    for outer, inner in ((0, 9), (1, 0), (1, 3), (1, 4), (1, 7), (1, 100), (1, 201), (2, 5), (9, 1), (10, 1)):
        put(0x105, bytes([outer, inner]) + any_bytes(6))
    for gap in (b"\x00\x80\xff\x00\x0c\x00\xff\xff\x0f", b"\x01\x80\xfe\x01\x08\x00\xfe\xff\x0e", b"\x64\x00\x05\x01\x00\x00\x10\x00\x00"):
        put(0x106, gap[:3] + bytes([gap[3] | gap[4]]) + gap[6:9] + b"\x00")
    put(0x18FF1234, any_bytes(5), True)  # shorter than its signals
    put(0x555, any_bytes(3))  # in no database
    put(0x555, any_bytes(3))
    put(0x100, b"", is_remote_frame=True, dlc=8)
    messages.append(can.Message(timestamp=round(t + 0.001, 6), is_error_frame=True, channel="can1"))
    return messages


def known(signal, value, bits):
    """Whether the database's text for a raw value says that there is none."""
    words = "".join(c if c.isalnum() else " " for c in str((signal.choices or {}).get(value, ""))).lower().split()
    gap = words in (["sna"], ["not", "known"], ["unknown"], ["not", "available"], ["invalid"], ["signal", "not", "available"])
    return not gap or bits == 1


def expected(messages, database):
    """Rows of row number, message, signal, value: by cantools, one signal at a time, its raw value scaled here."""
    for n, message in enumerate(messages, 1):
        if message.is_remote_frame or message.is_error_frame:
            continue
        try:
            layout = database.get_message_by_frame_id(message.arbitration_id, force_extended_id=message.is_extended_id)
        except KeyError:
            continue
        data = bytes(message.data)
        try:
            values = layout.decode(data, decode_choices=False, scaling=False, allow_truncated=True)
        except cantools.database.errors.DecodeError:
            # A page that the database does not have, of which cantools decodes nothing: what does not depend on it is there.
            values, whole = {}, int.from_bytes(data, "little")
            for signal in sorted(layout.signals, key=lambda signal: signal.multiplexer_ids is not None):
                if signal.multiplexer_ids is None or values.get(signal.multiplexer_signal) in signal.multiplexer_ids:
                    values[signal.name] = whole >> signal.start & (1 << signal.length) - 1
        for signal in layout.signals:
            value = values.get(signal.name)
            if value is None:
                yield n, layout.name, signal.name, "nan"
                continue
            gaps = signal
            as_unsigned = value % (1 << signal.length) if not signal.is_float else value
            if not known(gaps, value, signal.length) or not known(gaps, as_unsigned, signal.length):
                yield n, layout.name, signal.name, "nan"
                continue
            factor, offset = signal.conversion.scale, signal.conversion.offset
            yield n, layout.name, signal.name, repr(float(value) * float(factor) + float(offset))


def write_log(name, messages):
    with CanutilsLogWriter(HERE / f"{name}.log") as log:
        for m in messages:
            log.on_message_received(m)


def write_asc(name, messages):
    writer = ASCWriter(HERE / f"{name}.asc")
    for m in messages:
        m.channel = 0
        writer.on_message_received(m)
    writer.stop()


def write_blf(name, messages, container):
    """Containers of `container` bytes, so that objects continue from one to the next."""
    writer = BLFWriter(HERE / f"{name}.blf")
    writer.max_container_size = container
    for m in messages:
        m.channel = 0
        writer.on_message_received(m)
    writer.stop()


def write_mf4(name, messages, compression):
    writer = MF4Writer(HERE / f"{name}.mf4", compression_level=compression)
    writer._start_time = START
    writer._mdf.header.start_time = datetime.fromtimestamp(START, timezone.utc)
    for m in messages:
        m.channel = 0
        writer.on_message_received(m)
    writer.stop()


def fixed_dates(path):
    """The date of the file instead of today's, so that the same numbers give the same bytes."""
    lines = path.read_text().splitlines(keepends=True)
    date = "Tue Nov 14 22:13:20.000 2023"
    lines = [f"date {date}\n" if line.startswith("date ") else line for line in lines]
    lines = [f"Begin Triggerblock {date}\n" if line.startswith("Begin ") else line for line in lines]
    path.write_text("".join(lines))


def write_channels():
    """Channels that are decoded already: two groups of other rates, conversions, samples that are not valid."""
    mdf = MDF(version="4.10")
    mdf.header.start_time = datetime.fromtimestamp(START, timezone.utc)
    t = np.arange(40) * 0.01 + 0.5
    linear = {"a": 0.001, "b": -0.25}
    raw16 = (np.arange(40) * 100 - 2000).astype("<i2")
    gap = np.zeros(40, dtype=bool)
    gap[3:5] = True
    mdf.append(
        [
            Signal(raw16, t, name="RollRate", unit="rad/s", conversion=linear),
            Signal(np.sin(t).astype("<f4"), t, name="Steer", unit="rad", invalidation_bits=gap),
            Signal((np.arange(40) % 3).astype("u1"), t, name="Mode", unit=""),
            Signal(raw16.astype(">i4"), t, name="BigEndian", unit="N"),
            Signal(np.arange(40).astype("<u8") << 40, t, name="Large", unit=""),
        ],
        comment="fast",
    )
    mdf.groups[0].channel_group.acq_name = "Imu"
    slow = np.arange(8) * 0.05 + 0.52
    mdf.append([Signal(np.cos(slow), slow, name="Speed", unit="m/s")])
    mdf.groups[1].channel_group.acq_name = "Wheel"
    mdf.save(HERE / "channels.mf4", overwrite=True, compression=2)
    mdf.close()


# A logger's file, byte by byte: one group of records of several sorts as they came, not finished when the power went.


def block(name, links, data):
    size = 24 + 8 * len(links) + len(data)
    return name + struct.pack("<IQQ", 0, size, len(links)) + b"".join(struct.pack("<Q", x) for x in links) + data


class File:
    def __init__(self, identification):
        self.bytes = bytearray(identification)

    def put(self, name, links, data):
        self.bytes += b"\0" * (-len(self.bytes) % 8)
        at = len(self.bytes)
        self.bytes += block(name, links, data)
        return at

    def text(self, words):
        words = words.encode() + b"\0"
        return self.put(b"##TX", [], words + b"\0" * (-len(words) % 8))


def channel(file, following, name, kind, sync, data_type, bit, byte, bits, *, parts=0, data=0, conversion=0, unit=0):
    links = [following, parts, file.text(name), 0, conversion, data, unit, 0]
    fields = struct.pack("<BBBBIIIIBBHdddddd", kind, sync, data_type, bit, byte, bits, 0, 0, 0, 0, 0, *[0.0] * 6)
    return file.put(b"##CN", links, fields)


def write_logger(name, messages, finished):
    """As loggers of CAN do: id 1 for data frames, whose bytes are records of id 2, id 3 for remote frames; times in us."""
    identification = (b"MDF     " if finished else b"UnFinMF ") + b"4.11    by hand\0" + bytes(4)
    identification += struct.pack("<H", 411) + bytes(30)
    # Not updated: counts of records, length of the last data block, bytes of variable length.
    identification += struct.pack("<HH", 0 if finished else 0b100101, 0)
    file = File(identification)
    head = file.put(b"##HD", [0] * 6, struct.pack("<QhhBBBBdd", int(START * 1e9), 0, 0, 0, 0, 0, 0, 0.0, 0.0))
    scale = file.put(b"##CC", [0] * 4, struct.pack("<BBHHHdddd", 1, 0, 0, 0, 2, 0.0, 0.0, 0.0, 1e-6))
    variable = file.put(b"##CG", [0] * 6, struct.pack("<QQHHIII", 2, 0, 1, 0, 0, 0, 0))
    following = channel(file, 0, "CAN_DataFrame.DataBytes", 1, 0, 10, 0, 15, 64, data=variable)
    following = channel(file, following, "CAN_DataFrame.EDL", 0, 0, 0, 4, 13, 1)
    following = channel(file, following, "CAN_DataFrame.DataLength", 0, 0, 0, 0, 14, 7)
    following = channel(file, following, "CAN_DataFrame.DLC", 0, 0, 0, 0, 13, 4)
    following = channel(file, following, "CAN_DataFrame.IDE", 0, 0, 0, 7, 12, 1)
    following = channel(file, following, "CAN_DataFrame.ID", 0, 0, 0, 0, 9, 29)
    parts = channel(file, following, "CAN_DataFrame.BusChannel", 0, 0, 0, 0, 8, 8)
    frame = channel(file, 0, "CAN_DataFrame", 0, 0, 10, 0, 8, 120, parts=parts)
    master = channel(file, frame, "Timestamp", 2, 1, 0, 0, 0, 64, conversion=scale, unit=file.text("s"))
    source = file.put(b"##SI", [0] * 3, struct.pack("<BBB5x", 2, 2, 0))
    counts = [sum(not m.is_remote_frame and not m.is_error_frame for m in messages)]
    counts += [sum(m.is_remote_frame for m in messages)]
    counts = counts if finished else [0, 0]
    size = 8 + 1 + 4 + 1 + 1 + 8
    remote_part = channel(file, 0, "CAN_RemoteFrame.ID", 0, 0, 0, 0, 8, 29)
    remote_frame = channel(file, 0, "CAN_RemoteFrame", 0, 0, 10, 0, 8, 32, parts=remote_part)
    remote_master = channel(file, remote_frame, "Timestamp", 2, 1, 0, 0, 0, 64, conversion=scale)
    remote = file.put(
        b"##CG", [variable, remote_master, file.text("CAN"), source, 0, 0], struct.pack("<QQHHIII", 3, counts[1], 6, 46, 0, 12, 0)
    )
    data = file.put(
        b"##CG", [remote, master, file.text("CAN"), source, 0, 0], struct.pack("<QQHHIII", 1, counts[0], 6, 46, 0, size, 0)
    )
    group = file.put(b"##DG", [0, data, 0, 0], struct.pack("<B7x", 1))
    struct.pack_into("<Q", file.bytes, head + 24, group)
    records, place = bytearray(), 0
    for m in messages:
        if m.is_error_frame:
            continue
        us = round((m.timestamp - START) * 1e6)
        identifier = m.arbitration_id | (int(m.is_extended_id) << 31)
        if m.is_remote_frame:
            records += struct.pack("<BQI", 3, us, identifier)
            continue
        flags = can.util.len2dlc(len(m.data)) | int(m.is_fd) << 4
        records += struct.pack("<BQBIBBQ", 1, us, 0, identifier, flags, len(m.data), place)
        records += struct.pack("<BI", 2, len(m.data)) + bytes(m.data)
        place += 4 + len(m.data)
    at = file.put(b"##DT", [], bytes(records))
    struct.pack_into("<Q", file.bytes, group + 40, at)
    if finished:
        struct.pack_into("<Q", file.bytes, variable + 72 + 8, counts[0])
        struct.pack_into("<Q", file.bytes, variable + 72 + 24, place)
    else:
        struct.pack_into("<Q", file.bytes, at + 8, 24)
    (HERE / f"{name}.mf4").write_bytes(file.bytes)


def main():
    for name, messages, compression in (("ride", ride_messages, 0), ("odd", odd_messages, 2)):
        database = cantools.database.load_file(HERE / f"{name}.dbc")
        with open(HERE / f"{name}.expected.csv", "w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(["frame", "message", "signal", "value"])
            rows.writerows(expected(messages(), database))
        write_log(name, messages())
        write_asc(name, messages())
        fixed_dates(HERE / f"{name}.asc")
        write_mf4(name, messages(), compression)
        write_blf(name, messages(), 1000)
    write_logger("logger", odd_messages()[:60], finished=False)
    write_logger("unsorted", odd_messages()[:60], finished=True)
    with MDF(HERE / "logger.mf4") as mdf:
        mdf.save(HERE / "sorted.mf4", overwrite=True, compression=0)
    write_channels()
    asc = subprocess.run(["log2asc", "-n", "-I", "odd.log", "can1"], cwd=HERE, capture_output=True, text=True, check=True)
    (HERE / "log2asc.asc").write_text(asc.stdout)
    with open(HERE / "ride.log") as log:
        text = subprocess.run(["log2long"], stdin=log, capture_output=True, text=True, check=True).stdout
    (HERE / "ride.long.log").write_text(text)


if __name__ == "__main__":
    main()
