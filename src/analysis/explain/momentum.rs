//! The direction of the angular momentum and of the symmetry axis over a run.
//!
//! The axis of a fast top stays close to its angular momentum. Why the axis rises is then a question about the angular
//! momentum alone: what shortens its horizontal part?
//!
//! A top that spins the other way moves as its mirror image, and its angular momentum points down. Angles are therefore
//! those of a line: the angular momentum times the sign of its vertical part at the start, which is kept for the run.

use crate::analysis::history::Extent;
use crate::physics::dynamics::{Model, Support};
use crate::physics::math::{atan2, hypot, sin_cos};
use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::fields::{
    CENTER_OF_MASS, CONTACT, IMPACTS, MOMENTUM, POSE, STATE, TORQUE, center_of_mass, contact,
    impacts, momentum, pose, state, torque,
};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// The angular momentum and the axis at an instant. The angular momentum is about the centre of a fixed peg, or about
/// the centre of mass of a top with a free one: there, friction is the only torque besides that of the normal force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MomentumState {
    /// Time, s.
    pub(super) time: f64,
    /// Part of the angular momentum about the vertical, kg m²/s.
    pub(super) vertical: f64,
    /// Magnitude of its horizontal part, kg m²/s.
    pub(super) horizontal: f64,
    /// Part about the symmetry axis, kg m²/s.
    pub(super) axial: f64,
    /// Inclination of the axis, rad.
    pub(super) theta: f64,
    /// Angle between the line of the angular momentum and the axis, rad.
    pub(super) angle_to_axis: f64,
    /// Sense of the line of the angular momentum: 1 along it, −1 against it.
    sense: f64,
}

impl MomentumState {
    /// Inclination of the line of the angular momentum, rad.
    pub(super) fn inclination(&self) -> f64 {
        atan2(self.horizontal, self.sense * self.vertical)
    }

    /// Magnitude of the angular momentum, kg m²/s.
    pub(super) fn size(&self) -> f64 {
        hypot(self.horizontal, self.vertical)
    }

    /// The same with the line in this sense, where it is that of the angular momentum itself.
    fn with_sense(self, sense: f64) -> Self {
        let angle_to_axis = if sense < 0.0 {
            PI - self.angle_to_axis
        } else {
            self.angle_to_axis
        };
        Self {
            angle_to_axis,
            sense,
            ..self
        }
    }
}

/// The time from the first sample to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MomentumSpan {
    pub(super) from: MomentumState,
    pub(super) to: MomentumState,
    /// Change of the horizontal part by the torque of friction and air drag in the samples, and by friction in impacts,
    /// kg m²/s.
    pub(super) by_friction: f64,
    /// The largest angle between the line of the angular momentum and the axis, rad.
    pub(super) angle_to_axis: f64,
    /// The largest inclination of the line of the angular momentum, rad.
    pub(super) inclination: f64,
    /// The largest force of friction at the contact point in a sample, N; infinite if it is not recorded.
    pub(super) contact_friction: f64,
}

impl MomentumSpan {
    /// A span that begins and ends at a sample.
    pub(super) fn new(state: MomentumState) -> Self {
        Self {
            from: state,
            to: state,
            by_friction: 0.0,
            angle_to_axis: state.angle_to_axis,
            inclination: state.inclination(),
            contact_friction: 0.0,
        }
    }

    /// Both spans, of which the second one begins where the first one ends.
    pub(super) fn joined(self, next: Self) -> Self {
        Self {
            from: self.from,
            to: next.to,
            by_friction: self.by_friction + next.by_friction,
            angle_to_axis: self.angle_to_axis.max(next.angle_to_axis),
            inclination: self.inclination.max(next.inclination),
            contact_friction: self.contact_friction.max(next.contact_friction),
        }
    }
}

/// What the messages of one sample say; they come one after the other.
#[derive(Clone, Copy, Debug, Default)]
struct PendingSample {
    time_ns: u64,
    phi: Option<f64>,
    theta: Option<f64>,
    axis: Option<Vector3<f64>>,
    peg_position: Option<Vector3<f64>>,
    /// Torque of friction and air drag about the centre of the peg, node frame, N m.
    torque_node: Option<Vector3<f64>>,
    /// Force of friction, N.
    force: Option<Vector3<f64>>,
    axial: Option<f64>,
    /// Angular momentum about the centre of the peg, kg m²/s.
    peg_momentum: Option<Vector3<f64>>,
    /// Position of the centre of mass, m.
    center: Option<Vector3<f64>>,
    /// Angular momentum about the centre of mass, kg m²/s.
    central_momentum: Option<Vector3<f64>>,
}

/// Where friction acts in impacts after a sample: these come between samples, and take no time.
#[derive(Clone, Copy, Debug)]
struct ImpactLever {
    /// From the centre of mass to the centre of the peg, m.
    to_peg: Vector3<f64>,
    /// Direction of the horizontal part of the angular momentum.
    direction: Vector3<f64>,
}

impl ImpactLever {
    /// Change of the horizontal part of the angular momentum by the friction in an impact, kg m²/s.
    fn shortening(&self, impulse: Vector3<f64>, peg_radius: f64) -> f64 {
        let to_contact = self.to_peg - Vector3::new(0.0, 0.0, peg_radius);
        let friction = Vector3::new(impulse.x, impulse.y, 0.0);
        to_contact.cross(&friction).dot(&self.direction)
    }
}

/// The angular momentum of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct MomentumHistory {
    support: Support,
    /// Radius of the peg, m.
    peg_radius: f64,
    pending: PendingSample,
    /// Torque along the horizontal part of the angular momentum in the previous sample, N m.
    shortening: f64,
    /// That of the previous sample of a free top.
    lever: Option<ImpactLever>,
    /// Change of the horizontal part by friction in impacts since the previous sample, kg m²/s.
    by_impacts: f64,
    /// From the first sample to the last.
    pub(super) whole: Option<MomentumSpan>,
    /// From the last mark, or from the first sample, to the last.
    pub(super) since_mark: Option<MomentumSpan>,
    /// The part about the vertical.
    pub(super) vertical: Option<Extent>,
    /// The part about the symmetry axis.
    pub(super) axial: Option<Extent>,
    /// The largest magnitude, kg m²/s.
    pub(super) largest: f64,
}

impl MomentumHistory {
    /// Creates the history of a run of this model.
    pub(super) fn new(model: &Model) -> Self {
        Self {
            support: model.support,
            peg_radius: model.top.peg_radius,
            ..Self::default()
        }
    }

    /// Marks the last sample.
    pub(super) fn mark(&mut self) {
        self.since_mark = self.whole.map(|span| MomentumSpan::new(span.to));
    }

    pub(super) fn take(&mut self, message: &Message<'_>) {
        if message.time_ns != self.pending.time_ns {
            self.finish_sample();
            self.pending.time_ns = message.time_ns;
        }
        let sample = &mut self.pending;
        match message.topic() {
            STATE => {
                sample.phi = Some(state::PHI.of(message));
                sample.theta = Some(state::THETA.of(message));
            }
            POSE => {
                sample.axis = Some(pose::AXIS.of(message));
                sample.peg_position = Some(pose::PEG_POSITION.of(message));
            }
            TORQUE => sample.torque_node = Some(torque::FRICTION_NODE.of(message)),
            CONTACT => sample.force = Some(contact::FRICTION_FORCE.of(message)),
            MOMENTUM => {
                sample.axial = Some(momentum::AXIAL.of(message));
                sample.peg_momentum = Some(momentum::WORLD.of(message));
            }
            CENTER_OF_MASS => {
                sample.center = Some(center_of_mass::POSITION.of(message));
                sample.central_momentum = Some(center_of_mass::ANGULAR_MOMENTUM.of(message));
            }
            IMPACTS => {
                let impulse = impacts::IMPULSE.of(message);
                if let Some(lever) = self.lever {
                    self.by_impacts += lever.shortening(impulse, self.peg_radius);
                }
            }
            _ => {}
        }
    }

    /// Takes the messages of the pending sample, if they are all there.
    pub(super) fn finish_sample(&mut self) {
        let sample = std::mem::take(&mut self.pending);
        if let Some((state, shortening)) = sample.evaluate(self.support) {
            // A recording without forces does not show where they are zero.
            let friction = sample.force.map_or(f64::INFINITY, |force| force.norm());
            self.add(state, shortening, friction);
        }
        if let Some(lever) = sample.lever() {
            self.lever = Some(lever);
        }
    }

    fn add(&mut self, state: MomentumState, shortening: f64, contact_friction: f64) {
        let vertical = self.whole.map_or(state, |span| span.from).vertical;
        let state = state.with_sense(if vertical < 0.0 { -1.0 } else { 1.0 });
        Extent::take(&mut self.vertical, state.vertical);
        Extent::take(&mut self.axial, state.axial);
        self.largest = self.largest.max(state.size());
        // The trapezoidal rule: the torque of friction hardly changes within a sampling period.
        let mean = 0.5 * (self.shortening + shortening);
        let by_impacts = std::mem::take(&mut self.by_impacts);
        let mut step = MomentumSpan {
            contact_friction,
            ..MomentumSpan::new(state)
        };
        if let Some(whole) = self.whole {
            step.by_friction = (state.time - whole.to.time) * mean + by_impacts;
        }
        for span in [&mut self.whole, &mut self.since_mark] {
            *span = Some(span.map_or(step, |span| span.joined(step)));
        }
        self.shortening = shortening;
    }
}

impl PendingSample {
    /// The angular momentum, and the torque of friction and air drag along its horizontal part, N m; `None` if messages
    /// are missing or numbers are not finite.
    fn evaluate(&self, support: Support) -> Option<(MomentumState, f64)> {
        let (phi, theta, axis) = (self.phi?, self.theta?, self.axis?);
        let torque_about_peg = world_from_node(self.torque_node?, phi, axis);
        let (momentum, torque) = match support {
            Support::FixedPeg => (self.peg_momentum?, torque_about_peg),
            Support::FreePeg { .. } => {
                // The recorded torque is about the centre of the peg.
                let lever = self.peg_position? - self.center?;
                (
                    self.central_momentum?,
                    torque_about_peg + lever.cross(&self.force?),
                )
            }
        };
        let horizontal = Vector3::new(momentum.x, momentum.y, 0.0);
        let state = MomentumState {
            time: seconds(self.time_ns),
            vertical: momentum.z,
            horizontal: horizontal.norm(),
            axial: self.axial?,
            theta,
            angle_to_axis: atan2(axis.cross(&momentum).norm(), axis.dot(&momentum)),
            sense: 1.0,
        };
        let shortening = if state.horizontal > 0.0 {
            torque.dot(&horizontal) / state.horizontal
        } else {
            0.0
        };
        let is_known = state.angle_to_axis.is_finite() && shortening.is_finite();
        is_known.then_some((state, shortening))
    }

    /// `None` without a free peg, or if the angular momentum is vertical.
    fn lever(&self) -> Option<ImpactLever> {
        let momentum = self.central_momentum?;
        Some(ImpactLever {
            to_peg: self.peg_position? - self.center?,
            direction: Vector3::new(momentum.x, momentum.y, 0.0).try_normalize(0.0)?,
        })
    }
}

/// A vector of the node frame (line of nodes, n × e_N, n) in the world frame.
fn world_from_node(vector: Vector3<f64>, phi: f64, axis: Vector3<f64>) -> Vector3<f64> {
    let (sin, cos) = sin_cos(phi);
    let nodes = Vector3::new(cos, sin, 0.0);
    vector.x * nodes + vector.y * axis.cross(&nodes) + vector.z * axis
}
