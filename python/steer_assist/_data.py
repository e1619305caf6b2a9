"""Documents as labelled arrays."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from . import _core
from ._check import kind
from .errors import ScenarioError

#: Variable of a dataset: dimensions, values, attributes.
Variable = tuple[Any, Any, dict[str, Any]]


def variable(dims: Any, values: Any, units: str, about: str) -> Variable:
    return dims, values, {"units": units, "long_name": about}


def flags(dims: Any, values: Any, meanings: Sequence[str], about: str) -> Variable:
    """Flags as in the NetCDF files: a byte each, the index of a meaning."""
    attrs = {
        "flag_values": np.arange(len(meanings), dtype=np.int8),
        "flag_meanings": " ".join(meanings),
    }
    return dims, values, {"long_name": about, **attrs}


def words(dims: Any, values: Any, about: str) -> Variable:
    """Words, which have no unit."""
    return dims, values, {"long_name": about}


def active(mode: np.ndarray, limit_active: bytes, cause_active: bytes) -> tuple[dict[str, Variable], dict[str, Variable]]:
    """The mode, and limits and causes as a flag each over ``time_s``: variables and coordinates."""
    modes, states, limits, causes = _core.flags()
    over = {
        name: np.frombuffer(values, dtype=np.int8).reshape(-1, len(names))
        for name, values, names in (("limit", limit_active, limits), ("cause", cause_active, causes))
    }
    variables = {
        "mode": flags("time_s", mode.astype(np.int8), modes, "mode of the controller"),
        "limit_active": flags(("time_s", "limit"), over["limit"], states, "whether a limit changed the torque"),
        "cause_active": flags(("time_s", "cause"), over["cause"], states, "whether a cause prevented or reduced torque"),
    }
    coords = {
        "limit": words("limit", limits, "limits of the torque"),
        "cause": words("cause", [name for name, _ in causes], "causes that prevent or reduce torque"),
        "cause_number": variable("cause", np.array([number for _, number in causes], dtype=np.int8), "1", "number of the cause"),
    }
    return variables, coords


def numbers(values: Any) -> np.ndarray:
    """Numbers with NaN for None."""
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def table(rows: list[list[Any]], width: int, missing: Any, dtype: Any) -> np.ndarray:
    """Rows of a width, ``missing`` for None and for rows that were not computed."""
    filled = [[missing if value is None else value for value in row] or [missing] * width for row in rows]
    return np.array(filled, dtype=dtype).reshape(len(rows), width)


def attributes(document: dict[str, Any], text: str, keys: list[str]) -> dict[str, Any]:
    """Attributes of a dataset: these entries of a document, and the document itself."""
    tool = document["tool"]
    entries = {key: document[key] for key in keys if document.get(key) is not None}
    entries.update({key: float("nan") for key in ("area", "mean_height") if key in keys and document.get(key) is None})
    # Files have no attributes that are true or false.
    entries = {key: int(value) if isinstance(value, bool) else value for key, value in entries.items()}
    source = f"{tool['name']} {tool['version']} ({tool['commit']})"
    return {**entries, "source": source, "document": text}


def document(result: xr.Dataset) -> dict[str, Any]:
    """The JSON document of a result, as the command line writes it (docs/schema).

    Raises
    ------
    ScenarioError
        It is no result of this package, which has the attribute ``document``.
    """
    if not isinstance(result, xr.Dataset) or "document" not in result.attrs:
        what = "a Dataset without it" if isinstance(result, xr.Dataset) else kind(result)
        raise ScenarioError(f"result: a result of this package has the attribute `document`; {what} is none", "result")
    try:
        content: dict[str, Any] = json.loads(result.attrs["document"])
    except (TypeError, ValueError):
        raise ScenarioError("result: its attribute `document` is no JSON", "result") from None
    return content


def part(result: xr.Dataset, name: str, of: str) -> Any:
    """An entry of the document of a result of the function ``of``.

    Raises
    ------
    ScenarioError
        It is no such result.
    """
    content = document(result)
    if name not in content:
        raise ScenarioError(f"result: no result of {of}, whose document has `{name}`", "result")
    return content[name]


def require(result: Any, names: Iterable[str], of: str) -> None:
    """Refuses what is no Dataset with these variables, as those of the function ``of`` are.

    Raises
    ------
    ScenarioError
        With the missing variables.
    """
    if not isinstance(result, xr.Dataset):
        raise ScenarioError(f"result: {kind(result)}; expected a Dataset of {of}", "result")
    missing = [f"`{name}`" for name in names if name not in result.variables]
    if missing:
        raise ScenarioError(f"result: no Dataset of {of}: it has no {' and no '.join(missing)}", "result")


def border(entries: list[dict[str, Any]], speeds: list[float]) -> dict[str, Variable]:
    """The efforts of the rides at the border, over speed."""
    at = {entry["speed"]: entry["effort"] for entry in entries}
    names = list(next(iter(at.values()))) if at else []
    return {
        f"border_{name}": variable(
            "speed_m_s", numbers([at.get(v, {}).get(name) for v in speeds]), _core.unit_of(name), f"{name} of the ride at the border"
        )
        for name in names
    }
