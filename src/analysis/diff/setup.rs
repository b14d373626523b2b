//! What was different in the set-up of two runs.

use super::Subject;
use super::report::{KeyDifference, Setup};
use crate::archive::recording::{Entries, FileChannel, Recording};
use crate::run::scenario::KEYS;
use std::collections::BTreeMap;

/// The keys and values of a scenario, as texts.
type Flat = BTreeMap<String, String>;

/// Compares scenarios and files.
pub(super) fn compare(a: Subject<'_>, b: Subject<'_>) -> Setup {
    let mut setup = Setup::default();
    if let (Some(a), Some(b)) = (flat_scenario(a), flat_scenario(b)) {
        compare_scenarios(&a, &b, &mut setup);
    }
    if let (Subject::Recording(a), Subject::Recording(b)) = (a, b) {
        compare_files(a, b, &mut setup);
    }
    setup
}

/// The scenario key by key; of other versions too, whose keys mean nothing here.
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

fn compare_scenarios(a: &Flat, b: &Flat, setup: &mut Setup) {
    let known = KEYS.iter().map(|key| key.path.to_owned());
    let unknown = a
        .keys()
        .chain(b.keys())
        .filter(|path| !KEYS.iter().any(|key| key.path == **path));
    let mut paths: Vec<String> = known.chain(unknown.cloned()).collect();
    let mut seen = std::collections::BTreeSet::new();
    paths.retain(|path| seen.insert(path.clone()));
    for path in paths {
        let (x, y) = (a.get(&path), b.get(&path));
        if x.is_none() && y.is_none() {
            continue;
        }
        if x == y {
            setup.equal_keys += 1;
            continue;
        }
        let unit = KEYS
            .iter()
            .find(|key| key.path == path)
            .map_or("", |key| key.unit);
        setup.scenario.push(KeyDifference {
            key: path,
            unit: unit.to_owned(),
            a: x.cloned(),
            b: y.cloned(),
        });
    }
}

fn compare_files(a: &Recording, b: &Recording, setup: &mut Setup) {
    let mut add = |key: &str, of: &dyn Fn(&Recording) -> Option<String>| {
        let (x, y) = (of(a), of(b));
        if x != y {
            setup.files.push(KeyDifference {
                key: key.to_owned(),
                unit: String::new(),
                a: x,
                b: y,
            });
        }
    };
    add("library", &|recording| Some(recording.library().to_owned()));
    add("encoding", &|recording| Some(encodings(recording)));
    add("condition", &|recording| {
        Some(recording.condition().name().to_owned())
    });
    let names = |recording: &Recording| -> Vec<String> {
        recording
            .all_metadata()
            .map(|(name, _)| name.to_owned())
            .collect()
    };
    let mut all = [names(a), names(b)].concat();
    all.sort();
    all.dedup();
    for name in all {
        let empty = BTreeMap::new();
        let entries = |recording: &Recording| recording.metadata(&name).unwrap_or(&empty).clone();
        let prefix = format!("{name}: ");
        setup
            .files
            .extend(entry_differences(&prefix, &entries(a), &entries(b)));
    }
    for channel in a.channels() {
        let other = b
            .channels()
            .iter()
            .find(|other| other.topic == channel.topic);
        let Some(other) = other else {
            continue;
        };
        if let Some(difference) = schema_difference(channel, other) {
            setup.schemas.push(difference);
        }
    }
    let only = |of: &Recording, other: &Recording| -> Vec<String> {
        let has = |topic: &str| {
            other
                .channels()
                .iter()
                .any(|channel| channel.topic == topic)
        };
        let alone = of.channels().iter().filter(|channel| !has(&channel.topic));
        alone.map(|channel| channel.topic.clone()).collect()
    };
    setup.topics_only_in_a = only(a, b);
    setup.topics_only_in_b = only(b, a);
}

/// The encodings of a file's messages.
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

/// Entries of a record as differences: keys with other values.
fn entry_differences(prefix: &str, a: &Entries, b: &Entries) -> Vec<KeyDifference> {
    let mut keys: Vec<_> = a.keys().chain(b.keys()).collect();
    keys.sort();
    keys.dedup();
    let differing = keys.into_iter().filter(|key| a.get(*key) != b.get(*key));
    differing
        .map(|key| KeyDifference {
            key: format!("{prefix}{key}"),
            unit: String::new(),
            a: a.get(key).cloned(),
            b: b.get(key).cloned(),
        })
        .collect()
}
