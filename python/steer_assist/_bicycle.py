"""Bicycles from dictionaries and from objects of BicycleParameters."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from . import _core
from .errors import ScenarioError

IGNORED = {"v"}  # A forward speed, which BicycleParameters keeps beside the parameters.


def as_bicycle(value: Any) -> Any:
    """A scenario's ``bicycle`` from a name, a file, a scenario's own form, a dictionary, or an object.

    Parameters
    ----------
    value : str, path, mapping, Series or object
        Shipped name, ``FILE`` or ``FILE#NAME``; the 26 benchmark parameters (Meijaard et al. 2007, Table 1, with ``g``;
        SI units, ``lam`` in rad), with or without uncertainties (``uncertainties.ufloat``), in a mapping or in a pandas Series
        with their names as index; or an object of BicycleParameters: ``Bicycle`` or a parameter set.

    Notes
    -----
    Of uncertain parameters the nominal values and the standard deviations are used. Correlations, as of results of other
    ``ufloat``, are not: a draw changes every parameter independently of the others.
    """
    if isinstance(value, (str, Path)):
        return str(value)
    if isinstance(value, (pd.DataFrame, xr.Dataset)):
        kind = type(value).__name__
        raise ScenarioError(f"bicycle: a {kind} is no bicycle; one row or column of a DataFrame, a Series with the parameters, is", "bicycle")
    if isinstance(value, Mapping):
        return value if "parameters" in value else from_parameters(value, str(value.get("name", "own")))
    if isinstance(value, pd.Series):
        name = value.name if isinstance(value.name, str) else "own"
        return from_parameters({str(key): one for key, one in value.items()}, name)
    if isinstance(getattr(value, "parameters", None), Mapping):
        name = getattr(value, "bicycleName", None) or getattr(value, "name", None) or type(value).__name__
        return from_object(benchmark(value), str(name))
    raise ScenarioError(f"bicycle: an object of type {type(value).__name__} is no bicycle", "bicycle")


def benchmark(value: Any) -> Mapping[str, Any]:
    """The benchmark parameters of an object of BicycleParameters."""
    parameters: Mapping[str, Any] = value.parameters
    if "Benchmark" in parameters:
        inner: Mapping[str, Any] = parameters["Benchmark"]
        return inner
    if "IBxx" not in parameters and hasattr(value, "to_parameterization"):
        parameters = value.to_parameterization("Meijaard2007").parameters
    return parameters


def from_object(values: Mapping[str, Any], name: str) -> dict[str, Any]:
    """A scenario's own form of a bicycle from an object's parameters, of which those beside the 26 are checked against these and
    left out, as those of a file are."""
    pairs = {key: (number(key, value), deviation(key, value)) for key, value in values.items()}
    lines = [f"{key} = {value!r}" + (f"+/-{sd!r}" if sd > 0.0 else "") for key, (value, sd) in pairs.items()]
    bicycle: dict[str, Any] = json.loads(_core.bicycle_of_text(name, "\n".join(lines)))
    return bicycle


def from_parameters(values: Mapping[str, Any], name: str) -> dict[str, Any]:
    """A scenario's own form of a bicycle from its benchmark parameters."""
    keys = _core.bicycle_keys()
    given = {key: value for key, value in values.items() if key not in IGNORED | {"name"}}
    unknown = [key for key in given if key not in keys]
    if unknown:
        raise ScenarioError(
            f"bicycle: `{unknown[0]}` is no parameter; the parameters are {', '.join(keys)}", f"bicycle.{unknown[0]}"
        )
    missing = [key for key in keys if key not in given]
    if missing:
        raise ScenarioError(f"bicycle: `{missing[0]}` is missing", f"bicycle.{missing[0]}")
    pairs = {key: (number(key, given[key]), deviation(key, given[key])) for key in keys}
    bicycle: dict[str, Any] = {"name": name, "parameters": {key: value for key, (value, _) in pairs.items()}}
    if any(sd > 0.0 for _, sd in pairs.values()):
        bicycle["measured"] = {"bicycle": [{"value": value, "sd": sd} for value, sd in pairs.values()]}
    return bicycle


def deviation(key: str, value: Any) -> float:
    """The standard deviation of a parameter, 0 of a plain number."""
    sd = float(getattr(value, "std_dev", 0.0))
    if not 0.0 <= sd < math.inf:
        raise ScenarioError(f"bicycle.{key}: a standard deviation of {sd} is no number of at least 0", f"bicycle.{key}")
    return sd


def number(key: str, value: Any) -> float:
    """The nominal value of a parameter."""
    try:
        return float(getattr(value, "nominal_value", value))
    except (TypeError, ValueError):
        raise ScenarioError(f"bicycle.{key}: {value!r} is no number", f"bicycle.{key}") from None
