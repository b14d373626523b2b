//! Content of a recording except its messages: header, metadata, attachments, channels.

use super::difference::Difference;
use super::scope::Scope;
use crate::archive::container::attachment::describe;
use crate::archive::format::{
    CONTENT_DIGEST, END_RECORD, Entries, INVERSION_TIME, RUN_RECORD, TELEMETRY, VERSION,
    is_reserved,
};
use crate::archive::recording::{FileChannel, Recording};
use crate::archive::supplements::is_supplementary;
use crate::archive::writer::{Header, RegisteredChannel};
use crate::telemetry::supplement::supplements;
use crate::words::plural;
use mcap::records::AttachmentHeader;
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};

/// Subject of a fact. Ordered so that a difference of a whole item comes before those of its fields.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct FactSubject {
    /// The header, a metadata record, an attachment or a topic.
    item: String,
    /// A field of the item; `None` for all of it.
    field: Option<String>,
}

impl FactSubject {
    /// Whether this is an entry of the end record.
    fn is_end_entry(&self) -> bool {
        self.item == END_RECORD && self.field.is_some()
    }
}

/// Facts about a file, as texts that are shown where two files differ.
struct FileFacts {
    scope: Scope,
    texts: BTreeMap<FactSubject, String>,
}

/// The first entry in which a recording differs from its run. A partial run may lack some entries. A recording of another
/// version may have other words and fewer entries, but no further records or topics.
pub(super) fn difference(
    recording: &Recording,
    header: &Header,
    end: &Entries,
    is_part: bool,
    scope: Scope,
) -> Option<Difference> {
    let mut recorded = FileFacts::from_recording(recording, scope).texts;
    let mut run = FileFacts::from_run(header, end, scope);
    for supplement in supplements() {
        let channel = RegisteredChannel::supplement(supplement);
        if recording
            .channels()
            .iter()
            .any(|c| c.topic == channel.topic)
        {
            run.add_registered(&channel);
        }
    }
    let mut simulated = run.texts;
    if recording.is_interrupted() {
        // The run continues after the end of the recording.
        recorded.retain(|subject, _| !subject.is_end_entry());
        simulated.retain(|subject, _| !subject.is_end_entry());
    }
    if scope == Scope::Values {
        let has_same_fields = recording.differences().is_empty();
        recorded.retain(|subject, _| is_comparable(subject, has_same_fields));
        simulated.retain(|subject, _| is_comparable(subject, has_same_fields));
        recorded.retain(|subject, _| !is_view(recording, &subject.item));
        simulated.retain(|subject, _| recorded.contains_key(subject));
        recorded.retain(|subject, _| {
            // The only entry of this version that some runs lack.
            subject
                .field
                .as_deref()
                .is_none_or(|field| field == INVERSION_TIME)
                || simulated.contains_key(subject)
        });
    }
    if is_part {
        simulated.retain(|subject, _| recorded.keys().any(|known| known.item == subject.item));
    } else {
        // All messages are there, so a channel that is not has none: some writers leave those out.
        simulated.retain(|subject, _| {
            recorded.contains_key(subject)
                || !header.channels.iter().any(|c| c.topic == subject.item)
        });
    }
    let subject = simulated
        .keys()
        .chain(recorded.keys())
        .find(|subject| recorded.get(*subject) != simulated.get(*subject))?;
    Some(Difference::new(
        &subject.item,
        subject.field.as_deref().unwrap_or_default(),
        [&recorded, &simulated].map(|texts| texts.get(subject).cloned()),
    ))
}

/// Whether a fact doesn't depend on the version that recorded it. The digest covers all fields, so it is that of this
/// version only if the fields are.
fn is_comparable(subject: &FactSubject, has_same_fields: bool) -> bool {
    match (subject.item.as_str(), subject.field.as_deref()) {
        (RUN_RECORD, Some(VERSION | TELEMETRY)) => false,
        (END_RECORD, Some(CONTENT_DIGEST)) => has_same_fields,
        _ => true,
    }
}

/// Names and descriptions of the attachments of a run.
fn attachments(recording: &Recording) -> impl Iterator<Item = (&str, String)> {
    recording
        .layout
        .attachments
        .iter()
        .filter(|attachment| !is_supplementary(attachment))
        .map(|attachment| {
            let description = attachment.describe(&recording.source);
            let text = description.unwrap_or_else(|error| error.to_string());
            (attachment.header.name.as_str(), text)
        })
}

/// Names of metadata records and attachments that are in a recording more than once, in equal form.
pub(super) fn repeated(recording: &Recording) -> Vec<String> {
    let mut repeated = BTreeSet::new();
    let mut records = BTreeSet::new();
    for (name, entries) in recording.all_metadata() {
        if !records.insert((name, entries)) {
            repeated.insert(name.to_owned());
        }
    }
    let mut descriptions = BTreeSet::new();
    for (name, description) in attachments(recording) {
        if !descriptions.insert((name, description)) {
            repeated.insert(name.to_owned());
        }
    }
    Vec::from_iter(repeated)
}

fn is_view(recording: &Recording, topic: &str) -> bool {
    recording
        .channels()
        .iter()
        .any(|channel| channel.topic == topic && channel.is_view())
}

impl FileFacts {
    /// The facts that a file shows.
    fn from_recording(recording: &Recording, scope: Scope) -> Self {
        let mut facts = Self::new(recording.profile(), scope);
        let is_damaged = recording.is_damaged();
        // Some software repeats what it copies: equal records say nothing new.
        let records: BTreeSet<_> = recording.all_metadata().collect();
        for (name, entries) in records.into_iter().filter(|(name, _)| is_reserved(name)) {
            facts.add_metadata(name, entries);
        }
        let attachments: BTreeSet<_> = attachments(recording).collect();
        for (name, description) in attachments {
            facts.add_attachment(name, || description);
        }
        // Two publishers may share a topic.
        let mut channels = BTreeSet::new();
        // Those of others say nothing about the run.
        let is_compared = |c: &&FileChannel| c.is_declared_supplement() || !c.is_supplement();
        let compared = recording.channels().iter().filter(is_compared);
        for channel in compared.filter(|c| !c.is_superseded) {
            if let Some(id) = channel.undefined_schema() {
                // The damage may be that of the schema.
                if !is_damaged {
                    let text = format!("{} with the undefined schema {id}", channel.encoding);
                    facts.add(&channel.topic, None, &text);
                }
                continue;
            }
            let schema = channel.schema.as_deref();
            let (language, data) = schema.map_or(("", &[][..]), |s| (&s.encoding, &s.data));
            let names = [&channel.encoding, channel.schema_name(), language];
            if channels.insert((&channel.topic, names, data, &channel.metadata)) {
                facts.add_channel(&channel.topic, names, data, &channel.metadata);
            }
        }
        // The schema of an undefined one has another id after damage, and its channel may be lost.
        let unused = recording.layout.channels.unused_schemas();
        for schema in unused.filter(|_| !is_damaged) {
            facts.add(&schema.name, None, "an unused schema");
        }
        facts
    }

    /// The facts that the recording of a run must show.
    fn from_run(header: &Header, end: &Entries, scope: Scope) -> Self {
        let mut facts = Self::new("", scope);
        facts.add_metadata(RUN_RECORD, &header.run);
        facts.add_metadata(END_RECORD, end);
        let scenario = &header.scenario;
        facts.add_attachment(&scenario.name, || {
            let attachment = AttachmentHeader {
                name: scenario.name.clone(),
                media_type: scenario.media_type.clone(),
                log_time: scenario.log_time,
                create_time: scenario.create_time,
            };
            let digest = format!("{:x}", Sha256::digest(&scenario.data));
            describe(&attachment, scenario.data.len() as u64, &digest)
        });
        for channel in &header.channels {
            facts.add_registered(channel);
        }
        facts
    }

    /// The profile of a file's header.
    fn new(profile: &str, scope: Scope) -> Self {
        let mut facts = Self {
            scope,
            texts: BTreeMap::new(),
        };
        facts.add("the header", Some("profile"), profile);
        facts
    }

    fn add_attachment(&mut self, name: &str, describe: impl FnOnce() -> String) {
        let text = match self.scope {
            Scope::Bytes => describe(),
            Scope::Values => "an attachment".to_owned(),
        };
        self.add(name, None, &text);
    }

    /// Adds a channel as toprise declares it.
    fn add_registered(&mut self, channel: &RegisteredChannel) {
        let names = [
            channel.encoding,
            channel.schema_name,
            channel.schema_encoding,
        ];
        self.add_channel(channel.topic, names, &channel.schema, &Entries::new());
    }

    /// Adds a channel: its encoding, the name and the language of its schema, and the rest of both.
    fn add_channel(
        &mut self,
        topic: &str,
        [encoding, name, language]: [&str; 3],
        schema: &[u8],
        metadata: &Entries,
    ) {
        let mut text = format!("{encoding} with the {language} {name:?}");
        match self.scope {
            Scope::Bytes => {
                text += &format!(" of {} and metadata {metadata:?}", size_and_digest(schema));
            }
            Scope::Values => {}
        }
        self.add(topic, None, &text);
    }

    fn add_metadata(&mut self, name: &str, entries: &Entries) {
        self.add(name, None, "a metadata record");
        for (key, value) in entries {
            self.add(name, Some(key), value);
        }
    }

    /// Adds a fact. Facts about one subject are joined, so a second record of a name is a difference, too.
    fn add(&mut self, item: &str, field: Option<&str>, text: &str) {
        let subject = FactSubject {
            item: item.to_owned(),
            field: field.map(str::to_owned),
        };
        self.texts
            .entry(subject)
            .and_modify(|known| *known = format!("{known} and {text}"))
            .or_insert_with(|| text.to_owned());
    }
}

fn size_and_digest(data: &[u8]) -> String {
    let digest = format!("{:x}", Sha256::digest(data));
    let bytes = plural(data.len() as u64, "byte");
    format!("{} {bytes} (SHA-256 {digest})", data.len())
}
