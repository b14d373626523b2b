//! The sum of squares as the optimiser sees it.

use super::monitor::Monitor;
use crate::fit::error::FitError;
use crate::fit::problem::model::{Effort, Point, Problem};
use crate::words::sentence;
use rmpfit::{MPConfig, MPError, MPFitter, MPPar, MPResult, MPSide, MPSuccess};
use std::rc::Rc;

/// What a residual of a refused motion counts: more than any that can be measured, but its square is finite.
const REFUSED: f64 = 1e30;

/// Maximum number of iterations in a window, and in the last one.
const ITERATIONS: usize = 25;
const LAST_ITERATIONS: usize = 50;

/// The objective as the optimiser sees it: parameters in units of their scales.
pub(in crate::fit) struct Objective<'a> {
    problem: &'a Problem,
    points: &'a [Point],
    /// Centre of weak priors.
    priors: Option<&'a [f64]>,
    held: Vec<bool>,
    limits: Vec<MPPar>,
    effort: Effort,
    config: MPConfig,
    monitor: &'a Monitor<'a>,
    /// The last motion that was computed.
    last: Option<Rc<Evaluated>>,
    /// The lowest sum of squares in the last run, and its values.
    best: (f64, Vec<f64>),
    /// Whether the last run ended because it had no more iterations or steps.
    is_exhausted: bool,
}

/// A motion at the points.
struct Evaluated {
    /// Values of the parameters.
    values: Vec<f64>,
    predicted: Vec<f64>,
    residuals: Vec<f64>,
}

impl<'a> Objective<'a> {
    pub(in crate::fit) fn new(
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
            best: (f64::INFINITY, Vec::new()),
            is_exhausted: false,
        }
    }

    /// Whether the last run ended because it had no more iterations or steps, and not in a minimum.
    pub(in crate::fit) fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    /// Ends after this many iterations.
    pub(in crate::fit) fn limited_to(mut self, iterations: usize) -> Self {
        self.config.max_iter = iterations;
        self
    }

    /// Optimises with drafts of motions. Returns `start` if its draft ends before the data, as one that just reaches
    /// them may.
    pub(in crate::fit) fn run_drafts(
        &mut self,
        start: &[f64],
        precision: f64,
    ) -> Result<Vec<f64>, FitError> {
        self.effort = Effort::Draft;
        self.config.ftol = precision;
        self.last = None;
        if self.evaluated(&self.values(&self.scaled(start))).is_none() {
            return Ok(start.to_vec());
        }
        self.run(start)
    }

    /// Optimises with exact motions.
    pub(in crate::fit) fn run_finally(
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
        let mut scaled = self.scaled(start);
        self.best = (f64::INFINITY, self.values(&scaled));
        match self.mpfit(&mut scaled) {
            Ok(status) => {
                self.is_exhausted = matches!(status.success, MPSuccess::MaxIter);
                Ok(self.values(&scaled))
            }
            // The optimiser was stopped.
            Err(_) if self.problem.step_limit.is_exceeded() => {
                self.is_exhausted = true;
                Ok(self.best.1.clone())
            }
            Err(error) => Err(FitError::refused(sentence!(
                "the optimiser failed: {}",
                reason(&error)
            ))),
        }
    }

    /// Values in units of the scales: the optimiser's steps are isotropic, so it gets numbers of order 1.
    fn scaled(&self, values: &[f64]) -> Vec<f64> {
        let mut scaled = Vec::new();
        for (at, parameter) in self.problem.parameters.iter().enumerate() {
            let limits = &self.limits[at];
            // Rounding must not take the start out of the bounds.
            let number = (values[at] / parameter.scale).max(limits.limit_low);
            scaled.push(number.min(limits.limit_up));
        }
        scaled
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

    /// The motion of these values; `None` if it ends before the data.
    fn evaluated(&mut self, values: &[f64]) -> Option<Rc<Evaluated>> {
        if let Some(last) = &self.last
            && last.values == values
        {
            return Some(Rc::clone(last));
        }
        let motion = self.problem.predict_with(self.effort, values, self.points);
        self.monitor.count(1, f64::NAN);
        let predicted = motion.ok()?;
        let evaluated = Rc::new(Evaluated {
            residuals: Problem::residuals_of(&predicted, self.points),
            values: values.to_vec(),
            predicted,
        });
        self.last = Some(Rc::clone(&evaluated));
        Some(evaluated)
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
        if self.problem.step_limit.is_exceeded() {
            return Err(MPError::Eval);
        }
        let values = self.values(params);
        let Some(evaluated) = self.evaluated(&values) else {
            // A motion that ends before the data is no candidate: the step is shortened.
            deviates.fill(REFUSED);
            return Ok(());
        };
        self.fill(&values, &evaluated.residuals, deviates);
        let chi2 = deviates.iter().map(|deviate| deviate * deviate).sum();
        self.monitor.count(0, chi2);
        if chi2 < self.best.0 {
            self.best = (chi2, values);
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
        if self.problem.step_limit.is_exceeded() {
            return Err(MPError::Eval);
        }
        let values = self.values(params);
        let Some(here) = self.evaluated(&values) else {
            return Err(MPError::Eval);
        };
        self.fill(&values, &here.residuals, deviates);
        let jacobian = self.problem.jacobian(
            self.effort,
            &values,
            &here.predicted,
            self.points,
            &self.held,
        );
        let free = self.held.iter().filter(|is_held| !**is_held).count() as u64;
        self.monitor.count(self.effort.motions() * free, f64::NAN);
        let residuals = &here.residuals;
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
