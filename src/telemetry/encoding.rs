//! Message encodings: encoders and decoders.

mod decoding;
pub mod json;
pub mod protobuf;
pub mod schema;
pub(super) mod template;
mod wire;

pub use self::decoding::{
    DecodeError, FieldDifferences, Row, SchemaError, TimestampOverflow, WireError,
};
use self::json::JsonDecoder;
use self::protobuf::{ProtobufDecoder, file_descriptor_set};
use self::schema::json_schema;
use self::template::Template;
use super::message::Message;
use super::table::channel::ChannelInfo;
use super::table::channels;
use crate::run::listed::listed;

listed! {
    /// A message encoding with its schema language.
    pub enum Encoding {
        /// JSON with JSON Schema (widest support).
        Json = "json",
        /// Protocol Buffers (smaller, faster, can be plotted in Rerun).
        Protobuf = "protobuf",
    }
}

impl Encoding {
    /// Description for the help.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Json => "JSON with JSON Schema (widest support)",
            Self::Protobuf => "Protocol Buffers (smaller, faster, can be plotted in Rerun)",
        }
    }

    /// The MCAP schema encoding.
    pub fn schema_encoding(self) -> &'static str {
        match self {
            Self::Json => "jsonschema",
            Self::Protobuf => "protobuf",
        }
    }

    /// The schema of a channel's messages, as stored in recordings.
    pub fn schema(self, channel: &ChannelInfo) -> Vec<u8> {
        match self {
            Self::Json => json_schema(channel).into_bytes(),
            Self::Protobuf => file_descriptor_set(channel),
        }
    }
}

/// Encodes messages of all channels.
#[derive(Debug)]
pub struct Encoder {
    encoding: Encoding,
    templates: Vec<Template>,
}

impl Encoder {
    /// An encoder of this kind.
    pub fn new(encoding: Encoding) -> Self {
        // Made once: encoding takes longer than writing, so that a message only fills in its numbers.
        let template = match encoding {
            Encoding::Json => json::template,
            Encoding::Protobuf => protobuf::template,
        };
        Self {
            encoding,
            templates: channels().iter().map(template).collect(),
        }
    }

    /// Appends the message to `out`.
    #[inline]
    pub fn encode(&self, message: &Message<'_>, out: &mut Vec<u8>) {
        let template = &self.templates[message.channel];
        match self.encoding {
            Encoding::Json => json::encode(template, message, out),
            Encoding::Protobuf => protobuf::encode(template, message, out),
        }
    }
}

/// Maximum length of a channel schema, bytes.
const MAX_SCHEMA_LENGTH: usize = 1 << 20;

/// Decodes the messages of one channel of a file.
#[derive(Clone, Debug)]
pub struct Decoder {
    channel: &'static ChannelInfo,
    differences: FieldDifferences,
    format: Format,
}

#[derive(Clone, Debug)]
enum Format {
    Json(JsonDecoder),
    Protobuf(ProtobufDecoder),
}

impl Decoder {
    /// A decoder for messages of the table's `channel`, as a file describes them: by encoding name, schema name and
    /// schema data.
    ///
    /// # Errors
    /// [`DecodeError`] if the encoding is unknown, or the schema can't be read.
    pub fn new(
        channel: &'static ChannelInfo,
        encoding: &str,
        schema_name: &str,
        schema: &[u8],
    ) -> Result<Self, DecodeError> {
        // Before anything is parsed: the table's schemas have a few kilobytes, others come from hostile files.
        if schema.len() > MAX_SCHEMA_LENGTH {
            return Err(SchemaError::TooLong(MAX_SCHEMA_LENGTH).into());
        }
        let (format, present) = match Encoding::find(encoding) {
            Some(Encoding::Json) => {
                let (decoder, present) = JsonDecoder::new(channel, schema)?;
                (Format::Json(decoder), present)
            }
            Some(Encoding::Protobuf) => {
                let (decoder, present) = ProtobufDecoder::new(channel, schema_name, schema)?;
                (Format::Protobuf(decoder), present)
            }
            None => return Err(DecodeError::UnknownEncoding(encoding.to_owned())),
        };
        Ok(Self {
            channel,
            differences: FieldDifferences::between(channel, &present),
            format,
        })
    }

    /// The field differences between the file and the table.
    pub fn differences(&self) -> &FieldDifferences {
        &self.differences
    }

    /// Decodes a message into `row`.
    ///
    /// # Errors
    /// [`DecodeError`] if it is not a message of the file's schema.
    #[inline]
    pub fn decode(&self, data: &[u8], row: &mut Row) -> Result<(), DecodeError> {
        row.clear(self.channel);
        match &self.format {
            Format::Json(decoder) => decoder.decode(data, row),
            Format::Protobuf(decoder) => decoder.decode(data, row),
        }
    }
}
