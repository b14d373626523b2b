//! What is wrong with a file is said, and nothing else is taken for it.

use crate::forgeries::forgery::{Forgery, Raw, Record};
use crate::raw::{self, attachment, channel, header, map, message, record, text};
use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use mcap::records::op;
use std::rc::Rc;
use toprise::archive::recording::{Condition, Overview, Recording};
use toprise::archive::verify::{Equality, Verdict};
use toprise::archive::writer::Form;

fn original() -> Vec<u8> {
    let scenario = scenario("paper", &[("stop.duration", "0.02")]);
    recorded(&scenario, &[], Form::default())
}

/// The records of a recording without chunks: opcode and body of each.
fn unchunked(bytes: &[u8]) -> Vec<Raw> {
    let forgery = Forgery::of(bytes);
    let mut records = vec![(op::HEADER, header("toprise/1.0.0")[9..].to_vec())];
    for record in &forgery.records {
        match record {
            Record::Chunk(inner) => records.extend(inner.iter().map(Record::raw)),
            other => records.push(other.raw()),
        }
    }
    records
}

/// A file of records that were changed after its checksum had been computed.
fn changed(mut records: Vec<Raw>, change: impl FnOnce(&mut Vec<Raw>)) -> Vec<u8> {
    let framed = |records: &[Raw]| -> Vec<Vec<u8>> {
        records
            .iter()
            .map(|(opcode, body)| record(*opcode, body))
            .collect()
    };
    let join =
        |records: &[Vec<u8>]| raw::file(&records.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let whole = join(&framed(&records));
    change(&mut records);
    let mut bytes = join(&framed(&records));
    // The checksum stands before the footer (29 bytes) and the last magic bytes.
    let at = |bytes: &[u8]| bytes.len() - mcap::MAGIC.len() - 29 - 4;
    let checksum = whole[at(&whole)..][..4].to_vec();
    let start = at(&bytes);
    bytes[start..start + 4].copy_from_slice(&checksum);
    bytes
}

/// Damages a record.
type Change<'a> = &'a dyn Fn(&mut Vec<Raw>);

#[test]
fn damaged_definitions_are_damage() {
    let records = unchunked(&original());
    let first = |opcode| {
        records
            .iter()
            .position(|record| record.0 == opcode)
            .unwrap()
    };
    let (schema, channel) = (first(op::SCHEMA), first(op::CHANNEL));
    let folder = Folder::new();
    let whole = folder.write("a.mcap", changed(records.clone(), |_| {}));
    assert_eq!(verified(&whole).equality, Some(Equality::PackedOtherwise));
    let cases: [(&str, Change<'_>); 4] = [
        ("the id of a schema", &|records| records[schema].1[0] ^= 64),
        ("a length in a schema", &|records| {
            records[schema].1[2] ^= 64;
        }),
        ("the opcode of a schema", &|records| {
            records[schema].0 = 0x83;
        }),
        ("the schema of a channel", &|records| {
            records[channel].1[2] ^= 64;
        }),
    ];
    for (name, change) in cases {
        let path = folder.write("a.mcap", changed(records.clone(), change));
        let report = verified(&path);
        assert_eq!(report.verdict, Verdict::Incomplete, "{name}: {report:?}");
        assert_eq!(report.state, Condition::Damaged, "{name}");
        assert_eq!(report.difference, None, "{name}");
        let printed = folder.toprise("info a.mcap", 3).stdout;
        if name != "a length in a schema" && name != "the opcode of a schema" {
            assert_contains(&printed, "which is not defined");
        }
    }
}

#[test]
fn undefined_schemas_without_damage_are_differences() {
    let mut records = unchunked(&original());
    let schema = records
        .iter()
        .position(|record| record.0 == op::SCHEMA)
        .unwrap();
    records[schema].1[0] ^= 64;
    let folder = Folder::new();
    let path = folder.write("a.mcap", changed(records, |_| {}));
    let difference = verified(&path).difference.unwrap();
    assert_contains(&format!("{difference:?}"), "with the undefined schema");
}

#[test]
fn names_repeated_keys() {
    let mut with_metadata = channel(1, "/a");
    with_metadata.truncate(with_metadata.len() - 4);
    with_metadata.extend(map(&[("key", "1"), ("key", "2")]));
    let metadata = [text("notes"), map(&[("key", "1"), ("key", "2")])].concat();
    let folder = Folder::new();
    for (opcode, body, what) in [
        (op::METADATA, metadata, "a metadata record has a key twice"),
        (
            op::CHANNEL,
            with_metadata,
            "the metadata of a channel record have a key twice",
        ),
    ] {
        folder.write(
            "a.mcap",
            raw::file(&[&header("other"), &record(opcode, &body)]),
        );
        let printed = folder.toprise("info a.mcap", 3).stdout;
        assert_contains(&printed, what);
    }
}

/// A file within a file: where the record around it ends as it says, nothing in it is read as a part of the file.
#[test]
fn reads_nothing_within_a_damaged_record() {
    let inner = [
        &record(op::CHANNEL, &channel(7, "/inner"))[..],
        &(0..9)
            .map(|number| message(7, number, u64::from(number), b"1"))
            .collect::<Vec<_>>()
            .concat(),
    ]
    .concat();
    let inner = raw::file(&[&header("other"), &inner]);
    let mut damaged_attachment = attachment("inner.mcap", &inner);
    // The length of its name.
    damaged_attachment[19] = 1;
    let mut damaged_schema = [&raw::schema(3, "inner")[..], &inner].concat();
    damaged_schema[5] = 1;
    let folder = Folder::new();
    for (name, damaged) in [
        ("attachment", record(op::ATTACHMENT, &damaged_attachment)),
        ("schema", record(op::SCHEMA, &damaged_schema)),
    ] {
        let messages: Vec<u8> = (0..5)
            .map(|number| message(1, number, u64::from(number), b"2"))
            .collect::<Vec<_>>()
            .concat();
        let bytes = raw::file(&[
            &header("other"),
            &record(op::CHANNEL, &channel(1, "/outer")),
            &damaged,
            &messages,
        ]);
        let overview = Overview::read(&folder.write("a.mcap", bytes)).unwrap();
        let topics: Vec<&str> = overview
            .channels
            .iter()
            .map(|channel| channel.topic.as_str())
            .collect();
        assert_eq!(topics, ["/outer"], "{name}");
        assert_eq!(overview.messages(), 5, "{name}");
        assert_eq!(overview.losses.len(), 1, "{name}");
        assert_eq!(overview.losses[0].length, damaged.len() as u64, "{name}");
    }
}

#[test]
fn lists_attachments_of_foreign_files() {
    let folder = Folder::new();
    folder.write(
        "a.mcap",
        raw::file(&[
            &header("other"),
            &record(op::ATTACHMENT, &attachment("camera_*.yaml", &[0; 2000])),
        ]),
    );
    let printed = folder.toprise("info a.mcap", 0).stdout;
    for part in ["camera_*.yaml", "application/octet-stream", "2.0 kB"] {
        assert_contains(&printed, part);
    }
    let printed = folder.toprise("info a.mcap --format markdown", 0).stdout;
    assert_contains(
        &printed,
        r"| camera\_\*.yaml | application/octet-stream | 2.0 kB |",
    );
}

#[test]
fn names_schemas_that_are_not_defined() {
    let mut undefined = channel(1, "/a");
    undefined[2] = 9;
    let folder = Folder::new();
    folder.write(
        "a.mcap",
        raw::file(&[&header("other"), &record(op::CHANNEL, &undefined)]),
    );
    let printed = folder.toprise("info a.mcap", 0).stdout;
    assert_contains(&printed, "schema 9, which is not defined");
}

/// A summary that defines a topic once more, in another encoding, for a channel without messages.
#[test]
fn ignores_unused_definitions_in_summary() {
    let mut forgery = Forgery::of(&original());
    forgery.header.library = "somebody".to_owned();
    forgery.summary = Rc::new(|records| {
        let is_channel = |record: &&Raw| record.0 == op::CHANNEL;
        let mut other = records.iter().find(is_channel).unwrap().clone();
        // Another id, and no schema.
        other.1[..4].copy_from_slice(&[99, 0, 0, 0]);
        records.push(other);
        let statistics = records
            .iter_mut()
            .find(|record| record.0 == op::STATISTICS)
            .unwrap();
        statistics.1[10] += 1;
    });
    let folder = Folder::new();
    let path = folder.write("a.mcap", forgery.bytes());
    let recording = Recording::open(&path).unwrap();
    let overview = Overview::new(&recording);
    assert_eq!(overview.condition, Condition::Whole, "{overview:?}");
    let report = verified(&path);
    assert_eq!(
        report.equality,
        Some(Equality::PackedOtherwise),
        "{report:?}"
    );
}
