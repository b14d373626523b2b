"""Comparing, explaining and verifying runs."""

import json

import pytest
from conftest import ROOT
from jsonschema import validate

import toprise


def is_of_schema(report, name):
    schema = json.loads((ROOT / "schemas" / f"toprise.{name}.json").read_text())
    validate(report, schema)
    return True


def test_a_run_and_its_recording_are_identical(reference):
    recording = reference / "paper.mcap"
    run = toprise.run("paper", {"sampling.period": 0.01})
    report = toprise.diff(run, recording, floor=False)
    assert report.verdict == "identical"
    assert toprise.diff(toprise.read(recording), str(recording), floor=False).verdict == "identical"
    assert is_of_schema(report, "DiffReport")


def test_a_difference_is_told_in_sentences(brief):
    other = toprise.Scenario("paper", {"stop.duration": 0.1, "friction.k": 0.0303})
    report = toprise.diff(brief, other, floor=False)
    assert report.verdict == "different"
    assert report.summary == str(report) == " ".join(report["summary"])
    assert "friction.k (A: 0.03, B: 0.0303)" in report.summary
    assert report["setup"]["scenario"][0]["key"] == "friction.k"
    assert report["floor"] is None
    with pytest.raises(ValueError, match="offset = 'foo': must be a number of seconds or"):
        toprise.diff(brief, other, offset="foo")
    equal = toprise.diff(brief, other, abs=1.0, rel=0.5, floor=False, topics=["/top/state"])
    assert equal.verdict == "equal"
    equal = toprise.diff(
        brief, other, tolerances={"/top/state.*": "rel:1"}, topics=["/top/state"], floor=False
    )
    assert equal.verdict == "equal"
    ignoring = toprise.diff(brief, other, ignore=["/top/*"], floor=False)
    assert [topic["topic"] for topic in ignoring["signals"]["channels"]] == ["/events"]


def test_clocks_can_be_moved(brief):
    moved = toprise.diff(brief, brief, offset=0.01, floor=False)
    assert moved["clock"]["offset_ns"] == 10_000_000
    assert toprise.diff(brief, brief, offset="start", floor=False).verdict == "identical"


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"align": "phase"}, ValueError, "must be one of time, nutation, theta, index"),
        ({"rel": -1.0}, toprise.DiffError, "rel = -1"),
        ({"topics": ["/x"]}, toprise.DiffError, "the topic /x can't be compared"),
        ({"tolerances": {"/top/stat.theta": 1}}, toprise.DiffError, "no field matches"),
        ({"tolerances": {"/top/state.theta": "x"}}, toprise.DiffError, "tolerance"),
    ],
)
def test_wrong_options_say_what_is_wrong(brief, options, error, text):
    with pytest.raises(error, match=text):
        toprise.diff(brief, brief, **options)


def test_any_mcap_files_can_be_compared():
    foreign = ROOT / "tests/data/foreign"
    assert toprise.diff(foreign / "json_a.mcap", foreign / "json_b.mcap").verdict == "different"


def test_a_story_is_told(paper):
    story = toprise.explain(paper)
    assert story["title"] == "paper: the top rises in 24.7194 s"
    assert story.summary.startswith(story["title"])
    assert is_of_schema(story, "ExplainReport")


def test_a_recording_is_verified(reference):
    report = toprise.verify(reference / "frictionless.mcap")
    assert report.verdict == "passed"
    assert report.summary.endswith("frictionless.mcap: passed")
    assert any(check["group"] == "reproduction" for check in report["checks"])
    assert is_of_schema([report], "VerifyReport")
    quick = toprise.verify(reference / "frictionless.mcap", reproduce=False)
    assert {c["verdict"] for c in quick["checks"] if c["group"] == "reproduction"} == {"skipped"}
    with pytest.raises(FileNotFoundError):
        toprise.verify("missing.mcap")
