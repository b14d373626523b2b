//! Content of a recording except its messages: records of the run, attachments, channels.

use super::difference::Difference;
use crate::archive::format::{
    CONTENT_DIGEST, END_RECORD, Entries, RUN_RECORD, SCENARIO_ATTACHMENT,
};
use crate::archive::recording::Recording;
use crate::archive::writer::{Declared, Opening};

/// The first entry in which the end record differs from the run's. Of another version's end record only the entries count
/// that this version has too, without the digest, which is one of its own fields.
pub(super) fn end_difference(
    recording: &Recording,
    simulated: &Entries,
    is_by_value: bool,
) -> Option<Difference> {
    let mut recorded = recording.end()?.clone();
    let mut simulated = simulated.clone();
    if is_by_value {
        simulated.retain(|key, _| key != CONTENT_DIGEST && recorded.contains_key(key));
        recorded.retain(|key, _| simulated.contains_key(key));
    }
    entries_difference(END_RECORD, &recorded, &simulated)
}

/// The first difference in the header, records, attachments and channels. A part of a run may lack some of them.
pub(super) fn opening_difference(
    recording: &Recording,
    opening: &Opening,
    is_part: bool,
) -> Option<Difference> {
    let no_run = Entries::new();
    let run = match recording.run() {
        None if is_part => None,
        run => entries_difference(RUN_RECORD, run.unwrap_or(&no_run), &opening.run),
    };
    let profile = (!recording.profile().is_empty()).then(|| {
        let profile = Some(recording.profile().to_owned());
        Difference::of("the header", "profile", profile, Some(String::new()))
    });
    run.or(profile)
        .or_else(|| stray_metadata(recording))
        .or_else(|| attachment_difference(recording, opening))
        .or_else(|| channel_difference(recording, &opening.channels, is_part))
}

/// The first entry that differs.
fn entries_difference(place: &str, recorded: &Entries, simulated: &Entries) -> Option<Difference> {
    let keys = simulated.keys().chain(recorded.keys());
    let mut keys = keys.filter(|key| recorded.get(*key) != simulated.get(*key));
    let key = keys.next()?;
    let values = [recorded, simulated].map(|entries| entries.get(key).cloned());
    let [recorded, simulated] = values;
    Some(Difference::of(place, key, recorded, simulated))
}

/// A metadata record that a run doesn't write, or writes once.
fn stray_metadata(recording: &Recording) -> Option<Difference> {
    let mut expected = vec![RUN_RECORD, END_RECORD];
    let mut strays = recording.all_metadata().filter(|(name, _)| {
        let known = expected.iter().position(|known| known == name);
        known.map(|at| expected.remove(at)).is_none()
    });
    let (name, _) = strays.next()?;
    let recorded = Some("a metadata record".to_owned());
    Some(Difference::of(name, "", recorded, None))
}

fn attachment_difference(recording: &Recording, opening: &Opening) -> Option<Difference> {
    let attachments = &recording.layout.attachments;
    let is_ours = |name: &str| name == SCENARIO_ATTACHMENT;
    let first_ours = attachments.iter().position(|a| is_ours(&a.name));
    for (position, attachment) in attachments.iter().enumerate() {
        if Some(position) != first_ours {
            let recorded = Some("an attachment".to_owned());
            return Some(Difference::of(&attachment.name, "", recorded, None));
        }
        let expected = &opening.scenario;
        let read = recording.attachment(&attachment.place);
        let is_equal = read.as_ref().is_ok_and(|(head, data)| {
            *data == *expected.data
                && head.media_type == expected.media_type
                && (head.log_time, head.create_time) == (expected.log_time, expected.create_time)
        });
        if !is_equal {
            let recorded = read.map_or_else(
                |reason| reason,
                |(head, data)| format!("{} bytes of {}", data.len(), head.media_type),
            );
            let simulated = format!(
                "{} bytes of {} with other contents, times or form",
                expected.data.len(),
                expected.media_type
            );
            let (recorded, simulated) = (Some(recorded), Some(simulated));
            return Some(Difference::of(&attachment.name, "", recorded, simulated));
        }
    }
    None
}

/// The first channel that differs from what the run declares.
fn channel_difference(
    recording: &Recording,
    declared: &[Declared],
    is_part: bool,
) -> Option<Difference> {
    if let Some(schema) = recording.layout.channels.unused_schemas().next() {
        let recorded = Some("a schema without a channel".to_owned());
        return Some(Difference::of(&schema.name, "", recorded, None));
    }
    let channels = recording.channels();
    for (position, channel) in channels.iter().enumerate() {
        let of_topic = |d: &&Declared| d.topic == channel.topic;
        let is_first = channels.iter().position(|c| c.topic == channel.topic) == Some(position);
        let Some(declared) = declared.iter().find(of_topic).filter(|_| is_first) else {
            let recorded = Some("a channel".to_owned());
            return Some(Difference::of(&channel.topic, "", recorded, None));
        };
        let schema = channel.schema.as_deref();
        let (encoding, data) = schema.map_or(("", &[][..]), |s| (&s.encoding, &s.data));
        let size =
            |data: &[u8]| format!("{} bytes, crc32 {:08x}", data.len(), crc32fast::hash(data));
        let properties = [
            (
                "encoding",
                channel.encoding.clone(),
                declared.encoding.to_owned(),
            ),
            (
                "schema name",
                channel.schema_name().to_owned(),
                declared.schema_name.to_owned(),
            ),
            (
                "schema encoding",
                encoding.to_owned(),
                declared.schema_encoding.to_owned(),
            ),
            ("schema", size(data), size(&declared.schema)),
            (
                "metadata",
                format!("{:?}", channel.metadata),
                format!("{:?}", Entries::new()),
            ),
        ];
        for (name, recorded, simulated) in properties {
            if recorded != simulated {
                let values = (Some(recorded), Some(simulated));
                return Some(Difference::of(&channel.topic, name, values.0, values.1));
            }
        }
    }
    let has = |declared: &&Declared| channels.iter().any(|c| c.topic == declared.topic);
    let missing = declared
        .iter()
        .find(|declared| !has(declared) && !is_part)?;
    let simulated = Some("a channel".to_owned());
    Some(Difference::of(missing.topic, "", None, simulated))
}
