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
def reference() -> Path:
    """Recordings of the paper's runs at 100 Hz."""
    return ROOT / "recordings" / "reference"
