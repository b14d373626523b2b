//! Measured data from files.

use super::error::DataError;
use super::layout::Layout;
#[cfg(feature = "sweep")]
use super::parquet_table;
use super::reading::FileReading;
use super::recorded;
use super::rows::Epoch;
use super::signal::Signal;
use super::spec::SignalSpec;
use super::table::{Cells, FileSignals, Table, listed};
use super::text::{self, TextTable};
use crate::archive::input::{FileFormat, open_file};
use crate::archive::publish::is_same_file;
use crate::run::suggestion::{did_you_mean, similar_names};
use crate::words::{Piece, sentence};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Maximum size of a text file (held in memory), bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Measured signals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Data {
    /// The signals.
    pub signals: Vec<Signal>,
    /// What was read of each file.
    pub files: Vec<FileReading>,
    /// Whether the first file is a recording of toprise, whose clock starts with the run.
    pub starts_with_run: bool,
    /// Parts of recordings that could not be read.
    pub losses: Vec<String>,
}

impl Data {
    /// Signals that are in no file.
    pub fn from_signals(signals: Vec<Signal>) -> Self {
        Self {
            signals,
            files: vec![FileReading::default()],
            ..Self::default()
        }
    }
}

/// Reads the signals of files. Each of `specs` must be in at least one of them.
///
/// # Errors
/// [`DataError`] with the file, line and column.
pub fn read(files: &[PathBuf], specs: &[SignalSpec], layout: &Layout) -> Result<Data, DataError> {
    let mut data = Data::default();
    let mut contents = Vec::new();
    let mut epoch = Epoch::default();
    for (index, path) in files.iter().enumerate() {
        if files[..index].iter().any(|known| is_same_file(known, path)) {
            let name = path.display().to_string();
            return Err(DataError::new(sentence!(
                "{} is given twice: each value may count only once",
                name
            )));
        }
        let found = match FileFormat::detect(path) {
            FileFormat::Recording => {
                let read = recorded::read(path, index, specs, layout, &mut epoch)?;
                data.starts_with_run |= index == 0 && read.is_ours;
                for loss in read.losses {
                    data.losses.push(format!("{}: {loss}", path.display()));
                }
                read.found
            }
            FileFormat::Parquet => read_parquet(path, index, specs, layout, &mut epoch)?,
            FileFormat::Text => {
                let bytes = read_limited(path)?;
                read_text(path, index, bytes, specs, layout)?
            }
        };
        add(&mut data, found, path, &mut contents)?;
    }
    check_found(&data.signals, specs, &contents)?;
    Ok(data)
}

/// Reads the signals of one text table, whose content is in memory. Errors name it `name`.
///
/// # Errors
/// [`DataError`] with the file, line and column.
pub fn read_bytes(name: &Path, bytes: Vec<u8>, specs: &[SignalSpec]) -> Result<Data, DataError> {
    let mut data = Data::default();
    let mut contents = Vec::new();
    let found = read_text(name, 0, bytes, specs, &Layout::default())?;
    add(&mut data, found, name, &mut contents)?;
    check_found(&data.signals, specs, &contents)?;
    Ok(data)
}

fn add(
    data: &mut Data,
    found: FileSignals,
    path: &Path,
    contents: &mut Vec<Contents>,
) -> Result<(), DataError> {
    for signal in &found.signals {
        if let Some(known) = data.signals.iter().find(|known| repeats(known, signal)) {
            let other = &data.files[known.file].file;
            return Err(DataError::new(sentence!(
                "{} repeats the values of {}: each value may count only once",
                signal.field.to_string(),
                other
            ))
            .in_file(path));
        }
    }
    data.signals.extend(found.signals);
    data.files.push(found.reading);
    contents.push(Contents {
        path: path.to_owned(),
        known: found.known,
    });
    Ok(())
}

/// Whether a signal has half or more of the values of another one, at the same times.
fn repeats(known: &Signal, signal: &Signal) -> bool {
    /// Fewer values may be equal by chance.
    const FEWEST: usize = 5;
    if known.field != signal.field {
        return false;
    }
    let (mut common, mut at) = (0, 0);
    for (time, value) in signal.times.iter().zip(&signal.values) {
        // The times of both are ascending.
        while known.times.get(at).is_some_and(|known| known < time) {
            at += 1;
        }
        common += usize::from(known.times.get(at) == Some(time) && known.values[at] == *value);
    }
    common >= FEWEST.max(known.times.len().min(signal.times.len()) / 2)
}

/// The columns that can be read, or the topics, of a file.
struct Contents {
    path: PathBuf,
    known: Vec<String>,
}

fn read_limited(path: &Path) -> Result<Vec<u8>, DataError> {
    let unreadable = |reason| DataError::unreadable(path, reason);
    let mut bytes = Vec::new();
    let file = open_file(path).map_err(unreadable)?;
    file.take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    Ok(bytes)
}

fn read_text(
    path: &Path,
    file: usize,
    bytes: Vec<u8>,
    specs: &[SignalSpec],
    layout: &Layout,
) -> Result<FileSignals, DataError> {
    if bytes.len() as u64 > MAX_BYTES {
        let limit = (MAX_BYTES >> 20).to_string();
        let problem = sentence!("larger than {} MB: thin out the data", limit);
        return Err(DataError::new(problem).in_file(path));
    }
    let text = text::decode(path, bytes)?;
    let TextTable {
        columns,
        delimiter,
        lines,
    } = text::read(path, &text, layout)?;
    let cells = Cells::Text { lines, delimiter };
    let table = Table {
        path,
        file,
        columns,
        cells,
    };
    table.signals(specs, layout)
}

/// Refuses signals that are in no file, and files without a signal.
fn check_found(
    signals: &[Signal],
    specs: &[SignalSpec],
    files: &[Contents],
) -> Result<(), DataError> {
    // A file without a signal may be the one that a misspelt signal is in, so these come first.
    for spec in specs {
        if !signals
            .iter()
            .any(|signal| spec.describes(signal.field, &signal.name))
        {
            return Err(not_found(&spec.source, files));
        }
    }
    for (index, file) in files.iter().enumerate() {
        if !signals.iter().any(|signal| signal.file == index) {
            let problem = sentence!(
                "none of the signals is in this file; there {}",
                listed(&file.known)
            );
            let remedy = sentence!(
                "leave it out, or name its signals with {}",
                Piece::argument("signal")
            );
            return Err(DataError::new(problem)
                .in_file(&file.path)
                .with_remedy(remedy));
        }
    }
    Ok(())
}

/// The error of a signal that is in none of the files.
fn not_found(name: &str, files: &[Contents]) -> DataError {
    let known: Vec<&str> = files
        .iter()
        .flat_map(|file| &file.known)
        .map(String::as_str)
        .collect();
    if name.starts_with('/') && known.contains(&name) {
        return DataError::new(format!(
            "{name} is a topic: name a value in its messages, {name}.NAME"
        ));
    }
    // The topic of a member is compared with those that there are.
    let compared = match name.rsplit_once('.') {
        Some((topic, _)) if topic.starts_with('/') => topic,
        Some(_) | None => name,
    };
    let similar = if known.contains(&compared) {
        // The topic is right: no other one is meant.
        String::new()
    } else {
        did_you_mean(&similar_names(compared, known))
    };
    if let [file] = files {
        return DataError::new(format!(
            "no column or topic {name}; there {}{similar}",
            listed(&file.known)
        ))
        .in_file(&file.path);
    }
    let mut problem = format!("no column or topic {name} in any file");
    for file in files {
        let path = file.path.display();
        problem += &format!("; in {path} there {}", listed(&file.known));
    }
    DataError::new(problem + &similar)
}

#[cfg(feature = "sweep")]
use parquet_table::read as read_parquet;

/// Stands for the reader in builds without the crate `parquet`.
#[cfg(not(feature = "sweep"))]
fn read_parquet(
    path: &Path,
    _file: usize,
    _specs: &[SignalSpec],
    _layout: &Layout,
    _epoch: &mut Epoch,
) -> Result<FileSignals, DataError> {
    Err(DataError::new(
        "this build can't read Parquet files (its feature `sweep` is off): convert it to CSV",
    )
    .in_file(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::state;

    #[test]
    fn finds_values_that_are_repeated() {
        let signal = |rows: &[(f64, f64)]| {
            let (times, values): (Vec<f64>, Vec<f64>) = rows.iter().copied().unzip();
            Signal::from_values(state::THETA, &times, &values, Some(1.0)).unwrap()
        };
        let row = |at: i32| (f64::from(at), f64::from(at * 7919 % 1013));
        let rows: Vec<(f64, f64)> = (0..100).map(row).collect();
        let thinned = rows.iter().step_by(3).copied().collect();
        for (name, other, expected) in [
            ("the same", rows.clone(), true),
            ("without the last rows", rows[..90].to_vec(), true),
            ("without the first rows", rows[30..].to_vec(), true),
            ("thinned out", thinned, true),
            ("the next part", (100..200).map(row).collect(), false),
            (
                "other values",
                (0..100).map(|at| (f64::from(at), 0.5)).collect(),
                false,
            ),
            ("few", rows[..4].to_vec(), false),
        ] {
            assert_eq!(repeats(&signal(&rows), &signal(&other)), expected, "{name}");
        }
    }
}
