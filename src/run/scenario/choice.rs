//! String values of choice keys.

use crate::physics::friction::Dissipation;

/// Integration variables (`formulation`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormulationKind {
    /// Euler angles: [`crate::physics::dynamics::EulerAngles`].
    Euler,
    /// Rotation and angular momentum: [`crate::physics::dynamics::BodyRotation`].
    Body,
}

/// The values of `friction.dissipation`, with their meanings.
const MEANINGS: [(&str, Dissipation); 6] = [
    ("full", Dissipation::Full),
    ("without-nutation-part", Dissipation::WithoutNutationPart),
    ("precession-term-only", Dissipation::PrecessionTermOnly),
    ("spin-term-only", Dissipation::SpinTermOnly),
    ("tilt-torque-only", Dissipation::TiltTorqueOnly),
    ("spin-torque-only", Dissipation::SpinTorqueOnly),
];

/// The values of `friction.dissipation`, for the table of keys.
pub(super) const DISSIPATIONS: &[&str] = &{
    let mut words = [""; MEANINGS.len()];
    let mut i = 0;
    while i < words.len() {
        words[i] = MEANINGS[i].0;
        i += 1;
    }
    words
};

/// The meaning of a value of `friction.dissipation`.
pub(super) fn dissipation(word: &str) -> Option<Dissipation> {
    let meaning = MEANINGS.iter().find(|(known, _)| *known == word);
    meaning.map(|(_, dissipation)| *dissipation)
}
