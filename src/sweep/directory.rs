//! The directories next to a sweep's table. Each has a file that names its sweep: the spec as JSON.

use super::change::change;
use super::error::SweepError;
use crate::archive::given::read_file;
use crate::archive::publish::{self, Existing};
use crate::archive::sink::SinkError;
use serde_json::Value as Json;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};

/// The file with the spec.
pub(super) const SPEC_FILE: &str = "sweep.json";

/// The directory that has the table's name and a suffix.
pub(super) fn beside(table: &Path, suffix: &str) -> PathBuf {
    let mut name = table.file_name().map_or_else(OsString::new, OsString::from);
    name.push(suffix);
    table.with_file_name(name)
}

/// Makes a directory of this sweep, or finds that it is one.
///
/// # Errors
/// [`SweepError::Unusable`] if it is of another sweep.
pub(super) fn claim(directory: &Path, sweep: &Json) -> Result<(), SweepError> {
    let path = directory.join(SPEC_FILE);
    if !path.exists() {
        let text = format!("{sweep:#}\n");
        match publish::write(&path, Existing::Keep, text.as_bytes()) {
            // Another process was faster.
            Ok(()) | Err(SinkError::Exists { .. }) => {}
            Err(error) => return Err(error.into()),
        }
    }
    check(directory, sweep)
}

/// Finds whether a directory, if there is one, is of this sweep.
///
/// # Errors
/// [`SweepError::Unusable`] if it is of another sweep.
pub(super) fn check(directory: &Path, sweep: &Json) -> Result<(), SweepError> {
    let path = directory.join(SPEC_FILE);
    match read_file(&path) {
        Ok(text) => refuse_other(directory, &text, sweep),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(SweepError::io("read", &path)(error)),
    }
}

/// Refuses what has the spec of another sweep.
///
/// # Errors
/// [`SweepError::Unusable`].
pub(super) fn refuse_other(path: &Path, text: &str, sweep: &Json) -> Result<(), SweepError> {
    let Ok(before) = serde_json::from_str::<Json>(text) else {
        let reason = "does not name its sweep, because its file is damaged: choose another name, or remove it";
        return Err(SweepError::unusable(path, reason));
    };
    match change(&before, sweep) {
        None => Ok(()),
        Some(change) => Err(SweepError::unusable(
            path,
            format!("is of another sweep: {change}; choose another name, or remove it"),
        )),
    }
}
