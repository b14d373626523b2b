//! The files that a run writes.

use super::arguments::RunArguments;
use crate::archive::publish::{Draft, Existing, partial_name, refuse_inputs};
use crate::archive::sink::SinkError;
use crate::cli::output::warn_of_link;
use crate::cli::report::WrittenFile;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader};
use std::path::{Path, PathBuf};

/// The directory for recordings, unless the arguments name a file.
const DIRECTORY: &str = "recordings";

/// Creates the MCAP file, which starts with a preface. Its name is that of the arguments, or the first free one of
/// `STEM`, `STEM-2`, `STEM-3`, … (`STEM` itself with --force). Also returns the existing recordings with the names
/// before it. Safe if several runs start at once.
pub(super) fn start(
    arguments: &RunArguments,
    stem: &str,
    preface: &[u8],
) -> Result<(Draft, Vec<PathBuf>), SinkError> {
    let mut earlier = Vec::new();
    if let Some(mcap) = &arguments.output {
        return Ok((create(arguments, mcap, preface)?, earlier));
    }
    let mut name = stem.to_owned();
    loop {
        let mcap = Path::new(DIRECTORY).join(format!("{name}.mcap"));
        let is_free = |path: &Path| !path.exists() && !partial_name(path).exists();
        if arguments.force || is_free(&mcap) && is_free(&mcap.with_extension("rrd")) {
            match create(arguments, &mcap, preface) {
                // Another run took this name.
                Err(SinkError::Exists { .. }) if !arguments.force => {}
                draft => return Ok((draft?, earlier)),
            }
        }
        earlier.push(mcap);
        name = format!("{stem}-{}", earlier.len() + 1);
    }
}

/// Creates a file with a preface. Refuses to overwrite the input.
pub(super) fn create(
    arguments: &RunArguments,
    path: &Path,
    preface: &[u8],
) -> Result<Draft, SinkError> {
    refuse_inputs(path, [arguments.scenario.as_path()])?;
    let draft = Draft::of_run(path, Existing::forced(arguments.force), preface)?;
    warn_of_link(path, arguments.force);
    Ok(draft)
}

/// The existing recording with the bytes of this draft.
pub(super) fn same_as(draft: &Draft, earlier: &[PathBuf]) -> Option<WrittenFile> {
    let is_same = |path: &&PathBuf| are_equal(path, draft.working_name()).unwrap_or(false);
    let path = earlier.iter().find(is_same)?;
    Some(WrittenFile::new(path, path.metadata().ok()?.len()))
}

/// Whether two files have the same bytes.
fn are_equal(one: &Path, other: &Path) -> io::Result<bool> {
    let files = [File::open(one)?, File::open(other)?];
    if files[0].metadata()?.len() != files[1].metadata()?.len() {
        return Ok(false);
    }
    let [mut one, mut other] = files.map(BufReader::new);
    loop {
        let (a, b) = (one.fill_buf()?, other.fill_buf()?);
        let length = a.len().min(b.len());
        if length == 0 || a[..length] != b[..length] {
            return Ok(a.is_empty() && b.is_empty());
        }
        one.consume(length);
        other.consume(length);
    }
}
