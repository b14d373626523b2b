//! The problem to solve: data, parameters, and the simulation as their model.

use super::parameter::{Parameter, Target};
use crate::fit::error::FitError;
use crate::fit::search::step_limit::StepLimit;
use crate::measured::Signal;
use crate::physics::kinematics::Tilt;
use crate::run::scenario::{Scenario, ScenarioError};
use crate::run::simulation::{Sample, SimulationError, StopReason, sample_at_while};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// How residuals count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Loss {
    /// Squared.
    #[default]
    Squares,
    /// Huber's: squared up to 1.345 σ, linear beyond, for data with outliers.
    Huber,
}

/// Where Huber's loss becomes linear, in σ: 95 % efficiency for normal noise (Huber 1981).
pub(in crate::fit) const HUBER_LIMIT: f64 = 1.345;

/// ∫ min(|z|, c)² φ(z) dz with c = [`HUBER_LIMIT`] and the normal density φ.
const HUBER_VARIANCE: f64 = 0.710_164_5;

impl Loss {
    /// A residual whose square is the loss.
    pub(in crate::fit) fn transformed(self, residual: f64) -> f64 {
        let size = residual.abs();
        match self {
            Self::Huber if size > HUBER_LIMIT => {
                let loss = 2.0 * HUBER_LIMIT * size - HUBER_LIMIT * HUBER_LIMIT;
                loss.sqrt().copysign(residual)
            }
            Self::Huber | Self::Squares => residual,
        }
    }

    /// What a residual counts.
    pub(in crate::fit) fn of(self, residual: f64) -> f64 {
        let deviate = self.transformed(residual);
        deviate * deviate
    }

    /// The residual as far as it pulls at the parameters: half the derivative of the loss.
    pub(in crate::fit) fn clipped(self, residual: f64) -> f64 {
        match self {
            Self::Huber => residual.clamp(-HUBER_LIMIT, HUBER_LIMIT),
            Self::Squares => residual,
        }
    }

    /// The mean square of clipped residuals, if they are normal with standard deviation 1.
    pub(in crate::fit) fn clipped_variance(self) -> f64 {
        match self {
            Self::Huber => HUBER_VARIANCE,
            Self::Squares => 1.0,
        }
    }

    /// The derivative of the transformed residual with respect to the residual.
    pub(in crate::fit) fn slope(self, residual: f64) -> f64 {
        match self {
            Self::Huber if residual.abs() > HUBER_LIMIT => {
                HUBER_LIMIT / self.transformed(residual).abs()
            }
            Self::Huber | Self::Squares => 1.0,
        }
    }
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::fit) struct Point {
    /// Index of the signal.
    pub signal: usize,
    /// Time on the clock of the model, without the offset of its file, s.
    pub time: f64,
    pub value: f64,
    pub sigma: f64,
}

/// How exactly motions are simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fit) enum Effort {
    /// On the way to a minimum: 2.4 times fewer steps.
    Draft,
    /// Near the minimum, and for everything that is reported.
    Final,
}

impl Effort {
    /// Number of motions that a derivative takes.
    pub(in crate::fit) fn motions(self) -> u64 {
        match self {
            Self::Draft => 1,
            Self::Final => 2,
        }
    }

    /// Tolerance of the simulations. At 1e-12 derivatives by differences are right to 1e-5 or better; at 1e-9 to 1e-4,
    /// enough for the direction of a step; at 1e-6 they are useless.
    fn tolerance(self) -> f64 {
        match self {
            Self::Draft => 1e-9,
            Self::Final => 1e-12,
        }
    }

    /// Step of the differences, relative to a parameter's scale. Steps of 1e-5 move the phase of the nutation by 0.03 rad
    /// after 24 s, which is too much for five digits, or for two digits of one-sided differences; much smaller ones suffer
    /// from the error of the simulation.
    pub(in crate::fit) fn step(self) -> f64 {
        match self {
            Self::Draft => 3e-6,
            Self::Final => 1e-6,
        }
    }
}

/// Relative change of χ² that counts as none: of 10⁴ values it is 1e-3 σ of a parameter.
const PRECISION: f64 = 1e-10;

/// Time that the model goes on after the last sample, s, so that rounding can't end it before.
const MARGIN: f64 = 1e-6;

/// The problem of a fit.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The scenario; free keys have their start values.
    pub scenario: Scenario,
    /// The free parameters.
    pub parameters: Vec<Parameter>,
    /// Parameters that are kept at their start, though little is known of them.
    pub kept: Vec<Parameter>,
    /// The measured signals.
    pub signals: Vec<Signal>,
    /// How residuals count.
    pub loss: Loss,
    /// Relative change of χ² that counts as none.
    pub(in crate::fit) precision: f64,
    pub(in crate::fit) points: Vec<Point>,
    pub(in crate::fit) step_limit: StepLimit,
}

/// Why a set of parameters has no complete motion.
#[derive(Clone, Debug)]
pub(in crate::fit) enum Refusal {
    /// The scenario is invalid.
    Invalid(ScenarioError),
    /// The simulation failed.
    Failed(SimulationError),
    /// It takes many times the steps of the motion at the start.
    TooManySteps,
    /// The run ends before the data.
    Ends {
        time: f64,
        reason: StopReason,
        needed: f64,
    },
}

impl From<Refusal> for FitError {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Invalid(error) => Self::Scenario(error),
            Refusal::Failed(error) => Self::Simulation(error),
            Refusal::TooManySteps => Self::TooManySteps,
            Refusal::Ends {
                time,
                reason,
                needed,
            } => Self::ModelEnds {
                end: time,
                reason,
                needed,
                until: None,
            },
        }
    }
}

impl Problem {
    /// A problem whose model starts at `origin`, s, on the clock of the first file.
    pub(in crate::fit) fn new(
        scenario: &Scenario,
        parameters: Vec<Parameter>,
        signals: Vec<Signal>,
        loss: Loss,
        origin: f64,
    ) -> Result<Self, ScenarioError> {
        let tolerances = scenario.tolerances;
        let tolerance = Effort::Final.tolerance();
        // Derivatives by differences need exact motions, whatever the scenario asks for.
        let exact = scenario.with([
            (
                "integrator.relative_tolerance",
                tolerances.relative.min(tolerance).into(),
            ),
            (
                "integrator.absolute_tolerance",
                tolerances.absolute.min(tolerance).into(),
            ),
        ])?;
        let mut problem = Self {
            scenario: exact,
            parameters,
            kept: Vec::new(),
            signals,
            loss,
            precision: PRECISION,
            points: Vec::new(),
            step_limit: StepLimit::none(),
        };
        problem.collect_points(origin);
        Ok(problem)
    }

    /// Collects the points of all signals, relative to the start of the model. Points before it are left out.
    fn collect_points(&mut self, origin: f64) {
        for (index, signal) in self.signals.iter().enumerate() {
            let has_own_clock = self.has_own_clock(signal.file);
            for (at, time) in signal.times.iter().enumerate() {
                let point = Point {
                    signal: index,
                    time: time - origin,
                    value: signal.values[at],
                    sigma: signal.sigmas[at],
                };
                // An offset may move points into the motion.
                if point.time >= 0.0 || has_own_clock {
                    self.points.push(point);
                }
            }
        }
    }

    /// Leaves out the points after a time since the start, s.
    pub(in crate::fit) fn keep_until(&mut self, until: Option<f64>) {
        if let Some(until) = until {
            let mut points = std::mem::take(&mut self.points);
            points.retain(|point| {
                point.time <= until || self.has_own_clock(self.signals[point.signal].file)
            });
            self.points = points;
        }
    }

    /// Limits further simulations to the steps of many motions like that at the start, which is simulated for it.
    pub(in crate::fit) fn limit_steps(&mut self, points: &[Point], motions: u64) {
        self.step_limit.lift();
        let before = self.step_limit.taken();
        let motion = self.predict(&self.start(), points);
        let steps = self.step_limit.taken() - before;
        let duration = points.iter().map(|point| point.time).fold(0.0, f64::max);
        self.step_limit.begin(
            motions,
            match motion {
                Ok(_) => steps,
                // As if it went on.
                Err(Refusal::Ends { time, needed, .. }) if time > 0.0 => {
                    (steps as f64 * needed / time) as u64
                }
                Err(_) => 0,
            },
            duration,
        );
    }

    /// Whether a file has a clock of its own, whose offset is fitted. All others share one.
    pub(in crate::fit) fn has_own_clock(&self, file: usize) -> bool {
        self.parameters
            .iter()
            .any(|parameter| matches!(parameter.target, Target::Offset(own) if own == file))
    }

    /// Whether the times of a point are those of the model.
    pub(in crate::fit) fn is_on_clock(&self, point: &Point) -> bool {
        !self.has_own_clock(self.signals[point.signal].file)
    }

    /// The time of a nutation at the start, s.
    pub(in crate::fit) fn nutation_period(&self) -> f64 {
        let tilt = Tilt::from_rates(self.scenario.angles.theta, self.scenario.rates);
        TAU / self
            .scenario
            .model
            .top
            .nutation_frequency(tilt.axial_rate())
            .abs()
    }

    /// All points of a file.
    pub(in crate::fit) fn points_in_file(&self, file: usize) -> Vec<Point> {
        let mut points = Vec::new();
        for point in &self.points {
            if self.signals[point.signal].file == file {
                points.push(*point);
            }
        }
        points
    }

    /// Copies the standard deviations of the signals to the points after a change. They are the same for all values.
    pub(in crate::fit) fn set_sigma(&mut self, signal: usize, sigma: f64) {
        self.signals[signal].set_sigma(sigma);
        for point in &mut self.points {
            if point.signal == signal {
                point.sigma = sigma;
            }
        }
    }

    /// The start values.
    pub(in crate::fit) fn start(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.start).collect()
    }

    /// Offset of the clock of a file, s.
    pub(in crate::fit) fn offset(&self, values: &[f64], file: usize) -> f64 {
        // Files without an offset share the clock of the model.
        for (parameter, value) in self.parameters.iter().zip(values) {
            if matches!(parameter.target, Target::Offset(known) if known == file) {
                return *value;
            }
        }
        0.0
    }

    /// The time of a point on the model's clock, s.
    pub(in crate::fit) fn model_time(&self, values: &[f64], point: &Point) -> f64 {
        point.time + self.offset(values, self.signals[point.signal].file)
    }

    /// The scenario with these values of the parameters, which runs at least to `duration`, s.
    pub(in crate::fit) fn scenario_for(
        &self,
        values: &[f64],
        duration: f64,
    ) -> Result<Scenario, ScenarioError> {
        self.scenario_with(Effort::Final, values, duration)
    }

    fn scenario_with(
        &self,
        effort: Effort,
        values: &[f64],
        duration: f64,
    ) -> Result<Scenario, ScenarioError> {
        let mut changes = vec![("stop.duration", toml::Value::from(duration + MARGIN))];
        match effort {
            Effort::Draft => {
                let tolerance = effort.tolerance();
                changes.push(("integrator.relative_tolerance", tolerance.into()));
                changes.push(("integrator.absolute_tolerance", tolerance.into()));
            }
            // The scenario has them already.
            Effort::Final => {}
        }
        for (parameter, value) in self.parameters.iter().zip(values) {
            if let Target::Key(key) = parameter.target {
                changes.push((key.path, (*value).into()));
            }
        }
        self.scenario.with(changes)
    }

    /// The values of the model at these points.
    pub(in crate::fit) fn predict(
        &self,
        values: &[f64],
        points: &[Point],
    ) -> Result<Vec<f64>, Refusal> {
        self.predict_with(Effort::Final, values, points)
    }

    pub(in crate::fit) fn predict_with(
        &self,
        effort: Effort,
        values: &[f64],
        points: &[Point],
    ) -> Result<Vec<f64>, Refusal> {
        let mut order: Vec<(f64, usize)> = Vec::with_capacity(points.len());
        for (at, point) in points.iter().enumerate() {
            // A clock's offset may take its first point slightly before the start.
            order.push((self.model_time(values, point).max(0.0), at));
        }
        // The motion is sampled in order of time, whatever file a point comes from.
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut times: Vec<f64> = order.iter().map(|(time, _)| *time).collect();
        times.dedup();
        let needed = times.last().copied().unwrap_or_default();
        let scenario = self
            .scenario_with(effort, values, needed)
            .map_err(Refusal::Invalid)?;
        let mut predicted = vec![f64::NAN; points.len()];
        let mut pending = order.iter().peekable();
        let mut taken = 0;
        let mut take = |index: usize, sample: &Sample| {
            while let Some((time, at)) = pending.peek()
                && *time == times[index]
            {
                let field = self.signals[points[*at].signal].field;
                predicted[*at] = field.of_sample(sample);
                pending.next();
            }
            taken = index + 1;
        };
        let most = self.step_limit.most_per_motion(needed);
        let mut steps = 0;
        let ended = sample_at_while(&scenario, &times, &mut take, &mut || {
            steps += 1;
            steps <= most
        });
        self.step_limit.add(steps);
        let end = ended.map_err(Refusal::Failed)?;
        if steps > most {
            return Err(Refusal::TooManySteps);
        }
        if taken < times.len() || predicted.iter().any(|value| !value.is_finite()) {
            return Err(Refusal::Ends {
                time: end.time,
                reason: end.stop,
                needed,
            });
        }
        Ok(predicted)
    }

    /// The residuals (model − data)/σ at these points.
    pub(in crate::fit) fn residuals(
        &self,
        effort: Effort,
        values: &[f64],
        points: &[Point],
    ) -> Result<Vec<f64>, Refusal> {
        let predicted = self.predict_with(effort, values, points)?;
        Ok(Self::residuals_of(&predicted, points))
    }

    /// The residuals of a motion that is known at these points.
    pub(in crate::fit) fn residuals_of(predicted: &[f64], points: &[Point]) -> Vec<f64> {
        let mut residuals = Vec::with_capacity(predicted.len());
        for (value, point) in predicted.iter().zip(points) {
            residuals.push(Self::residual(*value, point));
        }
        residuals
    }

    /// The residual of a point at which the model has this value, in σ.
    fn residual(predicted: f64, point: &Point) -> f64 {
        (predicted - point.value) / point.sigma
    }

    /// The residual of a point whose turn is not known yet, in σ.
    pub(in crate::fit) fn residual_to_nearest_turn(&self, predicted: f64, point: &Point) -> f64 {
        let mut difference = predicted - point.value;
        if self.signals[point.signal].is_turning() {
            difference -= (difference / TAU).round() * TAU;
        }
        difference / point.sigma
    }

    /// The loss at these points: the sum of the squared residuals, or Huber's.
    pub(in crate::fit) fn loss_at(
        &self,
        effort: Effort,
        values: &[f64],
        points: &[Point],
    ) -> Result<f64, Refusal> {
        let mut loss = 0.0;
        for residual in self.residuals(effort, values, points)? {
            loss += self.loss.of(residual);
        }
        Ok(loss)
    }
}
