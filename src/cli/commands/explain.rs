//! `toprise explain`.

use crate::analysis::explain;
use crate::cli::arguments::{Override, parse_override};
use crate::cli::input::open;
use crate::cli::report;
use crate::cli::status::Status;
use anyhow::{Context as _, Error};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `toprise explain`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct ExplainArguments {
    /// A recording, a preset or a scenario file.
    #[arg(value_name = "RUN")]
    run: PathBuf,

    /// Set a key of the scenario, e.g. friction.k=0.02 (not for recordings)
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// Also show all events and a table of the averaged motion
    #[arg(long)]
    all: bool,
}

/// Explains a run.
pub(super) fn explain(arguments: &ExplainArguments) -> Result<Status, Error> {
    let input = open(&arguments.run, &[], &arguments.overrides)?;
    let explanation =
        explain::explain(input.subject()).with_context(|| arguments.run.display().to_string())?;
    report::print(&explanation, || explanation.sections(arguments.all))?;
    Ok(Status::from_whole(explanation.losses.is_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_one_run() {
        assert_eq!(
            parse::<ExplainArguments>("paper --set friction.k=0.02").unwrap(),
            ExplainArguments {
                run: "paper".into(),
                overrides: vec![("friction.k".to_owned(), "0.02".to_owned())],
                ..ExplainArguments::default()
            }
        );
        assert!(parse::<ExplainArguments>("").is_err());
    }
}
