//! Recordings that other software changed within an intact file: all commands report the same.

use crate::forgeries::forgery::{Forgery, Record};
use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use toprise::analysis::diff::{Options, compare};
use toprise::analysis::explain::explain;
use toprise::archive::recording::{Condition, Overview, Recording};
use toprise::archive::verify::Verdict;
use toprise::archive::writer::Form;

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
            Some("messages are skipped"),
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

#[test]
fn info_reports_dropped_topics() {
    let mut forgery = original();
    forgery.leave_out("/top/energy");
    let folder = Folder::new();
    let path = folder.write("a.mcap", forgery.bytes());
    let overview = Overview::read(&path).unwrap();
    assert_eq!(overview.condition, Condition::Altered);
    assert_eq!(
        overview.faults,
        ["missing 301 of 301 samples of /top/energy"]
    );
    assert_eq!(verified(&path).verdict, Verdict::Incomplete);
}
