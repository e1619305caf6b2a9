"""Basins of attraction over forward speed."""

from __future__ import annotations

import json
from typing import Any

import pandas as pd
import xarray as xr

from . import _core, _law
from ._check import threads as as_threads
from ._data import attributes, border, numbers, part, table, variable, words
from ._progress import Progress, reporting
from ._scenario import text
from .errors import Interrupted


def basin(
    scenario: Any = None, /, *, law: Any = None, threads: int | None = None, progress: Progress = None, **changes: Any
) -> xr.Dataset:
    """Searches the basin of attraction: the disturbances, over forward speed, from which a ride does not fall.

    Parameters
    ----------
    scenario, law
        As of :func:`steer_assist.ride`; a function must be odd in the roll rate; one of Python computes on one
        thread, a compiled one on all.
    threads : int, optional
        Number of threads; by default one per core. The result does not depend on it.
    progress : bool or callable, optional
        None: a bar on a terminal; True: a bar; False: none; a function gets the numbers of finished and of all columns.
    **changes
        Keys of the scenario; those of ``search`` directly: ``speeds`` [m/s] ("A:B:STEP" or a sequence), ``axis`` ("steer-rate",
        "roll-rate"), ``max_rate``, ``scan_step``, ``tolerance`` [rad/s], ``method``, ``adaptive_speeds``.

    Returns
    -------
    Dataset
        Over ``speed_m_s`` (S): ``height`` [rad/s], the largest disturbance from which nothing falls; ``capped``, whether it is a lower
        bound; efforts ``border_*`` of the ride there. Over ``speed_m_s`` and ``rate`` [rad/s] (S x R), the rides of the scan:
        ``outcome``, ``time_to_fall_s`` (NaN: no fall), ``fall``. Of draws (``uncertain``, ``rider_draws``): ``drawn_height`` (draw x S),
        ``drawn_quantile`` (S x 3). Attributes ``area`` [rad m/s^2], ``mean_height`` [rad/s], ``complete``, ``document``.

    Raises
    ------
    ScenarioError
        With ``key`` and ``range``.
    Interrupted
        After Ctrl-C, with the finished speeds in ``result``.
    """
    threads = as_threads(threads)
    data, function = _law.steered(scenario, law, changes, "search", mirrored=True)
    with reporting(progress, "basin", "column") as report:
        document_text, interrupted = _core.basin(text(data), function, threads, report)
    result = dataset(document_text)
    if interrupted:
        raise Interrupted("the basin was interrupted; .result has the finished speeds", result)
    return result


def dataset(document_text: str) -> xr.Dataset:
    """The dataset of a document of ``basin``."""
    content = json.loads(document_text)
    speeds, scan = content["speeds"], content["map"]
    width, over = len(scan["rates"]), ("speed_m_s", "rate")
    variables = {
        "height": variable("speed_m_s", numbers(content["height"]["upper"]), "rad s-1", "largest disturbance without a fall"),
        "capped": variable("speed_m_s", [bool(value) for value in content["capped"]], "1", "whether height is a lower bound"),
        **border(content["border"], speeds),
        "outcome": words(over, table(scan["outcome"], width, "", "<U9"), "outcome of the ride"),
        "time_to_fall_s": variable(over, table(scan["time_to_fall_s"], width, float("nan"), float), "s", "time to the fall"),
        "fall": words(over, table(scan["fall"], width, "", "<U9"), "reason of the fall"),
    }
    coords = {
        "speed_m_s": variable("speed_m_s", speeds, "m s-1", "forward speed"),
        "rate": variable("rate", scan["rates"], "rad s-1", f"disturbance: {content['search']['axis']} at t = 0"),
    }
    drawn = content["uncertain"] or content["rider_draws"]
    if drawn:
        variables["drawn_height"] = variable(("draw", "speed_m_s"), drawn["heights"], "rad s-1", "height of each draw")
        variables["drawn_quantile"] = variable(("speed_m_s", "quantile"), drawn["upper"], "rad s-1", "quantiles of the height")
        coords["quantile"] = variable("quantile", drawn["quantiles"], "1", "probability")
    attrs = attributes(content, document_text, ["area", "mean_height", "area_capped", "complete"])
    units = {"area_units": "rad m s-2", "mean_height_units": "rad s-1"}
    return xr.Dataset(variables, coords, {**attrs, **units})


def islands(result: xr.Dataset) -> pd.DataFrame:
    """Ranges of disturbances outside a basin from which a ride does not fall either.

    Returns
    -------
    DataFrame
        Columns ``speed_m_s`` [m/s], ``from_rad_s`` and ``to_rad_s`` [rad/s]; one row per island, which has a mirror image.
    """
    rows = [(row["speed"], row["from"], row["to"]) for row in part(result, "islands", "basin")]
    return pd.DataFrame(rows, columns=["speed_m_s", "from_rad_s", "to_rad_s"])
