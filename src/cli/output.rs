//! The one way out: whatever the program prints goes through here.
//!
//! Standard output carries the answer, standard error everything else. A stream that can't be written never ends the
//! program in a panic. Who stops reading, as `head` does, has read enough, and the exit code is that of the command;
//! an answer that could not be written at all is failed output. (Rust's runtime puts the null device in the place
//! of a standard output that is closed, which can't be distinguished from one that the user chose.)

use super::arguments::Format;
use super::text;
use anstyle::{AnsiColor, Effects, Style};
use clap::ColorChoice;
use std::io::{self, IsTerminal as _, Write};
use std::sync::OnceLock;

/// The fewest columns that a report takes: narrower terminals break the lines themselves.
const NARROWEST: usize = 60;

const ERROR: Style = AnsiColor::Red.on_default().effects(Effects::BOLD);
const WARNING: Style = AnsiColor::Yellow.on_default().effects(Effects::BOLD);

/// The values of `--quiet` and `--format`.
static OPTIONS: OnceLock<(bool, Format)> = OnceLock::new();

/// Takes in the options that hold for all that is printed from here on.
pub(super) fn set_up(quiet: bool, color: ColorChoice, format: Format) {
    let _ = OPTIONS.set((quiet, format));
    match color {
        ColorChoice::Auto => anstream::ColorChoice::Auto,
        ColorChoice::Always => anstream::ColorChoice::Always,
        ColorChoice::Never => anstream::ColorChoice::Never,
    }
    .write_global();
}

/// Whether only errors are wanted.
pub(super) fn is_quiet() -> bool {
    OPTIONS.get().is_some_and(|(quiet, _)| *quiet)
}

/// The output format.
pub(super) fn format() -> Format {
    OPTIONS.get().map_or(Format::Text, |(_, format)| *format)
}

/// The number of columns of the terminal that shows the answer; none if it goes to a file or to another program.
pub(super) fn columns() -> Option<usize> {
    let is_terminal = io::stdout().is_terminal();
    is_terminal.then(|| textwrap::termwidth().max(NARROWEST))
}

/// Prints an answer that has no colours.
pub(super) fn print(answer: &str) -> io::Result<()> {
    write(&mut io::stdout().lock(), &text::harmless_lines(answer))
}

/// Prints an answer that is harmless and has colours, which are taken out where they are not wanted.
pub(super) fn print_styled(answer: &str) -> io::Result<()> {
    write(&mut anstream::stdout().lock(), answer)
}

/// Prints JSON.
pub(super) fn print_json(json: &str) -> io::Result<()> {
    write(&mut io::stdout().lock(), &text::harmless_json(json))
}

fn write(stream: &mut impl Write, answer: &str) -> io::Result<()> {
    let answer = answer.trim_end();
    if answer.is_empty() {
        return Ok(());
    }
    let answer = format!("{answer}\n");
    let first = stream.write(answer.as_bytes());
    let rest = |written: usize| {
        let written = stream.write_all(&answer.as_bytes()[written..]);
        match written.and_then(|()| stream.flush()) {
            // Who reads no further has read enough.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            result => result,
        }
    };
    first.and_then(rest).map_err(|error| {
        let reported = format!("cannot write to standard output: {error}");
        io::Error::new(error.kind(), reported)
    })
}

/// Says what went wrong.
pub(super) fn error(what: &str) {
    print_line(&format!("{ERROR}error:{ERROR:#} "), what);
}

/// Warns of something, unless with `--quiet`.
pub(super) fn warn(what: &str) {
    if !is_quiet() {
        print_line(&format!("{WARNING}warning:{WARNING:#} "), what);
    }
}

/// Warns of several things.
#[cfg(feature = "rerun")]
pub(super) fn warn_all(warnings: Vec<String>) {
    for warning in warnings {
        warn(&warning);
    }
}

/// Says what else was done; nothing with `--quiet`.
#[cfg(any(feature = "rerun", feature = "sweep"))]
pub(super) fn note(what: &str) {
    if !is_quiet() {
        print_line("", what);
    }
}

/// Says what must be known to go on, even with `--quiet`.
#[cfg(feature = "web-viewer")]
pub(super) fn announce(what: &str) {
    print_line("", what);
}

fn print_line(prefix: &str, what: &str) {
    // Without standard error there is no place for it.
    let _ = writeln!(anstream::stderr().lock(), "{prefix}{}", text::message(what));
}

/// An error with its causes, without those that it contains itself.
pub(super) fn with_causes(error: &anyhow::Error) -> String {
    error
        .chain()
        .map(ToString::to_string)
        .fold(String::new(), |reported, cause| {
            if reported.is_empty() {
                cause
            } else if reported.contains(&cause) {
                reported
            } else {
                format!("{reported}: {cause}")
            }
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::anyhow;

    /// Takes some bytes, and then fails.
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
    fn what_cannot_be_written_is_named_unless_its_reader_has_read_enough() {
        let written = |room, kind| write(&mut Broken(room, kind), "answer");
        for (room, kind) in [
            (0, io::ErrorKind::BrokenPipe),
            (0, io::ErrorKind::StorageFull),
            (3, io::ErrorKind::StorageFull),
        ] {
            let reported = written(room, kind).unwrap_err().to_string();
            assert!(
                reported.starts_with("cannot write to standard output: "),
                "{reported}"
            );
        }
        assert!(written(3, io::ErrorKind::BrokenPipe).is_ok());
        assert!(written(7, io::ErrorKind::StorageFull).is_ok());
    }

    #[test]
    fn causes_are_told_once() {
        let error = anyhow!("no space left").context("cannot write a.mcap: no space left");
        let error = error.context("a.mcap");
        assert_eq!(
            with_causes(&error),
            "a.mcap: cannot write a.mcap: no space left"
        );
    }
}
