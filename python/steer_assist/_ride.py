"""One ride."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from . import _core, _law
from ._data import active, attributes, variable
from ._scenario import text
from .errors import Interrupted

ABOUT = {
    "roll_rad": "roll, to the right",
    "steer_rad": "steer, to the right",
    "pitch_rad": "pitch of the rear frame",
    "roll_rate_rad_s": "roll rate",
    "steer_rate_rad_s": "steer rate",
    "yaw_rate_rad_s": "yaw rate",
    "rear_wheel_rate_rad_s": "rear wheel rate, negative forward",
    "rear_speed_m_s": "forward speed of the rear wheel",
    "front_speed_m_s": "forward speed of the front wheel",
    "measured_roll_rate_rad_s": "roll rate that the controller measures",
    "measured_speed_m_s": "speed that the controller measures",
    "torque_nm": "steer torque commanded by the assist, to the right",
    "rider_torque_nm": "steer torque of the rider, to the right",
    "motor_torque_nm": "steer torque of the motor, to the right",
}


def ride(scenario: Any = None, /, *, law: Any = None, **changes: Any) -> xr.Dataset:
    """Rides once after a disturbance, until a fall or the time limit.

    Parameters
    ----------
    scenario : mapping, path or Dataset, optional
        The experiment; see :func:`steer_assist.scenario`.
    law : str, mapping, DataFrame or callable, optional
        Name of a law, a table (``speed_m_s``, ``gain_nm_s_rad``), or a function ``f(roll_rate_rad_s, speed_m_s) ->
        torque_nm`` of two numbers, positive steering to the right: of Python, or, much faster, compiled: of ``numba.njit``, of
        ``numba.cfunc("float64(float64, float64)")``, or of ctypes with doubles. A compiled one must be pure, callable from any thread,
        and raise nothing. A function is the ideal path: continuous, with exact sensors, no limits, called about 24,000 times in a
        ride of 6 s (docs/python.md).
    **changes
        Keys of the scenario; those of ``start`` directly: ``speed_m_s`` [m/s], ``steer_rate_rad_s``, ``roll_rate_rad_s`` [rad/s].

    Returns
    -------
    Dataset
        Variables over ``time_s`` [s], one point per control period (T): angles [rad], rates [rad/s], speeds [m/s], torques [N m],
        ``mode``; ``limit_active`` over ``limit`` (T x L) and ``cause_active`` over ``cause`` (T x C), 1 where active; ``cause_number``.
        Attributes ``outcome`` ("fallen", "recovered", "undecided"), ``time_to_fall_s`` (of a fall),
        ``effort`` entries such as ``peak_torque_nm``, and ``document``.

    Raises
    ------
    ScenarioError
        With ``key`` and ``range``.
    Interrupted
        After Ctrl-C; a ride has no partial result.
    """
    data, function = _law.steered(scenario, law, changes, "start", mirrored=False)
    ridden = _core.ride(text(data), function)
    if ridden is None:
        raise Interrupted("the ride was interrupted")
    return dataset(*ridden)


def dataset(document: str, columns: dict[str, bytes]) -> xr.Dataset:
    """The dataset of a document of ``ride`` and the columns of its record."""
    time = np.frombuffer(columns.pop("time_s"))
    mode = np.frombuffer(columns.pop("mode"), dtype=np.int8)
    bits, names = active(mode, columns.pop("limit_active"), columns.pop("cause_active"))
    values = {
        name: variable("time_s", np.frombuffer(column), _core.unit_of(name), ABOUT[name]) for name, column in columns.items()
    }
    content = json.loads(document)
    keys = ["outcome", "time_to_fall_s", "fall"]
    attrs = {**attributes(content, document, keys), **content["effort"]}
    coords = {"time_s": variable("time_s", time, "s", "time since the disturbance"), **names}
    return xr.Dataset({**values, **bits}, coords, attrs)
