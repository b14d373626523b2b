"""Tables for NumPy and through the Arrow PyCapsule interface."""

import gc

import duckdb
import numpy as np
import pandas
import polars as pl
import pyarrow as pa
import pytest

import toprise


def address(array):
    return array.__array_interface__["data"][0]


def test_numbers_are_shared_not_copied(paper):
    table = paper["/top/state"]
    view = table.numpy("theta")
    arrow = pa.table(table)
    assert address(view) == address(table.numpy("theta"))
    assert address(view) == arrow["theta"].chunk(0).buffers()[1].address
    assert address(view) == address(pl.DataFrame(table)["theta"].to_numpy(allow_copy=False))
    assert arrow["theta"].num_chunks == 1


def test_views_are_read_only_and_outlive_the_run():
    view = toprise.run("paper", {"stop.duration": 0.1})["/top/state"].numpy("theta")
    arrow = pa.table(toprise.run("paper", {"stop.duration": 0.1})["/top/state"])
    gc.collect()
    assert view[0] == 0.5 and view.shape == (101,) and view.dtype == np.float64
    assert arrow["theta"][0].as_py() == 0.5
    with pytest.raises(ValueError, match="read-only"):
        view[0] = 1.0
    with pytest.raises(ValueError):
        view.flags.writeable = True


def test_a_table_knows_its_units(brief):
    table = brief["/top/pose"]
    assert table.name == "/top/pose" and len(table) == 101
    assert table.units["omega_body_x"] == "rad/s"
    schema = pa.schema(table)
    field = schema.field("omega_body_x")
    assert field.metadata[b"unit"] == b"rad/s"
    assert field.metadata[b"frame"] == b"body"
    assert field.metadata[b"path"] == b"omega_body.x"
    assert b"angular velocity" in field.metadata[b"meaning"]
    assert not field.nullable
    assert schema.metadata[b"topic"] == b"/top/pose"
    assert schema == pa.table(table).schema
    assert np.shares_memory(table.numpy("omega_body.x"), table.numpy("omega_body_x"))


def test_every_column_has_a_plain_name_of_its_own():
    for preset in ("paper", "drop"):
        run = toprise.run(preset, {"stop.duration": 0.01})
        for topic in run:
            names = run[topic].column_names
            assert len(set(names)) == len(names)
            assert all(name.isidentifier() for name in names)
            assert names[:2] == ["time_ns", "sequence"] and "time" in names


def test_times_are_in_seconds_and_exact_in_nanoseconds(brief):
    state, events = brief["/top/state"], brief.events
    assert state.numpy("time_ns").dtype == np.int64
    assert state.numpy("time_ns").tolist() == [1_000_000 * n for n in range(101)]
    assert state.numpy("time").tolist() == [n / 1000 for n in range(101)]
    assert events.numpy("name")[0] == "start"
    assert np.abs(events.numpy("time") - events.numpy("time_ns") / 1e9).max() < 1e-9


def test_empty_tables_are_tables():
    run = toprise.run("paper", {"stop.duration": 1e-9})
    assert len(run.nutations) == 0
    assert run.nutations.numpy("period").shape == (0,)
    assert pa.table(run.nutations).num_rows == 0
    assert pl.DataFrame(run.nutations).shape == (0, len(run.nutations.column_names))


def test_a_stream_can_be_left_unread_and_read_once(brief):
    brief.events.__arrow_c_stream__()
    brief.events.__arrow_c_schema__()
    capsule = brief.events.__arrow_c_stream__(requested_schema=None)
    reader = pa.RecordBatchReader._import_from_c_capsule(capsule)
    assert reader.read_all().num_rows == len(brief.events)
    with pytest.raises(ValueError):
        pa.RecordBatchReader._import_from_c_capsule(capsule)


def test_print_shows_values_and_units(brief):
    state = brief["/top/state"]
    lines = repr(state).splitlines()
    assert lines[1].startswith("101 rows")
    assert lines[3].split()[:3] == ["time_ns", "sequence", "time"]
    assert "rad/s" in lines[4]
    assert lines[5].split()[0] == "0" and "0.5" in lines[5].split()
    assert lines[9].split()[0] == "…" and len(lines) in (14, 15)
    assert all(len(line) <= 100 for line in lines[3:14])
    assert state.meanings["theta_dot"].startswith("nutation rate")
    html = state._repr_html_()
    assert html.count("<tr>") == 1 + 4 + 1 + 4
    assert "<td>0.5</td>" in html and "rad/s²" in html
    assert brief.nutations._repr_html_().count("<tr>") == 1 + len(brief.nutations)
    assert "/top/state                 101 rows" in repr(brief)


def test_indexing_returns_columns(brief):
    state = brief["/top/state"]
    assert np.shares_memory(state["theta"], state.numpy("theta"))
    assert state.columns == state.column_names == list(state)
    assert "theta" in state and "phi" in state and "x" not in state
    with pytest.raises(KeyError, match="no column thet"):
        state["thet"]


def test_tables_become_frames(brief):
    for table in (brief["/top/state"], brief.events):
        for frame in (table.to_pandas(), table.to_polars()):
            assert list(frame.columns) == table.columns and len(frame) == len(table)
            assert list(frame["time_ns"]) == table["time_ns"].tolist()


def test_numeric_tables_are_arrays(brief):
    state = brief["/top/state"]
    array = np.asarray(state)
    assert array.shape == (101, len(state.columns)) and array.dtype == np.float64
    assert (array[:, state.columns.index("theta")] == state["theta"]).all()
    assert np.asarray(state, dtype=np.float32).dtype == np.float32
    with pytest.raises(TypeError, match="the column name has texts"):
        np.asarray(brief.events)


def test_run_repr_has_changes_and_outcome(brief, reference):
    assert repr(brief).startswith("<toprise.Run paper, stop.duration = 0.1: ")
    assert "at t = 0.100000 s" in repr(brief).splitlines()[0]
    recorded = toprise.read(reference / "paper.mcap", topics=["/events"])
    assert "risen at t = 24.719386 s" in repr(recorded).splitlines()[0]


def test_duckdb_and_pandas_read_tables(brief):
    state = brief["/top/state"]
    found = duckdb.sql("SELECT count(*), max(theta) FROM state").fetchall()
    assert found == [(101, state.numpy("theta").max())]
    frame = pandas.DataFrame.from_arrow(brief.events)
    assert frame["name"][0] == "start"


def test_a_run_in_a_notebook_shows_its_outcome(brief, reference):
    page = brief._repr_html_()
    assert page.startswith("<p>paper: <code>run.rerun()</code>")
    assert page.count("<svg ") == 1 and "<?xml" not in page
    assert "<th>stop_reason</th><td>duration</td>" in page
    read = toprise.read(reference / "paper.mcap", topics=["/top/state", "/top/nutation"])._repr_html_()
    assert "<th>/top/state</th>" in read and "<svg " in read
