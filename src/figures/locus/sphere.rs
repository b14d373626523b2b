//! The unit sphere, drawn down to the largest inclination of the axis, seen obliquely from above.

use super::trace::{Direction, Trace};
use crate::figures::looks::SURFACE;
use crate::figures::plot::decimate;
use crate::figures::plot::drawing::{Anchor, Drawing};
use crate::figures::plot::frame;
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::{Bounds, Point, Shape, Stroke};
use crate::figures::plot::style::{self, LINE, MARGIN, RESOLUTION};
use crate::figures::plot::text::Text;
use crate::figures::plot::ticks::{Scale, Tick};
use crate::physics::math::{atan2, hypot, sin_cos};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{PI, TAU};

/// The viewing direction: elevation and azimuth, rad.
const ELEVATION: f64 = 0.65;
const AZIMUTH: f64 = 0.6;

/// The number of meridians.
const MERIDIANS: u32 = 12;

/// Tolerance for points on the outline of the sphere.
const SLACK: f64 = 1e-9;

/// The number of pieces of a circle.
const PIECES: u32 = 360;

/// The length of the vertical above the pole: relative to the cap's radius, and its maximum.
const VERTICAL: (f64, f64) = (0.75, 0.36);

/// The cap of the sphere around the vertical on which the axes of some runs move.
///
/// Its lines are in view coordinates: x to the right, y upwards, z towards the viewer.
pub(super) struct Sphere {
    /// Circles of equal θ, the outermost last.
    circles: Vec<Vec<Direction>>,
    /// The θ of the circles in rad, to be multiplied by ten to the power of `exponent`.
    labels: Vec<String>,
    exponent: i32,
    meridians: Vec<Vec<Direction>>,
    /// The parts of the outline of the sphere that belong to the cap.
    outline: Vec<Vec<Direction>>,
    /// The piece of the vertical above the pole.
    vertical: [Direction; 2],
}

/// A direction in view coordinates, rotated about the vertical and then down to the horizon.
fn seen(axis: &Direction) -> Direction {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -AZIMUTH);
    let lower = Rotation3::from_axis_angle(&Vector3::y_axis(), ELEVATION);
    (lower * (turn * axis)).yzx()
}

/// The direction with this polar angle and azimuth, in view coordinates.
fn direction(theta: f64, azimuth: f64) -> Direction {
    let (sin_t, cos_t) = sin_cos(theta);
    let (sin_a, cos_a) = sin_cos(azimuth);
    seen(&Vector3::new(sin_t * cos_a, sin_t * sin_a, cos_t))
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
        let exponent = scale.exponent;
        let mut ticks = scale.ticks_beyond();
        ticks.retain(|tick| 0.0 < tick.value && tick.value < PI);
        // The θ of the edge of the cap.
        let edge = ticks.last().map_or(PI, |tick| tick.value);
        let circle = |tick: &Tick| {
            let azimuths = steps(TAU, PIECES);
            azimuths
                .map(|azimuth| direction(tick.value, azimuth))
                .collect()
        };
        let meridian = |azimuth| {
            let thetas = steps(edge, PIECES / 4);
            thetas.map(|theta| direction(theta, azimuth)).collect()
        };
        let outline = steps(TAU, 2 * PIECES).map(|angle| {
            let (up, right) = sin_cos(angle - PI / 2.0);
            Vector3::new(right, up, 0.0)
        });
        let outline: Vec<_> = outline.collect();
        let is_on_cap = |seen: &Direction| seen.y * sin_cos(ELEVATION).1 >= sin_cos(edge).1;
        let parts = outline.split(|seen| !is_on_cap(seen));
        let parts = parts.filter(|part| !part.is_empty());
        let (part, most) = VERTICAL;
        let length = most.min(part * sin_cos(edge.min(PI / 2.0)).0);
        Self {
            circles: ticks.iter().map(circle).collect(),
            labels: ticks.into_iter().map(|tick| tick.label).collect(),
            exponent,
            meridians: steps(TAU, MERIDIANS).skip(1).map(meridian).collect(),
            outline: parts.map(<[Direction]>::to_vec).collect(),
            vertical: [1.0, 1.0 + length].map(|z| seen(&Vector3::new(0.0, 0.0, z))),
        }
    }

    /// The visible ranges, to the right and upwards.
    fn extent(&self) -> [(f64, f64); 2] {
        let lines = [&self.circles, &self.meridians, &self.outline];
        let points = lines.into_iter().flatten().flatten().chain(&self.vertical);
        let visible = points.filter(|point| point.z >= -SLACK);
        [0, 1].map(|axis| extremes(visible.clone().map(|point| point[axis])))
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
            let axes: Vec<_> = trace.axes.iter().map(seen).collect();
            let parts = view.parts(&axes).into_iter();
            let shapes = parts.map(|(is_far, points)| {
                let opacity = if is_far { 0.3 } else { 1.0 };
                let stroke = trace.stroke;
                let stroke = Stroke { opacity, ..stroke };
                Shape::Line { points, stroke }
            });
            let meaning = format!("{}: locus on the unit sphere", trace.name);
            drawing.group(&meaning, shapes.collect());
        }
        let place = |axis: &Direction| view.place(&seen(axis));
        let dots = traces.iter().flat_map(|trace| trace.dots(0, place));
        drawing.group("start and end", dots.collect());
        drawing.label(self.caption(), (middle, top + height), Anchor::Middle);
    }

    fn draw_surface(&self, drawing: &mut Drawing, view: &View) {
        let mut shapes = Vec::new();
        let edge = self.circles.last();
        if let Some(edge) = edge.filter(|edge| edge.iter().all(|seen| seen.z >= 0.0)) {
            shapes.push(Shape::Area {
                points: view.places(edge),
                fill: SURFACE,
            });
        }
        let stroke = style::line(style::GREY, style::HAIRLINE / 2.0);
        let lines = self.circles.iter().chain(&self.meridians);
        let near = lines
            .flat_map(|line| view.parts(line))
            .filter(|part| !part.0);
        let outline = self.outline.iter().map(|line| view.places(line));
        let lines = near.map(|(_, points)| points).chain(outline);
        shapes.extend(lines.map(|points| Shape::Line { points, stroke }));
        let (x, y) = view.place(&self.vertical[1]);
        let arrow = vec![(x - 0.6, y + 1.6), (x, y), (x + 0.6, y + 1.6)];
        let stroke = style::frame();
        let lines = [view.places(&self.vertical), arrow];
        shapes.extend(lines.map(|points| Shape::Line { points, stroke }));
        drawing.group("unit sphere", shapes);
        let place = (x + 1.4, y + 0.5 * LINE);
        drawing.label(Text::markup("*z*′"), place, Anchor::Start);
    }

    /// The caption, with the θ of the circles.
    fn caption(&self) -> Text {
        let mut labels: Vec<_> = self.labels.iter().map(String::as_str).collect();
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
    fn place(&self, seen: &Direction) -> Point {
        let (x, y) = self.origin;
        (x + self.scale * seen.x, y - self.scale * seen.y)
    }

    fn places(&self, line: &[Direction]) -> Vec<Point> {
        line.iter().map(|seen| self.place(seen)).collect()
    }

    /// Splits a line into parts on the near and the far side; the flag is true for the far side.
    fn parts(&self, line: &[Direction]) -> Vec<(bool, Vec<Point>)> {
        let parts = line.chunk_by(|a, b| (a.z >= 0.0) == (b.z >= 0.0));
        let thinned = |part| decimate::by_distance(&self.places(part), 1.0 / RESOLUTION);
        parts.map(|part| (part[0].z < 0.0, thinned(part))).collect()
    }
}
