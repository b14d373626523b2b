//! Angles between two directions or orientations, which no single field contains.

use super::field::{FieldDifference, FieldTally};
use crate::analysis::diff::tolerance::{Tolerance, Tolerances};
use crate::physics::math::{atan2, unwrap_near};
use crate::telemetry::fields::{NumberField, POSE, STATE, pose, state};
use crate::telemetry::{Message, Topic};
use nalgebra::{Quaternion, Vector3};

/// The angle from A's message to B's, rad.
type Angle = fn(&Message<'_>, &Message<'_>) -> f64;

/// A kind of derived difference.
struct DerivedKind {
    topic: Topic,
    name: &'static str,
    /// The fields that it is derived from.
    sources: fn() -> Vec<NumberField>,
    angle: Angle,
}

/// The angles of topics.
static ANGLES: [DerivedKind; 4] = [
    DerivedKind {
        topic: STATE,
        name: "φ modulo 2π",
        sources: || vec![state::PHI],
        angle: |a, b| turn(state::PHI, a, b),
    },
    DerivedKind {
        topic: STATE,
        name: "ψ as a direction",
        sources: || vec![state::PSI],
        angle: |a, b| turn(state::PSI, a, b),
    },
    DerivedKind {
        topic: POSE,
        name: "angle between orientations",
        sources: || pose::ORIENTATION.components().to_vec(),
        angle: |a, b| between_orientations(pose::ORIENTATION.of(a), pose::ORIENTATION.of(b)),
    },
    DerivedKind {
        topic: POSE,
        name: "angle between axes",
        sources: || pose::AXIS.components().to_vec(),
        angle: |a, b| between_directions(&pose::AXIS.of(a), &pose::AXIS.of(b)),
    },
];

/// The angle between two directions in a plane, ignoring whole turns.
fn turn(field: NumberField, a: &Message<'_>, b: &Message<'_>) -> f64 {
    unwrap_near(field.of(b) - field.of(a), 0.0)
}

fn between_orientations(a: Quaternion<f64>, b: Quaternion<f64>) -> f64 {
    // A quaternion and its negative are one orientation. The arc cosine would lose small angles.
    let turn = a.conjugate() * b;
    2.0 * atan2(turn.imag().norm(), turn.scalar().abs())
}

fn between_directions(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    atan2(a.cross(b).norm(), a.dot(b))
}

/// A derived difference: the angle between two directions or orientations.
///
/// It has no tolerance of its own: an angle is beyond the tolerance where a field that it is derived from is.
#[derive(Clone, Debug)]
pub(super) struct Derived {
    name: &'static str,
    /// The fields that it is derived from, with their tolerances.
    sources: Vec<(NumberField, Tolerance)>,
    angle: Angle,
    tally: FieldTally,
}

impl Derived {
    /// The derived numbers of a topic.
    pub(super) fn for_topic(topic: Topic, tolerances: &Tolerances) -> Vec<Self> {
        let mut derived = Vec::new();
        for kind in ANGLES.iter().filter(|kind| kind.topic == topic) {
            let mut sources = Vec::new();
            for field in (kind.sources)() {
                sources.push((field, tolerances.for_field(topic.name(), field.path())));
            }
            let first = sources.first().map(|(_, tolerance)| *tolerance);
            derived.push(Self {
                name: kind.name,
                sources,
                angle: kind.angle,
                tally: FieldTally::new(first.unwrap_or_default()),
            });
        }
        derived
    }

    /// The fields that it is derived from.
    pub(super) fn sources(&self) -> impl Iterator<Item = &NumberField> {
        self.sources.iter().map(|(field, _)| field)
    }

    /// Adds a pair of messages.
    pub(super) fn add(&mut self, a: &Message<'_>, b: &Message<'_>) {
        // Recorded quaternions are of unit length only within rounding, so that equal ones would have a tiny angle.
        let is_same = a.numbers == b.numbers;
        let angle = if is_same { 0.0 } else { (self.angle)(a, b) };
        let is_beyond = !is_same
            && self
                .sources
                .iter()
                .any(|(field, tolerance)| !tolerance.allows(field.of(a), field.of(b)));
        self.tally.add_derived(a.time_ns, angle, is_beyond);
    }

    /// The differences so far.
    pub(super) fn report(&self) -> FieldDifference {
        FieldDifference {
            is_derived: true,
            scale: 0.0,
            ..self.tally.report(self.name, "rad", None)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::kinematics::{Euler, world_from_body};
    use std::f64::consts::{FRAC_PI_2, PI};

    fn assert_near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found}");
    }

    #[test]
    fn angles_ignore_whole_turns() {
        let of_phi = |phi: f64| {
            let mut numbers = vec![0.0; STATE.numbers().count()];
            numbers[state::PHI.index()] = phi;
            numbers
        };
        let [a, b] = [0.1, 0.3 + 20.0 * PI].map(of_phi);
        let [a, b] = [&a, &b].map(|numbers| Message {
            channel: STATE.index(),
            sequence: 0,
            time_ns: 0,
            numbers,
            texts: &[],
        });
        assert_near(turn(state::PHI, &a, &b), 0.2);
        let turned = world_from_body(Euler {
            phi: 0.4,
            theta: 0.0,
            psi: 0.0,
        });
        assert_near(
            between_orientations(Quaternion::identity(), -turned.into_inner()),
            0.4,
        );
        let right = between_directions(&Vector3::x(), &(2.0 * Vector3::z()));
        assert_near(right, FRAC_PI_2);
    }
}
