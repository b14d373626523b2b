//! In place of `sweep.rs` in a program without the feature `sweep`: no arguments, and no tables.

#![expect(
    clippy::unused_self,
    clippy::unnecessary_wraps,
    reason = "the signatures are those of the modules that read tables"
)]

use crate::run::scenario::Values;
use anyhow::Error;
use clap::Args;
use std::path::Path;

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

    /// No figure of a sweep.
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
