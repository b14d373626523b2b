//! Ends of commands.

use std::process::ExitCode;

/// End of a command that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Done {
    /// Everything was done as asked: exit code 0.
    Well,
    /// The runs that were compared differ, or a recording is not right: exit code 1.
    Differing,
    /// A file could not be read, which is reported: exit code 2.
    Unreadable,
    /// Less than what was asked for is there: exit code 3.
    WithLosses,
}

impl From<Done> for ExitCode {
    fn from(done: Done) -> Self {
        Self::from(match done {
            Done::Well => 0,
            Done::Differing => 1,
            Done::Unreadable => 2,
            Done::WithLosses => 3,
        })
    }
}
