"""Laws: data for the simulator, or a function."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ._function import Law, function
from ._scenario import doubt, read, short
from ._scenario import scenario as as_scenario
from .errors import ScenarioError

#: A function as the simulator takes it: its owner, and the address of its code if it is compiled.
Given = tuple[Any, int | None]

#: Roll rates [rad/s], and speeds of basins [m/s], at which a function is tried.
ROLL_RATES = (0.003, 0.03, 0.1, 0.3, 0.5, 1.0, 3.0)
SPEEDS = (2.0, 4.0, 6.0)


def steered(
    scenario: Any, law: Any, changes: dict[str, Any], table: str, mirrored: bool
) -> tuple[dict[str, Any], Given | None]:
    """A scenario with its changes and its law, which is returned apart if it is a function; warns of what is doubtful.

    Raises
    ------
    ScenarioError
        With ``key`` and ``range``.
    """
    base = read(scenario)
    law = base.get("law") if law is None else law
    own = function(law) if callable(law) else None
    base.pop("law", None)
    given = {} if law is None or own is not None else {"law": law}
    data = as_scenario({**base, **given}, **short(changes, table))
    doubt(data)
    if own is not None:
        check(own.call, mirrored, speeds(data, table))
    return data, None if own is None else (own.owner, own.address)


def speeds(data: dict[str, Any], table: str) -> tuple[float, ...]:
    """The speeds at which a function is tried: that of the ride or plane, if there is one."""
    inner = data.get(table) or {}
    one = inner.get("speed_m_s", inner.get("speed"))
    return SPEEDS if one is None else (float(one),)


def check(law: Law, mirrored: bool, speeds: tuple[float, ...]) -> None:
    """Calls a function at some roll rates to both sides, at some speeds.

    Raises
    ------
    ScenarioError
        It returns no finite number, or it is not odd in the roll rate where a search mirrors one side.
    """
    for speed in speeds:
        for roll_rate in ROLL_RATES:
            right, left = torque(law, roll_rate, speed), torque(law, -roll_rate, speed)
            if mirrored and not math.isclose(right, -left, rel_tol=1e-9, abs_tol=1e-12):
                raise ScenarioError(
                    f"law: basins are searched to one side, but the function is not odd in the roll rate: "
                    f"{right} N m at {roll_rate} rad/s, {left} N m at -{roll_rate} rad/s ({speed} m/s)",
                    "law",
                )


def torque(law: Law, roll_rate_rad_s: float, speed_m_s: float) -> float:
    value = law(roll_rate_rad_s, speed_m_s)
    try:
        # An array of one number and a complex number would be converted.
        torque_nm = math.nan if np.ndim(value) > 0 or np.iscomplexobj(value) else float(value)
    except (TypeError, ValueError):
        torque_nm = math.nan
    if not math.isfinite(torque_nm):
        at = f"{roll_rate_rad_s} rad/s and {speed_m_s} m/s"
        raise ScenarioError(f"law: the function returned {value!r} at {at}; a torque in N m is one finite number", "law")
    return torque_nm
