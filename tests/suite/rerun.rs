//! The Rerun stream, as far as it can be tested without a viewer.

use assert_cmd::Command;
use std::fs;
use std::time::{Duration, Instant};
use tempfile::tempdir;

#[test]
fn one_pass_writes_both_recordings() {
    let directory = tempdir().unwrap();
    let mut command = Command::cargo_bin("toprise").unwrap();
    let text = command
        .current_dir(directory.path())
        .args(["run", "--set", "stop.duration=0.3"])
        .assert()
        .success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("rerun recordings/paper.rrd"), "{text}");
    let bytes = fs::read(directory.path().join("recordings/paper.rrd")).unwrap();
    assert_eq!(&bytes[..4], b"RRF2");
    assert!(
        !directory
            .path()
            .join("recordings/paper.rrd.partial")
            .exists()
    );
}

#[test]
fn a_missing_viewer_is_a_warning_and_harms_nothing() {
    let directory = tempdir().unwrap();
    let started = Instant::now();
    let mut command = Command::cargo_bin("toprise").unwrap();
    let done = command
        .current_dir(directory.path())
        .args(["run", "--set", "stop.duration=0.3", "-o", "a.mcap"])
        // Nothing listens on the discard port.
        .arg("--connect=rerun+http://127.0.0.1:9/proxy")
        .timeout(Duration::from_secs(60))
        .assert()
        .success();
    let warning = String::from_utf8_lossy(&done.get_output().stderr).into_owned();
    assert!(
        warning.contains("warning") && warning.contains("127.0.0.1:9"),
        "{warning}"
    );
    assert!(started.elapsed() < Duration::from_secs(30));
    assert!(
        toprise::archive::recording::Overview::read(&directory.path().join("a.mcap"))
            .unwrap()
            .is_whole()
    );
}
