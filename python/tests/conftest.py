"""What several tests share."""

from pathlib import Path

import pytest

import toprise

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def paper() -> toprise.Run:
    return toprise.run("paper")


@pytest.fixture(scope="session")
def brief() -> toprise.Run:
    """A tenth of a second of the paper's run."""
    return toprise.run("paper", {"stop.duration": 0.1})


@pytest.fixture(scope="session")
def reference(tmp_path_factory) -> Path:
    """Recordings like those of `recordings/reference`, which are those of the last release, made by this version."""
    folder = tmp_path_factory.mktemp("reference")
    for preset in ("paper", "full-coulomb"):
        toprise.run(preset, {"sampling.period": 0.01}).save(folder / f"{preset}.mcap")
    return folder
