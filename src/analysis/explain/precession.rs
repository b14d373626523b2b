//! The averaged precession and the rates of regular precession.

use super::evidence::Evidence;
use super::fact::Fact;
use crate::analysis::history::{Cycle, PegPhase};
use crate::physics::dynamics::Phase;
use crate::physics::kinematics::{Euler, Tilt};
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
    let parts = cycles.chunks(size);
    parts.map(|part| stage(evidence, part)).collect()
}

fn stage(evidence: &Evidence, part: &[Cycle]) -> Stage {
    let duration: f64 = part.iter().map(|cycle| cycle.period).sum();
    let mean = |at: usize| {
        let weighted = part.iter().map(|cycle| cycle.period * cycle.means[at]);
        weighted.sum::<f64>() / duration
    };
    let slow = part
        .iter()
        .map(|cycle| Some(cycle.period * roots(evidence, cycle)?[0]));
    let slow: Option<f64> = slow.sum();
    Stage {
        from: part[0].start,
        to: part[part.len() - 1].end(),
        nutations: part.len() as u64,
        theta: mean(0),
        theta_dot: mean(1),
        phi_dot: mean(2),
        slow_root: slow.map(|sum| sum / duration),
        psi_dot: mean(3),
    }
}

/// The mean motion of a cycle; none near the vertical, where precession and spin can hardly be distinguished.
fn mean_motion(cycle: &Cycle) -> Option<Tilt> {
    let [theta, theta_dot, phi_dot, psi_dot] = cycle.means;
    let is_vertical = theta < UPRIGHT || PI - theta < UPRIGHT;
    let rates = Euler {
        phi: phi_dot,
        theta: theta_dot,
        psi: psi_dot,
    };
    (!is_vertical).then(|| Tilt::from_rates(theta, rates))
}

/// The phase of the peg in a cycle; `None` if it changes, or the peg is in the air.
fn phase(evidence: &Evidence, cycle: &Cycle) -> Option<Phase> {
    if evidence.history.peg.is_none() {
        return Some(Phase::Sliding);
    }
    let intervals = &evidence.peg_intervals;
    let later = intervals.partition_point(|interval| interval.from <= cycle.start);
    let interval = &intervals[later.checked_sub(1)?];
    if cycle.end() > interval.to {
        return None;
    }
    match interval.phase {
        PegPhase::Sliding => Some(Phase::Sliding),
        PegPhase::Rolling => Some(Phase::Sticking),
        PegPhase::Flying => None,
    }
}

/// The slow and the fast rate of regular precession at the mean motion of a cycle, rad/s.
fn roots(evidence: &Evidence, cycle: &Cycle) -> Option<[f64; 2]> {
    let (tilt, phase) = (mean_motion(cycle)?, phase(evidence, cycle)?);
    let roots = evidence.scenario.model.precession_roots(&tilt, phase)?;
    Some([roots.slow, roots.fast])
}

/// Comparison of the averaged precession with regular precession.
pub(super) fn regular(evidence: &Evidence) -> Option<Fact> {
    let top = evidence.scenario.model.nutating_top();
    let start = Tilt::from_rates(evidence.scenario.angles.theta, evidence.scenario.rates);
    let cycles = &evidence.history.cycles;
    let known = |cycle: &Cycle| Some((cycle.means[2], roots(evidence, cycle)?));
    let known: Vec<(f64, [f64; 2])> = cycles.iter().filter_map(known).collect();
    if !known.is_empty() && known.len() < cycles.len() {
        // Only report findings that hold for the whole run.
        return None;
    }
    if known.is_empty() {
        let spin = top.axial_moment * start.rates.psi;
        let quadratic = (top.transverse_moment - top.axial_moment) * start.cos;
        let is_weak = spin * spin < 4.0 * quadratic * top.gravity_moment();
        return (cycles.is_empty() && is_weak).then_some(Fact::NoRoots);
    }
    let near = |at: usize, (rate, roots): &(f64, [f64; 2])| {
        let difference = (rate - roots[at]).abs();
        (difference <= NEAR * roots[at].abs()).then_some(difference)
    };
    let follows = |at: usize| {
        let differences: Option<Vec<f64>> = known.iter().map(|cycle| near(at, cycle)).collect();
        differences.map(|all| all.into_iter().fold(0.0, f64::max))
    };
    let mut roots = ["slow", "fast"].into_iter().enumerate();
    if let Some((root, within)) = roots.find_map(|(at, root)| Some((root, follows(at)?))) {
        return Some(Fact::FollowsRoot { root, within });
    }
    let is_near = |cycle| near(0, cycle).or(near(1, cycle)).is_some();
    (!known.iter().any(is_near)).then_some(Fact::FollowsNoRoot)
}

/// Friction's part in the change of φ̇ between the first and the last sample; `None` where that isn't known.
pub(super) fn friction(evidence: &Evidence) -> Option<Fact> {
    let [first, last] = evidence.history.states?;
    let changes = [0, 1, 2].map(|term| last.terms[term] - first.terms[term]);
    let change = last.rates.phi - first.rates.phi;
    let [gyroscopic, coriolis, friction] = changes;
    let size = changes
        .iter()
        .fold(change.abs(), |most, c| most.max(c.abs()));
    let missed = (gyroscopic + coriolis + friction - change).abs();
    // Near the vertical the terms diverge.
    let adds_up = missed <= 5e-4 * size + evidence.floor(size);
    let is_real = |theta: f64| theta >= UPRIGHT && PI - theta >= UPRIGHT;
    if !adds_up || !is_real(first.theta) || !is_real(last.theta) {
        return None;
    }
    Some(if friction.abs() <= evidence.floor(size) {
        Fact::NoFrictionOnPrecession
    } else {
        Fact::FrictionOnPrecession { friction, change }
    })
}

/// The mean θ̇ at which the gyroscopic and Coriolis terms cancel friction's, and the mean θ̇, if φ̇ hardly changes.
pub(super) fn cancelling(evidence: &Evidence) -> Option<Fact> {
    let top = evidence.scenario.model.nutating_top();
    let cycles = &evidence.history.cycles;
    let (first, last) = (cycles.first()?, cycles.last()?);
    let frictional = |cycle: &Cycle| cycle.field(nutation::PHI_DDOT_FRICTIONAL_MEAN);
    let demanded = |cycle: &Cycle| {
        let tilt = mean_motion(cycle)?;
        let gyroscopic = top.axial_moment / top.transverse_moment * tilt.axial_rate();
        let answer = (gyroscopic - 2.0 * tilt.rates.phi * tilt.cos) / tilt.sin;
        Some(-cycle.period * frictional(cycle) / answer)
    };
    let known = cycles.iter().filter(|cycle| mean_motion(cycle).is_some());
    let known: Vec<&Cycle> = known.collect();
    let time: f64 = known.iter().map(|cycle| cycle.period).sum();
    let demanded = known.iter().filter_map(|cycle| demanded(cycle));
    let demanded = demanded.sum::<f64>() / time;
    let mean = known.iter().map(|c| c.period * c.means[1]).sum::<f64>() / time;
    let friction: f64 = cycles.iter().map(|c| c.period * frictional(c)).sum();
    let change = (last.means[2] - first.means[2]).abs();
    let is_steady = change < STEADY * friction.abs() && friction.abs() > evidence.floor(change);
    // In large nutations the terms of the mean motion are not the mean of the terms.
    let do_cancel = (demanded - mean).abs() < STEADY * mean.abs();
    (is_steady && do_cancel).then_some(Fact::TermsCancel { demanded, mean })
}
