//! Curves over one key: one for each scenario.

use super::along::Along;
use super::chart::{self, aired, dot};
use super::runs::{Map, MapRun};
use crate::figures::looks::Looks;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame;
use crate::figures::plot::legend::{self, Entry};
use crate::figures::plot::range::{NONE, union};
use crate::figures::plot::shape::{Bounds, Point, Stroke};
use crate::figures::plot::style::{self, COLOURS, DASHES, MEDIUM};
use crate::figures::plot::text::Text;

/// The height of the marks of runs without a value, and the distance between those of two scenarios, mm.
const STRIP: f64 = 1.2;
const STRIP_GAP: f64 = 0.5;

/// Half the width of these marks, mm.
const HALF_MARK: f64 = 0.6;

/// The maximum fraction of the frame's height used by these marks.
const STRIPS: f64 = 0.25;

/// Draws a curve for each scenario, and marks above the frame where runs have no value.
pub(super) fn draw(map: &Map, width: f64) -> Result<Drawing, String> {
    let across = Along::new(&map.x, map.values(|run| run.x));
    let upward = Along::new(&map.color, map.values(|run| run.color));
    let axes = [&across, &upward];
    let curves = curves(map)?;
    let mut drawing = Drawing::new(width);
    let mut key = Vec::new();
    if curves.len() > 1 {
        let entry = |curve: &Curve<'_>| Entry::of(curve.stroke, Text::name(curve.name));
        key.extend(curves.iter().map(entry));
    }
    let outcomes: Vec<_> = map.outcomes().into_iter().map(|(words, _)| words).collect();
    let strips = if outcomes.is_empty() { 0 } else { curves.len() };
    if strips > 0 {
        let outcomes = outcomes.join(", ");
        key.push(Entry::note(&format!("above the frame: {outcomes}")));
    }
    let below_legend = legend::draw_at_top(&mut drawing, &key) + 0.6;
    let pitch = (STRIP + STRIP_GAP).min(STRIPS * chart::height(width) / strips.max(1) as f64);
    let strip = pitch * STRIP / (STRIP + STRIP_GAP);
    let top = below_legend + strips as f64 * pitch;
    let ranges = [aired(across.range()), aired(union(NONE, upward.range()))];
    let room = (top, frame::ROOM_RIGHT);
    let frame = chart::frame(width, room, axes, ranges);
    for (index, curve) in curves.iter().enumerate() {
        let place = |run: &&MapRun| (across.place(run.x), upward.place(run.color));
        let points: Vec<Point> = curve.runs.iter().map(place).collect();
        let mut shapes = frame.line(&points, curve.stroke);
        let there = points.iter().filter(|point| point.1.is_finite());
        shapes.extend(there.map(|point| dot(frame.place(*point), curve.stroke.colour)));
        drawing.group(curve.name, shapes);
        let top = below_legend + index as f64 * pitch;
        let valueless = curve.runs.iter().filter(|run| !run.color.is_finite());
        let marks = valueless.map(|run| {
            let x = frame.place((across.place(run.x), ranges[1].0)).0;
            let mark = Bounds::between((x - HALF_MARK, top), (x + HALF_MARK, top + strip));
            mark.area(curve.stroke.colour)
        });
        let marks: Vec<_> = marks.collect();
        if !marks.is_empty() {
            drawing.group(&format!("{}: no value", curve.name), marks);
        }
    }
    frame.finish(&mut drawing, axes.map(|axis| &axis.quantity));
    Ok(drawing)
}

/// The runs of a scenario, in the order of x.
struct Curve<'a> {
    name: &'a str,
    stroke: Stroke,
    runs: Vec<&'a MapRun>,
}

/// The curves of all scenarios, in the order of their names.
fn curves(map: &Map) -> Result<Vec<Curve<'_>>, String> {
    let mut runs: Vec<&MapRun> = map.runs.iter().collect();
    runs.sort_by(|a, b| a.scenario.cmp(&b.scenario).then(a.x.total_cmp(&b.x)));
    let parts: Vec<_> = runs.chunk_by(|a, b| a.scenario == b.scenario).collect();
    let most = COLOURS.len() * DASHES.len();
    if parts.len() > most {
        return Err(format!(
            "{} scenarios, but at most {most} curves can be distinguished: select with --where scenario=NAME",
            parts.len()
        ));
    }
    let looks = Looks { runs: parts.len() };
    let mut curves = Vec::new();
    for (index, runs) in parts.into_iter().enumerate() {
        let name = &runs[0].scenario;
        if let Some(pair) = runs.windows(2).find(|pair| pair[0].x == pair[1].x) {
            return Err(format!(
                "several runs of {name} have {} = {:?}: select with --where",
                map.x.name, pair[0].x
            ));
        }
        let colour = COLOURS[index % COLOURS.len()];
        let mut stroke = style::line(colour, MEDIUM + looks.broader(index));
        stroke.dash = DASHES[index / COLOURS.len()];
        let runs = runs.to_vec();
        curves.push(Curve { name, stroke, runs });
    }
    Ok(curves)
}
