//! The path of a run's symmetry axis.

use crate::figures::data::RunData;
use crate::figures::plot::legend;
use crate::figures::plot::range::extremes;
use crate::figures::plot::rows::END;
use crate::figures::plot::shape::{Point, Shape, Stroke};
use crate::figures::plot::style;
use crate::telemetry::fields::pose;
use nalgebra::Vector3;

/// A direction in the world: x and y horizontal, z upwards.
pub(super) type Direction = Vector3<f64>;

/// The path of a run's symmetry axis over time.
pub(super) struct Trace {
    pub(super) name: String,
    pub(super) axes: Vec<Direction>,
    /// Index of the beginning of the last part of the path, which is drawn magnified.
    pub(super) end: usize,
    pub(super) stroke: Stroke,
}

impl Trace {
    /// The path of a run with a stroke that is to be replaced.
    pub(super) fn new(run: &RunData) -> Self {
        let [x, y, z] = pose::AXIS.components().map(|field| run.series(field));
        let (first, last) = extremes(x.iter().map(|(time, _)| *time));
        let end = last - END * (last - first);
        let mut axes = Vec::new();
        for ((x, y), z) in x.iter().zip(&y).zip(&z) {
            axes.push(Vector3::new(x.1, y.1, z.1));
        }
        Self {
            name: run.name.clone(),
            axes,
            end: x.partition_point(|(time, _)| *time < end),
            stroke: style::frame(),
        }
    }

    /// The length of the path.
    pub(super) fn length(&self) -> f64 {
        self.axes
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .filter(|step| step.is_finite())
            .sum()
    }

    /// The dots at the ends of the path from some index on. The start has a dot only if the whole path is drawn.
    pub(super) fn dots(&self, from: usize, place: impl Fn(&Direction) -> Point) -> Vec<Shape> {
        let mut dots = Vec::new();
        if let Some(start) = self.axes.first()
            && from == 0
        {
            dots.push(legend::start_dot(place(start), self.stroke.colour));
        }
        if let Some(end) = self.axes.last() {
            dots.push(legend::end_dot(place(end), self.stroke.colour));
        }
        dots
    }
}
