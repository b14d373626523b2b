//! The track of the contact point on the table.

use super::data::RunData;
use super::style::{Style, run_legend};
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::{self, Frame, Quantity};
use crate::figures::plot::legend::{self, LegendEntry};
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::{Bounds, Colour, Point};
use crate::figures::plot::style::{self, BLUE, GREEN, LINE_HEIGHT, MARGIN, MEDIUM, VERMILION};
use crate::run::simulation::Regime;
use crate::telemetry::fields::contact;

/// The maximum side of the square, mm.
const MAX_SIDE: f64 = 110.0;

/// The padding around the track, relative to its extent.
const PADDING: f64 = 0.05;

/// Half the range around a point that doesn't move, m.
const HALF_RANGE_AT_REST: f64 = 1e-3;

/// Horizontal positions, as axis labels.
const X: Quantity = Quantity::new("*x*", "m");
const Y: Quantity = Quantity::new("*y*", "m");

/// The contact between peg and table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ContactKind {
    Sliding,
    Rolling,
    InTheAir,
}

impl ContactKind {
    const ALL: [Self; 3] = [Self::Sliding, Self::Rolling, Self::InTheAir];

    /// The contact with a recorded [`contact::REGIME`]; `None` if the recording lacks it.
    fn from_regime(regime: f64) -> Option<Self> {
        match Regime::from_code(regime)? {
            Regime::Sticking => Some(Self::Rolling),
            Regime::Slipping => Some(Self::Sliding),
            Regime::Flying => Some(Self::InTheAir),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Sliding => "sliding",
            Self::Rolling => "rolling",
            Self::InTheAir => "in the air",
        }
    }

    fn colour(self) -> Colour {
        match self {
            Self::Sliding => BLUE,
            Self::Rolling => GREEN,
            Self::InTheAir => VERMILION,
        }
    }
}

/// The recorded position of a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ContactPosition {
    /// The horizontal position, m.
    point: Point,
    contact: ContactKind,
}

/// A part of a track with one kind of contact.
struct TrackPart {
    contact: ContactKind,
    points: Vec<Point>,
}

/// Draws the tracks of the contact points from above.
pub(super) fn track(runs: &[&RunData], width: f64) -> Drawing {
    let tracks: Vec<Vec<ContactPosition>> = runs.iter().map(|run| positions(run)).collect();
    // The tracks of several runs are distinguished by their colours, so they are not divided.
    let parts = match &tracks[..] {
        [track] => parts(track),
        _ => Vec::new(),
    };
    let mut drawing = Drawing::new(width);
    let mut legend = run_legend(runs, Style::run_in_legend);
    for contact in ContactKind::ALL {
        if parts.iter().any(|part| part.contact == contact) {
            let stroke = style::line(contact.colour(), MEDIUM);
            legend.push(LegendEntry::line(stroke, contact.name()));
        }
    }
    legend.extend(LegendEntry::ends());
    let top = legend::draw_at_top(&mut drawing, &legend) + LINE_HEIGHT + 0.6;
    let frame = largest_frame(top, width, ranges(&tracks));
    for (index, (run, track)) in runs.iter().zip(&tracks).enumerate() {
        let meaning = format!("{}: track of the contact point", run.name);
        let points: Vec<Point> = track.iter().map(|position| position.point).collect();
        let stroke = Style::run_in_legend(index);
        if parts.is_empty() {
            drawing.group(&meaning, frame.path(&points, stroke));
        }
        // One group for each kind of contact, because a track may change it a thousand times.
        for contact in ContactKind::ALL {
            let stroke = style::line(contact.colour(), MEDIUM);
            let shapes = parts
                .iter()
                .filter(|part| part.contact == contact)
                .flat_map(|part| frame.path(&part.points, stroke))
                .collect();
            drawing.group(&format!("{meaning}, {}", contact.name()), shapes);
        }
        let end_colour = parts
            .last()
            .map_or(stroke.colour, |part| part.contact.colour());
        let mut dots = Vec::new();
        if let (Some(start), Some(end)) = (points.first(), points.last()) {
            dots.push(legend::start_dot(frame.place(*start), stroke.colour));
            dots.push(legend::end_dot(frame.place(*end), end_colour));
        }
        drawing.group("start and end", dots);
    }
    frame.finish(&mut drawing, [&X, &Y]);
    drawing
}

/// The largest square frame below `top` in a drawing of this width.
fn largest_frame(top: f64, width: f64, ranges: [(f64, f64); 2]) -> Frame {
    let usable = width - 2.0 * MARGIN;
    let tentative = square(0.0, top, 0.7 * usable.min(MAX_SIDE), ranges);
    let tentative_room = frame::room_left(&tentative.y, &Y);
    // A larger frame has other tick labels, which may need more room.
    let larger = square(0.0, top, max_side(usable, tentative_room), ranges);
    let room = tentative_room.max(frame::room_left(&larger.y, &Y));
    square(MARGIN + room, top, max_side(usable, room), ranges)
}

fn square(left: f64, top: f64, side: f64, ranges: [(f64, f64); 2]) -> Frame {
    Frame::square(Bounds::new((left, top), side, side), ranges)
}

/// The side of a square frame with room to its left, mm.
fn max_side(usable: f64, room_left: f64) -> f64 {
    (usable - room_left - frame::ROOM_RIGHT).min(MAX_SIDE)
}

/// Divides a track into parts with one kind of contact each.
fn parts(track: &[ContactPosition]) -> Vec<TrackPart> {
    let mut parts: Vec<TrackPart> = Vec::new();
    for positions in track.chunk_by(|a, b| a.contact == b.contact) {
        // A part begins where the one before it ended.
        let previous = parts.last().and_then(|part| part.points.last()).copied();
        let points = positions.iter().map(|position| position.point);
        parts.push(TrackPart {
            contact: positions[0].contact,
            points: previous.into_iter().chain(points).collect(),
        });
    }
    parts
}

/// The recorded positions of a run's contact point.
fn positions(run: &RunData) -> Vec<ContactPosition> {
    let x = run.series(contact::CONTACT_POINT.x());
    let y = run.series(contact::CONTACT_POINT.y());
    let regime = run.series(contact::REGIME);
    let mut positions = Vec::new();
    for (((_, x), (_, y)), (_, regime)) in x.into_iter().zip(y).zip(regime) {
        if x.is_finite()
            && y.is_finite()
            && let Some(contact) = ContactKind::from_regime(regime)
        {
            let point = (x, y);
            positions.push(ContactPosition { point, contact });
        }
    }
    positions
}

/// The ranges of x and y, of equal size, with padding around the tracks.
fn ranges(tracks: &[Vec<ContactPosition>]) -> [(f64, f64); 2] {
    let points = tracks.iter().flatten().map(|position| position.point);
    let x = extremes(points.clone().map(|point| point.0));
    let y = extremes(points.map(|point| point.1));
    let size = (x.1 - x.0).max(y.1 - y.0);
    // A square, so that the track has its true shape.
    let half = if size > 0.0 {
        (0.5 + PADDING) * size
    } else {
        HALF_RANGE_AT_REST
    };
    [x, y].map(|(low, high)| {
        let middle = 0.5 * (low + high);
        (middle - half, middle + half)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_regimes_have_no_contact() {
        for regime in [f64::NAN, -1.0, 0.5, 3.0] {
            assert_eq!(ContactKind::from_regime(regime), None);
        }
        let known = [0.0, 1.0, 2.0].map(ContactKind::from_regime);
        let expected = [
            ContactKind::Rolling,
            ContactKind::Sliding,
            ContactKind::InTheAir,
        ];
        assert_eq!(known, expected.map(Some));
    }

    #[test]
    fn parts_begin_where_the_previous_part_ends() {
        let track = [
            ((0.0, 0.0), ContactKind::Sliding),
            ((1.0, 0.0), ContactKind::Sliding),
            ((2.0, 0.0), ContactKind::Rolling),
        ]
        .map(|(point, contact)| ContactPosition { point, contact });
        let parts = parts(&track);
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[0].points, [(0.0, 0.0), (1.0, 0.0)]);
        assert_eq!(parts[1].points, [(1.0, 0.0), (2.0, 0.0)]);
        assert_eq!(parts[1].contact, ContactKind::Rolling);
    }
}
