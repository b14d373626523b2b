"""Exceptions and warnings. Their texts are those of the command line."""


class Error(Exception):
    """Anything that toprise refuses or can't do."""


class ScenarioError(Error, ValueError):
    """A scenario that can't be run: the text names the key, its value and what is allowed."""


class SimulationError(Error, ArithmeticError):
    """A motion that can't be integrated."""


class RecordingError(Error, ValueError):
    """A file that is no recording of toprise, or that can't be read."""


class DiffError(Error, ValueError):
    """Runs that can't be compared or explained."""


class SweepError(Error, ValueError):
    """A sweep that can't be started or written."""


class InternalError(Error, RuntimeError):
    """A defect of toprise itself; please report it."""


class RecordingWarning(UserWarning):
    """A run of which something is missing; `run.losses` says what."""
