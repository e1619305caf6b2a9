"""Laws: data for the simulator, or a Python function."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from .errors import ScenarioError

#: ``f(roll_rate_rad_s, speed_m_s) -> torque_nm``
Law = Callable[[float, float], float]


def split(law: Any) -> tuple[Any, Law | None]:
    """The law as data and as a function, of which at most one is given."""
    if callable(law):
        return None, law
    if isinstance(law, Mapping):
        return {"name": "table", **law}, None
    if hasattr(law, "to_dict") and hasattr(law, "columns"):
        return {"name": "table", **{name: law[name].to_numpy() for name in law.columns}}, None
    return law, None


def check(law: Law | None, mirrored: bool) -> None:
    """Calls a function at one roll rate to both sides.

    Raises
    ------
    ScenarioError
        It returns no finite number, or it is not odd in the roll rate where a search mirrors one side.
    """
    if law is None:
        return
    right, left = (torque(law, roll_rate) for roll_rate in (0.5, -0.5))
    if mirrored and not math.isclose(right, -left, rel_tol=1e-9, abs_tol=1e-12):
        raise ScenarioError(
            f"law: basins are searched to one side, but the function is not odd in the roll rate: "
            f"{right} N m at 0.5 rad/s, {left} N m at -0.5 rad/s (4 m/s)",
            "law",
        )


def torque(law: Law, roll_rate_rad_s: float) -> float:
    value = law(roll_rate_rad_s, 4.0)
    try:
        torque_nm = float(value)
    except (TypeError, ValueError):
        raise ScenarioError(f"law: the function returned {value!r}, not a torque in N m", "law") from None
    if not math.isfinite(torque_nm):
        raise ScenarioError(f"law: the function returned {torque_nm} at {roll_rate_rad_s} rad/s and 4 m/s", "law")
    return torque_nm
