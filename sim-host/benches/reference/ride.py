"""The ride of benches/riders.rs in Python: what numba and scipy make of the same system.

A nonlinear Whipple bicycle under a rider whose neural signal comes 30 ms late, 6 s after a knock. Newton's and Euler's
equations of two gyrostats (each frame with its wheel) in axes that turn with the heading (x along it, y right, z down),
projected on the motions that rolling allows; the pitch is integrated. Prints lines of name=value.
"""

import math
import sys
import time
import tomllib
from pathlib import Path

import numba
import numpy as np
import scipy
from scipy.integrate import solve_ivp

DATA = Path(__file__).resolve().parents[3] / "data"
SPEED, KNOCK, SECONDS, DELAY, STEP = 4.0, 5.0, 6.0, 0.03, 1e-3
STEPS, DELAY_STEPS = round(SECONDS / STEP), round(DELAY / STEP)
OMEGA, ZETA = 2.17 * 2.0 * math.pi, math.sqrt(0.5)
GAINS = ["K_phi_p", "K_phi_d", "K_delta_i", "K_delta_d", "K_delta_dd"]
# The state: integral of steer, torque of the muscles and its rate are the rider's.
ROLL, STEER, ROLL_RATE, STEER_RATE, WHEEL_RATE, PITCH, INTEGRAL, TORQUE, TORQUE_RATE = range(9)

njit = numba.njit(error_model="numpy", fastmath=True)


@njit
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit
def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit
def add(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit
def mul(s, a):
    return s * a[0], s * a[1], s * a[2]


@njit
def sub(a, b):
    return add(a, mul(-1.0, b))


@njit
def out_of(frame, a):
    """The vector with components `a` in a frame of three unit vectors."""
    return add(add(mul(a[0], frame[0]), mul(a[1], frame[1])), mul(a[2], frame[2]))


@njit
def times(inertia, frame, w):
    """Inertia (xx, yy, zz, xz in a frame) times a vector."""
    (xx, yy, zz, xz), x, z = inertia, dot(frame[0], w), dot(frame[2], w)
    return out_of(frame, (xx * x + xz * z, yy * dot(frame[1], w), xz * x + zz * z))


@njit
def whirl(w, alpha, arm):
    """Acceleration of an arm's far end by its turning."""
    return add(cross(alpha, arm), cross(w, cross(w, arm)))


@njit
def solve(a, b, c, r):
    """x, y, z of x a + y b + z c = r."""
    bc, ra = cross(b, c), cross(r, a)
    per = 1.0 / dot(a, bc)
    return per * dot(r, bc), -per * dot(c, ra), per * dot(b, ra)


@njit
def moving(pose, roll, steer, wheel, rest):
    """Turning and centre's velocity of each gyrostat, spin of its wheel; `rest`: pitch, yaw, front wheel rate."""
    e2, axis, to_rear, head, rear, front = pose
    w = add((roll, 0.0, rest[1]), mul(rest[0], e2))
    wf = add(w, mul(steer, axis))
    hub = cross(to_rear, add(w, mul(wheel, e2)))
    vf = add(add(hub, cross(w, head)), cross(wf, front))
    return w, add(hub, cross(w, rear)), wheel, wf, vf, rest[2]


@njit
def power(a, b):
    return dot(a[0], b[0]) + dot(a[1], b[1]) + a[2] * b[2] + dot(a[3], b[3]) + dot(a[4], b[4]) + a[5] * b[5]


@njit
def momenta(rear, front, R, F, m):
    """Dual to `moving`: angular momentum, momentum, the wheel's share; of each gyrostat."""
    w, v, spin, wf, vf, spin_f = m
    (mass, _, inertia, rotor), (mass_f, _, inertia_f, rotor_f) = rear, front
    angular = add(times(inertia, R, w), mul(rotor * spin, R[1]))
    angular_f = add(times(inertia_f, F, wf), mul(rotor_f * spin_f, F[1]))
    share, share_f = rotor * (dot(w, R[1]) + spin), rotor_f * (dot(wf, F[1]) + spin_f)
    return angular, mul(mass, v), share, angular_f, mul(mass_f, vf), share_f


@njit
def rhs(p, gains, y, alpha, dy):
    """Writes the state's rate under the neural signal `alpha` that arrives; what is felt now."""
    rR, rF, g, (head, to_hub, sl, cl), rear, front = p
    roll, steer, wheel = y[ROLL_RATE], y[STEER_RATE], y[WHEEL_RATE]
    s, c = math.sin(y[ROLL]), math.cos(y[ROLL])
    st, ct = math.sin(y[PITCH]), math.cos(y[PITCH])
    sd, cd = math.sin(y[STEER]), math.cos(y[STEER])
    # The rear frame; the front frame, turned about the steer axis.
    e2, ex, ez = (0.0, c, s), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    R = (ct, s * st, -c * st), e2, (st, -s * ct, c * ct)
    axis, across = out_of(R, (sl, 0.0, cl)), out_of(R, (cl, 0.0, -sl))
    f1, f2 = add(mul(cd, across), mul(sd, e2)), sub(mul(cd, e2), mul(sd, across))
    F = add(mul(cl, f1), mul(sl, axis)), f2, sub(mul(cl, axis), mul(sl, f1))
    # From hub to contact, and how the front one wanders: d is the unit vector of z - (z . f2) f2.
    to_rear = (0.0, -s * rR, c * rR)
    n = f2[2]
    per_m = 1.0 / math.sqrt(1.0 - n * n)
    d = mul(per_m, sub(ez, mul(n, f2)))
    to_front = mul(rF, d)
    h, r, f = out_of(R, head), out_of(R, rear[1]), out_of(F, front[1])
    arm = add(out_of(F, to_hub), to_front)
    base = sub(add(h, arm), to_rear)
    pose = e2, axis, to_rear, h, r, f

    # The front contact's material point stays at rest: pitch, yaw, front wheel follow from the other three.
    turn, yawing, spinning = cross(e2, base), cross(ez, base), cross(f2, to_front)
    r1 = solve(turn, yawing, spinning, cross(base, ex))
    r2 = solve(turn, yawing, spinning, cross(arm, axis))
    r3 = solve(turn, yawing, spinning, (rR, 0.0, 0.0))
    rest = add(add(mul(roll, r1), mul(steer, r2)), mul(wheel, r3))
    pitch, yaw, spin = rest
    m1, m2, m3 = (
        moving(pose, 1.0, 0.0, 0.0, r1),
        moving(pose, 0.0, 1.0, 0.0, r2),
        moving(pose, 0.0, 0.0, 1.0, r3),
    )

    # Accelerations while the three independent speeds stay.
    w = add((roll, 0.0, yaw), mul(pitch, e2))
    wf = add(w, mul(steer, axis))
    e2_dot, f2_dot, axis_dot = cross(w, e2), cross(wf, f2), cross(w, axis)
    to_rear_dot = cross((roll, 0.0, yaw), to_rear)
    lean = f2_dot[2] * per_m
    to_front_dot = mul(rF, add(mul(-lean, f2), sub(mul(n * lean * per_m, d), mul(n * per_m, f2_dot))))
    arm_dot = add(cross(wf, sub(arm, to_front)), to_front_dot)
    base_dot = sub(add(cross(w, h), arm_dot), to_rear_dot)
    a0 = add((0.0, roll * yaw, 0.0), mul(pitch, e2_dot))
    free = add(cross(a0, base), cross(w, base_dot))
    free = add(free, mul(steer, add(cross(axis_dot, arm), cross(axis, arm_dot))))
    free = add(free, mul(spin, add(cross(f2_dot, to_front), cross(f2, to_front_dot))))
    free = add(free, (0.0, -rR * wheel * yaw, 0.0))
    pitch_acc, yaw_acc, spin_acc = solve(turn, yawing, spinning, mul(-1.0, free))
    al = add(add(a0, mul(pitch_acc, e2)), (0.0, 0.0, yaw_acc))
    alf = add(al, mul(steer, axis_dot))
    hub = add(cross(to_rear, add(al, mul(wheel, e2_dot))), cross(to_rear_dot, add(w, mul(wheel, e2))))
    hub = sub(hub, (0.0, 0.0, g))
    a_rear = add(hub, whirl(w, al, r))
    a_front = add(add(hub, whirl(w, al, h)), whirl(wf, alf, f))

    # Newton and Euler: rates of momentum, against the torques.
    (mass, _, inertia, rotor), (mass_f, _, inertia_f, rotor_f) = rear, front
    moment = add(times(inertia, R, al), cross(w, times(inertia, R, w)))
    moment = add(moment, mul(rotor * wheel, e2_dot))
    moment_f = add(times(inertia_f, F, alf), cross(wf, times(inertia_f, F, wf)))
    moment_f = add(moment_f, add(mul(rotor_f * spin, f2_dot), mul(rotor_f * spin_acc, f2)))
    share, share_f = rotor * dot(al, e2), rotor_f * (dot(alf, f2) + spin_acc)
    bias = moment, mul(mass, a_rear), share, moment_f, mul(mass_f, a_front), share_f
    p1, p2 = momenta(rear, front, R, F, m1), momenta(rear, front, R, F, m2)
    p3 = momenta(rear, front, R, F, m3)
    m12, m13, m23 = power(p1, m2), power(p1, m3), power(p2, m3)
    force = -power(bias, m1), y[TORQUE] - power(bias, m2), -power(bias, m3)
    roll_acc, steer_acc, wheel_acc = solve(
        (power(p1, m1), m12, m13), (m12, power(p2, m2), m23), (m13, m23, power(p3, m3)), force
    )

    dy[ROLL], dy[STEER], dy[PITCH], dy[INTEGRAL] = roll, steer, pitch, y[STEER]
    dy[ROLL_RATE], dy[STEER_RATE], dy[WHEEL_RATE] = roll_acc, steer_acc, wheel_acc
    dy[TORQUE] = y[TORQUE_RATE]
    dy[TORQUE_RATE] = OMEGA * OMEGA * (alpha - y[TORQUE]) - 2.0 * ZETA * OMEGA * y[TORQUE_RATE]
    v = -rF * spin
    felt = (gains[0, 0] * v + gains[1, 0]) * y[ROLL] + (gains[0, 1] * v + gains[1, 1]) * roll
    felt += (gains[0, 2] * v + gains[1, 2]) * y[INTEGRAL] + (gains[0, 3] * v + gains[1, 3]) * steer
    return felt + (gains[0, 4] * v + gains[1, 4]) * steer_acc


@njit
def ride(p, gains, y):
    """Runge-Kutta's fourth order in whole steps; what arrives half-way is on the cubic through four signals."""
    felt = np.zeros(STEPS + 1)
    k = np.zeros((4, y.size))
    y = y.copy()
    at = np.empty_like(y)
    for n in range(STEPS):
        a0 = a1 = a2 = 0.0
        i = n - DELAY_STEPS
        if i >= 0:
            # Four of one delay's stretch: at its ends the signal has kinks, at t = 0 a jump.
            first = i - i % DELAY_STEPS
            j = min(max(i - 1, first), first + DELAY_STEPS - 3)
            x = i - j + 0.5
            l0, l3 = (1 - x) * (2 - x) * (3 - x) / 6, x * (x - 1) * (x - 2) / 6
            l1, l2 = x * (2 - x) * (3 - x) / 2, x * (x - 1) * (3 - x) / 2
            a0, a2 = felt[i], felt[i + 1]
            a1 = l0 * felt[j] + l1 * felt[j + 1] + l2 * felt[j + 2] + l3 * felt[j + 3]
        felt[n] = rhs(p, gains, y, a0, k[0])
        at[:] = y + 0.5 * STEP * k[0]
        rhs(p, gains, at, a1, k[1])
        at[:] = y + 0.5 * STEP * k[1]
        rhs(p, gains, at, a1, k[2])
        at[:] = y + STEP * k[2]
        rhs(p, gains, at, a2, k[3])
        y += STEP / 6.0 * (k[0] + 2.0 * k[1] + 2.0 * k[2] + k[3])
    return y


def delay_by_delay(p, gains, y):
    """The same with scipy: one call per delay, fed from the last one's dense output; the end, and evaluations."""
    past, evaluations, unused = None, 0, np.empty_like(y)

    def rate(t, now):
        dy = np.empty_like(now)
        alpha = rhs(p, gains, past(t - DELAY), 0.0, unused) if past else 0.0
        rhs(p, gains, now, alpha, dy)
        return dy

    for i in range(round(SECONDS / DELAY)):
        span = i * DELAY, (i + 1) * DELAY
        part = solve_ivp(rate, span, y, method="DOP853", rtol=1e-9, atol=1e-11, dense_output=True)
        past, y, evaluations = part.sol, part.y[:, -1], evaluations + part.nfev * (2 if past else 1)
    return y, evaluations


def lumped(wheel, frame, origin):
    """A frame with its wheel: mass, centre from `origin`, inertia, the wheel's own about its axle."""
    (m1, r1, across, about), (m2, r2, inertia) = wheel, frame
    centre = (m1 * r1 + m2 * r2) / (m1 + m2)
    x, z = r2 - r1
    added = m1 * m2 / (m1 + m2) * np.array([z * z, x * x + z * z, x * x, -x * z])
    total = np.array([across, about, across, 0.0]) + inertia + added
    x, z = (centre - origin).tolist()
    return m1 + m2, (x, 0.0, z), tuple(total.tolist()), about


def bicycle(name):
    """Radii, gravity, arms, and the two gyrostats; forward and down in the upright bicycle."""
    b = tomllib.loads((DATA / "bicycles.toml").read_text())[name]
    hub, front_hub = np.array([0.0, -b["rR"]]), np.array([b["w"], -b["rF"]])
    head = np.array([b["w"] + b["c"], 0.0])  # where the steer axis meets the ground

    def own(f):
        return b["m" + f], np.array([b["x" + f], b["z" + f]]), np.array([b[f"I{f}{i}"] for i in ("xx", "yy", "zz", "xz")])

    rear = lumped((b["mR"], hub, b["IRxx"], b["IRyy"]), own("B"), hub)
    front = lumped((b["mF"], front_hub, b["IFxx"], b["IFyy"]), own("H"), head)

    def arm(a):
        return (float(a[0]), 0.0, float(a[1]))

    # The steer axis points down along (sin, cos) of its tilt.
    arms = arm(head - hub), arm(front_hub - head), math.sin(b["lam"]), math.cos(b["lam"])
    return b["rR"], b["rF"], b["g"], arms, rear, front


def regression(name):
    """Slopes and intercepts of a rider's gains over speed, as published."""
    lines = tomllib.loads((DATA / "riders" / f"{name}.toml").read_text())["regression"]
    return np.array([lines[key] for key in GAINS]).T


def timed(run, times):
    """Seconds of each of some runs, the first one (which compiles) left out; the last result."""
    result, seconds = run(), []
    for _ in range(times):
        start = time.perf_counter()
        result = run()
        seconds.append(time.perf_counter() - start)
    return sorted(seconds), result


def report(name, seconds, evaluations, y):
    end = ",".join(repr(float(x)) for x in y[[ROLL, STEER, ROLL_RATE, STEER_RATE, WHEEL_RATE]])
    middle = float(np.median(seconds))
    print(f"name={name} median_s={middle} least_s={seconds[0]} rides=1 right_hand_sides={evaluations} end={end}")


def main():
    p, gains = bicycle("rigid_jason"), regression("young")
    y = np.zeros(9)
    y[STEER_RATE], y[WHEEL_RATE] = KNOCK, -SPEED / p[0]
    print(f"# Python {sys.version.split()[0]}, numpy {np.__version__}, scipy {scipy.__version__}, numba {numba.__version__}")
    seconds, end = timed(lambda: ride(p, gains, y), 15)
    report("numba", seconds, 4 * STEPS, end)
    seconds, (end, evaluations) = timed(lambda: delay_by_delay(p, gains, y), 5)
    report("scipy", seconds, evaluations, end)


if __name__ == "__main__":
    main()
