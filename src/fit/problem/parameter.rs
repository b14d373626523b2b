//! Free parameters: keys of the scenario and offsets of clocks.

use crate::fit::error::{self, FitError};
use crate::run::scenario::{Key, Kind, Scenario, Value, find_key};
use crate::words::{Piece, Sentence, sentence};
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
    /// What the parameter changes.
    pub target: Target,
    /// Value at the start of the fit.
    pub start: f64,
    /// Size of a typical change, for derivatives and for the optimiser.
    pub scale: f64,
    /// Lowest and highest allowed value.
    pub bounds: [f64; 2],
    /// Standard deviation of the weak prior around the start, used until the fit covers all data.
    pub prior: f64,
    /// What reports add to the value: offsets are fitted relative to one that aligns the starts of the files, because
    /// clocks may differ by years.
    pub(in crate::fit) shift: f64,
}

/// Part of the half width of a typical range that is a typical change, and a weak prior.
const TYPICAL_CHANGE: f64 = 0.05;
const WEAK_PRIOR: f64 = 0.1;

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
const START_OF_FREE_PEG: [&str; 2] = ["initial.peg_x_dot", "initial.peg_y_dot"];
/// The same for scenarios that give the velocity of the centre of mass.
const START_OF_CENTER: [&str; 2] = ["initial.center_x_dot", "initial.center_y_dot"];

/// Name of the group of all keys of the start.
pub(in crate::fit) const INITIAL: &str = "initial";
/// Name of the offset of the second file's clock, and of the group of all offsets.
const OFFSET: &str = "offset";

impl Parameter {
    /// A key of a scenario.
    fn from_key(path: &str, scenario: &Scenario) -> Result<Self, FitError> {
        let key = find_key(path)?;
        let section = key.path.split('.').next().unwrap_or_default();
        if key.kind.is_text() || ["integrator", "sampling", "stop"].contains(&section) {
            return Err(unfit(
                key.path,
                sentence!("it is not a property of the top, its friction or its start"),
            ));
        }
        let start = match value(scenario, key.path) {
            Some(value) => value,
            None if section == "initial" => 0.0,
            None if section == "friction" && scenario.is_frictionless() => {
                return Err(unfit(key.path, no_friction()));
            }
            None => {
                let set = Piece::argument("set");
                return Err(unfit(
                    key.path,
                    sentence!("the scenario has no value for it; set one with {}", set),
                ));
            }
        };
        let bounds = match key.kind {
            Kind::Between(low, high) => [low, high],
            Kind::Text
            | Kind::Name
            | Kind::Formula
            | Kind::Choice(_)
            | Kind::Any
            | Kind::Nanoseconds => [f64::MIN, f64::MAX],
        };
        let [low, high] = key.typical.unwrap_or([start.abs(), start.abs()]);
        let half = 0.5 * (high - low);
        // At 0, which switches an effect off, only the range says what a change is.
        let is_magnitude = low >= 0.0 && bounds[0] >= 0.0 && section != "initial" && start != 0.0;
        let (change, prior) = if is_magnitude {
            // Magnitudes that span decades: a part of a typical range would be larger than most of their values.
            let smallest = low.max(1e-3 * high);
            (smallest, start.abs().max(smallest))
        } else {
            (TYPICAL_CHANGE * half, WEAK_PRIOR * half)
        };
        Ok(Self {
            target: Target::Key(key),
            start,
            scale: start.abs().max(change),
            bounds,
            prior,
            shift: 0.0,
        })
    }

    /// The offset of a file's clock.
    fn from_offset(file: usize) -> Self {
        Self {
            target: Target::Offset(file),
            start: 0.0,
            scale: OFFSET_SCALE,
            bounds: [f64::MIN, f64::MAX],
            prior: OFFSET_SCALE,
            shift: 0.0,
        }
    }

    /// Name: a key, or `offset` for the clock of the second file, `offset.3` for that of the third.
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

    /// Symbol in formulas, or the name.
    pub fn symbol(&self) -> String {
        match self.target {
            Target::Key(key) => key.symbol.unwrap_or(key.path).to_owned(),
            Target::Offset(_) => self.name(),
        }
    }

    /// Whether it is of the start of the motion.
    pub fn is_initial(&self) -> bool {
        let Target::Key(key) = self.target else {
            return false;
        };
        [START, &START_OF_FREE_PEG, &START_OF_CENTER]
            .iter()
            .any(|keys| keys.contains(&key.path))
    }

    /// The error of this parameter.
    pub(in crate::fit) fn error(&self, reason: Sentence) -> FitError {
        let name = Piece::key(self.name());
        let reason = sentence!("{}: {}", name, reason);
        match self.target {
            Target::Key(key) => FitError::of_key(key.path, reason),
            // The offset of a clock is no key.
            Target::Offset(_) => FitError::refused(reason),
        }
    }

    /// Restricts the parameter to a range that contains its start.
    fn set_bounds(&mut self, [low, high]: [f64; 2]) -> Result<(), FitError> {
        // An offset is scanned: it has no start of its own.
        let is_offset = matches!(self.target, Target::Offset(_));
        let is_within = is_offset || (low..=high).contains(&self.start);
        if !is_within || low >= high {
            return Err(self.error(sentence!(
                "the bounds {} to {} must contain the start, {}; {}",
                low.to_string(),
                high.to_string(),
                self.start.to_string(),
                error::change_start()
            )));
        }
        self.bounds = [low.max(self.bounds[0]), high.min(self.bounds[1])];
        if is_offset {
            self.start = self.clamp(self.start);
        }
        Ok(())
    }

    /// Counts an offset from `shift` on, s, where the start of the file is that of the motion.
    pub(in crate::fit) fn shift_by(&mut self, shift: f64) {
        self.shift = shift;
        self.bounds = self.bounds.map(|bound| bound - shift);
        self.start = self.clamp(0.0);
    }

    /// A value as reports give it: angles that may turn within half a turn of 0, offsets from 0 on.
    pub(in crate::fit) fn reported(&self, value: f64) -> f64 {
        if self.is_turning() {
            principal(value)
        } else {
            value + self.shift
        }
    }

    /// Size of a change for derivatives, relative to which its step is small.
    pub(in crate::fit) fn change(&self, value: f64) -> f64 {
        match self.target {
            Target::Key(_) => self.scale.max(value.abs()),
            // The motion depends on the offset as on the time, however large it is.
            Target::Offset(_) => self.scale,
        }
    }

    /// The value nearest to `value` within the bounds.
    pub(in crate::fit) fn clamp(&self, value: f64) -> f64 {
        value.clamp(self.bounds[0], self.bounds[1])
    }

    /// Whether the lowest value is a physical limit at which it has no effect, such as k = 0.
    pub(in crate::fit) fn is_magnitude(&self) -> bool {
        self.bounds[0] == 0.0 && !self.is_initial()
    }

    /// Whether it is an angle of the start that is defined up to whole turns.
    pub(in crate::fit) fn is_turning(&self) -> bool {
        matches!(self.target, Target::Key(key) if ["initial.phi", "initial.psi"].contains(&key.path))
    }
}

/// Whether a parameter is the offset of a clock, by its name.
pub(in crate::fit) fn is_offset(name: &str) -> bool {
    name.starts_with(OFFSET)
}

/// The error of a key that can't be fitted.
fn unfit(path: &str, reason: Sentence) -> FitError {
    let key = Piece::key(path.to_owned());
    FitError::of_key(path, sentence!("{} can't be fitted: {}", key, reason))
}

/// The error of an offset that can't be fitted.
fn unfit_offset(name: &str, reason: &'static str) -> FitError {
    let offset = Piece::key(name.to_owned());
    FitError::refused(sentence!("{} can't be fitted: {}", offset, reason))
}

/// The error of the offset of a file that there is not.
fn no_file(name: &str) -> FitError {
    unfit_offset(
        name,
        "there is no file with this number; offset is that of the second file, offset.3 that of the third",
    )
}

fn no_friction() -> Sentence {
    sentence!(
        "the scenario has no friction; choose a law, e.g. with {}",
        Piece::argument_with_all(
            "set",
            vec![
                "friction.law=coulomb".to_owned(),
                "friction.k=0.03".to_owned(),
                "friction.dissipation=full".to_owned()
            ]
        )
    )
}

/// The numeric value of a key of a scenario.
pub(in crate::fit) fn value(scenario: &Scenario, path: &str) -> Option<f64> {
    let mut entries = scenario.entries();
    match entries.find(|(key, _)| key.path == path)?.1 {
        Value::Number(number) => Some(*number),
        Value::Text(_) => None,
    }
}

/// A parameter that the user has selected, by itself or with a group.
pub(in crate::fit) struct SelectedParameter {
    pub parameter: Parameter,
    /// Whether it belongs to the group `initial`: then it is left out if no signal shows it.
    pub is_optional: bool,
}

/// The parameters of these names, with these bounds. `offset` stands for the clocks of all further files.
pub(in crate::fit) fn select(
    names: &[String],
    bounds: &[(String, [f64; 2])],
    scenario: &Scenario,
    files: usize,
) -> Result<Vec<SelectedParameter>, FitError> {
    let mut all: Vec<SelectedParameter> = Vec::new();
    for name in names {
        if name == INITIAL {
            for key in keys_of_start(scenario) {
                add(&mut all, key, true, scenario)?;
            }
        } else if is_offset(name) && files < 2 {
            return Err(unfit_offset(
                name,
                "a time offset of all data together and a free start are the same motion; name it for further files that have a clock of their own",
            ));
        } else if !is_offset(name) {
            add(&mut all, name, false, scenario)?;
        }
    }
    for file in 1..files {
        let offset = Parameter::from_offset(file);
        if names
            .iter()
            .any(|name| name == OFFSET || *name == offset.name())
        {
            all.push(SelectedParameter {
                parameter: offset,
                is_optional: false,
            });
        }
    }
    for name in names.iter().filter(|name| is_offset(name)) {
        if *name != OFFSET && !all.iter().any(|one| one.parameter.name() == *name) {
            return Err(no_file(name));
        }
    }
    for (name, range) in bounds {
        let parameter = find_free(&mut all, name, "bounds", scenario)?;
        parameter.set_bounds(*range)?;
    }
    Ok(all)
}

/// What only a free parameter can have.
pub(in crate::fit) const PROFILE: &str = "a profile";

/// The free parameter with this name, for what only a free one can have.
pub(in crate::fit) fn find_free<'a>(
    all: &'a mut [SelectedParameter],
    name: &str,
    what: &'static str,
    scenario: &Scenario,
) -> Result<&'a mut Parameter, FitError> {
    let mut parameters = all.iter_mut().map(|selected| &mut selected.parameter);
    if let Some(free) = parameters.find(|parameter| parameter.name() == name) {
        return Ok(free);
    }
    if is_offset(name) {
        return Err(no_file(name));
    }
    // A key that there is not can't be freed either.
    Parameter::from_key(name, scenario)?;
    Err(error::not_free(name, what))
}

/// The keys of the group `initial`.
fn keys_of_start(scenario: &Scenario) -> Vec<&'static str> {
    let mut keys = START.to_vec();
    if scenario.model.support.is_free() {
        for (of_peg, of_center) in START_OF_FREE_PEG.iter().zip(START_OF_CENTER) {
            // A scenario gives the velocity of one of the two points.
            let is_of_center = value(scenario, of_center).is_some();
            keys.push(if is_of_center { of_center } else { of_peg });
        }
    }
    keys
}

/// Adds the parameter of a key. One that was named by itself, too, is not optional.
fn add(
    all: &mut Vec<SelectedParameter>,
    key: &str,
    is_optional: bool,
    scenario: &Scenario,
) -> Result<(), FitError> {
    let parameter = Parameter::from_key(key, scenario)?;
    let known = all.iter_mut().find(|known| known.parameter.name() == key);
    match known {
        Some(known) => known.is_optional &= is_optional,
        None => all.push(SelectedParameter {
            parameter,
            is_optional,
        }),
    }
    Ok(())
}

/// The equal angle within half a turn of 0, rad: so estimates of angles that may turn are reported.
pub(in crate::fit) fn principal(angle: f64) -> f64 {
    let turn = 2.0 * PI;
    angle - turn * (angle / turn).round()
}
