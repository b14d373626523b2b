"""How does a spinning top stand up? Simulates heavy symmetric tops under slipping friction.

    import toprise

    run = toprise.run("paper", {"friction.k": 0.02})
    run["/top/state"].numpy("theta")        # a view for NumPy; the Table is also read by Polars, pyarrow, pandas, DuckDB
    print(toprise.diff(run, "paper").summary)

Units are SI and radians throughout.
"""

from ._errors import (
    DiffError,
    Error,
    InternalError,
    RecordingError,
    RecordingWarning,
    ScenarioError,
    SimulationError,
)
from ._reports import (
    AnyRun,
    DiffReport,
    Report,
    Story,
    VerifyReport,
    diff,
    explain,
    presets,
    verify,
)
from ._toprise import VERSION as __version__
from ._toprise import Run, Scenario, Table, outcome, read, run

__all__ = [
    "AnyRun",
    "DiffError",
    "DiffReport",
    "Error",
    "InternalError",
    "RecordingError",
    "RecordingWarning",
    "Report",
    "Run",
    "Scenario",
    "ScenarioError",
    "SimulationError",
    "Story",
    "Table",
    "VerifyReport",
    "__version__",
    "diff",
    "explain",
    "outcome",
    "presets",
    "read",
    "run",
    "verify",
]
