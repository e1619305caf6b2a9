"""Recorded rides through the flashed code."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from . import _core
from ._check import path, plain, warn
from ._data import active, attributes, numbers, part, variable
from .errors import ScenarioWarning

#: Units of the rows, by name.
UNITS = {
    "torque": "N m",
    "gain": "N m s rad-1",
    "roll": "rad",
    "roll_bound": "rad",
    "measured_roll_rate": "rad s-1",
    "measured_pitch_rate": "rad s-1",
    "measured_yaw_rate": "rad s-1",
    "measured_steer": "rad",
    "measured_front_speed": "m s-1",
    "measured_rear_speed": "m s-1",
    "wheels_residual": "m s-1",
    "yaw_residual": "rad s-1",
    "steer_residual": "rad",
    "motor_residual": "N m",
    "log_roll": "rad",
    "log_torque": "N m",
}


def replay(recording: str | Path, /, **choices: Any) -> xr.Dataset:
    """Replays a recorded ride through the flashed code, open loop.

    Parameters
    ----------
    recording : path
        A table of samples, CAN frames with ``dbc``, MDF4, or frames (docs/replay.md).
    **choices
        ``map`` (name or file; by default by the columns), ``dbc`` (list of files), ``strict``, ``resample`` ("hold",
        "interpolate"), ``longest_gap_s``, ``preset``, ``law``, ``bicycle``, ``parameters`` (file), ``set`` (list of "KEY=VALUE"), ``faults`` (list), ``seed``,
        ``every_s``.

    Returns
    -------
    Dataset
        The rows of the replay over ``time_s`` [s]: torque [N m], gain, estimated roll [rad], measured values, residuals; NaN where there is none;
        ``mode``; ``limit_active`` and ``cause_active`` as of :func:`steer_assist.ride`. Attributes: durations and peaks of the result, ``document``. See :func:`steer_assist.causes`.

    Raises
    ------
    ScenarioError
        What the recording or the choices lack.
    """
    document_text, rows_text, flags, remarks = _core.replay(path(recording, "recording"), json.dumps(plain(choices)))
    for remark in remarks:
        warn(remark, ScenarioWarning)
    rows = json.loads(rows_text)
    content = json.loads(document_text)
    variables = {
        name: variable("time_s", numbers([row[name] for row in rows]), units, name.replace("_", " "))
        for name, units in UNITS.items()
    }
    bits, names = active(np.array([row["mode"] for row in rows], dtype=np.int8), *flags)
    coords = {"time_s": variable("time_s", numbers([row["t"] for row in rows]), "s", "time in the recording"), **names}
    keys = ["file", "periods", "riding_s", "engaged_s", "limp_s", "fault_s", "peak_torque_nm", "rms_torque_nm", "rate_limited"]
    return xr.Dataset({**variables, **bits}, coords, attributes(content, document_text, keys))


def causes(result: xr.Dataset) -> pd.DataFrame:
    """The causes of a replay that prevented or reduced torque.

    Returns
    -------
    DataFrame
        One row per cause: ``number``, ``name``, ``first_s`` [s], ``count``, ``total_s`` [s], ``alarms``.
    """
    columns = ["number", "name", "first_s", "count", "total_s", "alarms"]
    return pd.DataFrame(part(result, "causes", "replay"), columns=columns)
