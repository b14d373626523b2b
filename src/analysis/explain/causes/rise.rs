//! Why a top rises.

use super::conservation::is_constant;
use super::stretch::Stretch;
use crate::analysis::explain::claim::Claim;
use crate::analysis::explain::evidence::Evidence;
use crate::analysis::explain::fact::{Fact, PrecessionRoot};
use crate::analysis::explain::precession;
use crate::analysis::losses::Losses;
use std::f64::consts::FRAC_PI_2;

/// Friction turns the angular momentum upright, and the axis follows it.
pub(super) fn friction_raises(evidence: &Evidence, stretch: &Stretch) -> Option<Claim> {
    let friction = &evidence.scenario.model.friction;
    // Without terms of the Euler equations there is no torque that would change the angular momentum.
    if friction.dissipation.drops_euler_terms() || evidence.history.is_tippe_top() {
        return None;
    }
    let span = stretch.span;
    let change = span.to.horizontal - span.from.horizontal;
    let descent = span.from.inclination() - span.to.inclination();
    // The axis is within `angle_to_axis` of the angular momentum, at the beginning as at the end.
    let must_follow = descent > 2.0 * span.angle_to_axis;
    let is_by_friction = change < 0.0 && span.by_friction < 0.5 * change;
    let is_vertical_constant = !friction.turns_about_vertical()
        && is_constant(
            evidence.observations.momentum.vertical?,
            span.from.vertical.abs(),
        );
    (must_follow && is_by_friction).then_some(Claim::FrictionRaises {
        horizontal: [span.from.horizontal, span.to.horizontal],
        vertical: [span.from.vertical, span.to.vertical],
        is_vertical_constant,
        by_friction: span.by_friction,
        angle_to_momentum: span.angle_to_axis,
        theta: [span.from.theta, span.to.theta],
        from: span.from.time,
        until: span.to.time,
        theta_at_end: evidence.observations.momentum.whole?.to.theta,
        losses: stretch.losses(evidence),
    })
}

/// The paper's argument: friction drives the precession beyond the slow rate of regular precession.
pub(super) fn friction_speeds_precession(evidence: &Evidence) -> Option<Claim> {
    // A free peg's acceleration has a part in φ̈ that is neither of these terms.
    if evidence.scenario.model.support.is_free() {
        return None;
    }
    let Some(Fact::FollowsRoot {
        root: PrecessionRoot::Slow,
        within,
    }) = precession::regular(evidence)
    else {
        return None;
    };
    let Some(Fact::FrictionOnPrecession { friction, .. }) = precession::friction(evidence) else {
        return None;
    };
    // The rise must be what cancels friction's term.
    precession::cancelling(evidence)?;
    let [first, .., last] = &evidence.history.cycles[..] else {
        return None;
    };
    let mean_theta = [first.means[0], last.means[0]];
    let mean_phi_dot = [first.means[2], last.means[2]];
    let top = &evidence.scenario.model.top;
    // Only then is θ̈ negative between the rates of regular precession.
    let is_negative_between = top.transverse_moment > top.axial_moment && mean_theta[0] < FRAC_PI_2;
    let speeds_up = mean_phi_dot.iter().all(|rate| rate * friction > 0.0);
    (is_negative_between && speeds_up && mean_theta[1] < mean_theta[0]).then_some(
        Claim::FrictionSpeedsPrecession {
            friction,
            mean_phi_dot,
            within,
            mean_theta,
        },
    )
}

/// Losses align the axis of an oblate top with its angular momentum.
pub(super) fn losses_align(evidence: &Evidence) -> Option<Claim> {
    let model = &evidence.scenario.model;
    let top = model.nutating_top();
    let is_oblate = top.axial_moment > top.transverse_moment;
    // Without terms of the Euler equations, energy is not lost by a torque.
    if !is_oblate || model.friction.dissipation.drops_euler_terms() {
        return None;
    }
    let span = evidence.observations.momentum.whole?;
    let energies = evidence.history.energies?;
    let decrease = span.from.angle_to_axis - span.to.angle_to_axis;
    // The inclination of the axis is within `inclination` of its angle to the angular momentum.
    let must_rise = decrease > 2.0 * span.inclination;
    let loses = energies.first - energies.last > energies.imbalance;
    (must_rise && loses).then_some(Claim::LossesAlign {
        angle_to_momentum: [span.from.angle_to_axis, span.to.angle_to_axis],
        momentum_inclination: span.inclination,
        energy: [energies.first, energies.last],
        losses: Losses::new(&model.friction),
    })
}
