//! Messages as JSON: `{"timestamp":{"sec":…,"nsec":…},"theta":…,…}`.

use super::{ChannelInfo, Message, channels};
use std::io::Write as _;

/// Writes messages of all channels as JSON, exact to the last bit of each number.
#[derive(Debug)]
pub struct JsonEncoder {
    templates: Vec<Template>,
}

/// What stands between the values of a channel's messages.
#[derive(Debug)]
struct Template {
    /// For each value, the bytes before it, and whether it is a text.
    slots: Vec<(Vec<u8>, bool)>,
    end: Vec<u8>,
}

impl Default for JsonEncoder {
    fn default() -> Self {
        Self {
            templates: channels().iter().map(Template::new).collect(),
        }
    }
}

impl JsonEncoder {
    /// Appends the message to `out`.
    pub fn encode(&self, message: &Message<'_>, out: &mut Vec<u8>) {
        let (sec, nsec) = seconds_and_nanoseconds(message.time_ns);
        // Writing to a Vec cannot fail, and every number is finite.
        let _ = write!(out, "{{\"timestamp\":{{\"sec\":{sec},\"nsec\":{nsec}}}");
        let template = &self.templates[message.channel];
        let mut numbers = message.numbers.iter();
        let mut texts = message.texts.iter();
        for (before, is_text) in &template.slots {
            out.extend_from_slice(before);
            let _ = if *is_text {
                serde_json::to_writer(&mut *out, texts.next().map_or("", String::as_str))
            } else {
                serde_json::to_writer(&mut *out, numbers.next().unwrap_or(&0.0))
            };
        }
        out.extend_from_slice(&template.end);
    }
}

/// Time split as in a message's timestamp.
#[must_use]
pub fn seconds_and_nanoseconds(time_ns: u64) -> (u64, u64) {
    (time_ns / 1_000_000_000, time_ns % 1_000_000_000)
}

impl Template {
    fn new(channel: &ChannelInfo) -> Self {
        let mut slots = Vec::new();
        let mut object = None;
        for (index, leaf) in channel.leaves().enumerate() {
            let (parent, name) = match leaf.path.split_once('.') {
                Some((parent, name)) => (Some(parent), name),
                None => (None, leaf.path.as_str()),
            };
            let before = match (object, parent) {
                (open, parent) if open == parent => format!(",\"{name}\":"),
                (None, Some(parent)) => format!(",\"{parent}\":{{\"{name}\":"),
                (Some(_), Some(parent)) => format!("}},\"{parent}\":{{\"{name}\":"),
                (_, None) => format!("}},\"{name}\":"),
            };
            object = parent;
            slots.push((before.into_bytes(), index < channel.texts.len()));
        }
        let end = if object.is_some() { "}}" } else { "}" };
        Self {
            slots,
            end: end.into(),
        }
    }
}
