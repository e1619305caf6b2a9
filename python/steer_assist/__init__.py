"""Rides and basins of attraction of a nonlinear bicycle with a steer assist, its riders and the flashed control code.

SI units, angles in radians; roll, steer and torque to the right are positive (axes of Meijaard et al. 2007). A scenario is a
dictionary, keyword arguments, or a TOML file; results are xarray Datasets with units and coordinates. docs/python.md.
"""

from importlib.metadata import version as _version

from . import plot
from ._basin import basin, islands
from ._bicycle import as_bicycle
from ._core import bicycle_keys, bicycles, riders
from ._data import document
from ._eigen import eigen
from ._identify import Identified, identify
from ._plane import plane
from ._replay import causes, replay
from ._ride import ride
from ._scenario import check, scenario
from ._sweep import sweep
from .errors import ClientError, Interrupted, ScenarioError, ScenarioWarning, UnitsWarning

__version__ = _version("steer_assist")

__all__ = [
    "ClientError",
    "Identified",
    "Interrupted",
    "ScenarioError",
    "ScenarioWarning",
    "UnitsWarning",
    "as_bicycle",
    "basin",
    "bicycle_keys",
    "bicycles",
    "causes",
    "check",
    "document",
    "eigen",
    "identify",
    "islands",
    "plane",
    "plot",
    "replay",
    "ride",
    "riders",
    "scenario",
    "sweep",
]
