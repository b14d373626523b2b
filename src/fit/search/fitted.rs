//! The fit of one law, before it is reported.

use super::solve::Solution;
use crate::fit::estimate::{PointResiduals, quality, signals, verdict};
use crate::fit::problem::model::{Point, Problem};
use crate::fit::report::{Mode, Quality, Verdict};

/// Points to fit and points to predict.
#[derive(Clone, Debug)]
pub(in crate::fit) struct Split {
    pub fitted: Vec<Point>,
    pub held_out: Vec<Point>,
    /// End of the fitted part, s.
    pub end: f64,
    /// End of the data on the model's clock, s.
    pub last: f64,
}

impl Split {
    /// The points on the model's clock. The last part of their time is held out.
    pub(in crate::fit) fn on_clock(problem: &Problem, holdout: f64) -> Self {
        let first: Vec<Point> = problem
            .points
            .iter()
            .copied()
            .filter(|point| problem.is_on_clock(point))
            .collect();
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

    /// Replaces the points to fit. Points of files with clocks of their own are held out in the time in which the others are.
    pub(in crate::fit) fn fit_points(
        &mut self,
        problem: &Problem,
        values: &[f64],
        points: Vec<Point>,
    ) {
        self.fitted = points;
        self.held_out.retain(|point| problem.is_on_clock(point));
        // Their times in the model are known only when the offsets of their clocks are.
        for point in &problem.points {
            let time = problem.model_time(values, point);
            let is_held_out = time > self.end && time <= self.last;
            if !problem.is_on_clock(point) && is_held_out {
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

    /// Chooses the turns and signs of the values that were held out.
    pub(in crate::fit) fn align_held_out(&mut self) {
        let Self {
            problem,
            solution,
            split,
            ..
        } = self;
        if let Ok(predicted) = problem.predict(&solution.values, &split.held_out) {
            problem.choose_turns(&predicted, &mut split.held_out);
        }
    }

    /// The verdict on the law.
    pub(in crate::fit) fn verdict(&self) -> Verdict {
        let fitted = PointResiduals {
            points: &self.split.fitted,
            residuals: &self.solution.residuals,
        };
        verdict(&self.quality(), &signals(&self.problem, fitted, None))
    }

    /// Goodness of the fit.
    pub(in crate::fit) fn quality(&self) -> Quality {
        quality(&self.problem, &self.split.fitted, &self.solution)
    }
}
