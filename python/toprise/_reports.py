"""Reports on runs: `diff`, `explain`, `verify`."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterable, Mapping
from typing import Any, Union

from . import _toprise
from ._toprise import Run, Scenario

#: Anything that identifies a run: a `Run`, a `Scenario`, or the name of a preset, scenario file or MCAP file.
AnyRun = Union[Run, Scenario, str, "os.PathLike[str]"]


class Report(dict[str, Any]):
    """A report as a dictionary, with the keys of `--format json` on the command line; `schemas/` describes them."""

    def __init__(self, report: Mapping[str, Any], lines: Iterable[str] = ()) -> None:
        super().__init__(report)
        self._lines = list(lines)

    @property
    def summary(self) -> str:
        """The report as text, one finding per line."""
        return "\n".join(self._lines)

    def __repr__(self) -> str:
        return self.summary

    def __str__(self) -> str:
        return self.summary

    def _repr_html_(self) -> str:
        """HTML with the summary and a table of the scalar entries."""
        plain = {key: value for key, value in self.items() if isinstance(value, (str, int, float))}
        rows = (
            f"<tr><th>{html.escape(str(key))}</th><td>{html.escape(str(value))}</td></tr>"
            for key, value in plain.items()
        )
        lines = html.escape(self.summary).replace("\n", "<br>")
        return f"<p>{lines}</p><table><tbody>{''.join(rows)}</tbody></table>"


class DiffReport(Report):
    """Differences between two runs; `schemas/toprise.DiffReport.json` describes the keys."""

    @property
    def verdict(self) -> str:
        """Verdict: identical, same_values, equal (within the tolerances), agreeing (as far as compared) or different."""
        return str(self["verdict"])


class Explanation(Report):
    """Why a top rose or fell; `schemas/toprise.ExplainReport.json` describes the keys."""


class VerifyReport(Report):
    """Comparison of a recording with a new run of its scenario; `schemas/toprise.VerifyReport.json` describes the keys."""

    @property
    def verdict(self) -> str:
        """verified, incomplete or different; `equality` says how a verified recording is equal."""
        return str(self["verdict"])

    @property
    def summary(self) -> str:
        """The verdict and the first difference, as text."""
        lines = [f"{self['file']}: {self.verdict}"]
        if found := self.get("difference"):
            parts = [found["place"], found.get("time"), found.get("field")]
            place = ", ".join(part for part in parts if part is not None)
            lines.append(f"{place}: recorded {found.get('recorded')}, simulated {found.get('simulated')}")
        return "\n".join(lines)


def diff(
    a: AnyRun,
    b: AnyRun,
    *,
    abs: float = 0.0,
    rel: float = 0.0,
    tolerances: Mapping[str, float | str] | None = None,
    integration_error: bool = True,
    topics: Iterable[str] = (),
    ignore: Iterable[str] = (),
) -> DiffReport:
    """Compares two runs: their scenarios, events, averaged motion and messages.

    `abs` (in the unit of each field) and `rel` (relative to the larger magnitude) are the tolerances; `tolerances` sets
    them for some fields, as in `{"/top/state.theta": 1e-9, "/top/torque.*": "rel:1e-6"}`. If `integration_error` is
    true, the integration errors are estimated by repeating both simulations with tighter tolerances. `topics` and
    `ignore` select the topics and fields to compare.

    Any two MCAP files can be compared. Messages of files not written by toprise are compared byte by byte.

    Raises `DiffError` if there is nothing to compare.
    """
    bounds = [f"{pattern}={bound}" for pattern, bound in (tolerances or {}).items()]
    report, lines = _toprise.diff(
        a,
        b,
        abs=abs,
        rel=rel,
        tolerances=bounds,
        integration_error=integration_error,
        topics=list(topics),
        ignore=list(ignore),
    )
    return DiffReport(json.loads(report), lines)


def explain(run: AnyRun) -> Explanation:
    """Explains why the top rose or fell, from the numbers of the run.

    Raises `DiffError` if the run lacks what is needed.
    """
    explanation, sentences = _toprise.explain(run)
    return Explanation(json.loads(explanation), sentences)


def verify(path: str | os.PathLike[str]) -> VerifyReport:
    """Runs the scenario of a recording again and compares the result with the file."""
    return VerifyReport(json.loads(_toprise.verify(path)))


def presets() -> dict[str, str]:
    """The built-in scenarios: names and descriptions."""
    return dict(_toprise.presets())
