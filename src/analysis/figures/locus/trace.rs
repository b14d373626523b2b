//! The path of a run's symmetry axis.

use crate::analysis::figures::run::Run;
use crate::analysis::plot::legend;
use crate::analysis::plot::range::extremes;
use crate::analysis::plot::rows::END;
use crate::analysis::plot::shape::{Point, Shape, Stroke};
use crate::analysis::plot::style;
use crate::telemetry::fields::pose;
use nalgebra::Vector3;

/// A direction in the world: x and y horizontal, z upwards.
pub(super) type Direction = Vector3<f64>;

/// The path of a run's symmetry axis over time.
pub(super) struct Trace {
    pub(super) name: String,
    times: Vec<f64>,
    pub(super) axes: Vec<Direction>,
    pub(super) stroke: Stroke,
    /// The place among all paths in the order of drawing.
    pub(super) order: usize,
}

impl Trace {
    pub(super) fn of(run: &Run) -> Self {
        let [x, y, z] = pose::AXIS
            .components()
            .map(|component| run.series(component));
        let both = x.iter().zip(&y).zip(&z);
        Self {
            name: run.name.clone(),
            times: x.iter().map(|(time, _)| *time).collect(),
            axes: both
                .map(|((x, y), z)| Vector3::new(x.1, y.1, z.1))
                .collect(),
            stroke: style::frame(),
            order: 0,
        }
    }

    /// The beginning of the last part of the path, which is drawn magnified.
    pub(super) fn end(&self) -> usize {
        let (first, last) = extremes(self.times.iter().copied());
        let from = last - END * (last - first);
        self.times.partition_point(|time| *time < from)
    }

    /// The length of the path.
    pub(super) fn length(&self) -> f64 {
        let steps = self.axes.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        steps.filter(|step| step.is_finite()).sum()
    }

    /// The path as seen from above, from some point on.
    pub(super) fn projected(&self, from: usize) -> Vec<Point> {
        let axes = self.axes[from..].iter();
        axes.map(|axis| (axis[0], axis[1])).collect()
    }

    /// The dots at the start and the end of the path from some point on.
    pub(super) fn dots(&self, from: usize, place: impl Fn(&Direction) -> Point) -> Vec<Shape> {
        let dot = |axis, is_end| legend::dot(place(axis), is_end, self.stroke.colour);
        let start = self.axes.first().filter(|_| from == 0);
        let start = start.map(|axis| dot(axis, false));
        let end = self.axes.last().map(|axis| dot(axis, true));
        start.into_iter().chain(end).collect()
    }
}
