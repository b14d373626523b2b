//! The scene: the top on its table, arrows, and the trail of the symmetry axis.
//!
//! World frame: z up, the table at z = 0, metres.

pub(super) mod arrow;
mod pose;
pub(super) mod shape;
mod trail;

use nalgebra::{UnitQuaternion, Vector3};
use rerun::ViewCoordinates;

use self::arrow::Arrow;
use self::pose::Pose;
use super::entity::STAGE;
use super::identity::{Geometry, Identity};
use super::look::Look;
use super::outlet::Outlet;
use super::track::{Collect, Flush};
use crate::telemetry::Message;
use crate::telemetry::fields::{POSE, pose as fields};
use crate::telemetry::proportions::Proportions;

/// The scene of one run, fed with the messages of several channels.
pub(super) struct Scene {
    pose: Pose,
    arrows: Vec<Arrow>,
    /// Orientation (world from body) of the last pose.
    orientation: Option<UnitQuaternion<f64>>,
    /// Centre of the peg at the last pose, in the world frame, m.
    peg: Vector3<f64>,
}

impl Scene {
    /// Sends bodies, colours and labels, and what stands still if no other run shares it.
    pub(super) fn new(identity: &Identity, look: &Look, outlet: &mut Outlet) -> Self {
        let geometry = &identity.geometry;
        if look.is_alone() {
            furnish(geometry, outlet);
        }
        let scene = Self {
            pose: Pose::new(look, &Proportions::new(&geometry.top), outlet),
            arrows: Arrow::all(identity, look),
            orientation: None,
            peg: geometry.top.peg_radius * Vector3::z(),
        };
        for arrow in &scene.arrows {
            arrow.dress(outlet);
        }
        scene
    }

    /// Adds what a message says about the scene.
    pub(super) fn write(&mut self, message: &Message<'_>, outlet: &mut Outlet) {
        if message.topic() == POSE {
            let orientation = UnitQuaternion::new_unchecked(fields::ORIENTATION.of(message));
            self.orientation = Some(orientation);
            self.peg = fields::PEG_POSITION.of(message);
            self.pose.write(message, orientation, self.peg, outlet);
        }
        for arrow in &mut self.arrows {
            arrow.write(message, self.orientation, self.peg, outlet);
        }
    }
}

impl Collect for Scene {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.arrows.flush(outlet, flush);
        self.pose.flush(outlet, flush);
    }
}

/// Sends what stands still, which two runs that are compared share: the table and the vertical.
pub(super) fn furnish(geometry: &Geometry, outlet: &mut Outlet) {
    let height = Proportions::new(&geometry.top).tip;
    let table = 2.1 * height;
    let vertical = geometry.top.peg_radius + 1.5 * height;
    outlet.send_static(STAGE, &ViewCoordinates::RIGHT_HAND_Z_UP());
    outlet.send_static("scene/table", &shape::table(table));
    outlet.send_static("scene/table/marks", &shape::table_marks(table));
    outlet.send_static("scene/vertical", &shape::vertical(vertical));
}
