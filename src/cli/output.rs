//! Writing to standard output without panicking when nobody reads it.

use std::io::{self, Write as _};

/// Prints a text and a newline.
pub(super) fn print(text: &str) -> io::Result<()> {
    print_bytes(format!("{}\n", text.trim_end()).as_bytes())
}

/// Prints a text with colours: on a terminal that shows them, unless `NO_COLOR` is set; else without.
pub(super) fn print_styled(text: &str) -> io::Result<()> {
    let choice = anstream::AutoStream::choice(&io::stdout());
    if choice == anstream::ColorChoice::Never {
        return print(&anstream::adapter::strip_str(text).to_string());
    }
    print(text)
}

/// Prints bytes as they are.
pub(super) fn print_bytes(bytes: &[u8]) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        // Who reads no further has read enough: the exit code says the rest.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// Says on standard error what went wrong.
pub(super) fn error(text: &str) {
    // Where standard error is gone there is nobody to tell.
    let _ = writeln!(io::stderr(), "error: {text}");
}

/// Says on standard error what else was done, beside an answer on standard output.
pub(super) fn note(text: &str) {
    // Where standard error is gone there is nobody to tell.
    let _ = writeln!(io::stderr(), "{text}");
}

/// Warns on standard error.
pub(super) fn warn(text: &str) {
    // Where standard error is gone there is nobody to warn.
    let _ = writeln!(io::stderr(), "warning: {text}");
}

/// Warns of several things.
#[cfg(feature = "rerun")]
pub(super) fn warn_all(texts: Vec<String>) {
    for text in texts {
        warn(&text);
    }
}
