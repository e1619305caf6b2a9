"""Basins over a grid of conditions."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from . import _core, _dask
from ._check import kind, plain, warn
from ._check import threads as as_threads
from ._data import attributes, variable
from ._progress import Progress, Report, reporting
from ._scenario import scenario as as_scenario
from ._scenario import short, text
from .errors import Interrupted, ScenarioError, ScenarioWarning

#: Settings whose values have a unit of time as text.
TIMES = {"sensor-delay", "delay"}


def sweep(
    scenario: Any = None,
    /,
    *,
    over: Mapping[str, Sequence[Any]],
    client: Any = None,
    threads: int | None = None,
    progress: Progress = None,
    **changes: Any,
) -> xr.Dataset:
    """Searches a basin in every cell of a grid of conditions.

    Parameters
    ----------
    scenario : mapping, path or Dataset, optional
        What all cells have in common.
    over : mapping of str to sequence
        The axes. A key is that of a scenario (``torque_limit_nm``, ``sensor_delay_s``) or the name of an option (``torque-limit``,
        ``law``, ``set``); values are numbers in the key's unit or text, None is "none". The dimension of an axis is the option's name with
        underscores (``torque_limit``, ``sensor_delay``), its coordinate numbers in the unit of the key, or text if one of them is no number.
    client : dask.distributed.Client, optional
        Computes one task per cell on the client's workers; a task whose worker dies is computed again. The result has the same bytes as
        without.
    threads : int, optional
        Threads per cell; by default one per core, and one in a task of a client.
    progress : bool or callable, optional
        As of :func:`steer_assist.basin`, counted in cells.
    **changes
        Keys of the scenario; those of ``search`` directly.

    Returns
    -------
    Dataset
        Over the axes and ``speed_m_s``: ``height`` [rad/s], ``capped``, ``peak_torque_nm`` [N m] of the ride at the border. Over the axes: ``area``
        [rad m/s^2], ``mean_height`` [rad/s], ``area_capped``. NaN (false) in unfinished cells. Attributes ``complete``, ``document``.

    Raises
    ------
    ScenarioError
        With the cell, its key and range.
    ClientError
        The client is closed, or has lost its cluster.
    Interrupted
        After Ctrl-C, with the finished cells in ``result``.
    """
    if not isinstance(over, Mapping):
        raise ScenarioError(f"over: {kind(over)}; expected a dictionary of axes and their values", "over")
    threads = as_threads(threads)
    axes = [axis(key, values) for key, values in over.items()]
    data = as_scenario(scenario, **short(changes, "search"))
    if client is not None:
        _dask.check(client)
    plan, cells, remarks = _core.sweep_plan(text(data), axes)
    for remark in remarks:
        if remark.startswith("warning: "):
            warn(remark.removeprefix("warning: "), ScenarioWarning)
    units: list[str] = []
    with reporting(progress, "sweep", "cell") as report:
        done = here(cells, threads) if client is None else _dask.units(client, cells, threads or 1)
        interrupted = collect(done, units, len(cells), report)
    result = dataset(_core.sweep_document(plan, units))
    if interrupted:
        raise Interrupted("the sweep was interrupted; .result has the finished cells", result)
    return result


def collect(done: Iterator[str], units: list[str], all: int, report: Report | None) -> bool:
    """Collects finished cells; whether Ctrl-C ended it."""
    try:
        for unit in done:
            units.append(unit)
            if report:
                report(len(units), all)
    except KeyboardInterrupt:
        return True
    return False


def here(cells: list[str], threads: int | None) -> Iterator[str]:
    """The results of cells, one after the other."""
    for cell in cells:
        unit, interrupted = _core.sweep_cell(cell, threads)
        if unit is not None:
            yield unit
        if interrupted:
            raise KeyboardInterrupt


def axis(key: str, values: Any) -> str:
    """An axis in the form of the command line: KEY=VALUES."""
    names = dict(_core.axes())
    name = names.get(key, key.replace("_", "-") if key not in names.values() else key)
    if name not in names.values():
        raise ScenarioError(f"over: {key!r} is no axis; expected one of {', '.join(names)}", key)
    if isinstance(values, (str, Mapping)) or not hasattr(values, "__iter__"):
        raise ScenarioError(f"over[{key!r}] = {values!r}: expected a sequence of values", key)
    items = [item(name, value, f"{key}[{i}]") for i, value in enumerate(values)]
    return f"{name}={','.join(items)}"


def item(name: str, value: Any, key: str) -> str:
    """A value of an axis as text."""
    if isinstance(value, (Mapping, list, tuple)) or callable(value) or np.ndim(value) > 0:
        raise ScenarioError(f"{key}: {kind(value)}; the value of an axis is a number or text, a table the name of its file", key)
    value = plain(value, key)
    if value is None:
        return "none"
    seconds = name in TIMES and not isinstance(value, str)
    return f"{value!r}s" if seconds else str(value).replace(",", "\\,")


def dataset(document_text: str) -> xr.Dataset:
    """The dataset of a document of ``sweep``."""
    content = json.loads(document_text)
    axes, speeds = content["axes"], content["search"]["speeds"]
    dims = [one["key"].replace("-", "_") for one in axes]
    shape = [len(one["values"]) for one in axes]
    found = {tuple(cell["values"]): cell for cell in content["cells"]}
    cells = [found.get(values) for values in itertools.product(*(one["values"] for one in axes))]

    def per_cell(key: str) -> np.ndarray:
        return np.array([np.nan if cell is None else cell[key] for cell in cells], dtype=float).reshape(shape)

    def per_speed(of: Any) -> np.ndarray:
        rows = [[np.nan] * len(speeds) if cell is None else [of(one) for one in cell["found"]] for cell in cells]
        return np.array(rows, dtype=float).reshape([*shape, len(speeds)])

    over = [*dims, "speed_m_s"]
    variables = {
        "height": variable(over, per_speed(lambda one: one["height"]), "rad s-1", "largest disturbance without a fall"),
        "capped": variable(over, per_speed(lambda one: one["capped"]) == 1, "1", "whether height is a lower bound"),
        "peak_torque_nm": variable(
            over, per_speed(lambda one: (one["effort"] or {"peak_torque_nm": np.nan})["peak_torque_nm"]), "N m", "at the border"
        ),
        "area": variable(dims, per_cell("area"), "rad m s-2", "area under the heights"),
        "mean_height": variable(dims, per_cell("mean_height"), "rad s-1", "mean height"),
        "area_capped": variable(dims, per_cell("area_capped") == 1, "1", "whether area and mean are lower bounds"),
    }
    coords = {dim: coordinate(dim, one) for dim, one in zip(dims, axes)}
    coords["speed_m_s"] = variable("speed_m_s", speeds, "m s-1", "forward speed")
    return xr.Dataset(variables, coords, attributes(content, document_text, ["complete"]))


def coordinate(dim: str, axis: dict[str, Any]) -> Any:
    """An axis as numbers in its unit, or as text."""
    about, units, values = _core.axis_coordinate(json.dumps(axis))
    return variable(dim, axis["values"] if values is None else values, units, about)
