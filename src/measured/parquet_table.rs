//! Tables of measured values in Parquet files.

use super::error::DataError;
use super::layout::Layout;
use super::rows::Epoch;
use super::spec::SignalSpec;
use super::table::{Cells, FileSignals, NumberColumn, Table, is_needed};
use super::text::{MAX_ROWS, too_long};
use crate::archive::caught::catch;
use crate::archive::input::open_file;
use arrow_array::cast::AsArray as _;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, RecordBatch};
use arrow_cast::cast;
use arrow_schema::{DataType, TimeUnit};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use std::fs::File;
use std::path::Path;

/// Reads the signals of a Parquet file.
pub(super) fn read(
    path: &Path,
    file: usize,
    specs: &[SignalSpec],
    layout: &Layout,
    epoch: &mut Epoch,
) -> Result<FileSignals, DataError> {
    let source = open_file(path).map_err(|reason| DataError::unreadable(path, reason))?;
    // The crate `parquet` panics on some damaged files, where it should return an error.
    let table = catch(|| read_columns(source, specs, layout, epoch));
    let table = table.unwrap_or_else(|_| Err(damaged()));
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
        file,
        columns: names,
        cells: Cells::Numbers { columns, count },
    };
    table.signals(specs, layout)
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
    layout: &Layout,
    epoch: &mut Epoch,
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
        if is_needed(field.name(), specs, layout) {
            needed.push(names.len());
            roots.push(root);
        }
        names.push(field.name().clone());
        columns.push(NumberColumn {
            cells: Vec::new(),
            is_time: tick(field.data_type()).is_some(),
        });
    }
    let projection = ProjectionMask::roots(opened.parquet_schema(), roots);
    let selected = opened.with_projection(projection);
    for read in selected.build().map_err(DataError::because)? {
        let batch: RecordBatch = read.map_err(DataError::because)?;
        for (at, column) in needed.iter().enumerate() {
            append(&mut columns[*column].cells, batch.column(at), epoch)
                .map_err(|error| error.in_column(&names[*column]))?;
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
    tick(kind).is_some() || kind.is_numeric()
}

/// The length of a tick of a type of times, ns; `None` for other types.
fn tick(kind: &DataType) -> Option<i128> {
    match kind {
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => Some(match unit {
            TimeUnit::Second => 1_000_000_000,
            TimeUnit::Millisecond => 1_000_000,
            TimeUnit::Microsecond => 1_000,
            TimeUnit::Nanosecond => 1,
        }),
        _ => None,
    }
}

/// Appends the values of a column, times in seconds.
fn append(
    cells: &mut Vec<Option<f64>>,
    column: &dyn Array,
    epoch: &mut Epoch,
) -> Result<(), DataError> {
    let Some(length) = tick(column.data_type()) else {
        let numbers = cast(column, &DataType::Float64).map_err(DataError::because)?;
        for number in numbers.as_primitive::<Float64Type>() {
            if number.is_some_and(f64::is_infinite) {
                return Err(DataError::new("a value is infinite"));
            }
            cells.push(number.filter(|number| !number.is_nan()));
        }
        return Ok(());
    };
    let is_stamp = matches!(column.data_type(), DataType::Timestamp(..));
    let ticks = cast(column, &DataType::Int64).map_err(DataError::because)?;
    for ticks in ticks.as_primitive::<Int64Type>() {
        cells.push(ticks.map(|ticks| {
            let time_ns = i128::from(ticks) * length;
            if is_stamp {
                epoch.seconds(time_ns)
            } else {
                time_ns as f64 / 1e9
            }
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

    fn read_file(
        path: &Path,
        specs: &[SignalSpec],
        layout: &Layout,
    ) -> Result<FileSignals, DataError> {
        read(path, 0, specs, layout, &mut Epoch::default())
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
            let layout = time.map_or_else(Layout::default, Layout::with_time);
            let found = read_file(file.path(), &[], &layout).unwrap();
            let [signal] = &found.signals[..] else {
                panic!("{name}: not one signal");
            };
            assert_eq!(signal.times, [0.0, 0.1, 0.2], "{name}");
            let clock = found.reading.time().unwrap();
            assert!(!clock.is_unit_assumed, "{name}");
        }
        let file = write(vec![("t", numbers), ("theta", angles), ("phi", stamps)]);
        let theta = SignalSpec::parse("theta").unwrap();
        let layout = Layout::default();
        let found = read_file(file.path(), &[theta], &layout).unwrap();
        let clock = found.reading.time().unwrap();
        assert_eq!((&*clock.column, clock.is_unit_assumed), ("t", true));
        let phi = SignalSpec::parse("phi").unwrap();
        let error = read_file(file.path(), &[phi], &layout).err().unwrap();
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
        let found = read_file(file.path(), &[], &Layout::default()).unwrap();
        let [signal] = &found.signals[..] else {
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
        let read_data = data::read(&[file.path().to_owned()], &specs, &Layout::default());
        let error = read_data.unwrap_err().to_string();
        assert!(
            error.contains("no column or topic name; there are: timestamp, theta (mrad)"),
            "{error}"
        );
        std::fs::write(file.path(), b"PAR1, but no more").unwrap();
        // Every error of the file names it, whatever the crate says of its damage.
        let damaged = read_file(file.path(), &[], &Layout::default())
            .err()
            .unwrap()
            .to_string();
        let name = format!("{}: ", file.path().display());
        assert!(damaged.starts_with(&name), "{damaged}");
    }
}
