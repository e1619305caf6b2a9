"""Values of a scenario as plain data; what is wrong with them, by key."""

from __future__ import annotations

import math
import os
import sys
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .errors import ScenarioError, UnitsWarning

#: Magnitudes above which a value is probably not in its unit, by the end of its key.
SUSPICIOUS = [
    ("roll_rate_rad_s", 10.0, "rad/s"),
    ("steer_rate_rad_s", 40.0, "rad/s"),
    ("max_roll_rate", 60.0, "rad/s"),
    ("max_steer_rate", 60.0, "rad/s"),
    ("search.max_rate", 60.0, "rad/s"),
    ("_rad", 2.0 * math.pi, "rad"),
    (".lam", 1.4, "rad"),
]


def plain(value: Any, key: str = "", largest: float | None = None) -> Any:
    """The value as dictionaries, lists, numbers and text; None is left out of dictionaries. ``largest`` takes the place of numbers that
    are not finite; without it they are rejected.

    Raises
    ------
    ScenarioError
        A number that is not finite, an array of more than one dimension, or a value of another kind, with its key.
    """
    if isinstance(value, Mapping):
        inner = {str(name): plain(item, f"{key}.{name}" if key else str(name), largest) for name, item in value.items()}
        return {name: item for name, item in inner.items() if item is not None}
    if isinstance(value, np.ndarray) or (hasattr(value, "to_numpy") and not isinstance(value, str)):
        return listed(np.asarray(value), key, largest)
    if isinstance(value, (list, tuple, range)):
        return [plain(item, f"{key}[{i}]", largest) for i, item in enumerate(value)]
    if isinstance(value, np.generic):
        return plain(value.item(), key, largest)
    if isinstance(value, float) and not math.isfinite(value):
        if largest is not None:
            return largest
        raise ScenarioError(f"{key} = {value} is not a finite number", key)
    if isinstance(value, Path):
        return str(value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise ScenarioError(f"{key}: {kind(value)} is no value of a scenario", key)


def ranged(value: Any, check: Callable[[Any], object]) -> Any:
    """As :func:`plain`; the error of a number that is not finite has the range that ``check`` names for the largest number in its
    place.

    Raises
    ------
    ScenarioError
        As of :func:`plain`.
    """
    try:
        return plain(value)
    except ScenarioError as error:
        try:
            check(plain(value, largest=sys.float_info.max))
        except ScenarioError as other:
            if other.range is not None and other.key == error.key:
                least, most = other.range
                raise ScenarioError(f"{error}; the range is {least:g} to {most:g}", error.key, other.range) from None
        raise


def kind(value: Any) -> str:
    """The kind of a value, with its article: "an int"."""
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiouAEIOU' else 'a'} {name}"


def path(file: Any, key: str) -> str:
    """The name of a file.

    Raises
    ------
    ScenarioError
        It is something else, such as a table that was already read.
    """
    if not isinstance(file, (str, os.PathLike)):
        raise ScenarioError(f"{key}: {kind(file)} is no file; expected its name", key)
    return os.fsdecode(file)


def warn(message: str, category: type[Warning]) -> None:
    """A warning at the line outside of this package that called it."""
    inside, frame, level = os.path.dirname(__file__), sys._getframe(1), 2
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == inside:
        frame, level = frame.f_back, level + 1
    warnings.warn(message, category, stacklevel=level)


def threads(number: int | None) -> int | None:
    """A number of threads.

    Raises
    ------
    ScenarioError
        It is no whole number from 1 to 1024.
    """
    whole = isinstance(number, (int, np.integer)) and not isinstance(number, bool)
    if number is not None and not (whole and 1 <= number <= 1024):
        raise ScenarioError(f"threads = {number!r} is no whole number from 1 to 1024", "threads", (1.0, 1024.0))
    return None if number is None else int(number)


def listed(array: np.ndarray, key: str, largest: float | None) -> Any:
    """An array as a number or a list."""
    if array.ndim == 0 and array.dtype == object:
        raise ScenarioError(f"{key}: {kind(array.item())} is no value of a scenario", key)
    if array.ndim > 1:
        raise ScenarioError(f"{key}: an array of shape {array.shape}; expected one dimension", key)
    return plain(array.tolist(), key, largest)


def doubt_units(value: Any, key: str = "") -> None:
    """Warns of numbers that look as if they were in degrees."""
    if isinstance(value, Mapping):
        for name, item in value.items():
            doubt_units(item, f"{key}.{name}" if key else name)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        for end, most, unit in SUSPICIOUS:
            if key.endswith(end) and abs(value) > most:
                message = f"{key} = {value} {unit} is unusually large; is it in degrees?"
                warn(message, UnitsWarning)
                return
