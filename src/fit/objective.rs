//! The sum of squares as the optimiser sees it.

use super::error::FitError;
use super::model::{Effort, Point, Problem};
use super::monitor::Monitor;
use rmpfit::{MPConfig, MPError, MPFitter, MPPar, MPResult, MPSide, MPSuccess};

/// What a residual of a refused motion counts: more than any that can be measured, but its square is finite.
const REFUSED: f64 = 1e30;

/// Maximum number of iterations in a window, and in the last one.
const ITERATIONS: usize = 25;
const LAST_ITERATIONS: usize = 50;

/// The objective as the optimiser sees it: parameters in units of their scales.
pub(super) struct Objective<'a> {
    problem: &'a Problem,
    points: &'a [Point],
    /// Centre of weak priors.
    priors: Option<&'a [f64]>,
    held: Vec<bool>,
    limits: Vec<MPPar>,
    effort: Effort,
    config: MPConfig,
    monitor: &'a Monitor<'a>,
    /// The last values that were computed, and their residuals.
    last: Option<(Vec<f64>, Vec<f64>)>,
    /// Whether the last run ended because it had no more iterations.
    is_exhausted: bool,
}

impl<'a> Objective<'a> {
    pub(super) fn new(
        problem: &'a Problem,
        points: &'a [Point],
        priors: Option<&'a [f64]>,
        held: Vec<bool>,
        monitor: &'a Monitor<'a>,
    ) -> Self {
        let mut limits = Vec::new();
        for (parameter, is_held) in problem.parameters.iter().zip(&held) {
            let [low, high] = parameter.bounds;
            limits.push(MPPar {
                fixed: *is_held,
                limited_low: low > f64::MIN,
                limited_up: high < f64::MAX,
                limit_low: low / parameter.scale,
                limit_up: high / parameter.scale,
                // The derivatives are those of `jacobian` below, not the optimiser's one-sided differences.
                side: MPSide::User,
                ..MPPar::new()
            });
        }
        // A fit with priors is that of a window on the way: its minimum is only where the next one starts.
        let max_iter = if priors.is_some() {
            ITERATIONS
        } else {
            LAST_ITERATIONS
        };
        Self {
            problem,
            points,
            priors,
            limits,
            held,
            effort: Effort::Final,
            config: MPConfig {
                max_iter,
                ..MPConfig::new()
            },
            monitor,
            last: None,
            is_exhausted: false,
        }
    }

    /// Whether the last run ended because it had no more iterations, and not in a minimum.
    pub(super) fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    /// Ends after this many iterations.
    pub(super) fn limited_to(mut self, iterations: usize) -> Self {
        self.config.max_iter = iterations;
        self
    }

    /// Optimises with drafts of motions. Returns `start` if its draft ends before the data, as one that just reaches
    /// them may.
    pub(super) fn run_drafts(
        &mut self,
        start: &[f64],
        precision: f64,
    ) -> Result<Vec<f64>, FitError> {
        let draft = self.problem.residuals(Effort::Draft, start, self.points);
        self.monitor.count(1, f64::NAN);
        if draft.is_err() {
            return Ok(start.to_vec());
        }
        self.effort = Effort::Draft;
        self.config.ftol = precision;
        self.run(start)
    }

    /// Optimises with exact motions.
    pub(super) fn run_finally(
        &mut self,
        start: &[f64],
        precision: f64,
    ) -> Result<Vec<f64>, FitError> {
        self.effort = Effort::Final;
        self.config.ftol = precision;
        // Those of drafts are not exact.
        self.last = None;
        self.run(start)
    }

    /// Optimises from `start`.
    fn run(&mut self, start: &[f64]) -> Result<Vec<f64>, FitError> {
        // The optimiser's steps are isotropic, so it gets numbers of order 1.
        let mut scaled: Vec<f64> = start
            .iter()
            .zip(&self.problem.parameters)
            .map(|(value, parameter)| value / parameter.scale)
            .collect();
        // Rounding must not take the start out of the bounds.
        for (value, limits) in scaled.iter_mut().zip(&self.limits) {
            *value = value.max(limits.limit_low).min(limits.limit_up);
        }
        match self.mpfit(&mut scaled) {
            Ok(status) => {
                self.is_exhausted = matches!(status.success, MPSuccess::MaxIter);
                Ok(self.values(&scaled))
            }
            Err(error) => Err(FitError::Optimiser(reason(&error))),
        }
    }

    /// The values of the parameters. Dividing by a scale and multiplying again may round to beyond a bound.
    fn values(&self, scaled: &[f64]) -> Vec<f64> {
        self.problem
            .parameters
            .iter()
            .zip(scaled)
            .map(|(parameter, scaled)| parameter.clamp(scaled * parameter.scale))
            .collect()
    }

    /// Fills in the residuals as their loss counts them, and those of the priors.
    fn fill(&self, values: &[f64], residuals: &[f64], deviates: &mut [f64]) {
        for (deviate, residual) in deviates.iter_mut().zip(residuals) {
            *deviate = self.problem.loss.transformed(*residual);
        }
        if let Some(centre) = self.priors {
            let priors = &mut deviates[residuals.len()..];
            for (j, deviate) in priors.iter_mut().enumerate() {
                *deviate = (values[j] - centre[j]) / self.problem.parameters[j].prior;
            }
        }
    }
}

impl MPFitter for Objective<'_> {
    fn eval(&mut self, params: &[f64], deviates: &mut [f64]) -> MPResult<()> {
        let values = self.values(params);
        match self.problem.residuals(self.effort, &values, self.points) {
            Ok(residuals) => {
                self.fill(&values, &residuals, deviates);
                let chi2 = deviates.iter().map(|d| d * d).sum();
                self.monitor.count(1, chi2);
                self.last = Some((values, residuals));
            }
            // A motion that ends before the data is no candidate: the step is shortened.
            Err(_) => deviates.fill(REFUSED),
        }
        Ok(())
    }

    fn number_of_points(&self) -> usize {
        self.points.len() + self.priors.map_or(0, <[f64]>::len)
    }

    fn config(&self) -> &MPConfig {
        &self.config
    }

    fn parameters(&self) -> &[MPPar] {
        &self.limits
    }

    fn jacobian(
        &mut self,
        params: &[f64],
        deviates: &mut [f64],
        derivs: &mut [Option<Vec<f64>>],
    ) -> MPResult<()> {
        let values = self.values(params);
        if self.last.as_ref().is_none_or(|(last, _)| *last != values) {
            self.eval(params, deviates)?;
        }
        let Some((_, residuals)) = self.last.as_ref().filter(|(last, _)| *last == values) else {
            return Err(MPError::Eval);
        };
        self.fill(&values, residuals, deviates);
        let jacobian = self
            .problem
            .jacobian(self.effort, &values, self.points, &self.held);
        self.monitor.count(2 * jacobian.len(), f64::NAN);
        for (j, derivative) in derivs.iter_mut().enumerate() {
            let Some(column) = derivative else { continue };
            let parameter = &self.problem.parameters[j];
            for (at, entry) in column.iter_mut().enumerate() {
                *entry = match residuals.get(at) {
                    Some(residual) => {
                        let slope = self.problem.loss.slope(*residual);
                        slope * jacobian[j][at] * parameter.scale
                    }
                    None if at - residuals.len() == j => parameter.scale / parameter.prior,
                    None => 0.0,
                };
            }
        }
        Ok(())
    }
}

/// Why the optimiser failed, in words of this program: those of the library are about its interface.
fn reason(error: &MPError) -> &'static str {
    match error {
        MPError::Input => "wrong input",
        MPError::Nan => "a derivative is not finite",
        MPError::Empty => "no data",
        MPError::NoFree => "no free parameters",
        MPError::InitBounds => "the start is not within the bounds",
        MPError::Bounds => "a lower bound is not below its upper bound",
        MPError::DoF => "fewer data than parameters",
        MPError::Eval => "the motion could not be computed",
    }
}
