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
    report = toprise.diff(run, recording, integration_error=False)
    assert report.verdict == "identical"
    assert toprise.diff(toprise.read(recording), str(recording), integration_error=False).verdict == "identical"
    assert is_of_schema(report, "DiffReport")


def test_a_difference_is_summarised(brief):
    other = toprise.Scenario("paper", {"stop.duration": 0.1, "friction.k": 0.0303})
    report = toprise.diff(brief, other, integration_error=False)
    assert report.verdict == "different"
    assert report.summary == str(report) == repr(report)
    lines = report.summary.splitlines()
    assert lines[0].startswith("B rises to a mean θ of ")
    assert lines[1] == "friction.k: A 0.03, B 0.0303"
    assert "B − A" in lines[2]
    assert report["setup"]["scenario"][0]["key"] == "friction.k"
    assert report["integration_errors"] is None
    equal = toprise.diff(brief, other, abs=1.0, rel=0.5, integration_error=False, topics=["/top/state"])
    assert equal.verdict == "equal"
    equal = toprise.diff(
        brief, other, tolerances={"/top/state.*": "rel:1"}, topics=["/top/state"], integration_error=False
    )
    assert equal.verdict == "equal"
    ignoring = toprise.diff(brief, other, ignore=["/top/*"], integration_error=False)
    assert [channel["topic"] for channel in ignoring["channels"]] == ["/events"]


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"rel": -1.0}, toprise.DiffError, "rel = -1"),
        ({"topics": ["/x"]}, toprise.DiffError, "topic /x can't be compared"),
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


def test_a_run_is_explained(paper):
    explanation = toprise.explain(paper)
    assert explanation["title"] == "paper: risen at t = 24.7194 s"
    lines = explanation.summary.splitlines()
    facts = [fact for chapter in explanation["chapters"] for fact in chapter["facts"]]
    assert lines[0] == f"{explanation['title']}." and len(lines) == 2 + len(facts)
    assert lines[1].startswith("The top rose because friction")
    assert is_of_schema(explanation, "ExplainReport")


def test_a_recording_is_verified(reference):
    report = toprise.verify(reference / "full-coulomb.mcap")
    assert report.verdict == "verified"
    assert report.summary.endswith("full-coulomb.mcap: verified")
    assert is_of_schema([report], "VerifyReport")
    with pytest.raises(FileNotFoundError):
        toprise.verify("missing.mcap")


def test_a_report_in_a_notebook_is_plain_html():
    page = toprise.Report({"title": "<b>", "list": [1]}, ["a & b", "c"])._repr_html_()
    assert page.startswith("<p>a &amp; b<br>c</p><table>")
    assert "<th>title</th><td>&lt;b&gt;</td>" in page and "list" not in page
