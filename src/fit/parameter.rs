//! Free parameters: keys of the scenario and offsets of clocks.

use super::error::FitError;
use crate::run::scenario::{Key, Kind, Scenario, Value, find_key};
use std::f64::consts::PI;

/// What a parameter changes.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A key of the scenario.
    Key(&'static Key),
    /// The offset of the clock of the file with this index, s: added to its times.
    Offset(usize),
}

/// A free parameter.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// What it changes.
    pub target: Target,
    /// Value at the start of the fit.
    pub start: f64,
    /// Size of a typical change, for derivatives and for the optimiser.
    pub scale: f64,
    /// Lowest and highest allowed value.
    pub bounds: [f64; 2],
    /// Standard deviation of the weak prior around the start, used until the fit covers all data.
    pub prior: f64,
}

/// Part of the half width of a typical range that is a typical change, and a weak prior.
const TYPICAL_CHANGE: f64 = 0.05;
const WEAK_PRIOR: f64 = 0.1;

/// Range of clock offsets, s, unless given.
const MAX_OFFSET: f64 = 1e9;
/// Typical change and weak prior of a clock offset, s. An offset starts close to its value: it is scanned before.
const OFFSET_SCALE: f64 = 0.1;

/// The keys of the start of a top on a fixed peg, and those of a free peg in addition.
const START: &[&str] = &[
    "initial.phi",
    "initial.theta",
    "initial.psi",
    "initial.phi_dot",
    "initial.theta_dot",
    "initial.psi_dot",
];
const START_OF_FREE_PEG: &[&str] = &["initial.peg_x_dot", "initial.peg_y_dot"];

/// Name of the group of all keys of the start.
const INITIAL: &str = "initial";
/// Name of the offset of the second file's clock.
const OFFSET: &str = "offset";

impl Parameter {
    /// A key of a scenario.
    fn from_key(path: &str, scenario: &Scenario) -> Result<Self, FitError> {
        let key = find_key(path)?;
        let unfit = |reason| FitError::Key {
            name: key.path.to_owned(),
            reason,
        };
        let section = key.path.split('.').next().unwrap_or_default();
        if key.kind.is_text() || ["integrator", "sampling", "stop"].contains(&section) {
            return Err(unfit(
                "it is not a property of the top, its friction or its start",
            ));
        }
        let start = match value(scenario, key.path) {
            Some(value) => value,
            None if section == "initial" => 0.0,
            None => {
                return Err(unfit(
                    "the scenario has no value for it: set one with --set",
                ));
            }
        };
        let bounds = match key.kind {
            Kind::Between(low, high) => [low, high],
            Kind::Text | Kind::Name | Kind::Choice(_) | Kind::Any | Kind::Nanoseconds => {
                [f64::MIN, f64::MAX]
            }
        };
        let [low, high] = key.typical.unwrap_or([start.abs(), start.abs()]);
        let half = 0.5 * (high - low);
        let (change, prior) = if low >= 0.0 && bounds[0] >= 0.0 && section != "initial" {
            // Magnitudes that span decades.
            let floor = low.max(1e-3 * high);
            (floor, start.abs().max(floor))
        } else {
            (TYPICAL_CHANGE * half, WEAK_PRIOR * half)
        };
        Ok(Self {
            target: Target::Key(key),
            start,
            scale: start.abs().max(change),
            bounds,
            prior,
        })
    }

    /// The offset of a file's clock.
    fn from_offset(file: usize) -> Self {
        Self {
            target: Target::Offset(file),
            start: 0.0,
            scale: OFFSET_SCALE,
            bounds: [-MAX_OFFSET, MAX_OFFSET],
            prior: OFFSET_SCALE,
        }
    }

    /// Its name: a key, or `offset` for the clock of the second file, `offset.3` for that of the third.
    pub fn name(&self) -> String {
        match self.target {
            Target::Key(key) => key.path.to_owned(),
            Target::Offset(1) => OFFSET.to_owned(),
            Target::Offset(file) => format!("{OFFSET}.{}", file + 1),
        }
    }

    /// The unit; may be empty.
    pub fn unit(&self) -> &'static str {
        match self.target {
            Target::Key(key) => key.unit,
            Target::Offset(_) => "s",
        }
    }

    /// Its symbol in formulas, or its name.
    pub fn symbol(&self) -> String {
        match self.target {
            Target::Key(key) => key.symbol.unwrap_or(key.path).to_owned(),
            Target::Offset(_) => self.name(),
        }
    }

    /// Whether it is of the start of the motion.
    pub fn is_initial(&self) -> bool {
        matches!(self.target, Target::Key(key) if START.contains(&key.path) || START_OF_FREE_PEG.contains(&key.path))
    }

    /// The value nearest to `value` within the bounds.
    pub(super) fn clamp(&self, value: f64) -> f64 {
        value.clamp(self.bounds[0], self.bounds[1])
    }

    /// Whether its lowest value is a physical limit at which it has no effect, such as k = 0.
    pub(super) fn is_magnitude(&self) -> bool {
        self.bounds[0] == 0.0 && !self.is_initial()
    }

    /// The period of an angle of the start, rad.
    pub(super) fn is_turning(&self) -> bool {
        matches!(self.target, Target::Key(key) if ["initial.phi", "initial.psi"].contains(&key.path))
    }
}

/// The numeric value of a key of a scenario.
pub(super) fn value(scenario: &Scenario, path: &str) -> Option<f64> {
    let mut entries = scenario.entries();
    match entries.find(|(key, _)| key.path == path)?.1 {
        Value::Number(number) => Some(*number),
        Value::Text(_) => None,
    }
}

/// A parameter that is named by the user, and whether it belongs to the group `initial`: such a parameter is left out if
/// no signal shows it.
pub(super) struct Named {
    pub parameter: Parameter,
    pub is_optional: bool,
}

/// The parameters of these names, with these bounds.
pub(super) fn parameters(
    names: &[String],
    bounds: &[(String, [f64; 2])],
    scenario: &Scenario,
    files: usize,
) -> Result<Vec<Named>, FitError> {
    let mut all: Vec<Named> = Vec::new();
    for name in names {
        let (keys, is_optional): (Vec<&str>, _) = if name == INITIAL {
            let extra = scenario
                .model
                .support
                .is_free()
                .then_some(START_OF_FREE_PEG);
            let keys = START.iter().chain(extra.into_iter().flatten());
            (keys.copied().collect(), true)
        } else if name == OFFSET && files < 2 {
            return Err(FitError::Key {
                name: name.clone(),
                reason: "a time offset of all data together and a free start are the same motion; the offset of a second file is fitted without being named",
            });
        } else if name.starts_with(OFFSET) {
            // Offsets of further files are always free.
            continue;
        } else {
            (vec![name.as_str()], false)
        };
        for key in keys {
            let parameter = Parameter::from_key(key, scenario)?;
            let known = all.iter().position(|known| known.parameter.name() == key);
            match known {
                Some(at) => all[at].is_optional &= is_optional,
                None => all.push(Named {
                    parameter,
                    is_optional,
                }),
            }
        }
    }
    all.extend((1..files).map(|file| Named {
        parameter: Parameter::from_offset(file),
        is_optional: false,
    }));
    for (name, [low, high]) in bounds {
        let found = all.iter_mut().find(|named| named.parameter.name() == *name);
        let Some(Named { parameter, .. }) = found else {
            return Err(FitError::NotFree { name: name.clone() });
        };
        let start = parameter.start;
        // An offset is scanned: it has no start of its own.
        let is_offset = matches!(parameter.target, Target::Offset(_));
        let is_within = is_offset || (*low..=*high).contains(&start);
        if !is_within || low >= high {
            return Err(FitError::Bounds {
                name: name.clone(),
                low: *low,
                high: *high,
                start,
            });
        }
        parameter.bounds = [low.max(parameter.bounds[0]), high.min(parameter.bounds[1])];
        if is_offset {
            parameter.start = parameter.clamp(start);
        }
    }
    Ok(all)
}

/// Whether an angle of the start that may turn is within a turn; it is reported so.
pub(super) fn principal(angle: f64) -> f64 {
    let turn = 2.0 * PI;
    angle - turn * (angle / turn).round()
}
