//! Records that contradict each other or the messages, in a file that is intact: other software changed them.

use super::file::Recording;
use crate::archive::format::{CONTENT_DIGEST, SCENARIO_DIGEST, STOP_REASON};
use crate::run::simulation::StopReason;
use thiserror::Error;

/// What shows that the records and messages of a recording do not belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub(crate) enum Contradiction {
    #[error("missing metadata record toprise.run")]
    NoRun,
    #[error("altered scenario: its digest is not the one in toprise.run")]
    Scenario,
    #[error("altered end record: it has no content digest")]
    NoDigest,
    #[error("altered messages: their digest is not the one in the end record")]
    Digest,
    #[error("altered end record: the run can't have stopped for its reason")]
    StopReason,
    #[error("altered end record: the last sample is not at its time")]
    StopTime,
}

impl Contradiction {
    /// That of the records of a finished recording.
    pub(super) fn find(recording: &Recording) -> Option<Self> {
        let end = recording.end()?;
        let Some(run) = recording.run() else {
            return Some(Self::NoRun);
        };
        if !recording.has_this_telemetry() {
            return None;
        }
        let digest = recording.scenario().ok().map(|scenario| scenario.digest());
        if digest.is_some() && run.get(SCENARIO_DIGEST) != digest.as_ref() {
            return Some(Self::Scenario);
        }
        if !end.contains_key(CONTENT_DIGEST) {
            return Some(Self::NoDigest);
        }
        let reason = end.get(STOP_REASON)?;
        StopReason::find(reason)
            .is_none()
            .then_some(Self::StopReason)
    }
}
