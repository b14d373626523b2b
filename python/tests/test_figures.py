"""Figures of runs and maps of sweeps."""

import pandas
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import toprise

#: Some rise, some do not, one is wrong, some loop.
ROWS = {
    "friction_k": [0.01, 0.02, 0.04] * 2,
    "initial_psi_dot": [100.0] * 3 + [150.0] * 3,
    "rise_time": [3.0, None, 1.0, None, 2.0, None],
    "loops": [0, 0, 2, 0, 1, None],
    "stop_reason": ["risen", "fallen", "risen", "duration", "risen", None],
}


def test_figures_are_those_of_the_program(brief, tmp_path):
    figures = toprise.figures(brief, only=["energy", "figure-2"])
    assert list(figures) == ["energy", "figure-2"]
    figure = figures["energy"]
    assert "<svg" in figure.svg and figure._repr_svg_() == figure.svg
    assert figure.png().startswith(b"\x89PNG")
    figure.save(tmp_path / "energy.svg")
    assert (tmp_path / "energy.svg").read_text() == figure.svg
    figure.save(tmp_path / "energy.png")
    assert (tmp_path / "energy.png").read_bytes() == figure.png()


def test_all_figures_that_apply_are_drawn(brief):
    one = toprise.figures(brief)
    two = toprise.figures(brief, "full-coulomb", width=170)
    assert "energy" in one and "track" not in one
    assert set(one) < set(two)
    assert "full-coulomb" in two["energy"].svg


def test_equal_names_are_numbered(brief):
    assert "(2)" in toprise.figures(brief, brief, only=["energy"], width=130)["energy"].svg


@pytest.mark.parametrize(
    ("only", "width", "message"),
    [
        (["figure-7"], 85, "figures: .*energy"),
        (["track"], 85, "peg is fixed"),
        (["figure-4"], 85, "at least"),
        (["energy"], 20, "80 to 400"),
    ],
)
def test_what_cannot_be_drawn_is_said(brief, only, width, message):
    with pytest.raises(ValueError, match=message):
        toprise.figures(brief, only=only, width=width)


@pytest.mark.parametrize("library", [pa.table, pl.DataFrame, pandas.DataFrame])
def test_maps_of_all_libraries_are_equal(library):
    figure = toprise.map(library(ROWS), "friction_k", "initial_psi_dot")
    assert figure.svg == toprise.map(pa.table(ROWS), "friction.k", "initial.psi_dot").svg
    # Without the reasons the map has fewer colours, and its legend fewer entries.
    fewer = {name: cells for name, cells in ROWS.items() if name != "stop_reason"}
    assert len(toprise.map(library(fewer), "friction_k", "initial_psi_dot").svg) < len(figure.svg)


def test_maps_of_a_file_are_those_of_its_table(tmp_path):
    spec = {
        "bases": ["paper"],
        "set": {"stop.duration": 0.02},
        "over": {"friction.k": "0.02..0.05/3", "initial.psi_dot": "120..180/2"},
    }
    toprise.sweep(spec, tmp_path / "map.parquet")
    names = ("friction_k", "initial_psi_dot", "theta")
    table = pq.read_table(tmp_path / "map.parquet")
    assert toprise.map(tmp_path / "map.parquet", *names).svg == toprise.map(table, *names).svg
    slow = pl.DataFrame(table).filter(pl.col("initial_psi_dot") == 120)
    curves = toprise.map(slow, "friction_k", show="theta")
    assert "<svg" in curves.svg


def test_what_is_no_map_is_said():
    rows = pl.DataFrame(ROWS)
    with pytest.raises(toprise.SweepError, match="no column mass; columns: friction_k"):
        toprise.map(rows, "mass", "initial_psi_dot")
    with pytest.raises(ValueError, match="no run"):
        toprise.map(rows.head(0), "friction_k", "initial_psi_dot")
    with pytest.raises(ValueError):
        toprise.map(pl.concat([rows, rows]), "friction_k", "initial_psi_dot")
