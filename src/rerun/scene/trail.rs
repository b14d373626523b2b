//! The path of the symmetry axis.

use nalgebra::Vector3;
use rerun::archetypes::{LineStrips3D, Points3D};
use rerun::{Color, Radius};

use super::strips::Strips;
use crate::rerun::entity::{TRAIL_ABOVE, TRAIL_BELOW, TRAIL_NAME};
use crate::rerun::look::Look;
use crate::rerun::outlet::Outlet;
use crate::rerun::palette;
use crate::rerun::track::{Collect, Flush, Track};

/// Time between two pieces of the trail, in ns.
const PIECE_NS: u64 = 10_000_000;
/// Time between two points of a piece, in ns.
const POINT_NS: u64 = 1_000_000;

/// The path of the symmetry axis on a sphere around the peg, and its projection onto the table if the peg is fixed:
/// below a top that travels, that would cross the path of the contact point.
///
/// Each row is one short piece, and the layout shows all pieces up to the time cursor. So the size of a recording grows
/// linearly with its length, and the cursor moves along the whole path.
pub(super) struct Trail {
    look: Look,
    radius: f64,
    above: Track<Strips>,
    below: Option<Track<Strips>>,
    piece: Vec<[f32; 3]>,
    next_point_ns: u64,
    next_piece_ns: u64,
}

impl Trail {
    /// An empty path on a sphere of this radius in m.
    pub(super) fn new(look: &Look, radius: f64, is_free: bool) -> Self {
        let track = |path| Track::new(look.entity(path), Strips::default());
        Self {
            look: look.clone(),
            radius,
            above: track(TRAIL_ABOVE),
            below: (!is_free).then(|| track(TRAIL_BELOW)),
            piece: Vec::new(),
            next_point_ns: 0,
            next_piece_ns: PIECE_NS,
        }
    }

    /// Sends how the path is drawn.
    pub(super) fn dress(look: &Look, is_free: bool, outlet: &mut Outlet) {
        let paths = [(TRAIL_ABOVE, 1.3), (TRAIL_BELOW, 1.0)];
        for (entity, width) in paths.into_iter().take(if is_free { 1 } else { 2 }) {
            let style = LineStrips3D::update_fields()
                .with_colors([Color::from_u32(look.color(palette::PURPLE, 0))])
                .with_radii([Radius::new_ui_points(width)]);
            outlet.send_static(look.entity(entity), &style);
        }
    }

    /// Adds a point: centre of the peg and direction of the axis at a time in ns.
    pub(super) fn write(
        &mut self,
        time_ns: u64,
        peg: Vector3<f64>,
        axis: Vector3<f64>,
        outlet: &mut Outlet,
    ) {
        if time_ns < self.next_point_ns {
            return;
        }
        self.next_point_ns = time_ns.saturating_add(POINT_NS);
        let point = (peg + self.radius * axis).cast::<f32>().into();
        if self.piece.is_empty() && self.look.is_alone() {
            let name = name("path of the symmetry axis", point, palette::PURPLE);
            outlet.send_static(TRAIL_NAME, &name);
        }
        self.piece.push(point);
        if time_ns < self.next_piece_ns || self.piece.len() < 2 {
            return;
        }
        self.next_piece_ns = time_ns.saturating_add(PIECE_NS);
        // Each piece begins where the one before it ended.
        let piece = std::mem::replace(&mut self.piece, vec![point]);
        if let Some(below) = &mut self.below {
            below.push(outlet, time_ns, |rows| rows.push(projected(&piece)));
        }
        self.above.push(outlet, time_ns, |rows| rows.push(piece));
    }
}

impl Collect for Trail {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.above.flush(outlet, flush);
        self.below.flush(outlet, flush);
    }
}

/// The name of a path, in its colour at a point of it in the world frame, m.
pub(super) fn name(text: &str, point: [f32; 3], color: u32) -> Points3D {
    Points3D::new([point])
        .with_colors([Color::from_u32(color)])
        .with_radii([Radius::new_ui_points(0.0)])
        .with_labels([text])
        .with_show_labels(true)
}

/// The projection of a piece onto the table.
fn projected(piece: &[[f32; 3]]) -> Vec<[f32; 3]> {
    piece.iter().map(|[x, y, _]| [*x, *y, 0.0]).collect()
}
