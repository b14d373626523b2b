//! What the commands do with the Rerun viewer. Without the feature `rerun`, `without_rerun.rs` stands here.

pub(super) mod diff;
#[cfg(feature = "fit")]
pub(super) mod fit;
pub(super) mod run;
mod view;
mod viewer;

use super::report;
use super::status::Status;
use crate::archive::publish::Drafts;
use anyhow::Error;
use clap::Subcommand;
use view::{ViewArguments, ViewReport, view};

/// The command of the feature `rerun`.
#[derive(Debug, Subcommand)]
pub(super) enum Commands {
    /// Show recordings in the Rerun viewer, with the layout of `toprise run`.
    ///
    /// Starts a viewer unless --connect or --rrd is given.
    #[command(
        after_help = "Exit codes: 0 shown, 2 unreadable or no viewer, 3 shown in part (interrupted, or the file is partly unreadable)."
    )]
    View(ViewArguments),
}

impl Commands {
    /// Runs the command.
    pub(super) fn run(&self, drafts: &Drafts) -> Result<Status, Error> {
        match self {
            Self::View(arguments) => view(arguments, drafts),
        }
    }
}

/// The JSON Schema of the command's report, as a file name and its content.
pub(super) fn schemas() -> Vec<(String, String)> {
    vec![report::schema::<ViewReport>("ViewReport")]
}
