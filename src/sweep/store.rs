//! Files of a sweep: parts and the complete table.

use super::checksum;
use super::counts::Counts;
use super::error::{FileProblem, SweepError};
use super::part::{COUNTS_ENTRY, Sweep, counts_entry, part_bytes, properties, row_group};
use super::spec::change::change;
use crate::archive::input::{open_file, read_file};
use crate::archive::publish::{self, Draft, Existing, is_same_file};
use crate::archive::sink::SinkError;
use arrow_array::RecordBatch;
use bytes::Bytes;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::column::writer::ColumnCloseResult;
use parquet::errors::ParquetError;
use parquet::file::metadata::{KeyValue, ParquetMetaData, ParquetMetaDataReader};
use parquet::file::reader::ChunkReader;
use parquet::file::writer::SerializedFileWriter;
use serde_json::Value as Json;
use sha2::{Digest as _, Sha256};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The entry of the table's metadata with the spec.
pub(super) const SPEC_ENTRY: &str = "toprise.sweep";

/// The entry of a part's metadata that names its sweep: the SHA-256 of the spec; and which part.
const PART_ENTRY: &str = "toprise.part";

/// The file in the directory of parts with the spec of their sweep.
const SPEC_FILE: &str = "sweep.json";

/// The directory for the parts of a table.
pub fn parts_directory(table: &Path) -> PathBuf {
    table.with_added_extension("parts")
}

/// Paths of a sweep's files.
pub(super) struct Store<'a> {
    pub(super) sweep: &'a Sweep,
    /// The spec as JSON, which identifies the sweep.
    identity: Json,
    /// The SHA-256.
    digest: String,
    table: &'a Path,
    parts: PathBuf,
}

/// An existing, undamaged part.
struct ExistingPart {
    file: File,
    metadata: ParquetMetaData,
    counts: Counts,
}

impl<'a> Store<'a> {
    /// The paths next to a table.
    ///
    /// # Errors
    /// [`SweepError::Sink`] if the table's name is invalid, or an input file would be overwritten.
    pub(super) fn new(sweep: &'a Sweep, table: &'a Path) -> Result<Self, SweepError> {
        publish::check_name(table)?;
        let identity = sweep.spec().to_json();
        let store = Self {
            sweep,
            digest: format!("{:x}", Sha256::digest(identity.to_string())),
            identity,
            table,
            parts: parts_directory(table),
        };
        for input in sweep.spec().inputs() {
            if store.would_replace(input) {
                let path = input.to_owned();
                return Err(SinkError::IsInUse { path }.into());
            }
        }
        Ok(store)
    }

    /// Whether an input is the table, or in the place of a part.
    fn would_replace(&self, input: &Path) -> bool {
        let name = input.file_name().unwrap_or_default();
        is_same_file(input, self.table)
            || self.is_own(&name.to_string_lossy()) && is_same_file(input, &self.parts.join(name))
    }

    /// The counts of the complete table; `None` if there is no table yet.
    ///
    /// # Errors
    /// If the existing file is not this table.
    pub(super) fn finished(&self) -> Result<Option<Counts>, SweepError> {
        let table = self.table;
        // Not `exists`, which follows links: a dangling one is in the way, too.
        if table.symlink_metadata().is_err() {
            return Ok(None);
        }
        let not_a_table = || SweepError::unusable(table, FileProblem::NotATable);
        let file = open_file(table).map_err(|reason| SweepError::io("read", table, reason))?;
        let metadata = metadata(&file).map_err(|_| not_a_table())?;
        let spec = entry(&metadata, SPEC_ENTRY).ok_or_else(not_a_table)?;
        check_same_sweep(table, spec, &self.identity)?;
        if !checksum::is_right(&file).map_err(|reason| SweepError::io("read", table, reason))? {
            return Err(SweepError::unusable(table, FileProblem::Modified));
        }
        counts(&metadata).map(Some).ok_or_else(not_a_table)
    }

    /// Creates the parts directory or checks that it belongs to this sweep, and rejects invalid table names early.
    ///
    /// # Errors
    /// [`SweepError::File`] if the directory belongs to another sweep, [`SweepError::Sink`] if a file can't be created.
    pub(super) fn open(&self) -> Result<(), SweepError> {
        let text = format!("{:#}\n", self.identity);
        match publish::write(&self.spec_file(), Existing::Keep, text.as_bytes()) {
            Ok(()) | Err(SinkError::Exists { .. }) => {}
            Err(error) => return Err(error.into()),
        }
        self.check_parts()?;
        // Dropped at once: a name that can't be written shows now, and not after hours of work.
        self.draft()?;
        Ok(())
    }

    /// Checks that the directory of the parts, if there is one, belongs to this sweep.
    ///
    /// # Errors
    /// [`SweepError::File`] if it belongs to another one.
    pub(super) fn check_parts(&self) -> Result<(), SweepError> {
        let path = self.spec_file();
        match read_file(&path) {
            Ok(text) => check_same_sweep(&self.parts, &text, &self.identity),
            Err(error) => match error.kind() {
                io::ErrorKind::NotFound => Ok(()),
                // What is not text is no spec either.
                io::ErrorKind::InvalidData => Err(SweepError::unusable(
                    &self.parts,
                    FileProblem::UnreadableSpec,
                )),
                _ => Err(SweepError::io("read", &path, error)),
            },
        }
    }

    fn spec_file(&self) -> PathBuf {
        self.parts.join(SPEC_FILE)
    }

    /// A draft of the table, in the parts directory so that leftovers are removed with it.
    fn draft(&self) -> Result<Draft, SinkError> {
        Draft::within(&self.parts, self.table, Existing::Keep)
    }

    /// The file of a part.
    fn path(&self, part: u64) -> PathBuf {
        self.parts.join(part_name(part))
    }

    /// The counts of a part; `None` if it is missing, or damaged and must be computed again.
    ///
    /// # Errors
    /// [`SweepError::File`] if it belongs to another sweep.
    pub(super) fn counts(&self, part: u64) -> Result<Option<Counts>, SweepError> {
        Ok(self.found(part)?.map(|found| found.counts))
    }

    /// Writes a part atomically, replacing a damaged part or an identical one of another process.
    ///
    /// # Errors
    /// [`SweepError::Sink`] if the file can't be written, e.g. if the disk is full.
    pub(super) fn write(
        &self,
        part: u64,
        batch: &RecordBatch,
        counts: &Counts,
    ) -> Result<(), SweepError> {
        let name = KeyValue::new(PART_ENTRY.to_owned(), self.name(part));
        let bytes = part_bytes(batch, counts, name)?;
        Ok(publish::write(&self.path(part), Existing::Replace, &bytes)?)
    }

    /// The value of [`PART_ENTRY`] of a part.
    fn name(&self, part: u64) -> String {
        // Parts of another size have other rows, though the sweep is the same.
        format!("{} {part} of {} rows", self.digest, self.sweep.part_rows())
    }

    /// Merges all parts into the table and removes them.
    ///
    /// # Errors
    /// [`SweepError::File`] for a missing or damaged part.
    pub(super) fn merge(&self) -> Result<(), SweepError> {
        match self.merge_into(self.draft()?) {
            // The directory of parts may be a link to another disk, from which a file can't be renamed.
            Err(SweepError::Sink(error)) if is_on_another_disk(&error) => {
                self.merge_into(Draft::new(self.table, Existing::Keep)?)
            }
            merged => merged,
        }?;
        self.clear();
        Ok(())
    }

    fn merge_into(&self, mut draft: Draft) -> Result<(), SweepError> {
        self.copy(&mut draft)
            .map_err(|error| cannot_write(self.table, error))?;
        draft.publish()?;
        Ok(())
    }

    /// Removes leftovers of other processes after the table is complete.
    pub(super) fn clear_rest(&self) {
        let is_claimed = self.spec_file().exists();
        if self.check_parts().is_ok() && (is_claimed || self.has_only_own_parts()) {
            self.clear();
        }
    }

    /// Whether no part belongs to another sweep, or is damaged.
    fn has_only_own_parts(&self) -> bool {
        (0..self.sweep.parts()).all(|part| self.whole(part).is_ok() || !self.path(part).exists())
    }

    /// Removes parts and leftovers, and the directory if it is empty. Failures are harmless. The file identifying the
    /// sweep is removed last.
    fn clear(&self) {
        let entries = fs::read_dir(&self.parts).into_iter().flatten().flatten();
        for entry in entries.filter(|entry| self.is_own(&entry.file_name().to_string_lossy())) {
            let _ = fs::remove_file(entry.path());
        }
        let _ = fs::remove_file(self.spec_file());
        let _ = fs::remove_dir(&self.parts);
    }

    /// Whether a file in the parts directory belongs to this sweep: a part, a hidden draft, or the spec file.
    fn is_own(&self, name: &str) -> bool {
        // Drafts are hidden files with the name of the part in theirs.
        let digits = name.trim_start_matches('.').split('.').next();
        let number = digits.and_then(|digits| digits.parse().ok());
        let is_part = number
            .filter(|part| *part < self.sweep.parts())
            .map(part_name)
            .is_some_and(|part| name == part || publish::is_draft_of(name, Path::new(&part)));
        is_part
            || publish::is_draft_of(name, self.table)
            || publish::is_draft_of(name, Path::new(SPEC_FILE))
    }

    /// Copies the parts into a draft of the table.
    fn copy(&self, draft: &mut Draft) -> Result<(), SweepError> {
        let first_part = self.whole(0)?.metadata;
        let first = first_part.file_metadata();
        let mut entries = first.key_value_metadata().cloned().unwrap_or_default();
        // These two describe a part; the others, such as the Arrow schema, are the table's.
        entries.retain(|entry| ![COUNTS_ENTRY, PART_ENTRY].contains(&entry.key.as_str()));
        let spec = self.identity.to_string();
        entries.push(KeyValue::new(SPEC_ENTRY.to_owned(), spec));
        let schema = first.schema_descr().root_schema_ptr();
        let output = BufWriter::new(&mut *draft);
        let properties = Arc::new(properties(entries));
        let mut writer = SerializedFileWriter::new(output, schema, properties)?;
        let mut counts = Counts::default();
        for parts in self.sweep.blocks() {
            if parts.clone().count() == 1 {
                let part = self.whole(parts.start)?;
                counts.add(part.counts);
                append_row_groups(&mut writer, &part.file, &part.metadata)?;
            } else {
                // Row groups are those of the whole table, so several small parts are decoded and written as one.
                let block = self.block(parts, &mut counts)?;
                let metadata = ParquetMetaDataReader::new().parse_and_finish(&block)?;
                append_row_groups(&mut writer, &block, &metadata)?;
            }
        }
        writer.append_key_value_metadata(counts_entry(&counts));
        writer.close()?;
        checksum::add(draft.file()?).map_err(|reason| SweepError::io("write", self.table, reason))
    }

    /// The rows of several parts as one row group: the bytes of the table don't depend on the size of its parts.
    fn block(&self, parts: Range<u64>, counts: &mut Counts) -> Result<Bytes, SweepError> {
        let mut batches = Vec::new();
        for part in parts {
            let part = self.whole(part)?;
            counts.add(part.counts);
            let reader = ParquetRecordBatchReaderBuilder::try_new(part.file)?.build()?;
            for batch in reader {
                batches.push(batch.map_err(ParquetError::from)?);
            }
        }
        Ok(row_group(self.sweep.schema(), &batches, Vec::new())?.into())
    }

    /// A part; `None` if it is missing or damaged.
    fn found(&self, part: u64) -> Result<Option<ExistingPart>, SweepError> {
        let Ok(file) = open_file(&self.path(part)) else {
            return Ok(None);
        };
        let is_right = checksum::is_right(&file).is_ok_and(|is_right| is_right);
        let Some(metadata) = metadata(&file).ok().filter(|_| is_right) else {
            return Ok(None);
        };
        if entry(&metadata, PART_ENTRY) != Some(&self.name(part)) {
            return Err(self.unusable_part(part, FileProblem::OtherPart));
        }
        Ok(counts(&metadata).map(|counts| ExistingPart {
            file,
            metadata,
            counts,
        }))
    }

    /// A part; an error if it is missing.
    fn whole(&self, part: u64) -> Result<ExistingPart, SweepError> {
        self.found(part)?
            .ok_or_else(|| self.unusable_part(part, FileProblem::MissingPart))
    }

    fn unusable_part(&self, part: u64, problem: FileProblem) -> SweepError {
        SweepError::unusable(&self.path(part), problem)
    }
}

/// Copies the row groups of a file without decoding them.
fn append_row_groups<W: Write + Send, R: ChunkReader>(
    writer: &mut SerializedFileWriter<W>,
    file: &R,
    metadata: &ParquetMetaData,
) -> Result<(), ParquetError> {
    for group in metadata.row_groups() {
        let mut copy = writer.next_row_group()?;
        for column in group.columns() {
            let close = ColumnCloseResult {
                bytes_written: column.compressed_size() as u64,
                rows_written: group.num_rows() as u64,
                metadata: column.clone(),
                bloom_filter: None,
                column_index: None,
                offset_index: None,
            };
            copy.append_column(file, close)?;
        }
        copy.close()?;
    }
    Ok(())
}

/// Rejects a table or parts directory of another sweep.
fn check_same_sweep(path: &Path, text: &str, sweep: &Json) -> Result<(), SweepError> {
    let Ok(before) = serde_json::from_str::<Json>(text) else {
        return Err(SweepError::unusable(path, FileProblem::UnreadableSpec));
    };
    match change(&before, sweep) {
        None => Ok(()),
        Some(change) => Err(SweepError::unusable(path, FileProblem::OtherSweep(change))),
    }
}

/// Unwraps the I/O error of a Parquet write error.
fn cannot_write(table: &Path, error: SweepError) -> SweepError {
    let SweepError::Parquet(ParquetError::External(cause)) = error else {
        return error;
    };
    match cause.downcast() {
        Ok(reason) => SweepError::io("write", table, *reason),
        Err(cause) => ParquetError::External(cause).into(),
    }
}

/// Whether renaming a draft failed because the target is on another file system.
fn is_on_another_disk(error: &SinkError) -> bool {
    matches!(error, SinkError::Io { reason, .. } if reason.kind() == io::ErrorKind::CrossesDevices)
}

/// The name of a part's file.
fn part_name(part: u64) -> String {
    format!("{part:06}.parquet")
}

fn metadata(file: &File) -> Result<ParquetMetaData, ParquetError> {
    ParquetMetaDataReader::new().parse_and_finish(file)
}

/// An entry of a file's metadata.
pub(super) fn entry<'a>(metadata: &'a ParquetMetaData, name: &str) -> Option<&'a str> {
    let entries = metadata.file_metadata().key_value_metadata()?;
    let found = entries.iter().find(|entry| entry.key == name)?;
    found.value.as_deref()
}

/// The counts in a file's metadata; `None` if they are missing or damaged.
fn counts(metadata: &ParquetMetaData) -> Option<Counts> {
    serde_json::from_str(entry(metadata, COUNTS_ENTRY)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn io_errors_name_the_table() {
        let full = io::Error::from(io::ErrorKind::StorageFull);
        let full = SweepError::Parquet(full.into());
        let message = cannot_write(Path::new("a.parquet"), full).to_string();
        assert_eq!(message, "cannot write a.parquet: no storage space");
        let other = ParquetError::General("odd".to_owned());
        let message = cannot_write(Path::new("a.parquet"), other.into()).to_string();
        assert!(message.ends_with("odd"), "{message}");
    }
}
