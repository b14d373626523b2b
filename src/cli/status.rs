//! Exit status of commands.

use std::process::ExitCode;

/// Exit status of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    /// Success: exit code 0.
    Success,
    /// Runs differ, or verification failed: exit code 1.
    Different,
    /// An error that was already printed: exit code 2.
    Failed,
    /// Partial result: exit code 3.
    Partial,
}

impl Status {
    /// Success of a whole result, or a partial one.
    pub(super) fn of_whole(is_whole: bool) -> Self {
        if is_whole {
            Self::Success
        } else {
            Self::Partial
        }
    }
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        Self::from(match status {
            Status::Success => 0,
            Status::Different => 1,
            Status::Failed => 2,
            Status::Partial => 3,
        })
    }
}
