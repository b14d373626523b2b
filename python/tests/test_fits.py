"""Fits of measured motions."""

import random
import re

import pytest

import toprise

TOP = toprise.Scenario("full-coulomb", {"stop.duration": 2, "sampling.period": 0.01})
SIGMA = {"theta": 1e-3, "phi": 1e-3}


def measured(seed=1):
    """θ and φ of the top with noise of 1 mrad."""
    noise = random.Random(seed)
    state = toprise.run(TOP)["/top/state"]
    columns = {name: [value + noise.gauss(0, 1e-3) for value in state[name]] for name in SIGMA}
    return {"time": state["time"].tolist(), **columns}


def test_estimates_friction_from_arrays():
    data = measured()
    fit = toprise.fit(
        "full-coulomb",
        time=data["time"],
        theta=data["theta"],
        phi=data["phi"],
        sigma=SIGMA,
        free=["friction.k", "initial"],
        overrides={"friction.k": 0.045},
    )
    assert fit.verdict == "fitted"
    k = fit.parameters["friction.k"]
    assert abs(k["value"] - 0.03) < 4 * k["sd"]
    assert fit.scenario["friction.k"] == k["value"]
    assert len(fit.residuals["residual"]) == 2 * len(data["time"])
    assert "| friction.k | 0.0" in fit.text()
    # With the digits of the standard deviation, 2e-4 rad: φ₀ is zero.
    assert re.search(r"^\| initial.phi \\\[rad\\\] \| −?0\.0\d{4,5} ± 0\.0", fit.text(), re.MULTILINE)


def test_compares_laws_of_a_table():
    fit = toprise.fit(
        "full-coulomb",
        measured(),
        sigma=SIGMA,
        free=["friction.k", "initial"],
        compare=["coulomb", "none"],
    )
    laws = [law["law"] for law in fit["comparison"]["laws"]]
    assert laws == ["coulomb", "none"]
    assert fit["comparison"]["is_decided"]


def test_reads_files(tmp_path):
    data = measured()
    path = tmp_path / "top.csv"
    rows = zip(data["time"], data["theta"], data["phi"])
    path.write_text("t,theta,phi\n" + "".join(f"{t},{a},{b}\n" for t, a, b in rows))
    fit = toprise.fit("full-coulomb", path, columns=["theta:1mrad", "phi:1mrad"], free=["friction.k", "initial"])
    assert fit.verdict == "fitted"
    with pytest.raises(FileNotFoundError):
        toprise.fit("full-coulomb", tmp_path / "none.csv", free=["friction.k"])


def test_errors_say_what_is_wrong():
    data = measured()
    with pytest.raises(toprise.FitError, match="only k·R is determined"):
        toprise.fit("full-coulomb", data, sigma=SIGMA, free=["friction.k", "top.peg_radius"])
    with pytest.raises(toprise.FitError, match="leave out of free what is known"):
        toprise.fit("full-coulomb", data, sigma=SIGMA, free=["friction.k", "top.peg_radius"])
    with pytest.raises(toprise.FitError, match='describe signals as in columns=\\["theta=tilt'):
        toprise.fit("full-coulomb", time=data["time"], theta=data["theta"], sigma={"theta": 0}, free=["friction.k"])
    with pytest.raises(ValueError, match="time is missing"):
        toprise.fit("full-coulomb", theta=data["theta"], free=["friction.k"])
    with pytest.raises(ValueError, match="phi has 1 values"):
        toprise.fit("full-coulomb", time=data["time"], phi=[0.0], free=["friction.k"])
    with pytest.raises(toprise.FitError, match="unknown field speed"):
        toprise.fit("full-coulomb", time=data["time"], speed=data["theta"], free=["friction.k"])
