//! The slip of both runs in the report of a comparison.

use crate::analysis::diff::Report;
use crate::analysis::slip::SlipComparison;
use crate::words::Section;

/// What the coefficients of friction do, if they differ.
pub(super) fn section(report: &Report) -> Section {
    let mut section = Section::default();
    let slip = report.slip.as_ref();
    if let Some(sentence) = slip.and_then(SlipComparison::sentence) {
        section.line(sentence);
    }
    section
}
