//! The command-line program.
//!
//! Each command with a report is a file with its arguments, its report and its function. `input` opens the runs named
//! on the command line; `report` prints a report as JSON or as a `page`; all output goes through `output`.
//!
//! `fit`, `rerun` and `sweep` need the features of these names. Without the feature this file has none of its commands and
//! reports, and a file `without_…` stands in place of the options that it adds to other commands.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod completions;
mod diff;
mod explain;
mod figures;
mod file_kind;
mod info;
mod input;
mod interrupt;
mod laws;
mod losses;
mod output;
mod presets;
mod progress;
mod report;
mod run;
mod schema;
mod status;
mod terminal;
mod text;
mod verify;
mod version;

#[cfg(feature = "fit")]
mod fit;
#[cfg(feature = "rerun")]
mod rerun;
#[cfg(not(feature = "rerun"))]
#[path = "cli/without_rerun.rs"]
mod rerun;
#[cfg(feature = "sweep")]
mod sweep;
#[cfg(not(feature = "sweep"))]
#[path = "cli/without_sweep.rs"]
mod sweep;

use crate::analysis;
use crate::archive::input::InputError;
use crate::archive::publish::Drafts;
use crate::run::scenario::ScenarioError;
use anyhow::Error;
use arguments::{Format, OUTPUT};
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue};
use clap::{ColorChoice, CommandFactory as _, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use interrupt::SignalGuard;
use status::Status;
use std::ffi::OsString;
use std::process::ExitCode;

/// Simulate and record the motion of a spinning top, and explain why it rises.
///
/// A spinning top rises because its round peg slips on the table. toprise integrates this motion and records the state,
/// the torques, the terms of the accelerations and the slip velocity in an MCAP file (reproducible bit for bit) and for
/// the Rerun viewer.
///
/// A run can be a preset (see `toprise presets`), a scenario file (TOML; create one with `toprise presets paper >
/// mine.toml`) or a recording (MCAP). Units are SI and radians.
#[derive(Debug, Parser)]
#[command(name = "toprise", version, long_version = version::long(), after_help = EXAMPLES, after_long_help = MORE)]
#[command(next_help_heading = OUTPUT, next_display_order = 899, max_term_width = MAX_WIDTH)]
struct Arguments {
    #[command(subcommand)]
    command: Command,

    /// Output format: text, json or markdown
    #[arg(
        long,
        global = true,
        value_enum,
        default_value_t,
        hide_possible_values = true
    )]
    format: Format,

    /// Print only errors (and the report, with --format json or markdown)
    #[arg(short, long, global = true)]
    quiet: bool,

    /// Use colours: auto (on a terminal, unless NO_COLOR is set), always or never
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        value_enum,
        default_value_t,
        hide_possible_values = true
    )]
    color: ColorChoice,
}

/// The clap definition of the command line, for help pages and completions.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Maximum width of help pages, columns. Without a terminal clap would wrap at 100, wider than many terminals.
const MAX_WIDTH: usize = 80;

const EXAMPLES: &str = "\
Start with:
  toprise run                        simulate the paper's run into recordings/
  toprise explain paper              explain why the top rises
  toprise --help                     more examples, and the exit codes";

const MORE: &str = "\
Simulate and view:
  toprise run                              the paper's run, into recordings/
  toprise run full-coulomb --spawn         another preset, shown in Rerun
  toprise run --set friction.k=0.02        change one value
  toprise presets paper > mine.toml        write a scenario file to edit
  toprise run mine.toml -o mine.mcap
  toprise view recordings/*.mcap           open recordings in the Rerun viewer

Analyse:
  toprise explain paper                    why the top rises
  toprise diff paper full-coulomb          compare two friction models
  toprise diff a.mcap b.mcap --rel 1e-9    compare with a tolerance
  toprise fit paper data.csv --free friction.k,initial
                                           estimate k from measured angles
  toprise figures                          the paper's figures, as SVG and PNG
  toprise sweep paper --over friction.k=0.005..0.1/64log -o k.parquet

Manage recordings:
  toprise info recordings/paper.mcap       list the contents
  toprise verify recordings/*.mcap         run the scenarios again and compare
  toprise run a.mcap --encoding protobuf   repeat a run in another encoding
  toprise run a.mcap.partial               repeat an interrupted run

For scripts: --format json prints each report as JSON, and
`toprise schema --write DIR` writes the JSON Schemas of reports and of the
messages in recordings.

Exit codes:
  0  success; recordings verified, runs equal
  1  verification failed, runs differ, or a model does not describe the data
  2  bad usage, unreadable input or failed output
  3  partial result: interrupted, file partly unreadable, runs compared in part,
     or the motion could not be computed to its end
  130  interrupted without a result";

#[derive(Debug, Subcommand)]
enum Command {
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
    View(rerun::view::ViewArguments),
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
    /// List the presets, or print one, or the scenario of a recording, as a scenario file.
    Presets(presets::PresetsArguments),
    /// List the laws of friction, or describe one: formulas, parameters, typical values and sources.
    Laws(laws::LawsArguments),
    /// List the channels of a recording, print the schema of one, or write all schemas.
    Schema(schema::SchemaArguments),
    /// Print a completion script for a shell.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    let words: Vec<OsString> = std::env::args_os().collect();
    let arguments = match parse(&words) {
        Ok(arguments) => arguments,
        Err(usage) => {
            // Also without parsed arguments, the error must have the requested form.
            output::set_up(
                false,
                option_or_default(&words, "--color"),
                option_or_default(&words, "--format"),
            );
            return print_usage(&usage);
        }
    };
    output::set_up(arguments.quiet, arguments.color, arguments.format);
    #[cfg(feature = "sweep")]
    sweep::set_panic_hook();
    let signals = SignalGuard::install();
    match dispatch(arguments.command, signals.drafts()) {
        Ok(status) => status.into(),
        Err(error) => {
            let text = output::with_causes(&error);
            output::error(&text);
            report::print_error(&text, wrong_key(&error));
            Status::Failed.into()
        }
    }
}

/// The key of the scenario that an error is about.
fn wrong_key(error: &Error) -> Option<&str> {
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

/// The features of the program, each with whether it has the feature, its commands, and its options of other commands.
const FEATURES: [(&str, bool, &[&str]); 3] = [
    ("fit", cfg!(feature = "fit"), &["fit"]),
    (
        "rerun",
        cfg!(feature = "rerun"),
        &["view", "--rrd", "--no-rrd", "--spawn", "--connect"],
    ),
    (
        "sweep",
        cfg!(feature = "sweep"),
        &["sweep", "--row", "--sweep"],
    ),
];

/// Adds to the error of an unknown command or option that it belongs to a feature that this program lacks.
fn name_missing_feature(usage: &mut clap::Error) {
    let unknown = usage
        .get(ContextKind::InvalidSubcommand)
        .or_else(|| usage.get(ContextKind::InvalidArg));
    let Some(ContextValue::String(unknown)) = unknown else {
        return;
    };
    for (feature, is_present, words) in FEATURES {
        if !is_present && words.contains(&unknown.as_str()) {
            let tip = format!("toprise was built without the feature `{feature}`");
            let tips = ContextValue::StyledStrs(vec![StyledStr::from(tip)]);
            usage.insert(ContextKind::Suggested, tips);
            return;
        }
    }
}

/// Parses the arguments. Errors respect --color and contain no control characters.
fn parse(words: &[OsString]) -> Result<Arguments, clap::Error> {
    Arguments::try_parse_from(words).map_err(|error| {
        // Parsed again, as clap quotes what was given.
        let sanitized = words
            .iter()
            .map(|word| crate::words::sanitized(&word.to_string_lossy()).into_owned());
        let mut error = Arguments::command()
            .color(option_or_default(words, "--color"))
            .try_get_matches_from(sanitized)
            .err()
            .unwrap_or(error);
        name_missing_feature(&mut error);
        error
    })
}

/// The value of an option in unparsed arguments, or its default if it is missing or invalid.
fn option_or_default<V: ValueEnum + Default>(words: &[OsString], option: &str) -> V {
    let mut words = words.iter().filter_map(|word| word.to_str());
    while let Some(word) = words.next() {
        let Some(rest) = word.strip_prefix(option) else {
            continue;
        };
        let value = rest.strip_prefix('=').or_else(|| words.next());
        return value
            .and_then(|value| V::from_str(value, false).ok())
            .unwrap_or_default();
    }
    V::default()
}

/// Prints the help, the version or a usage error.
fn print_usage(usage: &clap::Error) -> ExitCode {
    if usage.use_stderr() {
        // If standard error can't be written to, the message is lost.
        let _ = usage.print();
        let text = usage.render().to_string();
        report::print_error(text.trim_start_matches("error: ").trim_end(), None);
        return Status::Failed.into();
    }
    match output::print_styled(&usage.render().ansi().to_string()) {
        Ok(()) => Status::Success.into(),
        Err(error) => {
            output::error(&error.to_string());
            Status::Failed.into()
        }
    }
}

fn dispatch(command: Command, drafts: &Drafts) -> Result<Status, Error> {
    match command {
        Command::Run(arguments) => run::run(&arguments, drafts),
        #[cfg(feature = "rerun")]
        Command::View(arguments) => rerun::view::view(&arguments, drafts),
        Command::Explain(arguments) => explain::explain(&arguments),
        Command::Diff(arguments) => diff::diff(&arguments, drafts),
        #[cfg(feature = "fit")]
        Command::Fit(arguments) => fit::fit(&arguments, drafts),
        Command::Figures(arguments) => figures::figures(&arguments, drafts),
        #[cfg(feature = "sweep")]
        Command::Sweep(arguments) => sweep::sweep(&arguments, drafts),
        Command::Info(arguments) => info::info(&arguments),
        Command::Verify(arguments) => verify::verify(&arguments),
        Command::Presets(arguments) => presets::presets(&arguments),
        Command::Laws(arguments) => laws::laws(&arguments),
        Command::Schema(arguments) => schema::schema(&arguments, schemas(), drafts),
        Command::Completions { shell } => {
            output::print(&completions::script(shell, Arguments::command()))?;
            Ok(Status::Success)
        }
    }
}

/// The JSON Schemas of all reports, as file names and contents for `schemas/`.
pub fn schemas() -> Vec<(String, String)> {
    vec![
        report::schema::<run::RunReport>("RunReport"),
        #[cfg(feature = "rerun")]
        report::schema::<rerun::view::ViewReport>("ViewReport"),
        report::schema::<analysis::explain::Explanation>("ExplainReport"),
        report::schema::<analysis::diff::Report>("DiffReport"),
        #[cfg(feature = "fit")]
        report::schema::<fit::FitReport>("FitReport"),
        report::schema::<crate::figures::FiguresReport>("FiguresReport"),
        #[cfg(feature = "sweep")]
        report::schema::<sweep::report::SweepReport>("SweepReport"),
        report::schema::<info::InfoReport>("InfoReport"),
        report::schema::<verify::VerifyReport>("VerifyReport"),
        report::schema::<presets::PresetsReport>("PresetsReport"),
        report::schema::<laws::LawsReport>("LawsReport"),
        report::schema::<schema::SchemaReport>("SchemaReport"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn examples_fit_a_narrow_terminal() {
        for line in EXAMPLES.lines().chain(MORE.lines()) {
            assert!(line.chars().count() <= MAX_WIDTH, "{line}");
        }
    }

    /// Options of one name must have one type in all commands: only parsing shows that.
    #[test]
    fn parses_figures_of_a_sweep() {
        let line = "toprise figures --sweep a.parquet --x friction_k --show loops --color never";
        let parsed = Arguments::try_parse_from(line.split(' '));
        assert_eq!(parsed.is_ok(), cfg!(feature = "sweep"));
        assert!(Arguments::try_parse_from(["toprise", "figures", "--x", "a"]).is_err());
    }

    #[test]
    fn global_options_stand_before_or_after_the_command() {
        for line in [
            "toprise -q --color never laws",
            "toprise laws --quiet --color=never",
        ] {
            let arguments = Arguments::try_parse_from(line.split(' ')).unwrap();
            assert!(arguments.quiet && arguments.color == ColorChoice::Never);
        }
        assert!(Arguments::try_parse_from(["toprise", "--color", "pink", "laws"]).is_err());
    }

    #[test]
    fn unknown_commands_and_options_name_a_missing_feature() {
        for (word, feature, is_present) in [
            ("fit", "fit", cfg!(feature = "fit")),
            ("view", "rerun", cfg!(feature = "rerun")),
            ("run --spawn", "rerun", cfg!(feature = "rerun")),
            ("sweep", "sweep", cfg!(feature = "sweep")),
            ("run --row=2", "sweep", cfg!(feature = "sweep")),
        ] {
            let line = format!("toprise {word} --no-such-option");
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            let message = parse(&words).unwrap_err().render().to_string();
            let tip = format!("tip: toprise was built without the feature `{feature}`");
            assert_eq!(message.contains(&tip), !is_present, "{line}: {message}");
        }
    }

    #[test]
    fn usage_errors_are_sanitized_and_keep_their_colours() {
        let line = "toprise --no-\x1b[2Jsuch\u{202e}-option\nerror: forged";
        let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
        let message = parse(&words).unwrap_err().render().to_string();
        assert!(
            message.contains("--no-�[2Jsuch�-option�error:"),
            "{message}"
        );
        for (line, color) in [
            ("toprise --color=never --help", ColorChoice::Never),
            ("toprise laws --color always --wrong", ColorChoice::Always),
            ("toprise --color pink", ColorChoice::Auto),
            ("toprise --color", ColorChoice::Auto),
        ] {
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            assert!(parse(&words).is_err(), "{line}");
            assert_eq!(
                option_or_default::<ColorChoice>(&words, "--color"),
                color,
                "{line}"
            );
        }
    }
}
