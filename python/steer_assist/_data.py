"""Documents as labelled arrays."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

#: Variable of a dataset: dimensions, values, attributes.
Variable = tuple[Any, Any, dict[str, Any]]

UNITS = {"rad": "rad", "rad_s": "rad s-1", "m_s": "m s-1", "nm": "N m", "nm_s": "N m s-1", "s": "s", "j": "J", "1_s": "s-1"}


def variable(dims: Any, values: Any, units: str, about: str) -> Variable:
    return dims, values, {"units": units, "long_name": about}


def unit_of(name: str) -> str:
    """The unit in the end of a name: ``torque_nm``; "1" without one."""
    words = name.split("_")
    ends = ("_".join(words[i:]) for i in range(1, len(words)))
    return next((UNITS[end] for end in ends if end in UNITS), "1")


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
    """The JSON document of a result, as the command line writes it (docs/schema)."""
    return json.loads(result.attrs["document"])


def border(entries: list[dict[str, Any]], speeds: list[float]) -> dict[str, Variable]:
    """The efforts of the rides at the border, over speed."""
    at = {entry["speed"]: entry["effort"] for entry in entries}
    names = list(next(iter(at.values()))) if at else []
    return {
        f"border_{name}": variable(
            "speed_m_s", numbers([at.get(v, {}).get(name) for v in speeds]), unit_of(name), f"{name} of the ride at the border"
        )
        for name in names
    }
