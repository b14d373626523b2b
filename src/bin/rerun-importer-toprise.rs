//! The Rerun importer for scenario files: in PATH, it makes `rerun mine.toml` simulate the scenario and show the run.

use std::env;
use std::error::Error;
use std::fs::File;
use std::io;
use std::process::ExitCode;

use toprise::rerun::{ImportError, import};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let mut cause: Option<&dyn Error> = Some(&error);
            let mut text = String::new();
            while let Some(error) = cause {
                text = format!("{text}{}{error}", if text.is_empty() { "" } else { ": " });
                cause = error.source();
            }
            eprintln!("error: {text}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn run() -> Result<(), ImportError> {
    let output = standard_output().map_err(|error| ImportError::Stream(error.into()))?;
    import(env::args_os().skip(1), output)
}

/// Standard output as a file, without the line buffer of [`io::stdout`].
#[cfg(unix)]
fn standard_output() -> io::Result<File> {
    use std::os::fd::AsFd as _;
    Ok(io::stdout().as_fd().try_clone_to_owned()?.into())
}

/// Standard output as a file, without the line buffer of [`io::stdout`].
#[cfg(windows)]
fn standard_output() -> io::Result<File> {
    use std::os::windows::io::AsHandle as _;
    Ok(io::stdout().as_handle().try_clone_to_owned()?.into())
}
