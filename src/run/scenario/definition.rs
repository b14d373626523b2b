//! A validated scenario.

use super::choice::FormulationKind;
use super::error::ScenarioError;
use super::key::{Key, Value, short_number};
use super::keys::{FORMAT, KEYS};
use super::model::model;
use super::values::{Values, nanoseconds};
use crate::physics::dynamics::{Model, Start};
use crate::physics::friction::Dissipation;
use crate::physics::integrate::Tolerances;
use crate::physics::kinematics::{Euler, Tilt, lean_to_world};
use crate::physics::math::hypot;
use nalgebra::Vector3;
use sha2::{Digest as _, Sha256};
use std::f64::consts::PI;

/// The stop conditions of a run; at least one is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Stop when θ decreases to this angle, rad (`stop.theta_risen`).
    pub theta_risen: Option<f64>,
    /// Stop when θ increases to this angle, rad (`stop.theta_fallen`).
    pub theta_fallen: Option<f64>,
    /// Stop at this time, s (`stop.duration`).
    pub duration: Option<f64>,
    /// Whether the run continues when the contact point stops slipping; it may slip again (`stop.on_stick`).
    pub may_stick: bool,
}

/// A validated, complete definition of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    values: Values,
    /// Integration variables.
    pub formulation: FormulationKind,
    /// The top and its friction.
    pub model: Model,
    /// Euler angles at the start, rad.
    pub angles: Euler,
    /// Euler rates at the start, rad/s.
    pub rates: Euler,
    /// Integrator tolerances, limited by the support.
    pub tolerances: Tolerances,
    /// Time between samples, ns.
    pub sample_period_ns: u64,
    /// The stop conditions.
    pub stop: Stop,
}

impl Scenario {
    /// Checks that `values` are complete and consistent.
    ///
    /// # Errors
    /// The first key that is missing, does not apply, or contradicts another.
    pub fn new(mut values: Values) -> Result<Self, ScenarioError> {
        values.set_value("format", FORMAT)?;
        values.check_presence()?;
        // Equal runs must have equal digests.
        if values.text("support.kind") == Ok("fixed") {
            values.remove("support.kind");
        }
        let model = model(&values)?;
        let tolerance = |key| -> Result<f64, ScenarioError> {
            Ok(values.number(key)?.min(model.support.max_tolerance()))
        };
        let scenario = Self {
            formulation: match values.text("formulation")? {
                "euler" => FormulationKind::Euler,
                _ => FormulationKind::Body,
            },
            model,
            angles: Euler {
                phi: values.number("initial.phi")?,
                theta: values.number("initial.theta")?,
                psi: values.number("initial.psi")?,
            },
            rates: Euler {
                phi: values.number("initial.phi_dot")?,
                theta: values.number("initial.theta_dot")?,
                psi: values.number("initial.psi_dot")?,
            },
            tolerances: Tolerances {
                relative: tolerance("integrator.relative_tolerance")?,
                absolute: tolerance("integrator.absolute_tolerance")?,
            },
            // Validated before.
            sample_period_ns: nanoseconds(values.number("sampling.period")?).unwrap_or(1),
            stop: Stop {
                theta_risen: values.optional_number("stop.theta_risen"),
                theta_fallen: values.optional_number("stop.theta_fallen"),
                duration: values.optional_number("stop.duration"),
                may_stick: values.text("stop.on_stick") == Ok("continue"),
            },
            values,
        };
        scenario.check_support()?;
        scenario.check_body()?;
        scenario.check_start()?;
        scenario.check_end()?;
        Ok(scenario)
    }

    /// Reads and checks a scenario file.
    ///
    /// # Errors
    /// As [`Values::from_toml`] and [`Scenario::new`].
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        Self::new(Values::from_toml(text)?)
    }

    /// This scenario with some keys changed.
    ///
    /// # Errors
    /// As [`Values::set_value`] and [`Scenario::new`].
    pub fn with<'a>(
        &self,
        changes: impl IntoIterator<Item = (&'a str, toml::Value)>,
    ) -> Result<Self, ScenarioError> {
        let mut values = self.values.clone();
        for (path, value) in changes {
            values.set_value(path, value)?;
        }
        Self::new(values)
    }

    /// The scenario as TOML in canonical form: all keys in table order, with unit and description. Parsing it returns a
    /// bit-identical scenario.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        let mut section = "";
        for key in KEYS {
            let Some(value) = self.values.get(key.path) else {
                continue;
            };
            let (next, name) = key.path.rsplit_once('.').unwrap_or(("", key.path));
            if next != section {
                section = next;
                text.push_str(&format!("\n[{section}]\n"));
            }
            let unit = key.in_unit();
            text.push_str(&format!("{name} = {value}  # {}{unit}\n", key.meaning));
        }
        text
    }

    /// The keys that the scenario sets, in table order, with their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Key, &Value)> {
        KEYS.iter()
            .filter_map(|key| Some((key, self.values.get(key.path)?)))
    }

    /// The value of a key, if it is set.
    pub(super) fn value(&self, path: &str) -> Option<&Value> {
        self.values.get(path)
    }

    /// The scenario's name, used for file names.
    pub fn name(&self) -> &str {
        self.values.text("name").unwrap_or_default()
    }

    /// The description; may be empty.
    pub fn description(&self) -> &str {
        self.values.text("description").unwrap_or_default()
    }

    /// The text value of a key, or an empty string.
    pub fn word(&self, path: &'static str) -> &str {
        self.values.text(path).unwrap_or_default()
    }

    /// SHA-256 (hex) of all keys and values except name and description. Equal for scenarios that define the same run.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for (key, value) in self.entries() {
            if !matches!(key.path, "name" | "description") {
                hash.update(format!("{} = {value}\n", key.path));
            }
        }
        format!("{:x}", hash.finalize())
    }

    /// Whether there is no friction and no other loss.
    pub fn is_frictionless(&self) -> bool {
        self.model.friction.is_none()
    }

    /// Upper bound of the friction force at the initial slip speed, N. Used to scale its arrow.
    pub fn force_scale(&self) -> f64 {
        let Model { top, friction, .. } = &self.model;
        friction.law.bound(self.slip_speed_at_start(), top.weight())
    }

    /// Torque of that force and of all losses at the start, N m. Used to scale its arrow.
    pub fn torque_scale(&self) -> f64 {
        let tilt = Tilt::from_rates(self.angles.theta, self.rates);
        let losses = self.model.contact(&tilt).losses.unwrap_or_default();
        self.force_scale() * self.model.top.peg_radius + losses.norm()
    }

    /// Start of the motion.
    pub fn start(&self) -> Start {
        let number = |path: &str| self.values.optional_number(path);
        let top = &self.model.top;
        let tilt = Tilt::from_rates(self.angles.theta, self.rates);
        let world = |lean: &Vector3<f64>| lean_to_world(lean, self.angles.phi);
        // Vector from the peg's centre to the centre of mass, and its derivative.
        let reach = top.center_distance * world(&tilt.axis());
        let growth = top.center_distance * world(&tilt.omega_lean.cross(&tilt.axis()));
        let of_peg = |peg: &str, center: &str, offset: f64| {
            number(center).map_or_else(|| number(peg).unwrap_or_default(), |at| at - offset)
        };
        Start {
            angles: self.angles,
            rates: self.rates,
            peg_position: Vector3::new(
                of_peg("initial.peg_x", "initial.center_x", reach.x),
                of_peg("initial.peg_y", "initial.center_y", reach.y),
                top.peg_radius + number("initial.height").unwrap_or_default(),
            ),
            peg_velocity: Vector3::new(
                of_peg("initial.peg_x_dot", "initial.center_x_dot", growth.x),
                of_peg("initial.peg_y_dot", "initial.center_y_dot", growth.y),
                number("initial.peg_z_dot").unwrap_or_default(),
            ),
        }
    }

    /// Slip speed of the contact point at the start, m/s; for a dropped top, of its lowest point.
    pub fn slip_speed_at_start(&self) -> f64 {
        let tilt = Tilt::from_rates(self.angles.theta, self.rates);
        if !self.model.support.is_free() {
            return self.model.contact(&tilt).slip_speed;
        }
        let rolling = lean_to_world(
            &tilt.slip_velocity(self.model.top.peg_radius),
            self.angles.phi,
        );
        let slip = self.start().peg_velocity + rolling;
        hypot(slip.x, slip.y)
    }

    /// Checks keys that depend on the support.
    fn check_support(&self) -> Result<(), ScenarioError> {
        let distance = self.model.top.center_distance;
        if !self.model.support.is_free() {
            let reason = "must be a finite number > 0 (for a tippe top, which has a negative value, set support.kind = \"free\")";
            return ensure(distance > 0.0, || {
                self.values.invalid("top.center_distance", reason)
            });
        }
        ensure(
            distance != 0.0 && distance > -self.model.top.peg_radius,
            || {
                self.conflict(
                    "top.center_distance",
                    "must be > −top.peg_radius and not 0 (the centre of mass of a tippe top is inside its sphere)",
                )
            },
        )?;
        let is_euler = self.formulation == FormulationKind::Euler;
        let is_part = self.model.friction.dissipation != Dissipation::Full;
        let is_endless = self.stop.duration.is_none();
        let needs: Vec<&str> = [
            is_euler.then_some("formulation = \"body\""),
            is_part.then_some("friction.dissipation = \"full\""),
            is_endless.then_some("stop.duration (it may roll forever)"),
        ]
        .into_iter()
        .flatten()
        .collect();
        ensure(needs.is_empty(), || {
            let reason = format!("requires {}", needs.join(", "));
            self.conflict("support.kind", &reason)
        })?;
        self.check_places()?;
        match self.set_key(["stop.theta_risen", "stop.theta_fallen"]) {
            Some(key) if distance < 0.0 => Err(self.conflict(
                key,
                "not applicable to a tippe top (top.center_distance < 0); use stop.duration",
            )),
            _ => Ok(()),
        }
    }

    /// Checks that the peg and the centre of mass don't both have a position, or a velocity.
    fn check_places(&self) -> Result<(), ScenarioError> {
        for (of_peg, of_center) in PLACES {
            if let (Some(key), Some(other)) = (self.set_key(of_peg), self.set_key(of_center)) {
                let reason = format!(
                    "conflicts with {other}: set the position of either the peg or the centre of mass"
                );
                return Err(self.conflict(key, &reason));
            }
        }
        Ok(())
    }

    /// The first of these keys that is set.
    fn set_key(&self, keys: [&'static str; 2]) -> Option<&'static str> {
        keys.into_iter().find(|key| self.values.get(key).is_some())
    }

    fn conflict(&self, key: &str, reason: &str) -> ScenarioError {
        let value = self.values.get(key);
        let value = value.map_or_else(String::new, ToString::to_string);
        ScenarioError::of_value(key, &value, reason)
    }

    fn check_body(&self) -> Result<(), ScenarioError> {
        let top = &self.model.top;
        let offset = top.mass * top.center_distance * top.center_distance;
        ensure(top.transverse_moment > offset, || {
            let reason = format!(
                "must be more than {} kg m² = top.mass · top.center_distance² (parallel axis theorem)",
                short_number(offset)
            );
            self.values.invalid("top.transverse_moment", &reason)
        })?;
        // The axial moment of a rigid body is at most twice its transverse moment about any point of the axis.
        // The limit is lowest at the centre of mass.
        let limit = 2.0 * top.transverse_moment;
        for (limit, what) in [
            (limit, "2 · top.transverse_moment"),
            (
                limit - 2.0 * offset,
                "2 · (top.transverse_moment − top.mass · top.center_distance²), twice the transverse moment about the centre of mass",
            ),
        ] {
            ensure(top.axial_moment <= limit, || {
                let reason = format!(
                    "must be at most {} kg m² = {what} (limit for a rigid body)",
                    short_number(limit)
                );
                self.values.invalid("top.axial_moment", &reason)
            })?;
        }
        Ok(())
    }

    fn check_start(&self) -> Result<(), ScenarioError> {
        let theta = self.angles.theta;
        let is_singular = theta <= 0.0 || theta >= PI;
        ensure(
            !is_singular || self.formulation == FormulationKind::Body,
            || {
                let reason = "must be strictly between 0 and π with formulation = \"euler\"; \
                           use formulation = \"body\" for a vertical axis";
                self.values.invalid("initial.theta", reason)
            },
        )?;
        let drops_terms = self.model.friction.dissipation.drops_euler_terms();
        let is_endless = drops_terms && !self.is_frictionless() && self.stop.theta_risen.is_none();
        ensure(!is_endless, || {
            let reason = "requires stop.theta_risen, because its equations divide by sin θ";
            self.values.invalid("friction.dissipation", reason)
        })?;
        let (risen, fallen) = (self.stop.theta_risen, self.stop.theta_fallen);
        for (key, limit) in [
            ("stop.theta_risen", risen.filter(|limit| theta <= *limit)),
            ("stop.theta_fallen", fallen.filter(|limit| theta >= *limit)),
        ] {
            if limit.is_some() {
                let start = short_number(theta);
                let reason = format!("the start, initial.theta = {start}, is already beyond it");
                return Err(self.values.invalid(key, &reason));
            }
        }
        Ok(())
    }

    fn check_sticking(&self) -> Result<(), ScenarioError> {
        let conflict = |reason: &str| self.values.invalid("stop.on_stick", reason);
        ensure(self.model.friction.can_stick(), || {
            conflict(
                "this friction law never sticks; use friction.law = \"coulomb\", \"stribeck\" or \
                 \"contensou\", or rolling.arm, with friction.dissipation = \"full\"",
            )
        })?;
        ensure(self.stop.duration.is_some(), || {
            conflict("requires stop.duration, because the top may stick forever")
        })
    }

    fn check_end(&self) -> Result<(), ScenarioError> {
        let stop = &self.stop;
        if stop.may_stick && !self.model.support.is_free() {
            self.check_sticking()?;
        }
        let Some(duration) = stop.duration else {
            let by_angle = stop.theta_risen.is_some() || stop.theta_fallen.is_some();
            let ends = by_angle && !self.is_frictionless();
            return ensure(ends, || {
                ScenarioError(
                    "the run would never stop: set stop.duration, stop.theta_risen or stop.theta_fallen (without friction: stop.duration)"
                        .to_owned(),
                )
            });
        };
        let samples = duration * 1e9 / self.sample_period_ns as f64;
        ensure(samples < f64::from(u32::MAX), || {
            let reason = format!(
                "must be larger: at most {} samples fit in stop.duration = {} s",
                u32::MAX,
                short_number(duration)
            );
            self.values.invalid("sampling.period", &reason)
        })
    }
}

/// Keys of the position and of the velocity: those of the peg and of the centre of mass exclude each other.
const PLACES: [([&str; 2], [&str; 2]); 2] = [
    (
        ["initial.peg_x", "initial.peg_y"],
        ["initial.center_x", "initial.center_y"],
    ),
    (
        ["initial.peg_x_dot", "initial.peg_y_dot"],
        ["initial.center_x_dot", "initial.center_y_dot"],
    ),
];

/// The error unless a condition holds.
fn ensure(holds: bool, error: impl FnOnce() -> ScenarioError) -> Result<(), ScenarioError> {
    if holds { Ok(()) } else { Err(error()) }
}
