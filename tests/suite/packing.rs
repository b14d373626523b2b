//! Recordings that the writer of the crate `mcap` packs otherwise, with all its options.

use crate::damage::in_parallel;
use crate::forgeries::forgery::{Forgery, Record as Forged};
use crate::support::{Folder, assert_contains, recorded, scenario, verified};
use mcap::read::ChunkFlattener;
use mcap::records::{Record, op};
use mcap::{Attachment, Compression, WriteOptions, Writer};
use std::io::Cursor;
use std::path::Path;
use std::sync::Mutex;
use toprise::analysis::diff::{self, Options};
use toprise::archive::recording::{Condition, Overview, Recording};
use toprise::archive::verify::Verdict;
use toprise::archive::writer::Form;

/// A record that writers may leave out, or another option of theirs.
type Choice = (&'static str, fn(WriteOptions, bool) -> WriteOptions);

/// Options that decide which records readers find.
const RECORDS: [Choice; 9] = [
    ("chunks", WriteOptions::use_chunks),
    ("message indexes", WriteOptions::emit_message_indexes),
    ("chunk indexes", WriteOptions::emit_chunk_indexes),
    ("attachment indexes", WriteOptions::emit_attachment_indexes),
    ("metadata indexes", WriteOptions::emit_metadata_indexes),
    ("statistics", WriteOptions::emit_statistics),
    ("repeated channels", WriteOptions::repeat_channels),
    ("repeated schemas", WriteOptions::repeat_schemas),
    ("checksums and offsets", checksums_and_offsets),
];

fn checksums_and_offsets(options: WriteOptions, is_on: bool) -> WriteOptions {
    options
        .calculate_chunk_crcs(is_on)
        .calculate_data_section_crc(is_on)
        .calculate_summary_section_crc(is_on)
        .calculate_attachment_crcs(is_on)
        .emit_summary_offsets(is_on)
}

fn original() -> Vec<u8> {
    let scenario = scenario("paper", &[("stop.duration", "0.02")]);
    recorded(&scenario, &[], Form::default())
}

/// Writes the content of a recording anew.
fn rewrite(bytes: &[u8], options: WriteOptions) -> Vec<u8> {
    let library = "toprise/".to_owned() + env!("CARGO_PKG_VERSION");
    let options = options.library(library).profile("");
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    for record in ChunkFlattener::new(bytes).unwrap() {
        if !copy(record.unwrap(), &mut writer) {
            break;
        }
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// Writes a record; returns false at the end of the data.
fn copy(record: Record<'_>, writer: &mut Writer<Cursor<Vec<u8>>>) -> bool {
    match record {
        Record::Schema { header, data } => {
            let (id, name, encoding) = (header.id, &header.name, &header.encoding);
            writer
                .add_schema_with_id(id, name, encoding, &data)
                .unwrap();
        }
        Record::Channel(c) => {
            let (id, topic, encoding) = (c.id, &c.topic, &c.message_encoding);
            writer
                .add_channel_with_id(id, c.schema_id, topic, encoding, &c.metadata)
                .unwrap();
        }
        Record::Message { header, data } => writer.write_to_known_channel(&header, &data).unwrap(),
        Record::Metadata(metadata) => writer.write_metadata(&metadata).unwrap(),
        Record::Attachment { header, data, .. } => writer
            .attach(&Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            })
            .unwrap(),
        Record::DataEnd(_) => return false,
        _ => {}
    }
    true
}

/// The fault of a repacked recording, if it has one.
fn fault(original: &Recording, path: &Path) -> Option<String> {
    let report = verified(path);
    if report.verdict != Verdict::Verified {
        return Some(format!("{report:?}"));
    }
    let recording = Recording::open(path).unwrap();
    let overview = Overview::new(&recording);
    let (condition, losses) = (overview.condition, overview.losses);
    if condition != Condition::Whole || !losses.is_empty() {
        return Some(format!("{condition:?}, {losses:?}"));
    }
    let options = Options {
        integration_error: false,
        ..Options::default()
    };
    let verdict = diff::compare(original, &recording, &options)
        .unwrap()
        .verdict;
    (verdict != diff::Verdict::Identical).then(|| format!("{verdict:?}"))
}

#[test]
fn verifies_every_way_of_packing() {
    let folder = Folder::new();
    let bytes = original();
    let path = folder.write("original.mcap", &bytes);
    let original = Recording::open(&path).unwrap();
    let faults = Mutex::new(Vec::new());
    let all: Vec<usize> = (0..1 << RECORDS.len()).collect();
    in_parallel(&all, |path, choices| {
        // Chunks are compressed in every second case.
        let compression = choices.count_ones().is_multiple_of(2);
        let mut options = WriteOptions::new()
            .compression(compression.then_some(Compression::Zstd))
            .compression_threads(0)
            .chunk_size(Some(8 << 10));
        let mut without = Vec::new();
        for (bit, (name, choose)) in RECORDS.into_iter().enumerate() {
            let is_on = choices & (1 << bit) == 0;
            options = choose(options, is_on);
            if !is_on {
                without.push(name);
            }
        }
        std::fs::write(path, rewrite(&bytes, options)).unwrap();
        if let Some(found) = fault(&original, path) {
            let without = without.join(", ");
            faults
                .lock()
                .unwrap()
                .push(format!("without {without}: {found}"));
        }
    });
    let faults = faults.into_inner().unwrap();
    assert!(
        faults.is_empty(),
        "{} faults, e.g. {}",
        faults.len(),
        faults[0]
    );
}

#[test]
fn verifies_files_without_summary() {
    let folder = Folder::new();
    let bytes = original();
    let original = Recording::open(&folder.write("original.mcap", &bytes)).unwrap();
    for is_chunked in [true, false] {
        let options = WriteOptions::new()
            .use_chunks(is_chunked)
            .emit_summary_records(false)
            .emit_summary_offsets(false);
        let path = folder.write("a.mcap", rewrite(&bytes, options));
        assert_eq!(fault(&original, &path), None, "chunks: {is_chunked}");
        let shown = folder.toprise("info a.mcap", 0);
        assert_contains(&shown.stdout, "complete");
    }
}

/// Without a checksum of the data nothing shows whether an unknown opcode is a damaged one.
#[test]
fn skips_unknown_opcodes_without_checksum() {
    let folder = Folder::new();
    let bytes = original();
    let original = Recording::open(&folder.write("original.mcap", &bytes)).unwrap();
    for opcode in [0x10, 0x7f, 0x80, 0xff] {
        let mut forgery = Forgery::of(&bytes);
        let record = Forged::Other((opcode, b"by someone".to_vec()));
        forgery.records.insert(1, record);
        let mut bytes = forgery.bytes();
        // The footer's first number says where the summary begins: after the checksum.
        let footer = bytes.len() - mcap::MAGIC.len() - 20;
        let summary = u64::from_le_bytes(bytes[footer..footer + 8].try_into().unwrap()) as usize;
        bytes[summary - 4..summary].fill(0);
        let path = folder.write("private.mcap", &bytes);
        assert_eq!(fault(&original, &path), None, "{opcode:#x}");
    }
}

#[test]
fn all_commands_report_contradictory_statistics() {
    let folder = Folder::new();
    let bytes = original();
    folder.write("original.mcap", &bytes);
    // Offsets of the numbers in the record.
    for (name, at) in [
        ("messages", 0),
        ("channels", 10),
        ("chunks", 22),
        ("last time", 34),
    ] {
        let mut forgery = Forgery::of(&bytes);
        forgery.in_summary(op::STATISTICS, move |body| body[at] ^= 1);
        folder.write("a.mcap", forgery.bytes());
        let fact = format!("the statistics contradict the content: {name}");
        let info = folder.toprise("info a.mcap", 3).stdout;
        assert_contains(&info, "altered");
        assert_contains(&info, &fact);
        let diff = folder.toprise("diff original.mcap a.mcap --no-integration-error", 3);
        assert_contains(&diff.stdout, &fact);
        assert_contains(&folder.toprise("explain a.mcap", 3).stdout, &fact);
        let verify = folder.toprise("verify a.mcap", 1).stdout;
        assert_contains(&verify, &format!("the statistics, {name}"));
    }
}
