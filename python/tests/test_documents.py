"""What the documents and the example show runs."""

import os
import re
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT


def shown(document):
    """The Python that a document shows of the package, one block after the other."""
    blocks = re.findall(r"```python\n(.*?)```", document.read_text(), re.DOTALL)
    first = next(n for n, block in enumerate(blocks) if "import toprise" in block)
    return "".join(block for block in blocks[first:] if "mcap.reader" not in block)


def runs(program, folder):
    environment = os.environ | {"MPLBACKEND": "Agg", "PYTHONUTF8": "1"}
    ran = subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-c", program],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


@pytest.mark.parametrize("name", ["docs/python.md", "python/README.md", "README.md"])
def test_what_documents_show_runs(name, tmp_path, reference):
    shutil.copytree(reference, tmp_path / "recordings" / "reference")
    shutil.copy(reference / "paper.mcap", tmp_path / "recordings")
    program = shown(ROOT / name)
    assert "toprise." in program
    runs(program, tmp_path)


def test_the_example_runs(tmp_path):
    output = runs((ROOT / "python/examples/rise.py").read_text(), tmp_path)
    assert "24.719" in output and "friction.dissipation" in output
    for picture in ("rise.png", "map.png"):
        assert (tmp_path / picture).stat().st_size > 10_000
