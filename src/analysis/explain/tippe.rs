//! Why a tippe top turns over, or does not.

use super::claim::Claim;
use super::evidence::{Evidence, ROUNDED};
use crate::physics::math::sin_cos;
use std::f64::consts::FRAC_PI_2;

/// Number of inclinations at which the least energy is computed.
const INCLINATIONS: u32 = 64;

pub(super) fn inverts(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    let observations = &evidence.observations;
    if !history.is_tippe_top() || !history.has_exact_inversion() {
        return None;
    }
    let jellett_deviation = evidence.summary.peg.as_ref()?.jellett_deviation?;
    let span = observations.momentum.whole()?;
    let vertical = [span.from.vertical, span.to.vertical];
    let axial = [span.from.axial, span.to.axial];
    let theta = [span.from.theta, span.to.theta];
    let (center, kinetic) = (observations.center_height?, observations.kinetic?);
    let turns_over = theta[0] < FRAC_PI_2 && theta[1] > FRAC_PI_2;
    let reverses = vertical[0] * vertical[1] > 0.0 && axial[0] * axial[1] < 0.0;
    let rises = center.last > center.first && kinetic.last < kinetic.first;
    let lost_sliding = evidence.summary.peg.as_ref()?.lost?[0];
    // Other torques change Jellett's integral, and could turn the top over by themselves.
    let by_contact_force =
        jellett_deviation <= ROUNDED && !evidence.scenario.model.friction.has_losses();
    (turns_over && reverses && rises && by_contact_force && lost_sliding > 0.0).then_some(
        Claim::Inverts {
            time: history.inverted?,
            theta,
            jellett_deviation,
            vertical,
            axial,
            center_height: [center.first, center.last],
            kinetic: [kinetic.first, kinetic.last],
            lost_sliding,
        },
    )
}

/// A tippe top that has not enough energy to turn over.
///
/// No force at the contact point changes Jellett's integral. So at each inclination there is a least energy, and friction
/// only takes energy from the motion.
pub(super) fn stays_upright(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    let friction = &evidence.scenario.model.friction;
    let start = evidence.scenario.angles.theta;
    // Other torques change Jellett's integral.
    if friction.has_losses() || !friction.acts_at_contact() {
        return None;
    }
    if !history.is_tippe_top() || start >= FRAC_PI_2 || history.inverted.is_some() {
        return None;
    }
    // Otherwise the top may turn over after the end of the recording.
    history.stop_reason()?;
    let peg = evidence.summary.peg.as_ref()?;
    let (jellett, jellett_deviation) = (peg.jellett?, peg.jellett_deviation?);
    let top = &evidence.scenario.model.top;
    let terms =
        (top.center_distance.abs() + top.peg_radius) * evidence.observations.momentum.largest();
    let certain = (jellett.abs() - ROUNDED * terms).max(0.0);
    let energy = history.energies?.first;
    let (mut needed, mut needed_at) = (f64::NEG_INFINITY, start);
    for at in 0..=INCLINATIONS {
        let part = f64::from(at) / f64::from(INCLINATIONS);
        let theta = start + part * (FRAC_PI_2 - start);
        let (sin, cos) = sin_cos(theta);
        let least = top.least_energy(certain, sin, cos);
        if least > needed {
            (needed, needed_at) = (least, theta);
        }
    }
    let is_barred = needed - energy > ROUNDED * needed.abs().max(energy.abs());
    (jellett_deviation <= ROUNDED && is_barred).then_some(Claim::StaysUpright {
        energy,
        needed,
        needed_at,
        jellett,
        jellett_deviation,
    })
}
