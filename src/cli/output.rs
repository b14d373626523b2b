//! All output of the program.
//!
//! Reports go to standard output, everything else to standard error. Write errors never cause a panic. A closed pipe
//! (`head`, `true`) is not an error: its reader wants no more. A full disk is (exit code 2).

use super::arguments::Format;
use super::text;
use crate::words::sanitized_lines;
use anstyle::{AnsiColor, Effects, Style};
use clap::ColorChoice;
use std::io::{self, IsTerminal as _, Write};
use std::path::Path;
use std::sync::OnceLock;

/// Minimum report width; narrower terminals wrap the lines.
const MIN_WIDTH: usize = 60;

const ERROR: Style = AnsiColor::Red.on_default().effects(Effects::BOLD);
const WARNING: Style = AnsiColor::Yellow.on_default().effects(Effects::BOLD);

/// The options of all commands that concern output.
#[derive(Clone, Copy, Debug)]
struct OutputOptions {
    /// Whether warnings and notes are left out.
    is_quiet: bool,
    /// The format of reports.
    format: Format,
}

/// The options, for the whole program: errors and warnings arise everywhere, also before all arguments are parsed, and
/// must have the right format there.
static OPTIONS: OnceLock<OutputOptions> = OnceLock::new();

/// Sets the global output options.
pub(super) fn set_up(is_quiet: bool, color: ColorChoice, format: Format) {
    // Only tests could set them twice.
    let _ = OPTIONS.set(OutputOptions { is_quiet, format });
    match color {
        ColorChoice::Auto => anstream::ColorChoice::Auto,
        ColorChoice::Always => anstream::ColorChoice::Always,
        ColorChoice::Never => anstream::ColorChoice::Never,
    }
    .write_global();
}

/// Whether --quiet is set.
pub(super) fn is_quiet() -> bool {
    OPTIONS.get().is_some_and(|options| options.is_quiet)
}

/// The output format.
pub(super) fn format() -> Format {
    OPTIONS.get().map_or(Format::Text, |options| options.format)
}

/// The terminal width; `None` if standard output is not a terminal.
pub(super) fn columns() -> Option<usize> {
    // In a pipe or a file lines are not wrapped, so that `grep` finds whole ones.
    io::stdout()
        .is_terminal()
        .then(|| textwrap::termwidth().max(MIN_WIDTH))
}

/// Whether the output is text that a program reads: in a pipe or a file.
pub(super) fn is_for_programs() -> bool {
    format() == Format::Text && columns().is_none()
}

/// Prints a plain report.
pub(super) fn print(report: &str) -> io::Result<()> {
    write(&mut io::stdout().lock(), &sanitized_lines(report))
}

/// Prints a styled, already sanitised report; removes colours if they are disabled.
pub(super) fn print_styled(report: &str) -> io::Result<()> {
    let mut stream = io::stdout().lock();
    match anstream::stdout().current_choice() {
        anstream::ColorChoice::Never => {
            let plain = anstream::adapter::strip_str(report).to_string();
            write(&mut stream, &plain)
        }
        _ => write(&mut stream, report),
    }
}

/// Writes a report.
fn write(stream: &mut impl Write, report: &str) -> io::Result<()> {
    let text = report.trim_end();
    if text.is_empty() {
        return Ok(());
    }
    write_line(stream, &format!("{text}\n")).map_err(|error| {
        let message = format!("cannot write to standard output: {error}");
        io::Error::new(error.kind(), message)
    })
}

fn write_line(stream: &mut impl Write, text: &str) -> io::Result<()> {
    let written = stream.write_all(text.as_bytes());
    match written.and_then(|()| stream.flush()) {
        // Other programs are ended by SIGPIPE, which Rust ignores.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// Standard output for bytes. A closed pipe is no error, as for reports: its reader wants no more.
#[derive(Debug)]
pub(super) struct BinaryOutput(io::Stdout);

impl BinaryOutput {
    /// Standard output, unless it is a terminal, which would show nonsense.
    pub(super) fn new() -> io::Result<Self> {
        if io::stdout().is_terminal() {
            let reason = "standard output is a terminal: redirect it to a file or a program";
            return Err(io::Error::other(reason));
        }
        Ok(Self(io::stdout()))
    }
}

impl Write for BinaryOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(bytes.len()),
            result => result,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.flush() {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            result => result,
        }
    }
}

/// Prints an error.
pub(super) fn error(what: &str) {
    print_line(&format!("{ERROR}error:{ERROR:#} "), what);
}

/// Prints a warning, unless --quiet is set.
pub(super) fn warn(what: &str) {
    if !is_quiet() {
        print_line(&format!("{WARNING}warning:{WARNING:#} "), what);
    }
}

/// Warns that a file replaces a symbolic link, whose target stays as it is.
pub(super) fn warn_of_link(path: &Path, is_forced: bool) {
    if is_forced && path.is_symlink() {
        let path = path.display();
        warn(&format!(
            "{path} is a symbolic link: the new file replaces the link, and the file that it points to stays as it is"
        ));
    }
}

/// Prints a note, unless --quiet is set.
pub(super) fn note(what: &str) {
    if !is_quiet() {
        print_line("", what);
    }
}

fn print_line(prefix: &str, what: &str) {
    // A failing standard error is ignored.
    let _ = writeln!(anstream::stderr().lock(), "{prefix}{}", text::message(what));
}

/// An error with its chain of causes, without repetitions.
pub(super) fn with_causes(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .fold(String::new(), |message, cause| {
            if message.is_empty() {
                cause
            // Some errors already include their cause.
            } else if message.contains(&cause) {
                message
            } else {
                format!("{message}: {cause}")
            }
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::anyhow;

    /// Accepts some bytes and then fails.
    struct Broken(usize, io::ErrorKind);

    impl Write for Broken {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            if taken == 0 {
                Err(self.1.into())
            } else {
                Ok(taken)
            }
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn reports_write_errors_unless_the_reader_has_left() {
        let written = |room, kind| write(&mut Broken(room, kind), "answer");
        for room in [0, 3] {
            let full = written(room, io::ErrorKind::StorageFull);
            let reported = full.unwrap_err().to_string();
            assert!(
                reported.starts_with("cannot write to standard output: "),
                "{reported}"
            );
            assert!(written(room, io::ErrorKind::BrokenPipe).is_ok());
        }
        assert!(written(7, io::ErrorKind::StorageFull).is_ok());
    }

    #[test]
    fn prints_each_cause_once() {
        let error = anyhow!("no space left")
            .context("cannot write a.mcap: no space left")
            .context("a.mcap");
        assert_eq!(
            with_causes(&error),
            "a.mcap: cannot write a.mcap: no space left"
        );
    }
}
