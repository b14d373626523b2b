//! The top as it moves.

use nalgebra::{UnitQuaternion, Vector3};
use rerun::SerializedComponentColumn;
use rerun::archetypes::Transform3D;
use rerun::datatypes::Rgba32;

use super::shape;
use super::trail::Trail;
use crate::rerun::entity::TOP;
use crate::rerun::error::RerunError;
use crate::rerun::look::Look;
use crate::rerun::outlet::Outlet;
use crate::rerun::track::{Collect, Flush, Rows, Track};
use crate::telemetry::Message;
use crate::telemetry::fields::pose;
use crate::telemetry::proportions::Proportions;

/// The moving top and the trail of its axis.
pub(super) struct Pose {
    track: Track<Poses>,
    trail: Trail,
}

impl Pose {
    /// Sends the body of the top in its own axes, and how its trail is drawn.
    pub(super) fn new(
        look: &Look,
        proportions: &Proportions,
        is_free: bool,
        outlet: &mut Outlet,
    ) -> Self {
        let body = shape::top(&proportions.scaled(look.size()));
        let body = match look.albedo() {
            Some(albedo) => body.with_albedo_factor(Rgba32::from_u32(albedo)),
            None => body,
        };
        outlet.send_static(look.entity("scene/top/body"), &body);
        Trail::dress(look, is_free, outlet);
        Self {
            track: Track::new(look.entity(TOP), Poses::default()),
            trail: Trail::new(look, 1.13 * proportions.tip, is_free),
        }
    }

    /// Adds a row for a message of `/top/pose`, whose orientation (world from body) and centre of the peg are given.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        orientation: UnitQuaternion<f64>,
        peg: Vector3<f64>,
        outlet: &mut Outlet,
    ) {
        self.track.push(outlet, message.time_ns, |rows| {
            rows.quaternions
                .push(orientation.coords.cast::<f32>().into());
            rows.translations.push(peg.cast::<f32>().into());
        });
        let axis = pose::AXIS.of(message);
        self.trail.write(message.time_ns, peg, axis, outlet);
    }
}

impl Collect for Pose {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.track.flush(outlet, flush);
        self.trail.flush(outlet, flush);
    }
}

/// Rows of a transform from body to world.
#[derive(Default)]
struct Poses {
    translations: Vec<[f32; 3]>,
    quaternions: Vec<[f32; 4]>,
}

impl Rows for Poses {
    fn columns(&self, start: usize) -> Result<Vec<SerializedComponentColumn>, RerunError> {
        let quaternions = self.quaternions[start..].iter();
        let transform = Transform3D::update_fields()
            .with_many_translation(self.translations[start..].iter().copied())
            .with_many_quaternion(quaternions.map(|q| rerun::Quaternion::from_xyzw(*q)));
        Ok(transform.columns_of_unit_batches()?.collect())
    }

    fn clear(&mut self) {
        self.translations.clear();
        self.quaternions.clear();
    }
}
