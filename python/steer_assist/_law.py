"""Laws: data for the simulator, or a Python function."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from ._scenario import doubt, short
from ._scenario import scenario as as_scenario
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


#: Roll rates [rad/s] and speeds [m/s] at which a function is tried.
ROLL_RATES = (0.003, 0.03, 0.1, 0.3, 0.5, 1.0, 3.0)
SPEEDS = (2.0, 4.0, 6.0)


def steered(
    scenario: Any, law: Any, changes: dict[str, Any], table: str, mirrored: bool
) -> tuple[dict[str, Any], Law | None]:
    """A scenario with its changes and its law, which is returned apart if it is a function; warns of what is doubtful.

    Raises
    ------
    ScenarioError
        With ``key`` and ``range``.
    """
    law, function = split(law)
    data = as_scenario(scenario, **short({**changes, **({} if law is None else {"law": law})}, table))
    if function is not None:
        # It replaces the law of a scenario that is used again.
        data.pop("law", None)
        check(function, mirrored)
    doubt(data)
    return data, function


def check(law: Law, mirrored: bool) -> None:
    """Calls a function at some roll rates to both sides.

    Raises
    ------
    ScenarioError
        It returns no finite number, or it is not odd in the roll rate where a search mirrors one side.
    """
    for speed in SPEEDS:
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
        torque_nm = float(value)
    except (TypeError, ValueError):
        raise ScenarioError(f"law: the function returned {value!r}, not a torque in N m", "law") from None
    if not math.isfinite(torque_nm):
        raise ScenarioError(f"law: the function returned {torque_nm} at {roll_rate_rad_s} rad/s and {speed_m_s} m/s", "law")
    return torque_nm
