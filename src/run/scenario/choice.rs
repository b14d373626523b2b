//! Words of scenarios: the values of keys of [`Kind::Choice`](super::key::Kind::Choice).

use crate::physics::friction::Dissipation;
use crate::run::listed::listed;

listed! {
    /// Integration variables (`formulation`).
    pub enum FormulationKind {
        /// Euler angles: [`crate::physics::dynamics::EulerAngles`].
        Euler = "euler",
        /// Rotation and angular momentum: [`crate::physics::dynamics::BodyRotation`].
        Body = "body",
    }
}

listed! {
    /// Support of the peg (`support.kind`).
    pub enum SupportKind {
        /// The peg's centre is fixed.
        Fixed = "fixed",
        /// The peg moves on the table.
        Free = "free",
    }
}

listed! {
    /// Consequence of a contact point that sticks (`stop.on_stick`).
    pub enum OnStick {
        /// The run stops.
        Stop = "stop",
        /// The run continues.
        Continue = "continue",
    }
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
    // A loop, because iterators don't work in constants.
    let mut words = [""; MEANINGS.len()];
    let mut i = 0;
    while i < words.len() {
        words[i] = MEANINGS[i].0;
        i += 1;
    }
    words
};

/// The meaning of a value of `friction.dissipation`.
pub(crate) fn find_dissipation(word: &str) -> Option<Dissipation> {
    MEANINGS
        .into_iter()
        .find_map(|(known, dissipation)| (known == word).then_some(dissipation))
}
