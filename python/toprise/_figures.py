"""Figures of runs and of sweeps, as `toprise figures` draws them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from . import _toprise
from ._reports import AnyRun
from ._toprise import Figure


def figures(
    *runs: AnyRun,
    only: Iterable[str] = (),
    width: float = 85.0,
) -> dict[str, Figure]:
    """Draws runs: the figures of the paper and others, by name, each with all runs.

    `only` names the figures; otherwise all that apply are drawn. `width` is in mm, from 80 to 400; 130 or more gives two
    columns of plots. Notebooks show a figure; `figure.save("theta.svg")` writes one.

    Raises `ValueError` if a figure in `only` does not exist, or can't show these runs.
    """
    return dict(_toprise.figures(list(runs), only=list(only), width=width))


def map(  # noqa: A001: it draws a map
    table: Any,
    x: str,
    y: str | None = None,
    show: str = "rise_time",
    *,
    width: float = 85.0,
) -> Figure:
    """Draws a column of a sweep's outcomes: as a map over two keys, or as curves over one.

    `table` is the Parquet file of a sweep, or a table with the Arrow PyCapsule interface. `x` and `y` are keys such as
    `friction.k` or `friction_k`; each combination must have exactly one row. Runs without a value in `show` are coloured by
    the reason why they stopped. `width` is in mm, from 80 to 400.

    Raises `SweepError` if a column is missing, `ValueError` if there is nothing to draw or several runs are at one place.
    """
    return _toprise.map(table, x, y, show, width)
