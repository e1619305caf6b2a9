"""Scenarios: an experiment as a dictionary."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from . import _core
from ._bicycle import as_bicycle
from ._check import doubt_units, kind, ranged, warn
from ._data import document
from .errors import ScenarioError, ScenarioWarning

START = {"speed_m_s", "steer_rate_rad_s", "roll_rate_rad_s"}
SEARCH = {"speeds", "axis", "max_rate", "scan_step", "tolerance", "method", "adaptive_speeds"}
PLANE = {"speed", "rays", "max_steer_rate", "max_roll_rate", "points", "tolerance", "method"}
#: What the name of a law that was a function begins with.
FUNCTION = "python:"
#: Keys that can be given as keyword arguments, without their table.
SHORT = {"start": START, "search": SEARCH, "plane": PLANE}


def scenario(base: Any = None, /, **changes: Any) -> dict[str, Any]:
    """A scenario with files read and values checked for their kind, as a dictionary.

    Parameters
    ----------
    base : mapping, path or xarray.Dataset, optional
        A scenario as a dictionary, a TOML or JSON file, or a result of this package, which contains its scenario.
    **changes
        Keys that replace those of ``base``; of tables (``start``, ``search``, ``plant``) the given keys only. The keys are those of
        docs/scenario.md; numbers have the unit of the key's name, angles are in radians.

    Raises
    ------
    ScenarioError
        With ``key``, and ``range`` where there is one.
    """
    merged = merge(read(base), changes)
    if "bicycle" in merged:
        merged["bicycle"] = as_bicycle(merged["bicycle"])
    if "law" in merged:
        merged["law"] = as_law(merged["law"])
    data: dict[str, Any] = ranged(merged, lambda tried: _core.check(text(tried)))
    doubt_units(data)
    return data


def as_law(law: Any) -> Any:
    """A law as data: a name, or a table.

    Raises
    ------
    ScenarioError
        It is a function, or the name of one.
    """
    if callable(law):
        raise ScenarioError("law: a function is no data; it goes with ride, basin and plane, as law=", "law")
    if isinstance(law, str) and law.startswith(FUNCTION):
        name = law.removeprefix(FUNCTION)
        raise ScenarioError(f"law: it was the function `{name}`, which a result does not contain; pass it again as law=", "law")
    if isinstance(law, pd.DataFrame):
        return {"name": "table", **{str(name): law[name].to_numpy() for name in law.columns}}
    return {"name": "table", **law} if isinstance(law, Mapping) else law


def short(changes: dict[str, Any], table: str) -> dict[str, Any]:
    """The changes with the keys of ``table`` moved into it."""
    inner = {key: value for key, value in changes.items() if key in SHORT[table]}
    outer = {key: value for key, value in changes.items() if key not in inner}
    return merge(outer, {table: inner}) if inner else outer


def read(base: Any) -> dict[str, Any]:
    """A scenario from any of its forms."""
    if base is None:
        return {}
    if isinstance(base, xr.Dataset):
        base = document(base)
        if "scenario" not in base:
            raise ScenarioError("a result without a scenario, as of sweep, eigen and replay, is no scenario", "scenario")
    if isinstance(base, Mapping):
        return dict(base["scenario"] if "tool" in base and "scenario" in base else base)
    if isinstance(base, (str, Path)):
        content: dict[str, Any] = json.loads(_core.read(base))
        return content
    raise ScenarioError(f"{kind(base)} is no scenario; expected a dictionary, a file, or a result", "scenario")


def merge(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """``base`` with the keys of ``changes``; tables of both are merged."""
    merged = dict(base)
    for key, value in changes.items():
        both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping) and key in {*SHORT, "plant", "fall"}
        merged[key] = merge(merged[key], value) if both else value
    return merged


def text(data: Mapping[str, Any]) -> str:
    """A scenario as the simulator reads it."""
    return json.dumps(data, allow_nan=False)


def doubt(data: Mapping[str, Any]) -> None:
    """Warns of what is doubtful in a scenario that is about to be computed, which is loaded for it."""
    for warning in _core.check(text(data))[2]:
        warn(warning, ScenarioWarning)


def check(base: Any = None, /, **changes: Any) -> dict[str, Any]:
    """Loads and checks all that a scenario names.

    Returns
    -------
    dict
        ``scenario``: with the contents of files in the places of their names; ``config``: the conditions of its rides with
        all defaults; ``warnings`` and ``notes``: lists of text.
    """
    complete, config, warnings, notes = _core.check(text(scenario(base, **changes)))
    return {"scenario": json.loads(complete), "config": json.loads(config), "warnings": warnings, "notes": notes}
