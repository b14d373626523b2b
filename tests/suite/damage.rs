//! Damaged recordings: all damage is detected, nothing panics, and the run can be repeated.

use crate::fuzz_corpus::steps::analyses;
use crate::support::{archive, is_noticed, run_again, scenario, verified};
use std::fs;
use std::io::Read as _;
use std::path::Path;
use std::thread;
use toprise::analysis::explain::explain;
use toprise::analysis::figures::{Figure, Run};
use toprise::analysis::verify::Verdict;
use toprise::archive::recording::{Condition, Overview, Recording, Selection};
use toprise::archive::writer::Form;
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
fn in_parallel<T: Sync>(cases: &[T], check: impl Fn(&Path, &T) + Sync) {
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

fn recorded(duration: &str, topics: &[&str], form: Form) -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let scenario = scenario("paper", &[("stop.duration", duration)]);
    archive(&path, &scenario, topics, form).unwrap();
    fs::read(&path).unwrap()
}

#[test]
fn every_byte_of_a_tiny_recording_counts() {
    let form = Form {
        views: false,
        ..Form::default()
    };
    let whole = recorded("0.002", &["/events"], form);
    let positions: Vec<usize> = (0..whole.len()).collect();
    in_parallel(&positions, |path, position| {
        for mask in [0x01, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[*position] ^= mask;
            fs::write(path, bytes).unwrap();
            assert!(is_noticed(path), "byte {position} xor {mask:#x}");
        }
        endures(path);
    });
}

#[test]
fn flipped_bits_are_noticed_all_over_a_recording() {
    for encoding in Encoding::ALL {
        let form = Form {
            encoding,
            views: true,
        };
        let whole = recorded("0.08", &[], form);
        let positions: Vec<usize> = (0..1000).map(|i| i * whole.len() / 1000).collect();
        in_parallel(&positions, |path, position| {
            let mut bytes = whole.clone();
            bytes[*position] ^= 1 << (position % 8);
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
fn a_recording_may_end_anywhere() {
    let whole = recorded("0.1", &[], Form::default());
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
fn chunks_that_were_swapped_or_repeated_are_noticed() {
    let whole = recorded("0.5", &[], Form::default());
    let chunks = chunks(&whole);
    assert!(chunks.len() > 4);
    let (first, second) = (chunks[1].clone(), chunks[2].clone());
    let parts = |order: [std::ops::Range<usize>; 2]| {
        let mut bytes = whole[..first.start].to_vec();
        for part in order {
            bytes.extend_from_slice(&whole[part]);
        }
        bytes.extend_from_slice(&whole[second.end..]);
        bytes
    };
    let changed = [
        parts([second.clone(), first.clone()]),
        parts([first.clone(), first.clone()]),
        parts([first.clone(), 0..0]),
    ];
    in_parallel(&changed, |path, bytes| {
        fs::write(path, bytes).unwrap();
        assert!(is_noticed(path));
        endures(path);
        analyses(&Recording::open(path).unwrap());
    });
}

#[test]
fn messages_that_come_twice_are_left_out_and_told() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let whole = recorded("0.5", &[], Form::default());
    let first = chunks(&whole)[1].clone();
    let mut bytes = whole[..first.end].to_vec();
    bytes.extend_from_slice(&whole[first.start..]);
    fs::write(&path, &bytes).unwrap();
    let recording = Recording::open(&path).unwrap();
    let figure = Figure::find("figure-2").unwrap();
    let run = Run::read(&recording, "run", &[figure], &|_| {});
    let story = explain(&recording).unwrap();
    for losses in [&run.losses, &story.losses] {
        assert!(
            losses
                .iter()
                .any(|loss| loss.contains("messages that repeat others or go back in time")),
            "{losses:?}"
        );
    }
    // Sorted and without the repetition it is the run that was recorded.
    let original = directory.path().join("original.mcap");
    fs::write(&original, &whole).unwrap();
    let original = Recording::open(&original).unwrap();
    let sound = Run::read(&original, "run", &[figure], &|_| {});
    assert_eq!(sound.losses, Vec::<String>::new());
    assert_eq!(
        figure.draw(&[&run], 85.0).svg(),
        figure.draw(&[&sound], 85.0).svg()
    );
    analyses(&recording);
}

/// Where the chunks with their indexes lie, by another reader.
pub fn chunks(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
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
fn a_damaged_recording_is_read_past_its_damage_and_run_again_to_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let scenario = scenario("paper", &[("stop.duration", "0.5")]);
    for (encoding, topics) in [
        (Encoding::Json, &[][..]),
        (Encoding::Protobuf, &["/top/state", "/top/energy"]),
    ] {
        let _ = fs::remove_file(&path);
        let form = Form {
            encoding,
            ..Form::default()
        };
        archive(&path, &scenario, topics, form).unwrap();
        let whole = fs::read(&path).unwrap();
        let hit = chunks(&whole).pop().unwrap();
        let mut bytes = whole.clone();
        bytes[usize::midpoint(hit.start, hit.end)] ^= 1;
        fs::write(&path, bytes).unwrap();
        let recording = Recording::open(&path).unwrap();
        let overview = Overview::of(&recording);
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
fn a_recording_that_ends_before_its_scenario_can_not_be_run_again() {
    let whole = recorded("0.02", &[], Form::default());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cut.mcap");
    let first_chunk = chunks(&whole)[0].start;
    // Each record is an opcode, the length of its body, and the body; the header stands behind the magic.
    let mut ends = vec![8];
    while let Some(end) = ends.last().filter(|end| **end < first_chunk) {
        let length = whole[end + 1..end + 9].try_into().unwrap();
        ends.push(end + 9 + u64::from_le_bytes(length) as usize);
    }
    // The header, toprise.run and the scenario.
    let runs: Vec<_> = ends[1..]
        .iter()
        .map(|end| {
            fs::write(&path, &whole[..*end]).unwrap();
            assert!(is_noticed(&path), "{end}");
            run_again(&path).map(|bytes| bytes == whole)
        })
        .collect();
    assert_eq!(runs, [None, None, Some(true)]);
}

#[test]
fn damage_outside_of_chunks_costs_no_messages() {
    let whole = recorded("0.5", &[], Form::default());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let changed = |at: usize, mask: u8| {
        let mut bytes = whole.clone();
        bytes[at] ^= mask;
        fs::write(&path, bytes).unwrap();
        assert!(is_noticed(&path), "byte {at}");
        assert_eq!(verified(&path).missing, 0, "byte {at}");
    };
    // The times in the head of a chunk: it seems to stand at the wrong place.
    for chunk in chunks(&whole) {
        for byte in [9, 13, 17, 21] {
            changed(chunk.start + byte, 0x10);
        }
    }
    // A length that swallows what comes behind: of the header, and of the end of the data.
    changed(8 + 1, 0x40);
    let summary = mcap::read::footer(&whole).unwrap().summary_start as usize;
    let data_end = summary - 13;
    assert_eq!(whole[data_end], mcap::records::op::DATA_END);
    for (byte, mask) in [(1, 0x40), (2, 0x01), (2, 0x04)] {
        changed(data_end + byte, mask);
    }
    // The summary.
    for at in (summary + 9..whole.len() - 40).step_by(151) {
        changed(at, 1);
    }
}

#[test]
fn what_stands_behind_the_footer_is_noticed() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let whole = recorded("0.1", &[], Form::default());
    let end = whole.len() - mcap::MAGIC.len();
    let mut bytes = whole[..end].to_vec();
    bytes.extend_from_slice(&[0x85, 5, 0, 0, 0, 0, 0, 0, 0]);
    bytes.extend_from_slice(b"hello");
    bytes.extend_from_slice(&whole[end..]);
    fs::write(&path, bytes).unwrap();
    assert!(is_noticed(&path));
}

#[test]
fn a_recording_whose_index_is_lost_loses_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let whole = recorded("0.3", &[], Form::default());
    // The end magic and a part of the footer.
    fs::write(&path, &whole[..whole.len() - 20]).unwrap();
    let report = verified(&path);
    assert_eq!(report.state, Condition::Damaged);
    assert_eq!((report.verdict, report.missing), (Verdict::Incomplete, 0));
    assert_eq!(
        report.equal,
        Some(Overview::read(&path).unwrap().messages())
    );
    assert!(run_again(&path).unwrap() == whole);
}

#[test]
fn the_scenario_of_another_run_is_not_taken_for_its_own() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let whole = |k: &str| {
        let name = format!("{k}.mcap");
        let scenario = scenario("paper", &[("stop.duration", "0.3"), ("friction.k", k)]);
        archive(&path(&name), &scenario, &[], Form::default()).unwrap();
        fs::read(path(&name)).unwrap()
    };
    let (a, b) = (whole("0.03"), whole("0.02"));
    // The metadata and the scenario of one run, something unreadable, and all messages and the end of the other.
    let (head, rest) = (&a[..chunks(&a)[0].start], &b[chunks(&b)[0].start..]);
    let spliced = [head, &[0xee; 40], rest].concat();
    fs::write(path("spliced.mcap"), spliced).unwrap();
    let report = verified(&path("spliced.mcap"));
    assert_eq!(report.verdict, Verdict::Different, "{report:#?}");
}

#[test]
fn every_byte_of_the_record_of_the_run_counts_in_an_interrupted_recording() {
    let whole = recorded("0.01", &[], Form::default());
    let interrupted = &whole[..chunks(&whole).last().unwrap().end];
    let name = interrupted
        .windows(11)
        .position(|bytes| bytes == b"toprise.run");
    // Opcode and length of the record, and the length of its name, stand before.
    let start = name.unwrap() - 13;
    let length = u64::from_le_bytes(whole[start + 1..start + 9].try_into().unwrap());
    let positions: Vec<usize> = (start..start + 9 + length as usize).collect();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("interrupted.mcap");
    fs::write(&path, interrupted).unwrap();
    let sound = verified(&path);
    in_parallel(&positions, |path, position| {
        let mut bytes = interrupted.to_vec();
        bytes[*position] ^= 1 << (position % 8);
        fs::write(path, bytes).unwrap();
        assert_ne!(verified(path), sound, "byte {position}");
    });
}

#[test]
fn a_recording_that_ends_in_its_summary_is_incomplete() {
    let whole = recorded("0.1", &[], Form::default());
    let summary = mcap::read::footer(&whole).unwrap().summary_start as usize;
    let lengths: Vec<usize> = (summary..whole.len()).step_by(29).collect();
    in_parallel(&lengths, |path, length| {
        fs::write(path, &whole[..*length]).unwrap();
        let report = verified(path);
        assert_eq!(
            report.verdict,
            Verdict::Incomplete,
            "{length} bytes: {report:?}"
        );
    });
}

#[test]
fn an_empty_summary_offset_beside_that_of_the_group_is_refused() {
    let mut bytes = recorded("0.1", &[], Form::default());
    let summary = mcap::read::footer(&bytes).unwrap().summary_start as usize;
    let footer = bytes.len() - mcap::MAGIC.len() - 29;
    assert_eq!(bytes[footer], mcap::records::op::FOOTER);
    // A reader that believes it finds no attachments.
    let mut group = vec![mcap::records::op::ATTACHMENT_INDEX];
    group.extend_from_slice(&(summary as u64).to_le_bytes());
    group.extend_from_slice(&0_u64.to_le_bytes());
    let offset = record(mcap::records::op::SUMMARY_OFFSET, &group);
    bytes.splice(footer..footer, offset.iter().copied());
    let sum_at = footer + offset.len() + 25;
    let sum = crc32fast::hash(&bytes[summary..sum_at]);
    bytes[sum_at..sum_at + 4].copy_from_slice(&sum.to_le_bytes());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    fs::write(&path, bytes).unwrap();
    let difference = verified(&path).difference.unwrap();
    assert_eq!(difference.place, "the groups of the summary");
}

/// A record of an MCAP file.
fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    let mut record = vec![opcode];
    record.extend_from_slice(&(body.len() as u64).to_le_bytes());
    record.extend_from_slice(body);
    record
}

#[test]
fn a_chunk_of_compressed_zeros_is_not_read_to_its_end() {
    let size = 1 << 26;
    let zeros = zstd::encode_all(std::io::repeat(0).take(size), 1).unwrap();
    let mut chunk = vec![0; 16];
    chunk.extend_from_slice(&size.to_le_bytes());
    chunk.extend_from_slice(&0_u32.to_le_bytes());
    chunk.extend_from_slice(&4_u32.to_le_bytes());
    chunk.extend_from_slice(b"zstd");
    chunk.extend_from_slice(&(zeros.len() as u64).to_le_bytes());
    chunk.extend_from_slice(&zeros);
    let mut bytes = mcap::MAGIC.to_vec();
    bytes.extend(record(mcap::records::op::HEADER, &[0; 8]));
    bytes.extend(record(mcap::records::op::CHUNK, &chunk));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("zeros.mcap");
    fs::write(&path, bytes).unwrap();
    let overview = Overview::read(&path).unwrap();
    let losses: Vec<_> = overview.losses.iter().map(ToString::to_string).collect();
    assert!(
        losses
            .iter()
            .any(|loss| loss.contains("at byte 0 of the chunk")),
        "{losses:?}"
    );
}

#[cfg(unix)]
#[test]
fn a_pipe_is_refused_and_not_waited_for() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("pipe.mcap");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.unwrap().success());
    let (told, opened) = std::sync::mpsc::channel();
    thread::spawn(move || {
        told.send(
            Recording::open(&path)
                .map(|_| ())
                .map_err(|e| e.to_string()),
        )
    });
    let minute = std::time::Duration::from_mins(1);
    let opened = opened
        .recv_timeout(minute)
        .expect("opening a pipe takes no time");
    assert_eq!(
        opened,
        Err("it is a pipe or device, not an MCAP file".to_owned())
    );
}
