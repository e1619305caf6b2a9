"""Ctrl-C: what is finished is kept. Other threads run meanwhile."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import steer_assist as sa


@pytest.fixture(autouse=True)
def ctrl_c():
    """Python's own handler: a program that was started in the background ignores the signal."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupted_after(parts):
    """A progress function that presses Ctrl-C when some parts are finished."""

    def report(done, all):
        if done >= parts:
            signal.raise_signal(signal.SIGINT)

    return report


def test_an_interrupted_basin_has_its_finished_speeds():
    """Situation: 400 speeds, every ride exact. Action: Ctrl-C after the first. Must hold: the finished speeds are in the
    exception, bit for bit, and the others are NaN."""
    speeds = np.linspace(1, 8, 400)
    with pytest.raises(sa.Interrupted) as raised:
        sa.basin(speeds=speeds, method="plain", progress=interrupted_after(1))
    partial = raised.value.result
    done = partial.height.notnull()
    assert isinstance(raised.value, KeyboardInterrupt)
    assert 1 <= int(done.sum()) < 400 and partial.complete == 0 and np.isnan(partial.area)
    first = partial.height[done][:1]
    again = sa.basin(speeds=[float(first.speed_m_s[0])], method="plain", progress=False)
    assert again.height.values.tolist() == first.values.tolist()


def test_an_interrupted_sweep_has_its_finished_cells():
    with pytest.raises(sa.Interrupted) as raised:
        sa.sweep(over={"torque_limit_nm": np.arange(1, 50)}, speeds=[4.0], tolerance=0.2, progress=interrupted_after(2))
    partial = raised.value.result
    assert 2 <= int(partial.height.notnull().sum()) < 49


def test_a_function_is_interrupted_too():
    with pytest.raises(sa.Interrupted) as raised:
        sa.basin(law=lambda p, v: 10 * p, speeds=np.linspace(1, 8, 200), progress=interrupted_after(1))
    assert 1 <= int(raised.value.result.height.notnull().sum()) < 200


PROGRAM = """
import signal, steer_assist as sa
signal.signal(signal.SIGINT, signal.default_int_handler)
calls = 0
def law(roll_rate_rad_s, speed_m_s):
    global calls
    calls += 1
    if calls == 50_000:  # Beyond the checks, in the ride.
        print("rides", flush=True)
    return 0.0
try:
    sa.ride(law=law, bicycle="benchmark", speed_m_s=5.0, time_limit_s=3600, steer_rate_rad_s=0.01)
except sa.Interrupted as interrupted:
    print(calls, interrupted.result)
"""


def test_a_long_ride_is_stopped():
    """Situation: a ride of an hour, whose law is a Python function. Action: the signal of Ctrl-C after 50,000 calls. Must hold: it ends
    with a KeyboardInterrupt after a small part of the 14,400,000 calls."""
    with subprocess.Popen([sys.executable, "-c", PROGRAM], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "rides\n"
        child.send_signal(signal.SIGINT)
        output, _ = child.communicate(timeout=100)
    calls, result = output.split()
    assert 50_000 <= int(calls) < 4_000_000 and result == "None"


def test_a_long_ride_of_the_flashed_code_is_stopped():
    """Situation: a ride of an hour. Action: the signal of Ctrl-C soon after its start. Must hold: there is no ride."""
    presser = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    presser.start()
    with pytest.raises(sa.Interrupted) as raised:
        sa.ride(preset="product", bicycle="benchmark", speed_m_s=5.0, time_limit_s=3600, steer_rate_rad_s=0.01)
    presser.join()
    assert raised.value.result is None


def test_an_error_of_the_progress_function_is_raised():
    def broken(done, all):
        raise RuntimeError("my own")

    with pytest.raises(RuntimeError, match="my own"):
        sa.basin(speeds=np.linspace(1, 8, 200), method="plain", progress=broken)


def test_other_threads_run_meanwhile():
    """Situation: a second thread counts. Must hold: it counts on during a basin, so the interpreter's lock is free."""
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    sa.basin(speeds=np.linspace(2, 7, 20), method="plain", threads=1, progress=False)
    counted_meanwhile = counted[0] - before
    stop.set()
    thread.join()
    assert counted_meanwhile > 20
