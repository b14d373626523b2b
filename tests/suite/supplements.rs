//! Channels and attachments in addition to a run, such as the data of a fit.

use crate::forgeries::forgery::{Forgery, edit};
use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use std::error::Error;
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
    let file = std::fs::File::create(path).unwrap();
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
fn rejects_other_attachments() {
    let folder = Folder::new();
    let form = Form::default();
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let original = Forgery::of(&recorded(&scenario, &[], form));
    let path = folder.at("forged.mcap");
    for (name, media_type, time, verdict) in [
        ("fit-report.json", "application/json", 0, Verdict::Verified),
        ("fit-report.json", "application/json", 1, Verdict::Different),
        ("fit-report.json", "text/plain", 0, Verdict::Different),
        ("other.json", "application/json", 0, Verdict::Different),
    ] {
        let mut forgery = original.clone();
        forgery.attach(|header, _| {
            header.name = name.to_owned();
            header.media_type = media_type.to_owned();
            header.log_time = time;
        });
        forgery.write(&path);
        let report = verified(&path);
        assert_eq!(
            report.verdict, verdict,
            "{name} ({media_type}) at {time}: {report:?}"
        );
    }
}
