//! Damaged recordings: all damage is detected, nothing panics, and the run can be repeated.

use crate::fuzz_corpus::steps::analyses;
use crate::support::{
    Folder, archive, assert_contains, is_noticed, recorded, run_again, scenario, verified,
};
use assert_cmd::Command;
use mcap::records::op;
use std::fs;
use std::io::Read as _;
use std::ops::Range;
use std::path::Path;
use std::thread;
use toprise::analysis::diff::{Options, compare};
use toprise::analysis::explain::{Fact, explain};
use toprise::archive::recording::{Condition, Overview, Recording, Selection};
use toprise::archive::verify::Verdict;
use toprise::archive::writer::Form;
use toprise::figures::{Figure, RunData};
use toprise::telemetry::encoding::Encoding;

/// Reads everything of the file in every way.
fn endures(path: &Path) {
    let _ = Overview::read(path);
    if let Ok(recording) = Recording::open(path) {
        let mut reader = recording.reader(Selection::default());
        while reader.next().is_some() {}
    }
}

/// Calls `check` with each of the cases, divided between two threads with a directory each.
pub fn in_parallel<T: Sync>(cases: &[T], check: impl Fn(&Path, &T) + Sync) {
    thread::scope(|scope| {
        for half in [0, 1] {
            let check = &check;
            scope.spawn(move || {
                let directory = tempfile::tempdir().unwrap();
                let path = directory.path().join("case.mcap");
                for case in cases.iter().skip(half).step_by(2) {
                    check(&path, case);
                }
            });
        }
    });
}

fn short(duration: &str) -> Vec<u8> {
    let scenario = scenario("paper", &[("stop.duration", duration)]);
    recorded(&scenario, &[], Form::default())
}

/// A copy with other bits at a place.
fn flipped(bytes: &[u8], place: usize, mask: u8) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[place] ^= mask;
    bytes
}

#[test]
fn notices_any_changed_byte() {
    let form = Form {
        views: false,
        ..Form::default()
    };
    let scenario = scenario("paper", &[("stop.duration", "0.002")]);
    let whole = recorded(&scenario, &["/events"], form);
    let positions: Vec<usize> = (0..whole.len()).collect();
    in_parallel(&positions, |path, position| {
        for mask in [0x01, 0x80, 0xff] {
            fs::write(path, flipped(&whole, *position, mask)).unwrap();
            assert!(is_noticed(path), "byte {position} xor {mask:#x}");
        }
        endures(path);
    });
}

#[test]
fn notices_flipped_bits() {
    for encoding in Encoding::ALL {
        let form = Form {
            encoding,
            views: true,
        };
        let scenario = scenario("paper", &[("stop.duration", "0.08")]);
        let whole = recorded(&scenario, &[], form);
        let positions: Vec<usize> = (0..1000).map(|i| i * whole.len() / 1000).collect();
        in_parallel(&positions, |path, position| {
            let bytes = flipped(&whole, *position, 1 << (position % 8));
            fs::write(path, bytes).unwrap();
            assert!(is_noticed(path), "{encoding:?}: byte {position}");
            if position % 10 == 0 {
                endures(path);
            }
            if position % 50 == 0
                && let Ok(recording) = Recording::open(path)
            {
                analyses(&recording);
            }
        });
    }
}

#[test]
fn reads_recordings_cut_anywhere() {
    let whole = short("0.1");
    let mut lengths: Vec<usize> = (0..200).map(|i| i * whole.len() / 200).collect();
    lengths.extend(whole.len() - 300..whole.len());
    in_parallel(&lengths, |path, length| {
        fs::write(path, &whole[..*length]).unwrap();
        assert!(is_noticed(path), "{length} bytes");
        if length % 5 == 0 {
            endures(path);
        }
        if length % 25 == 0
            && let Ok(recording) = Recording::open(path)
        {
            analyses(&recording);
        }
    });
}

#[test]
fn notices_swapped_and_repeated_chunks() {
    let whole = short("0.5");
    let chunks = chunks(&whole);
    assert!(chunks.len() > 4);
    let (first, second) = (chunks[1].clone(), chunks[2].clone());
    let parts = |order: [&Range<usize>; 2]| {
        let parts = order.map(|part| &whole[part.clone()]);
        [
            &whole[..first.start],
            parts[0],
            parts[1],
            &whole[second.end..],
        ]
        .concat()
    };
    let changed = [
        parts([&second, &first]),
        parts([&first, &first]),
        parts([&first, &(0..0)]),
    ];
    in_parallel(&changed, |path, bytes| {
        fs::write(path, bytes).unwrap();
        assert!(is_noticed(path));
        endures(path);
        analyses(&Recording::open(path).unwrap());
    });
}

/// A file that ends between two records has nothing that can't be read, and lacks the end of its run.
#[test]
fn cut_between_records_is_interrupted() {
    let folder = Folder::new();
    let whole = short("0.5");
    let end = chunks(&whole)[3].end;
    let path = folder.write("cut.mcap", &whole[..end]);
    let recording = Recording::open(&path).unwrap();
    assert_eq!(recording.losses(), []);
    let story = explain(&recording).unwrap();
    assert_eq!(story.losses, ["missing end of the run (interrupted)"]);
    for command in [&["explain"][..], &["view", "--rrd", "x.rrd"]] {
        if cfg!(feature = "rerun") || command.len() == 1 {
            let mut program = Command::cargo_bin("toprise").unwrap();
            let program = program.args(command).arg(&path).current_dir(folder.path());
            program.assert().code(3);
        }
    }
}

#[test]
fn skips_and_reports_repeated_messages() {
    let folder = Folder::new();
    let whole = short("0.5");
    let first = chunks(&whole)[1].clone();
    let bytes = [&whole[..first.end], &whole[first.start..]].concat();
    let path = folder.write("run.mcap", bytes);
    let recording = Recording::open(&path).unwrap();
    let figure = Figure::find("figure-2").unwrap();
    let run = RunData::read(&recording, "run", &[figure], &|_| {});
    let story = explain(&recording).unwrap();
    for losses in [&run.losses, &story.losses] {
        let part = "messages skipped: repeated";
        assert_contains(&losses.join("\n"), part);
    }
    // Sorted and without the repetition it is the run that was recorded.
    let original = Recording::open(&folder.write("original.mcap", &whole)).unwrap();
    let sound = RunData::read(&original, "run", &[figure], &|_| {});
    assert_eq!(sound.losses, Vec::<String>::new());
    let [run, sound] = [run, sound].map(|run| figure.draw(&[&run], 85.0).svg());
    assert_eq!(run, sound);
    analyses(&recording);
}

/// Where the chunks with their indexes lie, by another reader.
pub fn chunks(bytes: &[u8]) -> Vec<Range<usize>> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let mut indexes = summary.chunk_indexes;
    indexes.sort_by_key(|index| index.chunk_start_offset);
    let range = |index: &mcap::records::ChunkIndex| {
        let start = index.chunk_start_offset;
        let end = start + index.chunk_length + index.message_index_length;
        start as usize..end as usize
    };
    indexes.iter().map(range).collect()
}

#[test]
fn reads_past_damage_and_reruns() {
    let folder = Folder::new();
    let scenario = scenario("paper", &[("stop.duration", "0.5")]);
    for (encoding, topics) in [
        (Encoding::Json, &[][..]),
        (Encoding::Protobuf, &["/top/state", "/top/energy"]),
    ] {
        let form = Form {
            encoding,
            ..Form::default()
        };
        let whole = recorded(&scenario, topics, form);
        let hit = chunks(&whole).pop().unwrap();
        let bytes = flipped(&whole, usize::midpoint(hit.start, hit.end), 1);
        let path = folder.write("run.mcap", bytes);
        let recording = Recording::open(&path).unwrap();
        let overview = Overview::new(&recording);
        assert_eq!(overview.condition, Condition::Damaged);
        assert_eq!(overview.losses.len(), 1);
        assert_eq!(overview.losses[0].offset, hit.start as u64);
        let mut reader = recording.reader(Selection::default());
        while reader.next().is_some() {}
        assert_eq!(reader.losses(), overview.losses);
        let report = verified(&path);
        assert_eq!(report.verdict, Verdict::Incomplete, "{report:#?}");
        assert_eq!(report.state, Condition::Damaged);
        assert!(report.missing > 0);
        assert!(run_again(&path).unwrap() == whole);
    }
}

#[test]
fn recordings_without_scenario_cannot_rerun() {
    let whole = short("0.02");
    let folder = Folder::new();
    let first_chunk = chunks(&whole)[0].start;
    // Each record is an opcode, the length of its body, and the body; the header follows the magic bytes.
    let mut ends = vec![8];
    while let Some(end) = ends.last().filter(|end| **end < first_chunk) {
        let length = whole[end + 1..end + 9].try_into().unwrap();
        ends.push(end + 9 + u64::from_le_bytes(length) as usize);
    }
    // The header, toprise.run and the scenario.
    let runs = ends[1..].iter().map(|end| {
        let path = folder.write("cut.mcap", &whole[..*end]);
        assert!(is_noticed(&path), "{end}");
        run_again(&path).map(|bytes| bytes == whole)
    });
    assert_eq!(runs.collect::<Vec<_>>(), [None, None, Some(true)]);
}

#[test]
fn damage_outside_chunks_loses_no_messages() {
    let whole = short("0.5");
    let folder = Folder::new();
    let changed = |at: usize, mask: u8| {
        let path = folder.write("run.mcap", flipped(&whole, at, mask));
        assert!(is_noticed(&path), "byte {at}");
        assert_eq!(verified(&path).missing, 0, "byte {at}");
    };
    // The times in the head of a chunk, which then seems to be at the wrong place.
    for chunk in chunks(&whole) {
        for byte in [9, 13, 17, 21] {
            changed(chunk.start + byte, 0x10);
        }
    }
    // A length that includes the following records: of the header, and of the end of the data.
    changed(8 + 1, 0x40);
    let summary = mcap::read::footer(&whole).unwrap().summary_start as usize;
    let data_end = summary - 13;
    assert_eq!(whole[data_end], op::DATA_END);
    for (byte, mask) in [(1, 0x40), (2, 0x01), (2, 0x04)] {
        changed(data_end + byte, mask);
    }
    // The summary.
    for at in (summary + 9..whole.len() - 40).step_by(151) {
        changed(at, 1);
    }
}

#[test]
fn notices_bytes_after_the_footer() {
    let whole = short("0.1");
    let (whole, magic) = whole.split_at(whole.len() - mcap::MAGIC.len());
    let bytes = [whole, &record(0x85, b"hello"), magic].concat();
    let folder = Folder::new();
    let path = folder.write("run.mcap", bytes);
    assert!(is_noticed(&path));
}

#[test]
fn reads_everything_without_an_index() {
    let folder = Folder::new();
    let whole = short("0.3");
    // The end magic and a part of the footer.
    let path = folder.write("run.mcap", &whole[..whole.len() - 20]);
    let report = verified(&path);
    assert_eq!(report.state, Condition::Damaged);
    assert_eq!((report.verdict, report.missing), (Verdict::Incomplete, 0));
    let messages = Overview::read(&path).unwrap().messages();
    assert_eq!(report.equal, Some(messages));
    assert!(run_again(&path).unwrap() == whole);
}

#[test]
fn rejects_foreign_scenario() {
    let whole = |k: &str| {
        let scenario = scenario("paper", &[("stop.duration", "0.3"), ("friction.k", k)]);
        recorded(&scenario, &[], Form::default())
    };
    let (a, b) = (whole("0.03"), whole("0.02"));
    // The metadata and the scenario of one run, something unreadable, and all messages and the end of the other.
    let (head, rest) = (&a[..chunks(&a)[0].start], &b[chunks(&b)[0].start..]);
    let spliced = [head, &[0xee; 40], rest].concat();
    let folder = Folder::new();
    let report = verified(&folder.write("spliced.mcap", spliced));
    assert_eq!(report.verdict, Verdict::Different, "{report:#?}");
}

#[test]
fn notices_changed_metadata_of_interrupted_runs() {
    let whole = short("0.01");
    let interrupted = &whole[..chunks(&whole).last().unwrap().end];
    let mut places = interrupted.windows(11);
    let name = places.position(|bytes| bytes == b"toprise.run");
    // Opcode and length of the record, and the length of its name, stand before.
    let start = name.unwrap() - 13;
    let length = u64::from_le_bytes(whole[start + 1..start + 9].try_into().unwrap());
    let positions: Vec<usize> = (start..start + 9 + length as usize).collect();
    let folder = Folder::new();
    let sound = verified(&folder.write("interrupted.mcap", interrupted));
    in_parallel(&positions, |path, position| {
        let bytes = flipped(interrupted, *position, 1 << (position % 8));
        fs::write(path, bytes).unwrap();
        assert_ne!(verified(path), sound, "byte {position}");
    });
}

#[test]
fn cut_summary_is_incomplete() {
    let whole = short("0.1");
    let summary = mcap::read::footer(&whole).unwrap().summary_start as usize;
    let lengths: Vec<usize> = (summary..whole.len()).step_by(29).collect();
    in_parallel(&lengths, |path, length| {
        fs::write(path, &whole[..*length]).unwrap();
        let report = verified(path);
        let what = format!("{length} bytes: {report:?}");
        assert_eq!(report.verdict, Verdict::Incomplete, "{what}");
    });
}

/// A record of an MCAP file.
fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

#[test]
fn bounds_decompression() {
    let size = 1 << 26;
    let zeros = zstd::encode_all(std::io::repeat(0).take(size), 1).unwrap();
    let chunk = [
        // Times, size and checksum.
        &[0; 16][..],
        &size.to_le_bytes(),
        &[0; 4],
        // Compression.
        &4_u32.to_le_bytes(),
        b"zstd",
        &(zeros.len() as u64).to_le_bytes(),
        &zeros,
    ];
    let header = record(op::HEADER, &[0; 8]);
    let chunk = record(op::CHUNK, &chunk.concat());
    let folder = Folder::new();
    let path = folder.write("zeros.mcap", [mcap::MAGIC, &header, &chunk].concat());
    let overview = Overview::read(&path).unwrap();
    let losses: Vec<_> = overview.losses.iter().map(ToString::to_string).collect();
    assert_contains(&losses.join("\n"), "at byte 0 of the chunk");
}

#[cfg(unix)]
#[test]
fn refuses_pipes_without_waiting() {
    let folder = Folder::new();
    let path = folder.at("pipe.mcap");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.unwrap().success());
    let (sender, opened) = std::sync::mpsc::channel();
    thread::spawn(move || {
        let opened = Recording::open(&path).map(|_| ());
        sender.send(opened.map_err(|error| error.to_string()))
    });
    let minute = std::time::Duration::from_mins(1);
    let opened = opened.recv_timeout(minute);
    let error = opened.expect("opening a pipe takes no time").unwrap_err();
    assert!(
        error.starts_with("it is a pipe or a device, not a file"),
        "{error}"
    );
}

/// What is missing of a run is no difference to it, and counts of the rest are not those of the run.
#[test]
fn gaps_make_no_findings() {
    let folder = Folder::new();
    let drop = scenario("drop", &[("sampling.period", "0.0005")]);
    archive(&folder.at("whole.mcap"), &drop, &[], Form::default()).unwrap();
    let whole = folder.read("whole.mcap");
    let original = Recording::open(&folder.at("whole.mcap")).unwrap();
    let chunks = chunks(&whole);
    assert!(chunks.len() > 9);
    let last = chunks.last().unwrap();
    for hit in [&chunks[0], &chunks[2], &chunks[5], last] {
        let mut bytes = whole.clone();
        bytes[hit.clone()].fill(0);
        let hole = Recording::open(&folder.write("hole.mcap", bytes)).unwrap();
        let story = explain(&hole).unwrap();
        assert!(!story.losses.is_empty());
        let facts = story.chapters.iter().flat_map(|chapter| &chapter.facts);
        for fact in facts {
            let counts = matches!(fact, Fact::Hops { .. } | Fact::Impacts { .. });
            // Nothing is reported after the last sample.
            assert!(!counts || hit == last, "{hit:?}: {fact:?}");
        }
        let options = Options {
            integration_error: false,
            ..Options::default()
        };
        for pair in [[&hole, &original], [&original, &hole]] {
            let report = compare(pair[0], pair[1], &options).unwrap();
            for finding in report.findings {
                assert!(!finding.differs(), "{hit:?}: {finding:?}");
            }
        }
    }
}
