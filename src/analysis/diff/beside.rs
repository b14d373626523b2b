//! What differs between two runs beside values that are all the same.

use super::setup::{CONDITION, ENCODING, SetupDifferences};
use super::topic::ChannelDifference;
use crate::analysis::phrase::counted;

/// What differs beside the values, in words.
pub(super) fn beside(setup: &SetupDifferences, channels: &[ChannelDifference]) -> Vec<String> {
    let mut beside = Vec::new();
    let says_otherwise = |key: &str| setup.files.iter().any(|file| file.key == key);
    if says_otherwise(ENCODING) {
        beside.push("the encoding".to_owned());
    }
    let count = |of: fn(&ChannelDifference) -> u64| channels.iter().map(of).sum();
    for (name, count) in [
        ("the bytes", count(|channel| channel.other_bytes)),
        (
            "the publish times",
            count(|channel| channel.other_publish_times),
        ),
        (
            "the sequence numbers",
            count(|channel| channel.other_sequences),
        ),
    ] {
        if count > 0 {
            beside.push(format!("{name} of {}", counted(count, "message")));
        }
    }
    let schemas = setup.schemas.iter();
    beside.extend(schemas.map(|schema| format!("the schema of {schema}")));
    let channels = setup.channels.iter();
    beside.extend(channels.map(|topic| format!("the channels of {topic}")));
    let keys = setup.scenario.iter();
    beside.extend(keys.map(|key| format!("the scenario's {}", key.key)));
    let attachments = setup.attachments.iter();
    beside.extend(attachments.map(|name| format!("the attachment {name}")));
    let entries = setup.files.iter().map(|file| file.key.as_str());
    // A file that can't be read as a whole is told as that.
    let entries = entries.filter(|key| ![ENCODING, CONDITION].contains(key));
    beside.extend(entries.map(|key| match key.contains(": ") {
        true => format!("the metadata {key}"),
        false => format!("the {key}"),
    }));
    beside
}
