//! Angles between two directions or orientations, which no single field contains.

use super::field::{FieldDifference, FieldTally};
use super::tolerance::Tolerance;
use crate::physics::math::{atan2, unwrap_near};
use crate::telemetry::Topic;
use crate::telemetry::fields::{self, NumberField, pose, state};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// A derived difference: the angle between two directions or orientations.
#[derive(Clone, Debug)]
pub(super) struct Derived {
    name: &'static str,
    kind: DerivedKind,
    tally: FieldTally,
}

/// Kinds of derived differences, with their source columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum DerivedKind {
    /// The angle between two directions in a plane, ignoring whole turns.
    Direction(usize),
    /// The angle between two orientations (x, y, z, w).
    Orientation([usize; 4]),
    /// The angle between two vectors.
    Between([usize; 3]),
}

impl DerivedKind {
    /// The angle from A's to B's, rad.
    fn difference(self, a: &[f64], b: &[f64]) -> f64 {
        match self {
            Self::Direction(at) => unwrap_near(b[at] - a[at], 0.0),
            Self::Orientation(at) => {
                let of = |row: &[f64]| {
                    let [x, y, z, w] = at.map(|at| row[at]);
                    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
                };
                let turn = of(a).conjugate() * of(b);
                2.0 * atan2(turn.imag().norm(), turn.scalar().abs())
            }
            Self::Between(at) => {
                let of = |row: &[f64]| Vector3::from(at.map(|at| row[at]));
                let (a, b) = (of(a), of(b));
                atan2(a.cross(&b).norm(), a.dot(&b))
            }
        }
    }
}

impl Derived {
    /// The derived numbers of a topic.
    pub(super) fn of(topic: Topic) -> Vec<Self> {
        let direction = |name, field: NumberField| (name, DerivedKind::Direction(field.index()));
        let kinds = match topic {
            fields::STATE => vec![
                direction("φ modulo 2π", state::PHI),
                direction("ψ as a direction", state::PSI),
            ],
            fields::POSE => {
                let of = pose::ORIENTATION.components().map(NumberField::index);
                let axis = pose::AXIS.components().map(NumberField::index);
                vec![
                    ("angle between orientations", DerivedKind::Orientation(of)),
                    ("angle between axes", DerivedKind::Between(axis)),
                ]
            }
            _ => Vec::new(),
        };
        let derived = |(name, kind)| Self {
            name,
            kind,
            tally: FieldTally::new(Tolerance::default()),
        };
        kinds.into_iter().map(derived).collect()
    }

    /// Adds the numbers of a pair.
    pub(super) fn add(&mut self, time_ns: u64, a: &[f64], b: &[f64]) {
        let difference = if a == b {
            0.0
        } else {
            self.kind.difference(a, b)
        };
        self.tally.add(time_ns, 0.0, difference);
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

    #[test]
    fn directions_and_orientations_don_t_count_turns() {
        let near = |kind: DerivedKind, a: &[f64], b: &[f64], expected: f64| {
            let found = kind.difference(a, b);
            assert!((found - expected).abs() < 1e-12, "{kind:?}: {found}");
        };
        near(
            DerivedKind::Direction(0),
            &[0.1],
            &[0.3 + 20.0 * std::f64::consts::PI],
            0.2,
        );
        let turned =
            crate::physics::kinematics::world_from_body(crate::physics::kinematics::Euler {
                phi: 0.4,
                theta: 0.0,
                psi: 0.0,
            });
        let c = turned.coords;
        near(
            DerivedKind::Orientation([0, 1, 2, 3]),
            &[0.0, 0.0, 0.0, 1.0],
            &[-c.x, -c.y, -c.z, -c.w],
            0.4,
        );
        near(
            DerivedKind::Between([0, 1, 2]),
            &[1.0, 0.0, 0.0],
            &[0.0, 0.0, 2.0],
            0.5 * std::f64::consts::PI,
        );
    }
}
