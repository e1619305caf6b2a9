"""Basins over steer rate and roll rate together."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from . import _core, _law
from ._check import threads as as_threads
from ._data import attributes, numbers, variable
from ._progress import Progress, reporting
from ._scenario import text
from .errors import Interrupted


def plane(
    scenario: Any = None, /, *, law: Any = None, threads: int | None = None, progress: Progress = None, **changes: Any
) -> xr.Dataset:
    """Searches the basin at one speed over two disturbances.

    Parameters
    ----------
    scenario, law, threads, progress
        As of :func:`steer_assist.basin`.
    **changes
        Keys of the scenario; those of ``plane`` directly: ``speed`` [m/s], ``rays``, ``max_steer_rate``, ``max_roll_rate`` [rad/s],
        ``points``, ``tolerance`` (part of a ray), ``method``.

    Returns
    -------
    Dataset
        The closed border as ``steer_rate_rad_s`` and ``roll_rate_rad_s`` over ``vertex`` (first vertex repeated at the end, if complete). Over ``ray``:
        the rates at a ray's end, ``reach`` (part of the ray without a fall), ``ray_capped``. Attributes ``area`` [rad^2/s^2],
        ``complete``, ``document``.

    Raises
    ------
    ScenarioError
        With ``key`` and ``range``.
    Interrupted
        After Ctrl-C, with the finished rays in ``result``.
    """
    threads = as_threads(threads)
    data, function = _law.steered(scenario, law, changes, "plane", mirrored=True)
    with reporting(progress, "plane", "ray") as report:
        document_text, interrupted = _core.plane(text(data), function, threads, report)
    result = dataset(document_text)
    if interrupted:
        raise Interrupted("the search was interrupted; .result has the finished rays", result)
    return result


def dataset(document_text: str) -> xr.Dataset:
    """The dataset of a document of ``basin plane``."""
    content = json.loads(document_text)
    outline = np.array(content["outline"], dtype=float).reshape(-1, 2)
    closed = np.concatenate([outline, outline[:1]]) if content["complete"] else outline
    rays = content["rays"]
    variables = {
        "steer_rate_rad_s": variable("vertex", closed[:, 0], "rad s-1", "steer rate at the border"),
        "roll_rate_rad_s": variable("vertex", closed[:, 1], "rad s-1", "roll rate at the border"),
        "end_steer_rate_rad_s": variable("ray", numbers([ray["steer_rate"] for ray in rays]), "rad s-1", "end of the ray"),
        "end_roll_rate_rad_s": variable("ray", numbers([ray["roll_rate"] for ray in rays]), "rad s-1", "end of the ray"),
        "reach": variable("ray", numbers([ray["upper"] for ray in rays]), "1", "part of the ray without a fall"),
        "ray_capped": variable("ray", [bool(ray["capped"]) for ray in rays], "1", "whether reach is a lower bound"),
    }
    attrs = attributes(content, document_text, ["area", "area_capped", "complete"])
    return xr.Dataset(variables, attrs={**attrs, "area_units": "rad2 s-2"})
