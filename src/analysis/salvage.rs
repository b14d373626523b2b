//! Saving what can be read of a recording, and judging what was saved.

use crate::analysis::verify::{Options, Verdict, verify};
use crate::archive::publish::Existing;
use crate::archive::recording::Recording;
use crate::archive::recover::{RecoverError, Recovered, recover, recover_doubting};
use std::path::Path;

/// Recovers a recording and verifies the result. A file that was put together from parts of several recordings may
/// have all that its end record counts and yet not be one run: then what doesn't fit is counted as lost.
///
/// # Errors
/// [`RecoverError`].
pub fn salvage(
    recording: &Recording,
    path: &Path,
    existing: Existing,
    progress: &dyn Fn(u64),
) -> Result<Recovered, RecoverError> {
    let recovered = recover(recording, path, existing, progress)?;
    match contradiction(path) {
        None => Ok(recovered),
        Some(doubt) => recover_doubting(recording, path, Existing::Replace, Some(&doubt), &|_| {}),
    }
}

/// What fails in a recording by itself, without its simulation.
fn contradiction(path: &Path) -> Option<String> {
    let recording = Recording::open(path).ok()?;
    let report = verify(&recording, Options { reproduce: false }, &|_| {});
    let mut checks = report.checks.iter();
    let failed = checks.find(|check| check.verdict == Verdict::Failed)?;
    let (name, finding) = (&failed.name, &failed.finding);
    Some(format!(
        "what belonged together ({name}: {finding}): parts are of another run"
    ))
}
