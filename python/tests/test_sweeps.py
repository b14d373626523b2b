"""Outcomes of tables, and sweeps."""

import hashlib
import os
import pickle
import signal
import subprocess
import sys

import duckdb
import numpy as np
import pandas
import polars as pl
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import toprise

BRIEF = toprise.Scenario("paper", {"stop.duration": 0.02})
FRICTIONS = [0.01, 0.02, 0.05, 0.1]
#: What each friction comes to, one run at a time.
EXPECTED = [toprise.outcome(BRIEF, {"friction.k": k}) for k in FRICTIONS]


def rows(table):
    if isinstance(table, pandas.DataFrame):
        # Missing numbers are NaN there.
        return pa.Table.from_pandas(table).to_pylist()
    if isinstance(table, pa.RecordBatch):
        return table.to_pylist()
    return pa.table(table).to_pylist()


def is_expected(table, expected=EXPECTED):
    found = rows(table)
    assert len(found) == len(expected)
    for row, outcome in zip(found, expected):
        assert {name: row[name] for name in outcome} == outcome
        assert row["error"] is None and len(row["scenario_digest"]) == 64
        assert row["scenario"] == "paper"
    return True


def unaligned(numbers):
    buffer = pa.py_buffer(b"\0" + np.array(numbers).tobytes()).slice(1)
    assert buffer.address % 8 != 0
    return pa.Array.from_buffers(pa.float64(), len(numbers), [None, buffer])


def sliced(numbers):
    return pa.array([7.0, *numbers, 8.0]).slice(1, len(numbers))


@pytest.mark.parametrize(
    "column",
    [
        pa.array(FRICTIONS),
        unaligned(FRICTIONS),
        sliced(FRICTIONS),
        pa.array(FRICTIONS).dictionary_encode(),
        pa.chunked_array([FRICTIONS[:1], [], FRICTIONS[1:]], pa.float64()),
    ],
    ids=["plain", "unaligned", "sliced", "dictionary", "chunked"],
)
def test_numbers_come_in_every_form(column):
    assert is_expected(toprise.outcomes(pa.table({"friction_k": column}), BRIEF))


def test_numbers_come_from_every_library():
    columns = {"friction.k": FRICTIONS}
    arrow = pa.table(columns)
    for table in (arrow, arrow.to_batches()[0], pl.DataFrame(columns), pandas.DataFrame(columns)):
        assert is_expected(toprise.outcomes(table, BRIEF))
        made = toprise.Outcomes(BRIEF)(table)
        assert type(made) is type(table)
        assert is_expected(made)
    relation = duckdb.sql("SELECT unnest([0.01, 0.02, 0.05, 0.1]::DOUBLE[]) AS friction_k")
    assert is_expected(toprise.outcomes(relation, BRIEF))
    assert is_expected(toprise.outcomes(arrow.to_reader(), BRIEF))


def test_words_are_values_too():
    laws = pl.DataFrame({"friction.dissipation": ["full", "without-nutation-part"]})
    for table in (laws, pa.table(laws), laws.cast(pl.Categorical)):
        found = rows(toprise.outcomes(table, BRIEF))
        assert found[0]["scenario_digest"] != found[1]["scenario_digest"]
        assert found[1]["scenario_digest"] == BRIEF.digest


def test_a_null_leaves_the_base_as_it_is():
    for column in (pa.array([None, 0.03]), pa.array([0.03, None]), pa.nulls(2)):
        found = rows(toprise.outcomes(pa.table({"friction_k": column}), BRIEF))
        assert [row["scenario_digest"] for row in found] == [BRIEF.digest] * 2


def test_rows_that_cannot_be_run_say_why():
    wrong = pa.table({"friction_k": [0.03, float("nan"), -1.0, float("inf")]})
    found = rows(toprise.outcomes(wrong, BRIEF))
    assert found[0]["error"] is None
    assert "friction.k = NaN" in found[1]["error"]
    assert found[2]["error"] == "friction.k = -1: must be a number from 0 to 100"
    assert "friction.k = inf" in found[3]["error"]
    assert found[1]["stop_reason"] is None and found[1]["theta"] is None
    over = toprise.outcomes(pa.table({"friction_k": [0.03]}), BRIEF, max_steps=1)
    assert rows(over)[0]["error"] == "not finished within 1 steps"


def test_no_rows_give_no_outcomes():
    some = toprise.outcomes(pa.table({"friction_k": [0.03]}), BRIEF)
    none = toprise.outcomes(pa.table({"friction_k": pa.array([], pa.float64())}), BRIEF)
    assert len(none) == 0 and pa.schema(none) == pa.schema(some)
    nothing = toprise.outcomes(pl.DataFrame({"friction_k": []}, schema={"friction_k": pl.Float64}), BRIEF)
    assert pa.schema(nothing) == pa.schema(some)


def test_tables_that_make_no_sense_are_refused():
    with pytest.raises(toprise.ScenarioError, match=r"did you mean friction.k\?"):
        toprise.outcomes(pa.table({"friction.kk": [1.0]}), BRIEF)
    with pytest.raises(toprise.ScenarioError, match="friction_k: .*neither numbers nor words"):
        toprise.outcomes(pa.table({"friction_k": [[1.0]]}), BRIEF)
    with pytest.raises(toprise.ScenarioError, match="friction_k"):
        toprise.outcomes(pa.table({"friction_k": ["much"]}), BRIEF)
    bases = {"scenario": pa.array(["paper", "viscous"]).dictionary_encode(), "friction_k": [0.03, 0.03]}
    with pytest.raises(ValueError, match="several bases, paper and viscous"):
        toprise.outcomes(pa.table(bases), BRIEF)
    with pytest.raises(TypeError, match="PyCapsule interface, not"):
        toprise.outcomes([0.03], BRIEF)


def test_other_columns_go_through_if_they_are_named():
    table = pa.table({"run": [7, 8], "label": ["a", None], "friction_k": [0.01, 0.02]})
    found = toprise.outcomes(table, BRIEF, keep=["label"])
    assert [(row["run"], row["label"]) for row in rows(found)] == [(7, "a"), (8, None)]
    with pytest.raises(toprise.ScenarioError, match="unknown key label"):
        toprise.outcomes(table, BRIEF)
    with pytest.raises(ValueError, match="no column lable; it has run, label, friction_k"):
        toprise.outcomes(table, BRIEF, keep=["label", "lable"])
    # Keys go by both of their names.
    assert toprise.outcomes(table, BRIEF, keep=["label", "friction.k"]).column_names == found.column_names


def test_a_key_that_is_kept_is_applied():
    table = pa.table({"friction_k": FRICTIONS, "label": list("abcd")})
    found = toprise.outcomes(table, BRIEF, keep=["friction_k", "label"])
    assert is_expected(found)
    assert pa.table(found)["friction_k"].to_pylist() == FRICTIONS
    assert pa.table(found).column_names.count("friction_k") == 1


def test_columns_are_not_kept_twice():
    for name in ("stop_reason", "theta", "error"):
        table = pa.table({"friction_k": [0.02], name: [None]})
        with pytest.raises(ValueError, match=f"outcomes have a column {name} too"):
            toprise.outcomes(table, BRIEF, keep=[name])


def test_the_index_of_pandas_is_no_key():
    frame = pandas.DataFrame({"friction_k": [*FRICTIONS, 0.2]})
    for some in (frame[frame.friction_k != 0.2], frame[:4].set_axis(list("abcd"))):
        assert is_expected(toprise.outcomes(some, BRIEF))
        made = toprise.Outcomes(BRIEF)(some)
        assert is_expected(made.reset_index(drop=True))
        assert list(made.index) == list(some.index)
    nothing = frame[frame.friction_k > 1]
    assert len(toprise.outcomes(nothing, BRIEF)) == 0
    # Keys may be the index too.
    assert is_expected(toprise.outcomes(frame[:4].set_index("friction_k"), BRIEF))


def test_decimals_are_the_numbers_next_to_them():
    relation = duckdb.sql("SELECT unnest([0.01, 0.02, 0.05, 0.1]) AS friction_k")
    assert pa.types.is_decimal(relation.arrow().schema.field(0).type)
    assert is_expected(toprise.outcomes(relation, BRIEF))
    for kind in (pa.decimal64(5, 3), pa.decimal128(20, 10), pa.decimal256(60, 30)):
        column = pa.array(map(str, FRICTIONS)).cast(kind)
        assert is_expected(toprise.outcomes(pa.table({"friction_k": column}), BRIEF))


def test_rows_that_are_null_as_a_whole_leave_the_base_as_it_is():
    fields = [pa.array([0.05, 0.0, 0.1])]
    mask = pa.array([False, True, False])
    rows_ = pa.StructArray.from_arrays(fields, ["friction_k"], mask=mask)
    found = rows(toprise.outcomes(rows_, BRIEF))
    assert [row["friction_k"] for row in found] == [0.05, None, 0.1]
    assert found[1]["scenario_digest"] == BRIEF.digest


def test_columns_are_found_by_names_with_dots():
    table = toprise.outcomes(pa.table({"friction_k": FRICTIONS}), BRIEF)
    assert table.numpy("friction.k").tolist() == FRICTIONS


def test_threads_do_not_change_outcomes():
    table = pa.table({"friction_k": np.geomspace(0.005, 0.1, 50)})
    one, two = (pa.table(toprise.outcomes(table, BRIEF, threads=n)) for n in (1, 2))
    assert one == two and one.num_rows == 50


def test_outcomes_travel():
    table = pl.DataFrame({"friction_k": FRICTIONS})
    outcomes = pickle.loads(pickle.dumps(toprise.Outcomes(BRIEF, keys=["friction_k"])))
    made = outcomes(table)
    assert isinstance(made, pl.DataFrame) and is_expected(made)
    batches = list(outcomes.batches(iter(pa.table(table).to_batches(max_chunksize=3))))
    assert [batch.num_rows for batch in batches] == [3, 1]
    assert all(batch.schema == pa.schema(outcomes.schema) for batch in batches)
    assert is_expected(pa.Table.from_batches(batches))


def test_missing_values_are_nan_for_numpy():
    table = toprise.outcomes(pa.table({"friction_k": [0.03, -1.0]}), BRIEF)
    assert np.isnan(table.numpy("rise_time")).all()
    theta, hops = table.numpy("theta"), table.numpy("hops")
    assert theta[0] > 0.4 and np.isnan(theta[1]) and np.isnan(hops).all()
    assert table.numpy("stop_reason").tolist() == ["duration", None]
    assert table.units["rise_time"] == "s"
    assert "<td></td>" in table._repr_html_()


SPEC = {
    "bases": ["paper"],
    "set": {"stop.duration": 0.005},
    "over": {"friction.k": "0.01..0.1/40log", "initial.psi_dot": list(range(100, 160))},
}


def test_a_design_is_the_rows_of_a_sweep(tmp_path):
    design = toprise.design(SPEC, 58, 62)
    assert design.numpy("run").tolist() == [58, 59, 60, 61]
    assert design.numpy("initial_psi_dot").tolist() == [158, 159, 100, 101]
    assert len(toprise.design(SPEC)) == 2400
    file = tmp_path / "spec.toml"
    file.write_text(
        '[over]\n"friction.k" = "0.01..0.1/40log"\n"initial.psi_dot" = "100..159/60"\n'
    )
    assert pa.table(toprise.design(file)) == pa.table(toprise.design(SPEC))
    with pytest.raises(ValueError, match="rows 0 to 2401: the sweep has 2400"):
        toprise.design(SPEC, 0, 2401)
    with pytest.raises(toprise.ScenarioError, match="did you mean friction.k"):
        toprise.design({"over": {"friction.kk": [1]}})
    with pytest.raises(toprise.ScenarioError, match="unknown preset"):
        toprise.design({"bases": ["papr"]})
    with pytest.raises(toprise.SweepError, match="friction.k is both set and varied"):
        toprise.design({"set": {"friction.k": 0.1}, "over": {"friction.k": [1]}})
    with pytest.raises(toprise.SweepError, match="ovr"):
        toprise.design({"ovr": {}})
    with pytest.raises(FileNotFoundError):
        toprise.design(tmp_path / "missing.toml")


def test_a_sweep_is_written_once_whatever_computes_it(tmp_path):
    reports = []
    whole = tmp_path / "whole.parquet"
    answer = toprise.sweep(SPEC, whole, progress=lambda done, of: reports.append((done, of)))
    assert answer["stops"] == {"duration": 2400} and answer["errors"] == 0
    assert answer["runs"] == answer["computed"] == 2400
    assert answer["is_merged"] and reports[-1] == (2400, 2400)
    parts = tmp_path / "parts.parquet"
    for shard in (2, 0, 1):
        toprise.sweep(SPEC, parts, shard=(shard, 3), threads=1)
    assert not parts.exists()
    toprise.sweep(SPEC, parts)
    assert whole.read_bytes() == parts.read_bytes()
    table = pq.read_table(whole)
    inline = toprise.outcomes(toprise.design(SPEC), toprise.Scenario("paper", SPEC["set"]))
    assert pa.table(inline).select(table.column_names).to_pylist() == table.to_pylist()
    # All is there already.
    again = toprise.sweep(SPEC, whole)
    assert (answer["kept"], again) == (0, answer | {"computed": 0, "kept": 2400})
    with pytest.raises(toprise.SweepError, match="belongs to another sweep"):
        toprise.sweep(SPEC | {"set": {"stop.duration": 0.01}}, whole)
    with pytest.raises(ValueError, match="shard"):
        toprise.sweep(SPEC, parts, shard=(3, 3))


def test_a_row_is_run_again(tmp_path):
    table = tmp_path / "a.parquet"
    toprise.sweep({"set": SPEC["set"], "over": {"friction.k": [0.01, 0.02, 0.03]}}, table)
    run = toprise.run(table, row=1)
    row = pq.read_table(table).to_pylist()[1]
    assert run.scenario["friction.k"] == 0.02
    assert run.scenario.digest == row["scenario_digest"]
    assert run.outcome["theta"] == row["theta"]
    assert toprise.run(table, {"sampling.period": 0.0005}, row=1).scenario["sampling.period"] == 0.0005
    with pytest.raises(toprise.SweepError, match="no row 3"):
        toprise.run(table, row=3)
    with pytest.raises(TypeError, match="name the file"):
        toprise.run(run.scenario, row=1)


def test_specs_may_have_numbers_of_numpy_and_none(tmp_path):
    spec = {
        "set": {"stop.duration": np.float64(0.005), "initial.psi_dot": np.int64(150)},
        "over": {"friction.k": np.array([0.01, 0.1])},
        "sample": {"count": np.int64(4), "method": "random", "seed": np.uint8(3)},
        "max_steps": np.int32(1000),
    }
    plain = {
        "set": {"stop.duration": 0.005, "initial.psi_dot": 150},
        "over": {"friction.k": [0.01, 0.1]},
        "sample": {"count": 4, "method": "random", "seed": 3},
        "max_steps": 1000,
    }
    one, other = tmp_path / "one.parquet", tmp_path / "other.parquet"
    assert toprise.sweep(spec, one)["stops"] == {"duration": 4}
    toprise.sweep(plain, other)
    assert one.read_bytes() == other.read_bytes()
    left_out = {"over": {"friction.k": [0.1]}, "sample": None, "max_steps": None}
    assert len(toprise.design(left_out)) == 1
    # In `set`, None takes a key out of the scenarios.
    taken = toprise.sweep({"set": {"initial.psi_dot": None}}, tmp_path / "taken.parquet")
    assert "initial.psi_dot" in taken["first_error"]["error"]


def test_a_table_needs_a_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(toprise.SweepError, match="is not a file name"):
        toprise.sweep(SPEC, "")
    assert list(tmp_path.iterdir()) == []


def test_wrong_rows_are_counted(tmp_path):
    spec = {"set": SPEC["set"], "over": {"friction.k": [0.03, -1.0, 0.02]}}
    answer = toprise.sweep(spec, tmp_path / "a.parquet")
    assert answer["errors"] == 1 and answer["first_error"]["run"] == 1
    with pytest.raises(toprise.SweepError, match="friction.k = -1"):
        toprise.sweep(spec, tmp_path / "b.parquet", fail_fast=True)


def test_a_progress_that_fails_ends_the_sweep(tmp_path):
    def fail(done, of):
        raise KeyError("enough")

    spec = {"over": {"friction.k": "0.01..0.1/2000"}}
    with pytest.raises(KeyError, match="enough"):
        toprise.sweep(spec, tmp_path / "a.parquet", progress=fail)
    assert not (tmp_path / "a.parquet").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent otherwise there")
def test_ctrl_c_ends_a_sweep_that_can_go_on(tmp_path):
    program = f"import toprise\nprint(1, flush=True)\ntoprise.sweep({{'over': {{'friction.k': '0.01..0.1/100000'}}}}, {str(tmp_path / 'a.parquet')!r})"
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.readline()
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(1.0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode != 0 and "KeyboardInterrupt" in errors
    assert (tmp_path / "a.parquet.parts" / "sweep.json").exists()


@pytest.mark.skipif("TOPRISE_PROGRAM" not in os.environ, reason="TOPRISE_PROGRAM names no program")
def test_val_the_bytes_are_those_of_the_program(tmp_path):
    here, there = tmp_path / "here.parquet", tmp_path / "there.parquet"
    toprise.sweep(SPEC, here)
    values = ",".join(map(str, SPEC["over"]["initial.psi_dot"]))
    subprocess.run(
        [
            os.environ["TOPRISE_PROGRAM"], "sweep", "paper", "--set", "stop.duration=0.005",
            "--over", "friction.k=0.01..0.1/40log", "--over", f"initial.psi_dot={values}",
            "-o", there,
        ],
        check=True,
        capture_output=True,
    )  # fmt: skip
    digests = {hashlib.sha256(file.read_bytes()).hexdigest() for file in (here, there)}
    assert len(digests) == 1


def test_the_bar_tells_how_far_it_is(tmp_path, capsys):
    toprise.sweep({"set": SPEC["set"]}, tmp_path / "a.parquet", progress=True)
    assert "1 of 1 runs" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ({"base": ["paper"]}, "unknown field `base`"),
        ({"bases": "paper"}, "in `bases`"),
        ({"bases": ["paper"], "sample": {"count": "many"}}, "in `sample.count`"),
    ],
)
def test_errors_of_a_mapping_name_its_keys(spec, expected):
    with pytest.raises(toprise.SweepError) as error:
        toprise.design(spec)
    assert expected in str(error.value) and "line" not in str(error.value)
