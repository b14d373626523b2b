//! Recordings that other software changed within an intact file: all commands report the same.

use crate::forgeries::forgery::{END, Forgery, RUN, Record, named};
use crate::raw;
use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use mcap::records::op;
use std::rc::Rc;
use toprise::analysis::diff::{Options, compare};
use toprise::analysis::explain::explain;
use toprise::archive::recording::{Condition, Overview, Recording};
use toprise::archive::verify::{Equality, Verdict};
use toprise::archive::writer::Form;
use toprise::figures::{FIGURES, RunData};

/// The sentence about messages that are not those of the end record.
const ALTERED: &str = "altered messages: their digest is not the one in the end record";

/// A recording of 0.3 s that can be changed.
fn original() -> Forgery {
    let scenario = scenario("paper", &[("stop.duration", "0.3")]);
    Forgery::of(&recorded(&scenario, &[], Form::default()))
}

/// Leaves out a message of a topic.
fn drop_message(forgery: &mut Forgery, topic: &str, number: u32) {
    let (id, _) = forgery.id(topic);
    forgery.drop_messages(|message| message.channel_id == id && message.sequence == number);
}

/// Repeats the last chunk with messages.
fn repeat_chunk(forgery: &mut Forgery) {
    let is_chunk = |record: &Record| matches!(record, Record::Chunk(_));
    let at = forgery.records.iter().rposition(is_chunk).unwrap();
    let chunk = forgery.records[at].clone();
    forgery.records.insert(at, chunk);
}

/// Adds a later copy of the last message of a topic.
fn add_message(forgery: &mut Forgery, topic: &str) {
    let (id, _) = forgery.id(topic);
    let is_of =
        |record: &&Record| matches!(record, Record::Message(header, _) if header.channel_id == id);
    let mut added = forgery
        .records
        .iter()
        .filter_map(|record| match record {
            Record::Chunk(records) => records.iter().rfind(is_of).cloned(),
            _ => None,
        })
        .next_back()
        .unwrap();
    if let Record::Message(header, data) = &mut added {
        header.log_time += 1_000_000;
        header.publish_time = header.log_time;
        header.sequence += 1;
        let text = std::str::from_utf8(data).unwrap();
        // The message has its own time, of seconds and nanoseconds.
        *data = text.replace("300000000", "301000000").into_bytes();
    }
    forgery.last_chunk().push(added);
}

#[test]
fn commands_agree_on_changed_messages() {
    type Change = fn(&mut Forgery);
    let cases: [(&str, Change, Option<&str>, Verdict); 7] = [
        ("unchanged", |_| {}, None, Verdict::Verified),
        (
            "a sample less",
            |forgery| drop_message(forgery, "/top/energy", 7),
            Some("missing 1 of 301 samples of /top/energy"),
            Verdict::Incomplete,
        ),
        (
            "an event less",
            |forgery| drop_message(forgery, "/events", 2),
            Some("missing 1 of 14 events of /events"),
            Verdict::Incomplete,
        ),
        (
            "not JSON",
            |forgery| forgery.edit("/top/energy", 7, |_| "{".to_owned()),
            Some("1 message can't be decoded: /top/energy message 7 at 0.007 s"),
            Verdict::Different,
        ),
        (
            "another time",
            |forgery| forgery.edit("/top/energy", 7, |text| text.replace("7000000", "8000000")),
            Some("its timestamp, 8000000 ns, differs from its log time"),
            Verdict::Different,
        ),
        (
            "a chunk twice",
            repeat_chunk,
            Some("messages skipped"),
            Verdict::Different,
        ),
        (
            "a sample more",
            |forgery| add_message(forgery, "/top/energy"),
            Some("302 samples of /top/energy, but 301 in the end record"),
            Verdict::Different,
        ),
    ];
    let folder = Folder::new();
    for (name, change, fault, verdict) in cases {
        let mut forgery = original();
        change(&mut forgery);
        // With statistics and checksums that fit, so that only the messages show it.
        let path = folder.write("a.mcap", forgery.bytes());
        let recording = Recording::open(&path).unwrap();
        let overview = Overview::new(&recording);
        let condition = match fault {
            Some(_) => Condition::Altered,
            None => Condition::Whole,
        };
        assert_eq!(overview.condition, condition, "{name}");
        assert_eq!(overview.losses, [], "{name}");
        let options = Options {
            integration_error: false,
            ..Options::default()
        };
        let compared = compare(&recording, &recording, &options).unwrap();
        let explained = explain(&recording).unwrap();
        assert_eq!(overview.faults, explained.losses, "{name}");
        assert_eq!(overview.faults, compared.a.losses, "{name}");
        let drawn = RunData::read(&recording, "run", &[&FIGURES[0]], &|_| {});
        assert_eq!(overview.faults, drawn.losses, "{name}");
        let expected = Vec::from_iter(fault);
        assert_eq!(overview.faults.len(), expected.len(), "{name}");
        for (found, part) in overview.faults.iter().zip(expected) {
            assert_contains(found, part);
        }
        assert_eq!(verified(&path).verdict, verdict, "{name}");
        let printed = folder.toprise("info a.mcap", 3 * i32::from(fault.is_some()));
        assert_contains(&printed.stdout, condition.name());
    }
}

/// A channel that other software left out, with its number of samples or without: not every sample has a precession.
#[test]
fn commands_report_dropped_topics() {
    let folder = Folder::new();
    for (topic, fault) in [
        ("/top/pose", "missing 301 of 301 samples of /top/pose"),
        ("/top/precession", ALTERED),
    ] {
        let mut forgery = original();
        forgery.leave_out(topic);
        let path = folder.write("a.mcap", forgery.bytes());
        assert_reports_fault(&folder, fault);
        let report = verified(&path);
        assert_eq!(report.verdict, Verdict::Incomplete, "{topic}");
        assert_eq!(report.state, Condition::Altered, "{topic}");
        let printed = folder.toprise("verify a.mcap", 3);
        assert_contains(&printed.stdout, "altered");
    }
}

/// One byte, which no number of messages shows.
#[test]
fn commands_report_an_altered_value() {
    let mut forgery = original();
    forgery.pack("", <[u8]>::to_vec);
    forgery.edit("/top/energy", 7, |text| {
        text.replacen("\"kinetic\":1", "\"kinetic\":2", 1)
    });
    let folder = Folder::new();
    let path = folder.write("a.mcap", forgery.bytes());
    assert_reports_fault(&folder, ALTERED);
    assert_eq!(verified(&path).verdict, Verdict::Different);
}

/// The content digest without its sequence numbers, which other software may give anew, is that of the same data.
#[test]
fn renumbered_and_partial_recordings_are_complete() {
    let scenario = scenario("paper", &[("stop.duration", "0.3004")]);
    let folder = Folder::new();
    for topics in [&[][..], &["/top/precession", "/events"]] {
        let whole = recorded(&scenario, topics, Form::default());
        let mut forgery = Forgery::of(&whole);
        forgery.each(|record| {
            if let Record::Message(header, _) = record {
                header.sequence = header.sequence * 3 + 1;
            }
        });
        for bytes in [whole, forgery.bytes()] {
            let path = folder.write("a.mcap", bytes);
            let overview = Overview::read(&path).unwrap();
            assert_eq!(overview.faults, Vec::<String>::new(), "{topics:?}");
            assert_eq!(overview.condition, Condition::Whole, "{topics:?}");
        }
    }
}

/// Asserts that the commands that read `a.mcap` report a fault of it, and look for no causes.
fn assert_reports_fault(folder: &Folder, fault: &str) {
    let info = folder.toprise("info a.mcap", 3).stdout;
    assert_contains(&info, "altered");
    for command in [
        "info a.mcap",
        "explain a.mcap",
        "diff a.mcap a.mcap --no-integration-error",
    ] {
        assert_contains(&folder.toprise(command, 3).stdout, fault);
    }
    let recording = Recording::open(&folder.at("a.mcap")).unwrap();
    assert_eq!(explain(&recording).unwrap().story.claims.len(), 0);
    let options = Options {
        integration_error: false,
        ..Options::default()
    };
    let compared = compare(&recording, &recording, &options).unwrap();
    assert_eq!(compared.a.state, Some(Condition::Altered));
    assert!(!compared.is_complete);
}

/// Two publishers: each topic has two channels, which have every other message.
pub fn split_channels(forgery: &mut Forgery) {
    const OTHER: u16 = 1000;
    for record in &mut forgery.records {
        let Record::Chunk(records) = record else {
            continue;
        };
        let mut others = Vec::new();
        for record in records.iter_mut() {
            match record {
                Record::Channel(channel) => {
                    let mut other = channel.clone();
                    other.id += OTHER;
                    others.push(Record::Channel(other));
                }
                Record::Message(header, _) if header.sequence % 2 == 1 => {
                    header.channel_id += OTHER;
                }
                _ => {}
            }
        }
        // After the definitions of the first.
        let at = records
            .iter()
            .rposition(|record| matches!(record, Record::Channel(_)))
            .map_or(0, |last| last + 1);
        records.splice(at..at, others);
    }
}

fn repeat_records(forgery: &mut Forgery) {
    for name in [RUN, END] {
        let record = forgery.records.iter().find(|record| named(name)(record));
        let record = record.unwrap().clone();
        forgery.records.push(record);
    }
    forgery.attach(|_, _| {});
}

#[test]
fn reads_repackings_as_the_same_run() {
    type Change = fn(&mut Forgery);
    let cases: [(&str, Change, &[&str]); 3] = [
        ("two publishers", split_channels, &[]),
        (
            "repeated records",
            repeat_records,
            &["scenario.toml", "toprise.end", "toprise.run"],
        ),
        (
            "both",
            |forgery| {
                split_channels(forgery);
                repeat_records(forgery);
            },
            &["scenario.toml", "toprise.end", "toprise.run"],
        ),
    ];
    let folder = Folder::new();
    let original = Recording::open(&folder.write("run.mcap", original().bytes())).unwrap();
    let expected = explain(&original).unwrap();
    for (name, change, repeated) in cases {
        let mut forgery = self::original();
        change(&mut forgery);
        let path = folder.write("changed.mcap", forgery.bytes());
        let recording = Recording::open(&path).unwrap();
        let overview = Overview::new(&recording);
        assert_eq!(overview.condition, Condition::Whole, "{name}");
        assert_eq!(overview.messages(), Overview::new(&original).messages());
        let report = verified(&path);
        assert_eq!(
            report.equality,
            Some(Equality::PackedOtherwise),
            "{name}: {report:#?}"
        );
        assert_eq!(report.repeated, repeated, "{name}");
        let explained = explain(&recording).unwrap();
        assert_eq!(explained.story, expected.story, "{name}");
        assert_eq!(explained.losses, expected.losses, "{name}");
        let printed = folder.toprise("diff run.mcap changed.mcap --no-integration-error", 0);
        assert_contains(&printed.stdout, "All values identical");
    }
}

#[test]
fn finds_messages_repeated_by_another_publisher() {
    let mut forgery = original();
    let second = forgery.like("/top/energy", |channel| channel.id = 99);
    let (id, _) = forgery.id("/top/energy");
    let chunk = forgery.first_chunk();
    let is_seventh = |record: &&Record| matches!(record, Record::Message(header, _) if (header.channel_id, header.sequence) == (id, 7));
    let mut repeated = chunk.iter().find(is_seventh).unwrap().clone();
    if let Record::Message(header, _) = &mut repeated {
        header.channel_id = 99;
    }
    chunk.extend([second, repeated]);
    let folder = Folder::new();
    let path = folder.write("a.mcap", forgery.bytes());
    let recording = Recording::open(&path).unwrap();
    let expected = [
        "1 message skipped: repeated, or not later than the one before; the first in /top/energy at t = 0.007 s",
    ];
    assert_eq!(Overview::new(&recording).faults, expected);
    assert_eq!(explain(&recording).unwrap().losses, expected);
    assert_eq!(verified(&path).verdict, Verdict::Different);
}

/// `mcap sort` and `mcap filter` write a channel with its first message.
#[test]
fn verifies_without_empty_channels() {
    // It ends before the first nutation does.
    let scenario = scenario("paper", &[("stop.duration", "0.02")]);
    let mut forgery = Forgery::of(&recorded(&scenario, &[], Form::default()));
    forgery.leave_out("/top/nutation");
    let folder = Folder::new();
    let path = folder.write("a.mcap", forgery.bytes());
    let report = verified(&path);
    assert_eq!(
        report.equality,
        Some(Equality::PackedOtherwise),
        "{report:#?}"
    );
    assert_eq!(report.without, ["/top/nutation"]);
    assert_eq!(Overview::read(&path).unwrap().condition, Condition::Whole);
}

#[test]
fn wrong_data_checksum_keeps_all_messages() {
    let mut bytes = raw::file(&[
        &raw::header("other"),
        &raw::record(mcap::records::op::CHANNEL, &raw::channel(1, "/a")),
        &raw::message(1, 0, 0, &[b'1'; 2000]),
    ]);
    let at = bytes.len() - mcap::MAGIC.len() - 29 - 4;
    bytes[at] ^= 1;
    let folder = Folder::new();
    folder.write("a.mcap", bytes);
    let printed = folder.toprise("info a.mcap", 3).stdout;
    assert_contains(&printed, "the checksum of the data is wrong: 2,");
    assert!(!printed.contains("lost"), "{printed}");
    let printed = folder.toprise("diff a.mcap a.mcap", 3).stdout;
    assert_contains(&printed, "A: the checksum of the data is wrong: 2,");
}

#[test]
fn deeply_nested_json_differs_unless_bytes_are_equal() {
    let folder = Folder::new();
    for (name, space) in [("a.mcap", ""), ("b.mcap", " ")] {
        let data = format!("{}{space}{}", "[".repeat(200), "]".repeat(200));
        let bytes = raw::file(&[
            &raw::header("other"),
            &raw::record(mcap::records::op::CHANNEL, &raw::channel(1, "/a")),
            &raw::message(1, 0, 0, data.as_bytes()),
        ]);
        folder.write(name, bytes);
    }
    folder.toprise("diff a.mcap a.mcap", 0);
    folder.toprise("diff a.mcap b.mcap", 1);
}

#[test]
fn refuses_empty_names_of_topics() {
    let folder = Folder::new();
    for line in [
        "run paper --topics , -o a.mcap",
        "run paper --topics /events, -o a.mcap",
        "diff paper paper --topics ,",
    ] {
        let printed = folder.toprise(line, 2);
        assert_contains(&printed.stderr, "--topics");
    }
}

#[test]
fn one_fault_hides_no_other() {
    type Change = fn(&mut Forgery);
    let changes: [(&str, Change, &str); 2] = [
        ("repeated messages", repeat_chunk, "messages skipped"),
        (
            "an undecodable message",
            |forgery| forgery.edit("/top/energy", 9, |_| "{".to_owned()),
            "1 message can't be decoded",
        ),
    ];
    let folder = Folder::new();
    for (name, change, fault) in changes {
        let mut forgery = original();
        drop_message(&mut forgery, "/top/energy", 7);
        change(&mut forgery);
        let overview = Overview::read(&folder.write("a.mcap", forgery.bytes())).unwrap();
        for part in [fault, "missing 1 of 301 samples of /top/energy"] {
            assert!(
                overview.faults.iter().any(|found| found.contains(part)),
                "{name}: {:?}",
                overview.faults
            );
        }
    }
}

/// The definitions after the first chunk are not read when a recording of toprise is opened, if its summary has the others.
#[test]
fn notices_channels_that_only_a_later_chunk_defines() {
    let mut forgery = original();
    let hidden = forgery.another("/top/state", "/hidden");
    forgery.last_chunk().push(hidden);
    forgery.summary =
        Rc::new(|records| records.retain(|(opcode, body)| *opcode != op::CHANNEL || body[0] != 99));
    let folder = Folder::new();
    let path = folder.write("a.mcap", forgery.bytes());
    let overview = Overview::read(&path).unwrap();
    assert_eq!(overview.condition, Condition::Damaged);
    assert_contains(&overview.losses[0].reason, "a further definition");
    assert_ne!(verified(&path).verdict, Verdict::Verified);
}

#[test]
fn uncompressed_recording_cut_in_a_chunk_is_interrupted() {
    let whole = recorded(
        &scenario("paper", &[("stop.duration", "0.3")]),
        &[],
        Form::default(),
    );
    // Its chunks are not compressed.
    let bytes = Forgery::of(&whole).bytes();
    let folder = Folder::new();
    let overview = Overview::read(&folder.write("a.mcap", &bytes[..bytes.len() / 2])).unwrap();
    assert_eq!(overview.condition, Condition::Interrupted);
    assert_eq!(overview.losses.len(), 1);
}

/// A scenario, a run or an end that was replaced or left out, which no message shows.
#[test]
fn commands_report_altered_records() {
    type Change = fn(&mut Forgery);
    let cases: [(Change, &str); 6] = [
        (
            |forgery| {
                forgery.edit_scenario("\nk = 0.03", "\nk = 0.04");
            },
            "altered scenario",
        ),
        (
            |forgery| forgery.set(RUN, "scenario_digest", "0"),
            "altered scenario",
        ),
        (
            |forgery| forgery.drop(named(RUN)),
            "missing metadata record",
        ),
        (
            |forgery| {
                forgery.entries(END).remove("content_digest");
            },
            "it has no content digest",
        ),
        (
            |forgery| forgery.set(END, "stop_reason", "boredom"),
            "its reason",
        ),
        (
            |forgery| forgery.set(END, "stop_time", "0.1"),
            "at its time",
        ),
    ];
    let folder = Folder::new();
    for (change, fault) in cases {
        let mut forgery = original();
        change(&mut forgery);
        folder.write("a.mcap", forgery.bytes());
        assert_reports_fault(&folder, fault);
    }
}
