//! Channels and attachments in addition to a run, such as the data of a fit.

use crate::forgeries::forgery::{Forgery, edit};
use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use std::error::Error;
use std::fs;
use std::path::Path;
use toprise::archive::format::end_entries;
use toprise::archive::recording::Recording;
use toprise::archive::verify::{Equality, Supplementary, Verdict};
use toprise::archive::writer::{Form, McapWriter};
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::supplement::{
    FIT_DATA, FIT_RESIDUAL, SUPPLEMENTARY_ATTACHMENTS, Supplement,
};
use toprise::telemetry::{RunMessages, Topics};

/// Number of data in addition to the run.
const DATA: u64 = 5;

/// Writes a run with the data and the report of a fit.
fn write_fit(path: &Path, encoding: Encoding) {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let mut run = RunMessages::new(&scenario, &Topics::All).unwrap();
    let views = true;
    let file = fs::File::create(path).unwrap();
    let form = Form { encoding, views };
    let mut writer = McapWriter::new(file, &scenario, run.telemetry(), form).unwrap();
    while let Some(record) = run.next(|message| Ok::<(), Box<dyn Error>>(writer.write(message)?)) {
        record.unwrap();
    }
    let data = Supplement::find(FIT_DATA).unwrap();
    let texts = ["/top/state.theta", "rad"].map(str::to_owned);
    let measured = (0..DATA).map(|i| (i * 10_000_000, &[0.1, 0.001][..], &texts[..]));
    writer.write_supplement(data, measured).unwrap();
    let residual = Supplement::find(FIT_RESIDUAL).unwrap();
    writer.write_supplement(residual, []).unwrap();
    for kind in SUPPLEMENTARY_ATTACHMENTS {
        writer.attach(kind, b"{}").unwrap();
    }
    writer.finish(end_entries(&run.end())).unwrap();
}

#[test]
fn verify_lists_supplements() {
    let folder = Folder::new();
    let path = folder.at("fit.mcap");
    for encoding in [Encoding::Json, Encoding::Protobuf] {
        write_fit(&path, encoding);
        let report = verified(&path);
        assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
        assert_eq!(report.equality, Some(Equality::PackedOtherwise));
        let listed: Vec<String> = report.supplements.iter().map(ToString::to_string).collect();
        let expected = [
            "/fit/data (5 messages)",
            "/fit/residual (0 messages)",
            "fit-problem.json (2 bytes)",
            "fit-report.json (2 bytes)",
        ];
        assert_eq!(listed, expected);
        // They are no fields of a later version.
        assert!(Recording::open(&path).unwrap().differences().is_empty());
    }
    let printed = folder.toprise("verify fit.mcap", 0);
    assert_contains(&printed.stdout, "in addition");
    assert_contains(&printed.stdout, "/fit/data (5 messages), not verified");
    let data = Supplementary::Channel {
        topic: FIT_DATA.to_owned(),
        messages: DATA,
    };
    assert_eq!(verified(&path).supplements.first(), Some(&data));
}

/// A change of a recording.
type Change = fn(&mut Forgery);

#[test]
fn rejects_other_declarations_of_supplements() {
    let folder = Folder::new();
    let original = folder.at("fit.mcap");
    write_fit(&original, Encoding::Json);
    let original = Forgery::of(&folder.read("fit.mcap"));
    let path = folder.at("forged.mcap");
    let cases: [(&str, Change, Verdict); 7] = [
        ("unchanged", |_| {}, Verdict::Verified),
        (
            "other topic of the family",
            |f| f.channel(FIT_DATA, |channel| channel.topic = "/fit/date".to_owned()),
            Verdict::Different,
        ),
        (
            "other unit in the schema",
            |f| {
                f.schema(FIT_DATA, |_, data| {
                    edit(data, |text| text.replace("measured", "invented"));
                });
            },
            Verdict::Different,
        ),
        (
            "other message type",
            |f| f.schema(FIT_DATA, |header, _| header.name.push('2')),
            Verdict::Different,
        ),
        (
            "metadata of the channel",
            |f| {
                f.channel(FIT_DATA, |channel| {
                    channel.metadata.insert("a".to_owned(), "b".to_owned());
                });
            },
            Verdict::Different,
        ),
        (
            "message of the run",
            |f| {
                f.messages("/top/state", |_, data| {
                    edit(data, |text| text.replacen('1', "2", 1));
                });
            },
            Verdict::Different,
        ),
        (
            "other data",
            |f| {
                f.messages(FIT_DATA, |_, data| {
                    edit(data, |text| text.replace("0.1", "0.2"));
                });
            },
            Verdict::Verified,
        ),
    ];
    for (name, change, verdict) in cases {
        let mut forgery = original.clone();
        change(&mut forgery);
        forgery.write(&path);
        let report = verified(&path);
        assert_eq!(report.verdict, verdict, "{name}: {report:?}");
    }
}

#[test]
fn attachments_with_reserved_names_are_of_the_run() {
    let folder = Folder::new();
    let form = Form::default();
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let original = Forgery::of(&recorded(&scenario, &[], form));
    let path = folder.at("forged.mcap");
    for (name, media_type, time, verdict) in [
        ("fit-report.json", "application/json", 0, Verdict::Verified),
        ("fit-report.json", "text/plain", 1, Verdict::Verified),
        ("other.json", "application/json", 0, Verdict::Verified),
        ("toprise.fit", "application/json", 0, Verdict::Different),
    ] {
        let mut forgery = original.clone();
        forgery.attach(|header, _| {
            header.name = name.to_owned();
            header.media_type = media_type.to_owned();
            header.log_time = time;
        });
        forgery.write(&path);
        let report = verified(&path);
        assert_eq!(report.verdict, verdict, "{name}: {report:?}");
    }
}

/// A recording with supplements of others, as a file.
fn write_supplemented(path: &Path) -> Recording {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let mut forgery = Forgery::of(&recorded(&scenario, &[], Form::default()));
    forgery.add_supplements();
    forgery.write(path);
    Recording::open(path).unwrap()
}

/// A file about a recording.
const ABOUT: &str = r#"
title = "A rising top"
licence = "CC-BY-4.0"
date = 2026-11-29
creators = [{ name = "Carberry, Josiah", orcid = "0000-0002-1825-0097" }]
"#;

#[test]
fn runs_carry_supplements_along() {
    let folder = Folder::new();
    let original = write_supplemented(&folder.at("a.mcap")).supplements();
    assert_eq!(original.len(), 3, "{original:?}");
    folder.toprise("run a.mcap -o b.mcap --encoding protobuf", 0);
    let copy = verified(&folder.at("b.mcap"));
    assert_eq!(
        (copy.verdict, copy.supplements),
        (Verdict::Verified, original.clone())
    );
    // Times, numbers and data of messages and attachments, too.
    let printed = folder.toprise("run a.mcap -o c.mcap", 0);
    assert_contains(&printed.stdout, "c.mcap");
    let printed = folder.toprise("diff a.mcap c.mcap", 0);
    assert_contains(&printed.stdout, "Identical (bit for bit)");
    let copied = Forgery::of(&folder.read("c.mcap"));
    let of_others = |mut forgery: Forgery| {
        let mut messages = Vec::new();
        forgery.messages("/lab/note", |header, data| {
            let times = (header.log_time, header.publish_time);
            messages.push((times, header.sequence, data.clone()));
        });
        messages
    };
    assert_eq!(
        of_others(copied),
        of_others(Forgery::of(&folder.read("a.mcap")))
    );
    // They are not about a changed run.
    folder.toprise("run a.mcap -o d.mcap --set friction.k=0.02", 0);
    assert_eq!(verified(&folder.at("d.mcap")).supplements, []);
}

#[test]
fn annotating_and_running_with_a_file_give_equal_bytes() {
    let folder = Folder::new();
    folder.write("about.toml", ABOUT);
    folder.write("later.toml", ABOUT.replace("29", "30"));
    write_supplemented(&folder.at("a.mcap"));
    folder.toprise("annotate a.mcap about.toml -o b.mcap", 0);
    folder.toprise("run a.mcap --about about.toml -o c.mcap", 0);
    assert!(folder.read("b.mcap") == folder.read("c.mcap"));
    let report = verified(&folder.at("b.mcap"));
    assert_eq!(report.verdict, Verdict::Verified);
    assert_eq!(report.supplements.len(), 4);
    // A record replaces that of its name.
    folder.toprise("annotate b.mcap later.toml -o d.mcap", 0);
    let annotated = Recording::open(&folder.at("d.mcap")).unwrap();
    let dates = &annotated.metadata("datacite").unwrap()["dates"];
    assert_contains(dates, "2026-11-30");
    assert_eq!(annotated.supplements().len(), 4);
    // The run is the same to the last bit.
    let digest = |name: &str| Recording::open(&folder.at(name)).unwrap().end().cloned();
    assert_eq!(digest("a.mcap"), digest("d.mcap"));
    folder.toprise("annotate d.mcap about.toml -o e.mcap", 0);
    assert!(folder.read("e.mcap") == folder.read("b.mcap"));
}

#[test]
fn annotates_whole_recordings_only() {
    let folder = Folder::new();
    folder.write("about.toml", ABOUT);
    folder.write("bad.toml", ABOUT.replace("0097", "0098"));
    let bytes = recorded(
        &scenario("paper", &[("stop.duration", "0.05")]),
        &[],
        Form::default(),
    );
    fs::write(folder.at("a.mcap"), &bytes).unwrap();
    fs::write(folder.at("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    for (arguments, expected) in [
        (
            "annotate cut.mcap about.toml -o b.mcap",
            "only a whole recording",
        ),
        (
            "annotate a.mcap bad.toml -o b.mcap",
            "bad.toml: TOML parse error at line 5",
        ),
        ("annotate a.mcap a.mcap -o b.mcap", "a.mcap"),
        (
            "annotate a.mcap about.toml -o about.toml",
            "call it about.mcap",
        ),
        (
            "annotate a.mcap about.toml -o a.mcap --force",
            "choose another file",
        ),
        ("annotate a.mcap about.toml -o cut.mcap", "cut.mcap exists"),
        ("run a.mcap --about bad.toml -o b.mcap", "check digit"),
    ] {
        let printed = folder.toprise(arguments, 2);
        assert_contains(&printed.stderr, expected);
        assert!(!folder.at("b.mcap").exists(), "{arguments}");
    }
}

/// What a damaged file loses is said, and a copy that would lack something is not made.
#[test]
fn lost_supplements_are_told() {
    let folder = Folder::new();
    folder.write("about.toml", ABOUT);
    write_supplemented(&folder.at("a.mcap"));
    let mut bytes = folder.read("a.mcap");
    let at = bytes
        .windows(8)
        .position(|part| part == b"measured")
        .unwrap();
    let notes = bytes[at..]
        .windows(17)
        .position(|part| part == b"measured at night")
        .unwrap();
    bytes[at + notes] ^= 1;
    folder.write("damaged.mcap", bytes);
    let printed = folder.toprise("run damaged.mcap -o b.mcap", 3);
    assert_contains(&printed.stderr, "damaged.mcap is damaged");
    folder.toprise("annotate damaged.mcap about.toml -o c.mcap", 2);
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let mut forgery = Forgery::of(&recorded(&scenario, &[], Form::default()));
    forgery.add("toprise.notes", &[("a", "b")]);
    forgery.write(&folder.at("reserved.mcap"));
    let printed = folder.toprise("annotate reserved.mcap about.toml -o d.mcap", 2);
    assert_contains(&printed.stderr, "toprise.notes, a name that is reserved");
}

#[test]
fn topics_of_others_are_no_difference_of_the_run() {
    let folder = Folder::new();
    write_supplemented(&folder.at("a.mcap"));
    folder.toprise("run paper --set stop.duration=0.05 -o b.mcap", 0);
    let printed = folder.toprise("diff a.mcap b.mcap", 0);
    assert_contains(&printed.stdout, "/lab/note");
}
