//! The unit sphere as far down as the axis leans, seen from aside.

use super::trace::{Direction, Trace};
use crate::analysis::figures::looks::SURFACE;
use crate::analysis::plot::decimate;
use crate::analysis::plot::drawing::{Anchor, Drawing};
use crate::analysis::plot::frame::extremes;
use crate::analysis::plot::shape::{Bounds, Point, Shape, Stroke};
use crate::analysis::plot::style::{self, LINE, MARGIN, RESOLUTION};
use crate::analysis::plot::text::Text;
use crate::analysis::plot::ticks::Scale;
use crate::physics::math::{atan2, hypot, sin_cos};
use std::f64::consts::{PI, TAU};

/// Where the sphere is looked at from: how far above the horizon, and around the vertical, rad.
const ELEVATION: f64 = 0.65;
const AZIMUTH: f64 = 0.6;

/// Meridians are 30° apart.
const MERIDIANS: u32 = 12;

/// What lies this little behind the outline of the sphere is there by rounding.
const SLACK: f64 = 1e-9;

/// Pieces of a circle.
const PIECES: u32 = 360;

/// How far the vertical is drawn above the pole, as a part of the cap's radius, and at most.
const VERTICAL: (f64, f64) = (0.75, 0.36);

/// The cap of the sphere around the vertical on which the axes of some runs move.
pub(super) struct Sphere {
    /// Circles of equal θ, rad, and what is written of them; the last bounds the cap.
    circles: Vec<(f64, String)>,
}

/// Where a direction is seen: to the right, upwards, and towards the eye.
fn seen(axis: &Direction) -> [f64; 3] {
    let (sin_e, cos_e) = sin_cos(ELEVATION);
    let (sin_a, cos_a) = sin_cos(AZIMUTH);
    let [x, y, z] = *axis;
    let forward = x * cos_a + y * sin_a;
    [
        y * cos_a - x * sin_a,
        z * cos_e - forward * sin_e,
        z * sin_e + forward * cos_e,
    ]
}

fn direction(theta: f64, azimuth: f64) -> Direction {
    let (sin_t, cos_t) = sin_cos(theta);
    let (sin_a, cos_a) = sin_cos(azimuth);
    [sin_t * cos_a, sin_t * sin_a, cos_t]
}

/// Equal steps from 0 to `end`.
fn steps(end: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..=count).map(move |step| end * f64::from(step) / f64::from(count))
}

impl Sphere {
    pub(super) fn around(traces: &[Trace]) -> Self {
        let axes = traces.iter().flat_map(|trace| &trace.axes);
        let thetas = axes.map(|[x, y, z]| atan2(hypot(*x, *y), *z));
        let (_, greatest) = extremes(thetas);
        let scale = Scale::new(0.0, greatest.max(1e-6), 6);
        Self {
            circles: scale
                .ticks_beyond()
                .into_iter()
                .filter(|tick| 0.0 < tick.value && tick.value < PI)
                .map(|tick| (tick.value, tick.label))
                .collect(),
        }
    }

    /// How far down it reaches, rad.
    fn edge(&self) -> f64 {
        self.circles.last().map_or(PI, |(theta, _)| *theta)
    }

    /// The circles, the outermost last.
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

    /// The outline of the sphere where it is part of the cap.
    fn outline(&self) -> Vec<Vec<Direction>> {
        let (sin_e, cos_e) = sin_cos(ELEVATION);
        let (sin_a, cos_a) = sin_cos(AZIMUTH);
        let least = sin_cos(self.edge()).1;
        let points: Vec<_> = steps(TAU, 2 * PIECES)
            .map(|turn| {
                let (up, right) = sin_cos(turn - PI / 2.0);
                let forward = -up * sin_e;
                [
                    forward * cos_a - right * sin_a,
                    forward * sin_a + right * cos_a,
                    up * cos_e,
                ]
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
        vec![[0.0, 0.0, 1.0], [0.0, 0.0, 1.0 + length]]
    }

    /// Where all of it is seen: least and greatest to the right, and upwards.
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

    /// The height that it takes in a width, mm.
    pub(super) fn height(&self, width: f64) -> f64 {
        let [across, up] = self.extent();
        (width - 2.0 * MARGIN) * (up.1 - up.0) / (across.1 - across.0) + LINE
    }

    /// Draws it with the ways of the axes into bounds.
    pub(super) fn draw(&self, drawing: &mut Drawing, traces: &[Trace], bounds: Bounds) {
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
            .flat_map(|trace| trace.dots(|axis| view.place(axis)));
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

    /// What the circles are.
    fn caption(&self) -> Text {
        let mut labels: Vec<_> = self
            .circles
            .iter()
            .map(|(_, label)| label.as_str())
            .collect();
        if labels.len() > 3 {
            labels.splice(2..labels.len() - 1, ["…"]);
        }
        Text::markup(&format!("circles at *θ* = {} rad", labels.join(", ")))
    }
}

/// How the sphere is put on paper.
struct View {
    scale: f64,
    /// Where the centre of the sphere is.
    origin: Point,
}

impl View {
    fn place(&self, axis: &Direction) -> Point {
        let [right, up, _] = seen(axis);
        (
            self.origin.0 + self.scale * right,
            self.origin.1 - self.scale * up,
        )
    }

    /// A line on the sphere, its far side paler.
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

    /// The near side of a line.
    fn visible(&self, axes: &[Direction], stroke: Stroke) -> Vec<Shape> {
        let mut shapes = self.line(axes, stroke);
        shapes.retain(|shape| matches!(shape, Shape::Line { stroke, .. } if stroke.opacity == 1.0));
        shapes
    }
}
