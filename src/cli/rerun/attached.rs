//! The report that is attached to the recording of a fit.

use crate::cli::terminal;
use crate::fit::Report;
use crate::words::markdown;

/// The report in Markdown; `None` if it isn't one of this program.
pub(super) fn report(json: &[u8]) -> Option<String> {
    let report: Report = serde_json::from_slice(json).ok()?;
    Some(markdown(&report.words(false).sections, terminal::option))
}
