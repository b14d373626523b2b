//! The words with which a scenario makes its choices, each beside what it means.

use crate::physics::friction::Dissipation;

/// A choice that a scenario makes with a word.
pub(super) trait Words: Copy + 'static {
    /// Every word with its meaning, in the order in which people are told of them.
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

/// What a run does when the contact point stops slipping: `stop.on_stick`.
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

/// How the table holds the peg: `support.kind`.
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

/// Laws of sliding friction, before their parameters are known: `friction.law`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SlidingLaw {
    None,
    Coulomb,
    CoulombSqrt,
    CoulombTanh,
    CoulombRational,
    Viscous,
    Stribeck,
    Contensou,
}

impl SlidingLaw {
    /// Its word, for the tables that name single laws.
    pub(super) const fn word(self) -> &'static str {
        // In the order of the enum; a test looks each law up.
        Self::WORDS[self as usize].0
    }
}

impl Words for SlidingLaw {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("none", Self::None),
        ("coulomb", Self::Coulomb),
        ("coulomb-sqrt", Self::CoulombSqrt),
        ("coulomb-tanh", Self::CoulombTanh),
        ("coulomb-rational", Self::CoulombRational),
        ("viscous", Self::Viscous),
        ("stribeck", Self::Stribeck),
        ("contensou", Self::Contensou),
    ];
}

pub(super) const FORMULATIONS: &[&str] =
    &words::<FormulationKind, { FormulationKind::WORDS.len() }>();
pub(super) const ON_STICK: &[&str] = &words::<OnStick, { OnStick::WORDS.len() }>();
pub(super) const SUPPORTS: &[&str] = &words::<SupportKind, { SupportKind::WORDS.len() }>();
pub(super) const DISSIPATIONS: &[&str] = &words::<Dissipation, { Dissipation::WORDS.len() }>();
pub(super) const SLIDING_LAWS: &[&str] = &words::<SlidingLaw, { SlidingLaw::WORDS.len() }>();
/// The laws of sliding that give a force: all but `none`.
pub(super) const ACTING_LAWS: &[&str] = SLIDING_LAWS.split_at(1).1;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_law_has_the_word_that_means_it() {
        for (word, law) in SlidingLaw::WORDS {
            assert_eq!(law.word(), *word);
        }
    }
}
