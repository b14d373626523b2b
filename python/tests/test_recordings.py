"""Recordings that are damaged, cut off or no recordings at all."""

import sys
import warnings

import pytest
from conftest import ROOT

import toprise


def test_files_that_are_no_recordings_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="missing.mcap"):
        toprise.read(tmp_path / "missing.mcap")
    with pytest.raises(toprise.RecordingError, match="it is a directory"):
        toprise.read(tmp_path)
    empty = tmp_path / "empty.mcap"
    empty.touch()
    with pytest.raises(toprise.RecordingError, match="empty.mcap: the file is empty"):
        toprise.read(empty)
    with pytest.raises(toprise.RecordingError, match="not by toprise"):
        toprise.read(ROOT / "tests/data/foreign/json_a.mcap")


def test_what_is_left_of_a_recording_is_given_with_a_warning(reference, tmp_path):
    whole = (reference / "paper.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: len(whole) // 2])
    with pytest.warns(toprise.RecordingWarning, match="cut: missing .*and 1 more"):
        run = toprise.read(cut)
    assert run.losses[-1] == "missing end of the run (interrupted)"
    assert run.content_digest is None
    part, all_of_it = run["/top/state"], toprise.read(reference / "paper.mcap")["/top/state"]
    theta = part.numpy("theta")
    assert 0 < len(theta) < len(all_of_it)
    assert (theta == all_of_it.numpy("theta")[: len(theta)]).all()


def test_damage_is_told(reference, tmp_path):
    damaged = bytearray((reference / "paper.mcap").read_bytes())
    middle = len(damaged) // 2
    damaged[middle : middle + 1000] = bytes(1000)
    file = tmp_path / "damaged.mcap"
    file.write_bytes(damaged)
    with pytest.warns(toprise.RecordingWarning, match="damaged: missing [0-9]{2},[0-9]{3} bytes at"):
        run = toprise.read(file)
    assert len(run.losses) == 1
    assert toprise.verify(file).verdict == "incomplete"


def test_a_whole_recording_is_read_in_silence(reference):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = toprise.read(reference / "full-coulomb.mcap")
    assert run.losses == [] and run.name == "full-coulomb"


def test_a_run_is_a_mapping_of_topics(brief):
    assert "/top/state" in brief and "/top/impact" not in brief
    assert list(brief) == brief.topics == brief.keys() and len(brief) == 10
    assert brief.events.name == "/events" and brief.nutations.name == "/top/nutation"
    with pytest.raises(KeyError, match="/top/impact; topics: /top/state, "):
        brief["/top/impact"]
    with pytest.raises(KeyError, match="no column thet; columns: time_ns, "):
        brief["/top/state"].numpy("thet")
    with pytest.raises(ValueError, match=r"unknown topic /top/stat \(did you mean /top/state\?\);"):
        toprise.run("paper", topics=["/top/stat"])


def test_a_run_is_saved_as_the_program_records_it(brief, tmp_path):
    path = tmp_path / "saved.mcap"
    brief.save(path)
    assert toprise.verify(path).verdict == "verified"
    assert toprise.read(path).content_digest == brief.content_digest
    before = path.read_bytes()
    with pytest.raises(toprise.RecordingError, match="saved.mcap exists: .*force=True"):
        brief.save(path)
    assert path.read_bytes() == before
    path.write_bytes(b"old")
    brief.save(path, force=True)
    assert path.read_bytes() == before


def without_the_program(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name: None)


def test_the_program_writes_rrd_files_with_its_layout(brief, tmp_path, monkeypatch):
    program = tmp_path / "toprise"
    program.write_text(
        f"#!{sys.executable}\n"
        "import shutil, sys\n"
        "command, source, option, target, *rest = sys.argv[1:]\n"
        "assert (command, option, rest) == ('view', '--rrd', ['--force', '--quiet']), sys.argv\n"
        "if 'bad' in target: sys.exit('no space left')\n"
        "shutil.copy(source, target)\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    path = tmp_path / "a.rrd"
    brief.save(path)
    assert path.read_bytes()[1:5] == b"MCAP"
    with pytest.raises(toprise.RecordingError, match="bad.rrd: no space left"):
        brief.save(tmp_path / "bad.rrd")


def test_without_the_program_rerun_converts(brief, tmp_path, monkeypatch):
    without_the_program(monkeypatch)
    package = tmp_path / "rerun"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "__main__.py").write_text(
        "import shutil, sys\n"
        "command, action, source, option, target = sys.argv[1:]\n"
        "assert (command, action, option) == ('mcap', 'convert', '-o'), sys.argv\n"
        "if 'bad' in target: sys.exit('no space left')\n"
        "shutil.copy(source, target)\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.syspath_prepend(tmp_path)
    path = tmp_path / "a.rrd"
    brief.save(path)
    assert path.read_bytes()[1:5] == b"MCAP"
    with pytest.raises(toprise.RecordingError, match="bad.rrd: no space left"):
        brief.save(tmp_path / "bad.rrd")


def test_a_run_opens_in_the_viewer(brief, tmp_path, monkeypatch, reference):
    without_the_program(monkeypatch)
    viewer = tmp_path / "rerun"
    viewer.mkdir()
    (viewer / "__init__.py").touch()
    (viewer / "__main__.py").write_text("import pathlib, sys\nprint(pathlib.Path(sys.argv[1]).stat().st_size)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.syspath_prepend(tmp_path)
    for run in (brief, toprise.read(reference / "paper.mcap", topics=["/events"])):
        assert run.rerun().wait(timeout=60) == 0


def test_without_a_viewer_it_is_named(brief, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ImportError, match="pip install rerun-sdk"):
        brief.rerun()
