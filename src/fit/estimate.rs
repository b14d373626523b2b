//! From a minimum to estimates with their uncertainties.

use super::report::{Correlation, Estimate, Limit, Mode, Quality, SignalReport, Verdict};
use super::statistics::{chi2_p_value, mean_p_value, rms, whiteness};
use crate::fit::problem::model::{Loss, Point, Problem};
use crate::fit::search::solve::Solution;
use crate::measured::median_size;
use crate::physics::math::ln;

/// Half width of a 95 % interval, and of a one-sided one, in standard deviations.
pub(super) const TWO_SIDED: f64 = 1.959963984540054;
pub(super) const ONE_SIDED: f64 = 1.6448536269514722;

/// A magnitude below this many standard deviations is not clearly above zero.
const SIGNIFICANT: f64 = 2.0;

/// Correlations above this are reported.
const HIGH_CORRELATION: f64 = 0.9;

/// A residual above this, in σ, is an outlier: of normal noise there is one in two million.
pub(super) const OUTLIER: f64 = 5.0;

/// p-values below this reject a fit.
pub(super) const REJECTED: f64 = 1e-3;

/// Residuals below this, in σ, are not noise: σ was given generously, and nothing follows from their correlations.
const TINY: f64 = 0.1;

/// The estimates of all parameters, without uncertainties where there is no minimum. Intervals reach over the other
/// minima.
pub(super) fn estimates(
    problem: &Problem,
    solution: &Solution,
    modes: &[Mode],
    rescale: f64,
) -> Vec<Estimate> {
    let mut all = Vec::new();
    for (at, parameter) in problem.parameters.iter().enumerate() {
        let value = parameter.reported(solution.values[at]);
        let [low, high] = parameter.bounds.map(|bound| bound + parameter.shift);
        let sd = (solution.covariance[(at, at)] * rescale).sqrt();
        let is_known = !solution.held[at] && sd > 0.0 && sd < high - low;
        // An interval that reaches below zero would be meaningless for a magnitude: it gets a limit.
        let is_significant = !parameter.is_magnitude() || value > SIGNIFICANT * sd;
        let (mut interval, mut limit) = (None, None);
        if !solution.is_converged {
            // The curvature at no minimum says nothing about uncertainties.
        } else if solution.held[at] {
            limit = Some(Limit::AtBound);
        } else if !is_known {
            limit = Some(Limit::None);
        } else if is_significant {
            let mut range = [value - TWO_SIDED * sd, value + TWO_SIDED * sd];
            for mode in modes {
                range[0] = range[0].min(mode.values[at] - TWO_SIDED * mode.sds[at]);
                range[1] = range[1].max(mode.values[at] + TWO_SIDED * mode.sds[at]);
            }
            // Far minima are less exact, and may be near a bound.
            if !modes.is_empty() {
                range = range.map(|end| end.clamp(low, high));
            }
            interval = Some(range);
        } else {
            limit = Some(Limit::Below((value + ONE_SIDED * sd).min(high)));
        }
        all.push(Estimate {
            name: parameter.name(),
            unit: parameter.unit().to_owned(),
            start: parameter.start + parameter.shift,
            value,
            sd: (is_known && solution.is_converged).then_some(sd),
            interval,
            limit,
        });
    }
    all
}

/// The correlations between parameters that are high.
pub(super) fn correlations(problem: &Problem, solution: &Solution) -> Vec<Correlation> {
    let mut high = Vec::new();
    if !solution.is_converged {
        return high;
    }
    let covariance = &solution.covariance;
    for i in 0..problem.parameters.len() {
        for j in 0..i {
            let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
            let correlation = covariance[(i, j)] / scale;
            if scale > 0.0 && correlation.abs() > HIGH_CORRELATION {
                high.push(Correlation {
                    parameters: [j, i].map(|at| problem.parameters[at].name()),
                    correlation,
                });
            }
        }
    }
    high
}

/// Goodness of a fit to these points.
pub(super) fn quality(problem: &Problem, points: &[Point], solution: &Solution) -> Quality {
    let estimated = problem
        .signals
        .iter()
        .filter(|signal| signal.is_sigma_estimated)
        .count();
    let freedom = points.len().saturating_sub(problem.parameters.len());
    // Estimated deviations make χ²/ν about 1 whatever the fit, and Huber's loss is no sum of squares.
    let is_tested = estimated == 0 && problem.loss == Loss::Squares;
    let deviance = deviance(problem, points, solution);
    // An estimated σ is a parameter like the others.
    let parameters = (problem.parameters.len() + estimated) as f64;
    Quality {
        chi2: solution.chi2,
        freedom,
        p_value: is_tested.then(|| chi2_p_value(solution.chi2, freedom as f64)),
        is_converged: solution.is_converged,
        aic: deviance + 2.0 * parameters,
        bic: deviance + parameters * ln(points.len() as f64),
    }
}

/// −2 ln L up to a constant that all laws share: χ² where σ is given, n ln(RSS/n) + n where it is estimated, that is, at
/// its most likely value.
fn deviance(problem: &Problem, points: &[Point], solution: &Solution) -> f64 {
    let mut deviance = solution.chi2;
    for (index, signal) in problem.signals.iter().enumerate() {
        if !signal.is_sigma_estimated {
            continue;
        }
        let (mut loss, mut sigma, mut count) = (0.0, 0.0, 0.0);
        for (point, residual) in points.iter().zip(&solution.residuals) {
            if point.signal == index {
                let deviate = problem.loss.transformed(*residual);
                loss += deviate * deviate;
                sigma = point.sigma;
                count += 1.0;
            }
        }
        if count > 0.0 && problem.loss == Loss::Huber {
            // The robust σ is not the most likely one, so the loss stands for itself.
            deviance += 2.0 * count * ln(sigma);
        } else if count > 0.0 {
            let likely = (loss / count).sqrt() * sigma;
            deviance += count + 2.0 * count * ln(likely.max(signal.rounding())) - loss;
        }
    }
    deviance
}

/// Points with their residuals, in σ.
#[derive(Clone, Copy)]
pub(super) struct PointResiduals<'a> {
    pub points: &'a [Point],
    pub residuals: &'a [f64],
}

impl PointResiduals<'_> {
    /// The residuals of a signal.
    fn residuals_for(self, signal: usize) -> Vec<f64> {
        let pairs = self.points.iter().zip(self.residuals);
        pairs
            .filter(|(point, _)| point.signal == signal)
            .map(|(_, residual)| *residual)
            .collect()
    }
}

/// The signals with their residuals in the fitted and the held-out part.
pub(super) fn signals(
    problem: &Problem,
    fitted: PointResiduals<'_>,
    held_out: Option<PointResiduals<'_>>,
) -> Vec<SignalReport> {
    let mut reports = Vec::new();
    for (index, signal) in problem.signals.iter().enumerate() {
        let residuals = fitted.residuals_for(index);
        let later = held_out
            .map(|held_out| held_out.residuals_for(index))
            .unwrap_or_default();
        let rms_here = rms(&residuals);
        // As the loss counts them, so that an outlier neither hides nor feigns a correlation.
        let clipped: Vec<f64> = residuals.iter().map(|r| problem.loss.clipped(*r)).collect();
        reports.push(SignalReport {
            field: signal.field.to_string(),
            source: signal.name.clone(),
            file: signal.file + 1,
            unit: signal.field.unit().to_owned(),
            sigma: median_size(&signal.sigmas),
            is_sigma_estimated: signal.is_sigma_estimated,
            samples: residuals.len(),
            missing: signal.missing,
            outside: signal
                .times
                .len()
                .saturating_sub(residuals.len() + later.len()),
            out_of_order: signal.out_of_order,
            rms: rms_here,
            held_out_rms: (!later.is_empty()).then(|| rms(&later)),
            held_out_samples: later.len(),
            outliers: residuals.iter().filter(|r| r.abs() > OUTLIER).count(),
            whiteness: whiteness(&clipped).filter(|_| rms_here > TINY),
            mean: residuals.iter().sum::<f64>() / residuals.len().max(1) as f64,
            mean_p_value: mean_p_value(&clipped).filter(|_| rms_here > TINY),
            scatter: signal.is_sigma_estimated.then(|| signal.scatter()),
        });
    }
    reports
}

/// Whether a model describes the data: neither χ² nor the residuals' correlations and means reject it, and an estimated σ
/// is not far above the scatter of the data themselves.
pub(super) fn verdict(quality: &Quality, signals: &[SignalReport]) -> Verdict {
    let is_rejected = quality.p_value.is_some_and(|p| p < REJECTED);
    let is_odd = signals
        .iter()
        .any(|signal| signal.excess_scatter().is_some() || signal.is_mostly_outliers());
    if !quality.is_converged {
        Verdict::NotConverged
    } else if is_rejected || is_odd || lowest_p(signals).is_some_and(|p| p < REJECTED) {
        Verdict::BadFit
    } else {
        Verdict::Fitted
    }
}

/// The lowest p-value of the tests of residuals for correlations and for a constant error.
pub(super) fn lowest_p(signals: &[SignalReport]) -> Option<f64> {
    signals
        .iter()
        .flat_map(|signal| [signal.whiteness, signal.mean_p_value])
        .flatten()
        .min_by(f64::total_cmp)
}
