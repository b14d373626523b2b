//! Images that commands write.

use crate::archive::publish::{Drafts, Existing, check_not_an_input, check_target, write_in};
use crate::cli::output;
use crate::cli::report::WrittenFile;
use crate::figures::Drawing;
use anyhow::{Context as _, Error};
use clap::ValueEnum;
use std::path::{Path, PathBuf};

/// The format of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ImageFormat {
    /// Vector graphics
    Svg,
    /// Bitmap, 300 dpi
    Png,
}

impl ImageFormat {
    pub(super) fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }

    pub(super) fn bytes(self, drawing: &Drawing) -> Result<Vec<u8>, Error> {
        Ok(match self {
            Self::Svg => drawing.svg().into_bytes(),
            Self::Png => drawing.png()?,
        })
    }
}

/// The image that `--plot` names.
pub(super) struct Plot {
    path: PathBuf,
    format: ImageFormat,
    existing: Existing,
}

impl Plot {
    /// The width, mm.
    pub(super) const WIDTH: f64 = 120.0;

    /// Checks that the file can be written and is no input, before anything is computed.
    pub(super) fn new(path: &Path, existing: Existing, inputs: &[PathBuf]) -> Result<Self, Error> {
        let extension = path.extension();
        let format = ImageFormat::value_variants()
            .iter()
            .find(|format| extension.is_some_and(|own| own == format.extension()))
            .with_context(|| {
                let name = path.with_extension("svg");
                format!("--plot writes SVG or PNG: call it {}", name.display())
            })?;
        check_not_an_input(path, inputs.iter().map(PathBuf::as_path))?;
        check_target(path, existing)?;
        Ok(Self {
            path: path.to_owned(),
            format: *format,
            existing,
        })
    }

    pub(super) fn write(&self, drafts: &Drafts, drawing: &Drawing) -> Result<WrittenFile, Error> {
        let bytes = self
            .format
            .bytes(drawing)
            .with_context(|| self.path.display().to_string())?;
        // Before the file replaces the link.
        output::warn_of_link(&self.path, self.existing == Existing::Replace);
        write_in(drafts, &self.path, self.existing, &bytes)?;
        Ok(WrittenFile::new(&self.path, bytes.len() as u64))
    }
}
