//! String values of choice keys.

use crate::physics::friction::Dissipation;

/// An enum with string values in scenarios.
pub(super) trait Choice: Copy + 'static {
    /// All names with their variants, in listing order.
    const NAMES: &'static [(&'static str, Self)];

    /// The variant with this name.
    fn from_name(word: &str) -> Option<Self> {
        let found = Self::NAMES.iter().find(|(known, _)| *known == word);
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

impl Choice for FormulationKind {
    const NAMES: &'static [(&'static str, Self)] = &[("euler", Self::Euler), ("body", Self::Body)];
}

/// Action when the contact point stops slipping: `stop.on_stick`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnStick {
    /// Stop the run.
    Stop,
    /// Continue the run; the contact point may slip again.
    Continue,
}

impl Choice for OnStick {
    const NAMES: &'static [(&'static str, Self)] =
        &[("stop", Self::Stop), ("continue", Self::Continue)];
}

/// Support of the peg: `support.kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SupportKind {
    Fixed,
    Free,
}

impl Choice for SupportKind {
    const NAMES: &'static [(&'static str, Self)] = &[("fixed", Self::Fixed), ("free", Self::Free)];
}

impl Choice for Dissipation {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("full", Self::Full),
        ("without-nutation-part", Self::WithoutNutationPart),
        ("precession-term-only", Self::PrecessionTermOnly),
        ("spin-term-only", Self::SpinTermOnly),
        ("tilt-torque-only", Self::TiltTorqueOnly),
        ("spin-torque-only", Self::SpinTorqueOnly),
    ];
}

pub(super) const FORMULATIONS: &[&str] =
    &names::<FormulationKind, { FormulationKind::NAMES.len() }>();
pub(super) const ON_STICK: &[&str] = &names::<OnStick, { OnStick::NAMES.len() }>();
pub(super) const SUPPORTS: &[&str] = &names::<SupportKind, { SupportKind::NAMES.len() }>();
pub(super) const DISSIPATIONS: &[&str] = &names::<Dissipation, { Dissipation::NAMES.len() }>();

/// The names of a choice, for the table of keys.
const fn names<T: Choice, const N: usize>() -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = T::NAMES[i].0;
        i += 1;
    }
    names
}
