//! The Rerun importer for scenario files: what the viewer starts for `rerun mine.toml`.
//!
//! Rerun starts each executable `rerun-importer-*` in PATH for a file that it can't read itself, passes the file and
//! the identifiers of the recording, and reads an `.rrd` stream from its standard output. An importer that can't read
//! the file either exits with [`EXTERNAL_IMPORTER_INCOMPATIBLE_EXIT_CODE`].

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use rerun::{EXTERNAL_IMPORTER_INCOMPATIBLE_EXIT_CODE, StoreId, TextDocument};
use thiserror::Error;

use super::blueprint;
use super::entity::ABOUT;
use super::error::RerunError;
use super::identity::{Identity, Playback, StoreNames};
use super::output::{Destination, Destinations, Output};
use super::role::Role;
use super::streams::explained::ExplainedSink;
use crate::archive::sink::{RecordedRun, Sink, SinkError, record_all};
use crate::run::scenario::{FORMAT, Scenario, ScenarioError, Values};
use crate::run::simulation::SimulationError;
use crate::telemetry::{RunError, RunMessages, Topic, Topics};

/// Why a file was not imported, or only in part.
#[derive(Debug, Error)]
pub enum ImportError {
    /// The arguments have no file.
    #[error(
        "usage: rerun-importer-toprise SCENARIO.toml [--application-id ID] [--recording-id ID]"
    )]
    NoFile,
    /// The file is not a scenario; another importer may read it.
    #[error("{} is not a toprise scenario", path.display())]
    NotAScenario {
        /// The file.
        path: PathBuf,
    },
    /// The file can't be read.
    #[error("cannot read {}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system error.
        source: io::Error,
    },
    /// The file is a scenario with an error.
    #[error("cannot read the scenario {}", path.display())]
    Scenario {
        /// The file.
        path: PathBuf,
        /// The error.
        source: ScenarioError,
    },
    /// The simulation can't start.
    #[error(transparent)]
    Start(#[from] SimulationError),
    /// The motion could not be computed to its end; the part before is shown.
    #[error("only part of the run is shown")]
    Incomplete(#[source] RunError),
    /// A message could not be passed on.
    #[error(transparent)]
    Sink(#[from] SinkError),
    /// The viewer did not read the whole stream.
    #[error(transparent)]
    Stream(#[from] RerunError),
}

impl ImportError {
    /// The exit code by which the viewer knows the reason.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::NotAScenario { .. } => EXTERNAL_IMPORTER_INCOMPATIBLE_EXIT_CODE as u8,
            Self::NoFile
            | Self::File { .. }
            | Self::Scenario { .. }
            | Self::Start(_)
            | Self::Incomplete(_)
            | Self::Sink(_)
            | Self::Stream(_) => 1,
        }
    }
}

/// The arguments that the viewer passes.
#[derive(Debug, Default, PartialEq)]
struct ImportRequest {
    path: Option<PathBuf>,
    names: StoreNames,
}

impl ImportRequest {
    /// Parses the arguments. Unknown options are ignored, because later versions of Rerun may pass more of them.
    fn parse(arguments: impl IntoIterator<Item = OsString>) -> Self {
        let mut request = Self::default();
        let mut arguments = arguments.into_iter();
        while let Some(argument) = arguments.next() {
            let text = argument.to_string_lossy();
            let (option, attached) = match text.split_once('=') {
                Some((option, value)) => (option, Some(value.to_owned())),
                None => (&*text, None),
            };
            match option {
                "--application-id" => {
                    request.names.application = attached.or_else(|| text_of(arguments.next()));
                }
                "--recording-id" => {
                    request.names.recording = attached.or_else(|| text_of(arguments.next()));
                }
                // The viewer's only options without a value.
                "--static" | "--timeless" => {}
                // The value of an unknown option is not the file.
                _ if option.starts_with("--") => {
                    if attached.is_none() {
                        arguments.next();
                    }
                }
                _ => request.path = request.path.or_else(|| Some(argument.clone().into())),
            }
        }
        request
    }
}

fn text_of(argument: Option<OsString>) -> Option<String> {
    Some(argument?.to_string_lossy().into_owned())
}

/// Simulates the scenario file that the arguments name, and writes the run to `output` as an `.rrd` stream.
///
/// # Errors
/// [`ImportError`], whose [exit code](ImportError::exit_code) is that of the importer.
pub fn import(
    arguments: impl IntoIterator<Item = OsString>,
    output: File,
) -> Result<(), ImportError> {
    let ImportRequest { path, names } = ImportRequest::parse(arguments);
    let path = path.ok_or(ImportError::NoFile)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let scenario = match read_scenario(&path) {
        Ok(scenario) => scenario,
        Err(error) => {
            // The viewer would say that no importer can read the file.
            if let ImportError::Scenario { source, .. } = &error {
                show_error(&names.store(&stem, &stem), source, output)?;
            }
            return Err(error);
        }
    };
    let topics: Vec<_> = Topic::all_with(scenario.model.support).collect();
    let identity = Identity {
        names,
        ..Identity::new(&stem, &scenario, topics, Playback::FromStart)
    };
    show(&scenario, &identity, output)
}

fn read_scenario(path: &Path) -> Result<Scenario, ImportError> {
    // Rerun asks for every file that it can't read itself.
    if path.extension().is_none_or(|extension| extension != "toml") {
        return Err(not_a_scenario(path));
    }
    let bytes = fs::read(path).map_err(|source| ImportError::File {
        path: path.to_owned(),
        source,
    })?;
    // Another importer may read a file that is not text.
    let text = String::from_utf8(bytes).map_err(|_| not_a_scenario(path))?;
    if !is_like_a_scenario(&text) {
        return Err(not_a_scenario(path));
    }
    Values::from_toml(&text)
        .and_then(Scenario::new)
        .map_err(|source| ImportError::Scenario {
            path: path.to_owned(),
            source,
        })
}

fn not_a_scenario(path: &Path) -> ImportError {
    ImportError::NotAScenario {
        path: path.to_owned(),
    }
}

/// Whether a text is meant to be a scenario, even if it has errors: it names the format, or has keys of a top, without
/// which there is no scenario.
fn is_like_a_scenario(text: &str) -> bool {
    text.lines().map(str::trim_start).any(|line| {
        line.starts_with("[top]")
            || line.starts_with("top.")
            || line.starts_with("format") && line.contains(FORMAT)
    })
}

/// Writes a Rerun recording that says what is wrong with a scenario.
fn show_error(store: &StoreId, error: &ScenarioError, output: File) -> Result<(), RerunError> {
    let destinations = Destinations {
        file: Some(output),
        live: None,
    };
    let mut output = Output::open(store.clone(), destinations);
    output.send_layout(Destination::File, blueprint::run::only_about(store));
    let text = format!("# The scenario has an error\n\n```text\n{error}\n```\n");
    output.send_static(
        Role::Alone.entity(ABOUT),
        &TextDocument::from_markdown(text),
    );
    output.finish().map(drop)
}

/// Simulates a scenario and writes the Rerun recording.
fn show(scenario: &Scenario, identity: &Identity, output: File) -> Result<(), ImportError> {
    let mut run = RunMessages::new(scenario, &Topics::All)?;
    let destinations = Destinations {
        file: Some(output),
        live: None,
    };
    let mut sink = ExplainedSink::new(scenario, identity, destinations);
    let mut sinks: [&mut dyn Sink; 1] = [&mut sink];
    let RecordedRun { outcome, error } = record_all(&mut run, &mut sinks)?;
    // The state in which an interruption or an error leaves a run is no outcome.
    if outcome.end.stop.is_complete() {
        sink.set_outcome(&outcome);
    }
    sink.finish()?;
    error.map_or(Ok(()), |error| Err(ImportError::Incomplete(error)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> ImportRequest {
        ImportRequest::parse(line.split_whitespace().map(OsString::from))
    }

    #[test]
    fn reads_the_arguments_of_the_viewer() {
        let expected = ImportRequest {
            path: Some("a.toml".into()),
            names: StoreNames {
                application: Some("app".to_owned()),
                recording: Some("rec".to_owned()),
            },
        };
        for line in [
            "a.toml --application-id app --recording-id rec",
            "--application-id=app --recording-id=rec a.toml",
            "--opened-recording-id old a.toml --static --application-id app --recording-id rec --time x=1",
        ] {
            assert_eq!(parse(line), expected, "{line}");
        }
        assert_eq!(parse("--application-id").path, None);
    }
}
