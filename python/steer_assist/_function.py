"""Laws that are functions: Python's, or compiled ones of numba and ctypes."""

from __future__ import annotations

import ctypes
import functools
import math
import sys
from _ctypes import FUNCFLAG_PYTHONAPI, CFuncPtr
from collections.abc import Callable
from typing import Any, NamedTuple

from .errors import ScenarioError

#: ``f(roll_rate_rad_s, speed_m_s) -> torque_nm``
Law = Callable[[float, float], float]

#: The type of compiled functions, for numba.
SIGNATURE = "float64(float64, float64)"


class Function(NamedTuple):
    """A law that is a function."""

    #: What has its name, and its code as long as it exists.
    owner: Any
    #: Calls the code that the simulator will call.
    call: Law
    #: Address of the code; None if the owner itself is called, with the interpreter's lock.
    address: int | None


def function(law: Any) -> Function:
    """What is to be called for a law that is callable.

    Raises
    ------
    ScenarioError
        It is a compiled function of another type, or can't be compiled to this one.
    """
    if isinstance(law, CFuncPtr):
        return compiled(law, law)
    if hasattr(law, "native_name") and hasattr(law, "address"):
        return of_cfunc(law)
    numba = sys.modules.get("numba")
    if numba is not None and numba.extending.is_jitted(law):
        return of_cfunc(entry(law))
    return Function(law, law, None)


def compiled(owner: Any, pointer: Any) -> Function:
    """The function of a pointer of ctypes, which must declare doubles."""
    result, arguments = pointer.restype, pointer.argtypes
    if result is not ctypes.c_double or tuple(arguments or ()) != (ctypes.c_double, ctypes.c_double):
        found = f"restype {declared(result)} and argtypes {declared(arguments)}"
        raise ScenarioError(f"law: a compiled function has restype c_double and argtypes [c_double, c_double], this one {found}", "law")
    if pointer._flags_ & FUNCFLAG_PYTHONAPI:
        raise ScenarioError("law: a function of ctypes.PyDLL or PYFUNCTYPE needs the interpreter's lock; use CDLL or CFUNCTYPE", "law")
    address = ctypes.cast(pointer, ctypes.c_void_p).value
    if address is None:
        raise ScenarioError("law: the function pointer is null", "law")
    return Function(owner, pointer, address)


def declared(types: Any) -> str:
    """The names of types of ctypes."""
    if isinstance(types, (list, tuple)):
        return f"[{', '.join(map(declared, types))}]"
    return str(getattr(types, "__name__", types))


def of_cfunc(law: Any) -> Function:
    """The function of a ``numba.cfunc``."""
    try:
        pointer = law.ctypes
    except TypeError as error:
        raise ScenarioError(f"law: a numba.cfunc has the signature {SIGNATURE}: {error}", "law") from None
    return compiled(law, pointer)


@functools.lru_cache(maxsize=32)
def entry(law: Any) -> Any:
    """A ``numba.cfunc`` that calls a function of ``numba.njit``: an exception in it is a NaN, which the simulator refuses."""
    import numba

    def call(roll_rate_rad_s: float, speed_m_s: float) -> float:
        try:
            torque_nm: float = law(roll_rate_rad_s, speed_m_s)
        except Exception:
            torque_nm = math.nan
        return torque_nm

    call.__name__ = law.__name__
    try:
        return numba.cfunc(SIGNATURE)(call)
    except numba.core.errors.NumbaError as error:
        lines = (line for line in str(error).splitlines() if line and not line.startswith("Failed in"))
        raise ScenarioError(f"law: numba can't compile `{law.__name__}` to {SIGNATURE}: {next(lines, error)}", "law") from error
