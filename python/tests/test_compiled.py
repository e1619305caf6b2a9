"""Compiled functions as laws: the bits of the same function in Python, on all threads, or refused."""

import ctypes
import ctypes.util
import math
import signal
import threading

import numpy as np
import pytest
import steer_assist as sa

START = {"speed_m_s": 4, "steer_rate_rad_s": 2}
SHORT = {"speeds": [3.0, 4.0, 5.0], "tolerance": 0.05, "max_rate": 8, "progress": False}
DOUBLES = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double, ctypes.c_double)


def of_c(name, result=ctypes.c_double, arguments=(ctypes.c_double, ctypes.c_double), library=ctypes.CDLL):
    """A function of the C library's mathematics."""
    file = ctypes.util.find_library("m")
    if file is None:
        pytest.skip("the C library's mathematics are not found")
    function = library(file)[name]
    function.restype, function.argtypes = result, None if arguments is None else list(arguments)
    function.__name__ = name
    return function


@pytest.fixture
def numba():
    return pytest.importorskip("numba", reason="numba is not installed")


def document(result):
    content = sa.document(result)
    content.pop("seconds", None)
    return content


def basin(law):
    return document(sa.basin(law=law, **SHORT))


COMPUTED = {
    "ride": lambda law: sa.ride(law=law, **START),
    "ride of a dictionary": lambda law: sa.ride({"law": law}, **START),
    "basin": lambda law: sa.basin(law=law, **SHORT),
    "basin of a dictionary": lambda law: sa.basin({"law": law}, **SHORT),
    "plane": lambda law: sa.plane(law=law, speed=4, rays=4, points=10, tolerance=0.01, progress=False),
}


@pytest.mark.parametrize("compute", COMPUTED.values(), ids=COMPUTED.keys())
def test_a_function_of_c_has_the_bits_of_pythons(compute):
    """Situation: atan2 of roll rate and speed, which Python has from the C library, as a law. Must hold: both are the same result, and
    the law is not that without one."""
    compiled, interpreted, none = compute(of_c("atan2")), compute(math.atan2), compute("none")
    assert compiled.drop_attrs().identical(interpreted.drop_attrs())
    assert document(compiled) == document(interpreted)
    assert not compiled.drop_attrs().equals(none.drop_attrs())


def test_the_threads_do_not_matter():
    """Must hold: one and four threads give the same document; of four several call the function."""
    law, search = of_c("atan2"), {**SHORT, "speeds": np.linspace(2, 6, 9)}
    one, four = (document(sa.basin(law=law, threads=threads, **search)) for threads in (1, 4))
    assert one == four and one["complete"]
    callers = set()

    def noted(roll_rate_rad_s, speed_m_s):
        callers.add(threading.get_ident())
        return math.atan2(roll_rate_rad_s, speed_m_s)

    assert sa.basin(law=DOUBLES(noted), threads=4, **search).height.equals(sa.basin(law=noted, **search).height)
    assert len(callers - {threading.get_ident()}) > 2


@pytest.mark.parametrize(
    "declared, found",
    [
        ({"result": ctypes.c_int}, "c_double.*restype c_int and argtypes .c_double, c_double."),
        ({"result": ctypes.c_float}, "restype c_float"),
        ({"result": None}, "restype None"),
        ({"arguments": None}, "argtypes None"),
        ({"arguments": [ctypes.c_double]}, r"argtypes \[c_double\]"),
        ({"arguments": [ctypes.c_double, ctypes.c_float]}, r"argtypes \[c_double, c_float\]"),
        ({"arguments": [ctypes.c_double] * 3}, r"argtypes \[c_double, c_double, c_double\]"),
        ({"library": ctypes.PyDLL}, "PyDLL.*interpreter's lock"),
    ],
)
def test_a_pointer_of_another_type_is_refused(declared, found):
    """Must hold: nothing is called, and what was found is named."""
    for use in (lambda law: sa.ride(law=law, **START), lambda law: sa.ride({"law": law}, **START), basin):
        with pytest.raises(sa.ScenarioError, match=found) as raised:
            use(of_c("atan2", **declared))
        assert raised.value.key == "law"


def test_a_null_pointer_is_refused():
    with pytest.raises(sa.ScenarioError, match="null"):
        sa.ride(law=DOUBLES(), **START)


def test_a_function_of_c_is_checked_as_pythons():
    """Situation: hypot, which is even. Must hold: no basin, as with Python's; a ride has it."""
    with pytest.raises(sa.ScenarioError, match="not odd in the roll rate"):
        basin(of_c("hypot"))
    assert sa.ride(law=of_c("hypot"), **START).roll_rad.equals(sa.ride(law=math.hypot, **START).roll_rad)


@pytest.mark.parametrize("beyond", [math.nan, math.inf])
def test_a_value_that_is_not_finite_is_refused(beyond):
    """Situation: a function that is not finite anywhere, or in the rides only. Must hold: refused with the inputs, as of Python's."""

    def late(roll_rate_rad_s, speed_m_s):
        return 0.0 if abs(roll_rate_rad_s) in (0.003, 0.03, 0.1, 0.3, 0.5, 1.0, 3.0) else beyond

    for law in (lambda roll_rate_rad_s, speed_m_s: beyond, late):
        for use in (lambda law: sa.ride(law=law, **START), basin):
            with pytest.raises(sa.ScenarioError, match=rf"returned {beyond} at .* rad/s and .* m/s.*one\s+finite number") as raised:
                use(DOUBLES(law))
            assert raised.value.key == "law"


def test_a_compiled_basin_is_interrupted():
    """Must hold: progress is reported, and Ctrl-C keeps the finished speeds."""

    def report(done, all):
        if done >= 1:
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(sa.Interrupted) as raised:
            sa.basin(law=of_c("atan2"), speeds=np.linspace(1, 8, 1000), method="plain", progress=report)
    finally:
        signal.signal(signal.SIGINT, before)
    assert 1 <= int(raised.value.result.height.notnull().sum()) < 1000


def soft(roll_rate_rad_s, speed_m_s):
    return 4.0 * math.tanh(20.0 * roll_rate_rad_s / (1.0 + speed_m_s))


def test_functions_of_numba_are_laws(numba):
    """Situation: one function compiled by njit and by cfunc. Must hold: both have the same bits, and the ride of Python's, but for the
    rounding of tanh."""
    by_njit, by_cfunc = numba.njit(soft), numba.cfunc("float64(float64, float64)")(soft)
    assert basin(by_njit) == basin(by_cfunc)
    compiled, interpreted = sa.ride(law=by_njit, **START), sa.ride(law=soft, **START)
    np.testing.assert_allclose(compiled.roll_rad, interpreted.roll_rad, atol=1e-9)
    assert document(compiled)["config"]["law"]["name"] == "python:soft"


def test_an_exception_in_a_function_of_njit_is_refused(numba):
    @numba.njit
    def law(roll_rate_rad_s, speed_m_s):
        if abs(roll_rate_rad_s) > 0.51 and abs(roll_rate_rad_s) != 1.0 and abs(roll_rate_rad_s) != 3.0:
            raise ValueError("my own")
        return 0.0

    for use in (lambda law: sa.ride(law=law, **START), basin):
        with pytest.raises(sa.ScenarioError, match="returned nan at"):
            use(law)


def test_what_numba_can_not_compile_is_refused(numba):
    """Must hold: the signature is named, and what was found or why it fails."""
    single = numba.cfunc("float32(float32, float32)")(lambda p, v: p)
    of_complex = numba.cfunc("complex128(float64, float64)")(lambda p, v: 1j * p)
    refused = [
        (single, r"c_double.*restype c_float and argtypes \[c_float, c_float\]"),
        (numba.cfunc("float64(float64)")(lambda p: p), r"argtypes \[c_double\]"),
        (of_complex, r"float64\(float64, float64\).*complex128"),
        (numba.njit(lambda p: p), r"can't compile.*float64\(float64, float64\).*too many positional arguments"),
        (numba.njit(lambda p, v: 1j * p), r"can't compile.*complex128"),
        (numba.njit(lambda p, v: "much"), r"can't compile.*float64"),
    ]
    for law, words in refused:
        for use in (lambda law: sa.ride(law=law, **START), lambda law: sa.ride({"law": law}, **START), basin):
            with pytest.raises(sa.ScenarioError, match=words) as raised:
                use(law)
            assert raised.value.key == "law"
