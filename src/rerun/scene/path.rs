//! Paths in the scene: of the symmetry axis, and of the contact point of a free peg.

use nalgebra::Vector3;
use rerun::archetypes::LineStrips3D;
use rerun::{Color, Radius};

use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::role::Role;

/// Time between two pieces of a path, in ns.
const PIECE_NS: u64 = 10_000_000;
/// Time between two points of a piece, in ns.
const POINT_NS: u64 = 1_000_000;

/// Width of the faded part of a path, points.
const FADED_WIDTH: f32 = 0.7;

/// A path in one or several colours.
///
/// Each row is one short piece, and the layout shows all pieces up to the time cursor. The size of a recording grows
/// linearly with its length, and the cursor moves along the whole path.
pub(super) struct Path {
    /// One for each colour.
    tracks: Vec<Track<Vec<[f32; 3]>>>,
    /// The same path again, for the part of it that has faded.
    faded: Option<Track<Vec<[f32; 3]>>>,
    piece: Vec<[f32; 3]>,
    /// The track that the piece belongs to.
    kind: usize,
    next_point_ns: u64,
    next_piece_ns: u64,
}

impl Path {
    /// An empty path of these colours, each with its entity.
    pub(super) fn new(
        role: &Role,
        colors: &[(&str, u32)],
        width: f32,
        output: &mut Output,
    ) -> Self {
        let mut tracks = Vec::new();
        for (place, (entity, color)) in colors.iter().enumerate() {
            let color = role.color(*color, place);
            tracks.push(track(role.entity(entity), color, width, output));
        }
        Self {
            tracks,
            faded: None,
            piece: Vec::new(),
            kind: 0,
            next_point_ns: 0,
            next_piece_ns: PIECE_NS,
        }
    }

    /// The same path, drawn a second time in a darker colour, for the part that has faded.
    pub(super) fn fading(
        mut self,
        role: &Role,
        entity: &str,
        color: u32,
        output: &mut Output,
    ) -> Self {
        let color = darkened(role.color(color, 0));
        self.faded = Some(track(role.entity(entity), color, FADED_WIDTH, output));
        self
    }

    /// Adds a point in the world frame, m, at a time in ns, in one of the colours.
    pub(super) fn write(
        &mut self,
        time_ns: u64,
        kind: usize,
        point: Vector3<f64>,
        output: &mut Output,
    ) {
        // A piece has one colour, so a change of colour ends it.
        let is_changed = kind != self.kind;
        if time_ns < self.next_point_ns && !is_changed {
            return;
        }
        self.next_point_ns = time_ns.saturating_add(POINT_NS);
        let point: [f32; 3] = point.cast().into();
        self.piece.push(point);
        if (time_ns >= self.next_piece_ns || is_changed) && self.piece.len() > 1 {
            self.next_piece_ns = time_ns.saturating_add(PIECE_NS);
            // Each piece begins where the one before it ended.
            let piece = std::mem::replace(&mut self.piece, vec![point]);
            if let Some(faded) = &self.faded {
                faded.push(output, time_ns, [piece.clone()]);
            }
            self.tracks[self.kind].push(output, time_ns, [piece]);
        }
        self.kind = kind;
    }
}

/// An empty track, whose color and width in points are sent.
fn track(entity: String, color: u32, width: f32, output: &mut Output) -> Track<Vec<[f32; 3]>> {
    let style = LineStrips3D::update_fields()
        .with_colors([Color::from_u32(color)])
        .with_radii([Radius::new_ui_points(width)]);
    output.send_static(entity.as_str(), &style);
    Track::new(entity, columns, output)
}

/// A third of a colour's brightness: lines can't be translucent.
fn darkened(color: u32) -> u32 {
    let [red, green, blue, alpha] = color.to_be_bytes();
    u32::from_be_bytes([red / 3, green / 3, blue / 3, alpha])
}

fn columns(rows: &[Vec<[f32; 3]>]) -> ComponentColumns {
    let strips = LineStrips3D::update_fields().with_strips(rows.iter().cloned());
    Ok(strips.columns_of_unit_batches()?.collect())
}
