"""Exceptions and warnings of the package."""

from __future__ import annotations

from typing import Any


class ScenarioError(ValueError):
    """A scenario, or a choice beside it, that can't be used.

    Attributes
    ----------
    key : str or None
        The key to blame, with dots: ``"search.scan_step"``.
    range : tuple of float or None
        Smallest and largest allowed value, in the key's unit, of a number outside its range.
    """

    def __init__(self, message: str, key: str | None = None, range: tuple[float, float] | None = None):
        super().__init__(message)
        self.key = key
        self.range = range

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.key, self.range)


class ScenarioWarning(UserWarning):
    """A doubt about a scenario that can be computed, such as a bicycle whose bodies have no possible inertia."""


class UnitsWarning(UserWarning):
    """A number whose magnitude suggests another unit, such as degrees in place of radians."""


class ClientError(RuntimeError):
    """A Dask client that can't compute: it is closed, or its cluster is gone."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a long computation.

    In an interactive session the last one is in ``sys.last_value``.

    Attributes
    ----------
    result : xarray.Dataset or None
        What was finished, as the function would have returned it, with NaN for the rest; None if nothing was.
    """

    def __init__(self, message: str, result: Any = None):
        super().__init__(message)
        self.result = result
