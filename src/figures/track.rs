//! The track of the contact point on the table.

use super::looks::{self, Looks};
use super::run::Run;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::{self, Frame, Quantity};
use crate::figures::plot::legend::{self, Entry};
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::{Bounds, Colour, Point};
use crate::figures::plot::style::{self, BLUE, GREEN, LINE, MARGIN, MEDIUM, VERMILION};
use crate::telemetry::fields::contact;

/// The maximum side of the square, mm.
const LARGEST: f64 = 110.0;

/// The padding around the track, relative to its extent.
const AIR: f64 = 0.05;

/// Horizontal positions, as axis labels.
const X: Quantity = Quantity::new("*x*", "m");
const Y: Quantity = Quantity::new("*y*", "m");

/// Draws the tracks of the contact points from above.
pub(super) fn track(runs: &[&Run], width: f64) -> Drawing {
    let tracks: Vec<_> = runs.iter().map(|run| places(run)).collect();
    let mut drawing = Drawing::new(width);
    let mut legend = looks::legend(runs, Looks::run_in_legend);
    let parts = match &tracks[..] {
        [track] => regimes(track),
        _ => Vec::new(),
    };
    for (name, colour) in REGIMES {
        if parts.iter().any(|(part, _)| part.0 == name) {
            legend.push(Entry::line(style::line(colour, MEDIUM), name));
        }
    }
    legend.extend(Entry::ends());
    let top = legend::draw_at_top(&mut drawing, &legend) + LINE + 0.6;
    let ranges = ranges(&tracks);
    let square = |left: f64, side: f64| Frame::square(Bounds::new((left, top), side, side), ranges);
    let usable = width - 2.0 * MARGIN;
    // A larger frame has other numbers, which may need more room.
    let room_at = |side: f64| frame::room_left(&square(0.0, side).y, &Y);
    let side_for = |room: f64| (usable - room - frame::ROOM_RIGHT).min(LARGEST);
    let room = room_at(0.7 * usable.min(LARGEST));
    let room = room.max(room_at(side_for(room)));
    let frame = square(MARGIN + room, side_for(room));
    for (index, (run, track)) in runs.iter().zip(&tracks).enumerate() {
        let stroke = Looks::run_in_legend(index);
        let meaning = format!("{}: track of the contact point", run.name);
        let places: Vec<_> = track.iter().map(|(place, _)| *place).collect();
        if parts.is_empty() {
            drawing.group(&meaning, frame.path(&places, stroke));
        }
        for (name, colour) in REGIMES {
            let parts = parts.iter().filter(|(part, _)| part.0 == name);
            let stroke = style::line(colour, MEDIUM);
            let shapes = parts.flat_map(|(_, places)| frame.path(places, stroke));
            drawing.group(&format!("{meaning}, {name}"), shapes.collect());
        }
        let last = parts.last().map_or(stroke.colour, |(part, _)| part.1);
        let ends = [
            (places.first(), false, stroke.colour),
            (places.last(), true, last),
        ];
        let dots = ends.into_iter().filter_map(|(place, is_end, colour)| {
            Some(legend::dot(frame.place(*place?), is_end, colour))
        });
        drawing.group("start and end", dots.collect());
    }
    frame.finish(&mut drawing, [&X, &Y]);
    drawing
}

/// A contact regime and its colour.
type Regime = (&'static str, Colour);

const REGIMES: [Regime; 3] = [
    ("sliding", BLUE),
    ("rolling", GREEN),
    ("in the air", VERMILION),
];

/// The parts of a track, each with one contact regime.
fn regimes(track: &[(Point, f64)]) -> Vec<(Regime, Vec<Point>)> {
    let mut last = None;
    let parts = track.chunk_by(|one, other| one.1 == other.1).map(|part| {
        let regime = match part[0].1 {
            1.0 => REGIMES[0],
            0.0 => REGIMES[1],
            _ => REGIMES[2],
        };
        // A part begins where the one before it ended.
        let places = last.into_iter().chain(part.iter().map(|(place, _)| *place));
        let places: Vec<_> = places.collect();
        last = places.last().copied();
        (regime, places)
    });
    parts.collect()
}

/// The recorded positions of a run's contact point, with its regime.
fn places(run: &Run) -> Vec<(Point, f64)> {
    let point = contact::CONTACT_POINT;
    let fields = [point.x(), point.y(), contact::REGIME];
    let [x, y, regime] = fields.map(|field| run.series(field).into_iter().map(|point| point.1));
    let is_known = |((x, y), regime): &(Point, f64)| (x + y + regime).is_finite();
    x.zip(y).zip(regime).filter(is_known).collect()
}

/// The ranges of x and y, of equal size, with padding around the tracks.
fn ranges(tracks: &[Vec<(Point, f64)>]) -> [(f64, f64); 2] {
    let places = tracks.iter().flatten().map(|(place, _)| place);
    let x = extremes(places.clone().map(|place| place.0));
    let y = extremes(places.map(|place| place.1));
    let size = (x.1 - x.0).max(y.1 - y.0);
    let half = if size > 0.0 { (0.5 + AIR) * size } else { 1e-3 };
    [x, y].map(|(low, high)| {
        let middle = 0.5 * (low + high);
        (middle - half, middle + half)
    })
}
