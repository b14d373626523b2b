//! The vectors of a sample: what the arrows of the scene show, and what charts of the angular momentum follow from.

use nalgebra::{UnitQuaternion, Vector3};

use crate::physics::top::Top;
use crate::telemetry::fields::{
    CENTER_OF_MASS, CONTACT, MOMENTUM, POSE, TORQUE, center_of_mass, contact, momentum, pose,
    torque,
};
use crate::telemetry::{Message, Topic};

/// The topics that a snapshot is made from, in the order of their messages.
const TOPICS: [Topic; 5] = [POSE, TORQUE, CONTACT, MOMENTUM, CENTER_OF_MASS];

/// The vectors of a sample in the world frame; NaN where the recording lacks a topic.
///
/// Angular momentum and torques are about the centre of a fixed peg, or about the centre of mass of a top with a free
/// one. About these points the sum of the torques is the rate of change of the angular momentum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Snapshot {
    /// Time, ns.
    pub(crate) time_ns: u64,
    /// Orientation (world from body).
    pub(crate) orientation: UnitQuaternion<f64>,
    /// Direction of the symmetry axis.
    pub(crate) axis: Vector3<f64>,
    /// Centre of the peg, m.
    pub(crate) peg: Vector3<f64>,
    /// Point of contact, or the lowest point of a peg in the air, m.
    pub(crate) contact: Vector3<f64>,
    /// Centre of mass, m.
    pub(crate) center: Vector3<f64>,
    /// The point that angular momentum and torques are about, m.
    pub(crate) origin: Vector3<f64>,
    /// Slip velocity, m/s.
    pub(crate) slip: Vector3<f64>,
    /// Friction force, N.
    pub(crate) friction: Vector3<f64>,
    /// Weight, N.
    pub(crate) weight: f64,
    /// Angular momentum, kg m²/s.
    pub(crate) momentum: Vector3<f64>,
    /// Torque of friction and air drag, N m.
    pub(crate) friction_torque: Vector3<f64>,
    /// Torque of gravity about a fixed peg, or of the normal force about the centre of mass, N m.
    pub(crate) weight_torque: Vector3<f64>,
}

impl Snapshot {
    /// A snapshot without values.
    fn empty(time_ns: u64, weight: f64) -> Self {
        let missing = Vector3::repeat(f64::NAN);
        Self {
            time_ns,
            orientation: UnitQuaternion::identity(),
            axis: missing,
            peg: missing,
            contact: missing,
            center: missing,
            origin: missing,
            slip: missing,
            friction: missing,
            weight,
            momentum: missing,
            friction_torque: missing,
            weight_torque: missing,
        }
    }

    /// The horizontal part of the angular momentum, kg m²/s.
    pub(crate) fn horizontal_momentum(&self) -> Vector3<f64> {
        Vector3::new(self.momentum.x, self.momentum.y, 0.0)
    }
}

/// Collects the messages of each sample.
#[derive(Clone, Debug)]
pub(crate) struct SnapshotReader {
    top: Top,
    is_free: bool,
    /// The topic whose message completes a snapshot.
    last: Option<Topic>,
    current: Snapshot,
    normal_force: f64,
}

impl SnapshotReader {
    /// A reader of a recording that has some topics.
    pub(crate) fn new(top: Top, is_free: bool, has: impl Fn(Topic) -> bool) -> Self {
        let mut recorded = TOPICS.into_iter();
        Self {
            top,
            is_free,
            last: recorded.rfind(|topic| has(*topic) && (is_free || *topic != CENTER_OF_MASS)),
            current: Snapshot::empty(0, top.weight()),
            normal_force: f64::NAN,
        }
    }

    /// The topic whose message completes a snapshot; `None` if nothing of one is recorded.
    pub(crate) fn last(&self) -> Option<Topic> {
        self.last
    }

    /// Takes a message. Returns the snapshot of its sample if it is the last one of it.
    pub(crate) fn take(&mut self, message: &Message<'_>) -> Option<&Snapshot> {
        if message.time_ns != self.current.time_ns {
            // Files with gaps lack messages: they must not be completed with those of another sample.
            self.current = Snapshot::empty(message.time_ns, self.top.weight());
            self.normal_force = f64::NAN;
        }
        self.fill(message);
        if self.last != Some(message.topic()) {
            return None;
        }
        if self.is_free {
            self.move_torques();
        }
        Some(&self.current)
    }

    /// Sets what the message contains.
    fn fill(&mut self, message: &Message<'_>) {
        let snapshot = &mut self.current;
        match message.topic() {
            POSE => {
                // A unit quaternion when it was recorded: normalising would only add a rounding error.
                snapshot.orientation = UnitQuaternion::new_unchecked(pose::ORIENTATION.of(message));
                snapshot.axis = pose::AXIS.of(message);
                snapshot.peg = pose::PEG_POSITION.of(message);
                snapshot.center = snapshot.peg + self.top.center_distance * snapshot.axis;
                snapshot.origin = if self.is_free {
                    snapshot.center
                } else {
                    snapshot.peg
                };
            }
            TORQUE => {
                let turn = snapshot.orientation;
                snapshot.friction_torque = turn * torque::FRICTION_BODY.of(message);
                snapshot.weight_torque = turn * torque::GRAVITY_BODY.of(message);
            }
            CONTACT => {
                snapshot.contact = contact::CONTACT_POINT.of(message);
                snapshot.slip = contact::SLIP_WORLD.of(message);
                snapshot.friction = contact::FRICTION_FORCE.of(message);
                self.normal_force = contact::NORMAL_FORCE.of(message);
            }
            MOMENTUM if !self.is_free => snapshot.momentum = momentum::WORLD.of(message),
            CENTER_OF_MASS => {
                snapshot.momentum = center_of_mass::ANGULAR_MOMENTUM.of(message);
            }
            _ => {}
        }
    }

    /// Moves the torques, which are recorded about the centre of the peg, to the centre of mass.
    fn move_torques(&mut self) {
        let snapshot = &mut self.current;
        let to_peg = snapshot.peg - snapshot.center;
        snapshot.friction_torque += to_peg.cross(&snapshot.friction);
        let normal = self.normal_force * Vector3::z();
        snapshot.weight_torque = (snapshot.contact - snapshot.center).cross(&normal);
    }
}
