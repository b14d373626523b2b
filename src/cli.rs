//! The command-line program.
//!
//! Each command is a file of `commands`. `input` opens the runs named on the command line; `report` prints a report as
//! JSON or as a `page`; all output goes through `output`.
//!
//! `rerun` and the commands `fit` and `sweep` need the features of these names; `extension` has the arguments that they
//! add to other commands.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod arguments;
mod commands;
mod extension;
mod file_kind;
mod input;
mod interrupt;
mod output;
mod progress;
mod report;
mod status;
mod terminal;
mod text;
mod version;

#[cfg(feature = "rerun")]
mod rerun;

pub use commands::schemas;

use arguments::{Format, OUTPUT, allow_negative_numbers};
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue};
use clap::{ColorChoice, CommandFactory as _, FromArgMatches as _, Parser, ValueEnum};
use commands::Command;
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

    /// Output format: text, json or markdown; csv (only of diff)
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
    allow_negative_numbers(Arguments::command())
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
    if arguments.format == Format::Csv && !arguments.command.has_csv() {
        output::error("--format csv is only for toprise diff");
        return Status::Failed.into();
    }
    let signals = SignalGuard::install();
    match commands::dispatch(arguments.command, command(), signals.drafts()) {
        Ok(status) => status.into(),
        Err(error) => {
            let text = output::with_causes(&error);
            output::error(&text);
            report::print_error(&text, commands::wrong_key(&error));
            Status::Failed.into()
        }
    }
}

/// Adds to the error of an unknown command or option that it belongs to a feature that this program lacks.
fn name_missing_feature(usage: &mut clap::Error) {
    let unknown = usage
        .get(ContextKind::InvalidSubcommand)
        .or_else(|| usage.get(ContextKind::InvalidArg));
    let Some(ContextValue::String(unknown)) = unknown else {
        return;
    };
    for (feature, is_present, words) in version::FEATURES {
        if !is_present && words.contains(&unknown.as_str()) {
            let tip = format!("toprise was built without the feature `{feature}`");
            let tips = ContextValue::StyledStrs(vec![StyledStr::from(tip)]);
            usage.insert(ContextKind::Suggested, tips);
            return;
        }
    }
}

/// Reads the arguments of a command line.
fn read(words: &[OsString]) -> Result<Arguments, clap::Error> {
    let matches = command().try_get_matches_from(words)?;
    Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command()))
}

/// Parses the arguments. Errors respect --color and contain no control characters.
fn parse(words: &[OsString]) -> Result<Arguments, clap::Error> {
    read(words).map_err(|error| {
        // Parsed again, as clap quotes what was given.
        let sanitized = words
            .iter()
            .map(|word| crate::words::sanitized(&word.to_string_lossy()).into_owned());
        let mut error = command()
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
    fn words_with_a_dash_are_numbers() {
        for (line, expected) in [
            ("diff paper paper --rel -1", "must be a number of 0 or more"),
            ("diff paper paper --abs x", "must be a number of 0 or more"),
        ] {
            let line = format!("toprise {line}");
            let words: Vec<OsString> = line.split(' ').map(OsString::from).collect();
            let message = parse(&words).unwrap_err().render().to_string();
            assert!(message.contains(expected), "{line}: {message}");
            assert!(!message.contains("-- -"), "{line}: {message}");
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
