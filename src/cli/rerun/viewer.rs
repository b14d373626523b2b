//! Selection of the Rerun viewer.

use crate::archive::publish::Draft;
use crate::archive::sink::SinkError;
use crate::cli::arguments::VIEWER;
use crate::cli::output;
use crate::cli::report::{Completed, WrittenFile};
use crate::rerun::{Live, RerunError, ViewerError};
use anyhow::{Context as _, Error};
use clap::Args;

/// Viewer arguments.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(super) struct ViewerArguments {
    /// Connect to a running Rerun viewer [default URL: local viewer]
    #[arg(long, value_name = "URL", num_args = 0..=1, require_equals = true,
          default_missing_value = "rerun+http://127.0.0.1:9876/proxy",
          conflicts_with = "spawn", help_heading = VIEWER)]
    connect: Option<String>,

    /// Start a Rerun viewer
    #[arg(long, help_heading = VIEWER)]
    spawn: bool,
}

impl ViewerArguments {
    /// Whether files may be opened in a new viewer.
    pub(super) fn can_open_files(&self) -> bool {
        self.connect.is_none()
    }

    /// The requested viewer, if any: a running one, or one to start.
    pub(super) fn live(&self) -> Option<Live> {
        match &self.connect {
            Some(url) => Some(Live::Connect(url.clone())),
            None => self.spawn.then_some(Live::Spawn),
        }
    }
}

/// Finishes a Rerun stream: prints viewer warnings and publishes the file, if there is one.
pub(super) fn complete(
    ended: Result<Vec<ViewerError>, RerunError>,
    draft: Option<Draft>,
) -> Result<Completed, Error> {
    let warnings = ended.map_err(|error| SinkError::Viewer(Box::new(error)));
    let Some(draft) = draft else {
        return Ok(Completed {
            file: None,
            is_viewer_lost: warn_all(&warnings?),
        });
    };
    let lost = format!("{} is not written", draft.path().display());
    match warnings {
        Ok(warnings) => {
            warn_all(&warnings);
            Ok(Completed {
                file: Some(WrittenFile::publish(draft).context(lost)?),
                // The file has all that the viewer was to show.
                is_viewer_lost: false,
            })
        }
        Err(error) => {
            draft.discard();
            Err(error).context(lost)
        }
    }
}

/// Prints what went wrong with a viewer. Returns whether it went away.
pub(super) fn warn_all(warnings: &[ViewerError]) -> bool {
    for warning in warnings {
        output::warn(&warning.to_string());
    }
    warnings.iter().any(ViewerError::is_loss)
}
