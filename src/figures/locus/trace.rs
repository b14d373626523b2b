//! The path of a run's symmetry axis.

use crate::figures::plot::legend;
use crate::figures::plot::range::extremes;
use crate::figures::plot::rows::END;
use crate::figures::plot::shape::{Point, Shape, Stroke};
use crate::figures::plot::style;
use crate::figures::run::Run;
use crate::telemetry::fields::pose;
use nalgebra::Vector3;

/// A direction in the world: x and y horizontal, z upwards.
pub(super) type Direction = Vector3<f64>;

/// The path of a run's symmetry axis over time.
pub(super) struct Trace {
    pub(super) name: String,
    pub(super) axes: Vec<Direction>,
    /// The beginning of the last part of the path, which is drawn magnified.
    pub(super) end: usize,
    pub(super) stroke: Stroke,
}

impl Trace {
    pub(super) fn of(run: &Run) -> Self {
        let [x, y, z] = pose::AXIS.components().map(|field| run.series(field));
        let (first, last) = extremes(x.iter().map(|(time, _)| *time));
        let from = last - END * (last - first);
        let axes = x.iter().zip(&y).zip(&z);
        Self {
            name: run.name.clone(),
            axes: axes
                .map(|((x, y), z)| Vector3::new(x.1, y.1, z.1))
                .collect(),
            end: x.partition_point(|(time, _)| *time < from),
            stroke: style::frame(),
        }
    }

    /// The length of the path.
    pub(super) fn length(&self) -> f64 {
        let steps = self.axes.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        steps.filter(|step| step.is_finite()).sum()
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
