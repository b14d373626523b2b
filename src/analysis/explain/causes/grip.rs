//! What follows when the contact point no longer slips.

use crate::analysis::explain::claim::{Claim, Effect, Hold, Inversion, Stopped};
use crate::analysis::explain::evidence::{Evidence, ROUNDED};
use crate::analysis::explain::observations::GripSpan;
use crate::analysis::history::PegPhase;
use crate::physics::math::sin_cos;
use crate::run::simulation::{EventKind, StopReason};
use std::f64::consts::FRAC_PI_2;

/// The contact point does not slip at the end of the run. `claims`: those that precede it.
pub(super) fn slip_ends(evidence: &Evidence, claims: &[Claim]) -> Option<Claim> {
    let GripSpan {
        from,
        theta_at_start,
        theta,
        energy,
        ..
    } = evidence.observations.grip?;
    let (theta, energy) = (theta?, energy?);
    let theta_range = [theta.least, theta.greatest];
    let (first, last) = (energy.first, energy.last);
    let is_constant = (last - first).abs() <= ROUNDED * first.abs().max(last.abs());
    let has_losses = evidence.scenario.model.friction.has_losses();
    // A change of energy that nothing explains is an error.
    if !(is_constant || has_losses) || evidence.history.stop_reason()? == StopReason::Rest {
        return None;
    }
    let rolls = evidence.scenario.model.support.is_free();
    let is_fixed_inclination =
        theta_range[1] - theta_range[0] <= evidence.integration_error(theta_range[1]);
    if !rolls && !is_fixed_inclination {
        return None;
    }
    let rises = claims.iter().any(|claim| claim.effect() == Effect::Rise);
    let stops = if rises && theta_range[1] < evidence.scenario.angles.theta {
        Stopped::Rise
    } else {
        Stopped::Nothing
    };
    let history = &evidence.history;
    let last_period = history.cycles.last().map_or(0.0, |cycle| cycle.period);
    // A part of a nutation shows neither its range nor that the grip goes on.
    let lasts = !rolls
        || history.cycles.iter().any(|cycle| cycle.start >= from)
        || (is_fixed_inclination && history.stop_time()? - from >= last_period);
    Some(Claim::SlipEnds {
        from,
        theta: theta_at_start,
        theta_range,
        energy: [first, last],
        stops,
        // It slips no more since then.
        has_slipped: evidence.summary.slip_path? > 0.0,
        alternates: slips_after_grip(evidence),
        lasts,
        is_inclination_constant: is_fixed_inclination,
        inversion: inversion(evidence, from, theta_range),
        rolls,
    })
}

/// Inversion of a tippe top that starts upright and grips from this time on, s, with inclinations in this range, rad; `None`
/// if the axis passed the horizontal and came back.
fn inversion(evidence: &Evidence, from: f64, theta_range: [f64; 2]) -> Option<Inversion> {
    let starts_upright = evidence.scenario.angles.theta < FRAC_PI_2;
    if !evidence.history.is_tippe_top() || !starts_upright {
        return None;
    }
    match evidence.history.inverted() {
        None => Some(Inversion::Absent),
        Some(time) if time <= from && theta_range[0] > FRAC_PI_2 => Some(Inversion::Complete),
        Some(_) => None,
    }
}

/// Whether the contact point has slipped after it had gripped.
fn slips_after_grip(evidence: &Evidence) -> bool {
    if !evidence.scenario.model.support.is_free() {
        return evidence.history.first(EventKind::SlipResumes).is_some();
    }
    // A peg may roll, hop, and slide.
    evidence
        .peg_intervals
        .iter()
        .skip_while(|interval| interval.phase != PegPhase::Rolling)
        .any(|interval| interval.phase == PegPhase::Sliding)
}

/// A top that rests at the end.
pub(super) fn rests(evidence: &Evidence) -> Option<Claim> {
    let rest = evidence.history.first(EventKind::Rest)?;
    let kinetic = evidence.observations.kinetic?;
    let theta = rest.state.theta;
    let held_by = hold(evidence, theta);
    Some(if rest.time <= 0.0 && kinetic.first <= 0.0 {
        Claim::RestsFromStart { theta, held_by }
    } else {
        Claim::ComesToRest {
            from: rest.time,
            theta,
            kinetic: [kinetic.first, kinetic.last],
            held_by,
        }
    })
}

/// What holds a top at rest at this inclination, rad.
fn hold(evidence: &Evidence, theta: f64) -> Hold {
    /// Distance from the vertical below which the axis is at it, rad: π isn't a floating-point number.
    const VERTICAL: f64 = 1e-12;
    let model = &evidence.scenario.model;
    let (sin, _) = sin_cos(theta);
    if sin.abs() < VERTICAL || model.top.gravity_moment() == 0.0 {
        Hold::Balance
    } else if model.support.is_free() {
        Hold::RollingResistance
    } else {
        Hold::StaticFriction
    }
}
