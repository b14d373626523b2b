//! Curves over one key: one for each scenario.

use super::axis_values::AxisValues;
use super::chart::{self, dot, padded};
use super::runs::{Map, MapRun};
use crate::figures::error::FigureError;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame;
use crate::figures::plot::legend::{self, LegendEntry};
use crate::figures::plot::shape::{Bounds, Point, Stroke};
use crate::figures::plot::style::{self, COLOURS, DASHES, MEDIUM};
use crate::figures::plot::text::Text;
use crate::figures::style::Style;

/// The maximum height of the marks of runs without a value, mm.
const MARK_HEIGHT: f64 = 1.2;

/// The distance between the marks of two scenarios, mm.
const MARK_GAP: f64 = 0.5;

/// Half the width of these marks, mm.
const HALF_MARK: f64 = 0.6;

/// The maximum height of all marks, relative to the height of the frame.
const MAX_MARKS: f64 = 0.25;

/// The number of curves that differ in colour or dashes.
const MAX_CURVES: usize = COLOURS.len() * DASHES.len();

/// Draws a curve for each scenario, and marks above the frame where runs have no value.
pub(super) fn draw(map: &Map, width: f64) -> Result<Drawing, FigureError> {
    let across = AxisValues::new(&map.x, map.values(|run| run.x));
    let upward = AxisValues::new(&map.color, map.values(|run| run.color));
    let axes = [&across, &upward];
    let curves = curves(map)?;
    let mut drawing = Drawing::new(width);
    let below_legend = legend::draw_at_top(&mut drawing, &legend_of(map, &curves)) + 0.6;
    let strip_count = if map.outcomes().is_empty() {
        0
    } else {
        curves.len()
    };
    let strips = Strips::new(below_legend, strip_count, width);
    let ranges = axes.map(|axis| padded(axis.range()));
    let frame = chart::frame(width, (strips.bottom(), frame::ROOM_RIGHT), axes, ranges);
    for (index, curve) in curves.iter().enumerate() {
        let mut points: Vec<Point> = Vec::new();
        let mut marks = Vec::new();
        for run in &curve.runs {
            let point = (across.position(run.x), upward.position(run.color));
            points.push(point);
            if !run.color.is_finite() {
                let (x, _) = frame.place((point.0, ranges[1].0));
                marks.push(strips.mark(index, x).area(curve.stroke.colour));
            }
        }
        let mut shapes = frame.line(&points, curve.stroke);
        for point in points.iter().filter(|point| point.1.is_finite()) {
            shapes.push(dot(frame.place(*point), curve.stroke.colour));
        }
        drawing.group(curve.name, shapes);
        if !marks.is_empty() {
            drawing.group(&format!("{}: no value", curve.name), marks);
        }
    }
    frame.finish(&mut drawing, axes.map(|axis| &axis.quantity));
    Ok(drawing)
}

/// Strips above the frame, one for each curve, with marks where its runs have no value.
struct Strips {
    top: f64,
    count: usize,
    /// The distance between the upper edges of two strips, mm.
    pitch: f64,
}

impl Strips {
    /// The strips below `top` in a drawing of this width, which shrink if there are many.
    fn new(top: f64, count: usize, width: f64) -> Self {
        let max_pitch = MAX_MARKS * chart::height(width) / count.max(1) as f64;
        Self {
            top,
            count,
            pitch: max_pitch.min(MARK_HEIGHT + MARK_GAP),
        }
    }

    /// The lower edge of all strips, mm.
    fn bottom(&self) -> f64 {
        self.top + self.count as f64 * self.pitch
    }

    /// A mark in a strip, around x.
    fn mark(&self, strip: usize, x: f64) -> Bounds {
        let top = self.top + strip as f64 * self.pitch;
        let height = self.pitch * MARK_HEIGHT / (MARK_HEIGHT + MARK_GAP);
        Bounds::between((x - HALF_MARK, top), (x + HALF_MARK, top + height))
    }
}

/// The names of several curves, and the outcomes of runs without a value.
fn legend_of(map: &Map, curves: &[ScenarioCurve<'_>]) -> Vec<LegendEntry> {
    let mut legend = Vec::new();
    if curves.len() > 1 {
        for curve in curves {
            legend.push(LegendEntry::from_text(curve.stroke, Text::name(curve.name)));
        }
    }
    let outcomes: Vec<String> = map
        .outcomes()
        .into_iter()
        .map(|outcome| outcome.words(&map.color.name))
        .collect();
    if !outcomes.is_empty() {
        let note = format!("above the frame: {}", outcomes.join(", "));
        legend.push(LegendEntry::note(&note));
    }
    legend
}

/// The runs of a scenario, in the order of x.
struct ScenarioCurve<'a> {
    name: &'a str,
    stroke: Stroke,
    runs: Vec<&'a MapRun>,
}

/// The curves of all scenarios, in the order of their names.
fn curves(map: &Map) -> Result<Vec<ScenarioCurve<'_>>, FigureError> {
    let mut runs: Vec<&MapRun> = map.runs.iter().collect();
    runs.sort_by(|a, b| a.scenario.cmp(&b.scenario).then(a.x.total_cmp(&b.x)));
    let scenarios: Vec<&[&MapRun]> = runs.chunk_by(|a, b| a.scenario == b.scenario).collect();
    if scenarios.len() > MAX_CURVES {
        return Err(FigureError::TooManyCurves {
            scenarios: scenarios.len(),
            max: MAX_CURVES,
        });
    }
    let style = Style::new(scenarios.len());
    let mut curves = Vec::new();
    for (index, runs) in scenarios.into_iter().enumerate() {
        let name = &runs[0].scenario;
        if let Some(pair) = runs.windows(2).find(|pair| pair[0].x == pair[1].x) {
            return Err(FigureError::SamePoint {
                scenario: name.clone(),
                x: map.x.name.clone(),
                x_value: pair[0].x,
            });
        }
        let colour = COLOURS[index % COLOURS.len()];
        curves.push(ScenarioCurve {
            name,
            // The dashes change after each round of colours, so that no two curves look alike.
            stroke: Stroke {
                dash: DASHES[index / COLOURS.len()],
                ..style::line(colour, MEDIUM + style.extra_width(index))
            },
            runs: runs.to_vec(),
        });
    }
    Ok(curves)
}
