//! A validated scenario.

use super::check::Check;
use super::choice::{FormulationKind, SupportKind};
use super::error::ScenarioError;
use super::key::{Key, Value};
use super::keys::{FORMAT, KEYS};
use super::model::model;
use super::parse::nanoseconds;
use super::stop::Stop;
use super::values::Values;
use crate::physics::dynamics::{Model, Start};
use crate::physics::integrate::Tolerances;
use crate::physics::kinematics::{Euler, Tilt, lean_to_world};
use crate::physics::math::hypot;
use nalgebra::Vector3;
use sha2::{Digest as _, Sha256};

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
        // A file may leave the format out; a recording names it.
        values.set_value("format", FORMAT)?;
        values.check_presence()?;
        // Equal runs must have equal digests.
        if values.optional_choice("support.kind", SupportKind::find)? == Some(SupportKind::Fixed) {
            values.remove("support.kind");
        }
        let model = model(&values)?;
        let max_tolerance = model.support.max_tolerance();
        let period = nanoseconds(values.required_number("sampling.period")?);
        let scenario = Self {
            formulation: values.choice("formulation", FormulationKind::find)?,
            model,
            angles: Euler {
                phi: values.required_number("initial.phi")?,
                theta: values.required_number("initial.theta")?,
                psi: values.required_number("initial.psi")?,
            },
            rates: Euler {
                phi: values.required_number("initial.phi_dot")?,
                theta: values.required_number("initial.theta_dot")?,
                psi: values.required_number("initial.psi_dot")?,
            },
            tolerances: Tolerances {
                relative: values
                    .required_number("integrator.relative_tolerance")?
                    // With coarser steps, the end of the slip of a free peg is missed.
                    .min(max_tolerance),
                absolute: values
                    .required_number("integrator.absolute_tolerance")?
                    .min(max_tolerance),
            },
            sample_period_ns: period.ok_or_else(|| values.not_allowed("sampling.period"))?,
            stop: Stop::new(&values)?,
            values,
        };
        scenario.check()?;
        Ok(scenario)
    }

    /// Checks combinations of keys.
    fn check(&self) -> Result<(), ScenarioError> {
        let check = Check {
            values: &self.values,
            formulation: self.formulation,
            model: &self.model,
            theta: self.angles.theta,
            stop: self.stop,
            sample_period_ns: self.sample_period_ns,
        };
        check.support()?;
        check.body()?;
        check.start()?;
        check.friction(&self.start())?;
        check.end()
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

    /// This scenario with some keys as another one has them; what that one lacks is removed.
    ///
    /// # Errors
    /// As [`Scenario::new`].
    pub fn with_keys_of<'k>(
        &self,
        other: &Self,
        paths: impl IntoIterator<Item = &'k str>,
    ) -> Result<Self, ScenarioError> {
        let mut values = self.values.clone();
        for path in paths {
            match other.entries().find(|(key, _)| key.path == path) {
                Some((key, value)) => values.insert(key, value.clone()),
                None => values.remove(path),
            }
        }
        Self::new(values)
    }

    /// The scenario as TOML in canonical form: all keys in table order. Parsing it returns a bit-identical scenario.
    ///
    /// Recordings hold this text, so it has no words that a later version may improve.
    pub fn to_toml(&self) -> String {
        self.write_toml(|_| String::new())
    }

    /// The keys as an object, as the TOML has them.
    pub fn to_json(&self) -> serde_json::Value {
        toml::from_str(&self.to_toml()).unwrap_or_default()
    }

    /// The canonical TOML with the unit and description of each key as a comment, for people who edit it.
    pub fn to_commented_toml(&self) -> String {
        self.write_toml(|key| format!("  # {}{}", key.meaning, key.in_unit()))
    }

    fn write_toml(&self, comment: impl Fn(&Key) -> String) -> String {
        let mut text = String::new();
        let mut section = "";
        for key in KEYS {
            // In the order of the table, whatever the order of the file was.
            let Some(value) = self.values.get(key.path) else {
                continue;
            };
            let (next, name) = key.path.rsplit_once('.').unwrap_or(("", key.path));
            if next != section {
                section = next;
                text.push_str(&format!("\n[{section}]\n"));
            }
            text.push_str(&format!("{name} = {value}{}\n", comment(key)));
        }
        text
    }

    /// The keys that the scenario sets, in table order, with their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Key, &Value)> {
        KEYS.iter()
            .filter_map(|key| Some((key, self.values.get(key.path)?)))
    }

    /// The number of a key, if it is set.
    pub fn number(&self, path: &str) -> Option<f64> {
        self.values.optional_number(path)
    }

    /// The value of a key, if it is set.
    pub(super) fn value(&self, path: &str) -> Option<&Value> {
        self.values.get(path)
    }

    /// The scenario's name, used for file names.
    pub fn name(&self) -> &str {
        self.values.required_text("name").unwrap_or_default()
    }

    /// The description; may be empty.
    pub fn description(&self) -> &str {
        self.values.required_text("description").unwrap_or_default()
    }

    /// The text value of a key, or an empty string.
    pub fn word(&self, path: &'static str) -> &str {
        self.values.required_text(path).unwrap_or_default()
    }

    /// SHA-256 (hex) of all keys and values except name and description. Equal for scenarios that define the same run.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for (key, value) in self.entries() {
            // They don't change the run.
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
        let top = &self.model.top;
        let tilt = Tilt::from_rates(self.angles.theta, self.rates);
        let phi = self.angles.phi;
        // Vector from the peg's centre to the centre of mass, and its derivative.
        let reach = top.center_distance * lean_to_world(&tilt.axis(), phi);
        let growth = top.center_distance * lean_to_world(&tilt.omega_lean.cross(&tilt.axis()), phi);
        Start {
            angles: self.angles,
            rates: self.rates,
            peg_position: Vector3::new(
                self.peg_coordinate("initial.peg_x", "initial.center_x", reach.x),
                self.peg_coordinate("initial.peg_y", "initial.center_y", reach.y),
                top.peg_radius + self.values.number_or_zero("initial.height"),
            ),
            peg_velocity: Vector3::new(
                self.peg_coordinate("initial.peg_x_dot", "initial.center_x_dot", growth.x),
                self.peg_coordinate("initial.peg_y_dot", "initial.center_y_dot", growth.y),
                self.values.number_or_zero("initial.peg_z_dot"),
            ),
        }
    }

    /// A coordinate of the peg's centre, from the key `peg`, or from the key `center` of the centre of mass, which is
    /// farther by `offset`.
    fn peg_coordinate(&self, peg: &str, center: &str, offset: f64) -> f64 {
        match self.values.optional_number(center) {
            Some(coordinate) => coordinate - offset,
            None => self.values.number_or_zero(peg),
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
}
