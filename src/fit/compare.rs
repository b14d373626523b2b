//! Comparison of friction laws.

use super::conclusion::{Conclusion, Flaw, Rival};
use super::error::{FitError, nothing_free};
use super::estimate::{PointResiduals, REJECTED, estimates, lowest_p, signals, verdict};
use super::failure::Failure;
use super::report::{Comparison, LawFit, Verdict};
use super::statistics::rms;
use crate::fit::problem::law::{Refused, find, find_laws, problem_for, slip_speed, speeds};
use crate::fit::problem::model::{Effort, Point, Problem};
use crate::fit::problem::request::Request;
use crate::fit::search::extension::extensions;
use crate::fit::search::fitted::Fitted;
use crate::fit::search::modes;
use crate::fit::search::monitor::Monitor;
use crate::fit::search::sigma::settle;
use crate::fit::search::solve::{Solution, complete, grow_window, minimise, refused_step};
use crate::measured::median_size;
use crate::run::scenario::Law;
use rayon::prelude::*;

/// A law is clearly better if AIC and BIC are both lower by this: the other is 20 times less likely (Burnham & Anderson).
const DECISIVE: f64 = 6.0;

/// χ² of a law, relative to that of the scenario's own, above which another start is tried if it has not converged.
const MUCH_WORSE: f64 = 1.5;

/// A comparison, and the fit of the law that it prefers if that is another one.
pub(super) struct ComparedLaws {
    pub comparison: Comparison,
    pub preferred: Option<Fitted>,
}

/// Fits the laws that a request names and ranks them. `own` is the fit of one of them, or of the scenario's law;
/// `refused` ones are listed, not tried again.
pub(super) fn compare(
    request: &Request,
    own: &Fitted,
    refused: Vec<Refused>,
    monitor: &Monitor<'_>,
) -> Result<ComparedLaws, FitError> {
    let mut laws = find_laws(&request.compare)?;
    // The law that is fitted already is what others are compared with.
    if let Some(law) = find(own.law()).filter(|own| laws.iter().all(|law| law.name != own.name)) {
        laws.insert(0, law);
    }
    let scenarios = find(request.scenario.word("friction.law"));
    if let Some(law) = scenarios.filter(|own| laws.iter().all(|law| law.name != own.name)) {
        laws.push(law);
    }
    laws.retain(|law| !refused.iter().any(|refused| refused.law == law.name));
    // Threads don't report progress: their order would be seen. Their simulations are counted afterwards.
    let results: Vec<_> = laws
        .par_iter()
        .map(|law| {
            let silent = Monitor::new(&|_| {});
            let candidate = fit_law(request, own, law, &silent);
            (law.name, candidate, silent.evaluations())
        })
        .collect();
    let (mut candidates, mut failures) = (Vec::new(), refused);
    for (law, candidate, evaluations) in results {
        monitor.add(evaluations);
        match candidate {
            Ok(candidate) => candidates.push(candidate),
            Err(error) => failures.push(Refused {
                law,
                reason: Failure::from(&error),
            }),
        }
    }
    candidates.sort_by(|a, b| a.quality().bic.total_cmp(&b.quality().bic));
    // The other minima of `own` are known already.
    if let Some(best) = candidates.first_mut()
        && best.law() != own.law()
    {
        // Criteria of laws compare fits to the same points, so a better minimum of an offset is only listed.
        modes::find(best, modes::Listed::AllButOwn, monitor)?;
    }
    let mut fits: Vec<LawFit> = Vec::new();
    for candidate in &candidates {
        fits.push(law_fit(candidate, request));
    }
    for (at, inner) in contained(&candidates) {
        fits[at].reduces_to = Some(fits[inner].law.clone());
        fits[at].verdict = fits[inner].verdict;
    }
    set_differences(&mut fits);
    let mut comparison = Comparison {
        laws: fits,
        extensions: Vec::new(),
    };
    let is_decided = comparison.is_decided();
    if let [best, rival, ..] = &candidates[..]
        && !is_decided
        && comparison.laws[0].verdict == Verdict::Fitted
    {
        comparison.extensions = extensions(best, rival, monitor)?;
    }
    for refused in failures {
        comparison.laws.push(failed(refused));
    }
    let best = candidates.into_iter().next();
    Ok(ComparedLaws {
        comparison,
        preferred: best.filter(|best| is_decided && best.law() != own.law()),
    })
}

/// The laws whose best motion is that of a law with fewer parameters: the index of each, and that of the other. Their own
/// parameters are not determined, so that their fits need not have a minimum.
fn contained(candidates: &[Fitted]) -> Vec<(usize, usize)> {
    /// Difference of the motions, in σ of all values together: that of two minima of one motion is much smaller.
    const SAME: f64 = 0.1;
    let mut found = Vec::new();
    for (at, law) in candidates.iter().enumerate() {
        let inner = candidates.iter().position(|inner| {
            let mut sum = 0.0;
            let pairs = law.split.fitted.iter().zip(&inner.split.fitted);
            let residuals = law.solution.residuals.iter().zip(&inner.solution.residuals);
            for ((point, other), (residual, inner)) in pairs.zip(residuals) {
                let difference = residual * point.sigma - inner * other.sigma;
                let in_sigma = difference / other.sigma;
                sum += in_sigma * in_sigma;
            }
            let is_simpler = inner.problem.parameters.len() < law.problem.parameters.len();
            is_simpler && inner.solution.is_converged && sum < SAME * SAME
        });
        found.extend(inner.map(|inner| (at, inner)));
    }
    found
}

/// Sets the criteria of laws relative to the lowest.
fn set_differences(fits: &mut [LawFit]) {
    // The lowest AIC and the lowest BIC may belong to different laws.
    let (mut lowest_aic, mut lowest_bic) = (f64::INFINITY, f64::INFINITY);
    for quality in fits.iter().filter_map(|fit| fit.quality.as_ref()) {
        lowest_aic = lowest_aic.min(quality.aic);
        lowest_bic = lowest_bic.min(quality.bic);
    }
    for fit in fits {
        let quality = fit.quality.as_ref();
        fit.delta_aic = quality.map(|quality| quality.aic - lowest_aic);
        fit.delta_bic = quality.map(|quality| quality.bic - lowest_bic);
    }
}

impl Comparison {
    /// The conclusion from the fits of all laws.
    pub fn conclusion(&self) -> Conclusion {
        // A law that reduces to another is that one.
        let fits: Vec<&LawFit> = self
            .laws
            .iter()
            .filter(|law| law.failure.is_none() && law.reduces_to.is_none())
            .collect();
        let [first, others @ ..] = &fits[..] else {
            return Conclusion::NothingFitted;
        };
        let Some(best) = fits.iter().find(|fit| fit.verdict == Verdict::Fitted) else {
            return Conclusion::NothingDescribes {
                law: first.law.clone(),
                flaw: first.flaw(),
            };
        };
        if best.law == first.law {
            return first.compared_with(others);
        }
        Conclusion::NotLowest {
            law: best.law.clone(),
            lowest: first.law.clone(),
            flaw: first.flaw(),
        }
    }

    /// Whether one law is clearly best and describes the data.
    pub fn is_decided(&self) -> bool {
        matches!(self.conclusion(), Conclusion::Decided { .. })
    }

    /// The verdict on all laws together.
    pub(super) fn verdict(&self) -> Verdict {
        let describes = self.laws.iter().any(|law| law.verdict == Verdict::Fitted);
        if self.is_decided() {
            Verdict::Fitted
        } else if describes {
            Verdict::Undecided
        } else {
            // A law that is ahead without a minimum might describe the data.
            let first = self.laws.first().map(|law| law.verdict);
            first.unwrap_or(Verdict::NotConverged)
        }
    }
}

impl LawFit {
    /// The conclusion if this law has the lowest BIC and describes the data.
    fn compared_with(&self, others: &[&Self]) -> Conclusion {
        let law = self.law.clone();
        let (mut alike, mut unfinished) = (Vec::new(), Vec::new());
        let mut is_open = false;
        for other in others {
            // Both criteria: AIC favours laws with more parameters, BIC those with fewer.
            let [aic, bic] = other.worse_than(self);
            let is_alike = aic < DECISIVE || bic < DECISIVE;
            is_open |= is_alike;
            if other.verdict == Verdict::NotConverged {
                unfinished.push(other.law.clone());
            } else if is_alike {
                alike.push(other.law.clone());
            }
        }
        if is_open {
            return Conclusion::Undecided {
                law,
                alike,
                unfinished,
            };
        }
        Conclusion::Decided {
            law,
            next: others.first().map(|next| {
                let [delta_aic, delta_bic] = next.worse_than(self);
                Rival {
                    law: next.law.clone(),
                    delta_aic,
                    delta_bic,
                }
            }),
            unfinished,
        }
    }

    /// AIC and BIC above those of another law.
    fn worse_than(&self, other: &Self) -> [f64; 2] {
        [
            self.delta_aic.unwrap_or_default() - other.delta_aic.unwrap_or_default(),
            self.delta_bic.unwrap_or_default() - other.delta_bic.unwrap_or_default(),
        ]
    }

    /// Why the law does not describe the data.
    fn flaw(&self) -> Flaw {
        let Some(quality) = self.quality.as_ref().filter(|quality| quality.is_converged) else {
            return Flaw::NoMinimum;
        };
        if quality.p_value.is_some_and(|p| p < REJECTED) {
            Flaw::Size {
                reduced_chi2: quality.chi2 / quality.freedom as f64,
            }
        } else if self.residual_p_value.is_some_and(|p| p < REJECTED) {
            Flaw::Residuals
        } else {
            Flaw::Sigma
        }
    }
}

/// A law that could not be fitted.
fn failed(refused: Refused) -> LawFit {
    LawFit {
        law: refused.law.to_owned(),
        verdict: Verdict::NotConverged,
        reduces_to: None,
        residual_p_value: None,
        quality: None,
        delta_aic: None,
        delta_bic: None,
        sigmas: Vec::new(),
        held_out_rms: None,
        parameters: Vec::new(),
        failure: Some(refused.reason),
    }
}

fn law_fit(candidate: &Fitted, request: &Request) -> LawFit {
    let Fitted {
        problem,
        solution,
        split,
        ..
    } = candidate;
    let quality = candidate.quality();
    let rescale = if request.rescale {
        quality.chi2 / quality.freedom as f64
    } else {
        1.0
    };
    let held_out = problem.residuals(Effort::Final, &solution.values, &split.held_out);
    let fitted = PointResiduals {
        points: &split.fitted,
        residuals: &solution.residuals,
    };
    let signals = signals(problem, fitted, None);
    LawFit {
        law: candidate.law().to_owned(),
        verdict: verdict(&quality, &signals),
        reduces_to: None,
        residual_p_value: lowest_p(&signals),
        quality: Some(quality),
        delta_aic: None,
        delta_bic: None,
        sigmas: problem
            .signals
            .iter()
            .map(|signal| median_size(&signal.sigmas))
            .collect(),
        held_out_rms: held_out.ok().filter(|r| !r.is_empty()).map(|r| rms(&r)),
        parameters: estimates(problem, solution, &candidate.modes, rescale),
        failure: None,
    }
}

/// Fits one law: from the solution of `own`, and from the start if that fails. It has standard deviations of its own
/// where they are estimated: those of a law that misses the data would make the residuals of a better one look small.
fn fit_law(
    request: &Request,
    own: &Fitted,
    law: &'static Law,
    monitor: &Monitor<'_>,
) -> Result<Fitted, FitError> {
    if own.law() == law.name {
        return Ok(own.clone());
    }
    let end = own.split.end;
    let solved = own.problem.scenario_for(&own.solution.values, end)?;
    // The points carry the standard deviations, which are this law's own.
    let mut split = own.split.clone();
    let mut best: Option<(Problem, Solution)> = None;
    for speed in speeds(law, slip_speed(&solved, end)?) {
        let problem = problem_for(request, own, law, speed)?;
        let solution = solve_law(&problem, &mut split.fitted, own.solution.chi2, monitor)?;
        let is_better = best
            .as_ref()
            .is_none_or(|(_, known)| solution.chi2 < known.chi2);
        if is_better {
            best = Some((problem, solution));
        }
    }
    let (mut problem, found) = best.ok_or_else(nothing_free)?;
    let solution = settle(&mut problem, &mut split, found, monitor)?;
    if !solution.is_converged
        && let Some(refusal) = refused_step(&problem, &split.fitted, &solution)
    {
        return Err(refusal);
    }
    Ok(Fitted {
        problem,
        solution,
        split,
        modes: Vec::new(),
    })
}

/// Minimises from the solution of another law with this χ²; grows windows if there is no good minimum nearby.
fn solve_law(
    problem: &Problem,
    points: &mut [Point],
    chi2: f64,
    monitor: &Monitor<'_>,
) -> Result<Solution, FitError> {
    let start = problem.start();
    let fixed = vec![false; start.len()];
    let near = match complete(problem, points, start.clone()) {
        Ok(values) => Some(minimise(problem, points, &values, None, &fixed, monitor)?),
        Err(_) => None,
    };
    match near {
        Some(near) if near.is_converged || near.chi2 < MUCH_WORSE * chi2 => Ok(near),
        Some(near) => {
            let grown = grow_window(problem, points, &start, false, monitor)?;
            Ok(if grown.chi2 < near.chi2 { grown } else { near })
        }
        None => grow_window(problem, points, &start, false, monitor),
    }
}
