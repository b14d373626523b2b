//! The scene: the top on its table, arrows, and the trail of the symmetry axis.
//!
//! World frame: z up, the table at z = 0, metres.

pub(super) mod arrow;
pub(super) mod contact_path;
pub(super) mod focus;
mod pose;
pub(super) mod shape;
mod strips;
mod trail;

use nalgebra::{UnitQuaternion, Vector3};
use rerun::ViewCoordinates;

use self::arrow::Arrow;
use self::contact_path::ContactPath;
use self::focus::Focus;
use self::pose::Pose;
use super::entity::{STAGE, VERTICAL};
use super::identity::{Geometry, Identity};
use super::look::Look;
use super::outlet::Outlet;
use super::track::{Collect, Flush};
use crate::telemetry::Message;
use crate::telemetry::fields::{CONTACT, POSE, contact, pose as fields};
use crate::telemetry::proportions::Proportions;

/// The scene of one run, fed with the messages of several channels.
pub(super) struct Scene {
    pose: Pose,
    arrows: Vec<Arrow>,
    /// The path of the contact point of a free peg.
    path: Option<ContactPath>,
    /// Target of the camera, of the only run with a free peg.
    focus: Option<Focus>,
    /// Orientation (world from body) of the last pose.
    orientation: Option<UnitQuaternion<f64>>,
    /// Centre of the peg at the last pose, in the world frame, m.
    peg: Vector3<f64>,
    /// The contact point at its last message, in the world frame, m.
    contact: Vector3<f64>,
}

impl Scene {
    /// Sends bodies, colours and labels, and what stands still if no other run shares it.
    pub(super) fn new(identity: &Identity, look: &Look, outlet: &mut Outlet) -> Self {
        let geometry = &identity.geometry;
        if look.is_alone() {
            furnish(geometry, outlet);
        }
        let focus = (geometry.is_free && look.is_alone()).then(|| {
            outlet.send_static(VERTICAL, &focus::vertical(geometry));
            Focus::new(geometry, outlet)
        });
        let scene = Self {
            pose: Pose::new(
                look,
                &Proportions::new(&geometry.top),
                geometry.is_free,
                outlet,
            ),
            arrows: Arrow::all(identity, look),
            path: (geometry.is_free && identity.has(CONTACT)).then(|| ContactPath::new(look)),
            focus,
            orientation: None,
            peg: geometry.top.peg_radius * Vector3::z(),
            contact: Vector3::zeros(),
        };
        for arrow in &scene.arrows {
            arrow.dress(outlet);
        }
        if scene.path.is_some() {
            ContactPath::dress(look, outlet);
        }
        scene
    }

    /// Adds what a message contains for the scene.
    pub(super) fn write(&mut self, message: &Message<'_>, outlet: &mut Outlet) {
        if message.topic() == POSE {
            let orientation = UnitQuaternion::new_unchecked(fields::ORIENTATION.of(message));
            self.orientation = Some(orientation);
            self.peg = fields::PEG_POSITION.of(message);
            self.pose.write(message, orientation, self.peg, outlet);
            if let Some(focus) = &mut self.focus {
                focus.write(message.time_ns, self.peg, outlet);
            }
        }
        if message.topic() == CONTACT {
            self.contact = contact::CONTACT_POINT.of(message);
            if let Some(path) = &mut self.path {
                path.write(message, self.contact, outlet);
            }
        }
        for arrow in &mut self.arrows {
            arrow.write(message, self.orientation, [self.peg, self.contact], outlet);
        }
    }

    /// Centre of the peg as it is drawn, in the world frame, m.
    pub(super) fn peg(&self) -> Vector3<f64> {
        self.peg
    }
}

impl Collect for Scene {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.arrows.flush(outlet, flush);
        self.pose.flush(outlet, flush);
        self.path.flush(outlet, flush);
        self.focus.flush(outlet, flush);
    }
}

/// Sends what stands still, which two runs that are compared share: the table and, where a peg is fixed, the vertical.
pub(super) fn furnish(geometry: &Geometry, outlet: &mut Outlet) {
    let size = Proportions::new(&geometry.top).size();
    outlet.send_static(STAGE, &ViewCoordinates::RIGHT_HAND_Z_UP());
    // A top that travels needs more room: those of the presets go as far as eleven times their height.
    let (rings, table) = if geometry.is_free {
        (20, 14.0 * size)
    } else {
        (5, 2.1 * size)
    };
    outlet.send_static("scene/table", &shape::table(table));
    outlet.send_static("scene/table/marks", &shape::table_marks(table, rings));
    if !geometry.is_free {
        outlet.send_static(VERTICAL, &focus::vertical(geometry));
    }
}
