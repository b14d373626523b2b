"""Fitting friction with Python: SciPy's `curve_fit` over `solve_ivp`.

    pip install scipy==1.17.*
    python benches/peers/scipy_fit.py tests/data/fit/offset_camera.csv

It does what a careful Python user would: DOP853 at 1e-10, sampled at the times of the data, Levenberg–Marquardt with
forward differences, sigma given. The starts are the same as for toprise: k wrong by a factor of 0.33 to 3, the spin by
−10 or +3 %. Compare with:

    toprise fit full-coulomb tests/data/fit/offset_camera.csv --signal theta:1.5mrad --signal phi:1.5mrad \
        --free friction.k,initial --set top.mass=0.0873 --set top.center_distance=0.0274 \
        --set top.transverse_moment=0.0001134 --set top.axial_moment=6.21e-05 --set top.peg_radius=0.0046 \
        --set initial.theta=0.55 --set initial.phi=0.4 --set initial.phi_dot=1.9 \
        --set friction.k=0.0128 --set initial.psi_dot=187.2
"""

import sys
import time

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import curve_fit

IX, IZ, M, L, R, G = 1.134e-4, 6.21e-5, 0.0873, 0.0274, 0.0046, 9.81
SIGMA = 1.5e-3
TRUTH = {"k": 0.0388, "psi_dot": 208.0}


def slope(_, y, k):
    """The full friction torque −K ω_⊥/|ω_⊥| in Euler angles."""
    _, th, _, ph, thd, ps = y
    s, c = np.sin(th), np.cos(th)
    v = np.sqrt(thd * thd + ps * ps * s * s)
    friction = k * M * G * R
    w = ps + ph * c
    f = friction * ps / v
    return [
        ph,
        thd,
        ps,
        IZ * thd * w / (IX * s) - 2 * thd * ph * c / s + f * c / IX,
        -IZ * ph * s * w / IX + ph * ph * s * c + M * G * L * s / IX - friction * thd / (v * IX),
        -IZ * thd * c * w / (IX * s) + 2 * thd * ph * c * c / s + thd * ph * s - f * (c * c / IX + s * s / IZ),
    ]


def model(times, k, phi, theta, phi_dot, theta_dot, psi_dot):
    start = [phi, theta, 0.0, phi_dot, theta_dot, psi_dot]
    times = times[: len(times) // 2]
    run = solve_ivp(slope, (0, times[-1]), start, "DOP853", times, args=(k,), rtol=1e-10, atol=1e-10)
    if run.y.shape[1] < len(times):
        return np.full(2 * len(times), 1e6)
    return np.concatenate([run.y[1], run.y[0]])


def main():
    table = np.loadtxt(sys.argv[1], delimiter=",", skiprows=1)
    times = np.concatenate([table[:, 0], table[:, 0]])
    values = np.concatenate([table[:, 1], np.unwrap(table[:, 2])])
    sigma = np.full(len(values), SIGMA)
    found, seconds = 0, []
    for factor in (0.33, 0.6, 1.5, 3.0):
        for spin in (0.9, 1.03):
            start = [factor * TRUTH["k"], 0.4, 0.55, 1.9, 0.0, spin * TRUTH["psi_dot"]]
            began = time.perf_counter()
            try:
                best, covariance = curve_fit(model, times, values, start, sigma, absolute_sigma=True, maxfev=400)
                chi2 = np.sum(((model(times, *best) - values) / sigma) ** 2)
                text = f"k = {best[0]:.6f} ± {np.sqrt(covariance[0, 0]):.6f}, χ²/ν = {chi2 / (len(values) - 6):.3f}"
                found += chi2 < 1.5 * len(values)
            except (RuntimeError, ValueError) as error:
                text = str(error)
            seconds.append(time.perf_counter() - began)
            print(f"k × {factor}, ψ̇ × {spin}: {seconds[-1]:.1f} s, {text}", flush=True)
    print(f"{found} of {len(seconds)} starts converged; median {np.median(seconds):.1f} s")


if __name__ == "__main__":
    main()
