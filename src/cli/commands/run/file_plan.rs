//! The files that a run reads and writes.

use crate::archive::pipeline::McapSink;
use crate::archive::publish::{Draft, Drafts, Existing, check_not_an_input, partial_name};
use crate::archive::sink::SinkError;
use crate::archive::writer::Header;
use crate::cli::output::warn_of_link;
use std::path::{Path, PathBuf};

/// The directory for recordings, unless the arguments name a file.
const DIRECTORY: &str = "recordings";

/// The files of a run.
#[derive(Debug)]
pub(in crate::cli) struct FilePlan {
    /// The scenario or recording, which is never overwritten.
    pub(super) input: PathBuf,
    /// The MCAP file; `None` for the next free name in [`DIRECTORY`].
    pub(super) mcap: Option<PathBuf>,
    /// The stem of a name in [`DIRECTORY`].
    pub(super) stem: String,
    /// The treatment of existing files.
    pub(super) existing: Existing,
}

impl FilePlan {
    /// Starts the MCAP file. Its name is that of the arguments, or the first free one of `STEM`, `STEM-2`, `STEM-3`, …
    /// (`STEM` itself with --force). Also returns the existing recordings with the names before it. Safe if several runs
    /// start at once.
    pub(super) fn start_mcap(
        &self,
        drafts: &Drafts,
        header: &Header,
    ) -> Result<(McapSink, Vec<PathBuf>), SinkError> {
        let mut earlier = Vec::new();
        if let Some(mcap) = &self.mcap {
            let sink = McapSink::open(self.create(drafts, mcap)?, header)?;
            return Ok((sink, earlier));
        }
        let mut name = self.stem.clone();
        loop {
            let mcap = Path::new(DIRECTORY).join(format!("{name}.mcap"));
            if self.replaces() || is_free(&mcap) && is_free(&mcap.with_extension("rrd")) {
                let started = self.create(drafts, &mcap);
                match started.and_then(|draft| McapSink::open(draft, header)) {
                    // Another run took this name.
                    Err(SinkError::Exists { .. }) if !self.replaces() => {}
                    started => return Ok((started?, earlier)),
                }
            }
            earlier.push(mcap);
            name = format!("{}-{}", self.stem, earlier.len() + 1);
        }
    }

    /// The scenario or recording.
    pub(super) fn input(&self) -> &Path {
        &self.input
    }

    /// Whether the MCAP file goes to standard output.
    pub(super) fn is_streamed(&self) -> bool {
        self.mcap
            .as_ref()
            .is_some_and(|mcap| mcap.as_os_str() == "-")
    }

    /// Creates the draft of a file. Refuses to overwrite the input.
    pub(in crate::cli) fn create(&self, drafts: &Drafts, path: &Path) -> Result<Draft, SinkError> {
        // Also with --force: the scenario would be lost if the run fails.
        check_not_an_input(path, [self.input.as_path()])?;
        let draft = Draft::new_in(drafts, path, self.existing)?;
        warn_of_link(path, self.replaces());
        Ok(draft)
    }

    /// Whether an existing file is replaced.
    pub(super) fn replaces(&self) -> bool {
        self.existing == Existing::Replace
    }
}

/// Whether neither a file nor an unfinished one has this name.
fn is_free(path: &Path) -> bool {
    !path.exists() && !partial_name(path).exists()
}
