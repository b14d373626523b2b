"""Maps of sweeps with Matplotlib: `pip install toprise[plot]`."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

from ._toprise import Table

#: Colours of runs without a value, by `stop_reason`; "failed" means the row has an error.
_COLORS = {
    "fallen": "#b2182b",
    "duration": "#bdbdbd",
    "failed": "#1a1a1a",
}
_OTHER = "#74a9cf"


def map(  # noqa: A001: it draws a map
    table: Any,
    x: str,
    y: str,
    color: str = "rise_time",
    ax: Axes | None = None,
) -> Axes:
    """Draws one outcome column as a map over two keys.

    `table` is a `Table`, or a sweep file read with pyarrow, Polars or pandas. `x` and `y` are two keys such as
    `friction.k` or `friction_k`; each combination must have exactly one row. Rows without a value in `color` are
    coloured by stop reason. A line encloses the runs in which the axis loops. An axis is logarithmic if the values of
    its key are evenly spaced on a log scale.
    """
    x, y, color = (name.replace(".", "_") for name in (x, y, color))
    xs, ys, values = (_column(table, name).astype(float) for name in (x, y, color))
    if len(xs) == 0:
        raise ValueError("the table has no rows: there is nothing to draw")
    found = _column(table, "stop_reason").astype(object)
    reasons = np.array([reason if isinstance(reason, str) else "failed" for reason in found])
    is_without = ~np.isfinite(values)
    columns, column = np.unique(xs, return_inverse=True)
    rows, row = np.unique(ys, return_inverse=True)
    if len(columns) * len(rows) != len(xs) or len(set(zip(column, row))) != len(xs):
        raise ValueError(f"{x} and {y} do not form a grid: each pair of values needs exactly one run")

    ax = ax or plt.subplots()[1]
    is_log = [_is_logarithmic(levels) for levels in (columns, rows)]
    edges = [_edges(levels, log) for levels, log in zip((columns, rows), is_log)]
    grid = np.full((len(rows), len(columns)), np.nan)
    grid[row, column] = values
    if np.isfinite(grid).any():
        mesh = ax.pcolormesh(*edges, np.ma.masked_invalid(grid))
        ax.figure.colorbar(mesh, ax=ax, label=_label(table, color))
    legend = []
    for reason in sorted(set(reasons[is_without])):
        mask = np.full(grid.shape, np.nan)
        mask[row, column] = np.where(is_without & (reasons == reason), 1.0, np.nan)
        shade = _COLORS.get(reason, _OTHER)
        ax.pcolormesh(*edges, np.ma.masked_invalid(mask), cmap=ListedColormap([shade]))
        legend.append(Patch(color=shade, label=reason))
    loops = np.zeros(grid.shape)
    loops[row, column] = np.nan_to_num(_column(table, "loops").astype(float))
    if (loops > 0).any() and (loops == 0).any():
        ax.add_collection(LineCollection(_boundary(loops > 0, *edges), colors="white", linewidths=1))
    if legend:
        ax.legend(handles=legend)
    ax.set(xlabel=_label(table, x), ylabel=_label(table, y))
    if is_log[0]:
        ax.set_xscale("log")
    if is_log[1]:
        ax.set_yscale("log")
    return ax


def _edges(levels: Any, is_log: bool) -> Any:
    """The cell boundaries, halfway between neighbouring levels. A single level gets a tenth of its value on both sides."""
    if len(levels) == 1:
        room = 0.1 * abs(levels[0]) or 1.0
        return np.array([levels[0] - room, levels[0] + room])
    places = np.log(levels) if is_log else levels
    between = (places[:-1] + places[1:]) / 2
    ends = 2 * places[0] - between[0], 2 * places[-1] - between[-1]
    edges = np.concatenate([[ends[0]], between, [ends[1]]])
    return np.exp(edges) if is_log else edges


def _boundary(inside: Any, xs: Any, ys: Any) -> list[Any]:
    """The edges between cells inside and outside, as line segments."""
    lines = []
    for row, column in zip(*np.nonzero(inside[:, :-1] != inside[:, 1:])):
        x = xs[column + 1]
        lines.append([(x, ys[row]), (x, ys[row + 1])])
    for row, column in zip(*np.nonzero(inside[:-1] != inside[1:])):
        y = ys[row + 1]
        lines.append([(xs[column], y), (xs[column + 1], y)])
    return lines


def _column(table: Any, name: str) -> Any:
    return table.numpy(name) if isinstance(table, Table) else np.asarray(table[name])


def _label(table: Any, name: str) -> str:
    unit = table.units[name] if isinstance(table, Table) else ""
    return f"{name}, {unit}" if unit else name


def _is_logarithmic(values: Any) -> bool:
    """Whether the values are evenly spaced on a log scale, and not on a linear one."""
    if len(values) < 3 or values[0] <= 0:
        return False

    def is_even(values: Any) -> bool:
        steps = np.diff(values)
        # Allows for rounding of the values.
        return bool(np.ptp(steps) < 1e-6 * steps[0])

    return is_even(np.log(values)) and not is_even(values)
