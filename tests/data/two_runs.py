"""Numbers against which a report on the differences of two runs of the rising top can be tested.

Three runs of the heavy symmetric top with a fixed round peg are computed
(V. Tanriverdi, "How does a heavy symmetric top rise?", arXiv:2204.14060, equations (7)):

    A    k = 0.03,   friction torque without its theta_dot part (the paper's equations);
    B1   k = 0.03,   full Coulomb torque -K omega_perp/|omega_perp|;
    B2   k = 0.0303, friction torque without its theta_dot part.

All start at theta = 0.5, theta_dot = 0, phi = psi = 0, phi_dot = 1.75, psi_dot = 170
and stop where theta first falls to 0.02.  The pairs (A, B1) and (A, B2) are compared: rise,
nutation cycles, averaged motion, envelopes, phase, amplitude, averaged crossing, energy, samples
every millisecond, and the difference of the friction terms along A.

Method.  A Taylor series of high order is integrated in 80-bit floating point.  Each step's
polynomial is also the dense output, so extrema, crossings and integrals over time are taken from
the same polynomials, to the same accuracy.  Extrema are zeros of the derivative.  The zeros of
theta_ddot are bracketed by fine sampling; between them theta_dot is monotone, and between the
zeros of theta_dot theta is monotone.  So no dip below 0.02 is missed, however short.
Parameters are taken as exact decimals.

Everything is computed twice, with different order, tolerance and sampling.  "error" in the output
is the largest absolute difference between the two computations.  It does not hold the rounding of
the printed numbers to 64 bits (relative 1.1e-16).  "float64" is the largest difference from the same
computation with all parameters rounded to 64 bits.
"checks" compares with published digits and with SciPy's DOP853.  "gap" beside a maximum tells how
far the second greatest value is below it: where it is small, the time of the maximum means little.

Definitions used where there was a choice:

* A cycle runs from one maximum of theta_dot to the next.  Its middle is start + period/2.
* Extrema over a cycle are those of the continuous functions and include the cycle's ends.
* Interpolation is cubic Lagrange through four points, two on each side; in the first and the last
  interval through the first or last four points.
* The extremum of theta at t = 0 (theta_dot = 0 there) is not counted.
* RMS is the square root of the mean of the squares over all points, t = 0 included for samples.
* Differences are B - A.

Versions: Python 3.11.7, NumPy 2.4.6, SciPy 1.17.1, x86-64 (long double of 64-bit mantissa).
Usage: python two_runs.py [OUTPUT.json]
"""

import json
import os
import sys
import time

import numpy as np
import scipy
from scipy.integrate import solve_ivp

LD = np.longdouble
START = {"theta": "0.5", "theta_dot": "0", "phi": "0", "phi_dot": "1.75", "psi": "0", "psi_dot": "170"}
PERIOD = LD("0.001")
STOP = "0.02"
RUNS = {"A": ("0.03", False), "B1": ("0.03", True), "B2": ("0.0303", False)}
PAIRS = {"A_B1": ("A", "B1"), "A_B2": ("A", "B2")}
SIGNALS = ["phi", "theta", "psi", "phi_dot", "theta_dot", "psi_dot", "phi_ddot", "theta_ddot", "psi_ddot"]
CYCLED = ["theta", "theta_dot", "phi_dot", "psi_dot"]


class Setting:
    """Order and tolerance of the series, samples per step when looking for zeros, parameter rounding."""

    def __init__(self, order, tolerance, samples, rounded=False):
        self.order, self.tolerance, self.samples, self.rounded = order, LD(tolerance), samples, rounded

    def number(self, text):
        return LD(float(text)) if self.rounded else LD(text)


FINE = Setting(30, "1e-20", 16)
COARSE = Setting(24, "1e-17", 48)
ROUNDED = Setting(30, "1e-20", 16, rounded=True)


class Model:
    def __init__(self, k, full, setting):
        number = setting.number
        self.Ix, self.Iz = number("8.52e-5"), number("7.25e-5")
        mass, length, gravity = number("0.110"), number("0.020"), number("9.81")
        self.R = number("0.007")
        self.Mgl = mass * gravity * length
        self.K = number(k) * mass * gravity * self.R
        self.full = full

    def energy(self, theta, theta_dot, phi_dot, psi_dot):
        wz = psi_dot + phi_dot * np.cos(theta)
        tilt = theta_dot**2 + (phi_dot * np.sin(theta)) ** 2
        return (self.Ix * tilt + self.Iz * wz**2) / 2 + self.Mgl * np.cos(theta)

    def friction_torque(self, theta, theta_dot, psi_dot):
        """Components along e_N, e_2 = n x e_N and n."""
        s, c = np.sin(theta), np.cos(theta)
        v = np.sqrt(theta_dot**2 + (psi_dot * s) ** 2)
        f = psi_dot / v
        node = -self.K * theta_dot / v if self.full else 0 * v
        return np.array([node, self.K * f * s * c, -self.K * f * s * s])

    def friction_acceleration(self, theta, theta_dot, psi_dot):
        """What friction adds to theta_ddot, phi_ddot and psi_ddot."""
        s, c = np.sin(theta), np.cos(theta)
        node, _, _ = self.friction_torque(theta, theta_dot, psi_dot)
        kf = self.K * psi_dot / np.sqrt(theta_dot**2 + (psi_dot * s) ** 2)
        return np.array([node / self.Ix, kf * c / self.Ix, -kf * (c * c / self.Ix + s * s / self.Iz)])

    def rates(self, _, y):
        """Right-hand side in 64-bit floats for the check by DOP853."""
        theta, _, _, u, v, w = y
        s, c = np.sin(theta), np.cos(theta)
        Ix, Iz, Mgl = float(self.Ix), float(self.Iz), float(self.Mgl)
        wz = w + v * c
        a, b, d = np.array(self.friction_acceleration(theta, u, w), dtype=float)
        return [u, v, w,
                -(Iz * v * s / Ix) * wz + v * v * s * c + Mgl * s / Ix + a,
                (Iz * u / (Ix * s)) * wz - 2 * u * v * c / s + b,
                -(Iz * u * c / (Ix * s)) * wz + 2 * u * v * c * c / s + u * v * s + d]


def series(m, y, order):
    """Taylor coefficients of the motion and of the integrands at the state y.

    Order of the state: theta, phi, psi and their rates u, v, w.
    """
    n = order + 1
    th, ph, ps, u, v, w = z = np.zeros((6, n + 1), LD)
    z[:, 0] = y
    names = "s c s2 c2 w2 V2 V F vc wz G Q us H B Fc cB su sF uV T power_node power_2 power_n vs2 Fs2".split()
    x = {name: np.zeros(n, LD) for name in names}
    s, c, s2, c2, w2, V2, V, F, vc, wz, G, Q, us, H, B, Fc, cB, su, sF, uV, T, pN, p2, pn, vs2, Fs2 = x.values()
    Ix, Iz, K = m.Ix, m.Iz, m.K

    def times(a, b, k):
        return np.dot(a[: k + 1], b[k::-1])

    def over(a, b, q, k):
        """Coefficient k of q = a/b, from the earlier ones of q."""
        return (a[k] - (np.dot(q[:k], b[k:0:-1]) if k else 0)) / b[0]

    for k in range(n):
        if k == 0:
            s[0], c[0] = np.sin(th[0]), np.cos(th[0])
        else:
            s[k] = times(c, u, k - 1) / k
            c[k] = -times(s, u, k - 1) / k
        s2[k], c2[k], w2[k] = times(s, s, k), times(c, c, k), times(w, w, k)
        V2[k] = times(u, u, k) + times(w2, s2, k)
        if k == 0:
            V[0] = np.sqrt(V2[0])
        else:
            V[k] = (V2[k] - (np.dot(V[1:k], V[k - 1:0:-1]) if k > 1 else 0)) / (2 * V[0])
        F[k] = over(w, V, F, k)
        vc[k] = times(v, c, k)
        wz[k] = w[k] + vc[k]
        G[k] = (-Iz * times(v, wz, k)) / Ix + times(v, vc, k) + (m.Mgl / Ix if k == 0 else 0)
        us[k] = over(u, s, us, k)
        H[k] = Iz * wz[k] / Ix - 2 * vc[k]
        B[k] = times(us, H, k)
        Fc[k] = times(F, c, k)
        cB[k] = times(c, B, k)
        su[k] = times(s, u, k)
        T[k] = c2[k] / Ix + s2[k] / Iz
        uV[k] = over(u, V, uV, k)
        vs2[k] = times(v, s2, k)
        Fs2[k] = times(F, s2, k)
        theta_ddot = times(s, G, k) - (K * uV[k] / Ix if m.full else 0)
        phi_ddot = B[k] + K * Fc[k] / Ix
        psi_ddot = -cB[k] + times(su, v, k) - K * times(F, T, k)
        pN[k] = -K * times(u, uV, k) if m.full else 0
        p2[k] = K * times(Fc, vs2, k)
        pn[k] = -K * times(Fs2, wz, k)
        z[:, k + 1] = np.array([u[k], v[k], w[k], theta_ddot, phi_ddot, psi_ddot]) / LD(k + 1)
    return z[:, :n], {"path": m.R * V, "work_node": pN, "work_2": p2, "work_n": pn}


class Run:
    """One run: piecewise polynomials in t, and what follows from them."""

    ROWS = {"theta": 0, "phi": 1, "psi": 2, "theta_dot": 3, "phi_dot": 4, "psi_dot": 5}
    SUMS = ["theta", "path", "work_node", "work_2", "work_n"]

    def __init__(self, k, full, setting):
        self.setting = setting
        self.stop = setting.number(STOP)
        self.model = Model(k, full, setting)
        self.integrate()
        self.find_events()

    def integrate(self):
        m, order, number = self.model, self.setting.order, self.setting.number
        scale = np.array([1e-2, 1, 1, 1e-1, 1, 1], LD)
        y = np.array([number(START[q]) for q in ["theta", "phi", "psi", "theta_dot", "phi_dot", "psi_dot"]])
        t, end = LD(0), None
        times, coefs, sums = [t], [], []
        while end is None or t < end:
            z, extra = series(m, y, order)
            h = min(
                np.min((self.setting.tolerance * scale / np.maximum(abs(z[:, j]), LD(1e-300))) ** (LD(1) / j))
                for j in (order - 1, order))
            powers = h ** np.arange(order + 1)
            coefs.append(z * powers)
            sums.append(np.array([(z[0] if q == "theta" else extra[q]) * powers * h for q in self.SUMS]))
            y = coefs[-1][:, ::-1].sum(axis=1)
            t = t + h
            times.append(t)
            if end is None and y[0] < self.stop:
                end = t + LD("0.06")
        self.times = np.array(times)
        self.steps = np.diff(self.times)
        self.coefs = np.array(coefs)
        n = np.arange(1, order + 1)
        # Integrals as polynomials of the normalised time of each step, from 0 at its start.
        sums = np.array(sums) / np.arange(1, order + 2)
        whole = sums[:, :, ::-1].sum(axis=2)
        before = np.vstack([np.zeros((1, len(self.SUMS)), LD), np.cumsum(whole, axis=0)[:-1]])
        self.poly = {q: self.coefs[:, row] for q, row in self.ROWS.items()}
        for q in ["theta", "phi", "psi"]:
            self.poly[q + "_ddot"] = self.poly[q + "_dot"][:, 1:] * n / self.steps[:, None]
        for i, q in enumerate(self.SUMS):
            self.poly["integral_" + q] = np.concatenate([before[:, i, None], sums[:, i]], axis=1)

    def at(self, q, t):
        t = np.asarray(t, LD)
        i = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.steps) - 1)
        x = (t - self.times[i]) / self.steps[i]
        p = self.poly[q]
        value = p[i, -1]
        for j in range(p.shape[1] - 2, -1, -1):
            value = value * x + p[i, j]
        return value

    def bisect(self, q, low, high, level=LD(0)):
        """Zeros of q - level, one in each interval (low, high)."""
        low, high = np.array(low, LD), np.array(high, LD)
        sign = np.sign(self.at(q, low) - level)
        for _ in range(75):
            mid = (low + high) / 2
            left = np.sign(self.at(q, mid) - level) == sign
            low, high = np.where(left, mid, low), np.where(left, high, mid)
        return (low + high) / 2

    def zeros(self, q, grid):
        """Zeros of q between neighbours in the grid whose signs differ, and whether q falls there."""
        sign = np.sign(self.at(q, grid))
        change = np.nonzero(sign[:-1] * sign[1:] < 0)[0]
        return self.bisect(q, grid[change], grid[change + 1]), sign[change] > 0

    def find_events(self):
        x = np.arange(self.setting.samples, dtype=LD) / self.setting.samples
        grid = np.append((self.times[:-1, None] + self.steps[:, None] * x).ravel(), self.times[-1])
        bends, bends_fall = self.zeros("theta_ddot", grid)
        ends = np.concatenate([[LD(0)], bends, [self.times[-1]]])
        # theta_dot is exactly 0 at the start; its sign just after it is that of theta_ddot.
        ends[0] = grid[1] / 1024
        turns, turns_fall = self.zeros("theta_dot", ends)
        ends = np.concatenate([[LD(0)], turns, [self.times[-1]]])
        below = np.nonzero(self.at("theta", ends) <= self.stop)[0][0]
        self.rise = self.bisect("theta", ends[below - 1:below], ends[below:below + 1], self.stop)[0]
        self.bounds = bends[bends_fall & (bends <= self.rise)]
        self.theta_maxima = turns[turns_fall & (turns <= self.rise)]
        self.theta_minima = turns[~turns_fall & (turns <= self.rise)]
        extremes = {"theta": turns, "theta_dot": bends}
        for angle in ["phi", "psi"]:
            extremes[angle + "_dot"] = self.zeros(angle + "_ddot", grid)[0]
        self.extremes = {q: (t, self.at(q, t)) for q, t in extremes.items()}
        zeros = np.concatenate([[LD(0)], self.extremes["phi_dot"][0], [self.times[-1]]])
        loops, falls = self.zeros("phi_dot", zeros)
        loops = loops[falls & (loops <= self.rise)]
        self.looping = loops[0] if len(loops) else None
        self.cycles = self.find_cycles()

    def find_cycles(self):
        b = self.bounds
        period = np.diff(b)
        c = {"start": b[:-1], "period": period, "middle": b[:-1] + period / 2, "frequency": 1 / period}
        for q in CYCLED:
            t, value = self.extremes[q]
            ends = self.at(q, b)
            low, high = np.minimum(ends[:-1], ends[1:]), np.maximum(ends[:-1], ends[1:])
            cycle = np.searchsorted(b, t) - 1
            inside = (cycle >= 0) & (cycle < len(period))
            np.minimum.at(low, cycle[inside], value[inside])
            np.maximum.at(high, cycle[inside], value[inside])
            whole = np.diff(self.at("integral_theta" if q == "theta" else q[:-4], b))
            c[q + "_min"], c[q + "_max"], c[q + "_mean"] = low, high, whole / period
        c["amplitude"] = (c["theta_dot_max"] - c["theta_dot_min"]) / 2
        return c


def cubic(x, y, t):
    """Cubic Lagrange interpolation through the four nearest points, two on each side where possible."""
    t = np.asarray(t, LD)
    first = np.clip(np.searchsorted(x, t, side="right") - 2, 0, len(x) - 4)
    total = np.zeros(t.shape, LD)
    for j in range(4):
        weight = np.ones(t.shape, LD)
        for i in range(4):
            if i != j:
                weight = weight * (t - x[first + i]) / (x[first + j] - x[first + i])
        total = total + weight * y[first + j]
    return total


def crossing(f, nodes, level):
    """First time f falls to the level, f given at the nodes and in between."""
    values = f(nodes) - level
    # The node that defines the level is on it, whatever the rounding.
    i = int(np.nonzero(values <= LD(1e-17))[0][0])
    if i == 0 or abs(values[i]) <= LD(1e-17):
        return nodes[i]
    low, high = nodes[i - 1], nodes[i]
    for _ in range(75):
        mid = (low + high) / 2
        low, high = (mid, high) if f(mid) > level else (low, mid)
    return (low + high) / 2


def rms(x):
    return np.sqrt(np.mean(np.square(x)))


def largest(difference, times):
    """The greatest of the absolute values, how far the second greatest is below it, and the RMS."""
    size = abs(difference)
    i, second = int(np.argmax(size)), np.partition(size, -2)[-2]
    return {"max_abs": size[i], "time": times[i], "signed": difference[i], "gap": size[i] - second,
            "rms": rms(difference)}


def describe(run):
    m, at, rise = run.model, run.at, run.rise
    state = lambda t: [at(q, t) for q in ["theta", "theta_dot", "phi_dot", "psi_dot"]]
    start, end = m.energy(*state(LD(0))), m.energy(*state(rise))
    work = {q: at("integral_work_" + q, rise) for q in ["node", "2", "n"]}
    last = np.floor(rise / PERIOD) * PERIOD
    return {
        "rise": {"time": rise, **{q: at(q, rise) for q in SIGNALS}},
        "last_theta_minimum_before_rise": {"time": run.theta_minima[-1], "theta": at("theta", run.theta_minima[-1])},
        "nutation": {"theta_dot_maxima": len(run.bounds), "cycles": len(run.bounds) - 1,
                     "first_boundaries": list(run.bounds[:3]), "last_boundary": run.bounds[-1]},
        "events": {"looping_begins": run.looping,
                   "theta_at_looping": None if run.looping is None else at("theta", run.looping),
                   "theta_maxima": len(run.theta_maxima), "theta_minima": len(run.theta_minima)},
        "energy": {"start": start, "rise": end, "change": end - start,
                   "friction_work": {"total": sum(work.values()), "e_N": work["node"], "e_2": work["2"], "n": work["n"]},
                   "friction_work_at_last_sample": {
                       name: at("integral_work_" + q, last) for name, q in [("e_N", "node"), ("e_2", "2"), ("n", "n")]},
                   "balance": end - start - sum(work.values()),
                   "slip_path": at("integral_path", rise)},
    }


def compare(a, b):
    ca, cb = a.cycles, b.cycles
    out = {"rise_shift": b.rise - a.rise,
           "rise_difference": {q: b.at(q, b.rise) - a.at(q, a.rise) for q in SIGNALS}}

    middle = ca["middle"]
    use = (middle >= cb["middle"][0]) & (middle <= cb["middle"][-1])
    t = middle[use]
    delta = lambda q: largest(cubic(cb["middle"], cb[q], t) - ca[q][use], t)
    out["averaged"] = {"points": len(t), "first": t[0], "last": t[-1],
                       "mean": {q: delta(q + "_mean") for q in CYCLED},
                       "upper": {q: delta(q + "_max") for q in CYCLED},
                       "lower": {q: delta(q + "_min") for q in CYCLED},
                       "frequency": delta("frequency")}

    inside = (a.bounds >= b.bounds[0]) & (a.bounds <= b.bounds[-1])
    tb = a.bounds[inside]
    count = lambda r, x: cubic(r.bounds, np.arange(len(r.bounds), dtype=LD), x)
    dn = count(b, tb) - np.nonzero(inside)[0]
    apart = np.nonzero(abs(dn) >= LD("0.25"))[0]
    quarter = None
    if len(apart):
        j = int(apart[0])
        quarter = tb[j]
        if j:
            low, high = tb[j - 1], tb[j]
            for _ in range(75):
                mid = (low + high) / 2
                near = abs(count(b, mid) - count(a, mid)) < LD("0.25")
                low, high = (mid, high) if near else (low, mid)
            quarter = (low + high) / 2
    out["phase"] = {"points": len(tb), "first": tb[0], "last": tb[-1], "at_last": dn[-1], **largest(dn, tb),
                    "quarter_at_boundary": tb[apart[0]] if len(apart) else None,
                    "quarter_interpolated": quarter}

    ratio = cubic(cb["middle"], cb["amplitude"], t) / ca["amplitude"][use]
    i = int(np.argmin(ratio))
    out["amplitude_ratio"] = {"first": ratio[0], "last": ratio[-1], "smallest": ratio[i], "time_of_smallest": t[i]}

    level = max(ca["theta_mean"][-1], cb["theta_mean"][-1])
    reach = [crossing(lambda x, c=c: cubic(c["middle"], c["theta_mean"], x), c["middle"], level) for c in (ca, cb)]
    out["averaged_crossing"] = {"level": level, "time_A": reach[0], "time_B": reach[1], "shift": reach[1] - reach[0]}

    last = int(np.floor(min(a.rise, b.rise) / PERIOD))
    ts = np.arange(last + 1, dtype=LD) * PERIOD
    out["signals"] = {"samples": last + 1, **{q: largest(b.at(q, ts) - a.at(q, ts), ts) for q in SIGNALS}}

    ts = np.arange(int(np.floor(a.rise / PERIOD)) + 1, dtype=LD) * PERIOD
    state = [a.at(q, ts) for q in ["theta", "theta_dot", "psi_dot"]]
    torque_a, torque_b = a.model.friction_torque(*state), b.model.friction_torque(*state)
    size = lambda x: np.sqrt(np.sum(np.square(x), axis=0))
    acceleration = b.model.friction_acceleration(*state) - a.model.friction_acceleration(*state)
    out["discrepancy"] = {
        "samples": len(ts),
        "torque": {**largest(size(torque_b - torque_a), ts), "rms_of_A": rms(size(torque_a))},
        "torque_components": {q: largest(d, ts) for q, d in zip(["e_N", "e_2", "n"], torque_b - torque_a)},
        "acceleration": {q: largest(d, ts) for q, d in zip(["theta_ddot", "phi_ddot", "psi_ddot"], acceleration)}}

    ts = np.exp(np.linspace(np.log(LD("0.5")), np.log(LD(20)), 100, dtype=LD))
    x, y = np.log(ts), np.log(abs(b.at("psi", ts) - a.at("psi", ts)))
    out["psi_growth_slope"] = np.sum((x - x.mean()) * (y - y.mean())) / np.sum(np.square(x - x.mean()))
    return out


def report(setting):
    runs = {name: Run(*run, setting) for name, run in RUNS.items()}
    values = {"runs": {name: describe(run) for name, run in runs.items()},
              "pairs": {name: compare(runs[a], runs[b]) for name, (a, b) in PAIRS.items()}}
    return runs, values


def difference(x, y):
    """Absolute differences, in the shape of x."""
    if isinstance(x, dict):
        return {q: difference(x[q], y[q]) for q in x}
    if isinstance(x, list):
        if len(x) != len(y):
            raise SystemExit("the two computations have lists of different lengths")
        return [difference(p, q) for p, q in zip(x, y)]
    return None if x is None else abs(x - y)


def largest_in(x):
    """The largest number in a nest of them."""
    if isinstance(x, (dict, list)):
        return max(largest_in(v) for v in (x.values() if isinstance(x, dict) else x))
    return 0 if x is None else x


def plain(x):
    """The same with ordinary numbers, ready for JSON."""
    if isinstance(x, dict):
        return {q: plain(v) for q, v in x.items()}
    if isinstance(x, (list, tuple, np.ndarray)):
        return [plain(v) for v in x]
    if isinstance(x, (np.integer, int)):
        return int(x)
    return float(x) if isinstance(x, (np.floating, float)) else x


# Digits of run A (and of the full torque with k = 0.04) from two integrators of 113-bit precision, given with the equations.
PUBLISHED = {"time": "24.719386112893650970603596", "theta_dot": "-0.07941109808576860887051615",
             "phi_dot": "-0.29688357524525027537542744", "psi_dot": "151.33666678097782536016113",
             "phi": "47.2189344795088697907214", "psi": "3868.154249121791325261598"}
PUBLISHED_20 = {"theta": "0.12036000723756361552741517", "theta_dot": "-0.0098532697430258515783721084",
                "phi_dot": "1.7499269082186242931328622", "psi_dot": "150.34280881041583221246072",
                "phi": "37.772835177782881145158414", "psi": "3162.8829092848965954728527"}
PUBLISHED_LOOPING, PUBLISHED_MAXIMA = "24.270259759989620131517", 516
PUBLISHED_FULL_004 = {"time": "18.547322710511893790754949", "theta_dot": "-0.012415880705277854008716739",
                      "phi_dot": "1.052868667532949447151103", "psi_dot": "149.98654996070229987469158",
                      "phi": "35.415597710870720932141499", "psi": "2902.2898424590215184201368"}
PUBLISHED_ENERGY = {"start": "1.08560883119928878574", "rise": "0.8485504380804592390422"}


def checks(runs, values):
    a, rise = runs["A"], values["runs"]["A"]["rise"]
    out = {"published": {
        "rise": {q: abs(rise[q] - LD(v)) for q, v in PUBLISHED.items()},
        "t_20": {q: abs(a.at(q, LD(20)) - LD(v)) for q, v in PUBLISHED_20.items()},
        "looping_begins": abs(a.looping - LD(PUBLISHED_LOOPING)),
        "theta_dot_maxima": len(a.bounds) - PUBLISHED_MAXIMA,
        "energy": {q: abs(values["runs"]["A"]["energy"][q] - LD(v)) for q, v in PUBLISHED_ENERGY.items()}}}
    full = Run("0.04", True, FINE)
    rise = {"time": full.rise, **{q: full.at(q, full.rise) for q in SIGNALS}}
    out["published"]["full_torque_k_0.04"] = {q: abs(rise[q] - LD(v)) for q, v in PUBLISHED_FULL_004.items()}
    # With the full torque the energy lost is M g k times the slip path.
    m, energy = runs["B1"].model, values["runs"]["B1"]["energy"]
    out["full_torque_energy_against_slip_path"] = energy["change"] + m.K / m.R * energy["slip_path"]
    for name, run in runs.items():
        y = [float(START[q]) for q in ["theta", "phi", "psi", "theta_dot", "phi_dot", "psi_dot"]]
        s = solve_ivp(run.model.rates, (0, float(run.rise)), y, "DOP853", rtol=1e-13, atol=1e-16)
        order = ["theta", "phi", "psi", "theta_dot", "phi_dot", "psi_dot"]
        out["dop853_" + name] = {"steps": len(s.t) - 1,
                                 "max_abs_at_steps": {q: np.max(abs(s.y[i] - run.at(q, s.t))) for i, q in enumerate(order)},
                                 "rise_time": abs((s.y[0, -1] - run.at("theta", s.t[-1])) / s.y[3, -1])}
    fresh = {}
    for name, run in runs.items():
        fresh[name] = {}
        grid = run.bounds[0] + np.arange(int((run.bounds[-1] - run.bounds[0]) * 50000), dtype=LD) / 50000
        cycle = np.searchsorted(run.bounds, grid, side="right") - 1
        for q in CYCLED:
            v, c = run.at(q, grid), run.cycles
            low = np.minimum.reduceat(v, np.searchsorted(cycle, np.arange(len(c["start"]))))
            high = np.maximum.reduceat(v, np.searchsorted(cycle, np.arange(len(c["start"]))))
            fresh[name][q] = {"least_min_excess": np.min(low - c[q + "_min"]), "most_min_excess": np.max(low - c[q + "_min"]),
                              "least_max_excess": np.min(c[q + "_max"] - high), "most_max_excess": np.max(c[q + "_max"] - high)}
    out["extrema_against_samples_every_20_us"] = fresh
    return out


def main():
    if np.finfo(LD).nmant < 63:
        raise SystemExit("needs a long double with at least 64 bits of mantissa")
    begin = time.perf_counter()
    runs, values = report(FINE)
    _, coarse = report(COARSE)
    _, rounded = report(ROUNDED)
    result = {
        "about": {"numpy": np.__version__, "scipy": scipy.__version__, "python": sys.version.split()[0],
                  "steps": {q: len(r.steps) for q, r in runs.items()},
                  "units": "SI, rad", "differences": "B - A"},
        "values": values, "error": largest_in(difference(values, coarse)), "float64": largest_in(difference(values, rounded)),
        "checks": checks(runs, values)}
    here = os.path.dirname(os.path.abspath(__file__))
    path = sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "two_runs.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(plain(result), file, indent=1)
        file.write("\n")
    print(f"{time.perf_counter() - begin:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
