//! Content of a recording except its messages: header, metadata, attachments, channels.

use super::difference::Difference;
use super::supplements::is_supplementary;
use crate::archive::container::record::AttachmentHeader;
use crate::archive::format::{
    CONTENT_DIGEST, END_RECORD, Entries, INVERSION_TIME, RUN_RECORD, TELEMETRY, VERSION,
};
use crate::archive::recording::Recording;
use crate::archive::writer::{Header, RegisteredChannel};
use crate::run::plural::plural;
use crate::telemetry::supplement::supplements;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;

const AN_ATTACHMENT: &str = "an attachment";

/// Values by location and field; the field is empty for a value described as a whole.
type Facts = BTreeMap<(String, String), String>;

/// The first entry in which a recording differs from its run. A partial run may lack some entries. A recording of another
/// version may have other words and fewer entries, but no further records or topics.
pub(super) fn difference(
    recording: &Recording,
    header: &Header,
    end: &Entries,
    is_part: bool,
    is_by_value: bool,
) -> Option<Difference> {
    let mut recorded = recorded(recording, is_by_value);
    let mut simulated = simulated(header, end, is_by_value);
    for supplement in supplements() {
        let channel = RegisteredChannel::supplement(supplement);
        if recording
            .channels()
            .iter()
            .any(|c| c.topic == channel.topic)
        {
            add_channel(&mut simulated, &channel, is_by_value);
        }
    }
    if recording.is_interrupted() {
        // The run continues after the end of the recording.
        recorded.retain(|key, _| !is_of_end(key));
        simulated.retain(|key, _| !is_of_end(key));
    }
    if is_by_value {
        let has_same_fields = recording.differences().is_empty();
        for facts in [&mut recorded, &mut simulated] {
            keep_values(facts, has_same_fields);
        }
        recorded.retain(|(place, _), _| !is_view(recording, place));
        simulated.retain(|key, _| recorded.contains_key(key));
        recorded.retain(|key, _| {
            // The only entry of this version that some runs lack.
            key.1.is_empty() || key.1 == INVERSION_TIME || simulated.contains_key(key)
        });
    }
    if is_part {
        simulated.retain(|(place, _), _| recorded.keys().any(|key| key.0 == *place));
    }
    let mut keys = simulated.keys().chain(recorded.keys());
    let key = keys.find(|key| recorded.get(*key) != simulated.get(*key))?;
    let values = [&recorded, &simulated].map(|facts| facts.get(key).cloned());
    Some(Difference::new(&key.0, &key.1, values))
}

/// Leaves out what depends on the version that recorded it. The digest covers all fields, so it is that of this version
/// if the fields are.
fn keep_values(facts: &mut Facts, has_same_fields: bool) {
    facts.remove(&(RUN_RECORD.to_owned(), VERSION.to_owned()));
    facts.remove(&(RUN_RECORD.to_owned(), TELEMETRY.to_owned()));
    if !has_same_fields {
        facts.remove(&(END_RECORD.to_owned(), CONTENT_DIGEST.to_owned()));
    }
}

fn is_view(recording: &Recording, topic: &str) -> bool {
    recording
        .channels()
        .iter()
        .any(|channel| channel.topic == topic && channel.is_view())
}

/// Whether this is an entry of the end record.
fn is_of_end((place, field): &(String, String)) -> bool {
    place == END_RECORD && !field.is_empty()
}

/// The content of a recording; with `is_by_value` without the words in attachments and schemas.
fn recorded(recording: &Recording, is_by_value: bool) -> Facts {
    let mut facts = Facts::new();
    add(&mut facts, "the header", "profile", recording.profile());
    for (name, entries) in recording.all_metadata() {
        add_metadata(&mut facts, name, entries);
    }
    let run_attachments = recording.layout.attachments.iter();
    for attachment in run_attachments.filter(|attachment| !is_supplementary(attachment)) {
        let text = if is_by_value {
            AN_ATTACHMENT.to_owned()
        } else {
            let described = attachment.describe(&recording.source);
            described.unwrap_or_else(|error| error.to_string())
        };
        add(&mut facts, &attachment.header.name, "", &text);
    }
    for channel in recording.channels() {
        let schema = channel.schema.as_deref();
        let (language, data) = schema.map_or(("", &[][..]), |s| (&s.encoding, &s.data));
        let names = [&channel.encoding, channel.schema_name(), language];
        let mut text = declared(names);
        if !is_by_value {
            text += &with_words(data, &channel.metadata);
        }
        add(&mut facts, &channel.topic, "", &text);
    }
    for schema in recording.layout.channels.unused_schemas() {
        add(&mut facts, &schema.name, "", "an unused schema");
    }
    facts
}

fn simulated(header: &Header, end: &Entries, is_by_value: bool) -> Facts {
    let mut facts = Facts::new();
    add(&mut facts, "the header", "profile", "");
    add_metadata(&mut facts, RUN_RECORD, &header.run);
    add_metadata(&mut facts, END_RECORD, end);
    let scenario = &header.scenario;
    let attachment = AttachmentHeader {
        name: scenario.name.clone(),
        media_type: scenario.media_type.clone(),
        log_time: scenario.log_time,
        create_time: scenario.create_time,
    };
    let digest = format!("{:x}", Sha256::digest(&scenario.data));
    let text = if is_by_value {
        AN_ATTACHMENT.to_owned()
    } else {
        attachment.describe(scenario.data.len() as u64, &digest)
    };
    add(&mut facts, &attachment.name, "", &text);
    for channel in &header.channels {
        add_channel(&mut facts, channel, is_by_value);
    }
    facts
}

/// Adds a channel as toprise declares it.
fn add_channel(facts: &mut Facts, channel: &RegisteredChannel, is_by_value: bool) {
    let names = [
        channel.encoding,
        channel.schema_name,
        channel.schema_encoding,
    ];
    let mut text = declared(names);
    if !is_by_value {
        text += &with_words(&channel.schema, &Entries::new());
    }
    add(facts, channel.topic, "", &text);
}

/// Adds an entry. Entries with the same location and field are merged.
fn add(facts: &mut Facts, place: &str, field: &str, value: &str) {
    let key = (place.to_owned(), field.to_owned());
    let known = facts.entry(key);
    // So a second record of a name is a difference, too.
    known
        .and_modify(|known| *known = format!("{known} and {value}"))
        .or_insert_with(|| value.to_owned());
}

fn add_metadata(facts: &mut Facts, name: &str, entries: &Entries) {
    add(facts, name, "", "a metadata record");
    for (key, value) in entries {
        add(facts, name, key, value);
    }
}

/// The encoding of a channel, and the name and language of its schema.
fn declared([encoding, name, language]: [&str; 3]) -> String {
    format!("{encoding} with the {language} {name:?}")
}

/// The text of a schema, and the metadata of its channel.
fn with_words(schema: &[u8], metadata: &Entries) -> String {
    format!(" of {} and metadata {metadata:?}", digest(schema))
}

fn digest(data: &[u8]) -> String {
    let digest = format!("{:x}", Sha256::digest(data));
    let bytes = plural(data.len() as u64, "byte");
    format!("{} {bytes} (SHA-256 {digest})", data.len())
}
