//! In place of `fit.rs` in a program without the feature `fit`: no command.

use super::status::Status;
use crate::archive::publish::Drafts;
use anyhow::Error;
use clap::Subcommand;

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

/// Reports that are attached to recordings of fits.
#[cfg(feature = "rerun")]
pub(super) mod attached {
    /// No report can be read.
    pub(in crate::cli) fn report(_json: &[u8]) -> Option<String> {
        None
    }
}

/// No error is one of a fit.
pub(super) fn wrong_key<'a>(_cause: &'a (dyn std::error::Error + 'static)) -> Option<&'a str> {
    None
}
