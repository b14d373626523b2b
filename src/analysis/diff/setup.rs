//! Section a of a report: what was different in the set-up of two runs.

use crate::analysis::subject::Subject;
use crate::archive::recording::{FileChannel, Recording};
use crate::run::scenario::KEYS;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Keys of what files say about themselves, beside the entries of their metadata records.
const LIBRARY: &str = "library";
const PROFILE: &str = "profile";
pub(super) const ENCODING: &str = "encoding";
pub(super) const CONDITION: &str = "condition";

/// Section a: the set-up.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SetupDifferences {
    /// Keys of the scenarios with different values.
    pub scenario: Vec<KeyDifference>,
    /// Number of keys that both scenarios have with equal values.
    pub equal_keys: u64,
    /// What the files say about themselves: versions, encodings, entries of metadata records.
    pub files: Vec<KeyDifference>,
    /// Topics with schemas that differ.
    pub schemas: Vec<String>,
    /// Topics whose channels differ in their number or metadata.
    pub channels: Vec<String>,
    /// Names of attachments that differ, or that only one of the files has.
    pub attachments: Vec<String>,
    /// Topics that only A has.
    pub topics_only_in_a: Vec<String>,
    /// Topics that only B has.
    pub topics_only_in_b: Vec<String>,
    /// Fields of common topics that only A has.
    pub fields_only_in_a: Vec<String>,
    /// Fields of common topics that only B has.
    pub fields_only_in_b: Vec<String>,
}

/// A key and its two values.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct KeyDifference {
    /// The key.
    pub key: String,
    /// The unit of the values.
    pub unit: String,
    /// A's value; absent if it has none.
    pub a: Option<String>,
    /// B's value; absent if it has none.
    pub b: Option<String>,
}

/// Keys of a scenario that don't change the run.
const NAMES: [&str; 2] = ["name", "description"];

impl KeyDifference {
    /// Whether it changes the run: not only what it is called.
    #[must_use]
    pub fn changes_the_run(&self) -> bool {
        !NAMES.contains(&self.key.as_str())
    }
}

/// Keys with their values as texts.
type Flat = BTreeMap<String, String>;

/// Compares scenarios and files; which topics and fields only one of them has is found elsewhere.
pub(super) fn compare(a: Subject<'_>, b: Subject<'_>) -> SetupDifferences {
    let mut setup = SetupDifferences::default();
    if let (Some(a), Some(b)) = (flat_scenario(a), flat_scenario(b)) {
        compare_scenarios(&a, &b, &mut setup);
    }
    if let (Subject::Recording(a), Subject::Recording(b)) = (a, b) {
        setup.files = file_differences(a, b);
        setup.schemas = schema_differences(a, b);
        setup.channels = channel_differences(a, b);
        setup.attachments = attachment_differences(a, b);
    }
    setup
}

/// The keys of a run's scenario, also of one of another version, whose keys mean nothing here.
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
        match value {
            toml::Value::Table(inner) => flatten(&format!("{path}."), inner, flat),
            toml::Value::String(text) => {
                flat.insert(path, text.clone());
            }
            value => {
                flat.insert(path, value.to_string());
            }
        }
    }
}

fn compare_scenarios(a: &Flat, b: &Flat, setup: &mut SetupDifferences) {
    let known: BTreeMap<&str, &str> = KEYS.iter().map(|key| (key.path, key.unit)).collect();
    let all: BTreeSet<&str> = a.keys().chain(b.keys()).map(String::as_str).collect();
    let ours = KEYS.iter().map(|key| key.path);
    let ours = ours.filter(|path| all.contains(path));
    let others = all.iter().copied();
    let others = others.filter(|path| !known.contains_key(path));
    for path in ours.chain(others) {
        let (x, y) = (a.get(path), b.get(path));
        if x == y {
            setup.equal_keys += 1;
        } else {
            let unit = known.get(path).copied().unwrap_or_default();
            setup.scenario.push(key_difference(path, unit, x, y));
        }
    }
}

fn key_difference(key: &str, unit: &str, a: Option<&String>, b: Option<&String>) -> KeyDifference {
    KeyDifference {
        key: key.to_owned(),
        unit: unit.to_owned(),
        a: a.cloned(),
        b: b.cloned(),
    }
}

/// What files say about themselves that is not the same.
fn file_differences(a: &Recording, b: &Recording) -> Vec<KeyDifference> {
    let [of_a, of_b] = [a, b].map(facts);
    let keys: BTreeSet<&String> = of_a.keys().chain(of_b.keys()).collect();
    let own = [LIBRARY, PROFILE, ENCODING, CONDITION].map(str::to_owned);
    let records = keys.into_iter().filter(|key| !own.contains(*key));
    let all = own.iter().chain(records);
    let differing = all.filter(|key| of_a.get(*key) != of_b.get(*key));
    let mut differing: Vec<_> = differing
        .map(|key| key_difference(key, "", of_a.get(key), of_b.get(key)))
        .collect();
    if differing.is_empty() && !a.all_metadata().eq(b.all_metadata()) {
        // Only the order of the records, or names that read the same with their keys.
        let [x, y] = [a, b].map(|recording| {
            let names = recording.all_metadata().map(|(name, _)| name);
            names.collect::<Vec<_>>().join(", ")
        });
        differing.push(key_difference("order of metadata", "", Some(&x), Some(&y)));
    }
    differing
}

/// What a file says about itself, and the entries of its metadata records.
fn facts(recording: &Recording) -> Flat {
    let mut facts = Flat::new();
    let mut counts: BTreeMap<&str, u64> = BTreeMap::new();
    for (name, entries) in recording.all_metadata() {
        let count = counts.entry(name).or_default();
        *count += 1;
        // Several records may have one name.
        let record = match *count {
            1 => name.to_owned(),
            count => format!("{name} ({count})"),
        };
        if entries.is_empty() {
            facts.insert(format!("{record}: "), "no entries".to_owned());
        }
        let entries = entries.iter();
        facts.extend(entries.map(|(key, value)| (format!("{record}: {key}"), value.clone())));
    }
    facts.insert(PROFILE.to_owned(), recording.profile().to_owned());
    facts.insert(LIBRARY.to_owned(), recording.library().to_owned());
    facts.insert(ENCODING.to_owned(), encodings(recording));
    let condition = recording.condition().name().to_owned();
    facts.insert(CONDITION.to_owned(), condition);
    facts
}

/// The names of the attachments that differ, or that only one of two files has.
fn attachment_differences(a: &Recording, b: &Recording) -> Vec<String> {
    let [of_a, of_b] = [a, b].map(Recording::attachment_digests);
    let names: BTreeSet<&String> = of_a.keys().chain(of_b.keys()).collect();
    let differing = names
        .into_iter()
        .filter(|name| of_a.get(*name) != of_b.get(*name));
    differing.cloned().collect()
}

/// Topics of both files whose channels differ in their number or metadata.
fn channel_differences(a: &Recording, b: &Recording) -> Vec<String> {
    let [of_a, of_b] = [a, b].map(|recording| {
        let mut channels: BTreeMap<&str, Vec<&BTreeMap<String, String>>> = BTreeMap::new();
        for channel in recording.channels() {
            let of_topic = channels.entry(&channel.topic).or_default();
            of_topic.push(&channel.metadata);
        }
        // The order of channels means nothing.
        for of_topic in channels.values_mut() {
            of_topic.sort();
        }
        channels
    });
    let in_both = of_a
        .iter()
        .filter_map(|(topic, x)| Some((topic, x, of_b.get(topic)?)));
    in_both
        .filter(|(_, x, y)| x != y)
        .map(|(topic, ..)| (*topic).to_owned())
        .collect()
}

/// Topics of both files whose message types differ.
fn schema_differences(a: &Recording, b: &Recording) -> Vec<String> {
    let mut of_b: BTreeMap<&str, VecDeque<&FileChannel>> = BTreeMap::new();
    for channel in b.channels() {
        of_b.entry(&channel.topic).or_default().push_back(channel);
    }
    let channels = a.channels().iter();
    let differences = channels.filter_map(|channel| {
        // A topic may have several channels, each with its own message type.
        let others = of_b.get_mut(channel.topic.as_str())?;
        let same = others
            .iter()
            .position(|other| other.schema == channel.schema);
        let other = others.remove(same.unwrap_or(0))?;
        schema_difference(channel, other)
    });
    differences.collect()
}

/// The encodings of a file's messages, separated by commas.
pub(super) fn encodings(recording: &Recording) -> String {
    if let Some(encoding) = recording.encoding() {
        return encoding.name().to_owned();
    }
    let mut names: Vec<_> = recording
        .channels()
        .iter()
        .map(|c| c.encoding.as_str())
        .collect();
    names.sort_unstable();
    names.dedup();
    names.join(", ")
}

/// In what the message types of a topic differ, if both are of one encoding.
fn schema_difference(a: &FileChannel, b: &FileChannel) -> Option<String> {
    if a.encoding != b.encoding || a.schema == b.schema {
        return None;
    }
    let name = |channel: &FileChannel| match channel.schema_name() {
        "" => "none".to_owned(),
        name => name.to_owned(),
    };
    let (x, y) = (name(a), name(b));
    Some(if x == y {
        format!("{}: both are {x}, described differently", a.topic)
    } else {
        format!("{}: {x} in A, {y} in B", a.topic)
    })
}
