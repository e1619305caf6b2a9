"""Cells of a sweep on a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from . import _core
from ._check import kind
from .errors import ClientError


def check(client: Any) -> None:
    """Refuses a client that can't compute.

    Raises
    ------
    ClientError
        It is no client, it is closed, or its scheduler does not answer.
    """
    if not hasattr(client, "submit") or not hasattr(client, "status"):
        raise ClientError(f"client: {kind(client)} is no dask.distributed.Client")
    if client.status != "running":
        raise ClientError(f"client: the Dask client is {client.status}; nothing was computed")


def compute(cell: str, threads: int) -> str:
    """One cell, on a worker."""
    unit, _ = _core.sweep_cell(cell, threads)
    if unit is None:
        raise RuntimeError("the cell was interrupted")
    return unit


def units(client: Any, cells: list[str], threads: int) -> Iterator[str]:
    """The results of cells as the workers finish them; after an interruption the other tasks are cancelled."""
    from dask import distributed

    as_completed: Any = distributed.as_completed
    # The same cell again is computed again: a function is pure here, but a cached result would hide a broken worker.
    futures = client.map(compute, cells, threads=threads, pure=False)
    try:
        for future in as_completed(futures):
            yield future.result()
    except Exception as error:
        if client.status != "running" or future_lost(error):
            raise ClientError(f"client: the Dask client was lost while computing ({error})") from error
        raise
    finally:
        if client.status == "running":
            client.cancel(futures)


def future_lost(error: Exception) -> bool:
    """Whether a task ended because its cluster did."""
    return type(error).__name__ in {"FutureCancelledError", "CancelledError", "CommClosedError"}
