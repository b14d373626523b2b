//! Tables of measured values in Parquet files.

use super::error::DataError;
use super::signal::{FileSignals, SignalSpec};
use super::table::{MAX_ROWS, NumberColumn, Table, TableRows, is_needed, too_long};
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
    let source = open_file(path).map_err(|reason| DataError::unreadable(path, reason))?;
    // The crate `parquet` panics on some damaged files, where it should return an error.
    let table = catch(|| read_columns(source, specs, time)).unwrap_or_else(|_| Err(damaged()));
    let NumberColumns {
        names,
        columns,
        count,
    } = table.map_err(|error| error.in_file(path))?;
    if count == 0 {
        return Err(DataError::new("no rows of numbers").in_file(path));
    }
    let table = Table {
        path,
        columns: names,
        is_named: true,
        has_arguments: true,
        rows: TableRows::Numbers { columns, count },
    };
    table.signals(file, specs, time)
}

/// The columns of numbers of a file.
struct NumberColumns {
    names: Vec<String>,
    columns: Vec<NumberColumn>,
    count: usize,
}

fn read_columns(
    source: File,
    specs: &[SignalSpec],
    time: Option<&str>,
) -> Result<NumberColumns, DataError> {
    let opened = ParquetRecordBatchReaderBuilder::try_new(source).map_err(DataError::because)?;
    let rows = opened.metadata().file_metadata().num_rows();
    let count = usize::try_from(rows).map_err(|_| damaged())?;
    if count > MAX_ROWS {
        return Err(too_long());
    }
    let (mut names, mut columns) = (Vec::new(), Vec::new());
    let (mut needed, mut roots) = (Vec::new(), Vec::new());
    for (root, field) in opened.schema().fields().iter().enumerate() {
        if !is_number(field.data_type()) {
            continue;
        }
        if is_needed(field.name(), specs, time) {
            needed.push(names.len());
            roots.push(root);
        }
        names.push(field.name().clone());
        columns.push(NumberColumn {
            cells: Vec::new(),
            is_time: per_second(field.data_type()).is_some(),
        });
    }
    let projection = ProjectionMask::roots(opened.parquet_schema(), roots);
    let mut epochs = vec![None; needed.len()];
    let selected = opened.with_projection(projection);
    for read in selected.build().map_err(DataError::because)? {
        let batch: RecordBatch = read.map_err(DataError::because)?;
        for (at, column) in needed.iter().enumerate() {
            append(
                &mut columns[*column].cells,
                batch.column(at),
                &mut epochs[at],
            )
            .map_err(DataError::because)?;
        }
    }
    Ok(NumberColumns {
        names,
        columns,
        count,
    })
}

fn damaged() -> DataError {
    DataError::new("the file is damaged")
}

/// Whether the values of a type are numbers or times.
fn is_number(kind: &DataType) -> bool {
    per_second(kind).is_some() || kind.is_numeric()
}

/// Ticks per second of a type of times; `None` for other types.
fn per_second(kind: &DataType) -> Option<f64> {
    match kind {
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => Some(match unit {
            TimeUnit::Second => 1.0,
            TimeUnit::Millisecond => 1e3,
            TimeUnit::Microsecond => 1e6,
            TimeUnit::Nanosecond => 1e9,
        }),
        _ => None,
    }
}

/// Appends the values of a column; those that are not finite are missing. Timestamps become seconds since the first one
/// (`epoch`): those since 1970 have no fraction of a microsecond as doubles.
fn append(
    cells: &mut Vec<Option<f64>>,
    column: &dyn Array,
    epoch: &mut Option<i64>,
) -> Result<(), ArrowError> {
    let Some(per_second) = per_second(column.data_type()) else {
        let numbers = cast(column, &DataType::Float64)?;
        for number in numbers.as_primitive::<Float64Type>() {
            cells.push(number.filter(|number| number.is_finite()));
        }
        return Ok(());
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

#[cfg(test)]
mod tests {
    use super::super::data;
    use super::*;
    use crate::telemetry::fields::state;
    use arrow_array::{
        DurationMillisecondArray, Float32Array, Float64Array, StringArray,
        TimestampMicrosecondArray, TimestampMillisecondArray,
    };
    use parquet::arrow::ArrowWriter;
    use std::sync::Arc;

    type Column<'a> = (&'a str, Arc<dyn Array>);

    fn write(columns: Vec<Column<'_>>) -> tempfile::NamedTempFile {
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let file = tempfile::Builder::new()
            .suffix(".parquet")
            .tempfile()
            .unwrap();
        let mut writer =
            ArrowWriter::try_new(file.reopen().unwrap(), batch.schema(), None).unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        file
    }

    #[test]
    fn types_of_times_prevail_over_units_in_names() {
        let start = 1_764_158_400_000;
        let ticks = vec![start, start + 100, start + 200];
        let stamps: Arc<dyn Array> = Arc::new(TimestampMillisecondArray::from(ticks));
        let durations: Arc<dyn Array> = Arc::new(DurationMillisecondArray::from(vec![0, 100, 200]));
        let numbers: Arc<dyn Array> = Arc::new(Float64Array::from(vec![0.0, 100.0, 200.0]));
        let angles: Arc<dyn Array> = Arc::new(Float64Array::from(vec![0.5, 0.4, 0.3]));
        for (name, column, values, time) in [
            ("timestamps", "time", &stamps, None),
            ("timestamps in ms", "time_ms", &stamps, None),
            ("a unit in brackets", "timestamp (ms)", &stamps, None),
            ("no unit", "timestamp (UTC)", &stamps, None),
            ("a unit added", "t", &stamps, Some("t (ms)")),
            ("durations in ms", "time_ms", &durations, None),
            ("numbers in ms", "time_ms", &numbers, None),
            ("numbers, unit added", "t", &numbers, Some("t (ms)")),
        ] {
            let file = write(vec![(column, values.clone()), ("theta", angles.clone())]);
            let [signal] = &read(file.path(), 0, &[], time).unwrap().signals[..] else {
                panic!("{name}: not one signal");
            };
            assert_eq!(signal.times, [0.0, 0.1, 0.2], "{name}");
            let clock = signal.clock.as_ref().unwrap();
            assert!(clock.is_unit_known, "{name}");
        }
        let file = write(vec![("t", numbers), ("theta", angles), ("phi", stamps)]);
        let theta = SignalSpec::parse("theta").unwrap();
        let found = read(file.path(), 0, &[theta], None).unwrap();
        let clock = found.signals[0].clock.as_ref().unwrap();
        assert_eq!((&*clock.name, clock.is_unit_known), ("t", false));
        let phi = SignalSpec::parse("phi").unwrap();
        let error = read(file.path(), 0, &[phi], None).err().unwrap();
        assert!(
            error
                .to_string()
                .contains("column phi has times, by its type; expected: angle"),
            "{error}"
        );
    }

    #[test]
    fn reads_numbers_and_timestamps() {
        let start = 1_700_000_000_000_000;
        let times = TimestampMicrosecondArray::from(vec![start, start + 100_000, start + 200_000]);
        let angles = Float32Array::from(vec![Some(500.0), None, Some(250.0)]);
        let names = StringArray::from(vec!["a", "b", "c"]);
        let file = write(vec![
            ("name", Arc::new(names)),
            ("timestamp", Arc::new(times)),
            ("theta (mrad)", Arc::new(angles)),
        ]);
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
        // Every error of the file names it, whatever the crate says of its damage.
        let damaged = read(file.path(), 0, &[], None).err().unwrap().to_string();
        let name = format!("{}: ", file.path().display());
        assert!(damaged.starts_with(&name), "{damaged}");
    }
}
