"""Runs in the Rerun viewer."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from ._errors import RecordingError
from ._toprise import Run


def show(run: Run) -> subprocess.Popen[bytes]:
    """Opens a run in a new viewer. A run without a file is saved to a temporary file first.

    The temporary file is not deleted, because the viewer may read it after the script has ended.
    """
    _check_installed()
    path = run.path
    if path is None:
        folder = tempfile.mkdtemp(prefix="toprise-")
        path = str(Path(folder) / (re.sub(r"[^\w.-]", "_", run.name) + ".mcap"))
        run.save(path)
    return subprocess.Popen([sys.executable, "-m", "rerun", path])


def save_rrd(run: Run, path: Path) -> None:
    """Writes a run as a recording for the Rerun viewer, which converts it from MCAP."""
    _check_installed()
    with tempfile.TemporaryDirectory(prefix="toprise-") as folder:
        source = Path(folder) / "run.mcap"
        run.save(source)
        result = subprocess.run(
            [sys.executable, "-m", "rerun", "mcap", "convert", str(source), "-o", str(path)],
            capture_output=True,
            text=True,
            check=False,
        )
    if result.returncode != 0:
        raise RecordingError(f"{path}: {result.stderr.strip()}")


def _check_installed() -> None:
    if importlib.util.find_spec("rerun") is None:
        raise ImportError("the Rerun viewer is not installed: pip install rerun-sdk==0.36.3")
