"""Fits of measured motions."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Union

from . import _toprise
from ._reports import Report
from ._toprise import Scenario

#: A scenario, or the name of a preset, scenario file or recording.
_Base = Union[Scenario, str, "os.PathLike[str]"]
#: A number per time, such as a list, a NumPy array, or a column of a table.
_Numbers = Any


class Fit(Report):
    """A fit, with the members of `toprise fit --format json` except `written`."""

    #: The scenario with the estimated values, and the law that a comparison prefers.
    scenario: Scenario
    #: Columns `signal` (index in `self["signals"]`), `time` (s), `value`, `sigma`, `residual` (σ) and `is_held_out`.
    residuals: dict[str, list[Any]]
    _text: str

    @property
    def verdict(self) -> str:
        """fitted, bad_fit, undecided (between laws) or not_converged."""
        return str(self["verdict"])

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """The estimates by name: `value`, `sd`, `interval` (95 %), `limit` … as far as the data determine them."""
        return {estimate["name"]: estimate for estimate in self["parameters"]}

    def text(self) -> str:
        """The report of `toprise fit --format markdown`, with the names that arguments have here."""
        return self._text

    @property
    def summary(self) -> str:
        """The same as `text()`."""
        return self.text()


def fit(
    scenario: _Base,
    data: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] | Mapping[str, _Numbers] | None = None,
    *,
    free: Iterable[str],
    time: _Numbers | None = None,
    sigma: Mapping[str, float] | None = None,
    columns: Iterable[str] = (),
    time_column: str | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    overrides: Mapping[str, Any] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    compare: Iterable[str] = (),
    profile: Iterable[str] = (),
    loss: str = "squares",
    start: float | None = None,
    until: float | None = None,
    holdout: float = 0.0,
    rescale: bool = False,
    **signals: _Numbers,
) -> Fit:
    """Estimates friction and the start of a motion from measured values, and compares friction laws.

    The measured values are arrays in SI units, `fit("paper", time=t, theta=theta, sigma={"theta": 1e-3}, free=…)`, with the
    names that `toprise fit --signal` knows; a table or dictionary with a column `time`; or the names of files, whose
    `columns` are described as for `--signal` (`"theta:1mrad"`). Without `sigma` a standard deviation is estimated from the
    residuals. Missing values are NaN. `delimiter` is "comma", "semicolon" or "tab", `decimal` "point" or "comma", where a
    file does not show it. Files share one clock, unless "offset" is in `free`.

    `free` are keys of the scenario, and "initial" for all of the start that the signals show. `loss` is "squares" or
    "huber". The other arguments are those of the command.

    Raises `FitError` if the data can't be read, or can't determine the parameters.
    """
    if loss not in ("squares", "huber"):
        raise ValueError(f'loss: {loss!r} is neither "squares" nor "huber"')
    files: list[str | os.PathLike[str]] = []
    if isinstance(data, (str, os.PathLike)):
        files = [data]
    elif isinstance(data, Sequence):
        files = list(data)
    elif data is not None:
        names = getattr(data, "columns", None)
        signals = {**{str(name): data[name] for name in (data if names is None else names)}, **signals}
        time = signals.pop("time", time)
    if bool(files) == bool(signals):
        raise ValueError("name either files or arrays, such as theta=…")
    if signals and time is None:
        raise ValueError("time is missing")
    sigma = dict(sigma or {})
    if unknown := set(sigma) - set(signals):
        raise ValueError(f"sigma: {', '.join(sorted(unknown))} is not measured; files have theirs in `columns`")
    if not 0 <= holdout <= 0.9:
        raise ValueError("holdout must be from 0 to 0.9")
    times = [] if time is None else _floats(time)
    arrays = [(name, _floats(values), sigma.get(name)) for name, values in signals.items()]
    for name, values, _ in arrays:
        if len(values) != len(times):
            raise ValueError(f"{name} has {len(values)} values, time has {len(times)}")
    measured = {
        "time": times,
        "arrays": arrays,
        "files": files,
        "columns": list(columns),
        "time_column": time_column,
        "delimiter": delimiter,
        "decimal": decimal,
    }
    options = {
        "free": list(free),
        "bounds": [(name, list(bound)) for name, bound in (bounds or {}).items()],
        "robust": loss == "huber",
        "start": start,
        "until": until,
        "holdout": holdout,
        "compare": list(compare),
        "profile": list(profile),
        "rescale": rescale,
    }
    report, text, best, residuals = _toprise.fit(scenario, overrides, measured, options)
    fitted = Fit(json.loads(report))
    fitted.scenario = best
    fitted._text = text
    names = ("signal", "time", "value", "sigma", "residual", "is_held_out")
    fitted.residuals = {name: [row[at] for row in residuals] for at, name in enumerate(names)}
    return fitted


def _floats(values: _Numbers) -> list[float]:
    """Numbers as a list; None stands for a missing one."""
    items = values.tolist() if hasattr(values, "tolist") else list(values)
    return [float("nan") if item is None else float(item) for item in items]
