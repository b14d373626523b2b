//! The track of the contact point on the table.

use super::looks::{self, Looks};
use super::run::Run;
use crate::analysis::plot::drawing::Drawing;
use crate::analysis::plot::frame::{self, Frame, Quantity};
use crate::analysis::plot::legend::{self, Entry};
use crate::analysis::plot::range::extremes;
use crate::analysis::plot::shape::{Bounds, Colour, Point};
use crate::analysis::plot::style::{self, BLUE, GREEN, LINE, MARGIN, MEDIUM, VERMILLION};
use crate::telemetry::fields::contact;

/// The greatest side of the square, mm.
const LARGEST: f64 = 110.0;

/// The air around the track, as a part of its extent.
const AIR: f64 = 0.05;

/// Horizontal places, as on axes.
const X: Quantity = Quantity {
    symbol: "*x*",
    unit: "m",
};
const Y: Quantity = Quantity {
    symbol: "*y*",
    unit: "m",
};

/// Draws the tracks of the contact points from above.
pub(super) fn track(runs: &[&Run], width: f64) -> Drawing {
    let tracks: Vec<Vec<Point>> = runs.iter().map(|run| places(run)).collect();
    let mut drawing = Drawing::new(width);
    let mut legend = looks::legend(runs, |_, run| Looks::run_in_legend(run));
    let parts = match runs {
        [run] => regimes(run),
        _ => Vec::new(),
    };
    let is_there = |(name, _): &&(&str, Colour)| parts.iter().any(|(part, _)| part == name);
    for (name, colour) in REGIMES.iter().filter(is_there) {
        legend.push(Entry::line(style::line(*colour, MEDIUM), name));
    }
    legend.extend([Entry::dot(false, "start"), Entry::dot(true, "end")]);
    let top = legend::draw_at_top(&mut drawing, &legend) + LINE + 0.6;
    let ranges = ranges(&tracks);
    let square = |left: f64, side: f64| Frame::square(Bounds::new((left, top), side, side), ranges);
    let usable = width - 2.0 * MARGIN;
    // A larger frame has other numbers, which may need more room.
    let room_at = |side: f64| square(0.0, side).room_left(Y);
    let side_for = |room: f64| (usable - room - frame::ROOM_RIGHT).min(LARGEST);
    let room = room_at(0.7 * usable.min(LARGEST));
    let room = room.max(room_at(side_for(room)));
    let side = side_for(room);
    let frame = square(MARGIN + room, side);
    for (index, (run, track)) in runs.iter().zip(&tracks).enumerate() {
        let stroke = Looks::run_in_legend(index);
        let meaning = format!("{}: track of the contact point", run.name);
        if parts.is_empty() {
            drawing.group(&meaning, frame.path(track, stroke));
        }
        for (name, colour) in REGIMES {
            let parts = parts.iter().filter(|(part, _)| *part == name);
            let stroke = style::line(colour, MEDIUM);
            let shapes = parts.flat_map(|(_, places)| frame.path(places, stroke));
            drawing.group(&format!("{meaning}, {name}"), shapes.collect());
        }
        let ends = [(track.first(), false), (track.last(), true)];
        let last = parts
            .last()
            .and_then(|(name, _)| REGIMES.iter().find(|known| known.0 == *name));
        let dots = ends.into_iter().filter_map(|(place, is_end)| {
            let colour = last
                .filter(|_| is_end)
                .map_or(stroke.colour, |known| known.1);
            Some(legend::dot(frame.place(*place?), is_end, colour))
        });
        drawing.group("start and end", dots.collect());
    }
    frame.draw_with_names(&mut drawing, [X, Y]);
    drawing.height = top + side + frame::ROOM_BELOW + MARGIN;
    drawing
}

/// Regimes of a peg, and the colours of its track.
const REGIMES: [(&str, Colour); 3] = [("slides", BLUE), ("rolls", GREEN), ("flies", VERMILLION)];

/// The parts of a run's track in which the peg does one thing, with its name; none if that is not known.
fn regimes(run: &Run) -> Vec<(&'static str, Vec<Point>)> {
    let mut parts: Vec<(&str, Vec<Point>)> = Vec::new();
    let regimes = run.series(contact::REGIME).into_iter().map(|point| point.1);
    let mut last = None;
    for (place, regime) in all_places(run).zip(regimes) {
        if !(place.0.is_finite() && place.1.is_finite() && regime.is_finite()) {
            continue;
        }
        let (name, _) = match regime {
            1.0 => REGIMES[0],
            0.0 => REGIMES[1],
            _ => REGIMES[2],
        };
        match parts.last_mut().filter(|part| part.0 == name) {
            Some((_, places)) => places.push(place),
            // A part begins where the one before it ended.
            None => parts.push((name, last.into_iter().chain([place]).collect())),
        }
        last = Some(place);
    }
    parts
}

/// The places of a run's contact point, without those that are not known.
fn places(run: &Run) -> Vec<Point> {
    all_places(run)
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect()
}

fn all_places(run: &Run) -> impl Iterator<Item = Point> {
    let [x, y] =
        [contact::CONTACT_POINT.x(), contact::CONTACT_POINT.y()].map(|field| run.series(field));
    x.into_iter().zip(y).map(|((_, x), (_, y))| (x, y))
}

/// The ranges of x and y, of one size, with some air around the tracks.
fn ranges(tracks: &[Vec<Point>]) -> [(f64, f64); 2] {
    let all = || tracks.iter().flatten();
    let [x, y] = [
        extremes(all().map(|place| place.0)),
        extremes(all().map(|place| place.1)),
    ];
    let size = (x.1 - x.0).max(y.1 - y.0);
    let half = if size > 0.0 { (0.5 + AIR) * size } else { 1e-3 };
    [x, y].map(|(low, high)| {
        let middle = 0.5 * (low + high);
        (middle - half, middle + half)
    })
}
