//! What every sentence of the summary needs.

use super::report::Report;
use super::setup::KeyDifference;
use crate::analysis::course::CourseReport;
use crate::analysis::phrase::quantity;

/// The report that is told, and what the two runs are called.
#[derive(Clone, Copy)]
pub(super) struct Tale<'r> {
    pub(super) report: &'r Report,
    pub(super) a: &'r str,
    pub(super) b: &'r str,
}

impl<'r> Tale<'r> {
    /// The keys of the scenarios that change the run.
    pub(super) fn keys(self) -> impl Iterator<Item = &'r KeyDifference> {
        let keys = self.report.setup.scenario.iter();
        keys.filter(|key| key.changes_the_run())
    }

    /// The names and courses of both runs, if these are known.
    pub(super) fn courses(self) -> Option<[(&'r str, &'r CourseReport); 2]> {
        let Report { a, b, .. } = self.report;
        Some([(self.a, a.course.as_ref()?), (self.b, b.course.as_ref()?)])
    }

    /// Whether a run could be read as a whole.
    pub(super) fn is_whole(self, name: &str) -> bool {
        let run = if name == self.a {
            &self.report.a
        } else {
            &self.report.b
        };
        run.losses.is_empty()
    }
}

/// An angle, rad.
pub(super) fn angle(value: f64) -> String {
    quantity(value, 3, "rad")
}

/// Whether a shift makes something later or earlier.
pub(super) fn order(shift: f64) -> &'static str {
    if shift > 0.0 { "later" } else { "earlier" }
}
