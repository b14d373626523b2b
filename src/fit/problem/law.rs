//! Other friction laws for the same data.

use super::model::Problem;
use super::parameter::{self, INITIAL, Parameter, Target};
use super::prepare::SharedClock;
use super::request::Request;
use crate::fit::error::FitError;
use crate::fit::failure::Failure;
use crate::fit::search::fitted::Fitted;
use crate::fit::search::step_limit::MAX_MOTIONS;
use crate::run::scenario::{KEYS, LAWS, Law, Presence, Scenario, ScenarioError, Values};
use crate::run::simulation::sample_at;
use crate::words::sentence;

/// Relative change of χ² that counts as none in a comparison: superfluous parameters run away in many small steps.
const PRECISION: f64 = 1e-7;

/// The law that has its own parameters.
const FORMULA: &str = "formula";

/// Coefficient of friction of a typical top.
const TYPICAL_K: f64 = 0.03;

/// A law that has no complete motion near its minimum, or can't be fitted, and why.
pub(in crate::fit) struct Refused {
    pub law: &'static str,
    pub reason: Failure,
}

/// The sliding law of this name.
pub(in crate::fit) fn find(name: &str) -> Option<&'static Law> {
    LAWS.iter().find(|law| law.name == name && law.is_sliding())
}

/// The sliding laws of these names, each once.
pub(in crate::fit) fn find_laws(names: &[String]) -> Result<Vec<&'static Law>, FitError> {
    let mut laws: Vec<&'static Law> = Vec::new();
    for name in names {
        let law = find(name).ok_or_else(|| unknown_law(name))?;
        if !laws.iter().any(|known| known.name == law.name) {
            laws.push(law);
        }
    }
    Ok(laws)
}

fn unknown_law(name: &str) -> FitError {
    let mut names = Vec::new();
    for law in LAWS.iter().filter(|law| law.is_sliding()) {
        names.push(law.name);
    }
    FitError::refused(sentence!(
        "unknown law {}; laws: {}",
        name.to_owned(),
        names.join(", ")
    ))
}

/// The keys of a law that data determine: with viscous friction only k/v_0, whatever the data; of a formula those that it
/// contains, which a scenario of this law has.
fn keys(law: &Law, scenario: &Scenario) -> Vec<&'static str> {
    let mut keys = Vec::new();
    for key in law.parameters() {
        let is_determined = match key.presence {
            Presence::Parameter(_) => {
                law.name != FORMULA || parameter::value(scenario, key.path).is_some()
            }
            // Only a top at rest tells the static friction of a formula.
            Presence::OfLaws(..) => law.name != FORMULA,
            _ => key.path != "friction.viscous_speed",
        };
        if is_determined {
            keys.push(key.path);
        }
    }
    keys
}

/// The names of the parameters that are usually free: those of the scenario's law, and the start.
pub fn usual_parameters(scenario: &Scenario) -> Vec<String> {
    let mut names = Vec::new();
    if let Some(law) = find(scenario.word("friction.law")) {
        names.extend(keys(law, scenario).into_iter().map(str::to_owned));
    }
    names.push(INITIAL.to_owned());
    names
}

/// A request with another law, from the scenario's start.
pub(in crate::fit) fn request_for(request: &Request, law: &Law) -> Result<Request, FitError> {
    let duration = SharedClock::new(&request.data, &[]).duration();
    let speed = slip_speed(&request.scenario, duration)?;
    let mut other = request.clone();
    other.scenario = scenario_with(&request.scenario, law, speed)?;
    // The parameters of the scenario's law have no meaning in another.
    other.free.retain(|name| !name.starts_with("friction."));
    other
        .free
        .extend(keys(law, &other.scenario).into_iter().map(str::to_owned));
    other.bounds.retain(|(name, _)| {
        !name.starts_with("friction.") || other.free.iter().any(|free| free == name)
    });
    Ok(other)
}

/// Start values of a law's speed: parameters of a speed are seen only near the speeds of the motion.
pub(in crate::fit) fn speeds(law: &Law, slip: f64) -> Vec<f64> {
    if law.name == "stribeck" {
        vec![slip, 0.3 * slip]
    } else {
        vec![slip]
    }
}

/// Mean slip speed of a scenario's motion, m/s.
pub(in crate::fit) fn slip_speed(scenario: &Scenario, duration: f64) -> Result<f64, FitError> {
    /// Number of samples of the motion.
    const SAMPLES: u32 = 100;
    /// A law whose speed is zero is none, m/s.
    const MIN_SPEED: f64 = 1e-3;
    let part = duration / f64::from(SAMPLES);
    let times: Vec<f64> = (0..SAMPLES).map(|i| part * f64::from(i)).collect();
    let (mut sum, mut count) = (0.0, 0.0);
    sample_at(scenario, &times, &mut |_, sample| {
        sum += sample.contact.slip_speed;
        count += 1.0;
    })?;
    Ok((sum / f64::max(count, 1.0)).max(MIN_SPEED))
}

/// The problem of another law, started at the solution of the scenario's own.
pub(in crate::fit) fn problem_for(
    request: &Request,
    fitted: &Fitted,
    law: &Law,
    speed: f64,
) -> Result<Problem, FitError> {
    let own = &fitted.problem;
    let end = fitted.split.end;
    let solved = own.scenario_for(&fitted.solution.values, end)?;
    let scenario = scenario_with(&solved, law, speed)?;
    let mut parameters: Vec<Parameter> = Vec::new();
    for (at, parameter) in own.parameters.iter().enumerate() {
        let is_of_law =
            matches!(parameter.target, Target::Key(key) if key.path.starts_with("friction."));
        if !is_of_law {
            let mut kept = parameter.clone();
            kept.start = fitted.solution.values[at];
            parameters.push(kept);
        }
    }
    for path in keys(law, &scenario) {
        let mut bounds = request.bounds.clone();
        bounds.retain(|(name, _)| name == path);
        for selected in parameter::select(&[path.to_owned()], &bounds, &scenario, 1)? {
            parameters.push(selected.parameter);
        }
    }
    let mut problem = own.clone();
    problem.scenario = scenario;
    problem.parameters = parameters;
    problem.precision = PRECISION;
    problem.limit_steps(&fitted.split.fitted, MAX_MOTIONS);
    Ok(problem)
}

/// A scenario with another law. Its parameters start at typical values, speeds at `speed`, m/s.
fn scenario_with(scenario: &Scenario, law: &Law, speed: f64) -> Result<Scenario, ScenarioError> {
    // From a law without k, or with none, a typical top's friction is as good a start as any.
    let k = parameter::value(scenario, "friction.k")
        .filter(|k| *k > 0.0)
        .unwrap_or(TYPICAL_K);
    let mut values = Values::from_toml(&scenario.to_toml())?;
    for key in KEYS {
        if key.path.starts_with("friction.") && key.path != "friction.dissipation" {
            values.set(key.path, "")?;
        }
    }
    values.set_value("friction.law", law.name)?;
    if law.name == "none" {
        values.set("friction.dissipation", "")?;
    } else if scenario.word("friction.dissipation").is_empty() {
        values.set_value("friction.dissipation", "full")?;
    }
    for key in law.parameters() {
        let start = match key.path {
            "friction.k" if law.name == "stribeck" => 0.9 * k,
            "friction.k" => k,
            "friction.static_k" => 1.5 * k,
            "friction.stribeck_speed" | "friction.viscous_speed" => speed,
            // Close to Coulomb's law, but not so close that nothing depends on it.
            "friction.smoothing_speed" => 0.1 * speed,
            "friction.patch_radius" => 1e-4,
            _ => 0.0,
        };
        values.set_value(key.path, start)?;
    }
    Scenario::new(values)
}
