"""The gains of a rider from a perturbation record."""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd
import xarray as xr

from . import _core
from ._check import path, plain
from ._check import threads as as_threads
from ._data import attributes, numbers, variable, words
from ._progress import Progress, reporting
from ._scenario import scenario as as_scenario
from ._scenario import text


#: Units of the gains by the ends of their names: proportional, of the integral, of the first and second derivative.
UNITS = {"p": "N m rad-1", "i": "N m rad-1 s-1", "d": "N m s rad-1", "dd": "N m s2 rad-1"}
#: The unit of variables whose values have several.
MIXED = "1"


@dataclass(frozen=True)
class Identified:
    """A rider, identified from one record.

    Attributes
    ----------
    gains : DataFrame
        Per gain (index): ``value``, ``std_error`` [N m per rad, rad s, rad/s, rad/s^2].
    covariance : DataArray
        Of the gains (G x G), NaN where their errors are not known.
    vaf : float
        Variance accounted for, 1 for a perfect model.
    delay_s, speed_m_s : float
        Neural delay [s] and forward speed [m/s] of the fit.
    document : dict
        The document, as the command line writes it.
    toml : str
        The rider as a file for ``--rider``.
    """

    gains: pd.DataFrame
    covariance: xr.DataArray
    vaf: float
    delay_s: float
    speed_m_s: float
    document: dict[str, Any]
    toml: str

    def dataset(self) -> xr.Dataset:
        """The gains as a Dataset, for files.

        Returns
        -------
        Dataset
            Over ``gain`` (G): ``value``, ``std_error`` (NaN: not known), both in ``gain_unit``; ``covariance`` over ``gain`` and ``other``
            (G x G). Attributes ``vaf``, ``delay_s``, ``speed_m_s``, ``document``.
        """
        names = [str(name) for name in self.covariance["gain"].values]
        values = self.gains.loc[names]
        variables = {
            "value": variable("gain", numbers(values["value"]), MIXED, "gain of the rider"),
            "std_error": variable("gain", numbers(values["std_error"]), MIXED, "standard error of the gain"),
            "covariance": variable(("gain", "other"), self.covariance.values, MIXED, "covariance of the gains"),
        }
        coords = {
            "gain": words("gain", names, "name of the gain"),
            "other": words("other", names, "name of the other gain"),
            "gain_unit": words("gain", [UNITS[name.rsplit("_", 1)[1]] for name in names], "unit of the gain"),
        }
        attrs = attributes(self.document, json.dumps(self.document), ["vaf", "delay_s"])
        return xr.Dataset(variables, coords, {**attrs, "speed_m_s": self.speed_m_s})

    def save(self, path: str | Path) -> Path:
        """Writes the rider's file, for ``rider=path`` and ``--rider``."""
        path = Path(path)
        path.write_text(self.toml)
        return path


def identify(
    record: str | Path,
    /,
    scenario: Any = None,
    *,
    delay_s: float | Literal["estimate"] = 0.03,
    reduce: bool = True,
    threads: int | None = None,
    progress: Progress = None,
    bicycle: Any = None,
    **choices: Any,
) -> Identified:
    """Identifies a rider's feedback gains from a ride that was disturbed (docs/identify.md).

    Parameters
    ----------
    record : path
        A perturbation record: time, lateral force or steer torque, steer; CSV, MDF4, or CAN with ``dbc``.
    scenario : mapping or path, optional
        Its bicycle is used.
    delay_s : float or "estimate"
        Neural delay [s].
    reduce : bool
        Whether gains are left out one by one, to see which are needed.
    threads, progress
        As of :func:`steer_assist.basin`, counted in stages.
    bicycle
        In place of the scenario's.
    **choices
        ``map``, ``dbc``, ``speed_m_s`` [m/s], ``force_at_m`` (ahead, height) [m], ``fit`` (list of "steer", "roll", "roll-rate"), ``gains`` (list of names),
        ``neuromuscular`` (Hz, damping ratio), ``delay_profile_s`` [s], ``drift`` ("none", "offset", "0.05Hz"), ``skip_s`` [s], ``hold``,
        ``filter``, ``linear``, ``select`` ("full", "vaf:90", "onset:90", "aic", "bic", "held"), ``seed``.

    Raises
    ------
    ScenarioError
        What the record or the choices lack.
    KeyboardInterrupt
        After Ctrl-C; one record has no partial result.
    """
    data = as_scenario(scenario, **({} if bicycle is None else {"bicycle": bicycle}))
    threads = as_threads(threads)
    delay = {} if delay_s == "estimate" else {"delay_s": delay_s}
    choice = plain({**choices, **delay, "reduce": reduce})
    with reporting(progress, "identify", "stage") as report:
        document_text, toml = _core.identify(path(record, "record"), text(data), json.dumps(choice), threads, report)
    content = json.loads(document_text)
    names = content["covariance_of"]
    unknown = np.full((len(names), len(names)), np.nan)
    covariance = unknown if content["covariance"] is None else np.array(content["covariance"], dtype=float)
    return Identified(
        gains=pd.DataFrame.from_dict(content["gains"], orient="index"),
        covariance=xr.DataArray(covariance, dims=("gain", "other"), coords={"gain": names, "other": names}),
        vaf=content["vaf"],
        delay_s=content["delay_s"],
        speed_m_s=tomllib.loads(toml)["rows"][0][0],
        document=content,
        toml=toml,
    )
