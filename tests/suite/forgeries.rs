//! Forgeries with recomputed checksums, indexes and digests: `verify` detects any change in what people or viewers
//! read, except the name and description of the scenario. Repacking the same content is not a forgery, nor is anything
//! that all readers skip.

pub mod forgery;

use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use forgery::{Change, END, Forgery, RUN, Raw, Record, body, edit, framed, metadata, named};
use mcap::records::{Header, MessageHeader, Metadata, SchemaHeader, op};
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::rc::Rc;
use toprise::archive::recording::{Condition, Recording};
use toprise::archive::verify::{Equality, Report, Verdict, verify};
use toprise::archive::writer::Form;
use toprise::run::scenario::Scenario;
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::views::{VIEW_CHANNELS, ViewChannel};

/// The verdict on a forgery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expected {
    /// Neither verified nor packed otherwise.
    Caught,
    /// Packed otherwise: it holds what its scenario gives.
    Repacked,
    /// It can't be opened.
    Unreadable,
}
use Expected::{Caught, Repacked, Unreadable};

/// The verdict on a file, and the difference that was found.
fn judge(path: &Path) -> (Expected, String) {
    let recording = match Recording::open(path) {
        Ok(recording) => recording,
        Err(error) => return (Unreadable, error.to_string()),
    };
    let report = match verify(&recording, &|_| {}) {
        Ok(report) => report,
        Err(error) => return (Unreadable, error.to_string()),
    };
    let found = match report.verdict {
        Verdict::Verified => Repacked,
        Verdict::Incomplete | Verdict::Different => Caught,
    };
    (found, format!("{report:?}"))
}

fn original(encoding: Encoding) -> Vec<u8> {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let views = true;
    recorded(&scenario, &[], Form { encoding, views })
}

/// Attempts to forge a recording.
struct Attempts {
    /// Recordings of one run, without and with supplements: those change no verdict.
    originals: [Forgery; 2],
    folder: Folder,
    /// The attempts with another verdict than expected.
    surprises: Vec<String>,
}

impl Attempts {
    fn judge(&mut self, name: &str, expected: Expected, forge: impl Fn(&mut Forgery)) {
        let path = self.folder.at("forged.mcap");
        for original in &self.originals {
            let mut forgery = original.clone();
            forge(&mut forgery);
            forgery.write(&path);
            let (found, report) = judge(&path);
            if found != expected {
                self.surprises.push(format!("{name}: {found:?}, {report}"));
            }
        }
    }

    fn caught(&mut self, name: &str, forge: impl Fn(&mut Forgery)) {
        self.judge(name, Caught, forge);
    }

    fn repacked(&mut self, name: &str, forge: impl Fn(&mut Forgery)) {
        self.judge(name, Repacked, forge);
    }

    /// Changes all messages of a topic.
    fn messages(
        &mut self,
        name: &str,
        topic: &str,
        change: impl Fn(&mut MessageHeader, &mut Vec<u8>),
    ) {
        self.caught(name, |f| f.messages(topic, &change));
    }

    /// Changes the text of the JSON message with a number.
    fn edit(&mut self, name: &str, topic: &str, number: u32, change: impl Fn(&str) -> String) {
        self.caught(name, |f| f.edit(topic, number, &change));
    }

    /// Changes the schema of a topic.
    fn schema(
        &mut self,
        name: &str,
        topic: &str,
        change: impl Fn(&mut SchemaHeader, &mut Vec<u8>),
    ) {
        self.caught(name, |f| f.schema(topic, &change));
    }

    /// Changes the records after each chunk, which index it.
    fn indexes(&mut self, name: &str, change: impl Fn(&mut Vec<Raw>) + 'static) {
        let change: Change<_> = Rc::new(change);
        self.caught(name, |f| f.indexes = change.clone());
    }

    /// Changes the offsets of the summary, which no reader needs.
    fn offsets(&mut self, name: &str, change: impl Fn(&mut Vec<Raw>) + 'static) {
        let change: Change<_> = Rc::new(change);
        self.repacked(name, |f| f.offsets = change.clone());
    }
}

/// Tries forgeries of a recording.
fn try_all(encoding: Encoding, forge: impl FnOnce(&mut Attempts)) {
    let plain = Forgery::of(&original(encoding));
    let mut with_supplements = plain.clone();
    with_supplements.add_supplements();
    let mut attempts = Attempts {
        originals: [plain, with_supplements],
        folder: Folder::new(),
        surprises: Vec::new(),
    };
    forge(&mut attempts);
    let surprises = attempts.surprises;
    assert!(surprises.is_empty(), "{}", surprises.join("\n"));
}

/// Makes another number of the last one, or of its last digit.
#[allow(clippy::ptr_arg, reason = "a change of messages")]
fn other_number(_: &mut MessageHeader, data: &mut Vec<u8>) {
    if let Some(byte) = data.last_mut() {
        *byte ^= 1;
    }
}

fn views_of_fixed_peg() -> impl Iterator<Item = &'static ViewChannel> {
    VIEW_CHANNELS.iter().filter(|view| !view.is_free_peg_only)
}

fn leave_out_views(forgery: &mut Forgery) {
    for view in views_of_fixed_peg() {
        forgery.leave_out(view.topic);
    }
}

/// Puts the index of the last chunk after the other groups of the summary.
fn split_chunk_indexes(forgery: &mut Forgery) {
    forgery.order = Rc::new(|summary| {
        let is_index = |(opcode, _): &Raw| *opcode == op::CHUNK_INDEX;
        let last = summary.iter().rposition(is_index);
        let index = summary.remove(last.unwrap());
        summary.push(index);
    });
}

fn zstd(bytes: &[u8]) -> Vec<u8> {
    zstd::bulk::compress(bytes, 1).unwrap()
}

fn lz4(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Compresses both halves.
fn in_two(bytes: &[u8], compress: fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let (one, two) = bytes.split_at(bytes.len() / 2);
    [compress(one), compress(two)].concat()
}

fn find(bytes: &[u8], part: &[u8]) -> Option<usize> {
    bytes.windows(part.len()).position(|found| found == part)
}

/// An unknown record.
fn unknown() -> Raw {
    (0x80, b"by me".to_vec())
}

/// A record with bytes after its fields.
fn with_more(record: &Record) -> Record {
    let (opcode, body) = record.raw();
    Record::Other((opcode, [&body, &b"by me"[..]].concat()))
}

#[test]
fn rejects_forged_metadata() {
    try_all(Encoding::Json, |a| {
        a.repacked("written anew", |_| {});
        // The record toprise.run.
        for (name, key, value) in [
            ("another law", "friction_law", "viscous"),
            ("another formulation", "formulation", "body"),
            ("another name", "scenario", "best top ever"),
            ("another epoch", "epoch", "1970-01-01"),
            ("another period", "sample_period_ns", "2000000"),
            ("another digest", "scenario_digest", "00"),
            ("another key", "measured_at", "MIT"),
        ] {
            a.caught(name, |f| f.set(RUN, key, value));
        }
        for (name, version) in [
            ("no version", "by the author himself"),
            ("another version", "0.0.9"),
        ] {
            // Whoever recorded them, the values are those of the scenario.
            a.repacked(name, |f| f.set(RUN, "version", version));
        }
        a.caught("a key is missing", |f| {
            f.entries(RUN).remove("friction_law").unwrap();
        });
        a.caught("a key twice", |f| {
            f.set(RUN, "Friction_law", "viscous");
            f.written = Rc::new(|(_, body)| {
                if let Some(at) = find(body, b"Friction_law") {
                    body[at] = b'f';
                }
            });
        });
        a.judge("a second toprise.run", Unreadable, |f| {
            f.add(RUN, &[("friction_law", "viscous")]);
        });
        a.caught("no toprise.run", |f| f.drop(named(RUN)));
        // The record toprise.end.
        for (name, key, value) in [
            ("another end", "stop_reason", "risen"),
            ("another time of the end", "stop_time", "0.051"),
            ("other steps", "steps_accepted", "7"),
            ("other largest step", "largest_step", "1.0"),
            ("another key at the end", "winner", "paper"),
        ] {
            a.caught(name, |f| f.set(END, key, value));
        }
        let end_early = |f: &mut Forgery, reason: &str| {
            f.set(END, "stop_reason", reason);
            f.drop_messages(|message| message.log_time > 30_000_000);
        };
        a.caught("an end that failed", |f| {
            end_early(f, "failed");
            f.set(END, "stop_time", "0.03");
        });
        a.caught("an end that was interrupted", |f| {
            end_early(f, "interrupted");
        });
        a.caught("another key at an interrupted end", |f| {
            end_early(f, "interrupted");
            f.set(END, "winner", "paper");
        });
        for (name, key, value) in [
            ("another content digest", "content_digest", "00"),
            ("another count of samples", "samples", "52"),
        ] {
            a.caught(name, |f| {
                f.is_digest_right = false;
                f.set(END, key, value);
            });
        }
        a.caught("a second toprise.end", |f| {
            f.add(END, &[("stop_reason", "risen")]);
        });
        let recovery = |f: &mut Forgery| f.add("toprise.recovery", &[("lost", "a dog ate it")]);
        a.caught("a recovery", recovery);
        a.caught("a second recovery", |f| {
            recovery(f);
            f.add("toprise.recovery", &[("lost", "nothing")]);
        });
        a.caught("a recovery with another end", |f| {
            recovery(f);
            f.set(END, "steps_accepted", "7");
        });
        // The scenario.
        a.caught("another scenario", |f| {
            let toml = f.edit_scenario("\nk = 0.03", "\nk = 0.029");
            let scenario = Scenario::from_toml(&toml).unwrap();
            f.set(RUN, "scenario_digest", &scenario.digest());
        });
        a.judge("a second scenario", Unreadable, |f| {
            f.attach(|_, toml| *toml = b"name = \"another\"".to_vec());
        });
        a.caught("the scenario as another type", |f| {
            f.scenario().media_type = "text/html".to_owned();
        });
        a.caught("the scenario made today", |f| {
            f.scenario().create_time = 1_700_000_000_000_000_000;
        });
        a.caught("the scenario logged later", |f| f.scenario().log_time = 7);
        a.repacked("another description", |f| {
            let changed = "description = \"Measured, not simulated. ";
            f.edit_scenario("description = \"", changed);
        });
        a.caught("a comment", |f| {
            f.edit_scenario("\n[top]", "  # as measured by the author\n[top]");
        });
        // Supplements say nothing of the run.
        for name in ["notes.txt", "", "scenario.toml ", "Toprise.run"] {
            a.repacked(name, |f| {
                f.attach(|header, _| header.name = name.to_owned());
            });
            a.repacked(name, |f| f.add(name, &[("place", "MIT")]));
        }
        a.caught("an attachment with a reserved name", |f| {
            f.attach(|header, _| header.name = "toprise.scenario".to_owned());
        });
        a.caught("metadata that is called almost like ours", |f| {
            f.add("toprise.run ", &[("friction_law", "viscous")]);
        });
        a.repacked("the end first", |f| f.shift(0, named(END)));
        a.repacked("the run last", |f| f.shift(usize::MAX, named(RUN)));
        a.repacked("the scenario last", |f| {
            f.shift(usize::MAX, |r| matches!(r, Record::Attachment(..)));
        });
        // The header.
        for (name, library) in [
            ("no library", ""),
            ("no version of toprise", "toprise/best"),
            ("another library", "somebody"),
            ("another version wrote it", "toprise/9.9.9"),
        ] {
            a.repacked(name, |f| f.header.library = library.to_owned());
        }
        a.repacked("another version wrote and simulated it", |f| {
            f.header.library = "toprise/9.9.9".to_owned();
            f.set(RUN, "version", "9.9.9");
        });
        a.caught("a profile", |f| f.header.profile = "ros2".to_owned());
    });
}

#[test]
fn rejects_forged_channels_and_schemas() {
    try_all(Encoding::Json, |a| {
        for (name, topic, key, value) in [
            ("metadata of a channel", "/top/state", "unit", "degrees"),
            ("metadata of a view", "/tf", "offered_qos_profiles", ""),
        ] {
            let entry = (key.to_owned(), value.to_owned());
            a.caught(name, |f| {
                f.channel(topic, |c| c.metadata.extend([entry.clone()]));
            });
        }
        a.caught("swapped schemas of views", |f| {
            let (tf, log) = (f.id("/tf").1, f.id("/log").1);
            f.channel("/tf", |channel| channel.schema_id = log);
            f.channel("/log", |channel| channel.schema_id = tf);
        });
        a.caught("swapped views", |f| {
            for (from, to) in [
                ("/view/spin_rate", "swap"),
                ("/view/precession_rate", "/view/spin_rate"),
                ("swap", "/view/precession_rate"),
            ] {
                f.channel(from, |channel| channel.topic = to.to_owned());
            }
        });
        let inclination = "/view/inclination";
        a.schema("a view with another definition", inclination, |_, data| {
            edit(data, |text| {
                let swapped = text.replace("position", "swap");
                let swapped = swapped.replace("velocity", "position");
                swapped.replace("swap", "velocity")
            });
        });
        for (name, topic, encoding) in [
            ("a view with another encoding", "/tf", "ros1"),
            ("another encoding", "/top/state", "cbor"),
            ("several encodings", "/top/state", "protobuf"),
        ] {
            a.caught(name, |f| {
                f.channel(topic, |c| c.message_encoding = encoding.to_owned());
            });
        }
        for (name, expected, like, topic) in [
            ("a channel of others", Caught, "/top/state", "/speed"),
            ("a view twice", Repacked, "/tf", "/tf"),
            ("a channel twice", Repacked, "/top/state", "/top/state"),
        ] {
            a.judge(name, expected, |f| {
                let another = f.another(like, topic);
                f.first_chunk().push(another);
            });
        }
        a.schema("another name of a schema", "/top/state", |schema, _| {
            schema.name = "toprise.Speed".to_owned();
        });
        a.schema("another language of a schema", "/top/state", |schema, _| {
            schema.encoding = "json".to_owned();
        });
        a.schema("another unit in a schema", "/top/state", |_, data| {
            edit(data, |text| text.replace("[rad]", "[degrees]"));
        });
        a.caught("a channel without schema", |f| {
            f.channel("/tf", |channel| channel.schema_id = 0);
        });
        a.caught("a schema with the number 0", |f| {
            let (_, schema) = f.id("/tf");
            f.each(|record| match record {
                Record::Schema(header, _) if header.id == schema => header.id = 0,
                Record::Channel(channel) if channel.schema_id == schema => channel.schema_id = 0,
                _ => {}
            });
        });
        a.repacked("a channel again", |f| {
            let channel = f.like("/tf", |_| {});
            f.last_chunk().insert(0, channel);
        });
        a.repacked("a schema again", |f| {
            let schema = f.first_schema();
            f.last_chunk().insert(0, schema);
        });
        a.repacked("a channel outside of chunks", |f| {
            let channel = f.like("/tf", |_| {});
            f.records.insert(3, channel);
        });
        a.caught("a schema that nothing uses", |f| {
            let schema = SchemaHeader {
                id: 99,
                name: "toprise.Heat".to_owned(),
                encoding: "jsonschema".to_owned(),
            };
            let schema = Record::Schema(schema, b"{}".to_vec());
            f.first_chunk().insert(0, schema);
        });
        a.caught("a schema that nothing uses, like one that is used", |f| {
            let mut schema = f.first_schema();
            if let Record::Schema(header, _) = &mut schema {
                header.id = 99;
            }
            f.first_chunk().insert(0, schema);
        });
        a.caught("other channels in the summary", |f| {
            f.in_summary(op::CHANNEL, |channel| {
                // In place of its empty metadata.
                let entries = body(&Metadata {
                    name: String::new(),
                    metadata: [("unit".to_owned(), "degrees".to_owned())].into(),
                });
                channel.truncate(channel.len() - 4);
                channel.extend(&entries[4..]);
            });
        });
        a.caught("other schemas in the summary", |f| {
            f.in_summary(op::SCHEMA, |schema| *schema.last_mut().unwrap() = b' ');
        });
        a.caught("a channel that the summary lacks", |f| {
            f.not_in_summary(op::CHANNEL);
        });
        a.caught("a channel in the summary alone", |f| {
            f.summary = Rc::new(|summary| {
                let channel = summary.iter().rfind(|raw| raw.0 == op::CHANNEL);
                let mut channel = channel.unwrap().clone();
                channel.1[0] = 99;
                summary.push(channel);
            });
        });
        a.caught("a channel that was dropped", |f| f.leave_out("/top/energy"));
        a.repacked("a dropped channel, declared", |f| {
            f.leave_out("/top/energy");
            let others = "/top/state,/top/pose,/top/torque,/top/acceleration,/top/contact,/top/momentum,\
                          /top/precession,/top/nutation,/events";
            f.set(RUN, "topics", others);
        });
        a.caught("a view that was dropped", |f| f.leave_out("/tf"));
        a.caught("views that were dropped", leave_out_views);
        a.repacked("no views, declared", |f| {
            leave_out_views(f);
            f.set(RUN, "views", "no");
        });
        for (name, key, value) in [
            ("undeclared views", "views", "no"),
            ("undeclared topics", "topics", "/events"),
            ("another declared encoding", "encoding", "protobuf"),
            ("an unknown encoding", "encoding", "by hand"),
        ] {
            a.caught(name, |f| f.set(RUN, key, value));
        }
        a.caught("a channel added to the last chunk", |f| {
            let added = f.another("/top/energy", "/more");
            f.last_chunk().push(added);
        });
        a.caught("an added channel that the summary lacks", |f| {
            let added = f.another("/top/energy", "/more");
            f.last_chunk().push(added);
            f.summary = Rc::new(|summary| {
                summary.retain(|(opcode, body)| *opcode != op::CHANNEL || body[..2] != [99, 0]);
            });
        });
        a.caught("another definition in the last chunk", |f| {
            let other = f.like("/top/energy", |channel| channel.topic = "/more".to_owned());
            f.last_chunk().push(other);
        });
        a.repacked("a definition just before its first message", |f| {
            let definition = f.like("/top/nutation", |_| {});
            let (id, _) = f.id("/top/nutation");
            f.drop(|r| matches!(r, Record::Channel(channel) if channel.id == id));
            let is_of = |r: &Record| matches!(r, Record::Message(m, _) if m.channel_id == id);
            let found = f.records.iter_mut().find_map(|record| match record {
                Record::Chunk(chunk) if chunk.iter().any(is_of) => Some(chunk),
                _ => None,
            });
            found.unwrap().insert(0, definition);
        });
        a.caught("a message at the last possible time", |f| {
            f.messages("/top/energy", |message, _| {
                if message.sequence == 50 {
                    message.log_time = u64::MAX;
                }
            });
        });
        a.caught("a channel whose messages were dropped", |f| {
            let (id, _) = f.id("/top/energy");
            f.drop_messages(|message| message.channel_id == id);
        });
    });
}

#[test]
fn rejects_forged_messages() {
    try_all(Encoding::Json, |a| {
        a.messages("a publish time", "/top/state", |m, _| m.publish_time += 1);
        a.messages("a publish time of a view", "/tf", |m, _| m.publish_time = 0);
        a.messages("a time of a view", "/view/spin_rate", |message, _| {
            message.log_time += 1;
            message.publish_time += 1;
        });
        for (name, from, to) in [
            ("a number", r#""theta":0."#, r#""theta":0.1"#),
            ("spaces", ":", ": "),
            ("a member twice", r#""theta":"#, r#""theta":1.5,"theta":"#),
            ("another member", r#""theta":"#, r#""heat":1.5,"theta":"#),
        ] {
            a.edit(name, "/top/state", 7, |text| text.replacen(from, to, 1));
        }
        a.edit("a text", "/events", 0, |text| {
            text.replace("start", "risen")
        });
        a.edit("escaped letters", "/events", 0, |text| {
            text.replacen("start", "\\u0073tart", 1)
        });
        a.messages("a number of a view", "/view/slip_speed", other_number);
        a.messages("the words of a view", "/robot_description", |_, data| {
            let at = find(data, b"top");
            data[at.unwrap()] = b'h';
        });
        a.edit("more digits than count", "/top/energy", 7, |text| {
            let at = text.find("\"potential\":").unwrap() + 12;
            let end = at + text[at..].find([',', '}']).unwrap();
            format!("{}0000000001{}", &text[..end], &text[end..])
        });
        a.edit("members in another order", "/top/state", 7, |text| {
            let (stamp, rest) = text[1..text.len() - 1].split_once("},").unwrap();
            format!("{{{rest},{stamp}}}}}")
        });
        a.messages("a sequence number", "/events", |message, _| {
            if message.sequence > 0 {
                message.sequence += 1;
            }
        });
        a.messages("a sequence number of a view", "/tf", |m, _| m.sequence += 1);
        a.caught("messages dropped at the end", |f| {
            f.drop_messages(|message| message.log_time > 40_000_000);
        });
        a.caught("messages dropped in between", |f| {
            f.drop_messages(|message| message.log_time == 40_000_000);
        });
        a.caught("a message of a view dropped", |f| {
            let (id, _) = f.id("/tf");
            f.drop_messages(|m| m.channel_id == id && m.log_time == 40_000_000);
        });
        a.caught("a message twice", |f| {
            let chunk = f.last_chunk();
            chunk.push(chunk.last().unwrap().clone());
        });
        a.caught("a message out of order", |f| {
            let chunk = f.last_chunk();
            let last = chunk.pop().unwrap();
            chunk.insert(0, last);
        });
        a.repacked("another order at one time", |f| {
            f.reorder(|message| std::cmp::Reverse(message.channel_id));
        });
        a.repacked("views after the rest", |f| {
            let views: Vec<_> = views_of_fixed_peg().map(|v| f.id(v.topic).0).collect();
            f.reorder(|message| views.contains(&message.channel_id));
        });
        a.caught("a message of no channel", |f| {
            let chunk = f.last_chunk();
            let Some(Record::Message(mut last, data)) = chunk.last().cloned() else {
                panic!("a chunk ends with a message");
            };
            last.channel_id = 99;
            chunk.push(Record::Message(last, data));
        });
    });
    try_all(Encoding::Protobuf, |a| {
        a.repacked("written anew", |_| {});
        a.messages("a field twice", "/top/energy", |_, data| {
            data.extend_from_within(data.len() - 9..);
        });
        // Field 99, a varint.
        a.messages("an unknown field", "/top/energy", |_, data| {
            data.extend([0x98, 0x06, 1]);
        });
        a.messages("a number", "/top/energy", other_number);
        a.schema("another unit in a schema", "/top/energy", |_, data| {
            let at = find(data, b"kine");
            data[at.unwrap()] = b'K';
        });
    });
}

#[test]
fn rejects_containers_that_readers_see_differently() {
    try_all(Encoding::Json, |a| {
        a.caught("a message outside of chunks", |f| {
            let last = f.last_chunk().pop().unwrap();
            let at = f.records.len() - 1;
            f.records.insert(at, last);
        });
        a.repacked("an unknown record", |f| {
            f.records.insert(1, Record::Other(unknown()));
        });
        a.repacked("an unknown record in a chunk", |f| {
            f.last_chunk().push(Record::Other(unknown()));
        });
        a.repacked("an unknown record in the summary", |f| {
            f.summary = Rc::new(|summary| summary.push(unknown()));
        });
        a.repacked("an empty chunk", |f| {
            f.records.insert(2, Record::Chunk(Vec::new()));
        });
        a.caught("bytes after metadata and not indexed", |f| {
            f.records[0] = with_more(&f.records[0]);
        });
        a.caught("bytes after a schema in a chunk and not indexed", |f| {
            let first = &mut f.first_chunk()[0];
            *first = with_more(first);
        });
        a.caught("metadata in the summary", |f| {
            f.summary = Rc::new(|summary| summary.push(metadata("by me", &[]).raw()));
        });
        a.caught("a second header", |f| {
            let header = Header {
                profile: "ros2".to_owned(),
                library: "toprise/0.1.0".to_owned(),
            };
            f.records
                .insert(1, Record::Other((op::HEADER, body(&header))));
        });
        a.judge("bytes before the magic", Unreadable, |f| {
            f.before_magic = b"by me".to_vec();
        });
        for (name, bytes) in [
            ("a record after the footer", framed(&unknown())),
            ("a second footer", framed(&(op::FOOTER, vec![0; 20]))),
            ("bytes after the footer", b"by me".to_vec()),
        ] {
            a.caught(name, |f| f.before_last_magic = bytes.clone());
        }
        for (name, opcode) in [
            ("a chunk indexed twice", op::CHUNK_INDEX),
            ("an index twice", op::METADATA_INDEX),
        ] {
            a.caught(name, |f| f.twice_in_summary(opcode));
        }
        a.repacked("equal statistics twice", |f| {
            f.twice_in_summary(op::STATISTICS);
        });
        for (name, opcode) in [
            ("a chunk not indexed", op::CHUNK_INDEX),
            ("metadata not indexed", op::METADATA_INDEX),
            ("a channel not in the summary", op::CHANNEL),
        ] {
            a.caught(name, |f| f.not_in_summary(opcode));
        }
        a.repacked("no statistics", |f| f.not_in_summary(op::STATISTICS));
        a.repacked("no index of attachments", |f| {
            f.summary = Rc::new(|summary| summary.retain(|raw| raw.0 != op::ATTACHMENT_INDEX));
        });
        a.caught("another compression", |f| {
            f.in_summary(op::CHUNK_INDEX, |index| {
                let at = index.len() - 20;
                index.splice(at..at + 4, *b"\x04\0\0\0zstd");
            });
        });
        for (name, opcode, last) in [
            ("another size of a chunk", op::CHUNK_INDEX, 1),
            (
                "another media type in the index",
                op::ATTACHMENT_INDEX,
                b'x',
            ),
            ("another name in the index", op::METADATA_INDEX, b'x'),
            ("other counts of channels", op::STATISTICS, 1),
        ] {
            a.caught(name, |f| {
                f.in_summary(opcode, move |body| *body.last_mut().unwrap() = last);
            });
        }
        for (name, opcode, at) in [
            ("other times of a chunk", op::CHUNK_INDEX, 8),
            ("other statistics", op::STATISTICS, 0),
            ("another end in the statistics", op::STATISTICS, 34),
        ] {
            a.caught(name, |f| f.in_summary(opcode, move |body| body[at] ^= 1));
        }
        a.offsets("an offset that leads elsewhere", |o| o[0].1[1] ^= 1);
        a.offsets("an offset to a part of its group", |offsets| {
            let length = u64::from_le_bytes(offsets[0].1[9..].try_into().unwrap());
            offsets[0].1[9..].copy_from_slice(&(length / 2).to_le_bytes());
        });
        a.indexes("an index without some messages", |indexes| {
            let (_, body) = &mut indexes[0];
            let length = u32::from_le_bytes(body[2..6].try_into().unwrap()) - 16;
            body[2..6].copy_from_slice(&length.to_le_bytes());
            body.truncate(body.len() - 16);
        });
        a.indexes("a channel without index", |indexes| drop(indexes.remove(0)));
        a.indexes("an empty index after the right one", |indexes| {
            let channel = indexes[0].1[..2].to_vec();
            indexes.push((op::MESSAGE_INDEX, [channel, vec![0; 4]].concat()));
        });
        a.repacked("an empty index of a channel that has nothing there", |f| {
            f.indexes = Rc::new(|indexes| {
                indexes.push((op::MESSAGE_INDEX, vec![0x0f, 0x27, 0, 0, 0, 0]));
            });
        });
        a.indexes("metadata between a chunk and its indexes", |indexes| {
            indexes.insert(0, metadata("by me", &[]).raw());
        });
        a.repacked("two zstd frames", |f| {
            f.pack("zstd", |bytes| in_two(bytes, zstd));
        });
        a.repacked("a zstd frame that is skipped", |f| {
            let hidden = [0x50, 0x2a, 0x4d, 0x18, 2, 0, 0, 0, b'm', b'e'];
            f.pack("zstd", move |bytes| [&zstd(bytes)[..], &hidden].concat());
        });
        a.repacked("two lz4 frames", |f| {
            f.pack("lz4", |bytes| in_two(bytes, lz4));
        });
        a.repacked("an lz4 frame that is skipped", |f| {
            let hidden = [0x50, 0x2a, 0x4d, 0x18, 2, 0, 0, 0, b'm', b'e'];
            f.pack("lz4", move |bytes| [&hidden[..], &lz4(bytes)].concat());
        });
        for (name, pack) in [("zstd", zstd as fn(&[u8]) -> Vec<u8>), ("lz4", lz4)] {
            a.repacked("a padded frame", |f| {
                f.pack(name, move |bytes| [&pack(bytes)[..], &[0; 5]].concat());
            });
        }
        a.repacked("one zstd frame", |f| f.pack("zstd", zstd));
        a.repacked("one lz4 frame", |f| f.pack("lz4", lz4));
        a.caught("an lz4 frame without its end mark", |f| {
            f.pack("lz4", |bytes| {
                let mut frame = lz4(bytes);
                frame.truncate(frame.len() - 4);
                frame
            });
        });
        a.repacked("no checksums of chunks", |f| {
            f.written = Rc::new(|(opcode, body)| {
                if *opcode == op::CHUNK {
                    body[24..28].fill(0);
                }
            });
        });
        a.repacked("no checksum of an attachment", |f| {
            f.written = Rc::new(|(opcode, body)| {
                if *opcode == op::ATTACHMENT {
                    let at = body.len() - 4;
                    body[at..].fill(0);
                }
            });
        });
        a.offsets("empty offsets", |offsets| {
            for (_, body) in offsets {
                body[9..].fill(0);
            }
        });
        a.offsets("an offset of an unknown kind", |offsets| {
            let mut more = offsets[0].clone();
            more.1[0] = 200;
            more.1[9..].fill(0);
            offsets.push(more);
        });
        a.offsets("no offsets", Vec::clear);
        a.offsets("offsets that lack groups", |offsets| offsets.truncate(2));
        a.repacked("a group in two parts", split_chunk_indexes);
        a.repacked("a group in two parts, of which one has an offset", |f| {
            split_chunk_indexes(f);
            f.offsets = Rc::new(|offsets| drop(offsets.pop()));
        });
        a.offsets("offsets twice", |offsets| offsets.extend(offsets.clone()));
        a.repacked("a footer that leads to the second offset", |f| {
            f.offsets_start = Rc::new(|start| *start += 26);
        });
        a.repacked("a footer without offsets", |f| {
            f.offsets_start = Rc::new(|start| *start = 0);
        });
        a.indexes("an index with other times", |indexes| indexes[0].1[6] ^= 1);
    });
}

#[test]
fn rejects_forged_library_version() {
    try_all(Encoding::Protobuf, |a| {
        a.repacked("an old version", |f| {
            let of_form = ["telemetry", "encoding", "views", "topics"];
            f.entries(RUN)
                .retain(|key, _| !of_form.contains(&key.as_str()));
            f.set(RUN, "version", "0.1.0");
        });
        for (name, telemetry) in [
            ("an old telemetry", "1"),
            ("no telemetry", "best"),
            ("a newer telemetry", "1000"),
        ] {
            // The values are those of the scenario, whoever recorded them.
            a.repacked(name, |f| f.set(RUN, "telemetry", telemetry));
        }
        a.caught("a newer telemetry with another number", |f| {
            f.set(RUN, "telemetry", "1000");
            f.messages("/top/energy", other_number);
        });
        a.caught("a newer telemetry with an inversion", |f| {
            f.set(RUN, "telemetry", "1000");
            f.set(END, "inversion_time", "0.01");
        });
        a.caught("a newer telemetry in another encoding", |f| {
            f.set(RUN, "telemetry", "1000");
            f.set(RUN, "encoding", "json");
        });
    });
}

/// The report on a forged recording.
fn report(forgery: &Forgery) -> Report {
    let folder = Folder::new();
    let path = folder.at("a.mcap");
    forgery.clone().write(&path);
    verified(&path)
}

#[track_caller]
fn assert_verdict(forgery: &Forgery, expected: Verdict) {
    let report = report(forgery);
    assert_eq!(report.verdict, expected, "{report:#?}");
}

#[test]
fn compares_other_telemetry_by_field_names() {
    let mut forgery = Forgery::of(&original(Encoding::Json));
    forgery.set(RUN, "telemetry", "1000");
    // Another field in the place of one, and a topic less.
    let renamed = |data: &mut _| edit(data, |text| text.replace("\"potential\"", "\"novel\""));
    forgery.schema("/top/energy", |_, data| renamed(data));
    forgery.messages("/top/energy", |_, data| renamed(data));
    forgery.leave_out("/top/contact");
    // What isn't known can't be compared.
    assert_verdict(&forgery, Verdict::Incomplete);
    assert_eq!(report(&forgery).unknown, ["/top/energy: novel"]);
    forgery.edit("/top/energy", 7, |text| {
        text.replace("\"kinetic\":1.", "\"kinetic\":2.")
    });
    assert_verdict(&forgery, Verdict::Different);
}

#[test]
fn truncated_runs_are_not_verified() {
    let mut forgery = Forgery::of(&original(Encoding::Json));
    forgery.drop(named(END));
    assert_verdict(&forgery, Verdict::Incomplete);
}

/// Readers that follow the index would see other things than those that follow the data, however much of the run is there.
#[test]
fn rejects_contradictory_index_of_partial_runs() {
    let parts: [fn(&mut Forgery); 3] = [
        |f| f.drop(named(END)),
        |f| {
            f.is_digest_right = false;
            f.last_chunk().pop();
        },
        |f| f.set(RUN, "version", "0.1.9"),
    ];
    for part in parts {
        let mut forgery = Forgery::of(&original(Encoding::Json));
        part(&mut forgery);
        let report = report(&forgery);
        assert_ne!(report.verdict, Verdict::Different, "{report:#?}");
        forgery.in_summary(op::CHUNK_INDEX, |index| *index.last_mut().unwrap() = 1);
        assert_verdict(&forgery, Verdict::Different);
    }
}

/// Python's `mcap` writes no checksum of the data unless it is asked to.
#[test]
fn accepts_missing_data_checksum() {
    let folder = Folder::new();
    let path = folder.at("a.mcap");
    let mut bytes = original(Encoding::Json);
    // The footer's first number says where the summary begins: after the checksum.
    let footer = bytes.len() - mcap::MAGIC.len() - 20;
    let summary = u64::from_le_bytes(bytes[footer..footer + 8].try_into().unwrap()) as usize;
    bytes[summary - 4..summary].fill(0);
    fs::write(&path, &bytes).unwrap();
    assert_eq!(verified(&path).equality, Some(Equality::PackedOtherwise));
    bytes[summary - 4] = 1;
    fs::write(&path, &bytes).unwrap();
    let report = verified(&path);
    assert_eq!(report.verdict, Verdict::Incomplete);
    assert_eq!(report.state, Condition::Damaged);
    assert_contains(
        &report.losses[0].reason,
        "the checksum of the data is wrong",
    );
}

/// A text of megabytes is no scenario, and is not given to a parser.
#[test]
fn bounds_the_scenario_size() {
    let folder = Folder::new();
    let path = folder.at("a.mcap");
    let mut forgery = Forgery::of(&original(Encoding::Json));
    *forgery.toml() = vec![b' '; 2 << 20];
    fs::write(&path, forgery.bytes()).unwrap();
    let recording = Recording::open(&path).unwrap();
    let reason = recording.scenario_text().unwrap_err().to_string();
    assert_contains(&reason, "it is longer than");
}
