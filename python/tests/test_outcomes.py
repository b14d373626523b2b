"""The outcome of a run."""

import typing

import numpy as np
import pytest

import toprise


def test_the_outcome_is_that_of_the_run(paper, reference):
    outcome = toprise.outcome("paper")
    assert outcome == paper.outcome
    assert outcome["stop_reason"] == "risen"
    # By 113-bit arithmetic, as toprise's own tests have it.
    assert outcome["rise_time"] == pytest.approx(24.719386, abs=1e-6)
    assert outcome["nutations"] == len(paper.nutations)
    assert outcome["weak_time"] is None and outcome["hops"] is None
    assert outcome["theta"] == pytest.approx(paper["/top/state"].numpy("theta")[-1], abs=1e-3)
    # Sampled ten times less often, it is the same motion.
    assert toprise.read(reference / "paper.mcap").outcome == outcome


def test_a_free_peg_has_more_to_tell():
    outcome = toprise.outcome("drop", {"stop.duration": 0.5})
    run = toprise.run("drop", {"stop.duration": 0.5})
    assert outcome == run.outcome
    assert outcome["impacts"] == len(run["/top/impact"]) > 0


def test_wrong_scenarios_have_no_outcome():
    with pytest.raises(toprise.ScenarioError, match="friction.k"):
        toprise.outcome("paper", {"friction.k": -1.0})


def test_outcome_type_has_every_column():
    assert list(typing.get_type_hints(toprise.Outcome)) == list(toprise.outcome("frictionless", {"stop.duration": 0.1}))


def test_outcomes_take_dictionaries():
    columns = {"friction.k": np.array([0.02, 0.03]), "friction_law": ["coulomb", None], "stop.duration": (0.1, 0.2)}
    outcomes = toprise.outcomes(columns, base="paper")
    assert outcomes["stop_time"].tolist() == [0.1, 0.2]
    assert outcomes["friction_k"].tolist() == [0.02, 0.03]
    with pytest.raises(TypeError, match="either numbers or texts"):
        toprise.outcomes({"friction.k": [0.1, "a"]}, base="paper")
