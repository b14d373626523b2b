//! The averaged precession and the rates of regular precession.

use super::evidence::Evidence;
use super::fact::{Fact, PrecessionRoot};
use crate::analysis::history::{Cycle, PegPhase};
use crate::physics::dynamics::Phase;
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::PrecessionRoots;
use crate::run::simulation::UPRIGHT;
use crate::telemetry::fields::nutation;
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::PI;

/// Number of stages.
const STAGES: usize = 6;
/// φ̇ follows a rate if it is always within this relative distance.
const NEAR: f64 = 0.05;
/// The mean precession is steady if φ̇ changes by less than this fraction of the integrated friction term.
const STEADY: f64 = 0.05;

/// The averaged motion in several nutations.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Stage {
    /// Time of its beginning, s.
    pub from: f64,
    /// Time of its end, s.
    pub to: f64,
    /// Number of nutations.
    pub nutations: u64,
    /// Mean inclination, rad.
    pub theta: f64,
    /// Mean nutation rate, rad/s.
    pub theta_dot: f64,
    /// Mean precession rate, rad/s.
    pub phi_dot: f64,
    /// Mean slow rate of regular precession, rad/s; absent where it is not real.
    pub slow_root: Option<f64>,
    /// Mean spin rate, rad/s.
    pub psi_dot: f64,
}

/// The averaged motion in stages of equally many nutations.
pub(super) fn stages(evidence: &Evidence) -> Vec<Stage> {
    let cycles = &evidence.history.cycles;
    let size = cycles.len().div_ceil(STAGES).max(1);
    cycles
        .chunks(size)
        .map(|part| stage(evidence, part))
        .collect()
}

fn stage(evidence: &Evidence, part: &[Cycle]) -> Stage {
    let duration: f64 = part.iter().map(|cycle| cycle.period).sum();
    let [theta, theta_dot, phi_dot, psi_dot] =
        // Means over time: cycles differ in length.
        [0, 1, 2, 3].map(|at| weighted_sum(part, |cycle| cycle.means[at]) / duration);
    // The slow rate of a stage is known if that of each of its cycles is.
    let slow_sum: Option<f64> = part
        .iter()
        .map(|cycle| Some(cycle.period * roots(evidence, cycle)?.slow))
        .sum();
    Stage {
        from: part[0].start,
        to: part[part.len() - 1].end(),
        nutations: part.len() as u64,
        theta,
        theta_dot,
        phi_dot,
        slow_root: slow_sum.map(|sum| sum / duration),
        psi_dot,
    }
}

/// The sum of a quantity over cycles, weighted with their periods.
fn weighted_sum(cycles: &[Cycle], quantity: impl Fn(&Cycle) -> f64) -> f64 {
    cycles
        .iter()
        .map(|cycle| cycle.period * quantity(cycle))
        .sum()
}

/// The mean motion of a cycle; none near the vertical, where precession and spin can hardly be distinguished.
fn mean_motion(cycle: &Cycle) -> Option<Tilt> {
    let [theta, theta_dot, phi_dot, psi_dot] = cycle.means;
    let rates = Euler {
        phi: phi_dot,
        theta: theta_dot,
        psi: psi_dot,
    };
    is_inclined(theta).then(|| Tilt::from_rates(theta, rates))
}

/// The phase of the peg in a cycle; `None` if it changes, or the peg is in the air.
fn phase(evidence: &Evidence, cycle: &Cycle) -> Option<Phase> {
    if evidence.history.peg.is_none() {
        return Some(Phase::Sliding);
    }
    let intervals = &evidence.peg_intervals;
    let later = intervals.partition_point(|interval| interval.from <= cycle.start);
    let interval = &intervals[later.checked_sub(1)?];
    // In two phases, a cycle has no single rate of regular precession.
    if cycle.end() > interval.to {
        return None;
    }
    match interval.phase {
        PegPhase::Sliding => Some(Phase::Sliding),
        PegPhase::Rolling => Some(Phase::Sticking),
        PegPhase::Flying => None,
    }
}

/// The rates of regular precession at the mean motion of a cycle, rad/s.
fn roots(evidence: &Evidence, cycle: &Cycle) -> Option<PrecessionRoots> {
    let (tilt, phase) = (mean_motion(cycle)?, phase(evidence, cycle)?);
    evidence.scenario.model.precession_roots(&tilt, phase)
}

/// The mean φ̇ of a cycle, and the rates of regular precession then, rad/s.
struct RootComparison {
    phi_dot: f64,
    roots: PrecessionRoots,
}

impl RootComparison {
    /// The distance from a rate of regular precession, if φ̇ is near it.
    fn near(&self, root: PrecessionRoot) -> Option<f64> {
        let rate = match root {
            PrecessionRoot::Slow => self.roots.slow,
            PrecessionRoot::Fast => self.roots.fast,
        };
        let difference = (self.phi_dot - rate).abs();
        (difference <= NEAR * rate.abs()).then_some(difference)
    }
}

/// The largest distance from a rate of regular precession, if φ̇ is always near it.
fn follows(cycles: &[RootComparison], root: PrecessionRoot) -> Option<f64> {
    let mut largest = 0.0_f64;
    for cycle in cycles {
        largest = largest.max(cycle.near(root)?);
    }
    Some(largest)
}

/// Comparison of the averaged precession with regular precession.
pub(super) fn regular(evidence: &Evidence) -> Option<Fact> {
    let cycles = &evidence.history.cycles;
    let mut known = Vec::new();
    for cycle in cycles {
        if let Some(roots) = roots(evidence, cycle) {
            let phi_dot = cycle.means[2];
            known.push(RootComparison { phi_dot, roots });
        }
    }
    // Only report findings that hold for the whole run.
    if known.len() < cycles.len() {
        return None;
    }
    if known.is_empty() {
        return (discriminant_at_start(evidence) < 0.0).then_some(Fact::NoRoots);
    }
    for root in [PrecessionRoot::Slow, PrecessionRoot::Fast] {
        if let Some(within) = follows(&known, root) {
            return Some(Fact::FollowsRoot { root, within });
        }
    }
    let is_ever_near = known.iter().any(|cycle| {
        cycle.near(PrecessionRoot::Slow).is_some() || cycle.near(PrecessionRoot::Fast).is_some()
    });
    (!is_ever_near).then_some(Fact::FollowsNoRoot)
}

/// The discriminant of the rates of regular precession at the start, (kg m²/s)²: negative if there are no real ones.
fn discriminant_at_start(evidence: &Evidence) -> f64 {
    let top = evidence.scenario.model.nutating_top();
    let start = Tilt::from_rates(evidence.scenario.angles.theta, evidence.scenario.rates);
    let spin = top.axial_moment * start.rates.psi;
    // (I_x − I_z) cos θ φ̇² − I_z ψ̇ φ̇ + M g l = 0 has no real root if this is negative.
    let quadratic = (top.transverse_moment - top.axial_moment) * start.cos;
    spin * spin - 4.0 * quadratic * top.gravity_moment()
}

/// Whether precession and spin can be distinguished.
fn is_inclined(theta: f64) -> bool {
    theta >= UPRIGHT && PI - theta >= UPRIGHT
}

/// Friction's part in the change of φ̇ between the first and the last sample; `None` where that isn't known.
pub(super) fn friction(evidence: &Evidence) -> Option<Fact> {
    let [first, last] = evidence.history.states?;
    let changes = [0, 1, 2].map(|term| last.terms[term] - first.terms[term]);
    let change = last.rates.phi - first.rates.phi;
    let [gyroscopic, coriolis, friction] = changes;
    let size = changes
        .iter()
        .fold(change.abs(), |largest, term| largest.max(term.abs()));
    let missed = (gyroscopic + coriolis + friction - change).abs();
    // Near the vertical the terms diverge.
    let adds_up = missed <= 5e-4 * size + evidence.integration_error(size);
    if !adds_up || !is_inclined(first.theta) || !is_inclined(last.theta) {
        return None;
    }
    Some(if friction.abs() <= evidence.integration_error(size) {
        Fact::NoFrictionOnPrecession
    } else {
        Fact::FrictionOnPrecession { friction, change }
    })
}

fn mean_friction_term(cycle: &Cycle) -> f64 {
    cycle.field(nutation::PHI_DDOT_FRICTIONAL_MEAN)
}

/// The mean θ̇ at which the gyroscopic and Coriolis terms cancel friction's, and the mean θ̇, if φ̇ hardly changes.
pub(super) fn cancelling(evidence: &Evidence) -> Option<Fact> {
    let top = evidence.scenario.model.nutating_top();
    let cycles = &evidence.history.cycles;
    let (first, last) = (cycles.first()?, cycles.last()?);
    let (mut time, mut angle, mut demanded_angle) = (0.0, 0.0, 0.0);
    for cycle in cycles {
        let Some(tilt) = mean_motion(cycle) else {
            continue;
        };
        // Equation (7) of the paper: φ̈ = θ̇ ((I_z/I_x)(ψ̇ + φ̇ cos θ) − 2 φ̇ cos θ)/sin θ + friction.
        let gyroscopic = top.axial_moment / top.transverse_moment * tilt.axial_rate();
        let acceleration_per_rate = (gyroscopic - 2.0 * tilt.rates.phi * tilt.cos) / tilt.sin;
        time += cycle.period;
        angle += cycle.period * cycle.means[1];
        demanded_angle -= cycle.period * mean_friction_term(cycle) / acceleration_per_rate;
    }
    let (demanded, mean) = (demanded_angle / time, angle / time);
    let friction = weighted_sum(cycles, mean_friction_term);
    let change = (last.means[2] - first.means[2]).abs();
    let is_steady =
        change < STEADY * friction.abs() && friction.abs() > evidence.integration_error(change);
    // In large nutations the terms of the mean motion are not the mean of the terms.
    let do_cancel = (demanded - mean).abs() < STEADY * mean.abs();
    (is_steady && do_cancel).then_some(Fact::TermsCancel { demanded, mean })
}
