//! What is measured only up to an equivalence: angles up to whole turns, quaternions up to their sign. Turns and signs are a
//! property of each sample, and are chosen by a motion.

use super::model::{Point, Problem};
use crate::telemetry::fields::{NumberField, pose};
use std::f64::consts::TAU;

/// The differences before a sample from which its turn is counted: a minority of them may be outliers.
const NEIGHBOURS: usize = 5;

impl Problem {
    /// Whether any signal is measured only up to an equivalence.
    pub(in crate::fit) fn has_equivalences(&self) -> bool {
        self.signals
            .iter()
            .any(|signal| signal.is_turning() || is_orientation(signal.field))
    }

    /// Chooses the turns and signs that bring the values next to a motion, which has the values `predicted` at these points.
    /// Returns whether any has changed.
    pub(in crate::fit) fn choose_turns(&self, predicted: &[f64], points: &mut [Point]) -> bool {
        let mut has_changed = false;
        for signal in 0..self.signals.len() {
            if self.signals[signal].is_turning() {
                has_changed |= choose_turns(signal, predicted, points);
            }
        }
        self.choose_signs(predicted, points) || has_changed
    }

    /// Chooses the signs of quaternions, the components of which have one in common.
    fn choose_signs(&self, predicted: &[f64], points: &mut [Point]) -> bool {
        let file = |point: &Point| self.signals[point.signal].file;
        let mut components = Vec::new();
        for (at, point) in points.iter().enumerate() {
            if is_orientation(self.signals[point.signal].field) {
                components.push(at);
            }
        }
        components.sort_by(|a, b| {
            let [a, b] = [a, b].map(|at| &points[*at]);
            file(a).cmp(&file(b)).then(a.time.total_cmp(&b.time))
        });
        let mut has_changed = false;
        let is_one = |a: &usize, b: &usize| {
            let [a, b] = [a, b].map(|at| &points[*at]);
            file(a) == file(b) && a.time == b.time
        };
        let quaternions: Vec<Vec<usize>> = components.chunk_by(is_one).map(<[_]>::to_vec).collect();
        for quaternion in quaternions {
            let product: f64 = quaternion
                .iter()
                .map(|at| points[*at].value * predicted[*at])
                .sum();
            if product < 0.0 {
                for at in quaternion {
                    points[at].value *= -1.0;
                }
                has_changed = true;
            }
        }
        has_changed
    }
}

/// Chooses the turns of an angle so that its difference from the motion goes on as in the samples before. So a motion that is
/// a little too fast does not lose turns, and an outlier does not change those after it.
fn choose_turns(signal: usize, predicted: &[f64], points: &mut [Point]) -> bool {
    let mut has_changed = false;
    let mut before: Vec<f64> = Vec::new();
    for (point, predicted) in points.iter_mut().zip(predicted) {
        if point.signal != signal {
            continue;
        }
        let difference = point.value - predicted;
        let turns = ((difference - median(&before)) / TAU).round();
        if turns != 0.0 {
            point.value -= turns * TAU;
            has_changed = true;
        }
        if before.len() == NEIGHBOURS {
            before.remove(0);
        }
        before.push(point.value - predicted);
    }
    has_changed
}

/// The median; 0 for no values.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

/// Whether a field is a component of a quaternion.
fn is_orientation(field: NumberField) -> bool {
    pose::ORIENTATION.components().contains(&field)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_do_not_change_the_turns_after_them() {
        // The motion is 2 % too fast, and ahead by more than a turn at the end.
        let truth: Vec<f64> = (0..600).map(|at| 0.55 * f64::from(at)).collect();
        let predicted: Vec<f64> = truth.iter().map(|angle| 1.03 * angle).collect();
        let mut points = Vec::new();
        for (at, angle) in truth.iter().enumerate() {
            let outlier = if at % 50 < 2 { 2.5 } else { 0.0 };
            points.push(Point {
                signal: 0,
                time: at as f64,
                value: (angle + outlier).rem_euclid(TAU),
                sigma: 1.0,
            });
        }
        choose_turns(0, &predicted, &mut points);
        for (at, (point, angle)) in points.iter().zip(&truth).enumerate() {
            if at % 50 >= 2 {
                assert!((point.value - angle).abs() < 1e-9, "{at}: {}", point.value);
            }
        }
    }
}
