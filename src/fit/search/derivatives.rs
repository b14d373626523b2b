//! Derivatives of the residuals, by differences of motions.

use crate::fit::problem::model::{Effort, Point, Problem};
use rayon::prelude::*;

impl Problem {
    /// The derivatives of the residuals: a column for each parameter, zero for those that are `fixed` and where no
    /// derivative can be computed. `here` is the motion of `values`.
    pub(in crate::fit) fn jacobian(
        &self,
        effort: Effort,
        values: &[f64],
        here: &[f64],
        points: &[Point],
        fixed: &[bool],
    ) -> Vec<Vec<f64>> {
        // In the order of the parameters, whatever the threads do.
        (0..self.parameters.len())
            .into_par_iter()
            .map(|j| {
                if fixed[j] {
                    return vec![0.0; points.len()];
                }
                self.derivative(effort, j, values, here, points)
                    .unwrap_or_else(|| vec![0.0; points.len()])
            })
            .collect()
    }

    /// The derivatives with respect to a parameter. `None` if it can't be computed on any side. Differences are those of the
    /// predictions: measured values, which may be huge, would only add rounding.
    pub(in crate::fit) fn derivative(
        &self,
        effort: Effort,
        j: usize,
        values: &[f64],
        here: &[f64],
        points: &[Point],
    ) -> Option<Vec<f64>> {
        let step = effort.step() * self.parameters[j].change(values[j]);
        let moved = Moved {
            problem: self,
            effort,
            j,
            values,
            points,
        };
        let mut column = match effort {
            // Half the motions of central differences, and right to 1e-3, which is enough for the direction of a step.
            Effort::Draft => match moved.by(step) {
                Some(up) => one_sided(step, here, &up, None),
                None => one_sided(-step, here, &moved.by(-step)?, None),
            },
            // One-sided at a bound and where the model ends on one side.
            Effort::Final => match (moved.by(step), moved.by(-step)) {
                (Some(up), Some(down)) => central(step, &up, &down),
                (Some(up), None) => one_sided(step, here, &up, moved.by(2.0 * step).as_deref()),
                (None, Some(down)) => {
                    one_sided(-step, here, &down, moved.by(-2.0 * step).as_deref())
                }
                (None, None) => return None,
            },
        };
        for (derivative, point) in column.iter_mut().zip(points) {
            *derivative /= point.sigma;
        }
        Some(column)
    }
}

/// Motions with one parameter changed.
struct Moved<'a> {
    problem: &'a Problem,
    effort: Effort,
    /// Index of the parameter.
    j: usize,
    values: &'a [f64],
    points: &'a [Point],
}

impl Moved<'_> {
    /// The values of the model with this change of the parameter; `None` beyond its bounds or without a complete motion.
    fn by(&self, change: f64) -> Option<Vec<f64>> {
        let mut moved = self.values.to_vec();
        moved[self.j] += change;
        let [low, high] = self.problem.parameters[self.j].bounds;
        if !(low..=high).contains(&moved[self.j]) {
            return None;
        }
        self.problem
            .predict_with(self.effort, &moved, self.points)
            .ok()
    }
}

/// Differences to both sides.
fn central(step: f64, up: &[f64], down: &[f64]) -> Vec<f64> {
    let mut column = Vec::with_capacity(up.len());
    for (up, down) in up.iter().zip(down) {
        column.push((up - down) / (2.0 * step));
    }
    column
}

/// Differences to one side: of second order if there is a second value, else of first order.
fn one_sided(step: f64, here: &[f64], one: &[f64], two: Option<&[f64]>) -> Vec<f64> {
    let mut column = Vec::with_capacity(here.len());
    for (at, here) in here.iter().enumerate() {
        column.push(match two {
            Some(two) => (4.0 * one[at] - 3.0 * here - two[at]) / (2.0 * step),
            None => (one[at] - here) / step,
        });
    }
    column
}
