//! Exit status of commands.

use std::process::ExitCode;

/// Exit status of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    /// Success: exit code 0.
    Success = 0,
    /// Runs differ, or verification failed: exit code 1.
    Different = 1,
    /// An error that was already printed: exit code 2.
    Failed = 2,
    /// Partial result: exit code 3.
    Partial = 3,
}

impl Status {
    /// Success of a whole result, or a partial one.
    pub(super) fn from_whole(is_whole: bool) -> Self {
        if is_whole {
            Self::Success
        } else {
            Self::Partial
        }
    }
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> Self {
        Self::from(status as u8)
    }
}
