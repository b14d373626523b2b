//! Comparison of friction laws.

use super::error::FitError;
use super::estimate::{REJECTED, estimates, lowest_p, quality, signals, verdict};
use super::extension::extensions;
use super::model::{Effort, Point, Problem};
use super::modes::{Modes, modes};
use super::parameter::{self, Parameter, Target};
use super::report::{Comparison, LawFit, Mode, Verdict};
use super::solve::{Solution, Watch, complete, grow, minimise};
use super::statistics::rms;
use super::{Request, Split};
use crate::run::scenario::{KEYS, LAWS, Law, Scenario, ScenarioError, Values};
use rayon::prelude::*;

/// A law is clearly better if AIC and BIC are both lower by this: the other is 20 times less likely (Burnham & Anderson).
const DECISIVE: f64 = 6.0;

/// Relative change of χ² that counts as none in a comparison: superfluous parameters run away in many small steps.
const PRECISION: f64 = 1e-7;

/// χ² of a law, relative to that of the scenario's own, above which another start is tried if it has not converged.
const MUCH_WORSE: f64 = 1.5;

/// The fit of the scenario's own law.
pub(super) struct Fitted<'a> {
    pub problem: &'a Problem,
    pub solution: &'a Solution,
    pub split: &'a Split,
}

/// The fit of another law.
#[derive(Clone)]
pub(super) struct Candidate {
    pub law: &'static str,
    pub problem: Problem,
    pub solution: Solution,
}

/// A comparison, and the fit of the law that it prefers, with its other minima.
pub(super) struct Compared {
    pub comparison: Comparison,
    pub preferred: Option<(Candidate, Vec<Mode>)>,
}

/// Fits the laws that a request names and ranks them.
pub(super) fn compare(
    request: &Request,
    fitted: &Fitted<'_>,
    watch: &Watch<'_>,
) -> Result<Compared, FitError> {
    let mut laws: Vec<&'static Law> = Vec::new();
    for name in &request.compare {
        let law = LAWS.iter().find(|law| law.name == name && law.is_sliding());
        let law = law.ok_or_else(|| unknown_law(name))?;
        if !laws.iter().any(|known| known.name == law.name) {
            laws.push(law);
        }
    }
    // Threads don't report progress: their order would be seen. Their simulations are counted afterwards.
    let results: Vec<_> = laws
        .par_iter()
        .map(|law| {
            let silent = Watch::new(&|_| {});
            let candidate = fit_law(request, fitted, law, &silent);
            (law.name, candidate, silent.evaluations())
        })
        .collect();
    let (mut candidates, mut failures) = (Vec::new(), Vec::new());
    for (law, candidate, evaluations) in results {
        watch.add(evaluations);
        match candidate {
            Ok(candidate) => candidates.push(candidate),
            Err(error) => failures.push((law, error.to_string())),
        }
    }
    let points = &fitted.split.fitted;
    candidates.sort_by(|a, b| {
        let [a, b] = [a, b].map(|c| quality(&c.problem, points, &c.solution).bic);
        a.total_cmp(&b)
    });
    // The other minima of the scenario's own law are known already.
    let own = fitted.problem.scenario.word("friction.law");
    let mut other_modes = Vec::new();
    if let Some(best) = candidates.first_mut().filter(|best| best.law != own) {
        let Modes {
            best: found,
            others,
        } = modes(&best.problem, points, &best.solution, watch)?;
        best.solution = found;
        other_modes = others;
    }
    let mut fits: Vec<LawFit> = Vec::new();
    for candidate in &candidates {
        fits.push(law_fit(candidate, fitted.split, request));
    }
    let lowest_aic = fits
        .iter()
        .map(|fit| fit.quality.aic)
        .fold(f64::INFINITY, f64::min);
    let lowest_bic = fits
        .iter()
        .map(|fit| fit.quality.bic)
        .fold(f64::INFINITY, f64::min);
    for fit in &mut fits {
        fit.delta_aic = fit.quality.aic - lowest_aic;
        fit.delta_bic = fit.quality.bic - lowest_bic;
    }
    let (is_decided, sentence) = conclusion(&fits);
    let mut extended = Vec::new();
    if let [best, rival, ..] = &candidates[..]
        && !is_decided
        && fits[0].verdict == Verdict::Fitted
    {
        extended = extensions(best, rival, fitted.split, watch)?;
    }
    for (law, failure) in failures {
        fits.push(failed(law, failure, &fits));
    }
    let best = candidates.into_iter().next();
    let preferred = best.filter(|best| is_decided && best.law != own);
    Ok(Compared {
        comparison: Comparison {
            laws: fits,
            is_decided,
            sentence,
            extensions: extended,
        },
        preferred: preferred.map(|candidate| (candidate, other_modes)),
    })
}

impl Comparison {
    /// The verdict on all laws together.
    pub(super) fn verdict(&self) -> Verdict {
        let has = |verdict| self.laws.iter().any(|law| law.verdict == verdict);
        if self.is_decided {
            Verdict::Fitted
        } else if has(Verdict::Fitted) {
            Verdict::Undecided
        } else {
            // A law that is ahead without a minimum might describe the data.
            let first = self.laws.first().map(|law| law.verdict);
            first.unwrap_or(Verdict::NotConverged)
        }
    }
}

fn unknown_law(name: &str) -> FitError {
    let sliding = LAWS.iter().filter(|law| law.is_sliding());
    let names: Vec<&str> = sliding.map(|law| law.name).collect();
    FitError::UnknownLaw {
        name: name.to_owned(),
        known: names.join(", "),
    }
}

/// A law that could not be fitted. Its numbers are those of no fit at all.
fn failed(law: &str, failure: String, fits: &[LawFit]) -> LawFit {
    let freedom = fits.first().map_or(0, |fit| fit.quality.freedom);
    LawFit {
        law: law.to_owned(),
        verdict: Verdict::NotConverged,
        residual_p_value: None,
        quality: super::report::Quality {
            chi2: f64::MAX,
            freedom,
            p_value: None,
            is_converged: false,
            aic: f64::MAX,
            bic: f64::MAX,
        },
        delta_aic: f64::MAX,
        delta_bic: f64::MAX,
        held_out_rms: None,
        parameters: Vec::new(),
        failure: Some(failure),
    }
}

fn law_fit(candidate: &Candidate, split: &Split, request: &Request) -> LawFit {
    let Candidate {
        law,
        problem,
        solution,
    } = candidate;
    let quality = quality(problem, &split.fitted, solution);
    let rescale = if request.rescale {
        quality.chi2 / quality.freedom as f64
    } else {
        1.0
    };
    let held_out = problem
        .residuals(Effort::Final, &solution.values, &split.held_out)
        .ok();
    let signals = signals(problem, (&split.fitted, &solution.residuals), None);
    LawFit {
        law: (*law).to_owned(),
        verdict: verdict(&quality, &signals),
        residual_p_value: lowest_p(&signals),
        quality,
        delta_aic: 0.0,
        delta_bic: 0.0,
        held_out_rms: held_out.filter(|r| !r.is_empty()).map(|r| rms(&r)),
        parameters: estimates(problem, solution, rescale),
        failure: None,
    }
}

/// Whether one law, the first, is to be preferred, and a sentence about it.
fn conclusion(fits: &[LawFit]) -> (bool, String) {
    let Some(first) = fits.first() else {
        return (false, "None of the laws could be fitted.".to_owned());
    };
    let describing = fits.iter().find(|fit| fit.verdict == Verdict::Fitted);
    let Some(best) = describing else {
        return (
            false,
            format!("None of the laws describes the data: {}.", flaw(first)),
        );
    };
    if best.law != first.law {
        let sentence = format!(
            "Undecided: {} describes the data, but its BIC is not the lowest: {}.",
            best.law,
            flaw(first)
        );
        return (false, sentence);
    }
    let others = &fits[1..];
    let mut equals = Vec::new();
    for other in others {
        if other.delta_aic - best.delta_aic < DECISIVE || other.delta_bic < DECISIVE {
            equals.push(other.law.as_str());
        }
    }
    if !equals.is_empty() {
        let sentence = format!(
            "Undecided: the data do not tell {} from {}.",
            best.law,
            equals.join(" and ")
        );
        return (false, sentence);
    }
    let mut sentence = match others {
        [] => format!("{} describes the data.", best.law),
        [next, ..] => format!(
            "{} describes the data; the next law, {}, is worse by ΔAIC = {:.1} and ΔBIC = {:.1}.",
            best.law,
            next.law,
            next.delta_aic - best.delta_aic,
            next.delta_bic
        ),
    };
    for other in others {
        if other.verdict == Verdict::NotConverged {
            sentence += &format!(
                " No minimum was found for {}: its criteria may be lower than shown.",
                other.law
            );
        }
    }
    (true, sentence)
}

/// Why a law does not describe the data.
fn flaw(fit: &LawFit) -> String {
    let law = &fit.law;
    if !fit.quality.is_converged {
        format!("no minimum was found for {law}")
    } else if fit.quality.p_value.is_some_and(|p| p < REJECTED) {
        let reduced = fit.quality.chi2 / fit.quality.freedom as f64;
        format!("{law}, which has the lowest BIC, has χ²/ν = {reduced:.2}")
    } else if fit.residual_p_value.is_some_and(|p| p < REJECTED) {
        format!("the residuals of {law}, which has the lowest BIC, are not white")
    } else {
        format!("the standard deviations estimated for {law} have no meaning")
    }
}

/// Fits one law: from the solution of the scenario's own law, and from the start if that fails.
fn fit_law(
    request: &Request,
    fitted: &Fitted<'_>,
    law: &'static Law,
    watch: &Watch<'_>,
) -> Result<Candidate, FitError> {
    let own = fitted.problem;
    if own.scenario.word("friction.law") == law.name {
        return Ok(Candidate {
            law: law.name,
            problem: own.clone(),
            solution: fitted.solution.clone(),
        });
    }
    let points = &fitted.split.fitted;
    let slip = slip_speed(own, fitted.solution, fitted.split.end)?;
    let mut best: Option<Candidate> = None;
    for speed in speeds(law, slip) {
        let problem = problem_for(request, fitted, law, speed)?;
        let solution = solve_law(&problem, points, fitted.solution.chi2, watch)?;
        let is_better = best
            .as_ref()
            .is_none_or(|b| solution.chi2 < b.solution.chi2);
        if is_better {
            best = Some(Candidate {
                law: law.name,
                problem,
                solution,
            });
        }
    }
    best.ok_or(FitError::NothingFree)
}

/// Minimises from the solution of another law with this χ²; grows windows if there is no good minimum nearby.
fn solve_law(
    problem: &Problem,
    points: &[Point],
    chi2: f64,
    watch: &Watch<'_>,
) -> Result<Solution, FitError> {
    let start = problem.start();
    let fixed = vec![false; start.len()];
    let near = match complete(problem, points, start.clone()) {
        Ok(values) => Some(minimise(problem, points, &values, None, &fixed, watch)?),
        Err(_) => None,
    };
    match near {
        Some(near) if near.is_converged || near.chi2 < MUCH_WORSE * chi2 => Ok(near),
        Some(near) => {
            let grown = grow(problem, points, &start, false, watch)?;
            Ok(if grown.chi2 < near.chi2 { grown } else { near })
        }
        None => grow(problem, points, &start, false, watch),
    }
}

/// Start values of a law's speed: parameters of a speed are seen only near the speeds of the motion.
fn speeds(law: &Law, slip: f64) -> Vec<f64> {
    if law.name == "stribeck" {
        vec![slip, 0.3 * slip]
    } else {
        vec![slip]
    }
}

/// Mean slip speed of the solution, m/s.
fn slip_speed(problem: &Problem, solution: &Solution, end: f64) -> Result<f64, FitError> {
    use crate::run::simulation::sample_at;
    let scenario = problem.scenario_for(&solution.values, end)?;
    let times: Vec<f64> = (0..100).map(|i| end * f64::from(i) / 100.0).collect();
    let mut sum = 0.0;
    sample_at(&scenario, &times, &mut |_, sample| {
        sum += sample.contact.slip_speed;
    })?;
    Ok((sum / times.len() as f64).max(1e-3))
}

/// The problem of another law, started at the solution of the scenario's own.
fn problem_for(
    request: &Request,
    fitted: &Fitted<'_>,
    law: &Law,
    speed: f64,
) -> Result<Problem, FitError> {
    let own = fitted.problem;
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
    for key in law.parameters() {
        // Only k/v_0 is determined, whatever the data.
        if key.path != "friction.viscous_speed" {
            let bounds: Vec<_> = request
                .bounds
                .iter()
                .filter(|(name, _)| name == key.path)
                .cloned()
                .collect();
            let names = [key.path.to_owned()];
            for named in parameter::parameters(&names, &bounds, &scenario, 1)? {
                parameters.push(named.parameter);
            }
        }
    }
    let mut problem = own.clone();
    problem.scenario = scenario;
    problem.parameters = parameters;
    problem.precision = PRECISION;
    Ok(problem)
}

/// A scenario with another law. Its parameters start at typical values, speeds at `speed`, m/s.
fn scenario_with(scenario: &Scenario, law: &Law, speed: f64) -> Result<Scenario, ScenarioError> {
    let k = parameter::value(scenario, "friction.k").filter(|k| *k > 0.0);
    let k = k.unwrap_or(0.03);
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
