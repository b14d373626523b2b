//! In place of `rerun.rs` in a program without the feature `rerun`: no arguments, nothing is shown.

#![expect(
    clippy::unused_self,
    clippy::unnecessary_wraps,
    reason = "the signatures are those of the modules that show runs"
)]

/// The part of the report of `diff` that is about the viewer.
pub(super) mod viewer {
    /// No viewer to mention.
    pub(in crate::cli) const SPAWN_HINT: &str = "";
}

/// The Rerun side of `toprise run`.
pub(super) mod run {
    use crate::archive::publish::Draft;
    use crate::archive::sink::Sink;
    use crate::cli::commands::run::file_plan::RrdFile;
    use crate::cli::report::{Completed, WrittenFile};
    use crate::run::outcome::Outcome;
    use crate::run::scenario::Scenario;
    use crate::telemetry::Telemetry;
    use anyhow::Error;
    use clap::Args;
    use std::path::Path;

    /// No arguments.
    #[derive(Args, Clone, Debug, Default, PartialEq)]
    pub(in crate::cli) struct ShowArguments {}

    impl ShowArguments {
        pub(in crate::cli) fn rrd(&self, _has_output: bool) -> RrdFile {
            RrdFile::None
        }

        pub(in crate::cli) fn plan(&self, _has_output: bool, _is_paced: bool) -> ShowPlan {
            ShowPlan
        }
    }

    /// Nothing is shown.
    #[derive(Clone, Debug)]
    pub(in crate::cli) struct ShowPlan;

    impl ShowPlan {
        pub(in crate::cli) fn note(&self) -> Option<&'static str> {
            None
        }
    }

    /// No viewer.
    pub(in crate::cli) enum RunViewer {}

    impl RunViewer {
        pub(in crate::cli) fn open(
            _plan: &ShowPlan,
            _draft: Option<Draft>,
            _scenario: &Scenario,
            _telemetry: &Telemetry,
            _mcap: &Path,
        ) -> Result<Option<Self>, Error> {
            Ok(None)
        }

        pub(in crate::cli) fn sink(&mut self) -> &mut dyn Sink {
            // No value exists, so this is never called, which the compiler checks.
            match *self {}
        }

        pub(in crate::cli) fn set_outcome(&mut self, _outcome: &Outcome) {
            match *self {}
        }

        pub(in crate::cli) fn keep_partial(self) -> Result<Completed, Error> {
            match self {}
        }

        pub(in crate::cli) fn finish(
            self,
            _substitute: Option<&WrittenFile>,
        ) -> Result<Completed, Error> {
            match self {}
        }
    }
}

/// The Rerun side of `toprise diff`.
pub(super) mod diff {
    use crate::analysis::diff::{Report, Subject};
    use crate::archive::publish::Drafts;
    use crate::telemetry::{Message, side::Side};
    use anyhow::Error;
    use clap::Args;
    use std::path::PathBuf;

    /// No arguments.
    #[derive(Args, Clone, Debug, PartialEq)]
    pub(in crate::cli) struct ShowArguments {}

    impl ShowArguments {
        pub(in crate::cli) fn plan(&self, _runs: &[PathBuf]) -> Result<ShowPlan, Error> {
            Ok(ShowPlan)
        }
    }

    /// Nothing is shown.
    pub(in crate::cli) struct ShowPlan;

    /// No viewer.
    pub(in crate::cli) enum PairViewer {}

    impl PairViewer {
        pub(in crate::cli) fn open(
            _plan: &ShowPlan,
            _subjects: [Subject<'_>; 2],
            _names: [&str; 2],
            _drafts: &Drafts,
        ) -> Result<Option<Self>, Error> {
            Ok(None)
        }

        pub(in crate::cli) fn write(&mut self, _side: Side, _message: &Message<'_>) {
            match *self {}
        }

        pub(in crate::cli) fn write_difference(&mut self, _message: &Message<'_>) {
            match *self {}
        }

        pub(in crate::cli) fn finish(self, _report: &Report) -> Result<bool, Error> {
            match self {}
        }
    }
}

/// The Rerun side of `toprise fit`.
#[cfg(feature = "fit")]
pub(super) mod fit {
    use crate::archive::publish::{Drafts, Existing};
    use crate::cli::report::Completed;
    use crate::fit::Fit;
    use anyhow::Error;
    use clap::Args;
    use std::path::Path;

    /// No arguments.
    #[derive(Args, Clone, Debug, Default, PartialEq)]
    pub(in crate::cli) struct ShowArguments {}

    impl ShowArguments {
        pub(in crate::cli) fn plan(&self) -> Result<ShowPlan, Error> {
            Ok(ShowPlan)
        }
    }

    /// Nothing is shown.
    pub(in crate::cli) struct ShowPlan;

    impl ShowPlan {
        pub(in crate::cli) fn file(&self) -> Option<&Path> {
            None
        }

        pub(in crate::cli) fn show(
            &self,
            _fit: &Fit,
            _report: String,
            _drafts: &Drafts,
            _existing: Existing,
        ) -> Result<Completed, Error> {
            Ok(Completed::default())
        }
    }
}
