//! The conformance suite of MCAP: its 416 files, rebuilt from the published description, and read.
//!
//! The suite combines six inputs with ten features of the format. The digests are those of the published lists of SHA-256
//! sums, so the rebuilt files have the published bytes.

use crate::raw::{PADDING, attachment, counted, map, record, text};
use crate::support::Folder;
use mcap::records::op;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeSet;
use toprise::archive::recording::{Condition, Overview, Recording, Selection};

/// An input: its name, what is in it, the number of its files, and the digest of the list of their SHA-256 sums.
struct Input {
    name: &'static str,
    content: Content,
    files: usize,
    digest: &'static str,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Content {
    Nothing,
    Attachment,
    Metadata,
    /// One message with or without schema.
    Message {
        has_schema: bool,
    },
    TenMessages,
}

const INPUTS: [Input; 6] = [
    Input {
        name: "NoData",
        content: Content::Nothing,
        files: 6,
        digest: "b44e4fcaa02a347a846c3a73cdacedb2760f052849d42770cc524df905e912b0",
    },
    Input {
        name: "OneSchemalessMessage",
        content: Content::Message { has_schema: false },
        files: 74,
        digest: "cc98bcbc33f2d30118337060fce1ded94dab10c48c966172fb9fca39222d7b3a",
    },
    Input {
        name: "OneMessage",
        content: Content::Message { has_schema: true },
        files: 154,
        digest: "aef6afb96b3307499b965743343a956c8b299a130d3197fa946573038d0a842c",
    },
    Input {
        name: "OneAttachment",
        content: Content::Attachment,
        files: 14,
        digest: "40a833056836d43242de4c6f1ade432318b9dd99bbdd7288af67e6e8ec66d2e1",
    },
    Input {
        name: "OneMetadata",
        content: Content::Metadata,
        files: 14,
        digest: "2cace83e09dc6c7273cb209c5753020726da2d56b8f49ab229261d8c15ab36cd",
    },
    Input {
        name: "TenMessages",
        content: Content::TenMessages,
        files: 154,
        digest: "5409ef83eaebca38cac56f6c84896368ce077675b162719b22c6784a53a0578c",
    },
];

/// Features: chunks, message index, statistics, repeated schemas and channels, index of attachments, metadata and chunks,
/// summary offsets, padded records.
const FEATURES: [&str; 10] = [
    "ch", "mx", "st", "rsh", "rch", "ax", "mdx", "chx", "sum", "pad",
];

/// Log times of the ten messages, which are not in order.
const TIMES: [u64; 10] = [0, 2, 1, 3, 3, 5, 4, 7, 8, 9];

type Features = BTreeSet<&'static str>;

impl Content {
    fn has_messages(self) -> bool {
        matches!(self, Self::Message { .. } | Self::TenMessages)
    }

    fn has_schema(self) -> bool {
        matches!(self, Self::Message { has_schema: true } | Self::TenMessages)
    }

    /// Whether the suite has a file with these features.
    fn allows(self, features: &Features) -> bool {
        let has = |name| features.contains(name);
        let in_summary = ["chx", "rsh", "rch", "mdx", "ax", "st"];
        !(has("ax") && self != Self::Attachment
            || has("mdx") && self != Self::Metadata
            || has("rsh") && !self.has_schema()
            || has("rch") && !self.has_messages()
            || has("ch") && !self.has_messages()
            || (has("chx") || has("mx")) && !has("ch")
            || has("sum") && !in_summary.into_iter().any(has))
    }

    fn schema(self) -> Option<Vec<u8>> {
        let schema = || {
            [
                &[1, 0],
                &text("Example")[..],
                &text("c"),
                &counted(&[4, 5, 6]),
            ]
            .concat()
        };
        self.has_schema().then(schema)
    }

    fn channel(self) -> Option<Vec<u8>> {
        if !self.has_messages() {
            return None;
        }
        let (ids, encoding, pairs): (_, _, &[_]) = if self.has_schema() {
            ([1, 0, 1, 0], "a", &[("foo", "bar")])
        } else {
            ([1, 0, 0, 0], "text", &[])
        };
        Some([&ids[..], &text("example"), &text(encoding), &map(pairs)].concat())
    }

    /// Sequence numbers, log times and publish times of the messages.
    fn messages(self) -> Vec<(u32, u64, u64)> {
        match self {
            Self::Message { .. } => vec![(10, 2, 1)],
            Self::TenMessages => (0..).zip(TIMES).map(|(n, time)| (n, time, time)).collect(),
            Self::Nothing | Self::Attachment | Self::Metadata => Vec::new(),
        }
    }
}

fn message_body(&(sequence, log_time, publish_time): &(u32, u64, u64)) -> Vec<u8> {
    [
        &[1, 0],
        &sequence.to_le_bytes()[..],
        &log_time.to_le_bytes(),
        &publish_time.to_le_bytes(),
        &[1, 2, 3],
    ]
    .concat()
}

/// Numbers of eight bytes.
fn numbers(numbers: &[u64]) -> Vec<u8> {
    numbers
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect()
}

/// A file of the suite while it is built.
struct Builder<'a> {
    content: Content,
    features: &'a Features,
    bytes: Vec<u8>,
    /// Bodies of chunk, attachment and metadata indexes.
    chunk_index: Vec<u8>,
    index: Vec<u8>,
    /// Groups of the summary: opcode, start and length.
    groups: Vec<(u8, u64, u64)>,
}

impl Builder<'_> {
    fn has(&self, feature: &str) -> bool {
        self.features.contains(feature)
    }

    /// Writes a record; returns its offset and length.
    fn write(&mut self, opcode: u8, body: &[u8]) -> [u64; 2] {
        let is_padded = !matches!(opcode, op::MESSAGE | op::CHUNK | op::DATA_END | op::FOOTER);
        let padding: &[u8] = if is_padded && self.has("pad") {
            &PADDING
        } else {
            &[]
        };
        let start = self.bytes.len() as u64;
        self.bytes.extend(record(opcode, &[body, padding].concat()));
        [start, self.bytes.len() as u64 - start]
    }

    fn build(mut self) -> Vec<u8> {
        self.bytes.extend(mcap::MAGIC);
        self.write(op::HEADER, &[0; 8]);
        match self.content {
            Content::Nothing => {}
            Content::Attachment => {
                let place = self.write(op::ATTACHMENT, &attachment("myFile", &[1, 2, 3]));
                let media_type = text("application/octet-stream");
                let fields = numbers(&[place[0], place[1], 2, 1, 3]);
                self.index = [fields, text("myFile"), media_type].concat();
            }
            Content::Metadata => {
                let body = [text("myMetadata"), map(&[("foo", "bar")])].concat();
                let place = self.write(op::METADATA, &body);
                self.index = [numbers(&place), text("myMetadata")].concat();
            }
            Content::Message { .. } | Content::TenMessages if self.has("ch") => self.chunk(),
            Content::Message { .. } | Content::TenMessages => {
                self.write_all(op::SCHEMA, self.content.schema());
                self.write_all(op::CHANNEL, self.content.channel());
                for message in self.content.messages() {
                    self.write(op::MESSAGE, &message_body(&message));
                }
            }
        }
        let checksum = crc32fast::hash(&self.bytes);
        self.write(op::DATA_END, &checksum.to_le_bytes());
        self.summary();
        self.bytes
    }

    fn write_all(&mut self, opcode: u8, bodies: impl IntoIterator<Item = Vec<u8>>) {
        for body in bodies {
            self.write(opcode, &body);
        }
    }

    fn chunk(&mut self) {
        let content = self.content;
        let mut records = Vec::new();
        records.extend(
            content
                .schema()
                .iter()
                .flat_map(|body| record(op::SCHEMA, body)),
        );
        records.extend(
            content
                .channel()
                .iter()
                .flat_map(|body| record(op::CHANNEL, body)),
        );
        let messages = content.messages();
        let mut entries = Vec::new();
        for message in &messages {
            entries.extend(numbers(&[message.1, records.len() as u64]));
            records.extend(record(op::MESSAGE, &message_body(message)));
        }
        let times = messages.iter().map(|message| message.1);
        let (first, last) = (times.clone().min().unwrap(), times.max().unwrap());
        let body = crate::raw::chunk((first, last), "", &records);
        let place = self.write(op::CHUNK, &body);
        let (mut offsets, mut length) = (Vec::new(), 0);
        if self.has("mx") {
            let body = [&[1, 0], &counted(&entries)[..]].concat();
            let index = self.write(op::MESSAGE_INDEX, &body);
            offsets = [&[1, 0], &index[0].to_le_bytes()[..]].concat();
            length = index[1];
        }
        let size = records.len() as u64;
        self.chunk_index = [
            numbers(&[first, last, place[0], place[1]]),
            counted(&offsets),
            numbers(&[length]),
            text(""),
            numbers(&[size, size]),
        ]
        .concat();
    }

    fn statistics(&self) -> Vec<u8> {
        let messages = self.content.messages();
        let times = || messages.iter().map(|message| message.1);
        let count = messages.len() as u64;
        let of_channel = if count > 0 {
            [&[1, 0], &count.to_le_bytes()[..]].concat()
        } else {
            Vec::new()
        };
        let counts = [
            u32::from(self.content.has_messages()),
            u32::from(self.content == Content::Attachment),
            u32::from(self.content == Content::Metadata),
            u32::from(self.has("ch")),
        ];
        let times = [times().min().unwrap_or(0), times().max().unwrap_or(0)];
        [
            numbers(&[count]),
            u16::from(self.content.has_schema()).to_le_bytes().to_vec(),
            counts
                .iter()
                .flat_map(|count| count.to_le_bytes())
                .collect(),
            numbers(&times),
            counted(&of_channel),
        ]
        .concat()
    }

    fn summary(&mut self) {
        let start = self.bytes.len();
        let groups = [
            ("rsh", op::SCHEMA, self.content.schema()),
            ("rch", op::CHANNEL, self.content.channel()),
            ("st", op::STATISTICS, Some(self.statistics())),
            ("mdx", op::METADATA_INDEX, Some(self.index.clone())),
            ("ax", op::ATTACHMENT_INDEX, Some(self.index.clone())),
            ("chx", op::CHUNK_INDEX, Some(self.chunk_index.clone())),
        ];
        for (feature, opcode, body) in groups {
            if let Some(body) = body.filter(|_| self.has(feature)) {
                let [start, length] = self.write(opcode, &body);
                self.groups.push((opcode, start, length));
            }
        }
        let summary_start = if self.bytes.len() > start {
            start as u64
        } else {
            0
        };
        let mut offset_start = 0;
        if self.has("sum") {
            offset_start = self.bytes.len() as u64;
            for (opcode, start, length) in self.groups.clone() {
                self.write(
                    op::SUMMARY_OFFSET,
                    &[&[opcode], &numbers(&[start, length])[..]].concat(),
                );
            }
        }
        let fields = numbers(&[summary_start, offset_start]);
        let head = [&[op::FOOTER], &20_u64.to_le_bytes()[..], &fields].concat();
        let checksum = crc32fast::hash(&[&self.bytes[start..], &head].concat());
        self.write(op::FOOTER, &[&fields[..], &checksum.to_le_bytes()].concat());
        self.bytes.extend(mcap::MAGIC);
    }
}

/// The files of an input with their names, in alphabetical order.
fn files(input: &Input) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for combination in 0..1 << FEATURES.len() {
        let chosen = FEATURES.iter().enumerate();
        let chosen = chosen.filter(|(bit, _)| combination >> bit & 1 == 1);
        let features: Features = chosen.map(|(_, name)| *name).collect();
        if !input.content.allows(&features) {
            continue;
        }
        let name = features
            .iter()
            .fold(input.name.to_owned(), |name, f| name + "-" + f);
        let builder = Builder {
            content: input.content,
            features: &features,
            bytes: Vec::new(),
            chunk_index: Vec::new(),
            index: Vec::new(),
            groups: Vec::new(),
        };
        files.push((name, builder.build()));
    }
    files.sort();
    files
}

#[test]
fn val_rebuilt_files_have_the_published_bytes() {
    let mut count = 0;
    for input in &INPUTS {
        let files = files(input);
        let sums = files
            .iter()
            .map(|(name, bytes)| format!("{name} {:x}\n", Sha256::digest(bytes)));
        let list: String = sums.collect();
        assert_eq!(files.len(), input.files, "{}", input.name);
        let digest = format!("{:x}", Sha256::digest(list));
        assert_eq!(digest, input.digest, "{}", input.name);
        count += files.len();
    }
    assert_eq!(count, 416);
}

#[test]
fn reads_all_files_of_the_conformance_suite() {
    let folder = Folder::new();
    for input in &INPUTS {
        for (name, bytes) in files(input) {
            let path = folder.write("file.mcap", bytes);
            check(&name, input.content, &Recording::open(&path).unwrap());
        }
    }
}

/// Checks that all content is found, in order of time, and that nothing is missing.
fn check(name: &str, content: Content, recording: &Recording) {
    let overview = Overview::new(recording);
    assert_eq!(overview.condition, Condition::Foreign, "{name}");
    assert_eq!(overview.losses, [], "{name}");
    let mut expected = content.messages();
    expected.sort_by_key(|message| message.1);
    let mut reader = recording.reader(Selection::default()).in_order_of_time();
    let mut found = Vec::new();
    while let Some(message) = reader.next_undecoded() {
        assert_eq!(
            (message.channel.topic.as_str(), message.data),
            ("example", &[1, 2, 3][..])
        );
        assert_eq!(
            message.channel.schema.is_some(),
            content.has_schema(),
            "{name}"
        );
        found.push((message.sequence, message.log_time, message.publish_time));
    }
    assert_eq!(found, expected, "{name}");
    assert_eq!(overview.messages(), expected.len() as u64, "{name}");
    let metadata: Vec<_> = recording.all_metadata().collect();
    let attachments: Vec<_> = recording.attachments().collect();
    match content {
        Content::Attachment => assert_eq!(attachments, [("myFile", 3)], "{name}"),
        Content::Metadata => {
            assert_eq!(metadata[0].0, "myMetadata", "{name}");
            assert_eq!(metadata[0].1["foo"], "bar", "{name}");
        }
        Content::Nothing | Content::Message { .. } | Content::TenMessages => {
            assert_eq!((metadata.len(), attachments.len()), (0, 0), "{name}");
        }
    }
}
