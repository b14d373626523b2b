//! Why a top falls.

use super::stretch::Stretch;
use crate::analysis::explain::claim::{Claim, Weakness};
use crate::analysis::explain::evidence::{Evidence, ROUNDED};
use crate::analysis::explain::momentum::MomentumSpan;
use crate::analysis::history::Cycle;
use crate::analysis::losses::Losses;
use crate::physics::kinematics::Tilt;
use crate::physics::math::sin_cos;
use crate::run::simulation::EventKind;
use std::f64::consts::FRAC_PI_2;

/// A top that is weak when it falls.
pub(super) fn weak_top_falls(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    let model = &evidence.scenario.model;
    let top = model.nutating_top();
    let fallen = history.first(EventKind::Fallen)?;
    let span = evidence.observations.momentum.whole?;
    if top.gravity_moment() <= 0.0 {
        return None;
    }
    let critical = (4.0 * top.gravity_moment() * top.transverse_moment).sqrt();
    // The run may go on after the fall.
    let axial = [span.from.axial, top.axial_moment * fallen.axial_rate()];
    let is_weak = axial[1].abs() < critical;
    let falls = fallen.state.theta > span.from.theta;
    let is_weak_from_start = axial[0].abs() < critical;
    let swing = Swing::new(evidence, fallen.state.theta);
    let falls_without_friction = swing.excess() > 0.0;
    let slows = axial[0].abs() - axial[1].abs() > ROUNDED * axial[0].abs();
    // Strong at the start, the top falls because of friction; weak, it falls without it, or is slowed further first.
    let weakness = match (is_weak_from_start, falls_without_friction) {
        (true, true) => Weakness::FromStart,
        (true, false) => Weakness::NeedsLoss,
        (false, _) => Weakness::ByLoss,
    };
    let is_by_spin = match weakness {
        Weakness::FromStart => true,
        Weakness::NeedsLoss => slows,
        Weakness::ByLoss => !falls_without_friction,
    };
    // More of the energy comes from gravity than from the motion at the start.
    let is_cause = swing.by_gravity > swing.kinetic && is_by_spin;
    // A fall that mostly precedes the weakness has another cause, such as a fast precession.
    let falls_when_weak = is_weak_from_start
        || history.first(EventKind::WeakTop).is_some_and(|weak| {
            weak.state.theta - span.from.theta < 0.5 * (fallen.state.theta - span.from.theta)
        });
    (is_weak && falls && is_cause && falls_when_weak).then_some(Claim::WeakTopFalls {
        axial,
        critical,
        theta: [span.from.theta, fallen.state.theta],
        time: fallen.time,
        losses: Losses::new(&model.friction),
        weakness,
    })
}

/// A fall, or the beginning of one, in fast precession.
pub(super) fn friction_lowers(evidence: &Evidence, stretch: &Stretch) -> Option<Claim> {
    let model = &evidence.scenario.model;
    // Without terms of the Euler equations, no torque shortens the angular momentum.
    if model.friction.dissipation.drops_euler_terms() || model.top.gravity_moment() <= 0.0 {
        return None;
    }
    let MomentumSpan {
        from,
        to,
        inclination,
        ..
    } = stretch.span;
    let increase = to.angle_to_axis - from.angle_to_axis;
    // The inclination of the axis is within `inclination` of its angle to the angular momentum.
    // Beyond a right angle, the axis would turn towards the other end of the line.
    let must_sink = increase > 2.0 * inclination && to.angle_to_axis < FRAC_PI_2;
    // Gravity and the normal force have no torque about the axis: only friction changes the part about it. If the whole
    // does not grow, only that can increase the angle.
    let loses = from.axial.abs() - to.axial.abs() > ROUNDED * from.axial.abs();
    let is_cause = loses && from.axial * to.axial > 0.0 && to.size() <= from.size();
    let fallen = evidence.history.first(EventKind::Fallen);
    (must_sink && is_cause).then_some(Claim::FrictionLowers {
        from: from.time,
        until: to.time,
        angle_to_momentum: [from.angle_to_axis, to.angle_to_axis],
        momentum_inclination: inclination,
        axial: [from.axial, to.axial],
        theta: [from.theta, to.theta],
        falls: fallen.is_some_and(|fallen| stretch.contains(fallen.time)),
        losses: stretch.losses(evidence),
    })
}

/// A top that falls in its first nutation as its energy and its angular momenta allow without friction, and not because it
/// is weak.
pub(super) fn swings_down(evidence: &Evidence) -> Option<Claim> {
    let fallen = evidence.fall()?;
    let first_end = evidence.history.cycles.first().map(Cycle::end);
    // In its first nutation, friction has changed little; without friction, each one is as the first.
    let is_first = first_end.is_none_or(|end| fallen.time <= end);
    if !is_first && !evidence.scenario.is_frictionless() {
        return None;
    }
    let swing = Swing::new(evidence, fallen.state.theta);
    let top = evidence.scenario.model.nutating_top();
    let start = Tilt::from_rates(evidence.scenario.angles.theta, evidence.scenario.rates);
    // Of a weak top that gravity swings down, its weakness is the reason.
    let is_weak = top.strength_ratio(&start) <= 1.0 && swing.by_gravity > swing.kinetic;
    (swing.excess() > 0.0 && !is_weak).then_some(Claim::SwingsDown {
        theta: [evidence.scenario.angles.theta, fallen.state.theta],
        time: fallen.time,
        kinetic: swing.kinetic,
        by_gravity: swing.by_gravity,
    })
}

/// The energy of the motion from the start to an inclination, without friction.
///
/// Energy and the angular momenta about the vertical and the axis are then constant, and so the part of the energy in θ̇
/// is a function of θ that is positive in one interval only: that between the turning points. The axis swings to and fro
/// between these, and reaches what is in between.
struct Swing {
    /// Kinetic energy of the motion across the axis at the start, J.
    kinetic: f64,
    /// Work of gravity from the start to the inclination, J.
    by_gravity: f64,
    /// The energy that the precession has at the inclination, J: (L_z′ − L_n cos θ)²/(2 I_x sin² θ).
    needed: f64,
}

impl Swing {
    /// The swing to an inclination, rad.
    fn new(evidence: &Evidence, theta: f64) -> Self {
        let model = &evidence.scenario.model;
        let top = model.nutating_top();
        let (rates, start) = (evidence.scenario.rates, evidence.scenario.angles.theta);
        let ((start_sin, start_cos), (sin, cos)) = (sin_cos(start), sin_cos(theta));
        // The centre of mass of a top with a free peg goes up and down with θ.
        let nodding_moment = if model.support.is_free() {
            let lever = top.center_distance * start_sin;
            top.transverse_moment + top.mass * lever * lever
        } else {
            top.transverse_moment
        };
        let axial = top.axial_moment * (rates.psi + rates.phi * start_cos);
        let precession_rate = rates.phi * start_sin;
        let vertical = top.transverse_moment * precession_rate * start_sin + axial * start_cos;
        let horizontal = (vertical - axial * cos) / sin;
        Self {
            kinetic: 0.5 * nodding_moment * rates.theta * rates.theta
                + 0.5 * top.transverse_moment * precession_rate * precession_rate,
            by_gravity: top.gravity_moment() * (start_cos - cos),
            needed: 0.5 * horizontal * horizontal / top.transverse_moment,
        }
    }

    /// The energy that is left at the inclination, J; positive if the axis reaches it.
    fn excess(&self) -> f64 {
        self.kinetic + self.by_gravity - self.needed
    }
}
