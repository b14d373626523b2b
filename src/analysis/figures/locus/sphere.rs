//! The unit sphere, as far down as the axis leans, seen from above and aside.

use super::trace::{Direction, Trace};
use crate::analysis::figures::looks::SURFACE;
use crate::analysis::plot::decimate;
use crate::analysis::plot::drawing::{Anchor, Drawing};
use crate::analysis::plot::frame;
use crate::analysis::plot::range::extremes;
use crate::analysis::plot::shape::{Bounds, Point, Shape, Stroke};
use crate::analysis::plot::style::{self, LINE, MARGIN, RESOLUTION};
use crate::analysis::plot::text::Text;
use crate::analysis::plot::ticks::Scale;
use crate::physics::math::{atan2, hypot, sin_cos};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{PI, TAU};

/// The direction from which the sphere is seen: above the horizon, and around the vertical, rad.
const ELEVATION: f64 = 0.65;
const AZIMUTH: f64 = 0.6;

/// The number of meridians.
const MERIDIANS: u32 = 12;

/// Points that are behind the outline of the sphere by less than this are so by rounding.
const SLACK: f64 = 1e-9;

/// The number of pieces of a circle.
const PIECES: u32 = 360;

/// The length of the vertical above the pole: as a part of the cap's radius, and at most.
const VERTICAL: (f64, f64) = (0.75, 0.36);

/// The cap of the sphere around the vertical on which the axes of some runs move.
pub(super) struct Sphere {
    /// Circles of equal θ (rad) and their labels; the last bounds the cap.
    circles: Vec<(f64, String)>,
    /// The labels are to be multiplied by ten to this power.
    exponent: i32,
}

/// The rotations that bring the eye to the x axis: about the vertical, and then down to the horizon.
fn to_eye() -> [Rotation3<f64>; 2] {
    [
        Rotation3::from_axis_angle(&Vector3::z_axis(), -AZIMUTH),
        Rotation3::from_axis_angle(&Vector3::y_axis(), ELEVATION),
    ]
}

/// A direction as the eye sees it: x to the right, y upwards, z towards the eye.
fn seen(axis: &Direction) -> Vector3<f64> {
    let [turn, lower] = to_eye();
    (lower * (turn * axis)).yzx()
}

fn direction(theta: f64, azimuth: f64) -> Direction {
    let (sin_t, cos_t) = sin_cos(theta);
    let (sin_a, cos_a) = sin_cos(azimuth);
    Vector3::new(sin_t * cos_a, sin_t * sin_a, cos_t)
}

/// Equal steps from 0 to `end`.
fn steps(end: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..=count).map(move |step| end * f64::from(step) / f64::from(count))
}

impl Sphere {
    pub(super) fn around(traces: &[&Trace]) -> Self {
        let axes = traces.iter().flat_map(|trace| &trace.axes);
        let thetas = axes.map(|axis| atan2(hypot(axis.x, axis.y), axis.z));
        let (_, greatest) = extremes(thetas);
        let scale = Scale::new(0.0, greatest.max(1e-6), 6);
        Self {
            exponent: scale.exponent,
            circles: scale
                .ticks_beyond()
                .into_iter()
                .filter(|tick| 0.0 < tick.value && tick.value < PI)
                .map(|tick| (tick.value, tick.label))
                .collect(),
        }
    }

    /// The θ of the edge of the cap, rad.
    fn edge(&self) -> f64 {
        self.circles.last().map_or(PI, |(theta, _)| *theta)
    }

    /// The circles of equal θ, the outermost last.
    fn parallels(&self) -> Vec<Vec<Direction>> {
        let circle = |(theta, _): &(f64, String)| {
            let azimuths = steps(TAU, PIECES);
            azimuths.map(|azimuth| direction(*theta, azimuth)).collect()
        };
        self.circles.iter().map(circle).collect()
    }

    fn meridians(&self) -> Vec<Vec<Direction>> {
        let meridian = |azimuth| {
            let thetas = steps(self.edge(), PIECES / 4);
            thetas.map(|theta| direction(theta, azimuth)).collect()
        };
        steps(TAU, MERIDIANS).skip(1).map(meridian).collect()
    }

    /// The parts of the outline of the sphere that belong to the cap.
    fn outline(&self) -> Vec<Vec<Direction>> {
        let [turn, lower] = to_eye();
        let least = sin_cos(self.edge()).1;
        let points: Vec<_> = steps(TAU, 2 * PIECES)
            .map(|angle| {
                let (up, right) = sin_cos(angle - PI / 2.0);
                turn.inverse() * (lower.inverse() * Vector3::new(0.0, right, up))
            })
            .collect();
        let is_on_cap = |axis: &&[Direction]| axis[0][2] >= least;
        let parts = points.chunk_by(|a, b| (a[2] >= least) == (b[2] >= least));
        parts.filter(is_on_cap).map(<[Direction]>::to_vec).collect()
    }

    /// The piece of the vertical above the pole.
    fn vertical(&self) -> Vec<Direction> {
        let (part, most) = VERTICAL;
        let length = most.min(part * sin_cos(self.edge().min(PI / 2.0)).0);
        vec![Vector3::z(), Vector3::z() * (1.0 + length)]
    }

    /// The ranges of what is seen, to the right and upwards.
    fn extent(&self) -> [(f64, f64); 2] {
        let vertical = self.vertical();
        let lines = [self.parallels(), self.meridians(), self.outline()];
        let lines = lines.iter().flatten().chain(std::iter::once(&vertical));
        let points: Vec<_> = lines.flatten().map(seen).collect();
        [0, 1].map(|axis| {
            let visible = points.iter().filter(|point| point[2] >= -SLACK);
            extremes(visible.map(|point| point[axis]))
        })
    }

    /// The height of the drawing at a width, mm.
    pub(super) fn height(&self, width: f64) -> f64 {
        let [across, up] = self.extent();
        (width - 2.0 * MARGIN) * (up.1 - up.0) / (across.1 - across.0) + LINE
    }

    /// Draws the cap and the paths of the axes into bounds.
    pub(super) fn draw(&self, drawing: &mut Drawing, traces: &[&Trace], bounds: Bounds) {
        let [across, up] = self.extent();
        let scale = (bounds.width() - 2.0 * MARGIN) / (across.1 - across.0);
        let scale = scale.min((bounds.height() - LINE) / (up.1 - up.0));
        let middle = f64::midpoint(bounds.left, bounds.right);
        let left = middle - scale * f64::midpoint(across.0, across.1);
        let height = scale * (up.1 - up.0) + LINE;
        let top = f64::midpoint(bounds.top, bounds.bottom) - height / 2.0;
        let view = View {
            scale,
            origin: (left, top + scale * up.1),
        };
        self.draw_surface(drawing, &view);
        for trace in traces {
            let shapes = view.line(&trace.axes, trace.stroke);
            drawing.group(&format!("{}: locus on the unit sphere", trace.name), shapes);
        }
        let dots = traces
            .iter()
            .flat_map(|trace| trace.dots(0, |axis| view.place(axis)));
        drawing.group("start and end", dots.collect());
        let place = (middle, top + height);
        drawing.label(self.caption(), place, Anchor::Middle);
    }

    fn draw_surface(&self, drawing: &mut Drawing, view: &View) {
        let mut shapes = Vec::new();
        let parallels = self.parallels();
        let edge = parallels.last();
        if let Some(edge) = edge.filter(|edge| edge.iter().all(|axis| seen(axis)[2] >= 0.0)) {
            shapes.push(Shape::Area {
                points: edge.iter().map(|axis| view.place(axis)).collect(),
                fill: SURFACE,
            });
        }
        let thin = style::line(style::GREY, style::HAIRLINE / 2.0);
        for line in parallels.iter().chain(&self.meridians()) {
            shapes.extend(view.visible(line, thin));
        }
        for line in self.outline() {
            let points = line.iter().map(|axis| view.place(axis)).collect();
            let stroke = thin;
            shapes.push(Shape::Line { points, stroke });
        }
        let vertical = self.vertical();
        let (x, y) = vertical.last().map_or(view.origin, |axis| view.place(axis));
        let arrow = vec![(x - 0.6, y + 1.6), (x, y), (x + 0.6, y + 1.6)];
        let line = vertical.iter().map(|axis| view.place(axis)).collect();
        let stroke = style::frame();
        shapes.extend([line, arrow].map(|points| Shape::Line { points, stroke }));
        drawing.group("unit sphere", shapes);
        drawing.label(
            Text::markup("*z*′"),
            (x + 1.4, y + 0.5 * LINE),
            Anchor::Start,
        );
    }

    /// The caption, with the θ of the circles.
    fn caption(&self) -> Text {
        let mut labels: Vec<_> = self
            .circles
            .iter()
            .map(|(_, label)| label.as_str())
            .collect();
        if labels.len() > 3 {
            labels.splice(2..labels.len() - 1, ["…"]);
        }
        let labels = labels.join(", ");
        let unit = frame::in_brackets(self.exponent, "rad");
        Text::markup(&match self.exponent {
            0 => format!("circles at *θ* = {labels} rad"),
            _ => format!("circles at *θ* = {labels} ({unit})"),
        })
    }
}

/// The projection of the sphere onto paper.
struct View {
    scale: f64,
    /// The place of the centre of the sphere.
    origin: Point,
}

impl View {
    fn place(&self, axis: &Direction) -> Point {
        let seen = seen(axis);
        (
            self.origin.0 + self.scale * seen.x,
            self.origin.1 - self.scale * seen.y,
        )
    }

    /// A line on the sphere, with its far side paler.
    fn line(&self, axes: &[Direction], stroke: Stroke) -> Vec<Shape> {
        let is_near = |a: &Direction, b: &Direction| (seen(a)[2] >= 0.0) == (seen(b)[2] >= 0.0);
        axes.chunk_by(is_near)
            .map(|part| {
                let is_far = part.first().is_some_and(|axis| seen(axis)[2] < 0.0);
                let opacity = if is_far { 0.3 } else { 1.0 };
                let places: Vec<_> = part.iter().map(|axis| self.place(axis)).collect();
                Shape::Line {
                    points: decimate::by_distance(&places, 1.0 / RESOLUTION),
                    stroke: Stroke { opacity, ..stroke },
                }
            })
            .collect()
    }

    /// The near side of a line on the sphere.
    fn visible(&self, axes: &[Direction], stroke: Stroke) -> Vec<Shape> {
        let mut shapes = self.line(axes, stroke);
        shapes.retain(|shape| matches!(shape, Shape::Line { stroke, .. } if stroke.opacity == 1.0));
        shapes
    }
}
