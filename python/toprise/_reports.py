"""Questions about runs, and their answers."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any, Literal, Union

from . import _toprise
from ._toprise import Run, Scenario

#: A run: one that was simulated or read, a scenario, a preset, a scenario file or an MCAP file.
AnyRun = Union[Run, Scenario, str, "os.PathLike[str]"]

_NS = 1_000_000_000


class Report(dict[str, Any]):
    """An answer as a dictionary, with the keys of `--format json` on the command line; `schemas/` describes them."""

    @property
    def summary(self) -> str:
        """The answer in words."""
        return str(self)

    def _repr_markdown_(self) -> str:
        return str(self)


class DiffReport(Report):
    """What differs between two runs; `schemas/toprise.DiffReport.json` describes the keys."""

    @property
    def verdict(self) -> str:
        """How the comparison ended: identical, equal (within the tolerances), agreeing (as far as compared) or different."""
        return str(self["verdict"])

    def __str__(self) -> str:
        return " ".join(self["summary"])


class Story(Report):
    """Why a top rose or fell; `schemas/toprise.ExplainReport.json` describes the keys."""

    def __str__(self) -> str:
        chapters = (
            f"{chapter['heading']}\n\n{' '.join(chapter['sentences'])}"
            for chapter in self["chapters"]
        )
        return "\n\n".join([self["title"], *chapters])


class VerifyReport(Report):
    """Whether a recording can be trusted; `schemas/toprise.VerifyReport.json` describes the keys."""

    @property
    def verdict(self) -> str:
        """The worst of all checks: passed, partial (without some channels), incomplete or failed."""
        return str(self["verdict"])

    def __str__(self) -> str:
        findings = (
            f"{check['name']}: {check['finding']}"
            for check in self["checks"]
            if check["verdict"] not in ("passed", "skipped")
        )
        return "\n".join([f"{self['file']}: {self.verdict}", *findings])


def diff(
    a: AnyRun,
    b: AnyRun,
    *,
    abs: float = 0.0,
    rel: float = 0.0,
    ulp: int = 0,
    tolerances: Mapping[str, float | str] | None = None,
    align: Literal["time", "nutation", "theta", "index"] = "time",
    max_dt: float | None = None,
    offset: float | Literal["start"] = 0.0,
    floor: bool = True,
    topics: Iterable[str] = (),
    ignore: Iterable[str] = (),
) -> DiffReport:
    """Says what differs between two runs: in the set-up, in what happened, in the averaged motion and point by point.

    `abs` (in the unit of each field), `rel` (as a part of the larger magnitude) and `ulp` (doubles from one to the other)
    are the largest differences that count as none; `tolerances` sets them for some fields, as in
    `{"/top/state.theta": 1e-9, "/top/torque.*": "rel:1e-6,ulp:4"}`. `align` says what is compared with what; `max_dt` (s)
    pairs messages that are nearest to each other and no farther apart; `offset` (s) puts the second run's clock forward.
    `floor` finds the integrators' errors too, by simulating the scenarios again. `topics` and `ignore` choose what counts.

    Any MCAP files can be compared. The answer's `summary` tells it in sentences; `verdict` in a word.

    Raises `DiffError` if there is nothing to compare.
    """
    if isinstance(offset, str) and offset != "start":
        raise ValueError(f"offset = {offset!r}: must be a number of seconds or \"start\"")
    bounds = [f"{pattern}={bound}" for pattern, bound in (tolerances or {}).items()]
    return DiffReport(
        json.loads(
            _toprise.diff(
                a,
                b,
                abs=abs,
                rel=rel,
                ulp=ulp,
                tolerances=bounds,
                align=align,
                max_dt_ns=None if max_dt is None else round(max_dt * _NS),
                offset_ns=None if isinstance(offset, str) else round(offset * _NS),
                floor=floor,
                topics=list(topics),
                ignore=list(ignore),
            )
        )
    )


def explain(run: AnyRun) -> Story:
    """Tells why the top rose or fell: the story of a run from its numbers.

    Raises `DiffError` if the run lacks what is needed.
    """
    return Story(json.loads(_toprise.explain(run)))


def verify(path: str | os.PathLike[str], *, reproduce: bool = True) -> VerifyReport:
    """Checks whether a recording can be trusted: the file, its messages, the physics, and its reproduction, bit for bit.

    `reproduce=False` doesn't simulate it again.
    """
    return VerifyReport(json.loads(_toprise.verify(path, reproduce=reproduce)))


def presets() -> dict[str, str]:
    """The scenarios that come with toprise: their names, and what they show."""
    return dict(_toprise.presets())
