//! The table of channels and what follows from it.

use crate::support::{MemorySink, in_memory, scenario};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use toprise::archive::memory::Owned;
use toprise::archive::sink::record_all;
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::encoding::{Encoder, Encoding};
use toprise::telemetry::fields::{EVENTS, NUTATION, STATE, TORQUE, nutation, torque};
use toprise::telemetry::protobuf::{proto_file, proto_file_name};
use toprise::telemetry::schema::{file_name, json_schema};
use toprise::telemetry::views::{VIEW_CHANNELS, Views};
use toprise::telemetry::{RunMessages, Topics, channels};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn short_run(overrides: &[(&str, &str)]) -> MemorySink {
    let mut all = vec![("stop.duration", "0.2")];
    all.extend_from_slice(overrides);
    let scenario = scenario("paper", &all);
    in_memory(&scenario).0
}

/// The numbers at the end of a message of the view of φ̇, with the range in the nutation before it.
fn precession_views() -> Vec<(Option<[f64; 2]>, Vec<f64>)> {
    let scenario = scenario("paper", &[("stop.duration", "0.3")]);
    let messages = in_memory(&scenario).0.messages;
    let mut views = Views::new(&scenario, |_| true);
    let (mut range, mut found) = (None, Vec::new());
    for message in &messages {
        let message = message.as_message();
        if message.topic() == NUTATION {
            let fields = [nutation::PHI_DOT_MIN, nutation::PHI_DOT_MAX];
            range = Some(fields.map(|field| field.of(&message)));
        }
        views.process(&message, |view, _, bytes| {
            if VIEW_CHANNELS[view].topic == "/view/precession_rate" {
                // A header of four bytes, an empty layout, the number of values and four bytes of room.
                assert_eq!(bytes.len(), 4 + 16 + 8 * 3);
                let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap());
                found.push((range, bytes[20..].chunks(8).map(number).collect()));
            }
        });
    }
    assert_eq!(found.len(), 31);
    found
}

#[test]
fn views_have_the_range_of_the_last_nutation() {
    for (range, values) in precession_views() {
        let value = values[0];
        let [least, greatest] = range.unwrap_or([value; 2]);
        assert_eq!(values, [value, least, greatest]);
    }
}

/// The texts in a message in CDR: aligned lengths before letters and a zero byte.
fn texts(bytes: &[u8]) -> Vec<String> {
    let mut texts = Vec::new();
    for at in (4..bytes.len().saturating_sub(4)).step_by(4) {
        let length = u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let text = bytes.get(at + 4..(at + 4).saturating_add(length));
        let Some([letters @ .., 0]) = text else {
            continue;
        };
        if letters.len() > 1 && letters.iter().all(|letter| *letter >= b' ') {
            texts.extend(String::from_utf8(letters.to_vec()));
        }
    }
    texts
}

#[test]
fn markers_name_the_arrows_that_are_drawn() {
    for (preset, expected) in [
        (
            "paper",
            &["slip velocity", "friction torque", "τ", "angular momentum"][..],
        ),
        (
            "tippe-top",
            &["slip velocity", "friction torque", "horizontal part of L"],
        ),
        (
            "frictionless",
            &["angular momentum", "gravity torque", "weight"],
        ),
    ] {
        let scenario = scenario(preset, &[("stop.duration", "1")]);
        let messages = in_memory(&scenario).0.messages;
        let mut views = Views::new(&scenario, |_| true);
        let (mut count, mut named) = (0, Vec::new());
        for message in &messages {
            views.process(&message.as_message(), |view, _, bytes| {
                if VIEW_CHANNELS[view].topic == "/view/arrows" {
                    count += 1;
                    named = texts(bytes);
                }
            });
        }
        assert_eq!(count, 21, "{preset}: 20 Hz");
        for name in expected {
            assert!(
                named.iter().any(|text| text == name),
                "{preset}: {name}, {named:?}"
            );
        }
        let has_friction = named.iter().any(|text| text == "friction force");
        assert_eq!(has_friction, preset != "frictionless");
    }
}

/// The next number of four bytes, which is aligned.
fn next_number(body: &[u8], at: &mut usize) -> usize {
    *at = at.next_multiple_of(4) + 4;
    u32::from_le_bytes(body[*at - 4..*at].try_into().unwrap()) as usize
}

/// Number of names, and the three arrays of a `JointState` in CDR.
fn joint_arrays(bytes: &[u8]) -> (usize, [Vec<f64>; 3]) {
    // Alignment counts from the end of the encapsulation.
    let body = &bytes[4..];
    // The two numbers of the time stamp stand first, then the frame.
    let mut at = 8;
    let frame = next_number(body, &mut at);
    at += frame;
    let names = next_number(body, &mut at);
    for _ in 0..names {
        let length = next_number(body, &mut at);
        at += length;
    }
    let arrays = [(); 3].map(|()| {
        let count = next_number(body, &mut at);
        if count > 0 {
            at = at.next_multiple_of(8);
        }
        let values = body[at..at + 8 * count].chunks(8);
        at += 8 * count;
        values
            .map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()))
            .collect()
    });
    assert_eq!(at, body.len());
    (names, arrays)
}

/// ROS 2 demands that all arrays of a joint state have one length. The torque's range is that of its samples in the last
/// nutation.
#[test]
fn joint_states_have_arrays_of_one_length() {
    let scenario = scenario("paper", &[("stop.duration", "0.3")]);
    let messages = in_memory(&scenario).0.messages;
    let mut views = Views::new(&scenario, |_| true);
    let is_view = |index: usize| VIEW_CHANNELS[index].topic == "/view/inclination";
    let (mut samples, mut range, mut checked) = (Vec::new(), None, 0);
    for message in &messages {
        let message = message.as_message();
        if message.topic() == TORQUE {
            samples.push(torque::TOTAL_NODE.x().of(&message));
        }
        if message.topic() == NUTATION {
            let last = std::mem::take(&mut samples);
            let least = last.iter().copied().reduce(f64::min);
            let greatest = last.iter().copied().reduce(f64::max);
            range = least.zip(greatest);
        }
        views.process(&message, |view, _, bytes| {
            if !is_view(view) {
                return;
            }
            let (names, arrays) = joint_arrays(bytes);
            assert_eq!(arrays.each_ref().map(Vec::len), [names; 3]);
            let effort = &arrays[2];
            assert_eq!(effort[0], torque::TOTAL_NODE.x().of(&message));
            if let Some((least, greatest)) = range {
                assert!(least < greatest);
                assert_eq!(effort[1..], [least, greatest]);
                checked += 1;
            } else {
                assert_eq!(effort[1..], [effort[0]; 2]);
            }
        });
    }
    assert!(checked > 10, "{checked}");
}

#[test]
fn regress_committed_schemas_match_the_table() {
    let directory = root().join("schemas");
    let reports = toprise::cli::schemas();
    let mut schemas = reports.clone();
    for channel in channels() {
        schemas.push((file_name(channel), json_schema(channel)));
        schemas.push((proto_file_name(channel), proto_file(channel)));
    }
    for (name, schema) in schemas {
        let committed = fs::read_to_string(directory.join(&name)).unwrap_or_default();
        let advice = "is out of date: run `cargo run -- schema --write schemas`";
        assert_eq!(committed, schema, "{name} {advice}");
    }
    let files = fs::read_dir(&directory).unwrap().count();
    // A build without Rerun has no `view`, one without sweeps no `sweep`, one without fits no `fit`.
    let missing = [
        cfg!(not(feature = "rerun")),
        cfg!(not(feature = "sweep")),
        cfg!(not(feature = "fit")),
    ];
    let missing = missing.map(usize::from).iter().sum::<usize>();
    let of_scenarios = 1;
    let expected = 2 * channels().len() + reports.len() + missing + of_scenarios;
    assert_eq!(files, expected);
}

#[test]
fn documents_list_every_channel() {
    let page = fs::read_to_string(root().join("docs/recordings.md")).unwrap();
    let rows = channels().iter();
    let rows = rows.map(|channel| format!("| `{}` | {} |", channel.topic, channel.meaning));
    let views = VIEW_CHANNELS.iter();
    let views = views.map(|v| format!("| `{}` | `{}` | {} |", v.topic, v.schema, v.meaning));
    for row in rows.chain(views) {
        assert!(
            page.contains(&row),
            "docs/recordings.md lacks the row {row}"
        );
    }
}

/// The rules of the strictest viewers: objects with properties, plain types, nothing else.
fn lint(path: &str, schema: &Value) {
    let object = schema.as_object().unwrap();
    for key in object.keys() {
        let allowed = [
            "$schema",
            "title",
            "description",
            "type",
            "properties",
            "required",
        ];
        assert!(allowed.contains(&key.as_str()), "{path}: {key}");
    }
    match object["type"].as_str().unwrap() {
        "object" => {
            let properties = object["properties"].as_object().unwrap();
            let required = object["required"].as_array().unwrap();
            assert_eq!(properties.len(), required.len(), "{path}");
            for (name, inner) in properties {
                lint(&format!("{path}.{name}"), inner);
            }
        }
        "number" | "integer" | "string" => assert!(!object.contains_key("properties")),
        other => panic!("{path}: type {other}"),
    }
    let description = object["description"].as_str().unwrap();
    assert!(!description.is_empty(), "{path}");
}

#[test]
fn schemas_use_common_features_only() {
    for channel in channels() {
        let schema: Value = serde_json::from_str(&json_schema(channel)).unwrap();
        lint(channel.topic, &schema);
        assert_eq!(schema["title"], channel.schema);
    }
}

/// The JSON value at a path of the table.
fn at<'a>(message: &'a Value, path: &str) -> &'a Value {
    path.split('.').fold(message, |value, part| &value[part])
}

/// Whether a message has exactly the members that a schema requires, of the right types.
fn conforms(message: &Value, schema: &Value) -> bool {
    match schema["type"].as_str().unwrap() {
        "object" => {
            let properties = schema["properties"].as_object().unwrap();
            let Some(members) = message.as_object() else {
                return false;
            };
            let fits = |name, inner| members.get(name).is_some_and(|m| conforms(m, inner));
            let all_fit = properties.iter().all(|(name, inner)| fits(name, inner));
            members.len() == properties.len() && all_fit
        }
        "integer" => message.is_u64(),
        "number" => message.is_number(),
        _ => message.is_string(),
    }
}

#[test]
fn json_messages_are_lossless_and_match_their_schema() {
    let fixed = short_run(&[]);
    let free = in_memory(&scenario("drop", &[("stop.duration", "0.2")])).0;
    let encoder = Encoder::new(Encoding::Json);
    let mut seen = vec![0; channels().len()];
    for message in fixed.messages.iter().chain(&free.messages) {
        let channel = &channels()[message.channel];
        let mut bytes = Vec::new();
        encoder.encode(&message.as_message(), &mut bytes);
        let json: Value = serde_json::from_slice(&bytes).unwrap();
        let schema: Value = serde_json::from_str(&json_schema(channel)).unwrap();
        assert!(conforms(&json, &schema), "{}: {json}", channel.topic);
        let sec = json["timestamp"]["sec"].as_u64().unwrap();
        let nsec = json["timestamp"]["nsec"].as_u64().unwrap();
        assert_eq!(sec * 1_000_000_000 + nsec, message.time_ns);
        for (leaf, number) in channel.numbers.iter().zip(&message.numbers) {
            let back = at(&json, &leaf.path).as_f64().unwrap();
            let what = format!("{} {}", channel.topic, leaf.path);
            assert_eq!(back.to_bits(), number.to_bits(), "{what}");
        }
        for (leaf, text) in channel.texts.iter().zip(&message.texts) {
            assert_eq!(at(&json, &leaf.path), text);
        }
        seen[message.channel] += 1;
    }
    assert!(seen.iter().all(|count| *count > 0), "{seen:?}");
}

#[test]
fn messages_are_ordered_by_time() {
    let sink = short_run(&[("sampling.period", "0.0003")]);
    let times: Vec<_> = sink.messages.iter().map(|m| m.time_ns).collect();
    assert!(times.is_sorted());
    let states: Vec<_> = sink.messages.iter().filter(|m| m.channel == 0).collect();
    for (i, message) in states.iter().enumerate() {
        assert_eq!(message.time_ns, i as u64 * 300_000);
        assert_eq!(message.sequence as usize, i);
    }
    assert_eq!(states.len(), 667);
}

#[test]
fn digest_ignores_channel_order() {
    let sink = short_run(&[("stop.duration", "0.05")]);
    let digest = |messages: &[Owned]| {
        let mut digest = ContentDigest::default();
        for message in messages {
            digest.update(&message.as_message());
        }
        digest.finish()
    };
    let original = digest(&sink.messages);
    assert_eq!(original, sink.digest.finish());
    let mut by_channel = sink.messages.clone();
    by_channel.sort_by_key(|message| message.channel);
    assert_eq!(digest(&by_channel), original);

    for i in [0, 1, 17, sink.messages.len() - 1] {
        let mut changed = sink.messages.clone();
        let number = &mut changed[i].numbers[0];
        *number = f64::from_bits(number.to_bits() ^ 1);
        assert_ne!(digest(&changed), original);
        let mut changed = sink.messages.clone();
        changed[i].time_ns += 1;
        assert_ne!(digest(&changed), original);
        let mut changed = sink.messages.clone();
        changed.remove(i);
        assert_ne!(digest(&changed), original);
    }
}

#[test]
fn skips_unselected_topics() {
    let scenario = scenario("paper", &[("stop.duration", "0.1")]);
    let mut run = RunMessages::new(&scenario, &Topics::Only(vec![STATE, EVENTS])).unwrap();
    let mut sink = MemorySink::default();
    record_all(&mut run, &mut [&mut sink]).unwrap();
    let seen = sink.messages.iter().map(|m| channels()[m.channel].topic);
    let seen: BTreeSet<_> = seen.collect();
    assert_eq!(seen, BTreeSet::from(["/events", "/top/state"]));
}
