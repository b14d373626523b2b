//! The commands: a file each, with the arguments, the report and the function.

mod annotate;
mod archive;
mod completions;
pub(super) mod diff;
mod explain;
mod figures;
#[cfg(feature = "fit")]
mod fit;
mod image;
mod info;
mod laws;
mod presets;
pub(super) mod run;
mod schema;
#[cfg(feature = "sweep")]
pub(super) mod sweep;
mod verify;

use self::annotate::annotate;
use self::archive::archive;
use self::completions::ScriptKind;
use self::diff::diff;
use self::explain::explain;
use self::figures::figures;
#[cfg(feature = "fit")]
use self::fit::fit;
use self::info::info;
use self::laws::laws;
use self::presets::presets;
use self::run::run;
use self::schema::schema;
#[cfg(feature = "sweep")]
use self::sweep::sweep;
use self::verify::verify;
use crate::analysis;
use crate::archive::input::InputError;
use crate::archive::publish::Drafts;
#[cfg(feature = "rerun")]
use crate::cli::rerun::view::{ViewArguments, ViewReport, view};
use crate::cli::status::Status;
use crate::cli::{output, report};
use crate::run::scenario::ScenarioError;
use anyhow::Error;
use clap::Subcommand;

/// A command with its arguments.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Simulate a scenario and record it.
    #[command(
        after_help = "Exit codes: 0 recorded, 2 invalid scenario or failed output, 3 recorded in part (interrupted, or the integration failed)."
    )]
    Run(run::RunArguments),
    /// Show recordings in the Rerun viewer, with the layout of `toprise run`.
    ///
    /// Starts a viewer unless --connect or --rrd is given.
    #[cfg(feature = "rerun")]
    #[command(
        after_help = "Exit codes: 0 shown, 2 unreadable or no viewer, 3 shown in part (interrupted, or the file is partly unreadable)."
    )]
    View(ViewArguments),
    /// Explain why the top rises or falls in a run.
    ///
    /// The report lists the events, the causes of the motion of the axis, and the energy balance.
    #[command(
        after_help = "Exit codes: 0 explained, 2 unreadable or nothing to explain, 3 explained in part (the recording is incomplete)."
    )]
    Explain(explain::ExplainArguments),
    /// Compare two runs: scenarios, events, averaged motion, and every field.
    ///
    /// Each run is a recording, a preset or a scenario file. MCAP files of other software are compared by topic, time
    /// and bytes.
    #[command(
        after_help = "Exit codes: 0 equal within the tolerances, 1 different, 2 unreadable or nothing to compare, 3 the common part is equal (a run is damaged, interrupted or sampled more finely)."
    )]
    Diff(diff::DiffArguments),
    /// Estimate friction and start from a measured motion, and compare friction laws.
    ///
    /// Reports first which parameters the data can determine. Estimates have standard deviations and 95 % intervals.
    #[cfg(feature = "fit")]
    #[command(
        after_help = "Exit codes: 0 fitted (and, comparing laws, decided), 1 the model does not describe the data, or undecided, 2 unreadable, or the data can't determine the parameters, 3 no minimum was found, or the model ends before the data."
    )]
    Fit(Box<fit::FitArguments>),
    /// Draw the paper's figures and others, as SVG and PNG.
    ///
    /// figure-2, figure-3 and figure-4 are those of the paper. The others: acceleration (terms of the equations),
    /// precession (rates of regular precession), torque, slip, energy; for free pegs also track (path of the contact
    /// point) and hops (normal force and height). Several runs are overlaid; figure-4 compares the others with the
    /// first. For a sweep (--sweep FILE --x KEY), draws a map over two keys, or curves over one.
    #[command(
        after_help = "Exit codes: 0 drawn, 2 unreadable or nothing to draw, 3 drawn in part (a run lacks data)."
    )]
    Figures(figures::FiguresArguments),
    /// Run a scenario for many values of its keys and tabulate the outcomes.
    ///
    /// Each row of the Parquet table contains the varied keys and the outcome of one run. To resume an interrupted
    /// sweep, or to merge shards, run the same command again. The bytes of the table don't depend on threads, shards or
    /// interruptions.
    #[cfg(feature = "sweep")]
    #[command(
        after_help = "Exit codes: 0 all runs have an outcome, 2 bad usage or failed output, 3 some runs failed (see the column `error`), or the sweep was interrupted."
    )]
    Sweep(sweep::SweepArguments),
    /// List the content of a recording, or of any MCAP file.
    #[command(
        after_help = "Exit codes: 0 everything was read, 2 unreadable, 3 the recording was interrupted or damaged."
    )]
    Info(info::InfoArguments),
    /// Verify recordings by rerunning their scenarios and comparing the files.
    ///
    /// A file with identical bytes is verified. Otherwise the messages are compared and the first difference is
    /// reported (time, channel, field, both values).
    #[command(
        after_help = "Exit codes: 0 verified, 1 different, 2 unreadable, 3 the common part is equal (incomplete run, or recorded by another version of toprise)."
    )]
    Verify(verify::VerifyArguments),
    /// Add title, creators, licence and more to a recording, in a copy.
    ///
    /// The copy holds the same run, and verifies as the recording does. Running it again with the next file replaces what
    /// was added before.
    #[command(after_help = "Exit codes: 0 written, 2 unreadable or failed output.")]
    Annotate(annotate::AnnotateArguments),
    /// Archive recordings with all that a repository asks, as a directory or a ZIP file.
    ///
    /// The archive holds the recordings and their scenarios, reports, comparisons and figures, and says who made them
    /// (RO-Crate 1.2, CITATION.cff, .zenodo.json, SHA256SUMS). toprise verify checks all of it.
    #[command(after_help = "Exit codes: 0 written, 2 unreadable, not verified, or failed output.")]
    Archive(archive::ArchiveArguments),
    /// List the presets, or print one, or the scenario of a recording, as a scenario file.
    Presets(presets::PresetsArguments),
    /// List the laws of friction, or describe some: formulas, parameters, typical values and sources.
    ///
    /// With --plot, draws their coefficients of friction against the slip speed: of laws with usual parameters, of scenario
    /// files and of recordings.
    Laws(laws::LawsArguments),
    /// List the channels of a recording, print the schema of one, or write all schemas.
    Schema(schema::SchemaArguments),
    /// Print a completion script for a shell, or the man page.
    Completions {
        /// The shell, or man
        #[arg(value_name = "SHELL")]
        kind: ScriptKind,
    },
}

/// Executes a command. Completions are those of the whole `definition`.
pub(super) fn dispatch(
    command: Command,
    definition: clap::Command,
    drafts: &Drafts,
) -> Result<Status, Error> {
    #[cfg(feature = "sweep")]
    sweep::set_panic_hook();
    match command {
        Command::Run(arguments) => run(&arguments, drafts),
        #[cfg(feature = "rerun")]
        Command::View(arguments) => view(&arguments, drafts),
        Command::Explain(arguments) => explain(&arguments),
        Command::Diff(arguments) => diff(&arguments, drafts),
        #[cfg(feature = "fit")]
        Command::Fit(arguments) => fit(&arguments, drafts),
        Command::Figures(arguments) => figures(&arguments, drafts),
        #[cfg(feature = "sweep")]
        Command::Sweep(arguments) => sweep(&arguments, drafts),
        Command::Info(arguments) => info(&arguments),
        Command::Verify(arguments) => verify(&arguments, drafts),
        Command::Annotate(arguments) => annotate(&arguments, drafts),
        Command::Archive(arguments) => archive(&arguments, drafts),
        Command::Presets(arguments) => presets(&arguments),
        Command::Laws(arguments) => laws(&arguments, drafts),
        Command::Schema(arguments) => schema(&arguments, schemas(), drafts),
        Command::Completions { kind } => {
            output::print(&completions::script(kind, definition)?)?;
            Ok(Status::Success)
        }
    }
}

/// The key of the scenario that an error is about.
pub(super) fn wrong_key(error: &Error) -> Option<&str> {
    error.chain().find_map(|cause| {
        #[cfg(feature = "sweep")]
        if let Some(error) = cause.downcast_ref::<crate::sweep::SweepError>() {
            return error.key();
        }
        #[cfg(feature = "fit")]
        if let Some(error) = cause.downcast_ref::<fit::FitFailure>() {
            return error.key();
        }
        // This is transparent: the error of the scenario is no cause of its own in the chain.
        let scenario_error = match cause.downcast_ref::<InputError>() {
            Some(error) => error.scenario_error(),
            None => cause.downcast_ref::<ScenarioError>(),
        };
        scenario_error?.key.as_deref()
    })
}

impl Command {
    /// Whether its report has a table of comma-separated values.
    pub(super) fn has_csv(&self) -> bool {
        matches!(self, Self::Diff(_))
    }
}

/// The JSON Schemas of all reports, as file names and contents for `schemas/`.
pub fn schemas() -> Vec<(String, String)> {
    vec![
        report::schema::<run::RunReport>(),
        #[cfg(feature = "rerun")]
        report::schema::<ViewReport>(),
        report::schema::<analysis::explain::Explanation>(),
        report::schema::<analysis::diff::Report>(),
        #[cfg(feature = "fit")]
        report::schema::<fit::FitReport>(),
        report::schema::<crate::figures::FiguresReport>(),
        #[cfg(feature = "sweep")]
        report::schema::<sweep::report::SweepReport>(),
        report::schema::<info::InfoReport>(),
        report::schema::<verify::VerifyReport>(),
        report::schema::<annotate::AnnotateReport>(),
        report::schema::<archive::ArchiveReport>(),
        report::schema::<presets::PresetsReport>(),
        report::schema::<laws::LawsReport>(),
        report::schema::<schema::SchemaReport>(),
    ]
}
