//! Tables of measured values in Parquet files.

use super::data_error::{DataError, ParquetError};
use super::signal::{FileSignals, SignalSpec};
use super::table::{MAX_ROWS, Rows, Table, is_needed};
use crate::archive::caught::catch;
use crate::archive::input::open_file;
use arrow_array::cast::AsArray as _;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, RecordBatch};
use arrow_cast::cast;
use arrow_schema::{ArrowError, DataType, TimeUnit};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::fs::File;
use std::path::Path;

/// Reads the signals of a Parquet file.
pub(super) fn read(
    path: &Path,
    file: usize,
    specs: &[SignalSpec],
    time: Option<&str>,
) -> Result<FileSignals, DataError> {
    let source = open_file(path).map_err(|reason| DataError::Io {
        path: path.to_owned(),
        reason,
    })?;
    // The crate `parquet` panics on some damaged files, where it should return an error.
    let table = catch(|| read_columns(source, specs, time)).unwrap_or(Err(ParquetError::Damaged));
    let Columns {
        names,
        cells,
        count,
    } = table.map_err(|reason| DataError::Parquet {
        path: path.to_owned(),
        reason,
    })?;
    if count == 0 {
        return Err(DataError::Empty {
            path: path.to_owned(),
            refused: None,
        });
    }
    let table = Table {
        path,
        columns: names,
        rows: Rows::Numbers {
            columns: cells,
            count,
        },
    };
    table.signals(file, specs, time)
}

/// The columns of numbers of a file.
struct Columns {
    names: Vec<String>,
    /// Cells of each column; none of a column that is not needed.
    cells: Vec<Vec<Option<f64>>>,
    count: usize,
}

fn read_columns(
    source: File,
    specs: &[SignalSpec],
    time: Option<&str>,
) -> Result<Columns, ParquetError> {
    let opened = ParquetRecordBatchReaderBuilder::try_new(source)?;
    let rows = opened.metadata().file_metadata().num_rows();
    let count = usize::try_from(rows).map_err(|_| ParquetError::Damaged)?;
    if count > MAX_ROWS {
        return Err(ParquetError::TooLong { limit: MAX_ROWS });
    }
    let (mut names, mut needed, mut roots) = (Vec::new(), Vec::new(), Vec::new());
    for (root, field) in opened.schema().fields().iter().enumerate() {
        if !is_number(field.data_type()) {
            continue;
        }
        if is_needed(field.name(), specs, time) {
            needed.push(names.len());
            roots.push(root);
        }
        names.push(field.name().clone());
    }
    let projection = ProjectionMask::roots(opened.parquet_schema(), roots);
    let mut cells: Vec<Vec<Option<f64>>> = vec![Vec::new(); names.len()];
    let mut epochs = vec![None; needed.len()];
    for batch in opened.with_projection(projection).build()? {
        let batch: RecordBatch = batch?;
        for (at, column) in needed.iter().enumerate() {
            append(&mut cells[*column], batch.column(at), &mut epochs[at])?;
        }
    }
    Ok(Columns {
        names,
        cells,
        count,
    })
}

/// Whether the values of a type are numbers or times.
fn is_number(kind: &DataType) -> bool {
    match kind {
        DataType::Timestamp(..) | DataType::Duration(_) => true,
        kind => kind.is_numeric(),
    }
}

/// Appends the values of a column; those that are not finite are missing. Timestamps become seconds since the first one
/// (`epoch`): those since 1970 have no fraction of a microsecond as doubles.
fn append(
    cells: &mut Vec<Option<f64>>,
    column: &dyn Array,
    epoch: &mut Option<i64>,
) -> Result<(), ArrowError> {
    let per_second = match column.data_type() {
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => per_second(*unit),
        _ => {
            let numbers = cast(column, &DataType::Float64)?;
            for number in numbers.as_primitive::<Float64Type>() {
                cells.push(number.filter(|number| number.is_finite()));
            }
            return Ok(());
        }
    };
    let ticks = cast(column, &DataType::Int64)?;
    for tick in ticks.as_primitive::<Int64Type>() {
        cells.push(tick.map(|tick| {
            let first = *epoch.get_or_insert(tick);
            (i128::from(tick) - i128::from(first)) as f64 / per_second
        }));
    }
    Ok(())
}

fn per_second(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::Second => 1.0,
        TimeUnit::Millisecond => 1e3,
        TimeUnit::Microsecond => 1e6,
        TimeUnit::Nanosecond => 1e9,
    }
}

#[cfg(test)]
mod tests {
    use super::super::data;
    use super::*;
    use crate::telemetry::fields::state;
    use arrow_array::{Float32Array, StringArray, TimestampMicrosecondArray};
    use parquet::arrow::ArrowWriter;
    use std::sync::Arc;

    #[test]
    fn reads_numbers_and_timestamps() {
        let start = 1_700_000_000_000_000;
        let times = TimestampMicrosecondArray::from(vec![start, start + 100_000, start + 200_000]);
        let angles = Float32Array::from(vec![Some(500.0), None, Some(250.0)]);
        let names = StringArray::from(vec!["a", "b", "c"]);
        let columns: [(&str, Arc<dyn Array>); 3] = [
            ("name", Arc::new(names)),
            ("timestamp", Arc::new(times)),
            ("theta (mrad)", Arc::new(angles)),
        ];
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let file = tempfile::Builder::new()
            .suffix(".parquet")
            .tempfile()
            .unwrap();
        let mut writer =
            ArrowWriter::try_new(file.reopen().unwrap(), batch.schema(), None).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        let [signal] = &read(file.path(), 0, &[], None).unwrap().signals[..] else {
            panic!("not one signal");
        };
        assert_eq!(signal.field, state::THETA);
        assert_eq!(
            (&signal.times[..], &signal.values[..]),
            (&[0.0, 0.2][..], &[0.5, 0.25][..])
        );
        assert_eq!(signal.missing, 1);
        // Texts are no measured values, also if another signal can be read.
        let specs = ["theta", "phi=name"].map(|text| SignalSpec::parse(text).unwrap());
        let read_data = data::read(&[file.path().to_owned()], &specs, None);
        let error = read_data.unwrap_err().to_string();
        assert!(
            error.contains("no column or topic name; there are: timestamp, theta (mrad)"),
            "{error}"
        );
        std::fs::write(file.path(), b"PAR1, but no more").unwrap();
        assert!(matches!(
            read(file.path(), 0, &[], None),
            Err(DataError::Parquet { .. })
        ));
    }
}
