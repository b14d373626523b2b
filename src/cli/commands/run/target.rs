//! Where the MCAP recording of a run goes: a file, or standard output.

use super::file_plan::FilePlan;
use super::files::{McapFile, find_identical};
use crate::archive::pipeline::{Ended, McapSink, Pipeline};
use crate::archive::publish::{Draft, Drafts};
use crate::archive::recording::{Condition, Recording};
use crate::archive::sink::Sink;
use crate::archive::supplements::Supplements;
use crate::archive::writer::Header;
use crate::cli::output::{self, BinaryOutput};
use crate::cli::report::WrittenFile;
use crate::run::outcome::Outcome;
use anyhow::Error;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// A recording that is being written.
pub(super) enum McapTarget {
    File {
        sink: McapSink,
        /// Existing recordings of the run, by their names.
        earlier: Vec<PathBuf>,
    },
    Stream(Pipeline<BufWriter<BinaryOutput>>),
}

impl McapTarget {
    /// Writes what is before the first message.
    pub(super) fn start(files: &FilePlan, drafts: &Drafts, header: &Header) -> Result<Self, Error> {
        if files.is_streamed() {
            let stream = BufWriter::new(BinaryOutput::new()?);
            return Ok(Self::Stream(Pipeline::start(
                stream,
                "standard output".into(),
                header,
            )?));
        }
        let (sink, earlier) = files.start_mcap(drafts, header)?;
        Ok(Self::File { sink, earlier })
    }

    pub(super) fn path(&self) -> &Path {
        match self {
            Self::File { sink, .. } => sink.path(),
            Self::Stream(_) => Path::new("-"),
        }
    }

    pub(super) fn keep(&mut self) {
        if let Self::File { sink, .. } = self {
            sink.keep();
        }
    }

    pub(super) fn sink(&mut self) -> &mut dyn Sink {
        match self {
            Self::File { sink, .. } => sink,
            Self::Stream(pipeline) => pipeline,
        }
    }

    /// Completes the recording.
    pub(super) fn finish(
        self,
        files: &FilePlan,
        outcome: &Outcome,
        supplements: &Supplements<'_>,
    ) -> Result<Ended<McapFile>, Error> {
        match self {
            Self::File { sink, earlier } => {
                let ended = sink.complete_with(&outcome.end, supplements)?;
                ended.try_map(|draft| finish_mcap(draft, files, &earlier, outcome))
            }
            Self::Stream(pipeline) => {
                let ended = pipeline.end(&outcome.end, supplements)?;
                ended.try_map(|mut stream| {
                    stream.flush()?;
                    Ok(McapFile::New(WrittenFile::new(Path::new("-"), 0)))
                })
            }
        }
    }
}

/// Gives the MCAP file its name, unless there is an identical one among the `earlier` recordings.
fn finish_mcap(
    draft: Draft,
    files: &FilePlan,
    earlier: &[PathBuf],
    outcome: &Outcome,
) -> Result<McapFile, Error> {
    // Repeating a run would otherwise fill the directory with copies.
    if let Some(existing) = find_identical(&draft, earlier) {
        draft.discard();
        return Ok(McapFile::Identical(existing));
    }
    // With --force, a part of a run would otherwise replace a whole one.
    let is_part = !outcome.end.stop.is_complete();
    if is_part && files.replaces() && is_complete_recording(draft.path()) {
        return Ok(McapFile::Partial(keep_partial(draft)?));
    }
    Ok(McapFile::New(WrittenFile::publish(draft)?))
}

/// Whether there is a recording of a whole run.
fn is_complete_recording(path: &Path) -> bool {
    Recording::open(path).is_ok_and(|recording| recording.condition() == Condition::Whole)
}

/// Leaves the file of an incomplete run under its partial name, because a complete recording has its own.
fn keep_partial(draft: Draft) -> Result<WrittenFile, Error> {
    let (path, partial) = (draft.path().to_owned(), draft.working_name().to_owned());
    // From the start of the run, a draft stays if it is not published.
    drop(draft);
    output::warn(&format!(
        "{} is a complete recording and stays as it is; the incomplete run is {}",
        path.display(),
        partial.display()
    ));
    Ok(WrittenFile::new(&partial, partial.metadata()?.len()))
}
