//! The path of a run's symmetry axis.

use crate::analysis::figures::run::Run;
use crate::analysis::plot::frame::extremes;
use crate::analysis::plot::legend;
use crate::analysis::plot::rows::END;
use crate::analysis::plot::shape::{Point, Shape, Stroke};
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
    /// Whether the path begins where the run began.
    has_start: bool,
}

impl Trace {
    pub(super) fn of(run: &Run, stroke: Stroke) -> Self {
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
            stroke,
            has_start: true,
        }
    }

    /// The last part of the path, which is drawn magnified.
    pub(super) fn end(&self) -> Self {
        let (first, last) = extremes(self.times.iter().copied());
        let from = last - END * (last - first);
        let skipped = self.times.partition_point(|time| *time < from);
        Self {
            name: self.name.clone(),
            times: self.times[skipped..].to_vec(),
            axes: self.axes[skipped..].to_vec(),
            stroke: self.stroke,
            has_start: false,
        }
    }

    pub(super) fn projected(&self) -> Vec<Point> {
        self.axes.iter().map(|axis| (axis[0], axis[1])).collect()
    }

    /// The dots at the start and the end.
    pub(super) fn dots(&self, place: impl Fn(&Direction) -> Point) -> Vec<Shape> {
        let dot = |axis, is_end| legend::dot(place(axis), is_end, self.stroke.colour);
        let start = self.axes.first().filter(|_| self.has_start);
        let start = start.map(|axis| dot(axis, false));
        let end = self.axes.last().map(|axis| dot(axis, true));
        start.into_iter().chain(end).collect()
    }
}
