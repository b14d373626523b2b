//! Why a tippe top turns over, or does not.

use super::claim::{Claim, SufficientSpin};
use super::evidence::{Evidence, ROUNDED};
use crate::physics::math::sin_cos;
use crate::physics::top::Top;
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
    for theta in inclinations(start) {
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
        sufficient_spin: sufficient_spin(evidence, energy),
    })
}

/// Inclinations from that at the start to the horizontal, rad.
fn inclinations(start: f64) -> impl Iterator<Item = f64> {
    (0..=INCLINATIONS).map(move |at| {
        let part = f64::from(at) / f64::from(INCLINATIONS);
        start + part * (FRAC_PI_2 - start)
    })
}

/// The spin with which the top would have enough energy, given its energy at the start, J.
///
/// The spin ψ̇ adds to Jellett's integral in proportion, and to the energy by its square. So what the energy lacks at an
/// inclination is a quadratic function of ψ̇. If it opens downwards at all of them, a faster spin is enough; if it is
/// positive everywhere at one of them, none is.
fn sufficient_spin(evidence: &Evidence, energy: f64) -> SufficientSpin {
    let top = &evidence.scenario.model.top;
    let (rates, start) = (evidence.scenario.rates, evidence.scenario.angles.theta);
    let (start_sin, start_cos) = sin_cos(start);
    let axial = top.axial_moment;
    // Jellett's integral is `per_spin ψ̇ + unspun`.
    let per_spin = axial * (top.center_distance + top.peg_radius * start_cos);
    let carried = rates.phi * start_cos;
    let across = top.central_moment() * rates.phi * start_sin * start_sin;
    let unspun = per_spin * carried + top.peg_radius * across;
    if 0.5 * per_spin * per_spin / least_jellett_moment(top, start) < 0.5 * axial * (1.0 - ROUNDED)
    {
        return SufficientSpin::Faster;
    }
    let unspun_energy = energy - axial * rates.psi * (0.5 * rates.psi + carried);
    // Rounding of the energies, which may be much larger than the least that is lacking.
    let rounded = 64.0 * f64::EPSILON * energy.abs() + ROUNDED * unspun_energy.abs();
    for theta in inclinations(start) {
        let (sin, cos) = sin_cos(theta);
        let moment = top.jellett_moment(sin, cos);
        let square = 0.5 * (per_spin * per_spin / moment - axial);
        let linear = per_spin * unspun / moment - axial * carried;
        let constant = top.least_energy(unspun, sin, cos) - unspun_energy;
        let is_open_upwards = square > ROUNDED * axial;
        if is_open_upwards && constant - 0.25 * linear * linear / square > rounded {
            return SufficientSpin::Absent;
        }
    }
    SufficientSpin::Unknown
}

/// The least [`Top::jellett_moment`] between this inclination, rad, and the horizontal, without that at this inclination:
/// there the top has enough energy.
fn least_jellett_moment(top: &Top, start: f64) -> f64 {
    let (_, start_cos) = sin_cos(start);
    let at_horizontal = top.jellett_moment(1.0, 0.0);
    // A quadratic function of cos θ.
    let excess = top.axial_moment - top.central_moment();
    let cos = -top.axial_moment * top.center_distance / (top.peg_radius * excess);
    if cos > 0.0 && cos < start_cos {
        at_horizontal.min(top.jellett_moment((1.0 - cos * cos).sqrt(), cos))
    } else {
        at_horizontal
    }
}
