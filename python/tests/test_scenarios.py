"""Scenarios, and what is wrong with them."""

import copy
import pickle

import numpy as np
import pytest

import toprise


def test_a_scenario_reads_like_a_mapping():
    scenario = toprise.Scenario("paper", {"friction.k": 0.02, "stop.duration": None})
    assert scenario["friction.k"] == 0.02
    assert scenario["friction.law"] == "coulomb"
    assert "stop.duration" not in scenario
    assert dict(scenario)["top.mass"] == 0.11
    assert len(scenario) == len(list(scenario)) == len(scenario.keys())
    assert toprise.Scenario.unit("top.mass") == "kg"
    assert scenario.name == "paper" and len(scenario.digest) == 64
    with pytest.raises(KeyError, match="stop.duration"):
        scenario["stop.duration"]


def test_keys_may_have_an_underscore_for_the_dot(brief):
    dotted = toprise.Scenario("paper", {"stop.duration": 0.1, "top.mass": 0.1})
    flat = toprise.Scenario("paper", {"stop_duration": 0.1, "top_mass": 0.1})
    assert flat == dotted and flat["top_mass"] == 0.1 and "top_mass" in flat
    assert toprise.Scenario.unit("top_mass") == "kg"
    assert toprise.run(brief.scenario, {"top_mass": 0.1}).scenario == dotted
    assert toprise.outcome(flat) == toprise.outcome(dotted)
    assert toprise.diff(flat, dotted, integration_error=False).verdict == "identical"
    with pytest.raises(toprise.ScenarioError, match="top.mass: set twice"):
        toprise.Scenario("paper", {"top.mass": 0.1, "top_mass": 0.2})
    with pytest.raises(KeyError, match="top.mass"):
        toprise.Scenario.unit("top.mas")


def test_a_scenario_is_shown():
    scenario = toprise.Scenario("paper", {"name": "a.b", "description": "a<b"})
    lines = repr(scenario).splitlines()
    assert lines[0].startswith("<toprise.Scenario a.b ")
    assert any(line.split() == ["friction.k", "0.03"] for line in lines)
    page = scenario._repr_html_()
    assert "a<b" not in page and "<th>top.mass</th><td>0.11</td><td>kg</td>" in page


def test_scenarios_travel():
    scenario = toprise.Scenario("paper", {"friction.k": 0.1 + 0.2})
    for again in (
        pickle.loads(pickle.dumps(scenario)),
        copy.deepcopy(scenario),
        toprise.Scenario.from_toml(scenario.to_toml()),
        toprise.Scenario(scenario),
        toprise.Scenario(scenario, {}),
    ):
        assert again == scenario and hash(again) == hash(scenario)
        assert again["friction.k"] == 0.1 + 0.2
    assert scenario != toprise.Scenario("paper") and scenario != "paper"


def test_a_scenario_is_a_base_and_so_is_a_file(tmp_path):
    scenario = toprise.Scenario("viscous", {"stop.duration": 0.01})
    file = tmp_path / "mine.toml"
    file.write_text(scenario.to_toml())
    digests = {
        toprise.run(base).content_digest for base in (scenario, file, str(file))
    }
    assert len(digests) == 1
    assert toprise.run(scenario, {"friction.k": 0.1}).content_digest not in digests


def test_numbers_of_any_kind_are_values():
    for number in (2, np.float64(2), np.float32(2), np.int64(2), "2", "2.0"):
        scenario = toprise.Scenario("paper", {"friction.k": number})
        assert scenario["friction.k"] == 2.0


@pytest.mark.parametrize(
    ("overrides", "error", "text"),
    [
        ({"friction.k": -1}, toprise.ScenarioError, r"friction.k = -1: must be a number from 0 to 100"),
        ({"friction.k": float("nan")}, toprise.ScenarioError, "friction.k = NaN"),
        ({"friction.k": float("inf")}, toprise.ScenarioError, "friction.k = inf"),
        ({"friction.k": True}, toprise.ScenarioError, "friction.k = true"),
        ({"friction.k": "much"}, toprise.ScenarioError, "friction.k = \"much\""),
        ({"friction.kk": 1}, toprise.ScenarioError, r"did you mean friction.k\?"),
        ({"friction.k": None}, toprise.ScenarioError, r"missing: friction.k \(coefficient of friction k: a number from 0 to 100\)"),
        ({"friction.law": "none"}, toprise.ScenarioError, "does not apply with"),
        ({"friction.law": "coulob"}, toprise.ScenarioError, r"did you mean coulomb\?"),
        ({"friction.k": [1]}, TypeError, "friction.k: must be a number, a text or None, not list"),
        ({3: 1}, TypeError, "str"),
        ([("friction.k", 1)], TypeError, "Mapping"),
    ],
)  # fmt: skip
def test_wrong_overrides_say_what_is_wrong(overrides, error, text):
    with pytest.raises(error, match=text):
        toprise.run("paper", overrides)


def test_wrong_bases_say_what_is_wrong(tmp_path):
    with pytest.raises(toprise.ScenarioError, match=r'unknown preset "papr" \(did you mean paper\?\)\. For a scenario file'):
        toprise.run("papr")
    with pytest.raises(FileNotFoundError, match="missing.toml"):
        toprise.run(tmp_path / "missing.toml")
    with pytest.raises(TypeError, match="a preset, a file or a Scenario, not"):
        toprise.run(3)
    file = tmp_path / "wrong.toml"
    file.write_text("[friction\n")
    with pytest.raises(toprise.ScenarioError, match="wrong.toml: not valid TOML"):
        toprise.Scenario(file)
    assert issubclass(toprise.ScenarioError, ValueError)
    assert issubclass(toprise.ScenarioError, toprise.Error)


def test_presets_are_scenarios():
    presets = toprise.presets()
    assert presets["paper"].startswith("The paper's rise")
    for name in presets:
        assert toprise.Scenario(name).name == name


def test_errors_have_key_and_value():
    for overrides, key, value in [
        ({"friction.k": -1}, "friction.k", "-1"),
        ({"friction_law": "glue"}, "friction.law", "glue"),
        ({"friction.kk": 1}, "friction.kk", None),
        ({"friction.k": None}, "friction.k", None),
        ({"top.mass": 1}, "top.transverse_moment", "8.52e-5"),
    ]:
        with pytest.raises(toprise.ScenarioError) as caught:
            toprise.run("paper", overrides)
        assert (caught.value.key, caught.value.value) == (key, value)
        again = pickle.loads(pickle.dumps(caught.value))
        assert (str(again), again.key) == (str(caught.value), key)
    with pytest.raises(toprise.ScenarioError) as caught:
        toprise.run("papr")
    assert caught.value.key is None
