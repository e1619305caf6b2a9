"""The package's time beside the command line's, and a law that is a function, Python's or compiled, beside numba and scipy.

python python/benchmarks/speed.py target/release/sim-host

Both sides in one call, in turn. The peer's equations are those of sim-host/benches/reference/ride.py, which shares only the
parameters; law h acts on the roll rate, scheduled by the rear wheel's speed. Needs numba and scipy.
"""

import importlib.util
import json
import math
import os
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


def in_turn(runs, times):
    """Median seconds of each, measured in turn after a first run, and the last results."""
    results = [run() for run in runs]
    seconds = [[] for _ in runs]
    for _ in range(times):
        for i, run in enumerate(runs):
            begin = time.perf_counter()
            results[i] = run()
            seconds[i].append(time.perf_counter() - begin)
    return [statistics.median(some) for some in seconds], results


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
        (a, b), _ = in_turn([there, here], times)
        print(f"| {name} | {1e3 * a:.1f} ms | {1e3 * b:.1f} ms | {b / a:.2f} |")
    there = statistics.median(json.loads(run("basin"))["seconds"] for _ in range(5))
    here = statistics.median(sa.document(sa.basin(progress=False))["seconds"] for _ in range(5))
    print(f"| search of the basin alone | {1e3 * there:.1f} ms | {1e3 * here:.1f} ms | {here / there:.2f} |")


def peers():
    """The ride with the law by scipy with numba's right-hand side, and by numba alone."""
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

    return lambda: by_scipy()[columns], lambda: runge_kutta(y, 6000, 1e-3)[columns]


def beside_numba():
    compiled, threads = numba.njit(h), os.cpu_count()
    by_scipy, by_numba = peers()

    def ride(law):
        return lambda: sa.ride(law=law, schedule_speed="rear", **START)

    def basin(law, threads):
        search = {"speeds": "2:6:0.5", "threads": threads, "progress": False}
        return lambda: sa.basin(law=law, schedule_speed="rear", **search)

    rows = {
        "scipy, DOP853 to 1e-9, right-hand side by numba": by_scipy,
        "numba alone, Runge-Kutta at 1 ms, law compiled": by_numba,
        "`ride` with a Python function": ride(h),
        "`ride` with a function of numba": ride(compiled),
        "`basin` with a Python function, one thread, per ride": basin(h, 1),
        "`basin` with a function of numba, one thread, per ride": basin(compiled, 1),
        f"`basin` with a function of numba, {threads} threads, per ride": basin(compiled, threads),
    }
    names = list(rows)
    seconds, results = in_turn([rows[name] for name in names[:4]], 15)
    of_basins, basins = in_turn([rows[name] for name in names[4:]], 5)
    seconds += [time_s / sa.document(found)["work"]["rides"] for time_s, found in zip(of_basins, basins)]
    finals = [sa.document(result)["final"] for result in results[2:]]
    keys = ("roll", "steer", "roll_rate", "steer_rate", "rear_wheel_rate")
    states = results[:2] + [np.array([final[key] for key in keys]) for final in finals]
    apart = max(np.abs(one - other).max() for one in states for other in states)
    print("\n| | a ride | rides per second | beside scipy and numba |\n| --- | ---: | ---: | ---: |")
    for name, ride_s in zip(names, seconds):
        print(f"| {name} | {1e3 * ride_s:.2f} ms | {1 / ride_s:.0f} | {seconds[0] / ride_s:.1f} |")
    print(f"\nThe final states differ by at most {apart:.1e} (rad, rad/s).")
    if not apart < AGREED:
        raise SystemExit(f"the rides differ by more than {AGREED}")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        beside_the_command_line(sys.argv[1])
    beside_numba()
