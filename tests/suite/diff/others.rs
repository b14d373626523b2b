//! Comparing files that other software wrote or changed.

use super::*;
use std::cell::Cell;

/// A message: its topic, time (ms) and text.
type Text<'t> = (&'t str, u64, &'t str);

/// A file of other software, with one schema for all topics.
fn foreign(folder: &Folder, name: &str, schema: &str, messages: &[Text<'_>]) -> Recording {
    let path = folder.at(name);
    let file = BufWriter::new(File::create(&path).unwrap());
    let options = mcap::WriteOptions::new().library("test");
    let mut writer = options.create(file).unwrap();
    let schema = writer
        .add_schema("x", "jsonschema", schema.as_bytes())
        .unwrap();
    for (sequence, (topic, milliseconds, text)) in messages.iter().enumerate() {
        let channel = writer.add_channel(schema, topic, "json", &BTreeMap::new());
        let header = mcap::records::MessageHeader {
            channel_id: channel.unwrap(),
            sequence: sequence as u32,
            log_time: milliseconds * 1_000_000,
            publish_time: 0,
        };
        writer
            .write_to_known_channel(&header, text.as_bytes())
            .unwrap();
    }
    writer.finish().unwrap();
    Recording::open(&path).unwrap()
}

/// The comparison of a topic that toprise doesn't decode.
fn other<'r>(report: &'r Report, topic: &str) -> &'r TopicBytes {
    let mut others = report.others.iter();
    others.find(|other| other.topic == topic).unwrap()
}

#[test]
fn compares_foreign_files_byte_by_byte() {
    const WHOLE: [Text<'_>; 4] = [
        ("/x", 0, "1"),
        ("/x", 10, "2"),
        ("/x", 10, "3"),
        ("/y", 20, "4"),
    ];
    let folder = Folder::new();
    let a = foreign(&folder, "a.mcap", "{}", &WHOLE);
    let against = |name: &str, schema: &str, messages: &[Text<'_>]| {
        let b = foreign(&folder, name, schema, messages);
        let report = compare(&a, &b, &quick()).unwrap();
        let x = other(&report, "/x").clone();
        (report, x)
    };
    let (report, x) = against("same.mcap", "{}", &WHOLE);
    assert_eq!(report.verdict, Verdict::Identical);
    assert_eq!((x.equal, x.first), (3, None));
    assert!(report.findings.is_empty() && report.a.summary.is_none());
    let changed = [WHOLE[0], WHOLE[1], ("/x", 10, "3.5"), WHOLE[3]];
    let (report, x) = against("bytes.mcap", "{}", &changed);
    assert_eq!(report.verdict, Verdict::Different);
    assert_eq!((x.equal, x.different), (2, 1));
    assert_eq!(x.first, Some(0.01));
    let (report, x) = against("less.mcap", "{}", &[WHOLE[0], WHOLE[2], WHOLE[3]]);
    assert_eq!((report.verdict, x.unmatched), (Verdict::Different, [1, 0]));
    let more = [&WHOLE[..], &[("/x", 30, "1")]].concat();
    let (report, x) = against("more.mcap", "{}", &more);
    assert_eq!((report.verdict, x.unmatched), (Verdict::Different, [0, 1]));
    let (report, x) = against("alone.mcap", "{}", &WHOLE[..3]);
    assert_eq!((report.verdict, x.is_equal()), (Verdict::Different, true));
    assert_eq!(report.setup.topics_only_in, [vec!["/y".to_owned()], vec![]]);
    let (report, x) = against("schema.mcap", "{ }", &WHOLE);
    assert_eq!((report.verdict, x.equal), (Verdict::Different, 3));
    assert!(x.is_described_differently);
    // Only the selected topics count.
    let messages = [WHOLE[0], ("/z", 0, "1"), ("/y", 20, "5")];
    let b = foreign(&folder, "b.mcap", "{}", &messages);
    let report = compare(&b, &b, &ignoring("/y")).unwrap();
    assert_eq!(report.others.len(), 2);
    let error = compare(&b, &b, &ignoring("/yy")).unwrap_err().to_string();
    assert!(error.starts_with("no field matches"), "{error}");
    let error = compare(&a, &b, &only("/z")).unwrap_err().to_string();
    assert!(error.starts_with("topic /z can't be compared"), "{error}");
    let alone = foreign(&folder, "z.mcap", "{}", &[("/z", 0, "1")]);
    let error = compare(&a, &alone, &quick()).unwrap_err().to_string();
    assert!(error.starts_with("no common topics"), "{error}");
    let error = compare(&a, &alone, &ignoring("/z")).unwrap_err();
    let error = error.to_string();
    assert!(error.ends_with("B has none"), "{error}");
}

/// A name, the messages in A and B, and the numbers of equal, different, only A's and only B's messages.
type Case = (
    &'static str,
    &'static [&'static str],
    &'static [&'static str],
    [u64; 4],
);

#[test]
fn messages_of_one_time_are_matched_by_content() {
    let folder = Folder::new();
    let cases: [Case; 5] = [
        // Equal, different, only in A, only in B.
        (
            "one more in front",
            &["1", "2"],
            &["0", "1", "2"],
            [2, 0, 0, 1],
        ),
        (
            "another order",
            &["1", "2", "3"],
            &["3", "1", "2"],
            [3, 0, 0, 0],
        ),
        (
            "one changed",
            &["1", "2", "3"],
            &["3", "4", "1"],
            [2, 1, 0, 0],
        ),
        ("repeated", &["1", "1", "2"], &["2", "1"], [2, 0, 1, 0]),
        ("nothing equal", &["1"], &["2", "3"], [0, 1, 0, 1]),
    ];
    for (name, a, b, expected) in cases {
        let [a, b] = [("a", a), ("b", b)].map(|(side, texts)| {
            let messages: Vec<Text<'_>> = texts.iter().map(|text| ("/x", 5, *text)).collect();
            foreign(&folder, &format!("{name} {side}.mcap"), "{}", &messages)
        });
        let report = compare(&a, &b, &quick()).unwrap();
        let x = other(&report, "/x");
        let [only_a, only_b] = x.unmatched;
        let counts = [x.equal, x.different, only_a, only_b];
        assert_eq!(counts, expected, "{name}");
    }
}

#[test]
fn refuses_empty_comparisons() {
    let folder = Folder::new();
    let files = foreign(&folder, "x.mcap", "{}", &[("/x", 0, "1")]);
    let ours = recorded(&folder, "a.mcap", &short(&[]), Encoding::Json);
    for run in [&files, &ours] {
        let error = compare(run, run, &ignoring("*")).unwrap_err();
        assert_contains(&error.to_string(), "all topics are ignored");
    }
}

#[test]
fn files_without_messages_are_noted() {
    let folder = Folder::new();
    let empty = foreign(&folder, "empty.mcap", "{}", &[]);
    let report = compare(&empty, &empty, &quick()).unwrap();
    assert_eq!(report.notes, ["Neither file has messages to compare."]);
}

#[test]
fn recordings_of_other_software_are_compared() {
    let [a, b] = ["json_a", "json_b"].map(|name| data(&format!("foreign/{name}.mcap")));
    let [a, b] = [a, b].map(|path| Recording::open(&path).unwrap());
    let same = compare(&a, &a, &quick()).unwrap();
    assert_eq!(same.verdict, Verdict::Identical);
    let report = compare(&a, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    assert!(report.others.iter().any(|topic| topic.different > 0));
    let scenario = short(&[]);
    for error in [
        compare(&a, &scenario, &quick()),
        compare(&scenario, &a, &quick()),
    ] {
        let error = error.unwrap_err().to_string();
        assert_contains(&error, "is not a toprise recording");
    }
}

/// A message of one of two publishers of `/x`.
#[derive(Clone, Copy)]
struct Published {
    publisher: u16,
    sequence: u32,
    milliseconds: u64,
    publish_time: u64,
    text: &'static str,
}

/// A change of a message.
type Republish = fn(&mut Published);
type Change = fn(&mut mcap::Message<'_>);

/// A file with several publishers of one topic.
fn published(folder: &Folder, name: &str, messages: &[Published]) -> Recording {
    let path = folder.at(name);
    let file = BufWriter::new(File::create(&path).unwrap());
    let mut writer = mcap::WriteOptions::new().create(file).unwrap();
    let schema = writer.add_schema("x", "jsonschema", b"{}").unwrap();
    // The writer would give equal channels one id.
    let publishers = [1, 2].map(|id| {
        let metadata = BTreeMap::new();
        writer.add_channel_with_id(id, schema, "/x", "json", &metadata)
    });
    for message in messages {
        let header = mcap::records::MessageHeader {
            channel_id: *publishers[usize::from(message.publisher)].as_ref().unwrap(),
            sequence: message.sequence,
            log_time: message.milliseconds * 1_000_000,
            publish_time: message.publish_time,
        };
        let text = message.text.as_bytes();
        writer.write_to_known_channel(&header, text).unwrap();
    }
    writer.finish().unwrap();
    Recording::open(&path).unwrap()
}

#[test]
fn names_differences_besides_values() {
    let folder = Folder::new();
    let original = [0, 1, 2].map(|sequence| Published {
        publisher: 0,
        sequence,
        milliseconds: u64::from(sequence),
        publish_time: 7,
        text: r#"{"a":1.0}"#,
    });
    let a = published(&folder, "a.mcap", &original);
    let same = compare(&a, &a, &quick()).unwrap();
    assert_eq!((same.verdict, same.notes.len()), (Verdict::Identical, 0));
    let cases: [(&str, Republish, Verdict, &str); 5] = [
        (
            "publish",
            |m| m.publish_time += 1,
            Verdict::SameValues,
            "Publish times differ in 3 messages of /x.",
        ),
        (
            "sequence",
            |m| m.sequence += 9,
            Verdict::SameValues,
            "Sequence numbers differ in 3 messages of /x.",
        ),
        (
            "spelling",
            |m| m.text = r#"{ "a" : 1 }"#,
            Verdict::SameValues,
            "JSON is spelled differently in 3 messages of /x.",
        ),
        (
            "publishers",
            |m| m.publisher = (m.sequence % 2) as u16,
            Verdict::Identical,
            "",
        ),
        ("value", |m| m.text = r#"{"a":2.0}"#, Verdict::Different, ""),
    ];
    for (name, change, verdict, note) in cases {
        let mut messages = original;
        messages.iter_mut().for_each(change);
        let b = published(&folder, name, &messages);
        let report = compare(&a, &b, &quick()).unwrap();
        assert_eq!(report.verdict, verdict, "{name}: {:?}", report.setup);
        assert_eq!(report.notes.concat(), note, "{name}");
    }
}

/// Consumers see them one after the other, and the last one stays.
#[test]
fn notes_reordered_simultaneous_messages() {
    let folder = Folder::new();
    let original = [r#"{"a":1}"#, r#"{"a":2}"#].map(|text| Published {
        publisher: 0,
        sequence: 0,
        milliseconds: 5,
        publish_time: 7,
        text,
    });
    let mut reversed = original;
    reversed.reverse();
    let a = published(&folder, "a.mcap", &original);
    let b = published(&folder, "b.mcap", &reversed);
    let report = compare(&a, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::SameValues);
    let note = "The order of messages of the same time differs in 2 messages of /x.";
    assert_eq!(report.notes, [note]);
}

#[test]
fn merges_equal_channels_of_a_topic() {
    let folder = Folder::new();
    let foreign = foreign(&folder, "one.mcap", "{}", &[("/x", 0, "1")]);
    let message = Published {
        publisher: 1,
        sequence: 0,
        milliseconds: 0,
        publish_time: 0,
        text: "1",
    };
    let two = published(&folder, "two.mcap", &[message]);
    let report = compare(&foreign, &two, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::SameValues);
    assert!(!other(&report, "/x").is_described_differently);
    let keys: Vec<_> = report.setup.files.iter().map(|file| &*file.key).collect();
    assert!(keys.contains(&"number of channels of /x"), "{keys:?}");
    assert!(!keys.contains(&"channel /x"), "{keys:?}");
}

#[test]
fn refuses_tolerances_without_fields() {
    let folder = Folder::new();
    let files = ["1.0", "1.1"].map(|text| foreign(&folder, text, "{}", &[("/x", 0, text)]));
    let mut relative = quick();
    relative.tolerances.general.rel = 0.5;
    for options in [relative, tolerating("/x=1")] {
        let error = compare(&files[0], &files[1], &options).unwrap_err();
        assert_contains(&error.to_string(), "tolerances apply to the fields");
    }
    // Nor does a tolerance apply to a foreign topic of a recording.
    let extended = with_topic(&folder, "extended.mcap", "/camera");
    let error = compare(&extended, &extended, &tolerating("/camera=1")).unwrap_err();
    assert_contains(&error.to_string(), "no field matches");
}

/// A short recording with one more topic.
fn with_topic(folder: &Folder, name: &str, topic: &str) -> Recording {
    let scenario = short(&[("stop.duration", "0.1")]);
    let original = recorded(
        folder,
        &format!("original-{name}"),
        &scenario,
        Encoding::Json,
    );
    copied(
        folder,
        name,
        &original,
        |_| {},
        |writer| {
            let channel = writer.add_channel(0, topic, "x", &BTreeMap::new()).unwrap();
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: 0,
                log_time: 0,
                publish_time: 0,
            };
            writer.write_to_known_channel(&header, b"1").unwrap();
        },
    )
}

#[test]
fn topics_of_others_are_no_difference_of_the_run() {
    let folder = Folder::new();
    let extended = with_topic(&folder, "extended.mcap", "/camera");
    let original = Recording::open(&folder.at("original-extended.mcap")).unwrap();
    let simulated = short(&[("stop.duration", "0.1")]);
    for report in [
        compare(&original, &extended, &quick()),
        compare(&simulated, &extended, &quick()),
    ] {
        let report = report.unwrap();
        assert_ne!(report.verdict, Verdict::Different);
        let only_in: [Vec<String>; 2] = Default::default();
        assert_eq!(report.setup.topics_only_in, only_in);
    }
    let ignored = compare(&original, &extended, &ignoring("/camera")).unwrap();
    assert_eq!(ignored.verdict, Verdict::Equal);
}

#[test]
fn names_differences_of_recordings_besides_values() {
    let folder = Folder::new();
    let scenario = short(&[("stop.duration", "0.1")]);
    let ours = recorded(&folder, "a.mcap", &scenario, Encoding::Json);
    let copy = |name: &str, change: fn(&mut mcap::Message<'_>)| {
        copied(&folder, name, &ours, change, |_| {})
    };
    let unchanged = copy("copy.mcap", |_| {});
    let cases: [(&str, Change, &str); 3] = [
        ("publish", |m| m.publish_time += 1, "Publish times differ"),
        (
            "sequence",
            |m| m.sequence += u32::from(m.channel.topic == "/top/state"),
            "Sequence numbers differ",
        ),
        (
            "spelling",
            |m| {
                if m.channel.message_encoding == "json" {
                    m.data.to_mut().insert(1, b' ');
                }
            },
            "JSON is spelled differently",
        ),
    ];
    for (name, change, note) in cases {
        let changed = copy(name, change);
        let report = compare(&unchanged, &changed, &quick()).unwrap();
        assert_eq!(report.verdict, Verdict::SameValues, "{name}");
        assert!(report.setup.files.is_empty(), "{name}: {:?}", report.setup);
        let [.., last] = report.notes.as_slice() else {
            panic!("{name}: no notes");
        };
        assert!(last.starts_with(note), "{name}: {:?}", report.notes);
        // Neither copy has its scenario.
        assert_eq!(report.notes.len(), 3, "{name}: {:?}", report.notes);
    }
    let report = compare(&unchanged, &unchanged, &quick()).unwrap();
    assert_eq!(
        (report.verdict, report.notes.len()),
        (Verdict::Identical, 2)
    );
}

/// A renumbering of the messages; its argument counts all messages of the file.
type Renumber = fn(&mut mcap::Message<'_>, u32);

#[test]
fn renumbered_messages_have_the_same_values() {
    let folder = Folder::new();
    let scenario = short(&[("stop.duration", "0.1")]);
    let ours = recorded(&folder, "a.mcap", &scenario, Encoding::Json);
    let original = copied(&folder, "copy.mcap", &ours, |_| {}, |_| {});
    let cases: [(&str, Renumber); 3] = [
        ("from 1", |message, _| message.sequence += 1),
        ("through the file", |message, number| {
            message.sequence = number;
        }),
        ("with gaps", |message, _| message.sequence *= 3),
    ];
    for (name, renumber) in cases {
        let number = Cell::new(0);
        let change = |message: &mut mcap::Message<'_>| {
            renumber(message, number.replace(number.get() + 1));
        };
        let renumbered = copied(&folder, name, &ours, change, |_| {});
        let report = compare(&original, &renumbered, &quick()).unwrap();
        assert_eq!(report.verdict, Verdict::SameValues, "{name}");
        let notes = report.notes.concat();
        assert_contains(&notes, "Sequence numbers differ");
    }
}

#[test]
fn refuses_damaged_runs_without_a_time_in_common() {
    let folder = Folder::new();
    let whole = recorded(&folder, "a.mcap", &short(&[]), Encoding::Json);
    let bytes = fs::read(whole.path()).unwrap();
    let chunks = chunks(&bytes);
    let middle = chunks.len() / 2;
    assert!(middle > 0);
    let damaged = |name: &str, damaged: &[std::ops::Range<usize>]| {
        let mut bytes = bytes.clone();
        for chunk in damaged {
            bytes[usize::midpoint(chunk.start, chunk.end)] ^= 1;
        }
        Recording::open(&folder.write(name, &bytes)).unwrap()
    };
    let halves = [
        damaged("late.mcap", &chunks[..middle]),
        damaged("early.mcap", &chunks[middle..]),
    ];
    let error = compare(&halves[0], &halves[1], &quick()).unwrap_err();
    assert_contains(&error.to_string(), "no message of the same time");
}

/// A copy of a file that other software wrote, with some messages changed.
fn copied(
    folder: &Folder,
    name: &str,
    from: &Recording,
    change: impl Fn(&mut mcap::Message<'_>),
    add: impl FnOnce(&mut mcap::Writer<BufWriter<File>>),
) -> Recording {
    let path = folder.at(name);
    let file = BufWriter::new(File::create(&path).unwrap());
    let options = mcap::WriteOptions::new().library(from.library());
    let mut writer = options.create(file).unwrap();
    for (name, entries) in from.all_metadata() {
        let (name, metadata) = (name.to_owned(), entries.clone());
        let metadata = mcap::records::Metadata { name, metadata };
        writer.write_metadata(&metadata).unwrap();
    }
    let bytes = fs::read(from.path()).unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let mut message = message.unwrap();
        change(&mut message);
        writer.write(&message).unwrap();
    }
    add(&mut writer);
    writer.finish().unwrap();
    Recording::open(&path).unwrap()
}

/// What others left of a recording, or changed in it, is never passed over.
#[test]
fn any_different_message_prevents_identical() {
    let folder = Folder::new();
    let scenario = short(&[("stop.duration", "0.1")]);
    let ours = recorded(&folder, "a.mcap", &scenario, Encoding::Json);
    // The attached scenario is missing.
    let copy = copied(&folder, "copy.mcap", &ours, |_| {}, |_| {});
    let report = compare(&ours, &copy, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::SameValues);
    let change = |message: &mut mcap::Message<'_>| {
        if message.channel.topic == "/tf" && message.log_time == 50_000_000 {
            message.data.to_mut()[1] ^= 1;
        }
    };
    let view = copied(&folder, "view.mcap", &ours, change, |_| {});
    let report = compare(&ours, &view, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    let tf = other(&report, "/tf");
    assert_eq!((tf.different, tf.first), (1, Some(0.05)));
}
