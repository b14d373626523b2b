//! The files that a run writes.

use super::arguments::RunArguments;
use crate::archive::publish::{Draft, partial_name, refuse_inputs};
use crate::archive::sink::SinkError;
use crate::cli::report::WrittenFile;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader};
use std::path::{Path, PathBuf};

/// The directory for recordings, unless the arguments name a file.
const DIRECTORY: &str = "recordings";

/// The files of a run, before it begins.
pub(super) struct RunFiles {
    pub(super) mcap: Draft,
    #[cfg(feature = "rerun")]
    pub(super) rrd: Option<Draft>,
}

impl RunFiles {
    /// Chooses the file names (`stem`, unless set by arguments) and creates the files, which start with a preface. Also
    /// returns the existing recordings with the names that were tried first.
    pub(super) fn start(
        arguments: &RunArguments,
        stem: &str,
        preface: &[u8],
    ) -> Result<(Self, Vec<PathBuf>), SinkError> {
        let Some(mcap) = &arguments.output else {
            return Self::free(arguments, stem, preface);
        };
        let mcap = start(arguments, mcap, preface)?;
        let files = Self::with(mcap, arguments, None)?;
        Ok((files, Vec::new()))
    }

    /// Creates the files under the first free name of `NAME`, `NAME-2`, `NAME-3`, … (or `NAME` itself with --force).
    /// Safe if several runs start at once.
    fn free(
        arguments: &RunArguments,
        name: &str,
        preface: &[u8],
    ) -> Result<(Self, Vec<PathBuf>), SinkError> {
        let mut earlier = Vec::new();
        let mut stem = name.to_owned();
        loop {
            let file = |extension: &str| Path::new(DIRECTORY).join(format!("{stem}.{extension}"));
            let (mcap, rrd) = (file("mcap"), file("rrd"));
            let is_free = |path: &Path| !path.exists() && !partial_name(path).exists();
            if arguments.force || is_free(&mcap) && is_free(&rrd) {
                match start(arguments, &mcap, preface) {
                    // Another run took this name.
                    Err(SinkError::Exists { .. }) if !arguments.force => {}
                    mcap => {
                        let files = Self::with(mcap?, arguments, Some(&rrd))?;
                        return Ok((files, earlier));
                    }
                }
            }
            earlier.push(mcap);
            stem = format!("{name}-{}", earlier.len() + 1);
        }
    }

    /// The MCAP file, and the Rerun recording at `rrd` unless --rrd or --no-rrd is given.
    #[cfg(feature = "rerun")]
    fn with(mcap: Draft, arguments: &RunArguments, rrd: Option<&Path>) -> Result<Self, SinkError> {
        let wanted = arguments.rrd.as_deref().or(rrd);
        let rrd = match wanted.filter(|_| !arguments.no_rrd) {
            Some(rrd) => {
                refuse_inputs(rrd, [mcap.path()])?;
                Some(start(arguments, rrd, &[])?)
            }
            None => None,
        };
        Ok(Self { mcap, rrd })
    }

    /// The MCAP file (build without Rerun).
    #[cfg(not(feature = "rerun"))]
    #[allow(clippy::unnecessary_wraps, reason = "with the Rerun SDK it may fail")]
    fn with(mcap: Draft, _: &RunArguments, _: Option<&Path>) -> Result<Self, SinkError> {
        Ok(Self { mcap })
    }
}

/// Creates a file with a preface. Refuses to overwrite the input.
fn start(arguments: &RunArguments, path: &Path, preface: &[u8]) -> Result<Draft, SinkError> {
    refuse_inputs(path, [arguments.scenario.as_path()])?;
    Draft::of_run(path, arguments.existing(), preface)
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
