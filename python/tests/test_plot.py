"""Maps of sweeps."""

import matplotlib

matplotlib.use("Agg")

import numpy as np
import pandas
import polars as pl
import pyarrow as pa
import pytest
from matplotlib.collections import LineCollection, QuadMesh

import toprise
import toprise.plot

#: Some rise, some do not, one is wrong, some loop.
ROWS = {
    "friction_k": [0.01, 0.02, 0.04] * 2,
    "initial_psi_dot": [100.0] * 3 + [150.0] * 3,
    "rise_time": [3.0, None, 1.0, None, 2.0, None],
    "loops": [0, 0, 2, 0, 1, None],
    "stop_reason": ["risen", "fallen", "risen", "duration", "risen", None],
}


@pytest.mark.parametrize("library", [pa.table, pl.DataFrame, pandas.DataFrame])
def test_a_map_shows_values_and_why_there_are_none(library):
    axes = toprise.plot.map(library(ROWS), "friction_k", "initial_psi_dot")
    meshes = [part for part in axes.collections if isinstance(part, QuadMesh)]
    shown = meshes[0].get_array()
    assert np.ma.filled(shown, -1).tolist() == [[3.0, -1, 1.0], [-1, 2.0, -1]]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        "duration",
        "failed",
        "fallen",
    ]
    assert len(meshes) == 4 and len(axes.collections) == 5, "and the line around loops"
    assert axes.get_xscale() == "log" and axes.get_yscale() == "linear"


def drawn(rows):
    """The ends of the cells that are shown, and the lines around loops."""
    axes = toprise.plot.map(pl.DataFrame(rows), "friction_k", "initial_psi_dot")
    axes.figure.canvas.draw()
    corners = [part for part in axes.collections if isinstance(part, QuadMesh)][0].get_coordinates()
    lines = [part for part in axes.collections if isinstance(part, LineCollection)]
    return corners[0, :, 0].tolist(), corners[:, 0, 1].tolist(), [line for part in lines for line in part.get_segments()]


def test_a_map_of_one_column_has_cells():
    rows = {
        "friction_k": [0.05] * 3,
        "initial_psi_dot": [100.0, 150.0, 200.0],
        "rise_time": [3.0, 2.0, 1.0],
        "loops": [0, 0, 2],
        "stop_reason": ["risen"] * 3,
    }
    across, upward, lines = drawn(rows)
    assert across == pytest.approx([0.045, 0.055])
    assert upward == pytest.approx([75.0, 125.0, 175.0, 225.0])
    assert np.array(lines) == pytest.approx(np.array([[(0.045, 175.0), (0.055, 175.0)]]))


def test_a_line_surrounds_the_cells_that_loop():
    across, upward, lines = drawn(ROWS)
    k = np.sqrt([0.01 * 0.02, 0.02 * 0.04])
    assert across == pytest.approx([0.01 / np.sqrt(2), *k, 0.04 * np.sqrt(2)])
    assert upward == pytest.approx([75.0, 125.0, 175.0])
    # The right cell of the lower row loops, and the middle one of the upper row.
    expected = [
        [(k[1], 75.0), (k[1], 125.0)],
        [(k[0], 125.0), (k[0], 175.0)],
        [(k[1], 125.0), (k[1], 175.0)],
        [(k[0], 125.0), (k[1], 125.0)],
        [(k[1], 125.0), (across[-1], 125.0)],
    ]
    assert np.array(lines) == pytest.approx(np.array(expected))


def test_a_map_of_a_table_names_units():
    table = pa.table({"friction_k": [0.01, 0.02], "initial_psi_dot": [100.0, 100.0]})
    brief = toprise.Scenario("paper", {"stop.duration": 0.01})
    axes = toprise.plot.map(
        toprise.outcomes(table, brief), "friction_k", "initial_psi_dot", color="theta"
    )
    assert axes.get_ylabel() == "initial_psi_dot, rad/s" and axes.get_xlabel() == "friction_k"
    assert axes.get_legend() is None


def test_what_is_no_grid_is_refused():
    lacking = pl.DataFrame(ROWS).head(5)
    with pytest.raises(ValueError, match="do not form a grid"):
        toprise.plot.map(lacking, "friction_k", "initial_psi_dot")
    with pytest.raises(ValueError, match="no rows"):
        toprise.plot.map(lacking.head(0), "friction_k", "initial_psi_dot")


def test_keys_go_by_their_paths_too():
    rows = pl.DataFrame(ROWS)
    one, other = (toprise.plot.map(rows, *names) for names in (("friction_k", "initial_psi_dot"), ("friction.k", "initial.psi_dot")))
    assert one.get_xlabel() == other.get_xlabel() == "friction_k"
