//! Reading Parquet files.

use super::error::{SweepError, TableError};
use crate::archive::caught::catch;
use crate::archive::input::{FileFormat, open_file};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::errors::ParquetError;
use std::fs::File;
use std::path::Path;

/// A Parquet file whose schema and metadata are read.
pub(super) type Opened = ParquetRecordBatchReaderBuilder<File>;

/// Result of `read` for a Parquet file. The `parquet` and `arrow-ipc` crates panic on some damaged files, where they should
/// return an error. Such a panic becomes an error here.
pub(super) fn read<T>(
    path: &Path,
    read: impl FnOnce(Opened) -> Result<T, TableError>,
) -> Result<T, SweepError> {
    let file = open_file(path).map_err(|reason| SweepError::io("read", path, reason))?;
    if FileFormat::detect(path) != FileFormat::Parquet {
        return Err(SweepError::table(path, TableError::NotParquet));
    }
    catch(|| read(Opened::try_new(file)?))
        .unwrap_or(Err(TableError::Damaged))
        .map_err(|reason| SweepError::table(path, reason))
}

/// The batches of some columns.
pub(super) fn batches(
    opened: Opened,
    columns: impl IntoIterator<Item = usize>,
) -> Result<ParquetRecordBatchReader, ParquetError> {
    let columns = ProjectionMask::roots(opened.parquet_schema(), columns);
    opened.with_projection(columns).build()
}
