"""Simulate heavy symmetric tops with sliding friction at the peg.

    import toprise

    run = toprise.run("paper", {"friction.k": 0.02})
    run["/top/state"]["theta"]              # NumPy view; Polars, pyarrow, pandas and DuckDB can read the Table, too
    print(toprise.diff(run, "paper").summary)

Units are SI and radians throughout.
"""

from ._errors import (
    DiffError,
    Error,
    FitError,
    InternalError,
    RecordingError,
    RecordingWarning,
    ScenarioError,
    SimulationError,
    SweepError,
)
from ._figures import figures, map
from ._fit import Fit, fit
from ._outcome import Outcome
from ._reports import (
    AnyRun,
    DiffReport,
    Explanation,
    Report,
    VerifyReport,
    diff,
    explain,
    presets,
    verify,
)
from ._sweeps import Outcomes, design, outcomes, sweep
from ._toprise import VERSION as __version__
from ._toprise import Figure, Run, Scenario, Table, outcome, read, run

__all__ = [
    "AnyRun",
    "DiffError",
    "DiffReport",
    "Error",
    "Fit",
    "FitError",
    "InternalError",
    "Outcome",
    "Outcomes",
    "RecordingError",
    "RecordingWarning",
    "Report",
    "Run",
    "Scenario",
    "ScenarioError",
    "SimulationError",
    "SweepError",
    "Table",
    "VerifyReport",
    "__version__",
    "design",
    "diff",
    "explain",
    "figures",
    "fit",
    "map",
    "outcome",
    "outcomes",
    "presets",
    "read",
    "run",
    "sweep",
    "verify",
]
