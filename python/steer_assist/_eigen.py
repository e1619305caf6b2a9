"""Eigenvalues of the linearised bicycle."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from . import _core
from ._check import plain
from ._data import attributes, variable, words
from ._scenario import doubt, text
from ._scenario import scenario as as_scenario
from .errors import ScenarioError


def eigen(
    scenario: Any = None,
    /,
    *,
    speeds: Sequence[float] | np.ndarray | None = None,
    roots: int | None = None,
    capsize: tuple[float, float] | None = None,
    actuator_delay_s: float = 0.0,
    actuator_lag_s: float = 0.0,
    steer_friction_nm_s_rad: float = 0.0,
    steer_inertia_kg_m2: float = 0.0,
    **changes: Any,
) -> xr.Dataset:
    """Eigenvalues of bicycle, rider and law over forward speed, and the critical speeds.

    Parameters
    ----------
    scenario : mapping, path or Dataset, optional
        Its bicycle, rider and law are used; without a law there is none.
    speeds : sequence of float, optional
        Forward speeds [m/s], 0 to 10 by 0.1; negative ones without law and rider.
    roots : int, optional
        Number of rightmost eigenvalues where a rider or a delay makes infinitely many, 4 to 40, by default 12; without these it can't be
        given.
    capsize : (float, float), optional
        Added capsize term: gain [N s/rad] per speed above the second number [m/s].
    actuator_delay_s, actuator_lag_s, steer_friction_nm_s_rad, steer_inertia_kg_m2 : float
        Between law and steer axis [s, s, N m s/rad, kg m^2].
    **changes
        Keys of the scenario.

    Returns
    -------
    Dataset
        ``real_part`` and ``imag_part`` [1/s] over ``speed_m_s`` and ``root`` (S x N), largest real part first, NaN where there are fewer; ``mode_real``
        and ``mode_imag`` over ``mode``, ``speed_m_s`` and ``part`` (M x S x 2). Attributes ``v_d``, ``v_w``, ``v_c`` [m/s], where they
        exist, and ``document``.

    Raises
    ------
    ScenarioError
        With ``key`` and ``range``.
    """
    choice = {
        "speeds": None if speeds is None else np.atleast_1d(plain(speeds, "speeds")),
        "roots": roots,
        "capsize": capsize,
        "actuator_delay_s": actuator_delay_s,
        "actuator_lag_s": actuator_lag_s,
        "steer_friction_nm_s_rad": steer_friction_nm_s_rad,
        "steer_inertia_kg_m2": steer_inertia_kg_m2,
    }
    if roots is not None and (not isinstance(roots, (int, np.integer)) or not 4 <= roots <= 40):
        raise ScenarioError(f"roots = {roots!r} is no whole number from 4 to 40", "roots", (4.0, 40.0))
    data = as_scenario(scenario, **changes)
    doubt(data)
    document_text = _core.eigen(text(data), json.dumps(plain(choice)))
    return dataset(document_text)


def dataset(document_text: str) -> xr.Dataset:
    """The dataset of a document of ``eigen``."""
    content = json.loads(document_text)
    real, imag = parts(content["eigenvalues"])
    over = ("speed_m_s", "root")
    variables = {
        "real_part": variable(over, real, "s-1", "real part of the eigenvalue"),
        "imag_part": variable(over, imag, "s-1", "imaginary part of the eigenvalue"),
    }
    coords: dict[str, Any] = {"speed_m_s": variable("speed_m_s", content["speeds"], "m s-1", "forward speed")}
    modes = {name: parts(values, 2) for name, values in content["modes"].items()}
    if modes:
        by = ("mode", "speed_m_s", "part")
        variables["mode_real"] = variable(by, np.stack([m[0] for m in modes.values()]), "s-1", "real part, by mode")
        variables["mode_imag"] = variable(by, np.stack([m[1] for m in modes.values()]), "s-1", "imaginary part, by mode")
        coords["mode"] = words("mode", list(modes), "name of the mode")
    return xr.Dataset(variables, coords, attributes(content, document_text, ["v_d", "v_w", "v_c"]))


def parts(values: list[list[list[float]]], width: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Real and imaginary parts per speed, NaN where there are fewer than the most."""
    most = width or max((len(row) for row in values), default=0)
    filled = np.full((2, len(values), most), np.nan)
    for i, row in enumerate(values):
        for j, (re, im) in enumerate(row):
            filled[:, i, j] = re, im
    return filled[0], filled[1]
