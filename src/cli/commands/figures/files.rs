//! The files of figures.

use crate::archive::publish::{self, Drafts, Existing};
use crate::archive::sink::SinkError;
use crate::cli::commands::image::ImageFormat;
use crate::cli::output;
use crate::figures::{Drawing, FigureFile};
use anyhow::Context as _;
use std::path::PathBuf;

/// The files that are written.
pub(super) struct FigureFiles {
    pub(super) directory: PathBuf,
    pub(super) kinds: Vec<ImageFormat>,
    pub(super) existing: Existing,
}

impl FigureFiles {
    fn path(&self, figure: &str, kind: ImageFormat) -> PathBuf {
        self.directory
            .join(format!("{figure}.{}", kind.extension()))
    }

    /// Checks that the files of some figures can be written and are no inputs.
    pub(super) fn check(&self, figures: &[&str], inputs: &[PathBuf]) -> Result<(), SinkError> {
        for figure in figures {
            for kind in &self.kinds {
                let path = self.path(figure, *kind);
                publish::check_not_an_input(&path, inputs.iter().map(PathBuf::as_path))?;
                // A link to nothing takes the name, too.
                if self.existing == Existing::Keep && path.symlink_metadata().is_ok() {
                    let advice = "choose another directory, or replace it with --force".to_owned();
                    return Err(SinkError::Exists { path, advice });
                }
            }
        }
        Ok(())
    }

    /// Writes the files of a figure, given its name and title.
    pub(super) fn write(
        &self,
        drafts: &Drafts,
        (figure, title): (&'static str, &'static str),
        runs: &[String],
        drawing: &Drawing,
    ) -> Result<Vec<FigureFile>, anyhow::Error> {
        let mut files = Vec::new();
        for kind in &self.kinds {
            let path = self.path(figure, *kind);
            let name = path.display().to_string();
            let bytes = kind.bytes(drawing).with_context(|| name.clone())?;
            // Before the file replaces the link.
            output::warn_of_link(&path, self.existing == Existing::Replace);
            publish::write_in(drafts, &path, self.existing, &bytes)?;
            files.push(FigureFile {
                figure,
                title,
                runs: runs.to_vec(),
                path: name,
                bytes: bytes.len() as u64,
            });
        }
        Ok(files)
    }
}
