"""The gains of a rider from a perturbation record."""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import pandas as pd
import xarray as xr

from . import _core
from ._check import plain
from ._progress import Progress, reporting
from ._scenario import scenario as as_scenario
from ._scenario import text


@dataclass(frozen=True)
class Identified:
    """A rider, identified from one record.

    Attributes
    ----------
    gains : DataFrame
        Per gain (index): ``value``, ``std_error`` [N m per rad, rad s, rad/s, rad/s^2].
    covariance : DataArray
        Of the gains (G x G).
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
    delay = {} if delay_s == "estimate" else {"delay_s": delay_s}
    choice = plain({**choices, **delay, "reduce": reduce})
    with reporting(progress, "identify", "stage") as report:
        document_text, toml = _core.identify(str(record), text(data), json.dumps(choice), threads, report)
    content = json.loads(document_text)
    names = content["covariance_of"]
    return Identified(
        gains=pd.DataFrame.from_dict(content["gains"], orient="index"),
        covariance=xr.DataArray(content["covariance"], dims=("gain", "other"), coords={"gain": names, "other": names}),
        vaf=content["vaf"],
        delay_s=content["delay_s"],
        speed_m_s=tomllib.loads(toml)["rows"][0][0],
        document=content,
        toml=toml,
    )
