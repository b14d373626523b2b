//! Files that other software wrote or rewrote: any order of messages, newer formats, files that are not whole.

use crate::forgeries::forgery::{Forgery, RUN, Record, edit, named};
use crate::raw::{
    PADDING, attachment, channel, chunk, file, header, message, record, schema, statistics,
    with_summary,
};
use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use mcap::records::{Channel, op};
use std::cmp::Reverse;
use std::fs;
use std::path::{Path, PathBuf};
use toprise::analysis::diff::{Options, compare};
use toprise::analysis::explain::explain;
use toprise::archive::recording::{Condition, Overview, Recording, RecordingError, Selection};
use toprise::archive::verify::{Equality, Verdict, verify};
use toprise::archive::writer::Form;
use toprise::figures::{Figure, RunData};
use toprise::telemetry::Topics;

/// A Unix time, ns.
const START: u64 = 1_659_409_666_000_000_000;

/// Eleven messages in a second, and the channel before them.
fn eleven() -> Vec<u8> {
    let messages = (0..11).map(|n| message(1, n, START + u64::from(n) * 100_000_000, b"{\"x\":1}"));
    [record(op::CHANNEL, &channel(1, "/a"))]
        .into_iter()
        .chain(messages)
        .collect::<Vec<_>>()
        .concat()
}

fn times() -> (u64, u64) {
    (START, START + 1_000_000_000)
}

fn chunk_body(compression: &str) -> Vec<u8> {
    chunk(times(), compression, &eleven())
}

fn other() -> Vec<u8> {
    header("other")
}

/// The file without its last records from an opcode on, and without the end magic.
fn cut_before(bytes: &[u8], opcode: u8) -> Vec<u8> {
    let mut at = mcap::MAGIC.len();
    while bytes[at] != opcode {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        at += 9 + length as usize;
    }
    bytes[..at].to_vec()
}

#[test]
fn skips_future_records() {
    let padded = |compression| [&chunk_body(compression)[..], &PADDING].concat();
    let hidden = record(op::CHUNK, &chunk_body(""));
    let in_chunk = |opcode| {
        chunk(
            times(),
            "zstd",
            &[eleven(), record(opcode, b"more")].concat(),
        )
    };
    let chunk_record = record(op::CHUNK, &chunk_body("zstd"));
    let padded_header = record(op::HEADER, &[&other()[9..], &PADDING].concat());
    let padded_attachment = [&attachment("notes", b"text")[..], &PADDING].concat();
    let cases: [(&str, Vec<u8>); 10] = [
        ("nothing", chunk_record.clone()),
        ("padded chunk", record(op::CHUNK, &padded(""))),
        ("padded zstd chunk", record(op::CHUNK, &padded("zstd"))),
        (
            "reserved record",
            [record(0x10, b"later"), chunk_record.clone()].concat(),
        ),
        (
            "private record",
            [record(0x80, b"mine"), chunk_record.clone()].concat(),
        ),
        (
            "chunk in a reserved record",
            [record(0x10, &hidden), chunk_record.clone()].concat(),
        ),
        (
            "chunk in a private record",
            [record(0xfe, &hidden), chunk_record.clone()].concat(),
        ),
        (
            "reserved record in a chunk",
            record(op::CHUNK, &in_chunk(0x7f)),
        ),
        (
            "private record in a chunk",
            record(op::CHUNK, &in_chunk(0xff)),
        ),
        (
            "padded attachment",
            [record(op::ATTACHMENT, &padded_attachment), chunk_record].concat(),
        ),
    ];
    let folder = Folder::new();
    for (name, records) in &cases {
        for head in [&other(), &padded_header] {
            let path = folder.write("a.mcap", file(&[head, records]));
            let overview = Overview::read(&path).unwrap();
            assert_eq!(overview.losses, [], "{name}");
            assert_eq!(overview.condition, Condition::Foreign, "{name}");
            assert_eq!(overview.messages(), 11, "{name}");
        }
    }
}

/// An unknown record may be a known one whose opcode is damaged: the checksum of the data decides.
#[test]
fn reports_records_whose_opcode_is_damaged() {
    let folder = Folder::new();
    let mut bytes = file(&[&other(), &record(op::CHUNK, &chunk_body("zstd"))]);
    let chunk = mcap::MAGIC.len() + other().len();
    bytes[chunk] ^= 0x10;
    let overview = Overview::read(&folder.write("a.mcap", bytes)).unwrap();
    assert_eq!(overview.condition, Condition::Damaged);
    assert_contains(&overview.losses[0].reason, "unknown opcode 0x16");
}

#[test]
fn classifies_foreign_files() {
    let chunk = record(op::CHUNK, &chunk_body("zstd"));
    let whole = file(&[&other(), &chunk]);
    let attached = |is_damaged| {
        let mut body = attachment("notes", b"text");
        let at = body.len() - 6;
        body[at] ^= u8::from(is_damaged);
        file(&[&other(), &record(op::ATTACHMENT, &body), &chunk])
    };
    let in_record = whole[..whole.len() - 50].to_vec();
    let mut flipped = whole.clone();
    flipped[20] ^= 1;
    let cases = [
        ("whole", whole.clone(), Condition::Foreign, 0),
        (
            "cut before the end of the data",
            cut_before(&whole, op::DATA_END),
            Condition::Interrupted,
            3,
        ),
        (
            "cut before the footer",
            cut_before(&whole, op::FOOTER),
            Condition::Interrupted,
            3,
        ),
        ("cut in a record", in_record, Condition::Interrupted, 3),
        ("attachment", attached(false), Condition::Foreign, 0),
        (
            "attachment with a wrong checksum",
            attached(true),
            Condition::Damaged,
            3,
        ),
        ("a bit of the header", flipped, Condition::Damaged, 3),
    ];
    let folder = Folder::new();
    for (name, bytes, condition, code) in cases {
        let path = folder.write("a.mcap", bytes);
        let overview = Overview::read(&path).unwrap();
        assert_eq!(
            overview.condition, condition,
            "{name}: {:?}",
            overview.losses
        );
        let printed = folder.toprise("info a.mcap", code);
        assert_contains(&printed.stdout, condition.name());
    }
}

#[test]
fn computes_span_and_rate_from_extreme_times() {
    let folder = Folder::new();
    let chunk_record = record(op::CHUNK, &chunk_body("zstd"));
    folder.write("a.mcap", file(&[&other(), &chunk_record]));
    let printed = folder.toprise("info a.mcap", 0).stdout;
    let line = |name: &str| {
        let found = printed
            .lines()
            .find(|line| line.trim_start().starts_with(name));
        found
            .unwrap_or_else(|| panic!("no {name} in\n{printed}"))
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    assert_eq!(line("span"), "span 1 s");
    assert_contains(&line("/a"), "10.0 Hz");
    // A message at time 0 that comes last.
    let late = record(op::CHUNK, &chunk((0, 0), "", &message(1, 11, 0, b"{}")));
    let path = folder.write("late.mcap", file(&[&other(), &chunk_record, &late]));
    let overview = Overview::read(&path).unwrap();
    assert_eq!((overview.first_ns(), overview.last_ns()), (0, times().1));
    let channel = &overview.channels[0];
    assert_eq!((channel.first_ns, channel.last_ns), (0, times().1));
    // Ten intervals' worth of messages in the whole span.
    let rate = 11.0 * 1e9 / times().1 as f64;
    assert!((channel.rate_hz.unwrap() - rate).abs() <= f64::EPSILON * rate);
}

/// A short run, and the same with a chunk for each topic, as `mcap sort --order topic` writes it.
fn by_topic(form: Form) -> (Vec<u8>, Vec<u8>) {
    let scenario = scenario(
        "paper",
        &[("stop.duration", "0.6"), ("sampling.period", "0.002")],
    );
    let original = recorded(&scenario, &[], form);
    let mut file = Forgery::of(&original);
    let is_chunk = |record: &Record| matches!(record, Record::Chunk(_));
    let first = file.records.iter().position(is_chunk).unwrap();
    let mut content = Vec::new();
    file.records.retain_mut(|record| match record {
        Record::Chunk(records) => {
            content.append(records);
            false
        }
        _ => true,
    });
    let mut ids = Vec::new();
    for record in &content {
        if let Record::Channel(Channel { id, .. }) = record {
            ids.push(*id);
        }
    }
    let definitions = content
        .iter()
        .filter(|r| matches!(r, Record::Schema(..) | Record::Channel(_)));
    let mut chunks = vec![Record::Chunk(definitions.cloned().collect())];
    // The last topic first, so that nothing is in order by chance.
    for id in ids.into_iter().rev() {
        let of_topic = |r: &&Record| matches!(r, Record::Message(m, _) if m.channel_id == id);
        chunks.push(Record::Chunk(
            content.iter().filter(of_topic).cloned().collect(),
        ));
    }
    file.records.splice(first..first, chunks);
    (original, file.bytes())
}

fn open(path: &Path) -> Recording {
    Recording::open(path).unwrap()
}

#[test]
fn reads_recordings_sorted_by_topic() {
    let folder = Folder::new();
    let (original, sorted) = by_topic(Form::default());
    let original = open(&folder.write("run.mcap", original));
    let path = folder.write("sorted.mcap", sorted);
    let sorted = open(&path);
    let report = verified(&path);
    assert_eq!(
        report.equality,
        Some(Equality::PackedOtherwise),
        "{report:#?}"
    );
    assert_eq!(report.equal, Some(Overview::new(&original).messages()));
    let stories = [&original, &sorted].map(|recording| {
        let mut story = explain(recording).unwrap();
        story.title.clear();
        format!("{story:?}").replace("sorted", "run")
    });
    assert_eq!(stories[0], stories[1]);
    let figure = Figure::find("figure-2").unwrap();
    let drawn = [&original, &sorted].map(|recording| {
        let run = RunData::read(recording, "run", &[figure], &|_| {});
        assert_eq!(run.losses, Vec::<String>::new());
        figure.draw(&[&run], 85.0).svg()
    });
    assert!(drawn[0] == drawn[1]);
    folder.toprise("diff run.mcap sorted.mcap --no-integration-error", 0);
}

#[test]
fn reads_topics_and_times_of_sorted_files_in_order() {
    let folder = Folder::new();
    let (original, sorted) = by_topic(Form::default());
    let read = |path: PathBuf, topics: &[&str]| {
        let recording = open(&path);
        let topics = topics.iter().map(|topic| (*topic).to_owned()).collect();
        let selection = Selection {
            topics: Topics::Only(topics),
            from_ns: Some(100_000_000),
            to_ns: Some(300_000_000),
        };
        let mut reader = recording.reader(selection).in_order_of_time();
        let mut found = Vec::new();
        while let Some(message) = reader.next_undecoded() {
            found.push((
                message.log_time,
                message.channel.topic.clone(),
                message.sequence,
            ));
        }
        found
    };
    let topics = ["/top/energy", "/events"];
    let mut expected = read(folder.write("run.mcap", original), &topics);
    let found = read(folder.write("sorted.mcap", sorted), &topics);
    assert!(found.is_sorted_by_key(|message| message.0));
    expected.sort();
    let mut sorted = found;
    sorted.sort();
    assert_eq!(sorted, expected);
    assert!(sorted.len() > 100);
}

#[test]
fn finds_one_changed_number_in_sorted_files() {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let mut file = Forgery::of(&recorded(&scenario, &[], Form::default()));
    file.edit("/top/state", 7, |text| {
        text.replacen("\"theta\":0.", "\"theta\":0.1", 1)
    });
    let folder = Folder::new();
    let report = verified(&folder.write("a.mcap", file.bytes()));
    assert_eq!((report.verdict, report.missing), (Verdict::Different, 0));
}

#[test]
fn damaged_scenario_is_damage() {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let mut bytes = recorded(&scenario, &[], Form::default());
    let name = b"name = \"paper\"";
    let at = bytes
        .windows(name.len())
        .position(|found| found == name)
        .unwrap();
    bytes[at + 8] ^= 1;
    let folder = Folder::new();
    let report = verified(&folder.write("a.mcap", bytes));
    assert_eq!(
        (report.verdict, report.state),
        (Verdict::Incomplete, Condition::Damaged)
    );
    assert_contains(
        &report.losses[0].reason,
        "\"scenario.toml\" has a wrong checksum",
    );
    for line in [
        "info a.mcap",
        "verify a.mcap",
        "diff a.mcap a.mcap --no-integration-error",
    ] {
        let printed = folder.toprise(line, 3);
        assert_contains(&printed.stdout, "wrong checksum");
    }
}

#[test]
fn verify_refuses_foreign_files() {
    let folder = Folder::new();
    let chunk = record(op::CHUNK, &chunk_body(""));
    let path = folder.write("a.mcap", file(&[&other(), &chunk]));
    assert!(verify(&open(&path), &|_| {}).is_err());
    let printed = folder.toprise("verify a.mcap", 2);
    assert_contains(&printed.stderr, "no scenario in it");
}

#[test]
fn refuses_merged_runs() {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let mut file = Forgery::of(&recorded(&scenario, &[], Form::default()));
    let run = file
        .records
        .iter()
        .find(|record| named(RUN)(record))
        .unwrap()
        .clone();
    let mut other = run.clone();
    let Record::Metadata(metadata) = &mut other else {
        panic!("named {RUN}");
    };
    metadata.metadata.insert("scenario".into(), "other".into());
    let folder = Folder::new();
    // An equal record is a repetition.
    file.records.push(run);
    Recording::open(&folder.write("a.mcap", file.bytes())).unwrap();
    file.records.push(other);
    let path = folder.write("a.mcap", file.bytes());
    let error = Recording::open(&path).unwrap_err();
    assert!(matches!(error, RecordingError::MergedRuns(2)), "{error}");
    let printed = folder.toprise("info a.mcap", 2);
    assert_contains(&printed.stderr, "it holds 2 runs");
}

/// What belongs to a sample is found whichever topic another writer puts first, also if a chunk ends within the sample.
#[test]
fn explanations_ignore_order_of_topics() {
    let scenario = scenario("paper", &[("stop.duration", "0.6")]);
    let original = recorded(&scenario, &[], Form::default());
    let folder = Folder::new();
    let explanation = |name: &str, bytes: &[u8]| {
        let path = folder.write(format!("{name}.mcap"), bytes);
        let explanation = explain(&open(&path)).unwrap();
        (explanation.story, explanation.chapters, explanation.losses)
    };
    let expected = explanation("original", &original);
    assert!(!expected.0.claims.is_empty());
    let reversed = |records: &mut Vec<Record>| {
        records.sort_by_key(|record| match record {
            Record::Message(message, _) => Some((message.log_time, Reverse(message.channel_id))),
            _ => None,
        });
    };
    let mut forgery = Forgery::of(&original);
    let mut all = Vec::new();
    forgery.records.retain(|record| match record {
        Record::Chunk(chunk) => {
            all.extend(chunk.iter().cloned());
            false
        }
        _ => true,
    });
    reversed(&mut all);
    for messages in [all.len(), 1000, 7] {
        let mut packed = forgery.clone();
        for (at, chunk) in all.chunks(messages).enumerate() {
            // After the record of the run.
            packed.records.insert(1 + at, Record::Chunk(chunk.to_vec()));
        }
        let found = explanation("reversed", &packed.bytes());
        assert_eq!(found, expected, "{messages} messages in a chunk");
    }
}

/// Chunks that all span the whole time, and loose messages between them, are read in order of time.
#[test]
fn sorts_overlapping_chunks() {
    let messages: Vec<_> = (0..1000_u64).map(|n| (n * 7919 % 500, n as u32)).collect();
    let mut records = vec![other(), record(op::CHANNEL, &channel(1, "/a"))];
    for (index, part) in messages.chunks(100).enumerate() {
        let part = part.iter().map(|(time, n)| message(1, *n, *time, b"{}"));
        let content = part.collect::<Vec<_>>().concat();
        records.push(match index % 3 {
            0 => content,
            _ => record(op::CHUNK, &chunk((0, 499), "zstd", &content)),
        });
    }
    let records: Vec<&[u8]> = records.iter().map(Vec::as_slice).collect();
    let folder = Folder::new();
    let recording = open(&folder.write("a.mcap", file(&records)));
    let mut reader = recording.reader(Selection::default()).in_order_of_time();
    let mut found = Vec::new();
    while let Some(message) = reader.next_undecoded() {
        found.push((message.log_time, message.sequence));
    }
    assert_eq!(reader.losses(), []);
    let mut expected = messages;
    // Messages of the same time keep the order of the file.
    expected.sort_by_key(|message| message.0);
    assert_eq!(found, expected);
    fs::remove_file(recording.path()).unwrap();
}

/// Damage by name, and a part of the reason with which every reader reports it.
#[test]
fn reports_contradictions_as_damage() {
    let definition = record(op::CHANNEL, &channel(1, "/a"));
    let other_definition = record(op::CHANNEL, &channel(1, "/b"));
    let [first, later] = [0, 1].map(|n| message(1, n, u64::from(n), b"{}"));
    let nested = record(op::CHUNK, &chunk((0, 0), "", b""));
    let whole = |records: &[&[u8]]| file(&[&[&other()[..]], records].concat());
    let redefined: [&[u8]; 4] = [&definition, &first, &other_definition, &later];
    let mut wrong_checksum = whole(&[&definition, &first, &later]);
    let at = wrong_checksum.len() - mcap::MAGIC.len() - 29 - 4;
    wrong_checksum[at] ^= 1;
    let mut late = whole(&[&definition, &first]);
    let at = late.len() - mcap::MAGIC.len() - 29;
    late.splice(at..at, later.iter().copied());
    let sound = whole(&[&definition, &first]);
    let trailing = [&sound[..], b"garbage that follows"].concat();
    let twice = [&sound[..], &sound].concat();
    let in_chunk = [&definition[..], &first, &nested, &later].concat();
    let undefined = message(2, 0, 0, b"{}");
    let too_long = record(op::CHUNK, &{
        let mut body = chunk((0, 0), "", &later);
        body[16..24].fill(0);
        body
    });
    let redefined_in_chunk = record(op::CHUNK, &chunk((0, 1), "zstd", &redefined.concat()));
    let cases = [
        (
            "redefined channel",
            whole(&redefined),
            1,
            "a second definition of channel 1",
        ),
        (
            "redefined in a chunk",
            whole(&[&redefined_in_chunk]),
            1,
            "a second definition of channel 1",
        ),
        (
            "wrong checksum",
            wrong_checksum,
            2,
            "the checksum of the data is wrong",
        ),
        (
            "late message",
            late,
            1,
            "a message after the end of the data",
        ),
        (
            "trailing bytes",
            trailing,
            1,
            "bytes after the end of the file",
        ),
        (
            "concatenated files",
            twice,
            1,
            "bytes after the end of the file",
        ),
        (
            "nested chunk",
            whole(&[&record(op::CHUNK, &chunk((0, 1), "zstd", &in_chunk))]),
            2,
            "a record with the opcode 0x06 in a chunk",
        ),
        (
            "other definition in the summary",
            with_summary(&[&other(), &definition, &first], &[&other_definition]),
            1,
            "in the summary, a second definition of channel 1",
        ),
        (
            "content longer than stated",
            whole(&[&definition, &first, &too_long]),
            1,
            "more content than the 0 bytes in its header",
        ),
        (
            "undefined channel",
            whole(&[&definition, &undefined, &later]),
            1,
            "undefined channel 2",
        ),
    ];
    let folder = Folder::new();
    for (name, bytes, messages, reason) in cases {
        let path = folder.write("a.mcap", bytes);
        let overview = Overview::read(&path).unwrap();
        assert_eq!(overview.condition, Condition::Damaged, "{name}");
        assert_eq!(overview.messages(), messages, "{name}");
        assert_contains(&overview.losses[0].reason, reason);
        // `diff`, which compares files of other software without their index.
        let recording = Recording::open(&path).unwrap();
        let report = compare(&recording, &recording, &Options::default()).unwrap();
        assert_contains(&report.a.losses[0], reason);
    }
}

/// What writers may leave out or add without damage, with the number of channels that a reader sees.
#[test]
fn accepts_omissions_and_additions_of_writers() {
    let data = eleven();
    let counts = [(1, 11)];
    let stated =
        |numbers, counts: &[_]| record(op::STATISTICS, &statistics(numbers, times(), counts));
    let padded = {
        // Two bytes after the last compressed frame, which the length of the data includes.
        let mut body = chunk_body("zstd");
        let at = 8 * 3 + 4 + 8;
        let length = u64::from_le_bytes(body[at..at + 8].try_into().unwrap()) + 2;
        body[at..at + 8].copy_from_slice(&length.to_le_bytes());
        body.extend([0; 2]);
        record(op::CHUNK, &body)
    };
    let empty = {
        let mut body = chunk((0, 0), "", b"");
        let zstd = crate::raw::text("zstd");
        body.splice(28..32, zstd);
        record(op::CHUNK, &body)
    };
    let silent = [
        record(op::SCHEMA, &schema(7, "Silent")),
        record(op::CHANNEL, &channel(2, "/silent")),
    ]
    .concat();
    let cases = [
        (
            "topic without messages, in the summary only",
            with_summary(
                &[&other(), &data],
                &[&silent, &stated([11, 1, 2, 0], &counts)],
            ),
            2,
        ),
        (
            "no messages by channel",
            with_summary(&[&other(), &data], &[&stated([11, 0, 1, 0], &[])]),
            1,
        ),
        (
            "schema with the id 0",
            with_summary(
                &[&other(), &record(op::SCHEMA, &schema(0, "Zero")), &data],
                &[&stated([11, 0, 1, 0], &counts)],
            ),
            1,
        ),
        (
            "padded frame",
            with_summary(&[&other(), &padded], &[&stated([11, 0, 1, 1], &counts)]),
            1,
        ),
        (
            "chunk of nothing",
            with_summary(
                &[&other(), &empty, &data],
                &[&stated([11, 0, 1, 1], &counts)],
            ),
            1,
        ),
    ];
    let folder = Folder::new();
    for (name, bytes, channels) in cases {
        let overview = Overview::read(&folder.write("a.mcap", bytes)).unwrap();
        assert_eq!(
            overview.condition,
            Condition::Foreign,
            "{name}: {overview:#?}"
        );
        assert_eq!(overview.messages(), 11, "{name}");
        assert_eq!(overview.channels.len(), channels, "{name}");
        assert!(
            overview.channels.iter().all(|c| c.schema.is_empty()),
            "{name}"
        );
    }
}

#[test]
fn finds_schemas_after_their_channels() {
    let mut late = channel(1, "/a");
    late[2] = 7;
    let definitions = [
        record(op::CHANNEL, &late),
        record(op::SCHEMA, &schema(7, "Late")),
    ];
    let bytes = file(&[&other(), &definitions.concat(), &message(1, 0, 0, b"{}")]);
    let folder = Folder::new();
    let overview = Overview::read(&folder.write("a.mcap", bytes)).unwrap();
    assert_eq!(overview.channels[0].schema, "Late");
}

#[test]
fn resumes_at_messages_outside_chunks() {
    let definition = record(op::CHANNEL, &channel(1, "/a"));
    let messages: Vec<_> = (0..100)
        .map(|n| message(1, n, u64::from(n), b"{\"x\":1}"))
        .collect();
    let length = messages[0].len();
    let mut bytes = file(&[&other(), &definition, &messages.concat()]);
    let start = mcap::MAGIC.len() + other().len() + definition.len();
    bytes[start + 40 * length..][..length].fill(0);
    let folder = Folder::new();
    let overview = Overview::read(&folder.write("a.mcap", bytes)).unwrap();
    assert_eq!(overview.condition, Condition::Damaged);
    assert_eq!(overview.messages(), 99);
    assert_eq!(overview.losses[0].length, length as u64);
}

#[test]
fn contradictory_summary_behind_a_footer_is_damage() {
    let [first, second] = ["/a", "/b"].map(|topic| record(op::CHANNEL, &channel(1, topic)));
    let footer = record(op::FOOTER, &[0; 20]);
    let end = record(op::DATA_END, &[0; 4]);
    let parts = [
        mcap::MAGIC,
        &other(),
        &first,
        &footer,
        &end,
        &second,
        mcap::MAGIC,
    ];
    let folder = Folder::new();
    let overview = Overview::read(&folder.write("a.mcap", parts.concat())).unwrap();
    assert_eq!(overview.condition, Condition::Damaged);
}

/// The times between which damage lies, with the times of the chunks before and after it.
#[test]
fn times_of_losses_never_run_backwards() {
    let definition = record(op::CHANNEL, &channel(1, "/a"));
    let at = |time_ns| {
        record(
            op::CHUNK,
            &chunk((time_ns, time_ns), "zstd", &message(1, 0, time_ns, b"{}")),
        )
    };
    let empty = record(op::CHUNK, &chunk((0, 0), "zstd", &definition));
    let mut damaged = at(5);
    damaged.fill(0);
    let folder = Folder::new();
    for (name, before, after, expected) in [
        ("in order", at(3), at(7), (Some(3), Some(7))),
        (
            "an empty chunk after it",
            at(3),
            [empty.clone(), at(7)].concat(),
            (Some(3), Some(7)),
        ),
        (
            "an empty chunk before it",
            [at(3), empty].concat(),
            at(7),
            (Some(3), Some(7)),
        ),
        ("not in order of time", at(7), at(3), (None, None)),
    ] {
        let bytes = file(&[&other(), &definition, &before, &damaged, &after]);
        let overview = Overview::read(&folder.write("a.mcap", bytes)).unwrap();
        let loss = &overview.losses[0];
        assert_eq!((loss.from_ns, loss.to_ns), expected, "{name}");
    }
}

#[test]
fn names_only_the_lost_record_outside_chunks() {
    let definition = record(op::CHANNEL, &channel(1, "/a"));
    let sound = message(1, 0, 0, b"{}");
    let lost = message(2, 0, 5, b"{}");
    let bytes = file(&[&other(), &definition, &sound, &lost, &lost, &sound]);
    let start = mcap::MAGIC.len() + other().len() + definition.len() + sound.len();
    let folder = Folder::new();
    let overview = Overview::read(&folder.write("a.mcap", bytes)).unwrap();
    assert_eq!(overview.losses.len(), 1);
    let loss = &overview.losses[0];
    assert_eq!(
        (loss.offset, loss.length),
        (start as u64, 2 * lost.len() as u64)
    );
    assert_eq!((loss.from_ns, loss.to_ns), (Some(5), Some(5)));
    assert_eq!(overview.messages(), 2);
}

#[test]
fn lists_at_most_1000_losses_and_counts_the_others() {
    let definition = record(op::CHANNEL, &channel(1, "/a"));
    // Alternating channels, so that the losses aren't merged.
    let messages: Vec<u8> = (0..3000_u16)
        .flat_map(|n| message(2 + n % 2, 0, 0, b""))
        .collect();
    let folder = Folder::new();
    let path = folder.write("a.mcap", file(&[&other(), &definition, &messages]));
    let overview = Overview::read(&path).unwrap();
    assert_eq!(
        (overview.losses.len(), overview.more_losses),
        (1000, Some(2000))
    );
}

#[test]
fn keeps_messages_without_sequence_numbers() {
    let whole = recorded(
        &scenario("paper", &[("stop.duration", "0.3")]),
        &[],
        Form::default(),
    );
    let mut forgery = Forgery::of(&whole);
    for topic in ["/events", "/top/state"] {
        forgery.messages(topic, |header, _| header.sequence = 0);
    }
    let folder = Folder::new();
    let path = folder.at("a.mcap");
    forgery.write(&path);
    let recording = Recording::open(&path).unwrap();
    let story = explain(&recording).unwrap();
    assert_eq!(story.losses, Vec::<String>::new());
    let original = Recording::open(&folder.write("b.mcap", &whole)).unwrap();
    assert_eq!(story.events, explain(&original).unwrap().events);
}

#[test]
fn reports_counts_that_contradict_the_end_record() {
    let whole = recorded(
        &scenario("paper", &[("stop.duration", "0.3")]),
        &[],
        Form::default(),
    );
    let mut forgery = Forgery::of(&whole);
    forgery.drop_messages(|header| header.log_time > 200_000_000);
    let folder = Folder::new();
    let path = folder.at("a.mcap");
    // Unlike `write`, without an end record that fits.
    fs::write(&path, forgery.bytes()).unwrap();
    let overview = Overview::read(&path).unwrap();
    assert_eq!(
        overview.condition,
        Condition::Altered,
        "{:?}",
        overview.faults
    );
    let printed = folder.toprise("info a.mcap", 3);
    assert_contains(&printed.stdout, "altered");
    assert_contains(&printed.stdout, "missing 100 of 301 samples");
}

#[test]
fn ignores_descriptions_of_another_version() {
    let folder = Folder::new();
    folder.toprise("run paper --set stop.duration=0.05 -o a.mcap", 0);
    let reworded = |library: &str| {
        let mut forgery = Forgery::of(&folder.read("a.mcap"));
        forgery.header.library = library.to_owned();
        forgery.schema("/top/energy", |_, data| {
            edit(data, |text| {
                text.replace("kinetic energy", "energy of the motion")
            });
        });
        forgery.write(&folder.at("b.mcap"));
    };
    reworded("toprise/99.0.0");
    let diff = folder.toprise("diff a.mcap b.mcap", 0).stdout;
    assert_contains(&diff, "All values identical; other parts differ");
    assert_contains(&diff, "channel /top/energy");
    // Within a version there is one text for a schema.
    reworded(&Forgery::of(&folder.read("a.mcap")).header.library);
    folder.toprise("diff a.mcap b.mcap", 1);
}
