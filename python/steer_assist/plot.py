"""Figures: functions that draw a result on a matplotlib axis and return it."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.axes import Axes

__all__ = ["basin", "eigen", "plane", "ride", "sweep"]


def axis_of(ax: Axes | None) -> Axes:
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
    ax.set_ylabel(f"{result.rate.attrs['long_name'].removeprefix('disturbance: ').split(' at ')[0]} [rad/s]")
    ax.set_ylim(bottom=0.0)
    return ax


def plane(result: xr.Dataset, /, *, ax: Axes | None = None, **line: Any) -> Axes:
    """The closed border of a basin over steer rate and roll rate."""
    ax = axis_of(ax)
    ax.plot(result.steer_rate_rad_s, result.roll_rate_rad_s, **line)
    ax.set_xlabel("steer rate [rad/s]")
    ax.set_ylabel("roll rate [rad/s]")
    return ax


def ride(result: xr.Dataset, /, *, ax: Axes | None = None, variables: tuple[str, ...] = ("roll_rad", "steer_rad")) -> Axes:
    """Variables of a ride over time, angles in degrees."""
    ax = axis_of(ax)
    for name in variables:
        angle = name.endswith("_rad")
        values = np.degrees(result[name]) if angle else result[name]
        ax.plot(result.time_s, values, label=f"{name.removesuffix('_rad')} [{'deg' if angle else result[name].units}]")
    ax.set_xlabel("time [s]")
    ax.legend()
    return ax


def eigen(result: xr.Dataset, /, *, ax: Axes | None = None) -> Axes:
    """Real (dots) and imaginary (circles) parts of the eigenvalues over forward speed."""
    ax = axis_of(ax)
    ax.plot(result.speed_m_s, result.real_part, "k.", markersize=3)
    imag = result.imag_part.where(result.imag_part > 0.0)
    ax.plot(result.speed_m_s, imag, "C0.", markersize=2, alpha=0.5)
    ax.axhline(0.0, color="grey", linewidth=0.5)
    ax.set_xlabel("forward speed [m/s]")
    ax.set_ylabel("real (black), imaginary (blue) part [1/s]")
    return ax


def sweep(result: xr.Dataset, /, *, ax: Axes | None = None, measure: str = "area", **options: Any) -> Axes:
    """A measure of a sweep over its one or two axes."""
    ax = axis_of(ax)
    values = result[measure].squeeze()
    if values.ndim == 1:
        ax.plot(values[values.dims[0]], values, "o-", **options)
        ax.set_xlabel(values.dims[0])
        ax.set_ylabel(f"{measure} [{values.units}]")
    else:
        values.plot(ax=ax, **options)
    return ax
