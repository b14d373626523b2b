//! The command line: arguments, what is printed, exit codes.

mod convert;
mod diff;
mod explain;
mod figures;
mod format;
mod given;
mod info;
mod interrupt;
mod laws;
mod output;
mod page;
mod presets;
mod progress;
mod recover;
mod run;
mod schema;
mod verify;
#[cfg(feature = "rerun")]
mod view;
#[cfg(feature = "rerun")]
mod viewer;

use crate::telemetry::encoding::Encoding;
use anyhow::Error;
use clap::{CommandFactory as _, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::process::ExitCode;

/// How a command ended, if it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Done {
    /// As asked: exit code 0.
    Well,
    /// What was compared is not the same, or not right: exit code 1.
    Differing,
    /// Something could not be read, which has been said: exit code 2.
    Unreadable,
    /// With less than was asked for: exit code 3.
    WithLosses,
}

/// Simulate how a heavy symmetric top rises under slipping friction.
///
/// toprise integrates the motion of a spinning top with a spherical peg and logs every state, every
/// torque and the slip velocity of the contact point into an MCAP file and a Rerun recording, so that
/// the rise can be scrubbed through, archived and reproduced bit for bit.
#[derive(Debug, Parser, PartialEq)]
#[command(name = "toprise", version, after_help = AFTER_HELP)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The command line's definition, from which help pages, completions and other documents can be made.
#[must_use]
pub fn command() -> clap::Command {
    Arguments::command()
}

const AFTER_HELP: &str = "\
Examples:
  toprise run                              the rise of the paper
  toprise run full-coulomb --spawn         another preset, live in the Rerun viewer
  toprise run --set friction.k=0.02        one value changed
  toprise presets paper > mine.toml        a scenario file to start from
  toprise run mine.toml -o mine.mcap
  toprise info recordings/paper.mcap
  toprise view recordings/*.mcap           recordings again in the Rerun viewer
  toprise verify recordings/*.mcap         whether they can be trusted
  toprise diff paper full-coulomb          what another friction model changes
  toprise diff a.mcap b.mcap --rel 1e-9    whether two recordings agree
  toprise explain paper                    why the top rises
  toprise figures                          the paper's figures, and more, as SVG and PNG
  toprise convert a.mcap b.mcap --encoding protobuf
  toprise recover a.mcap.partial a.mcap    what an interrupted run left

Exit codes: 0 done; 1 verification failed or runs differ; 2 bad usage, unreadable input or
failed output; 3 finished with losses (interrupted, parts of a file unreadable, or the motion could
not be integrated to its end).";

#[derive(Debug, Subcommand, PartialEq)]
enum Command {
    /// Simulate a scenario and record it.
    Run(run::RunArguments),
    /// Say what is in a recording.
    Info {
        /// An MCAP file.
        file: PathBuf,
        /// Form of the answer.
        #[arg(long, value_enum, default_value_t = Format::Text)]
        format: Format,
    },
    /// Show recordings in Rerun, as the run itself would have been shown.
    ///
    /// Without --connect, --serve and --rrd a viewer is started.
    #[cfg(feature = "rerun")]
    View(view::ViewArguments),
    /// Check recordings: container, messages, physics, and whether the simulation gives them again, bit
    /// for bit.
    ///
    /// Exit codes: 0 verified, 1 failed, 2 unreadable, 3 all that is there is right, but something is
    /// missing (a recording that was cut off or recovered).
    Verify(verify::VerifyArguments),
    /// Say what differs between runs: in the set-up, in what happened, in the averaged motion and point by
    /// point.
    ///
    /// Each run is a recording, or a preset or scenario file that is simulated now. Any other MCAP files can be
    /// compared too: the numbers of the topics that both have.
    ///
    /// Exit codes: 0 equal within the tolerances, 1 different, 2 unreadable or nothing to compare, 3 equal as
    /// far as both could be read.
    Diff(diff::DiffArguments),
    /// Tell the story of a run: what friction did to the precession, why the axis rose or fell, where the energy
    /// went.
    Explain(explain::ExplainArguments),
    /// Draw figures for print: those of the paper, and more.
    ///
    /// figure-2, figure-3 and figure-4 are the paper's. The others show the accelerations term by term, the rates
    /// of regular precession, the torques, the slip and the energy. With several runs each is an overlay; figure-4
    /// compares the others with the first.
    ///
    /// Exit codes: 0 drawn, 2 unreadable or nothing to draw, 3 drawn without what a run lacks.
    Figures(figures::FiguresArguments),
    /// Write a recording in another encoding; content, metadata and attachments stay the same.
    Convert(convert::ConvertArguments),
    /// Save what can be read of an interrupted or damaged recording.
    ///
    /// Exit codes: 0 nothing was lost, 2 nothing could be saved, 3 saved with losses.
    Recover(recover::RecoverArguments),
    /// List the presets, or print one as a scenario file.
    Presets {
        /// Preset to print as TOML.
        name: Option<String>,
    },
    /// List the laws of friction: formulas, parameters, typical values and sources.
    Laws {
        /// Form of the answer.
        #[arg(long, value_enum, default_value_t = Format::Text)]
        format: Format,
    },
    /// List the channels, print the schema of one, or write them all.
    Schema {
        /// Topic whose schema to print, as in /top/state.
        topic: Option<String>,
        /// Encoding whose schema to print: JSON Schema or a .proto file.
        #[arg(long, value_enum, default_value_t = EncodingName::Json, requires = "topic")]
        encoding: EncodingName,
        /// Write all schemas into this directory, replacing those there.
        #[arg(long, value_name = "DIRECTORY", conflicts_with = "topic")]
        write: Option<PathBuf>,
    },
    /// Print a completion script for a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
}

/// The form of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// The encoding of a recording's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EncodingName {
    /// JSON with JSON Schema: read everywhere.
    Json,
    /// Protocol Buffers: smaller, faster, plotted by Rerun.
    Protobuf,
}

impl From<EncodingName> for Encoding {
    fn from(name: EncodingName) -> Self {
        match name {
            EncodingName::Json => Self::Json,
            EncodingName::Protobuf => Self::Protobuf,
        }
    }
}

/// Runs the program with the arguments of the process.
#[must_use]
pub fn main() -> ExitCode {
    match dispatch(Arguments::parse().command) {
        Ok(Done::Well) => ExitCode::SUCCESS,
        Ok(Done::Differing) => ExitCode::from(1),
        Ok(Done::Unreadable) => ExitCode::from(2),
        Ok(Done::WithLosses) => ExitCode::from(3),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn dispatch(command: Command) -> Result<Done, Error> {
    match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Info { file, format } => info::info(&file, format),
        #[cfg(feature = "rerun")]
        Command::View(arguments) => view::view(&arguments),
        Command::Diff(arguments) => diff::diff(&arguments),
        Command::Explain(arguments) => explain::explain(&arguments),
        Command::Figures(arguments) => figures::figures(&arguments),
        Command::Convert(arguments) => convert::convert(&arguments),
        Command::Recover(arguments) => recover::recover(&arguments),
        Command::Verify(arguments) => verify::verify(&arguments),
        Command::Presets { name } => presets::presets(name.as_deref()),
        Command::Laws { format } => laws::laws(format),
        Command::Schema {
            topic,
            encoding,
            write,
        } => schema::schema(topic.as_deref(), encoding, write.as_deref()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "toprise", &mut script);
            output::print_bytes(&script)?;
            Ok(Done::Well)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn run_alone_means_the_paper() {
        let arguments = Arguments::try_parse_from(["toprise", "run"]).unwrap();
        let Command::Run(run) = arguments.command else {
            panic!("not run");
        };
        assert_eq!(run.scenario, "paper");
    }
}
