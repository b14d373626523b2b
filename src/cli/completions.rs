//! `toprise completions`.

use super::output;
use super::status::Status;
use anyhow::Error;
use clap::Args;
use clap_complete::Shell;

/// Arguments of `toprise completions`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct CompletionsArguments {
    /// The shell.
    shell: Shell,
}

/// Prints a script that completes the arguments of `command` in a shell.
pub(super) fn completions(
    arguments: &CompletionsArguments,
    mut command: clap::Command,
) -> Result<Status, Error> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "toprise", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(Status::Success)
}
