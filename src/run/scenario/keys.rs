//! The table of everything that a scenario says: one row per key.

use super::laws::SLIDING;
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
    /// Exactly when this other key is there.
    Beside(&'static str),
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
use Presence::{Beside, Optional, Required, With};

/// Of slip that sets a scale.
const SPEED: Kind = Between(1e-9, 1e6);

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
    key("friction.law", "", Choice(SLIDING), Required, "law of friction at the contact"),
    key("friction.k", "", Between(0.0, 100.0), With("friction.law", SLIDING.split_at(1).1),
        "coefficient of friction k"),
    key("friction.static_k", "", Between(0.0, 100.0), With("friction.law", &["stribeck"]),
        "coefficient of static friction k_s"),
    key("friction.smoothing_speed", "m/s", SPEED,
        With("friction.law", &["coulomb-sqrt", "coulomb-tanh", "coulomb-rational"]),
        "slip speed v_ε below which the force fades"),
    key("friction.viscous_speed", "m/s", SPEED, With("friction.law", &["viscous"]),
        "slip speed v_0 at which the force is k N"),
    key("friction.stribeck_speed", "m/s", SPEED, With("friction.law", &["stribeck"]),
        "slip speed v_s over which static friction falls to kinetic"),
    key("friction.viscous_slope", "s/m", Between(0.0, 100.0), With("friction.law", &["stribeck"]),
        "growth c_v of the coefficient with the slip speed"),
    key("friction.patch_radius", "m", Between(1e-9, 1.0), With("friction.law", &["contensou"]),
        "radius a of the patch of contact"),
    key("friction.dissipation", "",
        Choice(&["full", "without-nutation-part", "precession-term-only", "spin-term-only",
            "tilt-torque-only", "spin-torque-only"]),
        With("friction.law", SLIDING.split_at(1).1), "which parts of the friction torque act"),
    key("rolling.arm", "m", Between(0.0, 1.0), Optional, "arm δ of rolling resistance"),
    key("drilling.k", "", Between(0.0, 100.0), Optional, "coefficient k of drilling friction"),
    key("drilling.patch_radius", "m", Between(1e-9, 1.0), Beside("drilling.k"),
        "radius a of the patch of contact that drills"),
    key("air.axial", "N m s", Between(0.0, 1.0), Optional,
        "drag c_n of the air per angular velocity along the symmetry axis"),
    key("air.transverse", "N m s", Between(0.0, 1.0), Optional,
        "drag c_t of the air per angular velocity across the symmetry axis"),
    key("air.disc", "N m s^(3/2)", Between(0.0, 1.0), Optional,
        "drag c of the air on a disc, along the symmetry axis"),
    key("integrator.relative_tolerance", "", Between(1e-14, 1e-2), Required,
        "local error per step, relative"),
    key("integrator.absolute_tolerance", "", Between(1e-18, 1e-2), Required,
        "local error per step, absolute, in the units of the state"),
    key("sampling.period", "s", Nanoseconds, Required, "time between samples"),
    key("stop.theta_risen", "rad", Between(1e-6, PI), Optional, "stop when θ falls to this: risen"),
    key("stop.theta_fallen", "rad", Between(1e-6, PI), Optional, "stop when θ grows to this: fallen"),
    key("stop.on_stick", "", Choice(&["stop", "continue"]), Optional,
        "whether to stop when the contact point sticks; \"stop\" if left out"),
    key("stop.duration", "s", Between(0.0, 1e6), Optional, "stop at this time"),
];
