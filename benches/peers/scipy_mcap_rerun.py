"""The same job with Python: SciPy integrates, `mcap` and `rerun-sdk` log state, torque and contact.

    pip install scipy==1.17.* mcap==1.6.0 rerun-sdk==0.36.3
    python benches/peers/scipy_mcap_rerun.py OUTPUT_DIRECTORY

It does what a careful Python user would: DOP853 with an event at θ = 0.02, dense output at 1 kHz, NumPy for
all derived quantities, JSON messages into a zstd-compressed MCAP, and `send_columns` into an .rrd file.
Compare with: toprise run --topics /top/state,/top/torque,/top/contact -o OUT.mcap --rrd OUT.rrd
"""

import json
import math
import sys
import time

import numpy as np
import rerun as rr
from mcap.writer import CompressionType, Writer
from scipy.integrate import solve_ivp

IX, IZ, M, L, R, G, K = 8.52e-5, 7.25e-5, 0.110, 0.020, 0.007, 9.81, 0.03
FRICTION, GRAVITY = K * M * G * R, M * G * L


def slope(_, y, lib=math):
    """Equations (7); `lib` is math for the integrator's single states, numpy for arrays."""
    _, th, _, ph, thd, ps = y
    s, c = lib.sin(th), lib.cos(th)
    f = FRICTION * ps / lib.sqrt(thd * thd + ps * ps * s * s)
    w = ps + ph * c
    return [
        ph,
        thd,
        ps,
        IZ * thd * w / (IX * s) - 2 * thd * ph * c / s + f * c / IX,
        -IZ * ph * s * w / IX + ph * ph * s * c + GRAVITY * s / IX,
        -IZ * thd * c * w / (IX * s) + 2 * thd * ph * c * c / s + thd * ph * s - f * (c * c / IX + s * s / IZ),
    ]


def risen(_, y):
    return y[1] - 0.02


risen.terminal = True


def body(node, psi):
    """Node components to body axes."""
    s, c = np.sin(psi), np.cos(psi)
    return np.stack([c * node[0] + s * node[1], -s * node[0] + c * node[1], node[2]])


def channels(t, y):
    """The three topics as dictionaries of columns."""
    phi, th, psi, phd, thd, psd = y
    s, c = np.sin(th), np.cos(th)
    dy = slope(0, y, np)
    v = np.sqrt(thd * thd + psd * psd * s * s)
    kf = FRICTION * psd / v
    zero = np.zeros_like(t)
    gravity = np.stack([GRAVITY * s, zero, zero])
    friction = np.stack([zero, kf * s * c, -kf * s * s])
    state = dict(phi=phi, theta=th, psi=psi, phi_dot=phd, theta_dot=thd, psi_dot=psd,
                 phi_ddot=dy[3], theta_ddot=dy[4], psi_ddot=dy[5])
    torque = dict(gravity_body=body(gravity, psi), friction_body=body(friction, psi),
                  total_body=body(gravity + friction, psi), gravity_node=gravity,
                  friction_node=friction, total_node=gravity + friction)
    slip_node = R * np.stack([psd * s, thd * c, -thd * s])
    sp, cp = np.sin(phi), np.cos(phi)
    lean, node = -R * thd, R * psd * s
    slip_world = np.stack([sp * lean + cp * node, sp * node - cp * lean, zero])
    force = -K * M * G * R * psd * s / (R * v)
    contact = dict(slip_body=body(slip_node, psi), slip_world=slip_world, slip_speed=R * v,
                   friction_force=np.stack([cp * force, sp * force, zero]),
                   normal_force=np.full_like(t, M * G), contact_point=np.zeros((3, len(t))),
                   slip_path=np.concatenate([[0], np.cumsum(R * (v[1:] + v[:-1]) / 2 * np.diff(t))]),
                   regime=np.ones_like(t))
    return {"/top/state": state, "/top/torque": torque, "/top/contact": contact}


def write_mcap(path, t, topics):
    with open(path, "wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start()
        ids = {}
        for topic in topics:
            schema = writer.register_schema(topic, "jsonschema", b'{"type":"object"}')
            ids[topic] = writer.register_channel(topic, "json", schema)
        rows = {topic: {k: v.T.tolist() for k, v in columns.items()} for topic, columns in topics.items()}
        for i, ns in enumerate(np.round(t * 1e9).astype(int).tolist()):
            stamp = {"sec": ns // 10**9, "nsec": ns % 10**9}
            for topic, columns in rows.items():
                message = {"timestamp": stamp}
                for key, values in columns.items():
                    value = values[i]
                    message[key] = dict(zip("xyz", value)) if isinstance(value, list) else value
                data = json.dumps(message, separators=(",", ":")).encode()
                writer.add_message(ids[topic], ns, data, ns, i)
        writer.finish()


def write_rrd(path, t, topics):
    rr.init("toprise-peer")
    rr.save(path)
    for topic, columns in topics.items():
        for key, values in columns.items():
            scalars = np.atleast_2d(values).T
            column = rr.Scalars.columns(scalars=scalars.reshape(-1)).partition([scalars.shape[1]] * len(t))
            rr.send_columns(f"{topic}/{key}", indexes=[rr.TimeColumn("sim_time", duration=t)], columns=column)


def main():
    directory = sys.argv[1]
    began = time.perf_counter()
    solution = solve_ivp(lambda t, y: slope(t, y.tolist()), (0, 60), [0, 0.5, 0, 1.75, 0, 170.0], method="DOP853", rtol=1e-12, atol=1e-12,
                         events=risen, dense_output=True)
    t = np.arange(int(solution.t[-1] * 1000) + 1) / 1000
    topics = channels(t, solution.sol(t))
    integrated = time.perf_counter()
    write_mcap(f"{directory}/peer.mcap", t, topics)
    archived = time.perf_counter()
    write_rrd(f"{directory}/peer.rrd", t, topics)
    ended = time.perf_counter()
    print(f"rise {solution.t[-1]:.6f} s; integrate {integrated - began:.2f} s, MCAP {archived - integrated:.2f} s, "
          f"Rerun {ended - archived:.2f} s, in all {ended - began:.2f} s")


if __name__ == "__main__":
    main()
