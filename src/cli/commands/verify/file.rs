//! Verifying one recording.

use crate::archive::recording::Recording;
use crate::archive::verify::{Report, verify};
use crate::cli::progress::Progress;
use anyhow::Error;
use std::path::Path;

/// Opens and verifies a recording.
pub(in crate::cli::commands) fn check_file(
    path: &Path,
    progress: &Progress,
) -> Result<Report, Error> {
    let recording = Recording::open(path)?;
    Ok(verify(&recording, &|bytes| progress.add(bytes))?)
}
