"""The type of an outcome."""

from __future__ import annotations

from typing import TypedDict


class Outcome(TypedDict):
    """Outcome of a run: the columns of a sweep. `None` means that it did not happen."""

    stop_reason: str
    stop_time: float
    rise_time: float | None
    weak_time: float | None
    loop_time: float | None
    loops: int
    nutations: int
    theta: float
    phi_dot: float
    theta_dot: float
    psi_dot: float
    turns: float
    energy_at_start: float
    energy: float
    friction_work: float
    slip_path: float
    roll_time: float | None
    inversion_time: float | None
    hops: int | None
    impacts: int | None
    steps: int
