//! Messages as Protocol Buffers: one message type per channel, package `toprise`, with a
//! `google.protobuf.Timestamp` as field 1, then the members in table order; vectors, quaternions and
//! groups of terms are messages nested in it.
//!
//! All numbers are doubles and always written, so that negative zeros are preserved.

use super::decoding::{DecodeError, Object, Paths, Row, SchemaError, Storage, WireError};
use super::schema::with_unit_and_frame;
use super::template::{Slot, Template};
use super::wire::{Wire, take_field};
use crate::run::time::{NANOSECONDS, seconds_and_nanoseconds};
use crate::telemetry::message::Message;
use crate::telemetry::table::channel::{ChannelInfo, Content, Member};
use prost::Message as _;
use prost::encoding::{WireType, encode_key, encode_varint};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

const PACKAGE: &str = "toprise";
const TIMESTAMP_TYPE: &str = "google.protobuf.Timestamp";
const TIMESTAMP_FILE: &str = "google/protobuf/timestamp.proto";
/// The number of the first member's field; the timestamp has 1.
const FIRST_FIELD: u32 = 2;

/// The schema of a channel's messages: its file and the imported file, serialized.
pub fn file_descriptor_set(channel: &ChannelInfo) -> Vec<u8> {
    let set = FileDescriptorSet {
        // MCAP requires that the set includes the imported files.
        file: vec![timestamp_file(), file_descriptor(channel)],
    };
    set.encode_to_vec()
}

/// The schema of a channel's messages as a `.proto` file, with units, frames and descriptions as comments.
pub fn proto_file(channel: &ChannelInfo) -> String {
    let mut lines = vec![
        format!("// {}: {}", channel.topic, channel.meaning),
        String::new(),
        "syntax = \"proto3\";".to_owned(),
        String::new(),
        format!("package {PACKAGE};"),
        String::new(),
        format!("import \"{TIMESTAMP_FILE}\";"),
        String::new(),
        format!("message {} {{", message_name(channel)),
    ];
    let members = channel.members();
    for (name, leaves) in nested_types(channel, &members) {
        lines.push(format!("  message {name} {{"));
        for (leaf, number) in leaves.iter().zip(1..) {
            lines.push(format!("    double {leaf} = {number};"));
        }
        lines.extend(["  }".to_owned(), String::new()]);
    }
    lines.push("  // simulation time since the start".to_owned());
    lines.push(format!("  {TIMESTAMP_TYPE} timestamp = 1;"));
    for ((name, content), number) in members.iter().zip(FIRST_FIELD..) {
        for comment in comments(channel, content) {
            lines.push(format!("  // {comment}"));
        }
        let kind = match content {
            Content::Text(_) => "string".to_owned(),
            Content::Number(_) => "double".to_owned(),
            Content::Object(leaves) => nested_name(channel, name, leaves),
        };
        lines.push(format!("  {kind} {name} = {number};"));
    }
    lines.extend(["}".to_owned(), String::new()]);
    lines.join("\n")
}

/// The name of a channel's `.proto` file in `schemas/`.
pub fn proto_file_name(channel: &ChannelInfo) -> String {
    format!("{}.proto", channel.schema)
}

/// Comments on a member: one line, or one for each number of a group of terms.
fn comments(channel: &ChannelInfo, content: &Content<'_>) -> Vec<String> {
    match content {
        Content::Text(index) => vec![channel.texts[*index].meaning.to_owned()],
        Content::Number(index) => {
            let leaf = &channel.numbers[*index];
            vec![with_unit_and_frame(leaf.meaning, leaf)]
        }
        Content::Object(leaves) if is_components(channel, leaves) => {
            let leaf = &channel.numbers[leaves[0].1];
            vec![with_unit_and_frame(leaf.meaning, leaf)]
        }
        Content::Object(leaves) => leaves
            .iter()
            .map(|(name, index)| {
                let leaf = &channel.numbers[*index];
                format!("{name}: {}", with_unit_and_frame(leaf.meaning, leaf))
            })
            .collect(),
    }
}

fn message_name(channel: &ChannelInfo) -> &str {
    let prefix = channel.schema.strip_prefix(PACKAGE);
    prefix.map_or(channel.schema, |name| name.trim_start_matches('.'))
}

/// Whether these are the components of one quantity.
fn is_components(channel: &ChannelInfo, leaves: &[(&str, usize)]) -> bool {
    leaves
        .iter()
        .all(|(_, index)| channel.numbers[*index].is_component)
}

/// The name of the message type of an object.
fn nested_name(channel: &ChannelInfo, member: &str, leaves: &[(&str, usize)]) -> String {
    match leaves.len() {
        3 if is_components(channel, leaves) => "Vector3".to_owned(),
        4 if is_components(channel, leaves) => "Quaternion".to_owned(),
        _ => member.split('_').map(capitalized).collect(),
    }
}

fn capitalized(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}

/// The message types nested in a channel's, each with the names of its fields.
fn nested_types<'a>(channel: &ChannelInfo, members: &[Member<'a>]) -> Vec<(String, Vec<&'a str>)> {
    let mut types: Vec<(String, Vec<&str>)> = Vec::new();
    for (name, content) in members {
        if let Content::Object(leaves) = content {
            let name = nested_name(channel, name, leaves);
            // All vectors of a message share the type `Vector3`.
            if types.iter().all(|(known, _)| *known != name) {
                types.push((name, leaves.iter().map(|(leaf, _)| *leaf).collect()));
            }
        }
    }
    types
}

fn file_descriptor(channel: &ChannelInfo) -> FileDescriptorProto {
    let members = channel.members();
    let name = message_name(channel);
    let nested = nested_types(channel, &members);
    let nested_type = nested.iter().map(|(name, leaves)| DescriptorProto {
        name: Some(name.clone()),
        field: leaves
            .iter()
            .zip(1..)
            .map(|(leaf, number)| field(leaf, number, Type::Double, None))
            .collect(),
        ..DescriptorProto::default()
    });
    let stamp = format!(".{TIMESTAMP_TYPE}");
    let mut fields = vec![field("timestamp", 1, Type::Message, Some(stamp))];
    // Numbers follow from the order in the table. Readers go by the names in the file's schema, so a new field may
    // shift them.
    for ((member, content), number) in members.iter().zip(FIRST_FIELD as i32..) {
        fields.push(match content {
            Content::Text(_) => field(member, number, Type::String, None),
            Content::Number(_) => field(member, number, Type::Double, None),
            Content::Object(leaves) => {
                let nested = nested_name(channel, member, leaves);
                let kind = format!(".{PACKAGE}.{name}.{nested}");
                field(member, number, Type::Message, Some(kind))
            }
        });
    }
    FileDescriptorProto {
        name: Some(proto_file_name(channel)),
        package: Some(PACKAGE.to_owned()),
        dependency: vec![TIMESTAMP_FILE.to_owned()],
        message_type: vec![DescriptorProto {
            name: Some(name.to_owned()),
            field: fields,
            nested_type: nested_type.collect(),
            ..DescriptorProto::default()
        }],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    }
}

fn timestamp_file() -> FileDescriptorProto {
    FileDescriptorProto {
        name: Some(TIMESTAMP_FILE.to_owned()),
        package: Some("google.protobuf".to_owned()),
        message_type: vec![DescriptorProto {
            name: Some("Timestamp".to_owned()),
            field: vec![
                field("seconds", 1, Type::Int64, None),
                field("nanos", 2, Type::Int32, None),
            ],
            ..DescriptorProto::default()
        }],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    }
}

fn field(name: &str, number: i32, kind: Type, type_name: Option<String>) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        // Descriptors call every field of proto3 that is not repeated optional.
        label: Some(Label::Optional.into()),
        r#type: Some(kind.into()),
        type_name,
        json_name: Some(json_name(name)),
        ..FieldDescriptorProto::default()
    }
}

/// The name of a field in protobuf's JSON mapping, as written by `protoc`: `phi_dot` becomes `phiDot`.
fn json_name(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |all, word| all + &capitalized(word))
}

/// Appends the message to `out` as protobuf.
pub(super) fn encode(template: &Template, message: &Message<'_>, out: &mut Vec<u8>) {
    encode_timestamp(message.time_ns, out);
    let mut numbers = message.numbers.iter();
    let mut texts = message.texts.iter();
    for Slot { before, is_text } in &template.slots {
        out.extend_from_slice(before);
        if *is_text {
            let text = texts.next().map_or("", String::as_str);
            encode_varint(text.len() as u64, out);
            out.extend_from_slice(text.as_bytes());
        } else {
            let number = numbers.next().copied().unwrap_or(0.0);
            out.extend_from_slice(&number.to_le_bytes());
        }
    }
}

fn encode_timestamp(time_ns: u64, out: &mut Vec<u8>) {
    let (seconds, nanoseconds) = seconds_and_nanoseconds(time_ns);
    let mut inner = Vec::with_capacity(16);
    encode_key(1, WireType::Varint, &mut inner);
    encode_varint(seconds, &mut inner);
    encode_key(2, WireType::Varint, &mut inner);
    encode_varint(nanoseconds, &mut inner);
    encode_key(1, WireType::LengthDelimited, out);
    encode_varint(inner.len() as u64, out);
    out.extend_from_slice(&inner);
}

/// The template of a channel's messages.
pub(super) fn template(channel: &ChannelInfo) -> Template {
    let mut slots = Vec::new();
    for ((_, content), number) in channel.members().iter().zip(FIRST_FIELD..) {
        let mut before = Vec::new();
        match content {
            Content::Text(_) => {
                encode_key(number, WireType::LengthDelimited, &mut before);
                slots.push(Slot::text(before));
            }
            Content::Number(_) => {
                encode_key(number, WireType::SixtyFourBit, &mut before);
                slots.push(Slot::number(before));
            }
            Content::Object(leaves) => {
                encode_key(number, WireType::LengthDelimited, &mut before);
                // Each number has one byte for its key and eight for its value.
                encode_varint(leaves.len() as u64 * 9, &mut before);
                for (_, inner) in leaves.iter().zip(1..) {
                    encode_key(inner, WireType::SixtyFourBit, &mut before);
                    slots.push(Slot::number(std::mem::take(&mut before)));
                }
            }
        }
    }
    let end = Vec::new();
    Template { slots, end }
}

/// Reads the protobuf messages of one channel.
#[derive(Clone, Debug)]
pub(super) struct ProtobufDecoder {
    message: Object<u32>,
    /// Numbers in the file; in proto3 a missing field is zero.
    present: Vec<usize>,
}

impl ProtobufDecoder {
    /// A decoder for the table's `channel`, as described by the descriptors of a file; and the paths of the leaves in
    /// the file.
    pub(super) fn new(
        channel: &ChannelInfo,
        name: &str,
        schema: &[u8],
    ) -> Result<(Self, Vec<String>), SchemaError> {
        let set = FileDescriptorSet::decode(schema)?;
        let root =
            find_message(&set, name).ok_or_else(|| SchemaError::NoMessage(name.to_owned()))?;
        let mut builder = Builder {
            set: &set,
            channel,
            paths: Paths::default(),
            present: Vec::new(),
        };
        let message = builder.object(root, "", 0)?;
        let Builder { paths, present, .. } = builder;
        Ok((Self { message, present }, paths.leaves))
    }

    pub(super) fn decode(&self, data: &[u8], row: &mut Row) -> Result<(), DecodeError> {
        for number in &self.present {
            row.numbers[*number] = 0.0;
        }
        Ok(self.message.fill(data, row)?)
    }
}

/// Builds the tree of targets from descriptors.
struct Builder<'a> {
    set: &'a FileDescriptorSet,
    channel: &'a ChannelInfo,
    paths: Paths,
    present: Vec<usize>,
}

impl Builder<'_> {
    /// The fields of a message type at a path; `depth` guards against types that contain themselves.
    fn object(
        &mut self,
        message: &DescriptorProto,
        prefix: &str,
        depth: usize,
    ) -> Result<Object<u32>, SchemaError> {
        let mut fields = Vec::new();
        for field in &message.field {
            // No field on the wire has the number 0, so a negative number matches none.
            let number = u32::try_from(field.number()).unwrap_or(0);
            fields.push((number, self.target(field, prefix, depth)?));
        }
        Ok(Object(fields))
    }

    fn target(
        &mut self,
        field: &FieldDescriptorProto,
        prefix: &str,
        depth: usize,
    ) -> Result<Storage<u32>, SchemaError> {
        let path = format!("{prefix}{}", field.name());
        self.paths.count(&path)?;
        // The table has no lists.
        if field.label() == Label::Repeated {
            self.paths.leaves.push(path);
            return Ok(Storage::Skipped);
        }
        if field.r#type() == Type::Message && depth < 8 {
            let name = field.type_name().trim_start_matches('.');
            if path == "timestamp" && name == TIMESTAMP_TYPE {
                let parts = [(1, Storage::Seconds), (2, Storage::Nanoseconds)];
                return Ok(Storage::Object(Object(parts.into())));
            }
            if let Some(inner) = find_message(self.set, name) {
                let object = self.object(inner, &format!("{path}."), depth + 1)?;
                return Ok(Storage::Object(object));
            }
        }
        let target = Storage::for_field(self.channel, &path);
        match (field.r#type(), &target) {
            (Type::Double, Storage::Number(index)) => self.present.push(*index),
            (Type::String, Storage::Text(_)) | (_, Storage::Skipped) => {}
            // A field of the table with another type counts as unknown.
            (kind, _) => {
                let path = format!("{path} (as {})", kind.as_str_name());
                self.paths.leaves.push(path);
                return Ok(Storage::Skipped);
            }
        }
        self.paths.leaves.push(path);
        Ok(target)
    }
}

/// The message type with a full name, e.g. `toprise.State`.
fn find_message<'a>(set: &'a FileDescriptorSet, name: &str) -> Option<&'a DescriptorProto> {
    set.file.iter().find_map(|file| {
        let local = match file.package() {
            "" => Some(name),
            package => name.strip_prefix(package)?.strip_prefix('.'),
        }?;
        let mut parts = local.split('.');
        let first = parts.next()?;
        let mut found = file.message_type.iter().find(|m| m.name() == first)?;
        for part in parts {
            found = found.nested_type.iter().find(|m| m.name() == part)?;
        }
        Some(found)
    })
}

impl Object<u32> {
    /// Reads the fields of a message.
    fn fill(&self, mut data: &[u8], row: &mut Row) -> Result<(), WireError> {
        let mut next = 0;
        while !data.is_empty() {
            let (number, wire) = take_field(&mut data)?;
            match (self.find(number, &mut next), wire) {
                (Some(Storage::Number(index)), Wire::Eight(bits)) => {
                    row.numbers[*index] = f64::from_bits(bits);
                }
                (Some(Storage::Object(object)), Wire::Bytes(inner)) => object.fill(inner, row)?,
                (Some(Storage::Text(index)), Wire::Bytes(bytes)) => {
                    let text = std::str::from_utf8(bytes)?;
                    row.texts[*index].clear();
                    row.texts[*index].push_str(text);
                }
                (Some(Storage::Seconds), Wire::Varint(seconds)) => {
                    row.add_time(seconds.checked_mul(NANOSECONDS))?;
                }
                (Some(Storage::Nanoseconds), Wire::Varint(part)) => row.add_time(Some(part))?,
                // Other readers skip unknown fields. Here a field that the file's own schema lacks shows damage.
                (None, _) => return Err(WireError::UnknownField(number)),
                (Some(Storage::Skipped), wire) if !matches!(wire, Wire::End) => {}
                (Some(_), _) => return Err(WireError::WireType(number)),
            }
        }
        Ok(())
    }

    /// The target of a field.
    #[inline]
    fn find(&self, number: u32, next: &mut usize) -> Option<&Storage<u32>> {
        let position = self.position(*next, |known| *known == number)?;
        *next = position + 1;
        Some(&self.0[position].1)
    }
}
