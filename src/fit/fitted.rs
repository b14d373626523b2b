//! The fit of one law, before it is reported.

use super::estimate::quality;
use super::model::{Point, Problem};
use super::report::{Mode, Quality};
use super::solve::Solution;

/// Points to fit and points to predict.
#[derive(Clone, Debug)]
pub(super) struct Split {
    pub fitted: Vec<Point>,
    pub held_out: Vec<Point>,
    /// End of the fitted part, s.
    pub end: f64,
    /// End of the data of the first file, s.
    pub last: f64,
}

/// The fit of one law.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub problem: Problem,
    pub solution: Solution,
    pub split: Split,
    /// The other minima that the data don't exclude.
    pub modes: Vec<Mode>,
}

impl Fitted {
    /// The name of the law.
    pub(super) fn law(&self) -> &str {
        self.problem.scenario.word("friction.law")
    }

    /// Goodness of the fit.
    pub(super) fn quality(&self) -> Quality {
        quality(&self.problem, &self.split.fitted, &self.solution)
    }
}
