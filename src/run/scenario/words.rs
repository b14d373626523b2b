//! The words with which a scenario makes its choices, each with its meaning.

use crate::physics::friction::Dissipation;

/// A choice that a scenario makes with a word.
pub(super) trait Words: Copy + 'static {
    /// Every word with its meaning, in the order in which they are listed.
    const WORDS: &'static [(&'static str, Self)];

    /// The meaning of a word.
    fn of_word(word: &str) -> Option<Self> {
        let found = Self::WORDS.iter().find(|(known, _)| *known == word);
        found.map(|(_, meaning)| *meaning)
    }
}

/// The variables in which the motion is integrated: `formulation`.
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
    /// Ends there.
    Stop,
    /// Goes on with a contact point that sticks, or slips again.
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

/// The words of a choice, for the table of keys.
const fn words<T: Words, const N: usize>() -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = T::WORDS[i].0;
        i += 1;
    }
    words
}
