//! The path of the contact point of a free peg.

use nalgebra::Vector3;
use rerun::archetypes::LineStrips3D;
use rerun::{Color, Radius};

use super::strips::Strips;
use super::trail;
use crate::rerun::entity::{CONTACT_PATH_NAME, CONTACT_PATHS};
use crate::rerun::look::Look;
use crate::rerun::outlet::Outlet;
use crate::rerun::palette;
use crate::rerun::track::{Collect, Flush, Track};
use crate::telemetry::Message;
use crate::telemetry::fields::contact;

/// Time between two pieces of the path, in ns.
const PIECE_NS: u64 = 10_000_000;
/// Time between two points of a piece, in ns.
const POINT_NS: u64 = 1_000_000;

/// Colours of the paths, in Markdown.
pub(crate) const EXPLANATION: &str = "\n\n## Path of the contact point\n\nBlue where it slides, green where it rolls or \
                                      sticks, vermillion where the peg is in the air.\n";

/// The path of the lowest point of the peg: in one colour where it slides, in another where it rolls or sticks, in a
/// third where it flies.
///
/// As the trail of the axis, it consists of short pieces, and the layout shows those up to the time cursor.
pub(super) struct ContactPath {
    look: Look,
    tracks: [Track<Strips>; 3],
    piece: Vec<[f32; 3]>,
    /// Which of the tracks the piece belongs to.
    kind: usize,
    next_point_ns: u64,
    next_piece_ns: u64,
}

impl ContactPath {
    /// An empty path.
    pub(super) fn new(look: &Look) -> Self {
        let track = |path| Track::new(look.entity(path), Strips::default());
        Self {
            look: look.clone(),
            tracks: CONTACT_PATHS.map(track),
            piece: Vec::new(),
            kind: 0,
            next_point_ns: 0,
            next_piece_ns: PIECE_NS,
        }
    }

    /// Sends how the path is drawn.
    pub(super) fn dress(look: &Look, outlet: &mut Outlet) {
        let colors = [palette::SKY, palette::GREEN, palette::VERMILLION];
        for (place, (entity, color)) in CONTACT_PATHS.into_iter().zip(colors).enumerate() {
            let style = LineStrips3D::update_fields()
                .with_colors([Color::from_u32(look.color(color, place))])
                .with_radii([Radius::new_ui_points(1.6)]);
            outlet.send_static(look.entity(entity), &style);
        }
    }

    /// Adds the lowest point of the peg at the time of a message of `/top/contact`.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        point: Vector3<f64>,
        outlet: &mut Outlet,
    ) {
        let time_ns = message.time_ns;
        let kind = kind(contact::REGIME.of(message));
        if time_ns < self.next_point_ns && kind == self.kind {
            return;
        }
        self.next_point_ns = time_ns.saturating_add(POINT_NS);
        let point = point.cast::<f32>().into();
        if self.piece.is_empty() && self.look.is_alone() {
            let name = trail::name("path of the contact point", point, palette::GREY);
            outlet.send_static(CONTACT_PATH_NAME, &name);
        }
        self.piece.push(point);
        let is_due = time_ns >= self.next_piece_ns || kind != self.kind;
        if is_due && self.piece.len() > 1 {
            self.next_piece_ns = time_ns.saturating_add(PIECE_NS);
            // Each piece begins where the one before it ended.
            let piece = std::mem::replace(&mut self.piece, vec![point]);
            self.tracks[self.kind].push(outlet, time_ns, |rows| rows.push(piece));
        }
        self.kind = kind;
    }
}

impl Collect for ContactPath {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        for track in &mut self.tracks {
            track.flush(outlet, flush);
        }
    }
}

/// The track of a regime, as `/top/contact` has it.
fn kind(regime: f64) -> usize {
    match regime {
        1.0 => 0,
        0.0 => 1,
        _ => 2,
    }
}
