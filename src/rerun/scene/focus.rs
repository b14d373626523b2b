//! The vertical through a peg, and the place that the view of a free peg travels with.

use nalgebra::Vector3;
use rerun::archetypes::Transform3D;
use rerun::{Color, LineStrips3D, Radius};

use crate::rerun::entity::FOCUS;
use crate::rerun::identity::Geometry;
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::role::Role;
use crate::telemetry::proportions::Proportions;

/// Time between two positions, in ns.
const STEP_NS: u64 = 10_000_000;

/// Sends the vertical line through the centre of the table, or through a free peg, up to half a
/// height above the top.
pub(super) fn send_vertical(geometry: &Geometry, entity: String, output: &mut Output) {
    let height = geometry.top.peg_radius + 1.5 * Proportions::new(&geometry.top).size();
    let line = LineStrips3D::new([[[0.0, 0.0, 0.0], [0.0, 0.0, height as f32]]])
        .with_colors([Color::from_u32(0x8A93_A3FF)])
        .with_radii([Radius::new_ui_points(0.7)]);
    output.send_static(entity, &line);
}

/// The place on the table below a free peg: the origin of its view, whose camera stays where it is.
pub(super) struct Focus {
    track: Track<[f32; 3]>,
    next_ns: u64,
}

impl Focus {
    /// Sends the vertical through the peg.
    pub(super) fn new(geometry: &Geometry, role: &Role, output: &mut Output) -> Self {
        send_vertical(geometry, role.entity(&format!("{FOCUS}/vertical")), output);
        Self {
            track: Track::new(role.entity(FOCUS), columns, output),
            next_ns: 0,
        }
    }

    /// Moves it to a place at a time in ns.
    pub(super) fn write(&mut self, time_ns: u64, place: Vector3<f64>, output: &mut Output) {
        if time_ns < self.next_ns {
            return;
        }
        self.next_ns = time_ns.saturating_add(STEP_NS);
        // On the table, so that the camera doesn't hop with the peg.
        let place = [place.x as f32, place.y as f32, 0.0];
        self.track.push(output, time_ns, [place]);
    }
}

fn columns(rows: &[[f32; 3]]) -> ComponentColumns {
    let places = rows.iter().copied();
    let transform = Transform3D::update_fields().with_many_translation(places);
    Ok(transform.columns_of_unit_batches()?.collect())
}
