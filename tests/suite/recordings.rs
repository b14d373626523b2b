//! Reading recordings back: every bit, in both encodings, whole and in part.

use crate::support::{Folder, MemorySink, archive, in_memory, scenario, verified};
use proptest::prelude::*;
use serde_json::json;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error as _;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use toprise::analysis::subject::Subject;
use toprise::archive::format::end_entries;
use toprise::archive::memory::Owned;
use toprise::archive::recording::{Condition, Overview, Recording, RecordingError, Selection};
use toprise::archive::replay::replay;
use toprise::archive::sink::Sink as _;
use toprise::archive::verify::{Verdict, verify};
use toprise::archive::writer::{Form, McapWriter};
use toprise::run::scenario::{Scenario, ScenarioError};
use toprise::telemetry::encoding::{Decoder, Encoder, Encoding, Row};
use toprise::telemetry::fields::{ENERGY, NumberField, state};
use toprise::telemetry::{Telemetry, Topic, Topics, channels};

fn short() -> Scenario {
    scenario("paper", &[("stop.duration", "0.3")])
}

const PROTOBUF: Form = Form {
    encoding: Encoding::Protobuf,
    views: true,
};

fn recorded(name: &str, form: Form) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    archive(&path, &short(), &[], form).unwrap();
    (directory, path)
}

/// The messages of a run, straight from the simulation.
fn simulated(scenario: &Scenario) -> Vec<Owned> {
    in_memory(scenario).0.messages
}

#[test]
fn encodings_round_trip_bit_for_bit() {
    let expected = simulated(&short());
    for form in [Form::default(), PROTOBUF] {
        let (_directory, path) = recorded("run.mcap", form);
        let recording = Recording::open(&path).unwrap();
        assert_eq!(recording.condition(), Condition::Whole);
        assert_eq!(recording.encoding(), Some(form.encoding));
        assert_eq!(recording.scenario().unwrap(), short());
        assert_eq!(recording.differences(), []);
        let mut sink = MemorySink::default();
        let all = Selection::default();
        let read = replay(&recording, all, &mut |message, _| {
            sink.write(message).unwrap();
            true
        });
        assert_eq!((read.losses, read.undecodable), (Vec::new(), 0));
        // Finite numbers are equal only if their bits are, but for the sign of zero.
        assert_eq!(sink.messages, expected);
        let bits = |messages: &[Owned]| -> Vec<u64> {
            let numbers = messages.iter().flat_map(|m| m.numbers.clone());
            numbers.map(f64::to_bits).collect()
        };
        assert_eq!(bits(&sink.messages), bits(&expected));
        let end = recording.end().unwrap();
        assert_eq!(sink.digest.finish(), end["content_digest"]);
    }
}

/// The times and the values of a quantity.
fn series(recording: &Recording, field: NumberField) -> (Vec<u64>, Vec<f64>) {
    let mut series = (Vec::new(), Vec::new());
    let mut reader = recording.reader(Selection::default());
    while let Some(message) = reader.next() {
        let message = message.unwrap();
        if message.topic() == field.topic() {
            series.0.push(message.time_ns);
            series.1.push(field.of(&message));
        }
    }
    series
}

#[test]
fn handles_read_message_fields() {
    let expected = simulated(&short());
    for form in [Form::default(), PROTOBUF] {
        let (_directory, path) = recorded("run.mcap", form);
        let recording = Recording::open(&path).unwrap();
        for (topic, path) in [
            ("/top/state", "theta"),
            ("/top/contact", "slip_world.y"),
            ("/top/acceleration", "psi_ddot.frictional"),
            ("/top/nutation", "period"),
            ("/events", "psi_dot"),
        ] {
            let mut numbers = Topic::find(topic).unwrap().numbers();
            let field = numbers.find(|number| number.path() == path).unwrap();
            let (read_times, read_values) = series(&recording, field);
            let info = channels().iter().find(|c| c.topic == topic).unwrap();
            let number = info.number_index(path).unwrap();
            let of_channel = expected
                .iter()
                .filter(|message| channels()[message.channel].topic == topic);
            let (times, values): (Vec<_>, Vec<_>) = of_channel
                .map(|message| (message.time_ns, message.numbers[number]))
                .unzip();
            assert_eq!(read_times, times, "{topic}");
            assert_eq!(read_values, values, "{field}");
            assert_eq!(field.unit(), info.numbers[number].unit);
        }
    }
}

#[test]
fn topics_select_alike_in_scenarios_and_recordings() {
    let (_directory, path) = recorded("run.mcap", Form::default());
    let recording = Recording::open(&path).unwrap();
    let scenario = short();
    for subject in [Subject::from(&recording), Subject::from(&scenario)] {
        let seen = |topics: Topics| {
            let mut seen = BTreeSet::new();
            subject.read(&topics, &mut |message, _| {
                seen.insert(message.topic());
                true
            });
            seen
        };
        assert!(seen(Topics::Only(Vec::new())).is_empty());
        assert!(seen(Topics::Only(vec![ENERGY])).into_iter().eq([ENERGY]));
        let own = Topic::all_with(scenario.model.support);
        assert!(seen(Topics::All).into_iter().eq(own));
    }
}

#[test]
fn selects_topics_and_times() {
    let (_directory, path) = recorded("run.mcap", Form::default());
    let recording = Recording::open(&path).unwrap();
    let mut reader = recording.reader(Selection {
        topics: Topics::Only(vec!["/top/energy".to_owned()]),
        from_ns: Some(100_000_000),
        to_ns: Some(200_000_000),
    });
    let mut times = Vec::new();
    while let Some(message) = reader.next() {
        let message = message.unwrap();
        assert_eq!(channels()[message.channel].topic, "/top/energy");
        times.push(message.time_ns);
    }
    let expected: Vec<u64> = (100..=200).map(|ms| ms * 1_000_000).collect();
    assert_eq!(times, expected);
}

/// A recording of a run by the writer that needs no thread, with its messages changed.
fn written(scenario: &Scenario, form: Form, change: impl Fn(&mut Owned)) -> Vec<u8> {
    let (sink, end) = in_memory(scenario);
    let mut writer = McapWriter::new(Vec::new(), scenario, &Telemetry::default(), form).unwrap();
    for mut message in sink.messages {
        change(&mut message);
        writer.write(&message.as_message()).unwrap();
    }
    let (bytes, digest) = writer.finish(end_entries(&end)).unwrap();
    assert_eq!(digest.len(), 64);
    bytes
}

#[test]
fn both_writers_write_equal_bytes() {
    for form in [Form::default(), PROTOBUF] {
        for views in [true, false] {
            let form = Form { views, ..form };
            let (_directory, path) = recorded("run.mcap", form);
            assert!(fs::read(path).unwrap() == written(&short(), form, |_| {}));
        }
    }
}

#[test]
fn verify_finds_one_changed_bit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.mcap");
    let bytes = written(&short(), Form::default(), |message| {
        if channels()[message.channel].topic == "/top/torque" && message.sequence == 123 {
            let number = &mut message.numbers[4];
            *number = number.next_up();
        }
    });
    fs::write(&path, bytes).unwrap();
    let report = verified(&path);
    assert_eq!(report.verdict, Verdict::Different);
    let difference = report.difference.unwrap();
    let place = (difference.place.as_str(), difference.time.as_deref());
    assert_eq!(place, ("/top/torque", Some("0.123")));
    assert_eq!(difference.field.as_deref(), Some("friction_body.y"));
    let values = [difference.recorded, difference.simulated];
    let [recorded, simulated] = values.map(|value| value.unwrap().parse::<f64>().unwrap());
    assert_eq!(recorded, simulated.next_up());
}

/// An MCAP file with some channels, by the crate's own writer.
fn foreign(path: &Path, library: &str, topics: &[(&str, &str, serde_json::Value)]) {
    let file = fs::File::create(path).unwrap();
    let options = mcap::WriteOptions::new().library(library);
    let mut writer = options.create(std::io::BufWriter::new(file)).unwrap();
    for (topic, schema, message) in topics {
        // The names of toprise's types are reserved, also for versions to come.
        let name = if library.starts_with("toprise/") {
            "toprise.Schema"
        } else {
            "a.Schema"
        };
        let schema = writer.add_schema(name, "jsonschema", schema.as_bytes());
        let metadata = BTreeMap::from([("made".to_owned(), topic.len().to_string())]);
        let channel = writer.add_channel(schema.unwrap(), topic, "json", &metadata);
        let header = mcap::records::MessageHeader {
            channel_id: channel.unwrap(),
            sequence: 0,
            log_time: 0,
            publish_time: 0,
        };
        let data = message.to_string().into_bytes();
        writer.write_to_known_channel(&header, &data).unwrap();
        // Two channels with one topic differ in their metadata.
        if *topic == "/twice" {
            let metadata = BTreeMap::from([("other".to_owned(), String::new())]);
            writer.add_channel(1, topic, "json", &metadata).unwrap();
        }
    }
    writer.finish().unwrap();
}

/// The error of opening a file whose attached scenario is this text, or of reading the scenario.
fn scenario_error(path: &Path, text: &[u8]) -> RecordingError {
    let mut writer = mcap::Writer::new(fs::File::create(path).unwrap()).unwrap();
    let attachment = mcap::Attachment {
        log_time: 0,
        create_time: 0,
        name: "scenario.toml".to_owned(),
        media_type: "application/toml".to_owned(),
        data: Cow::Borrowed(text),
    };
    writer.attach(&attachment).unwrap();
    writer.finish().unwrap();
    Recording::open(path).unwrap().scenario().unwrap_err()
}

#[test]
fn errors_of_recorded_scenarios_have_their_cause() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let error = scenario_error(&path, b"name = \"\xff\"");
    assert!(matches!(error, RecordingError::ScenarioText(_)), "{error}");
    let text = short().to_toml().replace("k = 0.03", "k = -1");
    let error = scenario_error(&path, text.as_bytes());
    let cause = error
        .source()
        .and_then(|cause| cause.downcast_ref::<ScenarioError>());
    let key = cause.and_then(|cause| cause.key.as_deref());
    assert_eq!(key, Some("friction.k"), "{error}");
}

#[test]
fn classifies_files() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("other.mcap");
    foreign(&path, "somebody", &[("/a", "{}", json!({ "x": 1 }))]);
    let recording = Recording::open(&path).unwrap();
    assert_eq!(recording.condition(), Condition::Foreign);
    assert_eq!(recording.library(), "somebody");
    let mut reader = recording.reader(Selection::default());
    assert!(matches!(reader.next_undecoded(), Some(m) if m.data == b"{\"x\":1}"));
    let error = verify(&recording, &|_| {}).unwrap_err();
    assert_eq!(error.to_string(), "there is no scenario in it");

    // A version of toprise that had other fields and other channels.
    let schema = json!({
        "type": "object",
        "properties": {
            "timestamp": { "type": "object", "properties": { "sec": {}, "nsec": {} } },
            "theta": { "type": "number" },
            "wobble": { "type": "number" },
            "gust": { "type": "object", "properties": { "x": {}, "y": {} } },
        },
    });
    let message = json!({
        "timestamp": { "sec": 0, "nsec": 0 }, "theta": 0.5, "wobble": 1.0,
        // An unknown field is skipped with all that it contains.
        "gust": { "x": 2.0, "z": [3.0] },
    });
    let schema = schema.to_string();
    let channels = [
        ("/top/state", schema.as_str(), message.clone()),
        ("/top/novel", schema.as_str(), message),
    ];
    foreign(&path, "toprise/9.0.0", &channels);
    let recording = Recording::open(&path).unwrap();
    assert_eq!(recording.condition(), Condition::Interrupted);
    let differences = recording.differences();
    assert_eq!(differences.len(), 2);
    assert_eq!(differences[0].0, "/top/state");
    assert_eq!(differences[0].1.unknown, ["wobble", "gust.x", "gust.y"]);
    assert!(differences[0].1.missing.contains(&"phi_dot".to_owned()));
    assert_eq!(differences[1].0, "/top/novel");
    assert_eq!(series(&recording, state::THETA).1, [0.5]);
    assert!(series(&recording, state::PHI).1[0].is_nan());
    let mut reader = recording.reader(Selection::default());
    let message = reader.next().unwrap().unwrap();
    assert_eq!(state::THETA.of(&message), 0.5);
}

#[test]
fn refuses_different_channels_of_one_topic() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("twice.mcap");
    let expected =
        "it has channels named /top/state with different encodings or schemas, which is ambiguous";
    for (encoding, error) in [("json", None), ("protobuf", Some(expected))] {
        let file = fs::File::create(&path).unwrap();
        let options = mcap::WriteOptions::new().library("toprise/0.1.0");
        let mut writer = options.create(std::io::BufWriter::new(file)).unwrap();
        for (origin, encoding) in [("here", "json"), ("there", encoding)] {
            let metadata = BTreeMap::from([("origin".to_owned(), origin.to_owned())]);
            writer
                .add_channel(0, "/top/state", encoding, &metadata)
                .unwrap();
        }
        writer.finish().unwrap();
        let opened = Recording::open(&path);
        assert_eq!(
            opened.err().map(|error| error.to_string()).as_deref(),
            error
        );
    }
}

#[test]
fn reads_files_without_chunks_or_summary() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("plain.mcap");
    let file = fs::File::create(&path).unwrap();
    let options = mcap::WriteOptions::new()
        .use_chunks(false)
        .emit_summary_records(false);
    let mut writer = options.create(std::io::BufWriter::new(file)).unwrap();
    let channel = std::sync::Arc::new(mcap::Channel {
        id: 1,
        topic: "/a".to_owned(),
        schema: None,
        message_encoding: "json".to_owned(),
        metadata: BTreeMap::new(),
    });
    for sequence in 0..10_u32 {
        let message = mcap::Message {
            channel: channel.clone(),
            sequence,
            log_time: u64::from(sequence),
            publish_time: 0,
            data: Cow::Owned(vec![b'1'; 200_000]),
        };
        writer.write(&message).unwrap();
    }
    writer.finish().unwrap();
    let overview = Overview::read(&path).unwrap();
    assert_eq!(overview.channels.len(), 1);
    assert_eq!(overview.channels[0].messages, 10);
    assert_eq!(overview.losses, []);
}

#[test]
fn reports_each_undecodable_message() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("bad.mcap");
    let schema = json!({ "properties": { "theta": { "type": "number" } } }).to_string();
    let stamp = json!({ "sec": 0, "nsec": 0 });
    for message in [
        json!({ "timestamp": stamp, "theta": "high" }),
        json!({ "timestamp": stamp }),
        json!({ "timestamp": stamp, "theta": 1.0, "phi": 2.0 }),
        json!({ "timestamp": { "sec": 1, "nsec": 0 }, "theta": 1.0 }),
        json!([1, 2]),
        json!(null),
    ] {
        let channels = [("/top/state", schema.as_str(), message.clone())];
        foreign(&path, "toprise/0.1.0", &channels);
        let recording = Recording::open(&path).unwrap();
        let mut reader = recording.reader(Selection::default());
        let error = reader.next().unwrap().unwrap_err();
        assert!(
            error.to_string().starts_with("/top/state message 0"),
            "{error}"
        );
        assert!(reader.next().is_none(), "{message}");
    }
}

/// A row of any finite numbers and any texts for one of the channels.
fn rows() -> impl Strategy<Value = Owned> {
    let finite = prop::num::f64::NORMAL
        | prop::num::f64::SUBNORMAL
        | prop::num::f64::ZERO
        | prop::num::f64::NEGATIVE
        | prop::num::f64::POSITIVE;
    (0..channels().len(), any::<u32>(), 0..1u64 << 61).prop_flat_map(
        move |(channel, sequence, time_ns)| {
            let info = &channels()[channel];
            let numbers = prop::collection::vec(finite, info.numbers.len());
            let texts = prop::collection::vec(any::<String>(), info.texts.len());
            (numbers, texts).prop_map(move |(numbers, texts)| Owned {
                channel,
                sequence,
                time_ns,
                numbers,
                texts,
            })
        },
    )
}

proptest! {
    #[test]
    fn any_message_round_trips(row in rows()) {
        for encoding in Encoding::ALL {
            let info = &channels()[row.channel];
            let mut bytes = Vec::new();
            Encoder::new(encoding).encode(&row.as_message(), &mut bytes);
            let schema = encoding.schema(info);
            let decoder = Decoder::new(info, encoding.name(), info.schema, &schema).unwrap();
            let mut decoded = Row::default();
            decoder.decode(&bytes, &mut decoded).unwrap();
            prop_assert_eq!(decoded.time_ns, row.time_ns);
            let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&decoded.numbers), bits(&row.numbers));
            prop_assert_eq!(&decoded.texts, &row.texts);
        }
    }

    #[test]
    fn any_bytes_are_decoded_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200), channel in 0..channels().len()) {
        for encoding in Encoding::ALL {
            let info = &channels()[channel];
            let schema = encoding.schema(info);
            let decoder = Decoder::new(info, encoding.name(), info.schema, &schema).unwrap();
            let _ = decoder.decode(&bytes, &mut Row::default());
            let _ = Decoder::new(info, encoding.name(), info.schema, &bytes);
        }
    }

    #[test]
    fn any_bytes_are_opened_or_refused(mut bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("any.mcap");
        fs::write(&path, &bytes).unwrap();
        let _ = Overview::read(&path);
        let mut whole = mcap::MAGIC.to_vec();
        whole.append(&mut bytes);
        fs::write(&path, &whole).unwrap();
        if let Ok(recording) = Recording::open(&path) {
            let _ = verify(&recording, &|_| {});
        }
    }
}

#[test]
fn verify_names_unrecorded_topics() {
    let directory = tempfile::tempdir().unwrap();
    for topic in ["/top/state", "/top/nutation", "/events"] {
        let path = directory.path().join(topic.replace('/', "_"));
        archive(&path, &short(), &[topic], Form::default()).unwrap();
        let report = verified(&path);
        assert_eq!(report.verdict, Verdict::Verified, "{report:#?}");
        let all = Topic::all_with(short().model.support);
        let others = all.map(|t| t.to_string()).filter(|other| other != topic);
        assert_eq!(report.without, others.collect::<Vec<_>>());
    }
}

/// A member that stands twice does not make up for one that is missing.
#[test]
fn refuses_repeated_json_members() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    archive(&path, &short(), &["/top/energy"], Form::default()).unwrap();
    let recording = Recording::open(&path).unwrap();
    let mut reader = recording.reader(Selection::default());
    let is_energy = |topic: &str| topic == "/top/energy";
    let text = loop {
        let message = reader.next_undecoded().unwrap();
        if is_energy(&message.channel.topic) {
            break String::from_utf8(message.data.to_vec()).unwrap();
        }
    };
    let info = ENERGY.info();
    let schema = Encoding::Json.schema(info);
    let decoder = Decoder::new(info, "json", info.schema, &schema).unwrap();
    let mut row = Row::default();
    decoder.decode(text.as_bytes(), &mut row).unwrap();
    let twice = text.replacen("\"potential\"", "\"kinetic\"", 1);
    assert_ne!(twice, text);
    let error = decoder.decode(twice.as_bytes(), &mut row).unwrap_err();
    assert!(
        error.to_string().contains("a member is repeated"),
        "{error}"
    );
}

/// Views follow from recorded topics: without nutations they have no ranges.
#[test]
fn views_have_ranges_if_nutations_are_recorded() {
    let folder = Folder::new();
    let scenario = scenario("paper", &[("stop.duration", "0.5")]);
    let topics = ["/top/state", "/top/torque"];
    let with_nutations = [&topics[..], &["/top/nutation"]].concat();
    for (topics, numbers) in [(&topics[..], 1), (&with_nutations, 3)] {
        let path = folder.at(format!("{numbers}.mcap"));
        archive(&path, &scenario, topics, Form::default()).unwrap();
        let recording = Recording::open(&path).unwrap();
        let mut reader = recording.reader(Selection::default());
        let mut messages = 0;
        while let Some(message) = reader.next_undecoded() {
            if message.channel.topic == "/view/spin_rate" {
                // CDR: its header, two empty fields of the layout, the number of elements, and bytes that align them.
                assert_eq!(message.data[12], numbers, "{topics:?}");
                assert_eq!(message.data.len(), 20 + 8 * usize::from(numbers));
                messages += 1;
            }
        }
        assert!(messages > 10);
    }
}
