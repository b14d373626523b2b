//! Setup differences: scenario keys and file content except messages.

use crate::analysis::subject::Subject;
use crate::archive::recording::Recording;
use crate::run::scenario::{KEYS, Value};
use crate::words::plural;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The differences in the set-up of two runs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SetupDifferences {
    /// Keys of the scenarios that differ.
    pub scenario: Vec<KeyDifference>,
    /// Number of equal keys of the scenarios.
    pub equal_keys: u64,
    /// Differences of the files: what wrote them, encoding, metadata, schemas, attachments. Empty unless both are recordings.
    pub files: Vec<KeyDifference>,
    /// Topics that only A and only B has.
    pub topics_only_in: [Vec<String>; 2],
    /// Fields that only A and only B has.
    pub fields_only_in: [Vec<String>; 2],
}

impl SetupDifferences {
    /// Whether neither scenarios nor files differ, except in messages.
    pub(super) fn is_same(&self) -> bool {
        self.files.is_empty() && self.scenario.is_empty()
    }
}

/// A key that differs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct KeyDifference {
    /// The key.
    pub key: String,
    /// The unit, empty for pure numbers and words.
    pub unit: String,
    /// A's value; absent if it has none.
    pub a: Option<String>,
    /// B's value; absent if it has none.
    pub b: Option<String>,
}

impl KeyDifference {
    /// Whether the key affects the simulation (all except name and description).
    pub fn changes_the_run(&self) -> bool {
        !["name", "description"].contains(&self.key.as_str())
    }
}

/// Keys, each with its value as text.
type Flat = BTreeMap<String, String>;

pub(super) fn compare(
    [a, b]: [Subject<'_>; 2],
    topics_only_in: [Vec<String>; 2],
) -> SetupDifferences {
    let mut setup = SetupDifferences {
        topics_only_in,
        ..SetupDifferences::default()
    };
    if let (Some(a), Some(b)) = (flat_scenario(a), flat_scenario(b)) {
        let all: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
        setup.scenario = differences(&a, &b);
        setup.equal_keys = (all.len() - setup.scenario.len()) as u64;
    }
    if let (Subject::Recording(a), Subject::Recording(b)) = (a, b) {
        // Each encoding has its own schemas, which say nothing about the runs.
        let has_schemas = a.encoding() == b.encoding();
        setup.files = differences(&facts(a, has_schemas), &facts(b, has_schemas));
    }
    setup
}

/// The keys that differ: those of a scenario in the order of the table of keys, then others by name.
fn differences(a: &Flat, b: &Flat) -> Vec<KeyDifference> {
    let keys: BTreeSet<&String> = a
        .keys()
        .chain(b.keys())
        .filter(|key| a.get(*key) != b.get(*key))
        .collect();
    let mut differing = Vec::from_iter(keys);
    differing.sort_by_key(|key| place(key).unwrap_or(usize::MAX));
    differing
        .into_iter()
        .map(|key| KeyDifference {
            key: key.clone(),
            unit: place(key).map_or("", |at| KEYS[at].unit).to_owned(),
            a: a.get(key).cloned(),
            b: b.get(key).cloned(),
        })
        .collect()
}

/// The place of a key in the table of keys.
fn place(key: &str) -> Option<usize> {
    KEYS.iter().position(|known| known.path == key)
}

/// The scenario keys of a run, even if this version can't run it.
fn flat_scenario(subject: Subject<'_>) -> Option<Flat> {
    let text = match subject {
        Subject::Scenario(scenario) => scenario.to_toml(),
        Subject::Recording(recording) => recording.scenario_text().ok()?,
    };
    let table: toml::Table = text.parse().ok()?;
    let mut flat = Flat::new();
    flatten("", &table, &mut flat);
    Some(flat)
}

fn flatten(prefix: &str, table: &toml::Table, flat: &mut Flat) {
    for (name, value) in table {
        let path = format!("{prefix}{name}");
        let text = match value {
            toml::Value::Table(inner) => {
                flatten(&format!("{path}."), inner, flat);
                continue;
            }
            toml::Value::String(text) => text.clone(),
            // As people write it, and equal for `1` and `1.0`.
            toml::Value::Float(number) => Value::Number(*number).to_set_notation(),
            value => value.to_string(),
        };
        flat.insert(path, text);
    }
}

/// Content of a file except its messages and its scenario's keys. Schemas of different encodings can't be compared.
fn facts(recording: &Recording, has_schemas: bool) -> Flat {
    let mut facts = Facts::default();
    facts.add("library", recording.library());
    facts.add("profile", recording.profile());
    if let Some(relogged) = recording.relogged() {
        facts.add("log times", relogged.to_string());
    }
    facts.add("state", recording.condition().name());
    for (name, entries) in recording.all_metadata() {
        facts.add(
            format!("metadata {name}"),
            format!(
                "{} {}",
                entries.len(),
                plural(entries.len() as u64, "entry")
            ),
        );
        for (key, value) in entries {
            facts.add(format!("metadata {name}: {key}"), value);
        }
    }
    for attachment in &recording.layout.attachments {
        let described = attachment.describe(&recording.source);
        let text = described.unwrap_or_else(|error| error.to_string());
        facts.add(format!("attachment {}", attachment.header.name), text);
    }
    // Equal channels of a topic, e.g. of two publishers, are described once.
    let mut described = BTreeSet::new();
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let channels = recording.channels().iter();
    for channel in channels.filter(|_| has_schemas) {
        let schema = channel.schema.as_deref();
        // Enough to see that two schemas differ, and short enough to read.
        let sum = schema.map_or(0, |schema| crc32fast::hash(&schema.data));
        let text = format!(
            "{}, schema {} (crc32 {sum:08x}), metadata {:?}",
            channel.encoding,
            channel.schema_name(),
            channel.metadata
        );
        if described.insert((&channel.topic, text.clone())) {
            facts.add(format!("channel {}", channel.topic), text);
        }
        *numbers.entry(&channel.topic).or_default() += 1;
    }
    for (topic, number) in numbers {
        facts.add(format!("number of channels of {topic}"), number.to_string());
    }
    for schema in recording.layout.channels.unused_schemas() {
        facts.add(format!("unused schema {}", schema.name), "");
    }
    facts.0
}

/// Facts about a file by their keys.
#[derive(Default)]
struct Facts(Flat);

impl Facts {
    /// Adds a fact. Facts with one key, such as two channels of a topic, are listed together.
    fn add(&mut self, key: impl Into<String>, value: impl AsRef<str>) {
        let value = value.as_ref();
        self.0
            .entry(key.into())
            .and_modify(|all| *all += &format!(", {value}"))
            .or_insert_with(|| value.to_owned());
    }
}
