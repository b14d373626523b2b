//! The fit of one law, before it is reported.

use super::solve::Solution;
use crate::fit::error::FitError;
use crate::fit::estimate::quality;
use crate::fit::problem::model::{Point, Problem};
use crate::fit::report::{Mode, Quality};

/// Points to fit and points to predict.
#[derive(Clone, Debug)]
pub(in crate::fit) struct Split {
    pub fitted: Vec<Point>,
    pub held_out: Vec<Point>,
    /// End of the fitted part, s.
    pub end: f64,
    /// End of the data of the first file, s.
    pub last: f64,
}

impl Split {
    /// The points of the first file, whose clock is the model's. The last part of its time is held out.
    pub(in crate::fit) fn from_first_file(problem: &Problem, holdout: f64) -> Self {
        let first = problem.points_in_file(0);
        let last = first.iter().map(|point| point.time).fold(0.0, f64::max);
        let end = last * (1.0 - holdout);
        let (fitted, held_out) = first.into_iter().partition(|point| point.time <= end);
        Self {
            fitted,
            held_out,
            end,
            last,
        }
    }

    /// Replaces the points to fit. Points of the other files are held out in the time in which those of the first are.
    pub(in crate::fit) fn fit_points(
        &mut self,
        problem: &Problem,
        values: &[f64],
        points: Vec<Point>,
    ) {
        self.fitted = points;
        self.held_out
            .retain(|point| problem.signals[point.signal].file == 0);
        // Their times in the model are known only when the offsets of their clocks are.
        for point in &problem.points {
            let time = problem.model_time(values, point);
            let is_held_out = time > self.end && time <= self.last;
            if problem.signals[point.signal].file > 0 && is_held_out {
                self.held_out.push(*point);
            }
        }
    }
}

/// The fit of one law.
#[derive(Clone, Debug)]
pub(in crate::fit) struct Fitted {
    pub problem: Problem,
    pub solution: Solution,
    pub split: Split,
    /// The other minima that the data don't exclude.
    pub modes: Vec<Mode>,
}

impl Fitted {
    /// The name of the law.
    pub(in crate::fit) fn law(&self) -> &str {
        self.problem.scenario.word("friction.law")
    }

    /// Moves the angles of further files by whole turns, to those of the motion.
    pub(in crate::fit) fn align_turns(&mut self) -> Result<(), FitError> {
        let Self {
            problem,
            solution,
            split,
            ..
        } = self;
        // Residuals don't depend on whole turns, but data that are drawn or recorded do.
        let predicted = problem.predict(&solution.values, &split.fitted)?;
        for signal in 0..problem.signals.len() {
            let Some(turns) = problem.turns(signal, &predicted, &split.fitted) else {
                continue;
            };
            for value in &mut problem.signals[signal].values {
                *value += turns;
            }
            let points = problem.points.iter_mut();
            for point in points.chain(&mut split.fitted).chain(&mut split.held_out) {
                if point.signal == signal {
                    point.value += turns;
                }
            }
        }
        Ok(())
    }

    /// Goodness of the fit.
    pub(in crate::fit) fn quality(&self) -> Quality {
        quality(&self.problem, &self.split.fitted, &self.solution)
    }
}
