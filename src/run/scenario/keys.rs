//! The table of scenario keys.

use super::choice::{DISSIPATIONS, FormulationKind, OnStick, SupportKind};
use super::key::Key;
use super::key::Kind::{self, Any, Between, Choice, Formula, Name, Nanoseconds, Text};
use super::key::Presence::{
    self, OfLaws, Optional, OptionalWith, Parameter, Required, RequiredWith, RequiredWithKey,
};
use super::laws::{FORMULA, FRICTIONAL_LAWS, Law, SLIDING_LAWS};
use std::f64::consts::PI;

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
        label: meaning,
        symbol: None,
        typical: None,
        default: None,
    }
}

/// Range of masses and moments of inertia; products of several such values don't overflow.
const INERTIA: Kind = Between(1e-30, 1e30);
/// Range of lengths of the top, and of gravity.
const SCALE: Kind = Between(1e-15, 1e15);
/// Range of slip speed parameters.
const SPEED: Kind = Between(1e-9, 1e6);

/// Range of the parameters of a formula, in the units that it gives them.
const PARAMETER: Kind = Between(-1e6, 1e6);

const SMOOTH_LAWS: &[&str] = &["coulomb-sqrt", "coulomb-tanh", "coulomb-rational"];

/// Presence of keys that apply only to a free peg.
const FREE: Presence = OptionalWith("support.kind", &["free"]);

/// The scenario format that this version writes and reads.
pub const FORMAT: &str = "toprise-1";

/// All keys, in the order of scenario files.
#[rustfmt::skip]
pub const KEYS: &[Key] = &[
    key("format", "", Choice(&[FORMAT]), Optional, "version of this format"),
    key("name", "", Name, Required, "name of the scenario and, by default, of its recordings"),
    key("description", "", Text, Optional, "human-readable description"),
    key("formulation", "", Choice(FormulationKind::NAMES), Required,
        "integration variables: Euler angles (singular when upright) or rotation of the body"),
    key("gravity", "m/s²", SCALE, Required, "gravitational acceleration g").named("gravitational acceleration").typically(0.5, 25.0).denoted("g"),
    key("top.mass", "kg", INERTIA, Required, "mass M").named("mass").typically(0.01, 1.0).denoted("M"),
    key("top.transverse_moment", "kg m²", INERTIA, Required,
        "transverse moment of inertia I_x about the peg's centre").named("transverse moment of inertia about the peg's centre").typically(1e-6, 1e-2).denoted("I_x"),
    key("top.axial_moment", "kg m²", INERTIA, Required, "axial moment of inertia I_z").named("axial moment of inertia").typically(1e-6, 1e-2).denoted("I_z"),
    key("top.center_distance", "m", Between(-1e15, 1e15), Required,
        "distance l from the peg's centre to the centre of mass; may be negative (tippe top) if the peg is free").named("distance from the peg's centre to the centre of mass").typically(-0.05, 0.1).denoted("l"),
    key("top.peg_radius", "m", SCALE, Required, "radius R of the spherical peg").named("radius of the spherical peg").typically(0.0001, 0.05).denoted("R"),
    key("initial.phi", "rad", Any, Required, "precession angle φ").named("precession angle").typically(-PI, PI).denoted("φ"),
    key("initial.theta", "rad", Between(0.0, PI), Required, "nutation angle (inclination) θ").named("nutation angle").typically(0.0, 1.5).denoted("θ"),
    key("initial.psi", "rad", Any, Required, "spin angle ψ").named("spin angle").typically(-PI, PI).denoted("ψ"),
    key("initial.phi_dot", "rad/s", Between(-1e6, 1e6), Required, "precession rate φ̇").named("precession rate").typically(-50.0, 50.0).denoted("φ̇"),
    key("initial.theta_dot", "rad/s", Between(-1e6, 1e6), Required, "nutation rate θ̇").named("nutation rate").typically(-20.0, 20.0).denoted("θ̇"),
    key("initial.psi_dot", "rad/s", Between(-1e6, 1e6), Required, "spin rate ψ̇").named("spin rate").typically(-300.0, 300.0).denoted("ψ̇"),
    key("initial.height", "m", Between(0.0, 1e3), FREE, "height of the peg above the table; default 0").named("height of the peg above the table").typically(0.0, 0.02),
    key("initial.peg_x", "m", Between(-1e6, 1e6), FREE, "position of the peg's centre; default 0").named("position of the peg's centre").typically(-0.1, 0.1),
    key("initial.peg_y", "m", Between(-1e6, 1e6), FREE, "position of the peg's centre; default 0").named("position of the peg's centre").typically(-0.1, 0.1),
    key("initial.peg_x_dot", "m/s", Between(-1e3, 1e3), FREE, "velocity of the peg's centre; default 0").named("velocity of the peg's centre").typically(-1.0, 1.0),
    key("initial.peg_y_dot", "m/s", Between(-1e3, 1e3), FREE, "velocity of the peg's centre; default 0").named("velocity of the peg's centre").typically(-1.0, 1.0),
    key("initial.peg_z_dot", "m/s", Between(-1e3, 1e3), FREE, "velocity of the peg's centre, upward; default 0").named("velocity of the peg's centre, upward").typically(-1.0, 1.0),
    key("initial.center_x", "m", Between(-1e6, 1e6), FREE, "position of the centre of mass, instead of the peg's").typically(-0.1, 0.1),
    key("initial.center_y", "m", Between(-1e6, 1e6), FREE, "position of the centre of mass, instead of the peg's").typically(-0.1, 0.1),
    key("initial.center_x_dot", "m/s", Between(-1e3, 1e3), FREE, "velocity of the centre of mass, instead of the peg's").typically(-1.0, 1.0),
    key("initial.center_y_dot", "m/s", Between(-1e3, 1e3), FREE, "velocity of the centre of mass, instead of the peg's").typically(-1.0, 1.0),
    key("support.kind", "", Choice(SupportKind::NAMES), Optional,
        "whether the peg's centre is fixed, or the peg free to move on the table; default \"fixed\"").or("fixed"),
    key("support.restitution", "", Between(0.0, 1.0), FREE,
        "coefficient of restitution e of impacts (Stronge's); default 0").named("coefficient of restitution of impacts").typically(0.0, 1.0).denoted("e"),
    key("friction.law", "", Choice(SLIDING_LAWS), Required, "friction law at the contact"),
    key("friction.formula", "", Formula, RequiredWith("friction.law", FORMULA),
        "coefficient of friction μ at the slip speed v in m/s"),
    key("friction.k", "", Between(0.0, 100.0), Parameter(FRICTIONAL_LAWS),
        "coefficient of friction k").named("coefficient of friction").typically(0.001, 1.0).denoted("k"),
    key("friction.a", "", PARAMETER, Parameter(FORMULA), "parameter a of the formula").named("parameter of the formula").typically(0.001, 1.0).denoted("a"),
    key("friction.b", "", PARAMETER, Parameter(FORMULA), "parameter b of the formula").named("parameter of the formula").typically(0.001, 1.0).denoted("b"),
    key("friction.c", "", PARAMETER, Parameter(FORMULA), "parameter c of the formula").named("parameter of the formula").typically(0.001, 1.0).denoted("c"),
    key("friction.d", "", PARAMETER, Parameter(FORMULA), "parameter d of the formula").named("parameter of the formula").typically(0.001, 1.0).denoted("d"),
    key("friction.static_k", "", Between(0.0, 100.0), OfLaws(&["stribeck"], FORMULA),
        "coefficient of static friction k_s").named("coefficient of static friction").typically(0.001, 1.0).denoted("k_s"),
    key("friction.smoothing_speed", "m/s", SPEED,
        RequiredWith("friction.law", SMOOTH_LAWS),
        "slip speed v_ε below which the force fades to zero").named("slip speed below which the force fades to zero").typically(0.001, 1.0).denoted("v_ε"),
    key("friction.viscous_speed", "m/s", SPEED, RequiredWith("friction.law", &["viscous"]),
        "slip speed v_0 at which the force is k N").named("slip speed at which the force is k N").typically(0.01, 10.0).denoted("v_0"),
    key("friction.stribeck_speed", "m/s", SPEED, RequiredWith("friction.law", &["stribeck"]),
        "slip speed v_s around which static friction drops to kinetic friction").named("slip speed around which static friction drops to kinetic friction").typically(0.001, 1.0).denoted("v_s"),
    key("friction.viscous_slope", "s/m", Between(0.0, 100.0), RequiredWith("friction.law", &["stribeck"]),
        "increase c_v of the coefficient per unit of slip speed").named("increase of the coefficient per unit of slip speed").typically(0.0, 0.1).denoted("c_v"),
    key("friction.patch_radius", "m", Between(1e-9, 1.0), RequiredWith("friction.law", &["contensou"]),
        "radius a of the contact patch").named("radius of the contact patch").typically(1e-5, 0.01).denoted("a"),
    key("friction.dissipation", "",
        Choice(DISSIPATIONS),
        RequiredWith("friction.law", FRICTIONAL_LAWS), "parts of the friction torque that act"),
    key("rolling.arm", "m", Between(0.0, 1.0), Optional, "arm δ of rolling resistance").named("arm of rolling resistance").typically(0.0, 0.001).denoted("δ"),
    key("drilling.k", "", Between(0.0, 100.0), Optional, "coefficient k of drilling friction").named("coefficient of drilling friction").typically(0.0, 0.5).denoted("k"),
    key("drilling.patch_radius", "m", Between(1e-9, 1.0), RequiredWithKey("drilling.k"),
        "radius a of the contact patch for drilling friction").named("radius of the contact patch for drilling friction").typically(1e-5, 0.01).denoted("a"),
    key("air.axial", "N m s", Between(0.0, 1.0), Optional,
        "linear air drag c_n about the symmetry axis").named("linear air drag about the symmetry axis").typically(0.0, 1e-5).denoted("c_n"),
    key("air.transverse", "N m s", Between(0.0, 1.0), Optional,
        "linear air drag c_t about transverse axes").named("linear air drag about transverse axes").typically(0.0, 1e-5).denoted("c_t"),
    key("air.disc", "N m s^(3/2)", Between(0.0, 1.0), Optional,
        "air drag c of a disc about the symmetry axis").named("air drag of a disc about the symmetry axis").typically(0.0, 1e-5).denoted("c"),
    key("integrator.relative_tolerance", "", Between(1e-14, 1e-2), Required,
        "relative tolerance of the local error per step").typically(1e-13, 1e-6),
    key("integrator.absolute_tolerance", "", Between(1e-18, 1e-2), Required,
        "absolute tolerance of the local error per step, in the units of the state").typically(1e-15, 1e-6),
    key("sampling.period", "s", Nanoseconds, Required, "time between samples").typically(0.0001, 0.1),
    key("stop.theta_risen", "rad", Between(1e-6, PI), Optional, "stop when θ falls to this value (risen)").named("stop when θ falls to this value").typically(0.001, 0.4),
    key("stop.theta_fallen", "rad", Between(1e-6, PI), Optional, "stop when θ grows to this value (fallen)").named("stop when θ grows to this value").typically(0.5, 3.1),
    key("stop.on_stick", "", Choice(OnStick::NAMES), Optional,
        "whether to stop or continue when the contact point sticks; default \"stop\"").or("stop"),
    key("stop.duration", "s", Between(0.0, 1e6), Optional, "stop at this time at the latest").typically(1.0, 120.0),
];

impl Law {
    /// The keys of its parameters.
    pub fn parameters(&self) -> impl Iterator<Item = &'static Key> {
        KEYS.iter()
            .filter(|key| !key.kind.is_text() && self.has_parameter(key))
    }

    fn has_parameter(&self, key: &Key) -> bool {
        match key.presence {
            RequiredWith("friction.law", words) | Parameter(words) => words.contains(&self.name),
            OfLaws(required, optional) => [required, optional].concat().contains(&self.name),
            // Additional losses have the name of their section.
            Required | Optional | RequiredWith(..) | RequiredWithKey(_) | OptionalWith(..) => {
                key.section() == self.name
            }
        }
    }
}

impl Key {
    /// The key name without section (`k` for `friction.k`), or with section (`drilling-k`) if it is ambiguous.
    pub fn short_name(&self) -> String {
        match KEYS.iter().find(|key| key.name() == self.name()) {
            Some(first) if first.path == self.path => self.name().to_owned(),
            Some(_) | None => self.path.replace('.', "-"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::{Preset, Scenario};

    /// The word that a key is said to have by default gives the same run as leaving the key out, and its meaning says so.
    #[test]
    fn default_words_are_those_that_apply() {
        let mut paper = Preset::find("paper").and_then(Preset::values).unwrap();
        // A free peg requires them.
        paper.set("formulation", "body").unwrap();
        paper.set("friction.dissipation", "full").unwrap();
        let mut checked = 0;
        for key in KEYS {
            let Kind::Choice(words) = key.kind else {
                assert_eq!(key.default, None, "{}", key.path);
                continue;
            };
            let Some(default) = key.default else {
                // A choice without a default must be made, or doesn't apply; the format is that of this version.
                assert!(
                    key.presence != Optional || key.path == "format",
                    "{}",
                    key.path
                );
                continue;
            };
            let run = |word: &str| {
                let mut values = paper.clone();
                values.set(key.path, word).unwrap();
                let scenario = Scenario::new(values).unwrap();
                (scenario.model, scenario.stop)
            };
            for word in words {
                assert_eq!(
                    run(word) == run(""),
                    *word == default,
                    "{} = {word}",
                    key.path
                );
            }
            assert!(
                key.meaning.ends_with(&format!("; default {default:?}")),
                "{}",
                key.path
            );
            checked += 1;
        }
        assert_eq!(checked, 2);
    }
}
