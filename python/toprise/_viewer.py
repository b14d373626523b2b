"""Runs in the Rerun viewer."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from ._toprise import Run


def show(run: Run) -> subprocess.Popen[bytes]:
    """Opens a run in a new viewer. A run without a file is saved to a temporary file first.

    The temporary file is not deleted, because the viewer may read it after the script has ended.
    """
    if importlib.util.find_spec("rerun") is None:
        raise ImportError("the Rerun viewer is not installed: pip install rerun-sdk==0.36.3")
    path = run.path
    if path is None:
        folder = tempfile.mkdtemp(prefix="toprise-")
        path = str(Path(folder) / (re.sub(r"[^\w.-]", "_", run.name) + ".mcap"))
        run.save(path)
    return subprocess.Popen([sys.executable, "-m", "rerun", path])
