//! The Rerun stream, as far as it can be tested without a viewer.

use crate::support::{Folder, assert_contains, printed};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::external::re_log_types::LogMsg;
use rerun::log::Chunk;
use std::time::{Duration, Instant};
use toprise::archive::recording::Overview;

#[test]
fn one_pass_writes_both_recordings() {
    let folder = Folder::new();
    let text = folder.toprise("run --set stop.duration=0.3", 0).stdout;
    assert_contains(&text, "rerun recordings/paper_duration0.3.rrd");
    let bytes = folder.read("recordings/paper_duration0.3.rrd");
    assert_eq!(&bytes[..4], b"RRF2");
    let partial = folder.at("recordings/paper_duration0.3.rrd.partial");
    assert!(!partial.exists());
}

#[test]
fn a_missing_viewer_is_a_warning_and_harms_nothing() {
    let folder = Folder::new();
    let started = Instant::now();
    // Nothing listens on the discard port.
    let viewer = "--connect=rerun+http://127.0.0.1:9/proxy";
    let line = format!("run --set stop.duration=0.3 -o a.mcap {viewer}");
    let mut program = folder.program(&line);
    let warning = printed(program.timeout(Duration::from_mins(1)), &line, 0).stderr;
    assert_contains(&warning, "warning");
    assert_contains(&warning, "127.0.0.1:9");
    assert!(started.elapsed() < Duration::from_secs(30));
    let archive = Overview::read(&folder.at("a.mcap")).unwrap();
    assert!(archive.is_whole());
}

/// The chunks of an `.rrd` file, in order.
fn chunks(bytes: &[u8]) -> Vec<Chunk> {
    DecoderApp::decode_eager(bytes)
        .unwrap()
        .filter_map(|message| match message.unwrap() {
            LogMsg::ArrowMsg(_, message) => Some(Chunk::from_arrow_msg(&message).unwrap()),
            _ => None,
        })
        .collect()
}

#[test]
fn repeated_paced_and_replayed_runs_have_the_same_chunks() {
    let folder = Folder::new();
    // The stem of the file is the name in the viewer, so it is the same for all.
    for (name, pace) in [("first", ""), ("second", ""), ("paced", "--realtime")] {
        let outputs = format!("-o {name}/run.mcap --rrd {name}/run.rrd");
        let line = format!("run --set stop.duration=0.3 {outputs} {pace}");
        folder.toprise(&line, 0);
    }
    folder.toprise("view first/run.mcap --rrd replayed/run.rrd", 0);
    let expected = chunks(&folder.read("first/run.rrd"));
    assert!(expected.len() > 50);
    for name in ["second", "paced", "replayed"] {
        let found = chunks(&folder.read(format!("{name}/run.rrd")));
        assert_eq!(found.len(), expected.len(), "{name}");
        for (found, expected) in found.iter().zip(&expected) {
            // Not assert_eq, which would print the chunks.
            assert!(found == expected, "{name}: {}", expected.entity_path());
        }
    }
}

#[test]
fn the_outcome_is_a_property_of_whole_runs() {
    let folder = Folder::new();
    let outcomes = |arguments: &str, rrd: &str| {
        folder.toprise(&format!("{arguments} --rrd {rrd}"), 0);
        let bytes = folder.read(rrd);
        chunks(&bytes)
            .iter()
            .filter(|chunk| chunk.entity_path().to_string() == "/__properties/outcome")
            .count()
    };
    let run = "run --set stop.duration=0.1 -o a.mcap";
    assert_eq!(outcomes(run, "a.rrd"), 1);
    assert_eq!(outcomes("view a.mcap", "whole.rrd"), 1);
    // What came of a run is not what came of a part of it.
    assert_eq!(outcomes("view a.mcap --to 0.05", "part.rrd"), 0);
}
