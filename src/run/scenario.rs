//! Everything that defines a run: read from TOML, checked, and written back in one canonical form.
//!
//! [`Values`] holds keys and values as a person writes them; [`Scenario`] is what has passed every
//! check and is turned into the types of the physics. The table of keys, [`KEYS`], is the only place
//! that knows names, units and ranges.

mod error;
mod keys;
mod laws;
mod presets;

pub use error::ScenarioError;
pub use keys::{FORMAT, KEYS, Key, Kind, Presence, Value};
pub use laws::{LAWS, Law};
pub use presets::{PRESETS, Preset};

use crate::physics::dynamics::Model;
use crate::physics::friction::{
    Air, Dissipation, Drilling, Friction, FrictionLaw, Losses, Smoothing,
};
use crate::physics::integrate::Tolerances;
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::Top;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::Write as _;

/// Names at least so alike, by Jaro and Winkler, are taken for misspelt ones.
const LIKE: f64 = 0.8;

/// Keys with values of the right type, in no particular combination.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values(BTreeMap<&'static str, Value>);

/// The variables in which the motion is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormulationKind {
    /// Euler angles: [`crate::physics::dynamics::EulerAngles`].
    Euler,
    /// Rotation and angular momentum: [`crate::physics::dynamics::BodyRotation`].
    Body,
}

/// When a run ends. At least one is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// When θ falls to this angle, rad.
    pub theta_risen: Option<f64>,
    /// When θ grows to this angle, rad.
    pub theta_fallen: Option<f64>,
    /// At this time, s.
    pub duration: Option<f64>,
    /// Whether when the contact point stops slipping.
    pub on_stick: bool,
}

/// A checked, complete definition of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    values: Values,
    /// Variables of integration.
    pub formulation: FormulationKind,
    /// The top and its friction.
    pub model: Model,
    /// Euler angles at the start, rad.
    pub angles: Euler,
    /// Euler rates at the start, rad/s.
    pub rates: Euler,
    /// Local error bounds.
    pub tolerances: Tolerances,
    /// Time between samples, ns.
    pub sample_period_ns: u64,
    /// When the run ends.
    pub stop: Stop,
}

impl Values {
    /// Reads a scenario file. What it says is checked key by key, but not whether it is complete.
    ///
    /// # Errors
    /// Malformed TOML, an unknown key, a value of the wrong type or out of range.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let table: toml::Table = text.parse().map_err(ScenarioError::Syntax)?;
        let mut values = Self::default();
        for (name, value) in table {
            match value {
                toml::Value::Table(section) => {
                    for (inner, value) in section {
                        values.insert(&format!("{name}.{inner}"), &value)?;
                    }
                }
                value => values.insert(&name, &value)?,
            }
        }
        Ok(values)
    }

    /// Sets one key from `text`, a value as in TOML (quotes around words may be left out). An empty
    /// text removes the key.
    ///
    /// # Errors
    /// An unknown key, a value of the wrong type or out of range.
    pub fn set(&mut self, path: &str, text: &str) -> Result<(), ScenarioError> {
        if text.is_empty() {
            self.0.remove(find_key(path)?.path);
            return Ok(());
        }
        let is_text = find_key(path)?.kind.is_text();
        let value = match format!("value = {text}").parse::<toml::Table>() {
            Ok(mut table) if table.len() == 1 => table.remove("value"),
            _ => None,
        };
        let value = value
            .filter(|value| !is_text || value.is_str())
            .unwrap_or_else(|| toml::Value::from(text));
        self.insert(path, &value)
    }

    /// The value of a key.
    #[must_use]
    pub fn get(&self, path: &str) -> Option<&Value> {
        self.0.get(path)
    }

    fn insert(&mut self, path: &str, value: &toml::Value) -> Result<(), ScenarioError> {
        let key = find_key(path)?;
        self.0.insert(key.path, checked(key, value)?);
        Ok(())
    }

    fn number(&self, path: &'static str) -> Result<f64, ScenarioError> {
        self.optional_number(path)
            .ok_or(ScenarioError::MissingKey { key: path })
    }

    fn optional_number(&self, path: &str) -> Option<f64> {
        match self.get(path) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        }
    }

    fn text(&self, path: &'static str) -> Result<&str, ScenarioError> {
        match self.get(path) {
            Some(Value::Text(text)) => Ok(text),
            _ => Err(ScenarioError::MissingKey { key: path }),
        }
    }

    /// Whether each key of the table is there if and only if it has to be.
    fn check_presence(&self) -> Result<(), ScenarioError> {
        for key in KEYS {
            let there = self.0.contains_key(key.path);
            match key.presence {
                Presence::Required if !there => {
                    return Err(ScenarioError::MissingKey { key: key.path });
                }
                Presence::With(other, words) => {
                    let value = self.text(other)?;
                    let wanted = words.contains(&value);
                    if wanted && !there {
                        return Err(ScenarioError::MissingKey { key: key.path });
                    }
                    if there && !wanted {
                        return Err(ScenarioError::Inapplicable {
                            key: key.path,
                            other,
                            value: value.to_owned(),
                        });
                    }
                }
                Presence::Beside(other) if there != self.0.contains_key(other) => {
                    let key = if there { other } else { key.path };
                    return Err(ScenarioError::MissingKey { key });
                }
                Presence::Required | Presence::Optional | Presence::Beside(_) => {}
            }
        }
        Ok(())
    }
}

impl Scenario {
    /// Checks that `values` are complete and fit together.
    ///
    /// # Errors
    /// The first key that is missing, has no meaning here, or contradicts another.
    pub fn new(mut values: Values) -> Result<Self, ScenarioError> {
        values.0.insert("format", Value::Text(FORMAT.to_owned()));
        values.check_presence()?;
        let scenario = Self {
            formulation: formulation(&values)?,
            model: Model {
                top: top(&values)?,
                friction: friction(&values)?,
            },
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
                relative: values.number("integrator.relative_tolerance")?,
                absolute: values.number("integrator.absolute_tolerance")?,
            },
            sample_period_ns: nanoseconds(values.number("sampling.period")?).ok_or(
                ScenarioError::MissingKey {
                    key: "sampling.period",
                },
            )?,
            stop: Stop {
                theta_risen: values.optional_number("stop.theta_risen"),
                theta_fallen: values.optional_number("stop.theta_fallen"),
                duration: values.optional_number("stop.duration"),
                on_stick: values.text("stop.on_stick") != Ok("continue"),
            },
            values,
        };
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

    /// The scenario as TOML in canonical form: every key in the order of the table, with unit and
    /// meaning. Reading it gives back the same scenario to the last bit.
    #[must_use]
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
                // Writing to a String cannot fail.
                let _ = writeln!(text, "\n[{section}]");
            }
            let unit = if key.unit.is_empty() {
                String::new()
            } else {
                format!(" [{}]", key.unit)
            };
            let _ = writeln!(text, "{name} = {value}  # {}{unit}", key.meaning);
        }
        text
    }

    /// The keys that it has, in the order of the table, with their values.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Key, &Value)> {
        KEYS.iter()
            .filter_map(|key| Some((key, self.values.get(key.path)?)))
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.values.text("name").unwrap_or_default()
    }

    /// A sentence about it; empty if it has none.
    #[must_use]
    pub fn description(&self) -> &str {
        self.values.text("description").unwrap_or_default()
    }

    /// The word that stands for a key's value, empty if the scenario has none: for summaries.
    #[must_use]
    pub fn word(&self, path: &'static str) -> &str {
        self.values.text(path).unwrap_or_default()
    }

    /// SHA-256 over every key and value but the name and the description, in hexadecimal: equal for
    /// scenarios that define the same run.
    #[must_use]
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for (key, value) in self.entries() {
            if !matches!(key.path, "name" | "description") {
                hash.update(format!("{} = {value}\n", key.path));
            }
        }
        hex(&hash.finalize())
    }

    /// Whether nothing takes energy from the top.
    #[must_use]
    pub fn is_frictionless(&self) -> bool {
        self.model.friction.is_none()
    }

    /// Largest friction force of the law at the slip speed of the start, N: the scale for drawing it.
    #[must_use]
    pub fn force_scale(&self) -> f64 {
        let Model { top, friction } = &self.model;
        friction.law.bound(self.slip_speed_at_start(), top.weight())
    }

    /// Torque of that force and of all losses at the start, N m: the scale for drawing it.
    #[must_use]
    pub fn torque_scale(&self) -> f64 {
        let tilt = Tilt::from_rates(self.angles.theta, self.rates);
        let losses = self.model.contact(&tilt).losses.unwrap_or_default();
        self.force_scale() * self.model.top.peg_radius + losses.norm()
    }

    /// Slip speed of the contact point at the start, m/s.
    #[must_use]
    pub fn slip_speed_at_start(&self) -> f64 {
        let tilt = Tilt::from_rates(self.angles.theta, self.rates);
        self.model.contact(&tilt).slip_speed
    }

    fn check_body(&self) -> Result<(), ScenarioError> {
        let top = &self.model.top;
        // No body has a larger axial moment than twice its transverse one, about any point of its axis;
        // the centre of mass is the hardest.
        let limit = 2.0 * top.transverse_moment;
        let offset = top.mass * top.center_distance * top.center_distance;
        for (limit, what) in [
            (limit, "2 · top.transverse_moment"),
            (
                limit - 2.0 * offset,
                "2 · (top.transverse_moment − top.mass · top.center_distance²), twice the transverse moment about the centre of mass",
            ),
        ] {
            if top.axial_moment > limit {
                return Err(ScenarioError::OutOfRange {
                    key: "top.axial_moment",
                    value: top.axial_moment.to_string(),
                    allowed: format!("at most {limit:e} kg m² = {what}: no rigid body exceeds it"),
                });
            }
        }
        Ok(())
    }

    fn check_start(&self) -> Result<(), ScenarioError> {
        let theta = self.angles.theta;
        if self.formulation == FormulationKind::Euler && !(theta > 0.0 && theta < PI) {
            return Err(ScenarioError::OutOfRange {
                key: "initial.theta",
                value: theta.to_string(),
                allowed: "between 0 and π with formulation = \"euler\", which is singular there; \
                          formulation = \"body\" allows both"
                    .to_owned(),
            });
        }
        let drops_terms = self.model.friction.dissipation.drops_euler_terms();
        if drops_terms && !self.is_frictionless() && self.stop.theta_risen.is_none() {
            return Err(ScenarioError::Conflict {
                key: "friction.dissipation",
                value: self.word("friction.dissipation").to_owned(),
                reason: "divides by sin θ and needs stop.theta_risen to end before upright"
                    .to_owned(),
            });
        }
        for (key, limit, wrong) in [
            (
                "stop.theta_risen",
                self.stop.theta_risen,
                self.stop.theta_risen.is_some_and(|limit| theta <= limit),
            ),
            (
                "stop.theta_fallen",
                self.stop.theta_fallen,
                self.stop.theta_fallen.is_some_and(|limit| theta >= limit),
            ),
        ] {
            if wrong {
                return Err(ScenarioError::Conflict {
                    key,
                    value: limit.unwrap_or_default().to_string(),
                    reason: format!("the top starts beyond it, at initial.theta = {theta}"),
                });
            }
        }
        Ok(())
    }

    fn check_sticking(&self) -> Result<(), ScenarioError> {
        let conflict = |reason: &str| {
            Err(ScenarioError::Conflict {
                key: "stop.on_stick",
                value: "continue".to_owned(),
                reason: reason.to_owned(),
            })
        };
        if !self.model.friction.can_stick() {
            return conflict(
                "this friction never holds the contact point at rest; friction.law = \"coulomb\" or \
                 \"stribeck\" and rolling.arm do, if friction.dissipation is \"full\"",
            );
        }
        if self.stop.duration.is_none() {
            return conflict("a top may stick for ever; set stop.duration");
        }
        Ok(())
    }

    fn check_end(&self) -> Result<(), ScenarioError> {
        let Stop {
            theta_risen,
            theta_fallen,
            duration,
            on_stick,
        } = self.stop;
        if !on_stick {
            self.check_sticking()?;
        }
        let Some(duration) = duration else {
            let by_angle = theta_risen.is_some() || theta_fallen.is_some();
            return if by_angle && !self.is_frictionless() {
                Ok(())
            } else {
                Err(ScenarioError::NeverStops)
            };
        };
        if duration * 1e9 / self.sample_period_ns as f64 > f64::from(u32::MAX) {
            return Err(ScenarioError::OutOfRange {
                key: "sampling.period",
                value: (self.sample_period_ns as f64 / 1e9).to_string(),
                allowed: format!(
                    "long enough for at most {} samples in stop.duration = {duration} s",
                    u32::MAX
                ),
            });
        }
        Ok(())
    }
}

fn find_key(path: &str) -> Result<&'static Key, ScenarioError> {
    KEYS.iter().find(|key| key.path == path).ok_or_else(|| {
        let section = path.rsplit_once('.').map_or("", |(section, _)| section);
        let in_section =
            |key: &&Key| key.path.rsplit_once('.').map_or("", |(section, _)| section) == section;
        let mut allowed: Vec<_> = KEYS.iter().filter(in_section).map(|key| key.path).collect();
        if allowed.is_empty() {
            allowed = KEYS.iter().map(|key| key.path).collect();
        }
        ScenarioError::UnknownKey {
            key: path.to_owned(),
            near: near(path, KEYS.iter().map(|key| key.path)),
            allowed: allowed.join(", "),
        }
    })
}

/// A question after the name most like a wrong one; empty if none is like it.
fn near<'a>(wrong: &str, names: impl Iterator<Item = &'a str>) -> String {
    let likeness = names.map(|name| (strsim::jaro_winkler(wrong, name), name));
    let most = likeness.max_by(|(a, _), (b, _)| a.total_cmp(b));
    match most {
        Some((likeness, name)) if likeness > LIKE => format!(" (did you mean {name}?)"),
        _ => String::new(),
    }
}

/// A value of the type and in the range that `key` asks for.
fn checked(key: &Key, value: &toml::Value) -> Result<Value, ScenarioError> {
    let wrong_type = || ScenarioError::WrongType {
        key: key.path,
        value: value.to_string(),
        expected: key.kind.to_string(),
    };
    if key.kind.is_text() {
        let text = value.as_str().ok_or_else(wrong_type)?;
        let allowed = match key.kind {
            Kind::Choice(words) => words.contains(&text),
            Kind::Name => is_name(text),
            _ => true,
        };
        return if allowed {
            Ok(Value::Text(text.to_owned()))
        } else {
            Err(out_of_range(key, text))
        };
    }
    let number = match value {
        toml::Value::Float(number) => *number,
        toml::Value::Integer(number) => *number as f64,
        _ => return Err(wrong_type()),
    };
    let allowed = match key.kind {
        Kind::Positive => number > 0.0,
        Kind::Between(low, high) => number >= low && number <= high,
        Kind::Nanoseconds => nanoseconds(number).is_some(),
        Kind::Any | Kind::Text | Kind::Name | Kind::Choice(_) => true,
    };
    if allowed && number.is_finite() {
        Ok(Value::Number(number))
    } else {
        Err(out_of_range(key, &number.to_string()))
    }
}

fn out_of_range(key: &Key, value: &str) -> ScenarioError {
    let near = match key.kind {
        Kind::Choice(words) => near(value, words.iter().copied()),
        _ => String::new(),
    };
    ScenarioError::OutOfRange {
        key: key.path,
        value: value.to_owned(),
        allowed: format!("{}{near}", key.kind),
    }
}

/// Whether a text can be part of a file's name on every system, and shows there.
fn is_name(text: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    !text.is_empty() && text.len() <= 100 && !text.starts_with('.') && text.chars().all(allowed)
}

/// Seconds as a whole number of nanoseconds, if they are one, up to an hour.
///
/// A decimal number with at most nine places is the double nearest to `ns / 1e9`, which is also what
/// the division gives.
fn nanoseconds(seconds: f64) -> Option<u64> {
    let rounded = (seconds * 1e9).round();
    let whole = (1.0..=3.6e12).contains(&rounded) && rounded / 1e9 == seconds;
    whole.then_some(rounded as u64)
}

fn formulation(values: &Values) -> Result<FormulationKind, ScenarioError> {
    Ok(match values.text("formulation")? {
        "body" => FormulationKind::Body,
        _ => FormulationKind::Euler,
    })
}

fn top(values: &Values) -> Result<Top, ScenarioError> {
    Ok(Top {
        mass: values.number("top.mass")?,
        transverse_moment: values.number("top.transverse_moment")?,
        axial_moment: values.number("top.axial_moment")?,
        center_distance: values.number("top.center_distance")?,
        peg_radius: values.number("top.peg_radius")?,
        gravity: values.number("gravity")?,
    })
}

fn friction(values: &Values) -> Result<Friction, ScenarioError> {
    let law = law(values)?;
    let losses = Some(losses(values)).filter(|losses| !losses.is_none());
    if matches!(law, FrictionLaw::Contensou { .. }) && values.get("drilling.k").is_some() {
        return Err(ScenarioError::Conflict {
            key: "drilling.k",
            value: values.number("drilling.k")?.to_string(),
            reason: "friction.law = \"contensou\" has a drilling torque of its own".to_owned(),
        });
    }
    Ok(Friction {
        law,
        dissipation: match values.text("friction.dissipation") {
            Ok("without-nutation-part") => Dissipation::WithoutNutationPart,
            Ok("precession-term-only") => Dissipation::PrecessionTermOnly,
            Ok("spin-term-only") => Dissipation::SpinTermOnly,
            Ok("tilt-torque-only") => Dissipation::TiltTorqueOnly,
            Ok("spin-torque-only") => Dissipation::SpinTorqueOnly,
            _ => Dissipation::Full,
        },
        losses,
    })
}

fn law(values: &Values) -> Result<FrictionLaw, ScenarioError> {
    let name = values.text("friction.law")?;
    if name == "none" {
        return Ok(FrictionLaw::None);
    }
    let k = values.number("friction.k")?;
    let regularised = |shape| {
        Ok(FrictionLaw::Regularised {
            k,
            speed: values.number("friction.smoothing_speed")?,
            shape,
        })
    };
    Ok(match name {
        "coulomb-sqrt" => return regularised(Smoothing::SquareRoot),
        "coulomb-tanh" => return regularised(Smoothing::Tanh),
        "coulomb-rational" => return regularised(Smoothing::Rational),
        "viscous" => FrictionLaw::Viscous {
            k,
            speed: values.number("friction.viscous_speed")?,
        },
        "stribeck" => FrictionLaw::Stribeck {
            k,
            static_k: values.number("friction.static_k")?,
            speed: values.number("friction.stribeck_speed")?,
            slope: values.number("friction.viscous_slope")?,
        },
        "contensou" => FrictionLaw::Contensou {
            k,
            patch_radius: values.number("friction.patch_radius")?,
        },
        _ => FrictionLaw::Coulomb { k },
    })
}

fn losses(values: &Values) -> Losses {
    let number = |path| values.optional_number(path).unwrap_or_default();
    Losses {
        rolling_arm: number("rolling.arm"),
        drilling: Drilling {
            k: number("drilling.k"),
            patch_radius: number("drilling.patch_radius"),
        },
        air: Air {
            axial: number("air.axial"),
            transverse: number("air.transverse"),
            disc: number("air.disc"),
        },
    }
}

/// Bytes in lower-case hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
