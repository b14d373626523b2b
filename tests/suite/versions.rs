//! Archives outlive versions: recordings of earlier versions are judged by the rules of theirs.

use crate::forgeries::Forgery;
use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};
use toprise::analysis::complete::complete;
use toprise::analysis::verify::{Options, Report, Verdict, verify};
use toprise::archive::convert::convert;
use toprise::archive::publish::Existing;
use toprise::archive::recording::{Condition, Recording};
use toprise::archive::recover::recover;
use toprise::telemetry::Version;
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::table::VERSION;

fn old(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/0.1.0");
    directory.join(name)
}

fn verified(path: &Path) -> Report {
    verify(&Recording::open(path).unwrap(), Options::default(), &|_| {})
}

#[test]
fn recordings_of_the_first_version_are_verified() {
    for entry in fs::read_dir(old("")).unwrap() {
        let path = entry.unwrap().path();
        let report = verified(&path);
        let expected = match path.file_stem().unwrap().to_str() {
            Some("lifecycle") => Verdict::Partial,
            _ => Verdict::Passed,
        };
        assert_eq!(
            report.verdict(),
            expected,
            "{}: {report:#?}",
            path.display()
        );
        assert_eq!(report.telemetry, Some(1));
        let last = report.checks.last().unwrap();
        let told = "are equal, bit for bit, in all fields of telemetry 1";
        assert!(last.finding.contains(told), "{}", last.finding);
        let told = "that toprise 0.1.0 simulated it";
        assert!(
            report.not_covered.iter().any(|what| what.contains(told)),
            "{report:#?}"
        );
    }
}

#[test]
fn the_first_version_has_the_schemas_that_it_recorded() {
    let first = Version::find(1).unwrap();
    for name in ["paper.mcap", "protobuf.mcap"] {
        let recording = Recording::open(&old(name)).unwrap();
        for channel in recording.channels() {
            assert!(channel.is_of(&first), "{name}: {}", channel.topic);
        }
    }
    assert!(Version::find(0).is_none() && Version::find(VERSION + 1).is_none());
}

#[test]
fn an_old_recording_is_converted_as_what_it_is() {
    let directory = tempfile::tempdir().unwrap();
    let [json, back] = ["json.mcap", "back.mcap"].map(|name| directory.path().join(name));
    let write = |from: &Path, to: &Path, encoding| {
        let recording = Recording::open(from).unwrap();
        convert(&recording, to, Existing::Keep, encoding, &|_| {}).unwrap()
    };
    let original = old("protobuf.mcap");
    let archived = write(&original, &json, Encoding::Json);
    let end = Recording::open(&original).unwrap().end().unwrap().clone();
    assert_eq!(archived.digest, end["content_digest"]);
    write(&json, &back, Encoding::Protobuf);
    for path in [json, back] {
        let report = verified(&path);
        assert_eq!(report.verdict(), Verdict::Passed, "{report:#?}");
        assert_eq!(report.telemetry, Some(1));
    }
}

#[test]
fn an_old_recording_is_saved_as_what_it_is_and_completed_as_what_is_recorded_today() {
    let directory = tempfile::tempdir().unwrap();
    let [cut, saved, whole] =
        ["cut.mcap", "saved.mcap", "whole.mcap"].map(|name| directory.path().join(name));
    let bytes = fs::read(old("full-coulomb.mcap")).unwrap();
    fs::write(&cut, &bytes[..bytes.len() / 3]).unwrap();
    let recording = Recording::open(&cut).unwrap();
    assert_eq!(verified(&cut).verdict(), Verdict::Incomplete);
    let recovered = recover(&recording, &saved, Existing::Keep, &|_| {}).unwrap();
    assert!(
        recovered.messages > 1000 && recovered.undecodable == 0,
        "{recovered:?}"
    );
    let report = verified(&saved);
    assert_eq!(report.verdict(), Verdict::Incomplete, "{report:#?}");
    assert_eq!(
        (report.condition, report.telemetry),
        (Condition::Recovered, Some(1))
    );

    complete(&recording, &whole, Existing::Keep, &|_| {}).unwrap();
    let report = verified(&whole);
    assert_eq!(report.verdict(), Verdict::Passed, "{report:#?}");
    assert_eq!(report.telemetry, Some(VERSION));
    // It is not the file that was: that is said, with exit code 3.
    let output = Command::cargo_bin("toprise")
        .unwrap()
        .current_dir(directory.path())
        .args(["recover", "--complete", "cut.mcap", "again.mcap"])
        .assert()
        .code(3);
    let text = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
    assert!(
        text.contains("telemetry 1, in which it was recorded"),
        "{text}"
    );
}

#[test]
fn a_newer_recording_is_told_as_such() {
    let directory = tempfile::tempdir().unwrap();
    let mut forgery = Forgery::of(&fs::read(old("protobuf.mcap")).unwrap());
    forgery.set("toprise.run", "telemetry", &(VERSION + 1).to_string());
    forgery.set("toprise.run", "version", "9.9.9");
    forgery.write(&directory.path().join("new.mcap"));
    for arguments in [
        &["verify", "new.mcap"][..],
        &["convert", "new.mcap", "x.mcap", "--encoding", "json"],
        &["recover", "new.mcap", "x.mcap"],
        &["recover", "new.mcap", "x.mcap", "--complete"],
    ] {
        let output = Command::cargo_bin("toprise")
            .unwrap()
            .current_dir(directory.path())
            .args(arguments)
            .assert()
            .code(2);
        let text = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        let told = format!("toprise 9.9.9 recorded it as telemetry {}", VERSION + 1);
        assert!(text.contains(&told), "{arguments:?}: {text}");
    }
}
