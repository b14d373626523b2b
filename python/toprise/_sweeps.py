"""Outcomes of many runs, as tables."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from numbers import Integral
from pathlib import Path
from typing import Any, Union

from . import _toprise
from ._toprise import Scenario, Table

#: A scenario, or the name of a preset or file.
AnyScenario = Union[Scenario, str, "os.PathLike[str]"]

#: The spec of a sweep: a TOML file, or its content as a mapping.
Spec = Union[str, "os.PathLike[str]", Mapping[str, Any]]


class Outcomes:
    """Picklable function that maps a table of keys to a table of outcomes, one run per row.

    `outcomes(table)` returns a table of the same library for pyarrow, Polars and pandas, and a `toprise.Table` for any
    other Arrow table. Use it with `ray.data.Dataset.map_batches(…, batch_format="pyarrow")`,
    `dask.dataframe.map_partitions` or Polars' `map_batches(outcomes, schema=polars.DataFrame(outcomes.schema).schema)`;
    Polars needs `keys`, and `threads=0` uses all processors. `outcomes.batches` maps an iterator of pyarrow record
    batches, for Spark's `mapInArrow(outcomes.batches, from_arrow_schema(pyarrow.schema(outcomes.schema)))`, which needs
    `keys`. The workers need this package, and Spark needs `PYSPARK_PYTHON`.

    Each column is a scenario key (`friction_k` or `friction.k`); a null cell keeps the value of the base. The column
    `run` and the columns in `keep` are copied to the result; a pandas index is ignored. For a row that can't be run,
    `error` contains the reason and the outcome is null.
    """

    def __init__(
        self,
        base: AnyScenario,
        *,
        keys: Sequence[str] = (),
        keep: Sequence[str] = (),
        threads: int = 1,
        max_steps: int | None = None,
    ) -> None:
        """`keys` are only needed for `schema`. `threads=0` uses all processors."""
        self.base = Scenario(base)
        self.keys = list(keys)
        self.keep = list(keep)
        self.threads = threads
        self.max_steps = max_steps

    @property
    def schema(self) -> Table:
        """An empty table with the columns of `keys` and of the outcomes, as a schema: `pyarrow.schema(outcomes.schema)`."""
        return _toprise.outcome_columns(self.keys)

    def table(self, table: Any) -> Table:
        """The outcomes for a table that supports the Arrow PyCapsule interface, or a dictionary of columns."""
        if isinstance(table, Mapping):
            table = _toprise.table([(str(name), list(cells)) for name, cells in table.items()])
        return _toprise.outcomes(
            table, self.base, keep=self.keep, threads=self.threads, max_steps=self.max_steps
        )

    def __call__(self, table: Any) -> Any:
        library = type(table).__module__.partition(".")[0]
        made = self.table(table)
        if library == "pyarrow":
            import pyarrow

            if isinstance(table, pyarrow.RecordBatch):
                return pyarrow.RecordBatchReader.from_stream(made).read_next_batch()
            return pyarrow.table(made)
        if library == "polars":
            import polars

            return polars.DataFrame(made)
        if library == "pandas":
            import pyarrow

            return pyarrow.table(made).to_pandas().set_axis(table.index)
        return made

    def batches(self, batches: Iterable[Any]) -> Iterator[Any]:
        """The outcomes of each pyarrow record batch, for `pyspark.sql.DataFrame.mapInArrow`."""
        return map(self, batches)


def outcomes(
    table: Any,
    base: AnyScenario,
    *,
    keep: Sequence[str] = (),
    threads: int = 0,
    max_steps: int | None = None,
) -> Table:
    """Runs one scenario per row of a table, on all processors, and returns the outcomes.

    See `Outcomes` for the table formats; a dictionary of columns is a table, too, as in `{"friction.k": [0.02, 0.03]}`.
    A run that takes more than `max_steps` integrator steps has an error instead of an outcome.
    """
    return Outcomes(base, keep=keep, threads=threads, max_steps=max_steps).table(table)


def design(spec: Spec, start: int = 0, stop: int | None = None) -> Table:
    """The rows `start` to `stop` (exclusive) of a sweep's design: row number, base and the values of the varied keys.

    `spec` is a TOML file or a mapping, as in `{"bases": ["paper"], "over": {"friction.k": "0.005..0.1/64log"}}`; a
    sample adds `{"sample": {"count": 1000, "method": "sobol", "seed": 7}}`. See `toprise sweep --help`.
    """
    return _toprise.design(*read(spec), start, stop)


def sweep(
    spec: Spec,
    out: str | os.PathLike[str],
    *,
    threads: int = 0,
    shard: tuple[int, int] | None = None,
    fail_fast: bool = False,
    progress: bool | Callable[[int, int], object] = False,
) -> dict[str, Any]:
    """Computes a sweep and writes its table to a Parquet file, with the same bytes as `toprise sweep`.

    Resumes an interrupted call. `shard=(i, n)` computes shard i (from 0) of n and does not merge; a later call without
    `shard` completes the table. `progress=True` shows a progress bar on standard error; a function is called with the
    number of finished runs and the total number of runs to compute in this call. Returns the total number of `runs`,
    the numbers `computed` now and `kept` from before (None for a shard), and the counts by stop reason (`stops`) and of
    `errors`.
    """
    report: Callable[[int, int], object] | None = None
    if callable(progress):
        report = progress
    elif progress:
        report = _Bar()
    answer: dict[str, Any] = json.loads(
        _toprise.sweep(
            *read(spec),
            out,
            threads=threads,
            shard=shard,
            fail_fast=fail_fast,
            progress=report,
        )
    )
    return answer


class _Bar:
    """A progress line on standard error."""

    def __init__(self) -> None:
        self.began = time.monotonic()
        self.printed = 0.0

    def __call__(self, done: int, of: int) -> None:
        now = time.monotonic()
        if done < of and now - self.printed < 0.2:
            return
        self.printed = now
        rate = done / max(now - self.began, 1e-9)
        left = f", {(of - done) / rate:.0f} s left" if 0 < done < of else ""
        end = "\n" if done >= of else ""
        print(f"\r{done:,} of {of:,} runs, {rate:.0f}/s{left}   ", end=end, file=sys.stderr, flush=True)


def read(spec: Spec) -> tuple[str, str]:
    """The text of a spec, and the directory for relative file names in it."""
    if isinstance(spec, Mapping):
        entries = (f"{_key(name)} = {_toml(value)}\n" for name, value in _present(spec).items())
        return "".join(entries), os.getcwd()
    path = Path(spec).absolute()
    return path.read_text(encoding="utf-8"), str(path.parent)


def _present(spec: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a spec that are not None. In `set`, None removes a key from the scenario, as in `toprise.run`."""
    present = {name: value for name, value in spec.items() if value is not None}
    if isinstance(taken := present.get("set"), Mapping):
        present["set"] = {key: "" if value is None else value for key, value in taken.items()}
    return present


def _toml(value: Any) -> str:
    if isinstance(value, Mapping):
        entries = (f"{_key(name)} = {_toml(inner)}" for name, inner in value.items())
        return "{" + ", ".join(entries) + "}"
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, Integral) and not isinstance(value, bool):
        # NumPy's too.
        return str(int(value))
    if isinstance(value, (str, bool)):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Iterable):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return repr(float(value))


def _key(name: str) -> str:
    return json.dumps(str(name), ensure_ascii=False)
