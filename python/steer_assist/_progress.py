"""Progress of long computations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Union

from tqdm.auto import tqdm as tqdm_auto
from tqdm.std import tqdm

from .errors import ScenarioError

#: Called with the numbers of finished and of all parts.
Report = Callable[[int, int], Any]
Progress = Union[bool, Report, None]


@contextmanager
def reporting(progress: Progress, name: str, unit: str) -> Iterator[Report | None]:
    """The function that gets the progress.

    ``progress``: None for a bar on a terminal, True for a bar everywhere, False for none, or a function of the numbers of
    finished and of all parts.

    Raises
    ------
    ScenarioError
        It is something else.
    """
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise ScenarioError(f"progress = {progress!r}: expected None, True, False or a function", "progress")
    if progress is False:
        yield None
    elif callable(progress):
        yield progress
    else:
        # None would be a terminal's only, in tqdm's own terms.
        bar = tqdm(desc=name, unit=unit, disable=None, leave=False) if progress is None else tqdm_auto(desc=name, unit=unit)
        with bar:

            def report(done: int, all: int) -> None:
                bar.total = all
                bar.update(done - bar.n)

            yield None if bar.disable else report
