//! The unit sphere, drawn down to the largest inclination of the axis, seen obliquely from above.

use super::trace::{Direction, Trace};
use crate::figures::plot::decimate;
use crate::figures::plot::drawing::{Anchor, Drawing};
use crate::figures::plot::frame;
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::{Bounds, Point, Shape, Stroke};
use crate::figures::plot::style::{self, LINE_HEIGHT, MARGIN, RESOLUTION};
use crate::figures::plot::text::Text;
use crate::figures::plot::ticks::Scale;
use crate::figures::style::SURFACE;
use crate::physics::math::{atan2, hypot, sin_cos};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{PI, TAU};

/// The viewing direction: elevation and azimuth, rad.
const ELEVATION: f64 = 0.65;
const AZIMUTH: f64 = 0.6;

/// The number of meridians.
const MERIDIANS: u32 = 12;

/// The maximum number of circles of equal θ, but for one more at the edge.
const MAX_CIRCLES: usize = 6;

/// Tolerance for points on the outline of the sphere.
const SLACK: f64 = 1e-9;

/// The number of pieces of a circle.
const PIECES: u32 = 360;

/// The length of the vertical above the pole, relative to the cap's radius.
const VERTICAL: f64 = 0.75;

/// The maximum length of the vertical above the pole, relative to the sphere's radius.
const MAX_VERTICAL: f64 = 0.36;

/// The opacity of paths on the far side of the sphere.
const FAR_OPACITY: f64 = 0.3;

/// The cap of the sphere around the vertical on which the axes of some runs move.
///
/// The lines are in view coordinates: x to the right, y upwards, z towards the viewer.
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
fn to_view(axis: &Direction) -> Direction {
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -AZIMUTH);
    let lower = Rotation3::from_axis_angle(&Vector3::y_axis(), ELEVATION);
    // Both rotations leave x pointing at the viewer and z upwards.
    (lower * (turn * axis)).yzx()
}

/// The direction with this polar angle and azimuth in rad, in view coordinates.
fn direction(theta: f64, azimuth: f64) -> Direction {
    let (sin_t, cos_t) = sin_cos(theta);
    let (sin_a, cos_a) = sin_cos(azimuth);
    to_view(&Vector3::new(sin_t * cos_a, sin_t * sin_a, cos_t))
}

/// Equal steps from 0 to `end`.
fn steps(end: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..=count).map(move |step| end * f64::from(step) / f64::from(count))
}

/// The circle of equal θ, in view coordinates.
fn circle(theta: f64) -> Vec<Direction> {
    steps(TAU, PIECES)
        .map(|azimuth| direction(theta, azimuth))
        .collect()
}

/// The meridian from the pole to the edge of a cap, in view coordinates.
fn meridian(azimuth: f64, edge: f64) -> Vec<Direction> {
    steps(edge, PIECES / 4)
        .map(|theta| direction(theta, azimuth))
        .collect()
}

/// The parts of the outline of the sphere that belong to the cap with this edge, in view coordinates.
fn outline(edge: f64) -> Vec<Vec<Direction>> {
    let points: Vec<Direction> = steps(TAU, 2 * PIECES)
        .map(|angle| {
            let (up, right) = sin_cos(angle - PI / 2.0);
            Vector3::new(right, up, 0.0)
        })
        .collect();
    // The height in the world of a point on the outline is that in the view, foreshortened by the elevation.
    let (cos_elevation, cos_edge) = (sin_cos(ELEVATION).1, sin_cos(edge).1);
    points
        .split(|point| point.y * cos_elevation < cos_edge)
        .filter(|part| !part.is_empty())
        .map(<[Direction]>::to_vec)
        .collect()
}

impl Sphere {
    /// The cap that contains the axes of all paths.
    pub(super) fn around(traces: &[&Trace]) -> Self {
        let axes = traces.iter().flat_map(|trace| &trace.axes);
        let (_, max_theta) = extremes(axes.map(|axis| atan2(hypot(axis.x, axis.y), axis.z)));
        // The cap of an axis that stays vertical has an extent too.
        let scale = Scale::new(0.0, max_theta.max(1e-6), MAX_CIRCLES);
        let exponent = scale.exponent;
        let mut ticks = scale.into_ticks_beyond();
        ticks.retain(|tick| 0.0 < tick.value && tick.value < PI);
        let edge = ticks.last().map_or(PI, |tick| tick.value);
        // Below the horizon, the cap is as wide as the sphere.
        let vertical = MAX_VERTICAL.min(VERTICAL * sin_cos(edge.min(PI / 2.0)).0);
        Self {
            circles: ticks.iter().map(|tick| circle(tick.value)).collect(),
            labels: ticks.into_iter().map(|tick| tick.label).collect(),
            exponent,
            meridians: steps(TAU, MERIDIANS)
                // The first and the last step are the same meridian.
                .skip(1)
                .map(|azimuth| meridian(azimuth, edge))
                .collect(),
            outline: outline(edge),
            vertical: [1.0, 1.0 + vertical].map(|z| to_view(&Vector3::new(0.0, 0.0, z))),
        }
    }

    /// The visible ranges, to the right and upwards.
    fn extent(&self) -> [(f64, f64); 2] {
        let lines = [&self.circles, &self.meridians, &self.outline];
        let visible: Vec<&Direction> = lines
            .into_iter()
            .flatten()
            .flatten()
            .chain(&self.vertical)
            .filter(|point| point.z >= -SLACK)
            .collect();
        [0, 1].map(|axis| extremes(visible.iter().map(|point| point[axis])))
    }

    /// The height of the drawing at a width, mm.
    pub(super) fn height(&self, width: f64) -> f64 {
        let [across, up] = self.extent();
        (width - 2.0 * MARGIN) * (up.1 - up.0) / (across.1 - across.0) + LINE_HEIGHT
    }

    /// Draws the cap and the paths of the axes into bounds.
    pub(super) fn draw(&self, drawing: &mut Drawing, traces: &[&Trace], bounds: Bounds) {
        let [across, up] = self.extent();
        let scale = ((bounds.width() - 2.0 * MARGIN) / (across.1 - across.0))
            .min((bounds.height() - LINE_HEIGHT) / (up.1 - up.0));
        let middle = f64::midpoint(bounds.left, bounds.right);
        let height = scale * (up.1 - up.0) + LINE_HEIGHT;
        let top = f64::midpoint(bounds.top, bounds.bottom) - height / 2.0;
        let view = View {
            scale,
            origin: (
                middle - scale * f64::midpoint(across.0, across.1),
                top + scale * up.1,
            ),
        };
        self.draw_surface(drawing, &view);
        for trace in traces {
            draw_trace(drawing, trace, &view);
        }
        let dots = traces
            .iter()
            .flat_map(|trace| trace.dots(0, |axis| view.place(&to_view(axis))))
            .collect();
        drawing.group("start and end", dots);
        drawing.label(self.caption(), (middle, top + height), Anchor::Middle);
    }

    fn draw_surface(&self, drawing: &mut Drawing, view: &View) {
        let mut shapes = Vec::new();
        // An edge that is partly hidden doesn't bound the visible surface.
        if let Some(edge) = self.circles.last()
            && edge.iter().all(|point| point.z >= 0.0)
        {
            shapes.push(Shape::Area {
                points: view.places(edge),
                fill: SURFACE,
            });
        }
        let mut lines = Vec::new();
        for line in self.circles.iter().chain(&self.meridians) {
            for (side, points) in view.parts(line) {
                if side == Hemisphere::Near {
                    lines.push(points);
                }
            }
        }
        lines.extend(self.outline.iter().map(|line| view.places(line)));
        let stroke = style::line(style::GREY, style::HAIRLINE / 2.0);
        shapes.extend(Shape::lines(lines, stroke));
        let (x, y) = view.place(&self.vertical[1]);
        let arrow = vec![(x - 0.6, y + 1.6), (x, y), (x + 0.6, y + 1.6)];
        let vertical = [view.places(&self.vertical), arrow];
        shapes.extend(Shape::lines(vertical, style::frame()));
        drawing.group("unit sphere", shapes);
        let place = (x + 1.4, y + 0.5 * LINE_HEIGHT);
        drawing.label(Text::markup("*z*′"), place, Anchor::Start);
    }

    /// The caption, with the θ of the circles.
    fn caption(&self) -> Text {
        let labels = match &self.labels[..] {
            [first, second, .., last] if self.labels.len() > 3 => {
                format!("{first}, {second}, …, {last}")
            }
            labels => labels.join(", "),
        };
        let unit = frame::unit_with_power(self.exponent, "rad");
        Text::markup(&match self.exponent {
            0 => format!("circles at *θ* = {labels} rad"),
            _ => format!("circles at *θ* = {labels} ({unit})"),
        })
    }
}

fn draw_trace(drawing: &mut Drawing, trace: &Trace, view: &View) {
    let axes: Vec<Direction> = trace.axes.iter().map(to_view).collect();
    let mut shapes = Vec::new();
    for (side, points) in view.parts(&axes) {
        let opacity = match side {
            Hemisphere::Near => 1.0,
            Hemisphere::Far => FAR_OPACITY,
        };
        shapes.push(Shape::Line {
            points,
            stroke: Stroke {
                opacity,
                ..trace.stroke
            },
        });
    }
    let meaning = format!("{}: locus on the unit sphere", trace.name);
    drawing.group(&meaning, shapes);
}

/// A side of the sphere, as seen by the viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hemisphere {
    Near,
    Far,
}

impl Hemisphere {
    /// The side of a point in view coordinates.
    fn new(point: &Direction) -> Self {
        if point.z >= 0.0 {
            Self::Near
        } else {
            Self::Far
        }
    }
}

/// The projection of the sphere onto paper.
struct View {
    /// The radius of the sphere, mm.
    scale: f64,
    /// The place of the centre of the sphere.
    origin: Point,
}

impl View {
    /// The place of a point in view coordinates.
    fn place(&self, point: &Direction) -> Point {
        let (x, y) = self.origin;
        (x + self.scale * point.x, y - self.scale * point.y)
    }

    fn places(&self, line: &[Direction]) -> Vec<Point> {
        line.iter().map(|point| self.place(point)).collect()
    }

    /// Splits a line into parts on the near and the far side.
    fn parts(&self, line: &[Direction]) -> Vec<(Hemisphere, Vec<Point>)> {
        line.chunk_by(|a, b| Hemisphere::new(a) == Hemisphere::new(b))
            .map(|part| {
                let places = self.places(part);
                let thinned = decimate::by_distance(&places, 1.0 / RESOLUTION);
                (Hemisphere::new(&part[0]), thinned)
            })
            .collect()
    }
}
