//! Recordings whose messages other software logged at other times, e.g. when it played and recorded them again.

use crate::forgeries::forgery::{Forgery, Record};
use crate::support::{Folder, recorded, scenario, verified};
use toprise::analysis::diff::{self, Options};
use toprise::archive::recording::{Condition, Overview, Recording, Relogged, Selection};
use toprise::archive::verify::{Equality, Verdict};
use toprise::archive::writer::Form;

/// Unix time of a replay, ns.
const REPLAYED: u64 = 1_763_900_000_123_456_789;

/// Another log time, ns, of a message that was logged at `time_ns` and is the `number`-th of the file.
type Clock = fn(time_ns: u64, number: u64) -> u64;

fn original() -> Forgery {
    let scenario = scenario("paper", &[("stop.duration", "0.3")]);
    Forgery::of(&recorded(&scenario, &[], Form::default()))
}

/// Logs all messages at other times.
fn relog(forgery: &mut Forgery, clock: Clock) {
    let mut number = 0;
    forgery.each(|record| {
        if let Record::Message(header, _) = record {
            header.log_time = clock(header.log_time, number);
            header.publish_time = header.log_time;
            // As many writers do.
            header.sequence = 0;
            number += 1;
        }
    });
}

#[test]
fn reads_messages_by_their_stamps() {
    let cases: [(&str, Clock, i64); 5] = [
        ("shifted", |time, _| time + REPLAYED, REPLAYED as i64),
        (
            "with a delay of up to 3 ms",
            |time, number| time + REPLAYED + number * 7_919_777 % 3_000_000,
            REPLAYED as i64,
        ),
        ("played slowly", |time, _| time * 8, 7_000_000),
        (
            "logged early",
            |time, _| time.saturating_sub(50_000_000),
            -1_000_000,
        ),
        ("without times", |_, _| 0, -1_000_000),
    ];
    let folder = Folder::new();
    let plain = folder.write("plain.mcap", original().bytes());
    let plain = Recording::open(&plain).unwrap();
    assert_eq!(plain.relogged(), None);
    for (name, clock, offset_ns) in cases {
        let mut forgery = original();
        relog(&mut forgery, clock);
        let path = folder.write("relogged.mcap", forgery.bytes());
        let relogged = Some(Relogged { offset_ns });
        let recording = Recording::open(&path).unwrap();
        let overview = Overview::new(&recording);
        let expected = (relogged, &[][..], Condition::Whole);
        let found = (overview.relogged, &overview.faults[..], overview.condition);
        assert_eq!(found, expected, "{name}");
        let report = verified(&path);
        assert_eq!(report.difference, None, "{name}");
        let expected = (Verdict::Verified, Some(Equality::PackedOtherwise), relogged);
        assert_eq!(
            (report.verdict, report.equality, report.relogged),
            expected,
            "{name}"
        );
        let compared = diff::compare(&plain, &recording, &Options::default()).unwrap();
        assert_eq!(compared.verdict, diff::Verdict::SameValues, "{name}");
        let mut last = 0;
        let mut reader = recording.reader(Selection::default()).in_order_of_time();
        while let Some(message) = reader.next().transpose().unwrap() {
            assert!(last <= message.time_ns, "{name}");
            last = message.time_ns;
        }
        assert_eq!(last, 300_000_000, "{name}");
    }
}

#[test]
fn verifies_content_of_relogged_messages() {
    let folder = Folder::new();
    let mut forgery = original();
    forgery.edit("/top/energy", 7, |text| {
        text.replacen("\"kinetic\":", "\"kinetic\":1", 1)
    });
    relog(&mut forgery, |time, _| time + REPLAYED);
    let report = verified(&folder.write("forged.mcap", forgery.bytes()));
    assert_eq!(report.verdict, Verdict::Different);
    assert_eq!(report.difference.unwrap().place, "/top/energy");
    let mut forgery = original();
    let (id, _) = forgery.id("/tf");
    forgery.drop_messages(|message| message.channel_id == id && message.sequence > 0);
    relog(&mut forgery, |time, _| time + REPLAYED);
    let report = verified(&folder.write("view.mcap", forgery.bytes()));
    assert_eq!(report.verdict, Verdict::Different);
    assert_eq!(report.difference.unwrap().place, "/tf");
    let mut forgery = original();
    let (id, _) = forgery.id("/top/energy");
    forgery.drop_messages(|message| message.channel_id == id && message.sequence == 7);
    relog(&mut forgery, |time, _| time + REPLAYED);
    let report = verified(&folder.write("cut.mcap", forgery.bytes()));
    assert_eq!((report.verdict, report.missing), (Verdict::Incomplete, 1));
}

#[test]
fn takes_few_wrong_log_times_for_damage() {
    let folder = Folder::new();
    let mut forgery = original();
    forgery.each({
        let mut number = 0;
        move |record| {
            if let Record::Message(header, _) = record {
                header.log_time += u64::from(number < 40);
                number += 1;
            }
        }
    });
    let path = folder.write("a.mcap", forgery.bytes());
    let recording = Recording::open(&path).unwrap();
    assert_eq!(recording.relogged(), None);
    assert_eq!(Overview::new(&recording).condition, Condition::Altered);
}
