//! In place of `sweep.rs` in a program without the feature `sweep`: no command, no arguments, and no tables.

#![expect(
    clippy::unused_self,
    clippy::unnecessary_wraps,
    reason = "the signatures are those of the modules that read tables"
)]

use super::status::Status;
use crate::archive::publish::Drafts;
use crate::run::scenario::Values;
use anyhow::Error;
use clap::{Args, Subcommand};
use std::path::Path;

/// No commands.
#[derive(Debug, Subcommand)]
pub(super) enum Commands {}

impl Commands {
    pub(super) fn run(&self, _drafts: &Drafts) -> Result<Status, Error> {
        match *self {}
    }
}

/// No reports.
pub(super) fn schemas() -> Vec<(String, String)> {
    Vec::new()
}

/// No error is one of a sweep.
pub(super) fn wrong_key<'a>(_cause: &'a (dyn std::error::Error + 'static)) -> Option<&'a str> {
    None
}

/// Nothing turns panics into errors.
pub(super) fn set_panic_hook() {}

/// No argument.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(super) struct RowArgument {}

impl RowArgument {
    pub(super) fn values(&self, _table: &Path) -> Result<Option<Values>, Error> {
        Ok(None)
    }

    pub(super) fn name(&self, table: String) -> String {
        table
    }
}

/// Figures of sweeps.
pub(super) mod figures {
    use crate::figures::Map;
    use anyhow::Error;
    use clap::Args;
    use std::path::Path;

    /// No arguments.
    #[derive(Args, Debug, PartialEq)]
    pub(in crate::cli) struct SweepFigure {}

    /// A figure of a sweep, which there is none of.
    pub(in crate::cli) enum SweepPlan {}

    impl SweepFigure {
        pub(in crate::cli) fn plan(&self) -> Result<Option<SweepPlan>, Error> {
            Ok(None)
        }
    }

    impl SweepPlan {
        pub(in crate::cli) fn table(&self) -> &Path {
            match *self {}
        }

        pub(in crate::cli) fn read(&self) -> Result<Map, Error> {
            match *self {}
        }
    }
}
