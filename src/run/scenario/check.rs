//! Checks of combinations of keys.

use super::choice::FormulationKind;
use super::error::{Problem, Requirement, ScenarioError};
use super::stop::Stop;
use super::values::Values;
use crate::physics::dynamics::{Model, Start};
use crate::physics::friction::{Dissipation, FrictionLaw};
use std::f64::consts::PI;

/// Keys of the position and of the velocity: those of the peg and of the centre of mass exclude each other.
const PLACES: [([&str; 2], [&str; 2]); 2] = [
    (
        ["initial.peg_x", "initial.peg_y"],
        ["initial.center_x", "initial.center_y"],
    ),
    (
        ["initial.peg_x_dot", "initial.peg_y_dot"],
        ["initial.center_x_dot", "initial.center_y_dot"],
    ),
];

/// A complete scenario whose combinations of keys are to be checked.
pub(super) struct Check<'a> {
    pub(super) values: &'a Values,
    pub(super) formulation: FormulationKind,
    pub(super) model: &'a Model,
    /// Initial inclination, rad.
    pub(super) theta: f64,
    pub(super) stop: Stop,
    pub(super) sample_period_ns: u64,
}

impl Check<'_> {
    /// Fails with the problem of a key unless a condition holds.
    fn ensure(&self, holds: bool, key: &str, problem: Problem) -> Result<(), ScenarioError> {
        if holds {
            return Ok(());
        }
        Err(self.values.invalid(key, problem))
    }

    /// Checks keys that depend on the support.
    pub(super) fn support(&self) -> Result<(), ScenarioError> {
        let key = "top.center_distance";
        let distance = self.model.top.center_distance;
        if !self.model.support.is_free() {
            return self.ensure(distance > 0.0, key, Problem::NotAboveFixedPeg);
        }
        // With its centre of mass in the centre, a ball has no axis that could rise.
        let is_inside = distance != 0.0 && distance > -self.model.top.peg_radius;
        self.ensure(is_inside, key, Problem::OutsideSphere)?;
        let requirements = self.requirements_of_free_peg();
        self.ensure(
            requirements.is_empty(),
            "support.kind",
            Problem::Requires {
                requirements,
                reason: None,
            },
        )?;
        self.places()?;
        let angles = ["stop.theta_risen", "stop.theta_fallen"];
        match self.values.first_set(angles) {
            Some(key) if distance < 0.0 => Err(self.values.invalid(key, Problem::TippeTop)),
            Some(_) | None => Ok(()),
        }
    }

    /// The values of other keys that a free peg requires, and that are not set.
    fn requirements_of_free_peg(&self) -> Vec<Requirement> {
        let mut requirements = Vec::new();
        if self.formulation != FormulationKind::Body {
            requirements.push(Requirement::Word("formulation", "body"));
        }
        if self.model.friction.dissipation != Dissipation::Full {
            requirements.push(Requirement::Word("friction.dissipation", "full"));
        }
        // The top may roll forever.
        if self.stop.duration.is_none() {
            requirements.push(Requirement::Set("stop.duration"));
        }
        requirements
    }

    /// Checks that the peg and the centre of mass don't both have a position, or a velocity.
    fn places(&self) -> Result<(), ScenarioError> {
        for (peg, center) in PLACES {
            if let Some(key) = self.values.first_set(peg)
                && let Some(other) = self.values.first_set(center)
            {
                return Err(self.values.invalid(key, Problem::Excludes(other)));
            }
        }
        Ok(())
    }

    /// Checks that the moments of inertia are those of a rigid body.
    pub(super) fn body(&self) -> Result<(), ScenarioError> {
        let top = &self.model.top;
        let offset = top.mass * top.center_distance * top.center_distance;
        self.ensure(
            top.transverse_moment > offset,
            "top.transverse_moment",
            Problem::TooSmallMoment { offset },
        )?;
        // The axial moment of a rigid body is at most twice its transverse moment about any point of the axis.
        // The limit is lowest at the centre of mass.
        let limit = 2.0 * top.transverse_moment;
        for (limit, is_central) in [(limit, false), (limit - 2.0 * offset, true)] {
            let problem = Problem::TooLargeMoment { limit, is_central };
            self.ensure(top.axial_moment <= limit, "top.axial_moment", problem)?;
        }
        Ok(())
    }

    /// Checks the start against the formulation and the stop angles.
    pub(super) fn start(&self) -> Result<(), ScenarioError> {
        let theta = self.theta;
        let is_singular = theta <= 0.0 || theta >= PI;
        self.ensure(
            !is_singular || self.formulation == FormulationKind::Body,
            "initial.theta",
            Problem::SingularStart,
        )?;
        let Stop {
            theta_risen: risen,
            theta_fallen: fallen,
            ..
        } = self.stop;
        let friction = &self.model.friction;
        // As the axis comes upright, terms without their counterparts grow beyond all bounds.
        let divides = friction.dissipation.drops_euler_terms() && !friction.is_none();
        self.ensure(
            !divides || risen.is_some(),
            "friction.dissipation",
            Problem::Requires {
                requirements: vec![Requirement::Set("stop.theta_risen")],
                reason: Some("its equations divide by sin θ"),
            },
        )?;
        let problem = Problem::AlreadyPassed { theta };
        let is_above = risen.is_none_or(|limit| theta > limit);
        self.ensure(is_above, "stop.theta_risen", problem.clone())?;
        let is_below = fallen.is_none_or(|limit| theta < limit);
        self.ensure(is_below, "stop.theta_fallen", problem)
    }

    /// Checks a formula at the slip speeds that the energy allows.
    pub(super) fn friction(&self, start: &Start) -> Result<(), ScenarioError> {
        let FrictionLaw::Formula { coefficient, .. } = &self.model.friction.law else {
            return Ok(());
        };
        coefficient
            .check_up_to(self.model.largest_slip_speed(start))
            .map_err(|error| {
                self.values
                    .invalid("friction.formula", Problem::Coefficient(error))
            })
    }

    /// Checks that the run stops, and that its samples can be numbered.
    pub(super) fn end(&self) -> Result<(), ScenarioError> {
        let stop = self.stop;
        if stop.may_stick && !self.model.support.is_free() {
            self.sticking()?;
        }
        let Some(duration) = stop.duration else {
            let has_angle = stop.theta_risen.is_some() || stop.theta_fallen.is_some();
            if has_angle && !self.model.friction.is_none() {
                return Ok(());
            }
            return Err(ScenarioError::without_key(Problem::Endless));
        };
        let samples = duration * 1e9 / self.sample_period_ns as f64;
        self.ensure(
            // Sequence numbers of messages have 32 bits.
            samples < f64::from(u32::MAX),
            "sampling.period",
            Problem::TooManySamples { duration },
        )
    }

    /// Checks that a run that continues where the contact point sticks can stick, and stops.
    fn sticking(&self) -> Result<(), ScenarioError> {
        let key = "stop.on_stick";
        let can_stick = self.model.friction.can_stick();
        self.ensure(can_stick, key, Problem::NeverSticks)?;
        self.ensure(
            self.stop.duration.is_some(),
            key,
            Problem::Requires {
                requirements: vec![Requirement::Set("stop.duration")],
                reason: Some("the top may stick forever"),
            },
        )
    }
}
