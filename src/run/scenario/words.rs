//! String values of choice keys.

use crate::physics::friction::Dissipation;

/// An enum with string values in scenarios.
pub(super) trait Words: Copy + 'static {
    /// All names with their variants, in listing order.
    const WORDS: &'static [(&'static str, Self)];

    /// The variant with this name.
    fn of_word(word: &str) -> Option<Self> {
        let found = Self::WORDS.iter().find(|(known, _)| *known == word);
        found.map(|(_, meaning)| *meaning)
    }
}

/// Integration variables (`formulation`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormulationKind {
    /// Euler angles: [`crate::physics::dynamics::EulerAngles`].
    Euler,
    /// Rotation and angular momentum: [`crate::physics::dynamics::BodyRotation`].
    Body,
}

impl Words for FormulationKind {
    const WORDS: &'static [(&'static str, Self)] = &[("euler", Self::Euler), ("body", Self::Body)];
}

/// Action when the contact point stops slipping: `stop.on_stick`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnStick {
    /// Stop the run.
    Stop,
    /// Continue the run; the contact point may slip again.
    Continue,
}

impl Words for OnStick {
    const WORDS: &'static [(&'static str, Self)] =
        &[("stop", Self::Stop), ("continue", Self::Continue)];
}

/// Support of the peg: `support.kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SupportKind {
    Fixed,
    Free,
}

impl Words for SupportKind {
    const WORDS: &'static [(&'static str, Self)] = &[("fixed", Self::Fixed), ("free", Self::Free)];
}

impl Words for Dissipation {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("full", Self::Full),
        ("without-nutation-part", Self::WithoutNutationPart),
        ("precession-term-only", Self::PrecessionTermOnly),
        ("spin-term-only", Self::SpinTermOnly),
        ("tilt-torque-only", Self::TiltTorqueOnly),
        ("spin-torque-only", Self::SpinTorqueOnly),
    ];
}

pub(super) const FORMULATIONS: &[&str] =
    &words::<FormulationKind, { FormulationKind::WORDS.len() }>();
pub(super) const ON_STICK: &[&str] = &words::<OnStick, { OnStick::WORDS.len() }>();
pub(super) const SUPPORTS: &[&str] = &words::<SupportKind, { SupportKind::WORDS.len() }>();
pub(super) const DISSIPATIONS: &[&str] = &words::<Dissipation, { Dissipation::WORDS.len() }>();

/// The names of a choice, for the table of keys.
const fn words<T: Words, const N: usize>() -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = T::WORDS[i].0;
        i += 1;
    }
    words
}
