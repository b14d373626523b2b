//! Measured data from files.

use super::column::{listed, similar};
use super::error::DataError;
#[cfg(not(feature = "sweep"))]
use super::signal::FileSignals;
use super::signal::{Signal, SignalSpec};
use super::{recorded, text_table};
use crate::archive::input::FileFormat;
use crate::archive::publish::is_same_file;
use crate::words::{Piece, sentence};
use std::path::{Path, PathBuf};

/// Measured signals. Each file has a clock of its own; that of the first is the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// The signals.
    pub signals: Vec<Signal>,
    /// Number of files.
    pub files: usize,
    /// Whether the first file is a recording of toprise, whose clock starts with the run.
    pub starts_with_run: bool,
    /// Parts of recordings that could not be read.
    pub losses: Vec<String>,
}

impl Data {
    /// The time on the clock of the first file at which the scenario starts, unless given, s.
    pub(crate) fn origin(&self) -> f64 {
        if self.starts_with_run {
            return 0.0;
        }
        let mut origin = f64::INFINITY;
        for signal in self.signals.iter().filter(|signal| signal.file == 0) {
            // Times are ascending.
            origin = origin.min(signal.times.first().copied().unwrap_or(f64::INFINITY));
        }
        if origin.is_finite() { origin } else { 0.0 }
    }

    /// The time from the origin to the last sample of the first file, s.
    pub(crate) fn duration(&self) -> f64 {
        let mut last = self.origin();
        for signal in self.signals.iter().filter(|signal| signal.file == 0) {
            last = signal.times.iter().copied().fold(last, f64::max);
        }
        last - self.origin()
    }
}

/// Reads the signals of files. Each of `specs` must be in at least one of them. `time` is the name of the
/// columns of times; the messages of recordings have times of their own.
///
/// # Errors
/// [`DataError`] with the file, line and column.
pub fn read(
    files: &[PathBuf],
    specs: &[SignalSpec],
    time: Option<&str>,
) -> Result<Data, DataError> {
    let mut data = Data {
        signals: Vec::new(),
        files: files.len(),
        starts_with_run: false,
        losses: Vec::new(),
    };
    check_time(files, time)?;
    let mut contents = Vec::new();
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
                let read = recorded::read(path, index, specs)?;
                data.starts_with_run |= index == 0 && read.is_ours;
                for loss in read.losses {
                    data.losses.push(format!("{}: {loss}", path.display()));
                }
                read.found
            }
            FileFormat::Parquet => read_parquet(path, index, specs, time)?,
            FileFormat::Text => text_table::read(path, index, specs, time)?,
        };
        data.signals.extend(found.signals);
        contents.push(Contents {
            path: path.clone(),
            known: found.known,
        });
    }
    check_found(&data.signals, specs, contents)?;
    Ok(data)
}

/// Reads the signals of one text table, whose content is in memory. Errors name it `name`.
///
/// # Errors
/// [`DataError`] with the file, line and column.
pub fn read_bytes(name: &Path, bytes: Vec<u8>, specs: &[SignalSpec]) -> Result<Data, DataError> {
    let found = text_table::read_bytes(name, bytes, specs)?;
    let data = Data {
        signals: found.signals,
        files: 1,
        starts_with_run: false,
        losses: Vec::new(),
    };
    let contents = Contents {
        path: name.to_owned(),
        known: found.known,
    };
    check_found(&data.signals, specs, vec![contents])?;
    Ok(data)
}

/// The columns that can be read, or the topics, of a file.
struct Contents {
    path: PathBuf,
    known: Vec<String>,
}

/// Refuses a name of columns of times if no file has columns.
fn check_time(files: &[PathBuf], time: Option<&str>) -> Result<(), DataError> {
    let has_columns = files.iter().any(|path| match FileFormat::detect(path) {
        FileFormat::Text | FileFormat::Parquet => true,
        FileFormat::Recording => false,
    });
    match time {
        Some(name) if !has_columns => Err(DataError::new(sentence!(
            "there is no column of times {} in MCAP files: the times are those of their messages; leave the name out",
            name.to_owned()
        ))),
        Some(_) | None => Ok(()),
    }
}

/// Refuses signals that are in no file, and files without a signal.
fn check_found(
    signals: &[Signal],
    specs: &[SignalSpec],
    files: Vec<Contents>,
) -> Result<(), DataError> {
    // A file without a signal may be the one that a misspelt signal is in, so these come first.
    for spec in specs {
        if !signals.iter().any(|signal| spec.describes(signal)) {
            return Err(not_found(&spec.source, &files));
        }
    }
    for (index, file) in files.into_iter().enumerate() {
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
    let mut topics = files.iter().flat_map(|file| &file.known);
    if name.starts_with('/') && topics.any(|topic| topic == name) {
        return DataError::new(format!(
            "{name} is a topic: name a value in its messages, {name}.NAME"
        ));
    }
    if let [file] = files {
        return DataError::new(format!(
            "no column or topic {name}; there {}{}",
            listed(&file.known),
            similar(name, &file.known)
        ))
        .in_file(&file.path);
    }
    let mut problem = format!("no column or topic {name} in any file");
    let mut known = Vec::new();
    for file in files {
        let path = file.path.display();
        problem += &format!("; in {path} there {}", listed(&file.known));
        known.extend(file.known.iter().cloned());
    }
    DataError::new(problem + &similar(name, &known))
}

#[cfg(feature = "sweep")]
use super::parquet_table::read as read_parquet;

/// Stands for the reader in builds without the crate `parquet`.
#[cfg(not(feature = "sweep"))]
fn read_parquet(
    path: &Path,
    _file: usize,
    _specs: &[SignalSpec],
    _time: Option<&str>,
) -> Result<FileSignals, DataError> {
    Err(DataError::new(
        "this build can't read Parquet files (its feature `sweep` is off): convert it to CSV",
    )
    .in_file(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_a_column_of_times_without_tables() {
        let [mcap, csv] = ["a.mcap", "b.csv"].map(PathBuf::from);
        let error = check_time(std::slice::from_ref(&mcap), Some("stamp")).unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("no column of times stamp in MCAP files"),
            "{message}"
        );
        check_time(std::slice::from_ref(&mcap), None).unwrap();
        check_time(&[mcap, csv], Some("stamp")).unwrap();
    }
}
