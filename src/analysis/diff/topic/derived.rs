//! Differences of the state that no single field contains: angles between directions, and ω·n.

use super::field::{FieldDifference, FieldTally};
use crate::analysis::diff::tolerance::{Tolerance, Tolerances, full_name};
use crate::physics::math::{atan2, cos, sin, unwrap_near};
use crate::telemetry::Message;
use crate::telemetry::fields::{NumberField, STATE, state};
use nalgebra::Vector3;

/// The angle between the axes, in `/top/state`.
pub(in crate::analysis::diff) const AXIS_ANGLE: &str = "angle between axes";
/// The component of the angular velocity along the symmetry axis. Unlike its parts φ̇ cos θ and ψ̇, it is defined where the
/// axis is vertical, and the nutation leaves it alone.
pub(in crate::analysis::diff) const AXIAL_SPIN: &str = "ω·n";

/// The way in which a difference is derived.
#[derive(Clone, Copy, Debug)]
enum Derivation {
    /// The angle from A's message to B's, rad.
    Angle(fn(&Message<'_>, &Message<'_>) -> f64),
    /// The difference of a number of both, rad/s.
    Rate(fn(&Message<'_>) -> f64),
}

/// A kind of derived difference.
struct DerivedKind {
    name: &'static str,
    /// The fields that it is derived from.
    sources: fn() -> Vec<NumberField>,
    derivation: Derivation,
}

/// The derived differences of `/top/state`.
static KINDS: [DerivedKind; 4] = [
    DerivedKind {
        name: "φ modulo 2π",
        sources: || vec![state::PHI],
        derivation: Derivation::Angle(|a, b| turn(state::PHI, a, b)),
    },
    DerivedKind {
        name: "ψ as a direction",
        sources: || vec![state::PSI],
        derivation: Derivation::Angle(|a, b| turn(state::PSI, a, b)),
    },
    DerivedKind {
        name: AXIS_ANGLE,
        sources: || vec![state::THETA, state::PHI],
        derivation: Derivation::Angle(|a, b| between_directions(&axis(a), &axis(b))),
    },
    DerivedKind {
        name: AXIAL_SPIN,
        sources: || vec![state::THETA, state::PHI_DOT, state::PSI_DOT],
        derivation: Derivation::Rate(axial_spin),
    },
];

/// The direction of the symmetry axis.
fn axis(message: &Message<'_>) -> Vector3<f64> {
    let (theta, phi) = (state::THETA.of(message), state::PHI.of(message));
    // The paper counts φ from the line of nodes; a common turn about the vertical changes no angle.
    Vector3::new(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta))
}

pub(in crate::analysis::diff) fn axial_spin(message: &Message<'_>) -> f64 {
    let theta = state::THETA.of(message);
    state::PHI_DOT.of(message) * cos(theta) + state::PSI_DOT.of(message)
}

/// The angle between two directions in a plane, ignoring whole turns.
fn turn(field: NumberField, a: &Message<'_>, b: &Message<'_>) -> f64 {
    unwrap_near(field.of(b) - field.of(a), 0.0)
}

fn between_directions(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    atan2(a.cross(b).norm(), a.dot(b))
}

/// A derived difference.
///
/// It has no tolerance of its own: it is beyond the tolerance where a field that it is derived from is.
#[derive(Clone, Debug)]
pub(super) struct Derived {
    name: &'static str,
    /// The fields that it is derived from, with their tolerances.
    sources: Vec<(NumberField, Tolerance)>,
    derivation: Derivation,
    tally: FieldTally,
}

impl Derived {
    /// The derived numbers of `/top/state`.
    pub(super) fn of_state(tolerances: &Tolerances) -> Vec<Self> {
        let mut derived = Vec::new();
        for kind in &KINDS {
            let mut sources = Vec::new();
            for field in (kind.sources)() {
                sources.push((field, tolerances.for_field(STATE.name(), field.path())));
            }
            let first = sources.first().map(|(_, tolerance)| *tolerance);
            derived.push(Self {
                name: kind.name,
                sources,
                derivation: kind.derivation,
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
        let is_beyond = self
            .sources
            .iter()
            .any(|(field, tolerance)| !tolerance.allows(field.of(a), field.of(b)));
        let numbers = match self.derivation {
            Derivation::Angle(angle) => [0.0, angle(a, b)],
            Derivation::Rate(number) => [number(a), number(b)],
        };
        self.tally.add_derived(a.time_ns, numbers, is_beyond);
    }

    /// The name with that of the topic.
    pub(super) fn full_name(&self) -> String {
        full_name(STATE.name(), self.name)
    }

    /// The largest difference.
    pub(super) fn largest(&self) -> f64 {
        self.tally.found.largest.abs()
    }

    /// The differences so far.
    pub(super) fn report(&self, integration_error: Option<f64>) -> FieldDifference {
        let (unit, is_angle) = match self.derivation {
            Derivation::Angle(_) => ("rad", true),
            Derivation::Rate(_) => ("rad/s", false),
        };
        let report = self.tally.report(self.name, unit, integration_error);
        FieldDifference {
            is_derived: true,
            // An angle between two directions is a difference without numbers of A and B.
            scale: if is_angle { 0.0 } else { report.scale },
            values: report.values.filter(|_| !is_angle),
            ..report
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let right = between_directions(&Vector3::x(), &(2.0 * Vector3::z()));
        assert_near(right, FRAC_PI_2);
    }
}
