"""Exceptions and warnings. Messages are the same as on the command line."""

from __future__ import annotations


class Error(Exception):
    """Base class of all toprise exceptions."""


class ScenarioError(Error, ValueError):
    """Invalid scenario. The message names the key, its value and the allowed values.

    `key` is the key to change, and `value` its value as written after `--set KEY=`; None where there is none.
    """

    def __init__(self, message: str, key: str | None = None, value: str | None = None) -> None:
        # All arguments are kept, so that the exception can be pickled.
        super().__init__(message, key, value)
        self.key = key
        self.value = value

    def __str__(self) -> str:
        return str(self.args[0])


class SimulationError(Error, ArithmeticError):
    """The motion can't be integrated."""


class RecordingError(Error, ValueError):
    """The file is not a toprise recording, or can't be read."""


class DiffError(Error, ValueError):
    """The runs can't be compared or explained."""


class FitError(Error, ValueError):
    """The data can't be read, or can't determine the parameters."""


class SweepError(Error, ValueError):
    """The sweep can't be started or its table can't be written."""


class InternalError(Error, RuntimeError):
    """Internal error (a bug in toprise); please report it."""


class RecordingWarning(UserWarning):
    """Part of a run is missing; see `run.losses`."""
