//! Comparing files that somebody else wrote or changed.

use super::*;

/// A message: its topic, time (ms) and text.
type Text<'t> = (&'t str, u64, &'t str);

/// A file that somebody else wrote, with a schema for all topics.
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
fn files_of_others_are_compared_byte_by_byte() {
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
    let changed = [WHOLE[0], WHOLE[1], ("/x", 10, "3 "), WHOLE[3]];
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
    // Only what is wanted counts.
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

/// The messages of a file, written by somebody else who changes some.
fn copied(
    folder: &Folder,
    name: &str,
    from: &Recording,
    change: impl Fn(&mut mcap::Message<'_>),
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
    writer.finish().unwrap();
    Recording::open(&path).unwrap()
}

/// What others left of a recording, or changed in it, is never passed over.
#[test]
fn what_differs_in_any_message_is_not_identical() {
    let folder = Folder::new();
    let scenario = short(&[("stop.duration", "0.1")]);
    let ours = recorded(&folder, "a.mcap", &scenario, Encoding::Json);
    // The attached scenario is missing.
    let copy = copied(&folder, "copy.mcap", &ours, |_| {});
    let report = compare(&ours, &copy, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::SameValues);
    let view = copied(&folder, "view.mcap", &ours, |message| {
        if message.channel.topic == "/tf" && message.log_time == 50_000_000 {
            message.data.to_mut()[1] ^= 1;
        }
    });
    let report = compare(&ours, &view, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    let tf = other(&report, "/tf");
    assert_eq!((tf.different, tf.first), (1, Some(0.05)));
}
