//! The Rerun stream, as far as it can be tested without a viewer.

use crate::support::{Folder, assert_contains, printed};
use rerun::StoreId;
use rerun::external::re_log_encoding::{Decodable as _, DecoderApp, RawRrdManifest, StreamFooter};
use rerun::external::re_log_types::LogMsg;
use rerun::log::{Chunk, ChunkId};
use std::collections::BTreeMap;
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

#[test]
fn a_run_gives_the_same_bytes_again_and_from_its_archive() {
    let folder = Folder::new();
    let run = |name: &str, pace: &str| {
        let outputs = format!("-o {name}/run.mcap --rrd {name}/run.rrd");
        let line = format!("run --set stop.duration=0.3 {outputs} {pace}");
        folder.toprise(&line, 0);
        folder.read(format!("{name}/run.rrd"))
    };
    let (first, second) = (run("first", ""), run("second", ""));
    let paced = run("paced", "--realtime");
    folder.toprise("view first/run.mcap --rrd viewed.rrd", 0);
    let viewed = folder.read("viewed.rrd");
    assert!(first.len() > 100_000);
    // Not assert_eq, which would print the files.
    assert!(first == second, "two runs differ");
    assert!(first == paced, "a paced run differs");
    assert!(first == viewed, "the archive gives another recording");
}

#[test]
fn the_outcome_is_a_property_of_whole_runs() {
    let folder = Folder::new();
    let outcomes = |arguments: &str, rrd: &str| {
        folder.toprise(&format!("{arguments} --rrd {rrd}"), 0);
        let bytes = folder.read(rrd);
        let messages = DecoderApp::decode_eager(&bytes[..]).unwrap();
        let chunks = messages.filter_map(|message| match message.unwrap() {
            LogMsg::ArrowMsg(_, message) => Some(Chunk::from_arrow_msg(&message).unwrap()),
            _ => None,
        });
        let told = chunks.filter(|c| c.entity_path().to_string() == "/__properties/outcome");
        told.count()
    };
    let run = "run --set stop.duration=0.1 -o a.mcap";
    assert_eq!(outcomes(run, "a.rrd"), 1);
    assert_eq!(outcomes("view a.mcap", "whole.rrd"), 1);
    // What came of a run is not what came of a part of it.
    assert_eq!(outcomes("view a.mcap --to 0.05", "part.rrd"), 0);
}

#[test]
fn the_footer_tells_of_every_chunk() {
    let folder = Folder::new();
    let line = "run --set stop.duration=0.3 -o run.mcap --rrd run.rrd";
    folder.toprise(line, 0);
    let bytes = folder.read("run.rrd");
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
    let sum = StreamFooter::compute_crc(footer);
    assert_eq!(sum, place.crc_excluding_header);
}
