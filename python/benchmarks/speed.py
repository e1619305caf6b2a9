"""The package's time beside the command line's, and a law that is a Python function beside numba and scipy.

python python/benchmarks/speed.py target/release/sim-host

Both sides in one call, in turn. The peer's equations are those of sim-host/benches/reference/ride.py, which shares only the
parameters; law h acts on the roll rate, scheduled by the rear wheel's speed. Needs numba and scipy.
"""

import importlib.util
import json
import math
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numba
import numpy as np
import steer_assist as sa
from scipy.integrate import solve_ivp

REFERENCE = Path(__file__).resolve().parents[2] / "sim-host/benches/reference/ride.py"
START = {"speed_m_s": 4.0, "steer_rate_rad_s": 5.0}
AGREED = 1e-6


def reference():
    spec = importlib.util.spec_from_file_location("reference", REFERENCE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def timed(run, times):
    """Median seconds of some runs after a first one, and the last result."""
    result, seconds = run(), []
    for _ in range(times):
        begin = time.perf_counter()
        result = run()
        seconds.append(time.perf_counter() - begin)
    return statistics.median(seconds), result


def in_turn(one, other, times):
    """Median seconds of two, measured in turn."""
    pairs = []
    for _ in range(times):
        pairs.append((timed(one, 1)[0], timed(other, 1)[0]))
    return [statistics.median(seconds) for seconds in zip(*pairs)]


def h(roll_rate_rad_s, speed_m_s):
    return (30.0 - 4.0 * speed_m_s) * math.exp(-0.03 * speed_m_s * speed_m_s) * roll_rate_rad_s


def beside_the_command_line(program):
    def run(*words):
        return subprocess.run([program, *words, "--json"], check=True, capture_output=True).stdout

    print("| | command line | Python | ratio |\n| --- | ---: | ---: | ---: |")
    words = ["--speed", "4", "--steer-rate", "5"]
    pairs = [
        ("basin", lambda: run("basin"), lambda: sa.basin(progress=False), 5),
        ("ride", lambda: run("ride", *words), lambda: sa.ride(**START), 30),
    ]
    for name, there, here, times in pairs:
        a, b = in_turn(there, here, times)
        print(f"| {name} | {1e3 * a:.1f} ms | {1e3 * b:.1f} ms | {b / a:.2f} |")
    there = statistics.median(json.loads(run("basin"))["seconds"] for _ in range(5))
    here = statistics.median(sa.document(sa.basin(progress=False))["seconds"] for _ in range(5))
    print(f"| search of the basin alone | {1e3 * there:.1f} ms | {1e3 * here:.1f} ms | {here / there:.2f} |")


def peers():
    """The ride with the law by numba alone, and by scipy with numba's right-hand side."""
    module = reference()
    p, rhs = module.bicycle("rigid_jason"), module.rhs
    rear, gains = p[0], np.zeros((2, 5))
    roll_rate, wheel, torque, torque_rate = module.ROLL_RATE, module.WHEEL_RATE, module.TORQUE, module.TORQUE_RATE
    law = numba.njit(h)

    @numba.njit(error_model="numpy", fastmath=True)
    def rate(y, dy):
        y[torque] = law(y[roll_rate], -rear * y[wheel])
        rhs(p, gains, y, 0.0, dy)
        dy[torque] = dy[torque_rate] = 0.0

    @numba.njit(error_model="numpy", fastmath=True)
    def runge_kutta(y, steps, step):
        k, at = np.zeros((4, y.size)), np.empty_like(y)
        y = y.copy()
        for _ in range(steps):
            at[:] = y
            rate(at, k[0])
            for i, part in ((1, 0.5), (2, 0.5), (3, 1.0)):
                at[:] = y + part * step * k[i - 1]
                rate(at, k[i])
            y += step / 6.0 * (k[0] + 2.0 * k[1] + 2.0 * k[2] + k[3])
        return y

    def slope(_, y):
        now, dy = y.copy(), np.empty_like(y)
        rate(now, dy)
        return dy

    y = np.zeros(9)
    y[module.STEER_RATE], y[wheel] = START["steer_rate_rad_s"], -START["speed_m_s"] / rear
    columns = [module.ROLL, module.STEER, roll_rate, module.STEER_RATE, wheel]

    def by_scipy():
        return solve_ivp(slope, (0.0, 6.0), y, method="DOP853", rtol=1e-9, atol=1e-11).y[:, -1]

    numba_s, end = timed(lambda: runge_kutta(y, 6000, 1e-3), 15)
    scipy_s, other = timed(by_scipy, 9)
    return numba_s, end[columns], scipy_s, other[columns]


def beside_numba():
    numba_s, end, scipy_s, other = peers()
    own_s, ride = timed(lambda: sa.ride(law=h, schedule_speed="rear", **START), 15)
    final = sa.document(ride)["final"]
    state = [final[key] for key in ("roll", "steer", "roll_rate", "steer_rate", "rear_wheel_rate")]
    apart = max(np.abs(state - end).max(), np.abs(state - other).max())
    basin_s, basin = timed(lambda: sa.basin(law=h, schedule_speed="rear", speeds="2:6:0.5", progress=False), 3)
    rides = sa.document(basin)["work"]["rides"]
    rows = [
        ("scipy, DOP853 to 1e-9, right-hand side by numba", scipy_s),
        ("numba alone, Runge-Kutta at 1 ms, law compiled", numba_s),
        ("`ride` with the law as a Python function", own_s),
        ("`basin` with it, per ride", basin_s / rides),
    ]
    print("\n| | a ride | rides per second | beside scipy and numba |\n| --- | ---: | ---: | ---: |")
    for name, seconds in rows:
        print(f"| {name} | {1e3 * seconds:.2f} ms | {1 / seconds:.0f} | {scipy_s / seconds:.1f} |")
    print(f"\nThe final states differ by at most {apart:.1e} (rad, rad/s).")
    if not apart < AGREED:
        raise SystemExit(f"the rides differ by more than {AGREED}")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        beside_the_command_line(sys.argv[1])
    beside_numba()
