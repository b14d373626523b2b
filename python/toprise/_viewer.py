"""Runs in the Rerun viewer."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from ._errors import RecordingError
from ._toprise import Run


def show(run: Run) -> subprocess.Popen[bytes]:
    """Opens a run in a new viewer, with the layout of `toprise view` if that program is installed.

    Temporary files are not deleted, because the viewer may read them after the script has ended.
    """
    _check_installed()
    folder = Path(tempfile.mkdtemp(prefix="toprise-"))
    name = re.sub(r"[^\w.-]", "_", run.name)
    path = run.path
    if path is None:
        path = str(folder / f"{name}.mcap")
        run.save(path)
    if shutil.which("toprise"):
        recording = folder / f"{name}.rrd"
        _convert(path, recording)
        path = str(recording)
    return subprocess.Popen([sys.executable, "-m", "rerun", path])


def save_rrd(run: Run, path: Path) -> None:
    """Writes a run as a recording for the Rerun viewer."""
    with tempfile.TemporaryDirectory(prefix="toprise-") as folder:
        source = Path(folder) / "run.mcap"
        run.save(source)
        _convert(source, path)


def _convert(source: str | Path, path: Path) -> None:
    """Converts MCAP: with `toprise`, which adds the scene and its layout, otherwise with Rerun's own program.

    The package has no part of Rerun, whose SDK is far larger and takes longer to compile than everything else.
    """
    program = shutil.which("toprise")
    if program:
        command = [program, "view", str(source), "--rrd", str(path), "--force", "--quiet"]
    else:
        _check_installed()
        command = [sys.executable, "-m", "rerun", "mcap", "convert", str(source), "-o", str(path)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    shown = (0, 3) if program else (0,)  # 3: the recording is incomplete, and shown as far as it goes
    if result.returncode not in shown:
        raise RecordingError(f"{path}: {result.stderr.strip()}")


def _check_installed() -> None:
    if importlib.util.find_spec("rerun") is None:
        raise ImportError("the Rerun viewer is not installed: pip install rerun-sdk==0.36.3")
