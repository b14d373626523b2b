//! Where a sweep is kept: its parts while it grows, its table when it is complete.

use super::counts::Counts;
use super::directory::{self, SPEC_FILE};
use super::error::SweepError;
use super::part::{COUNTS_ENTRY, Sweep, counts_entry, properties};
use super::seal::{SEAL_ENTRY, is_sealed, seal};
use crate::archive::publish::{self, Draft, Existing};
use crate::archive::sink::SinkError;
use parquet::column::writer::ColumnCloseResult;
use parquet::errors::ParquetError;
use parquet::file::metadata::{KeyValue, ParquetMetaData, ParquetMetaDataReader};
use parquet::file::writer::SerializedFileWriter;
use std::ffi::OsStr;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The entry of the table's metadata with the spec.
const SPEC_ENTRY: &str = "toprise.sweep";

/// The directory for the parts of a table.
#[must_use]
pub fn parts_directory(table: &Path) -> PathBuf {
    directory::beside(table, ".parts")
}

/// The places of a sweep's files.
pub(super) struct Store<'a> {
    sweep: &'a Sweep,
    /// Its identity as text, which each seal is made from.
    identity: String,
    table: &'a Path,
    parts: PathBuf,
}

impl<'a> Store<'a> {
    pub(super) fn new(sweep: &'a Sweep, table: &'a Path) -> Self {
        let parts = parts_directory(table);
        Self {
            sweep,
            identity: sweep.identity().to_string(),
            table,
            parts,
        }
    }

    /// How the rows of the complete table came out; none if there is no table yet.
    ///
    /// # Errors
    /// If a file of that name is something else.
    pub(super) fn finished(&self) -> Result<Option<Counts>, SweepError> {
        let table = self.table;
        if table.symlink_metadata().is_err() {
            return Ok(None);
        }
        let path = || table.to_owned();
        let exists = || SweepError::Exists { path: path() };
        let is_special = |found: Metadata| !found.is_file() && !found.is_dir();
        if table.metadata().is_ok_and(is_special) {
            return Err(SweepError::NoFile { path: path() });
        }
        let metadata = metadata(table).map_err(|_| exists())?;
        let spec = entry(&metadata, SPEC_ENTRY).ok_or_else(exists)?;
        directory::refuse_other(table, spec, self.sweep.identity())?;
        let counts = entry(&metadata, COUNTS_ENTRY).ok_or_else(exists)?;
        serde_json::from_str(counts).map(Some).map_err(|_| exists())
    }

    /// Makes the directory of the parts, or finds that it is of this sweep.
    ///
    /// # Errors
    /// [`SweepError::Changed`] if it is of another one.
    pub(super) fn open(&self) -> Result<(), SweepError> {
        directory::claim(&self.parts, self.sweep.identity())
    }

    /// Finds whether the directory of the parts, if there is one, is of this sweep.
    ///
    /// # Errors
    /// [`SweepError::Changed`] if it is of another one.
    pub(super) fn check_parts(&self) -> Result<(), SweepError> {
        directory::check(&self.parts, self.sweep.identity())
    }

    /// Refuses a name that the table can't get, as one that is too long, before anything is computed for it.
    ///
    /// # Errors
    /// [`SweepError::Sink`].
    pub(super) fn check_table(&self) -> Result<(), SweepError> {
        self.draft().map(|_| ())
    }

    /// A draft of the table. What a process that was killed leaves of it goes with the parts.
    fn draft(&self) -> Result<Draft, SweepError> {
        let draft = Draft::within(&self.parts, self.table, Existing::Keep);
        Ok(draft?)
    }

    /// The file of a part.
    pub(super) fn part(&self, part: u64) -> PathBuf {
        self.parts.join(part_name(part))
    }

    /// Whether a part is there.
    ///
    /// # Errors
    /// [`SweepError::BadPart`] if something else has its name.
    pub(super) fn has(&self, part: u64) -> Result<bool, SweepError> {
        if self.part(part).symlink_metadata().is_err() {
            return Ok(false);
        }
        self.checked(part).map(|_| true)
    }

    /// How the rows of a part that is there came out.
    ///
    /// # Errors
    /// [`SweepError::BadPart`] if it is something else.
    pub(super) fn counts(&self, part: u64) -> Result<Counts, SweepError> {
        self.counts_in(&self.checked(part)?, part)
    }

    fn counts_in(&self, metadata: &ParquetMetaData, part: u64) -> Result<Counts, SweepError> {
        let text = entry(metadata, COUNTS_ENTRY);
        let counts = text.and_then(|text| serde_json::from_str(text).ok());
        counts.ok_or_else(|| self.bad(part, "its counts are missing"))
    }

    /// Writes a part: whole, or not at all.
    ///
    /// # Errors
    /// [`SweepError::Sink`] if the disk is full, or the like.
    pub(super) fn write(&self, part: u64, mut bytes: Vec<u8>) -> Result<(), SweepError> {
        seal(&mut bytes, &self.identity, part);
        match publish::write(&self.part(part), Existing::Keep, &bytes) {
            // Another process that computes the same part was faster, and came to the same bytes.
            Ok(()) | Err(SinkError::Exists { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Merges all parts into the table by copying their columns, and removes them.
    ///
    /// # Errors
    /// [`SweepError::BadPart`] for a part that is not what it must be.
    pub(super) fn merge(&self) -> Result<(), SweepError> {
        let mut counts = Counts::default();
        let mut schema = None;
        for part in 0..self.sweep.parts() {
            let metadata = self.checked(part)?;
            counts.add(self.counts_in(&metadata, part)?);
            schema.get_or_insert(metadata);
        }
        let Some(first) = schema else {
            return Ok(());
        };
        let merge = |mut draft: Draft| -> Result<(), SweepError> {
            self.copy(&mut draft, &first, &counts)?;
            draft.publish()?;
            Ok(())
        };
        match merge(self.draft()?) {
            Err(SweepError::Sink(error)) if is_on_another_disk(&error) => {
                merge(Draft::new(self.table, Existing::Keep)?)
            }
            merged => merged,
        }?;
        self.clear();
        Ok(())
    }

    /// Removes what a process left that was killed, or late, when the table was there already.
    pub(super) fn clear_rest(&self) {
        let is_claimed = self.parts.join(SPEC_FILE).exists();
        let is_ours = if is_claimed {
            self.check_parts().is_ok()
        } else {
            (0..self.sweep.parts()).all(|part| self.has(part).is_ok())
        };
        if is_ours {
            self.clear();
        }
    }

    /// Removes the parts, what was left of them by processes that were killed, and the directory unless there is
    /// something else in it. What is left if this fails does no harm. The file that says of which sweep the directory is
    /// goes last.
    fn clear(&self) {
        let entries = fs::read_dir(&self.parts).into_iter().flatten().flatten();
        for entry in entries.filter(|entry| self.is_own(&entry.file_name())) {
            let _ = fs::remove_file(entry.path());
        }
        let _ = fs::remove_file(self.parts.join(SPEC_FILE));
        let _ = fs::remove_dir(&self.parts);
    }

    /// Whether a file in the directory of parts has the name of a part of this sweep, or of the hidden draft of a part, of
    /// the table or of the file that says of which sweep the directory is.
    fn is_own(&self, name: &OsStr) -> bool {
        let name = name.to_string_lossy();
        let (name, is_draft) = match name.strip_prefix('.') {
            Some(name) => (name, true),
            None => (&*name, false),
        };
        let is_file = |file: &str| {
            // A draft has some more letters.
            let rest = name.strip_prefix(file);
            rest.is_some_and(|rest| rest.is_empty() != is_draft)
        };
        let digits = name
            .split('.')
            .next()
            .and_then(|digits| digits.parse().ok());
        let part = digits.filter(|part| *part < self.sweep.parts());
        let table = publish::name_in_drafts(self.table);
        let is_other_draft = is_file(SPEC_FILE) || is_file(&table.to_string_lossy());
        part.is_some_and(|part| is_file(&part_name(part))) || is_draft && is_other_draft
    }

    /// Copies the parts into a draft of the table.
    fn copy(
        &self,
        draft: &mut Draft,
        first: &ParquetMetaData,
        counts: &Counts,
    ) -> Result<(), SweepError> {
        let cannot_write = |error| cannot_write(self.table, error);
        let file = first.file_metadata();
        let arrow = file.key_value_metadata().into_iter().flatten();
        let mut entries: Vec<_> = arrow
            .filter(|entry| ![COUNTS_ENTRY, SEAL_ENTRY].contains(&entry.key.as_str()))
            .cloned()
            .collect();
        entries.push(KeyValue::new(SPEC_ENTRY.to_owned(), self.identity.clone()));
        entries.push(counts_entry(counts)?);
        let schema = file.schema_descr().root_schema_ptr();
        let output = BufWriter::new(draft);
        let writer = SerializedFileWriter::new(output, schema, Arc::new(properties(entries)));
        let mut writer = writer.map_err(cannot_write)?;
        for part in 0..self.sweep.parts() {
            let path = self.part(part);
            // Checked before.
            let metadata = metadata(&path).map_err(|error| self.bad(part, &error.to_string()))?;
            let file = File::open(&path).map_err(SweepError::io("read", &path))?;
            for group in metadata.row_groups() {
                let mut copy = writer.next_row_group().map_err(cannot_write)?;
                for column in group.columns() {
                    let close = ColumnCloseResult {
                        bytes_written: column.compressed_size() as u64,
                        rows_written: group.num_rows() as u64,
                        metadata: column.clone(),
                        bloom_filter: None,
                        column_index: None,
                        offset_index: None,
                    };
                    let copied = copy.append_column(&file, close);
                    copied.map_err(cannot_write)?;
                }
                copy.close().map_err(cannot_write)?;
            }
        }
        writer.close().map_err(cannot_write)?;
        Ok(())
    }

    /// The metadata of a part, if it is one of this sweep, and as it was written.
    fn checked(&self, part: u64) -> Result<ParquetMetaData, SweepError> {
        let path = self.part(part);
        let is_file = path.symlink_metadata().is_ok_and(|found| found.is_file());
        if !is_file {
            return Err(self.bad(part, "it is no file"));
        }
        let bytes = fs::read(&path).map_err(SweepError::io("read", &path))?;
        let is_own = |found: &ParquetMetaData| {
            let seal = entry(found, SEAL_ENTRY);
            seal.is_some_and(|seal| is_sealed(bytes, seal, &self.identity, part))
        };
        let found = metadata(&path).ok().filter(is_own);
        found.ok_or_else(|| self.bad(part, "it is damaged, or of another sweep"))
    }

    fn bad(&self, part: u64, reason: &str) -> SweepError {
        SweepError::BadPart {
            path: self.part(part),
            reason: reason.to_owned(),
        }
    }
}

/// Why a table can't be written: the system's reason, where there is one, and not how the Parquet writer wraps it.
fn cannot_write(table: &Path, error: ParquetError) -> SweepError {
    let ParquetError::External(cause) = error else {
        return error.into();
    };
    match cause.downcast() {
        Ok(reason) => SweepError::io("write", table)(*reason),
        Err(cause) => ParquetError::External(cause).into(),
    }
}

/// Whether a draft could not get its name because that is on another disk, as where the directory of parts is a link.
fn is_on_another_disk(error: &SinkError) -> bool {
    matches!(error, SinkError::Io { reason, .. } if reason.kind() == io::ErrorKind::CrossesDevices)
}

/// The name of a part's file.
fn part_name(part: u64) -> String {
    format!("{part:06}.parquet")
}

fn metadata(path: &Path) -> Result<ParquetMetaData, ParquetError> {
    let file = File::open(path)?;
    ParquetMetaDataReader::new().parse_and_finish(&file)
}

/// An entry of a file's metadata.
fn entry<'a>(metadata: &'a ParquetMetaData, name: &str) -> Option<&'a str> {
    let entries = metadata.file_metadata().key_value_metadata()?;
    let found = entries.iter().find(|entry| entry.key == name)?;
    found.value.as_deref()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_refuses_is_told_with_the_name_of_the_table() {
        let full = io::Error::from(io::ErrorKind::StorageFull);
        let told = cannot_write(Path::new("a.parquet"), full.into()).to_string();
        assert_eq!(told, "cannot write a.parquet: no storage space");
        let other = ParquetError::General("odd".to_owned());
        let told = cannot_write(Path::new("a.parquet"), other).to_string();
        assert!(told.ends_with("odd"), "{told}");
    }
}
