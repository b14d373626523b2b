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

/// Recordings that had taken the names that the run tried first.
pub(super) struct Earlier(Vec<PathBuf>);

impl RunFiles {
    /// Chooses the names, after `stem` unless the arguments have others, and starts the files with a preface.
    pub(super) fn start(
        arguments: &RunArguments,
        stem: &str,
        preface: &[u8],
    ) -> Result<(Self, Earlier), SinkError> {
        let Some(mcap) = &arguments.output else {
            return Self::free(arguments, stem, preface);
        };
        let mcap = start(arguments, mcap, preface)?;
        Ok((Self::with(mcap, arguments, None)?, Earlier(Vec::new())))
    }

    /// Starts the files of the first of `NAME`, `NAME-2`, `NAME-3`, … without existing files, even if several
    /// runs look for one at once; of `NAME` itself if it may be replaced.
    fn free(
        arguments: &RunArguments,
        name: &str,
        preface: &[u8],
    ) -> Result<(Self, Earlier), SinkError> {
        let mut earlier = Vec::new();
        let mut stem = name.to_owned();
        loop {
            let file = |extension: &str| Path::new(DIRECTORY).join(format!("{stem}.{extension}"));
            let (mcap, rrd) = (file("mcap"), file("rrd"));
            let is_free = |path: &Path| !path.exists() && !partial_name(path).exists();
            if arguments.force || is_free(&mcap) && is_free(&rrd) {
                match start(arguments, &mcap, preface) {
                    // Another run was faster.
                    Err(SinkError::Exists { .. }) if !arguments.force => {}
                    mcap => {
                        let files = Self::with(mcap?, arguments, Some(&rrd))?;
                        return Ok((files, Earlier(earlier)));
                    }
                }
            }
            earlier.push(mcap);
            stem = format!("{name}-{}", earlier.len() + 1);
        }
    }

    /// The MCAP file, and the Rerun recording at `rrd` unless the arguments name another, or want none.
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

    /// The MCAP file; without the Rerun SDK there is no other.
    #[cfg(not(feature = "rerun"))]
    #[allow(clippy::unnecessary_wraps, reason = "with the Rerun SDK it may fail")]
    fn with(mcap: Draft, _: &RunArguments, _: Option<&Path>) -> Result<Self, SinkError> {
        Ok(Self { mcap })
    }
}

/// Starts a file that holds a preface, unless it is the scenario that is run.
fn start(arguments: &RunArguments, path: &Path, preface: &[u8]) -> Result<Draft, SinkError> {
    refuse_inputs(path, [arguments.scenario.as_path()])?;
    Draft::of_run(path, arguments.existing(), preface)
}

impl Earlier {
    /// The recording with the bytes of this draft.
    pub(super) fn same_as(&self, draft: &Draft) -> Option<WrittenFile> {
        let is_same = |path: &&PathBuf| are_equal(path, draft.working_name()).unwrap_or(false);
        let path = self.0.iter().find(is_same)?;
        Some(WrittenFile::new(path, path.metadata().ok()?.len()))
    }
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
