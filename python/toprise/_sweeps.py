"""Many runs: their outcomes as tables."""

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

#: What a scenario is named by.
AnyScenario = Union[Scenario, str, "os.PathLike[str]"]

#: The spec of a sweep: a TOML file, or its content as a mapping.
Spec = Union[str, "os.PathLike[str]", Mapping[str, Any]]


class Outcomes:
    """The outcomes of runs whose keys are the rows of a table: a function that can be pickled and sent to other processes.

    `outcomes(table)` takes and gives a table of pyarrow, Polars or pandas (any other table of Arrow gives a `toprise.Table`):
    for `ray.data.Dataset.map_batches(…, batch_format="pyarrow")`, `dask.dataframe.map_partitions`, Polars' `map_batches`.
    `outcomes.batches` maps an iterator of pyarrow's batches, for Spark's `mapInArrow`.

    Each column is a key of a scenario (`friction_k` or `friction.k`); where a cell is null, the base's value holds. `run` and the
    columns named in `keep` go through, and an index of pandas is passed over. A row that can't be run has its reason in `error` and no outcome.
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
        """`keys` are only needed for `schema`; 0 `threads` are as many as there are processors."""
        self.base = Scenario(base)
        self.keys = list(keys)
        self.keep = list(keep)
        self.threads = threads
        self.max_steps = max_steps

    @property
    def schema(self) -> Table:
        """The columns for `keys` and of the outcomes, as a table without rows: `pyarrow.schema(outcomes.schema)`."""
        return _toprise.outcome_columns(self.keys)

    def table(self, table: Any) -> Table:
        """The outcomes of a table of any library with Arrow's PyCapsule interface."""
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
        """The outcomes of each of pyarrow's batches, for `pyspark.sql.DataFrame.mapInArrow`."""
        return map(self, batches)


def outcomes(
    table: Any,
    base: AnyScenario,
    *,
    keep: Sequence[str] = (),
    threads: int = 0,
    max_steps: int | None = None,
) -> Table:
    """The outcomes of runs whose keys are the rows of a table, computed with all processors.

    See `Outcomes` for what tables are and what comes of them. A run that takes more than `max_steps` steps of the integrator has
    an error instead of an outcome. NumPy's arrays become a table with `pyarrow.table({"friction_k": array})` or the like.
    """
    return Outcomes(base, keep=keep, threads=threads, max_steps=max_steps).table(table)


def design(spec: Spec, start: int = 0, stop: int | None = None) -> Table:
    """The runs from `start` to before `stop` of a sweep: their numbers, bases and the values of the keys that vary.

    `spec` is a TOML file or a mapping, as in `{"bases": ["paper"], "over": {"friction.k": "0.005..0.1/64log"}}`; a sample adds
    `{"sample": {"count": 1000, "method": "sobol", "seed": 7}}`. See `toprise sweep --help`.
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
    """Computes a sweep and writes its table, in Parquet: the bytes that `toprise sweep` writes.

    Continues an earlier call that was interrupted. `shard=(i, n)` computes the i-th of n shares of the parts, from
    0, and merges nothing; the call without it completes the table. `progress=True` shows a bar on standard error; a function is
    called with the numbers of runs that are done, and of all that are left. The answer has the number of `runs` of the whole sweep and of those `computed` now
    and `kept` from before (None for a share), and counts the runs by why they stopped, and those with an `error`.
    `toprise.run(out, row=42)` runs a row again.
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
    """A line on standard error."""

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
    """The text of a spec, and the folder in which files that it names are looked for."""
    if isinstance(spec, Mapping):
        entries = (f"{_key(name)} = {_toml(value)}\n" for name, value in _present(spec).items())
        return "".join(entries), os.getcwd()
    path = Path(spec).absolute()
    return path.read_text(encoding="utf-8"), str(path.parent)


def _present(spec: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a spec but for those that are None. In `set`, None takes a key out of a scenario, as in `toprise.run`."""
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
