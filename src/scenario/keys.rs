//! The table of everything that a scenario says: one row per key.

use std::f64::consts::PI;
use std::fmt;

/// What a scenario says under one key.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A name, a choice or a text.
    Text(String),
    /// A number in SI units or radians.
    Number(f64),
}

impl fmt::Display for Value {
    /// As TOML.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => write!(f, "{}", toml::Value::from(text.as_str())),
            Self::Number(number) => write!(f, "{number:?}"),
        }
    }
}

/// Which values a key takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Any text.
    Text,
    /// A word that can be part of a file's name.
    Name,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Any finite number.
    Any,
    /// A finite number larger than 0.
    Positive,
    /// A finite number not less than the first and not larger than the second.
    Between(f64, f64),
    /// A whole number of nanoseconds from 1 ns to one hour, in seconds.
    Nanoseconds,
}

impl Kind {
    /// Whether the values are texts; otherwise they are numbers.
    #[must_use]
    pub fn is_text(self) -> bool {
        matches!(self, Self::Text | Self::Name | Self::Choice(_))
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text => write!(f, "a text"),
            Self::Name => write!(
                f,
                "a name of letters, digits, '-', '_' and '.', not beginning with '.'"
            ),
            Self::Choice(words) => write!(f, "one of {}", words.join(", ")),
            Self::Any => write!(f, "a finite number"),
            Self::Positive => write!(f, "a finite number > 0"),
            Self::Between(low, high) => write!(f, "a number from {low:?} to {high:?}"),
            Self::Nanoseconds => write!(f, "a whole number of nanoseconds from 1e-9 to 3600 s"),
        }
    }
}

/// When a scenario has to, or may, have a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// Always.
    Required,
    /// It may be left out.
    Optional,
    /// Exactly when another key has one of these values.
    With(&'static str, &'static [&'static str]),
}

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The section and name, as in `top.mass`; a name alone stands before the first section.
    pub path: &'static str,
    /// Unit, empty where there is none.
    pub unit: &'static str,
    /// Allowed values.
    pub kind: Kind,
    /// When it is there.
    pub presence: Presence,
    /// What it means.
    pub meaning: &'static str,
}

const fn key(
    path: &'static str,
    unit: &'static str,
    kind: Kind,
    presence: Presence,
    meaning: &'static str,
) -> Key {
    Key {
        path,
        unit,
        kind,
        presence,
        meaning,
    }
}

use Kind::{Any, Between, Choice, Name, Nanoseconds, Positive, Text};
use Presence::{Optional, Required, With};

/// The scenario format that this version writes and reads.
pub const FORMAT: &str = "toprise-1";

/// Every key, in the order in which a scenario is written.
#[rustfmt::skip]
pub const KEYS: &[Key] = &[
    key("format", "", Choice(&[FORMAT]), Optional, "version of this format"),
    key("name", "", Name, Required, "names the recordings"),
    key("description", "", Text, Optional, "a sentence for people"),
    key("formulation", "", Choice(&["euler", "body"]), Required,
        "variables of integration: Euler angles (singular upright), or rotation of the body"),
    key("gravity", "m/s²", Positive, Required, "acceleration of gravity g"),
    key("top.mass", "kg", Positive, Required, "mass M"),
    key("top.transverse_moment", "kg m²", Positive, Required,
        "transverse moment of inertia I_x about the peg's centre"),
    key("top.axial_moment", "kg m²", Positive, Required, "axial moment of inertia I_z"),
    key("top.center_distance", "m", Positive, Required,
        "distance l from the peg's centre to the centre of mass"),
    key("top.peg_radius", "m", Positive, Required, "radius R of the spherical peg"),
    key("initial.phi", "rad", Any, Required, "precession angle φ"),
    key("initial.theta", "rad", Between(0.0, PI), Required, "nutation angle (inclination) θ"),
    key("initial.psi", "rad", Any, Required, "spin angle ψ"),
    key("initial.phi_dot", "rad/s", Between(-1e6, 1e6), Required, "precession rate φ̇"),
    key("initial.theta_dot", "rad/s", Between(-1e6, 1e6), Required, "nutation rate θ̇"),
    key("initial.psi_dot", "rad/s", Between(-1e6, 1e6), Required, "spin rate ψ̇"),
    key("friction.law", "", Choice(&["none", "coulomb"]), Required, "law of friction at the contact"),
    key("friction.k", "", Between(0.0, 100.0), With("friction.law", &["coulomb"]),
        "coefficient of friction k"),
    key("friction.dissipation", "",
        Choice(&["full", "without-nutation-part", "precession-term-only", "spin-term-only"]),
        With("friction.law", &["coulomb"]), "which parts of the friction torque act"),
    key("integrator.relative_tolerance", "", Between(1e-14, 1e-2), Required,
        "local error per step, relative"),
    key("integrator.absolute_tolerance", "", Between(1e-18, 1e-2), Required,
        "local error per step, absolute, in the units of the state"),
    key("sampling.period", "s", Nanoseconds, Required, "time between samples"),
    key("stop.theta_risen", "rad", Between(1e-6, PI), Optional, "stop when θ falls to this: risen"),
    key("stop.theta_fallen", "rad", Between(1e-6, PI), Optional, "stop when θ grows to this: fallen"),
    key("stop.duration", "s", Between(0.0, 1e6), Optional, "stop at this time"),
];
