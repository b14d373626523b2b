//! The Rerun stream, as far as it can be tested without a viewer.

use crate::support::assert_contains;
use assert_cmd::Command;
use rerun::StoreId;
use rerun::external::re_log_encoding::{Decodable as _, DecoderApp, RawRrdManifest, StreamFooter};
use rerun::external::re_log_types::LogMsg;
use rerun::log::{Chunk, ChunkId};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};
use tempfile::tempdir;
use toprise::archive::recording::Overview;

#[test]
fn one_pass_writes_both_recordings() {
    let directory = tempdir().unwrap();
    let text = toprise(directory.path())
        .args(["run", "--set", "stop.duration=0.3"])
        .assert()
        .success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert_contains(&text, "rerun recordings/paper_duration0.3.rrd");
    let bytes = fs::read(directory.path().join("recordings/paper_duration0.3.rrd")).unwrap();
    assert_eq!(&bytes[..4], b"RRF2");
    assert!(
        !directory
            .path()
            .join("recordings/paper_duration0.3.rrd.partial")
            .exists()
    );
}

#[test]
fn a_missing_viewer_is_a_warning_and_harms_nothing() {
    let directory = tempdir().unwrap();
    let started = Instant::now();
    let done = toprise(directory.path())
        .args(["run", "--set", "stop.duration=0.3", "-o", "a.mcap"])
        // Nothing listens on the discard port.
        .arg("--connect=rerun+http://127.0.0.1:9/proxy")
        .timeout(Duration::from_mins(1))
        .assert()
        .success();
    let warning = String::from_utf8_lossy(&done.get_output().stderr).into_owned();
    assert!(
        warning.contains("warning") && warning.contains("127.0.0.1:9"),
        "{warning}"
    );
    assert!(started.elapsed() < Duration::from_secs(30));
    let archive = Overview::read(&directory.path().join("a.mcap")).unwrap();
    assert!(archive.is_whole());
}

#[test]
fn a_run_gives_the_same_bytes_again_and_from_its_archive() {
    let directory = tempdir().unwrap();
    let run = |name: &str, pace: &[&str]| {
        let rrd = format!("{name}/run.rrd");
        toprise(directory.path())
            .args(["run", "--set", "stop.duration=0.3", "-o"])
            .args([&format!("{name}/run.mcap"), "--rrd", &rrd])
            .args(pace)
            .assert()
            .success();
        fs::read(directory.path().join(rrd)).unwrap()
    };
    let (first, second) = (run("first", &[]), run("second", &[]));
    let paced = run("paced", &["--realtime"]);
    toprise(directory.path())
        .args(["view", "first/run.mcap", "--rrd", "viewed.rrd"])
        .assert()
        .success();
    let viewed = fs::read(directory.path().join("viewed.rrd")).unwrap();
    assert!(first.len() > 100_000);
    // Not assert_eq, which would print the files.
    assert!(first == second, "two runs differ");
    assert!(first == paced, "a paced run differs");
    assert!(first == viewed, "the archive gives another recording");
}

#[test]
fn the_outcome_is_a_property_of_whole_runs() {
    let directory = tempdir().unwrap();
    let outcomes = |arguments: &[&str], rrd: &str| {
        let mut program = toprise(directory.path());
        program.args(arguments).args(["--rrd", rrd]);
        program.assert().success();
        let bytes = fs::read(directory.path().join(rrd)).unwrap();
        let messages = DecoderApp::decode_eager(&bytes[..]).unwrap();
        let chunks = messages.filter_map(|message| match message.unwrap() {
            LogMsg::ArrowMsg(_, message) => Some(Chunk::from_arrow_msg(&message).unwrap()),
            _ => None,
        });
        let told = chunks.filter(|c| c.entity_path().to_string() == "/__properties/outcome");
        told.count()
    };
    let run = ["run", "--set", "stop.duration=0.1", "-o", "a.mcap"];
    assert_eq!(outcomes(&run, "a.rrd"), 1);
    assert_eq!(outcomes(&["view", "a.mcap"], "whole.rrd"), 1);
    // What came of a run is not what came of a part of it.
    let part = ["view", "a.mcap", "--to", "0.05"];
    assert_eq!(outcomes(&part, "part.rrd"), 0);
}

#[test]
fn the_footer_tells_of_every_chunk() {
    let directory = tempdir().unwrap();
    toprise(directory.path())
        .args(["run", "--set", "stop.duration=0.3", "-o", "run.mcap"])
        .args(["--rrd", "run.rrd"])
        .assert()
        .success();
    let bytes = fs::read(directory.path().join("run.rrd")).unwrap();
    let mut chunks: BTreeMap<StoreId, Vec<ChunkId>> = BTreeMap::new();
    let mut decoder = DecoderApp::decode_eager(&bytes[..]).unwrap();
    for message in decoder.by_ref() {
        if let LogMsg::ArrowMsg(store, message) = message.unwrap() {
            let chunk = Chunk::from_arrow_msg(&message).unwrap();
            chunks.entry(store).or_default().push(chunk.id());
        }
    }
    let manifests = decoder.rrd_manifests().unwrap();
    assert_eq!(manifests.len(), chunks.len());
    for manifest in manifests {
        let told: Vec<ChunkId> = manifest.col_chunk_id().unwrap().collect();
        assert_eq!(told, chunks[&manifest.store_id], "{:?}", manifest.store_id);
        let schema = RawRrdManifest::compute_sorbet_schema_sha256(&manifest.sorbet_schema);
        assert_eq!(schema.unwrap(), manifest.sorbet_schema_sha256);
    }
    let (_, end) = bytes.split_at(bytes.len() - StreamFooter::ENCODED_SIZE_BYTES);
    let place = &StreamFooter::from_rrd_bytes(end).unwrap().entries[0];
    let span = place.rrd_footer_byte_span_from_start_excluding_header;
    let footer = &bytes[span.range_usize()];
    assert_eq!(
        StreamFooter::compute_crc(footer),
        place.crc_excluding_header
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_for_the_rrd_leaves_the_archive_whole() {
    let directory = tempdir().unwrap();
    // A file-size limit stands for the full disk: 1 MiB is enough for the archive only.
    let script = format!(
        "ulimit -f 1024; trap '' XFSZ; exec {} run --set stop.duration=0.3 \
         --encoding protobuf --no-views -o run.mcap --rrd run.rrd",
        assert_cmd::cargo::cargo_bin("toprise").display()
    );
    let output = std::process::Command::new("bash")
        .current_dir(directory.path())
        .args(["-c", &script])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(
        error.contains("Rerun recording") && error.contains("too large"),
        "{error}"
    );
    let archive = Overview::read(&directory.path().join("run.mcap")).unwrap();
    assert!(archive.is_whole());
    assert!(!directory.path().join("run.rrd").exists());
}

fn toprise(directory: &Path) -> Command {
    let mut command = Command::cargo_bin("toprise").unwrap();
    command.current_dir(directory);
    command
}
