"""Figures: functions that draw a result on a matplotlib axis and return it."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ._check import kind
from ._data import require
from .errors import ScenarioError

__all__ = ["basin", "eigen", "plane", "ride", "sweep"]


def axis_of(ax: Axes | None) -> Axes:
    """The axis to draw on.

    Raises
    ------
    ScenarioError
        It is something else.
    """
    if ax is not None and not isinstance(ax, Axes):
        raise ScenarioError(f"ax: {kind(ax)} is no axis of matplotlib", "ax")
    return plt.subplots()[1] if ax is None else ax


def basin(result: xr.Dataset, /, *, ax: Axes | None = None, label: str | None = None, **line: Any) -> Axes:
    """The border of a basin over forward speed; lower bounds as triangles.

    Parameters
    ----------
    result : Dataset
        Of :func:`steer_assist.basin`.
    ax : Axes, optional
        A new one by default.
    label : str, optional
        Entry of the legend.
    **line
        Properties of the line.
    """
    require(result, ("speed_m_s", "height", "capped", "rate"), "basin")
    ax = axis_of(ax)
    speeds, height = result.speed_m_s.values, result.height.values
    (drawn,) = ax.plot(speeds, height, label=label, **line)
    capped = result.capped.values.astype(bool)
    if capped.any():
        ax.plot(speeds[capped], height[capped], "^", color=drawn.get_color())
    if "drawn_quantile" in result:
        low, high = result.drawn_quantile.isel(quantile=0), result.drawn_quantile.isel(quantile=-1)
        ax.fill_between(speeds, low, high, color=drawn.get_color(), alpha=0.2)
    ax.set_xlabel("forward speed [m/s]")
    ax.set_ylabel(f"{result.rate.attrs.get('long_name', 'rate').removeprefix('disturbance: ').split(' at ')[0]} [rad/s]")
    ax.set_ylim(bottom=0.0)
    return ax


def plane(result: xr.Dataset, /, *, ax: Axes | None = None, **line: Any) -> Axes:
    """The closed border of a basin over steer rate and roll rate."""
    require(result, ("steer_rate_rad_s", "roll_rate_rad_s"), "plane")
    ax = axis_of(ax)
    ax.plot(result.steer_rate_rad_s, result.roll_rate_rad_s, **line)
    ax.set_xlabel("steer rate [rad/s]")
    ax.set_ylabel("roll rate [rad/s]")
    return ax


def ride(result: xr.Dataset, /, *, ax: Axes | None = None, variables: tuple[str, ...] = ("roll_rad", "steer_rad")) -> Axes:
    """Variables of a ride over time, angles in degrees."""
    require(result, ("time_s", *variables), "ride")
    ax = axis_of(ax)
    for name in variables:
        angle = name.endswith("_rad")
        values = np.degrees(result[name]) if angle else result[name]
        ax.plot(result.time_s, values, label=f"{name.removesuffix('_rad')} [{'deg' if angle else result[name].attrs.get('units', '1')}]")
    ax.set_xlabel("time [s]")
    ax.legend()
    return ax


def eigen(result: xr.Dataset, /, *, ax: Axes | None = None) -> Axes:
    """Real (dots) and imaginary (circles) parts of the eigenvalues over forward speed."""
    require(result, ("speed_m_s", "real_part", "imag_part"), "eigen")
    ax = axis_of(ax)
    ax.plot(result.speed_m_s, result.real_part, "k.", markersize=3)
    imag = result.imag_part.where(result.imag_part > 0.0)
    ax.plot(result.speed_m_s, imag, "C0.", markersize=2, alpha=0.5)
    ax.axhline(0.0, color="grey", linewidth=0.5)
    ax.set_xlabel("forward speed [m/s]")
    ax.set_ylabel("real (black), imaginary (blue) part [1/s]")
    return ax


def sweep(result: xr.Dataset, /, *, ax: Axes | None = None, measure: str = "area", **options: Any) -> Axes:
    """A measure of a sweep over its one or two axes.

    Raises
    ------
    ScenarioError
        The measure is missing, or has no or more than two axes of more than one value: select one along the others.
    """
    require(result, (measure,), "sweep")
    values = result[measure].squeeze()
    if values.ndim not in (1, 2):
        over = ", ".join(f"{dim} ({size})" for dim, size in values.sizes.items()) or "a single cell"
        raise ScenarioError(f"{measure}: a figure has one or two axes, not {over}; select with .sel() or .isel()", "measure")
    ax = axis_of(ax)
    if values.ndim == 1:
        (dim,) = values.dims
        coordinate = values[dim]
        units = coordinate.attrs.get("units", "1")
        ax.plot(coordinate, values, "o-", **options)
        ax.set_xlabel(coordinate.attrs.get("long_name", str(dim)) + ("" if units == "1" else f" [{units}]"))
        ax.set_ylabel(f"{measure} [{values.attrs.get('units', '1')}]")
    else:
        values.plot(ax=ax, **options)
    return ax
