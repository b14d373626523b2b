//! MCAP files built byte by byte: what other writers do and the writer of the `mcap` crate doesn't.

use mcap::records::op;

/// Bytes that a newer version of the format could add to a record.
pub const PADDING: [u8; 3] = [0x01, 0xff, 0xff];

/// A record with its opcode and length.
pub fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

/// Bytes preceded by their length.
pub fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

/// A text preceded by its length.
pub fn text(text: &str) -> Vec<u8> {
    counted(text.as_bytes())
}

/// A map of texts, preceded by its length.
pub fn map(pairs: &[(&str, &str)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (key, value) in pairs {
        bytes.extend(text(key));
        bytes.extend(text(value));
    }
    counted(&bytes)
}

/// The header of a file with an empty profile.
pub fn header(library: &str) -> Vec<u8> {
    record(op::HEADER, &[text(""), text(library)].concat())
}

/// The body of a channel of JSON messages without a schema.
pub fn channel(id: u16, topic: &str) -> Vec<u8> {
    let ids = [id.to_le_bytes(), [0; 2]].concat();
    [ids, text(topic), text("json"), map(&[])].concat()
}

/// A message whose log and publish time are equal.
pub fn message(channel: u16, sequence: u32, time_ns: u64, data: &[u8]) -> Vec<u8> {
    let times = [time_ns.to_le_bytes(), time_ns.to_le_bytes()].concat();
    let body = [
        &channel.to_le_bytes(),
        &sequence.to_le_bytes()[..],
        &times,
        data,
    ]
    .concat();
    record(op::MESSAGE, &body)
}

/// The body of a chunk with these times, compressed with zstd or not at all.
pub fn chunk((first, last): (u64, u64), compression: &str, records: &[u8]) -> Vec<u8> {
    let data = match compression {
        "zstd" => zstd::bulk::compress(records, 1).unwrap(),
        _ => records.to_vec(),
    };
    [
        &first.to_le_bytes()[..],
        &last.to_le_bytes(),
        &(records.len() as u64).to_le_bytes(),
        &crc32fast::hash(records).to_le_bytes(),
        &text(compression),
        &(data.len() as u64).to_le_bytes(),
        &data,
    ]
    .concat()
}

/// The body of an attachment with a checksum.
pub fn attachment(name: &str, data: &[u8]) -> Vec<u8> {
    let times = [2_u64.to_le_bytes(), 1_u64.to_le_bytes()].concat();
    let length = (data.len() as u64).to_le_bytes();
    let body = [
        &times,
        &text(name),
        &text("application/octet-stream"),
        &length[..],
        data,
    ]
    .concat();
    let checksum = crc32fast::hash(&body).to_le_bytes();
    [&body[..], &checksum].concat()
}

/// A complete file of these records, without a summary.
pub fn file(records: &[&[u8]]) -> Vec<u8> {
    with_summary(records, &[])
}

/// A complete file of these records, and of those of its summary.
pub fn with_summary(records: &[&[u8]], summary: &[&[u8]]) -> Vec<u8> {
    let data = [mcap::MAGIC, &records.concat()].concat();
    let end = record(op::DATA_END, &crc32fast::hash(&data).to_le_bytes());
    let start = match summary.len() {
        0 => 0,
        _ => (data.len() + end.len()) as u64,
    };
    let footer = record(op::FOOTER, &[&start.to_le_bytes()[..], &[0; 12]].concat());
    [&data[..], &end, &summary.concat(), &footer, mcap::MAGIC].concat()
}

/// The body of a schema.
pub fn schema(id: u16, name: &str) -> Vec<u8> {
    let texts = [text(name), text("jsonschema"), counted(b"{}")];
    [&id.to_le_bytes()[..], &texts.concat()].concat()
}

/// The body of statistics of a file without attachments and metadata. Messages are counted by channel if `counts` are given.
pub fn statistics(
    [messages, schemas, channels, chunks]: [u32; 4],
    (first, last): (u64, u64),
    counts: &[(u16, u64)],
) -> Vec<u8> {
    let mut map = Vec::new();
    for (channel, count) in counts {
        map.extend(channel.to_le_bytes());
        map.extend(count.to_le_bytes());
    }
    [
        &u64::from(messages).to_le_bytes()[..],
        &(schemas as u16).to_le_bytes(),
        &channels.to_le_bytes(),
        &[0; 8],
        &chunks.to_le_bytes(),
        &first.to_le_bytes(),
        &last.to_le_bytes(),
        &counted(&map),
    ]
    .concat()
}
