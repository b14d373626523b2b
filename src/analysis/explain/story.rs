//! Why a top moves as it does, in a paragraph.

use super::claim::{Claim, Hold, Inversion, Stopped};
use super::course::Course;
use super::drift::{self, Drift};
use super::evidence::{Evidence, ROUNDED};
use super::fact::{Fact, PrecessionRoot};
use super::fixed;
use super::momentum::MomentumSpan;
use super::observations::{Ends, GripSpan};
use super::precession;
use super::tippe::{self, NotInverted};
use crate::analysis::history::{Constancy, Cycle, PegPhase, in_phase};
use crate::physics::kinematics::Tilt;
use crate::physics::math::sin_cos;
use crate::run::simulation::{EventKind, StopReason};
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// The causes of a motion, in the order in which they are told.
///
/// Each claim is carried by numbers of the run. If none of the known causes is shown by them, there is no claim.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Story {
    /// The claims, with their numbers.
    pub claims: Vec<Claim>,
    /// Rise and fall of the axis, as the words of all claims have it.
    #[serde(skip)]
    course: Course,
    /// A reason in words that is no claim: reports have had no member for it since version 1.0.
    #[serde(skip)]
    remark: Option<Remark>,
}

/// A reason for what the claims leave open.
#[derive(Clone, Debug, PartialEq)]
enum Remark {
    /// A tippe top that has not turned over.
    NotInverted(NotInverted),
    /// A strong top that falls as it would without friction.
    SwingsDown {
        /// Whether it would without gravity, too.
        without_gravity: bool,
    },
    /// A rise or fall on average, or a fall after a rise.
    Drifts(Drift),
}

impl Remark {
    /// Whether it is told before claims on what follows a rise or fall.
    fn comes_first(&self) -> bool {
        match self {
            Self::NotInverted(_) | Self::SwingsDown { .. } => false,
            Self::Drifts(drift) => drift.comes_first(),
        }
    }

    fn words(&self) -> String {
        match self {
            Self::NotInverted(reason) => reason.words().to_owned(),
            Self::Drifts(drift) => drift.words(),
            Self::SwingsDown {
                without_gravity: true,
            } => {
                "The top falls because of its motion at the start, which would carry the axis down so far even without gravity.".to_owned()
            }
            Self::SwingsDown {
                without_gravity: false,
            } => {
                "The top falls although its spin could hold it upright: with its motion at the start, gravity swings the axis down so far before the spin turns it up again.".to_owned()
            }
        }
    }
}

impl Story {
    /// A paragraph in words, without numbers; `None` if there is no claim.
    pub fn text(&self) -> Option<String> {
        if self.claims.is_empty() && self.remark.is_none() {
            return None;
        }
        let (first, later): (Vec<&Claim>, Vec<&Claim>) = self
            .claims
            .iter()
            .partition(|claim| self.course.comes_first(claim));
        let mut words = Vec::new();
        let mut remark = self.remark.as_ref();
        for claim in first.into_iter().chain(later) {
            if is_after_drift(claim) {
                words.extend(
                    remark
                        .take_if(|remark| remark.comes_first())
                        .map(Remark::words),
                );
            }
            words.push(claim.words_in(self.course, &self.claims));
        }
        words.extend(remark.map(Remark::words));
        Some(words.join(" "))
    }
}

/// Whether a claim is about what follows a rise or fall on average.
fn is_after_drift(claim: &Claim) -> bool {
    claim.is_fall() || matches!(claim, Claim::SlipEnds { .. } | Claim::ComesToRest { .. })
}

/// The causes of a motion whose samples and events are all known.
pub(super) fn story(evidence: &Evidence) -> Story {
    let mut claims = Vec::new();
    claims.extend(conserves(evidence));
    // In the order of time: a top that starts in the air bounces first, others hop while they rise.
    let starts_in_air = starts_in_air(evidence);
    if starts_in_air {
        claims.extend(bounces(evidence));
    }
    let raises = friction_raises(evidence);
    let rises = raises.is_some();
    claims.extend(raises);
    claims.extend(friction_speeds_precession(evidence));
    claims.extend(losses_align(evidence));
    if !starts_in_air {
        claims.extend(bounces(evidence));
    }
    let inversion = tippe::inverts(evidence).or_else(|| tippe::stays_upright(evidence));
    let is_inversion_claimed = inversion.is_some();
    claims.extend(inversion);
    claims.extend(slip_ends(evidence, rises, is_inversion_claimed));
    claims.extend(weak_top_falls(evidence).or_else(|| friction_lowers(evidence)));
    claims.extend(rests(evidence));
    let history = &evidence.history;
    let has_fallen = history.first(EventKind::Fallen).is_some() || history.inverted.is_some();
    let remark = remark(evidence, &claims);
    let course = Course::new(
        &claims,
        has_fallen,
        matches!(remark, Some(Remark::Drifts(_))),
    );
    Story {
        claims,
        course,
        remark,
    }
}

fn remark(evidence: &Evidence, claims: &[Claim]) -> Option<Remark> {
    let is_inversion_claimed = claims
        .iter()
        .any(|claim| claim.is_inversion() || matches!(claim, Claim::SlipEnds { .. }));
    if !is_inversion_claimed && let Some(reason) = tippe::not_inverted(evidence) {
        return Some(Remark::NotInverted(reason));
    }
    if claims.iter().any(Claim::is_inversion) {
        return None;
    }
    if evidence.scenario.is_frictionless() {
        return swings_down(evidence, claims);
    }
    let rises = claims.iter().any(Claim::is_rise);
    let falls = claims.iter().any(Claim::is_fall);
    match (rises, falls) {
        (true, true) => None,
        (true, false) => {
            let is_held = claims
                .iter()
                .any(|claim| matches!(claim, Claim::SlipEnds { .. }));
            drift::later_fall(evidence, is_held).map(Remark::Drifts)
        }
        (false, true) => drift::earlier_rise(evidence).map(Remark::Drifts),
        (false, false) => {
            swings_down(evidence, claims).or_else(|| drift::drift(evidence).map(Remark::Drifts))
        }
    }
}

/// A top that falls as it would without friction, as its energy and its angular momenta allow, and not because it is
/// weak.
fn swings_down(evidence: &Evidence, claims: &[Claim]) -> Option<Remark> {
    let fallen = evidence.history.first(EventKind::Fallen)?;
    let conserves = claims
        .iter()
        .any(|claim| matches!(claim, Claim::Conserves { .. }));
    let first_end = evidence.history.cycles.first().map(Cycle::end);
    // In its first nutation, friction has changed little.
    if !conserves && first_end.is_some_and(|end| fallen.time > end) {
        return None;
    }
    let theta = fallen.state.theta;
    let top = evidence.scenario.model.nutating_top();
    let start = Tilt::from_rates(evidence.scenario.angles.theta, evidence.scenario.rates);
    let falls = theta > evidence.scenario.angles.theta;
    let is_strong = top.strength_ratio(&start) > 1.0;
    let [without_gravity, with_gravity] =
        [0.0, top.gravity_moment()].map(|moment| can_reach(evidence, theta, moment));
    // Of a weak top, its weakness would be half of the reason.
    let is_known = without_gravity || (with_gravity && is_strong);
    (falls && is_known).then_some(Remark::SwingsDown { without_gravity })
}

fn conserves(evidence: &Evidence) -> Option<Claim> {
    if !evidence.scenario.is_frictionless() || evidence.may_have_impacts() {
        return None;
    }
    let energies = evidence.history.energies?;
    let energy_deviation = energies
        .imbalance
        .max((energies.last - energies.first).abs());
    let momentum = &evidence.observations.momentum;
    let (vertical, axial) = (momentum.vertical()?, momentum.axial()?);
    // Both may be zero: what counts is the size of the angular momentum.
    let size = momentum.largest();
    let is_constant = energy_deviation <= ROUNDED * energies.first.abs()
        && is_constant(vertical, size)
        && is_constant(axial, size);
    let mean_theta = match fixed::mean_theta(evidence) {
        Some(Fact::ThetaConstant { .. }) => evidence.mean_theta(),
        _ => None,
    };
    is_constant.then_some(Claim::Conserves {
        energy_deviation,
        momentum_deviations: [vertical.deviation, axial.deviation],
        mean_theta,
    })
}

fn is_constant(constancy: Constancy, size: f64) -> bool {
    constancy.deviation <= ROUNDED * size
}

fn friction_raises(evidence: &Evidence) -> Option<Claim> {
    let friction = &evidence.scenario.model.friction;
    // Without terms of the Euler equations there is no torque that would change the angular momentum.
    if friction.dissipation.drops_euler_terms() || evidence.history.is_tippe_top() {
        return None;
    }
    let span = evidence.observations.momentum.rise()?;
    let change = span.to.horizontal - span.from.horizontal;
    let descent = span.from.inclination() - span.to.inclination();
    // The axis is within `angle_to_axis` of the angular momentum, at the beginning as at the end.
    let must_follow = descent > 2.0 * span.angle_to_axis;
    let is_by_friction = change < 0.0 && span.by_friction < 0.5 * change;
    let is_vertical_constant = !friction.turns_about_vertical()
        && is_constant(
            evidence.observations.momentum.vertical()?,
            span.from.vertical.abs(),
        );
    (must_follow && is_by_friction).then_some(Claim::FrictionRaises {
        horizontal: [span.from.horizontal, span.to.horizontal],
        vertical: [span.from.vertical, span.to.vertical],
        is_vertical_constant,
        by_friction: span.by_friction,
        angle_to_momentum: span.angle_to_axis,
        theta: [span.from.theta, span.to.theta],
        until: span.to.time,
        theta_at_end: evidence.observations.momentum.whole()?.to.theta,
        has_friction: friction.acts_at_contact(),
        has_air_drag: friction.has_air_drag(),
    })
}

fn friction_speeds_precession(evidence: &Evidence) -> Option<Claim> {
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

fn losses_align(evidence: &Evidence) -> Option<Claim> {
    let model = &evidence.scenario.model;
    let top = model.nutating_top();
    let is_oblate = top.axial_moment > top.transverse_moment;
    // Without terms of the Euler equations, energy is not lost by a torque.
    if !is_oblate || model.friction.dissipation.drops_euler_terms() {
        return None;
    }
    let span = evidence.observations.momentum.whole()?;
    let energies = evidence.history.energies?;
    let decrease = span.from.angle_to_axis - span.to.angle_to_axis;
    // The inclination of the axis is within `inclination` of its angle to the angular momentum.
    let must_rise = decrease > 2.0 * span.inclination;
    let loses = energies.first - energies.last > energies.imbalance;
    (must_rise && loses).then_some(Claim::LossesAlign {
        angle_to_momentum: [span.from.angle_to_axis, span.to.angle_to_axis],
        momentum_inclination: span.inclination,
        energy: [energies.first, energies.last],
        has_friction: model.friction.acts_at_contact(),
        has_air_drag: model.friction.has_air_drag(),
    })
}

fn weak_top_falls(evidence: &Evidence) -> Option<Claim> {
    let history = &evidence.history;
    let model = &evidence.scenario.model;
    let top = model.nutating_top();
    let fallen = history.first(EventKind::Fallen)?;
    let span = evidence.observations.momentum.whole()?;
    if top.gravity_moment() <= 0.0 {
        return None;
    }
    let critical = (4.0 * top.gravity_moment() * top.transverse_moment).sqrt();
    // The run may go on after the fall.
    let axial = [span.from.axial, top.axial_moment * fallen.axial_rate()];
    let is_weak = axial[1].abs() < critical;
    let falls = fallen.state.theta > span.from.theta;
    let is_weak_from_start = axial[0].abs() < critical;
    let falls_without_friction = can_reach(evidence, fallen.state.theta, top.gravity_moment());
    let slows = axial[0].abs() - axial[1].abs() > ROUNDED * axial[0].abs();
    // Strong at the start, the top falls because of friction; weak, it falls without it, or is slowed further first.
    let needs_loss = is_weak_from_start && !falls_without_friction;
    let is_by_spin = if is_weak_from_start {
        falls_without_friction || slows
    } else {
        !falls_without_friction
    };
    let is_cause = !can_reach(evidence, fallen.state.theta, 0.0) && is_by_spin;
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
        has_friction: model.friction.acts_at_contact(),
        has_air_drag: model.friction.has_air_drag(),
        needs_loss,
    })
}

/// A fall, or the beginning of one, in fast precession.
fn friction_lowers(evidence: &Evidence) -> Option<Claim> {
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
    } = evidence.observations.momentum.descent()?;
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
        angle_to_momentum: [from.angle_to_axis, to.angle_to_axis],
        momentum_inclination: inclination,
        axial: [from.axial, to.axial],
        theta: [from.theta, to.theta],
        falls: fallen.is_some_and(|fallen| fallen.time > from.time),
        has_friction: model.friction.acts_at_contact(),
        has_air_drag: model.friction.has_air_drag(),
    })
}

/// Whether the motion from the start, without friction and with this largest torque of gravity, N m, reaches an
/// inclination below that at the start, rad.
///
/// Energy and the angular momenta about the vertical and the axis are then constant, and so the part of the energy in θ̇
/// is a function of θ that is positive in one interval only: that between the turning points. The axis swings to and fro
/// between these, and reaches what is in between.
fn can_reach(evidence: &Evidence, theta: f64, gravity_moment: f64) -> bool {
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
    let kinetic = 0.5 * nodding_moment * rates.theta * rates.theta
        + 0.5 * top.transverse_moment * precession_rate * precession_rate;
    let horizontal = (vertical - axial * cos) / sin;
    // The energy of the precession at θ, (L_z′ − L_n cos θ)²/(2 I_x sin² θ); the rest of the energy is left to θ̇.
    let needed = 0.5 * horizontal * horizontal / top.transverse_moment;
    kinetic + gravity_moment * (start_cos - cos) > needed
}

fn slip_ends(evidence: &Evidence, rises: bool, is_inversion_claimed: bool) -> Option<Claim> {
    let GripSpan {
        from,
        theta_at_start,
        theta_range,
        energy,
        ..
    } = evidence.observations.grip?;
    let (theta_range, Ends { first, last }) = (theta_range?, energy?);
    let friction = &evidence.scenario.model.friction;
    let is_constant = (last - first).abs() <= ROUNDED * first.abs().max(last.abs());
    // With other losses, the energy would be constant by chance.
    let stop = evidence.history.stop_reason()?;
    if !is_constant || friction.has_losses() || stop == StopReason::Rest {
        return None;
    }
    let rolls = evidence.scenario.model.support.is_free();
    let is_fixed_inclination =
        theta_range[1] - theta_range[0] <= evidence.integration_error(theta_range[1]);
    if !rolls && !is_fixed_inclination {
        return None;
    }
    let stops = if rises && theta_range[1] < evidence.scenario.angles.theta {
        Stopped::Rise
    } else {
        Stopped::Nothing
    };
    let starts_upright = evidence.scenario.angles.theta < FRAC_PI_2;
    let inversion = match evidence.history.inverted {
        _ if !evidence.history.is_tippe_top() || !starts_upright || is_inversion_claimed => None,
        None => Some(Inversion::Absent),
        Some(time) if time <= from && theta_range[0] > FRAC_PI_2 => Some(Inversion::Complete),
        Some(_) => None,
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
        inversion,
        rolls,
    })
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

fn starts_in_air(evidence: &Evidence) -> bool {
    let scenario = &evidence.scenario;
    // Another may lift off at once: nothing pulls it down to the table.
    scenario.model.support.is_free() && scenario.start().is_in_flight(scenario.model.top.peg_radius)
}

fn bounces(evidence: &Evidence) -> Option<Claim> {
    let peg = evidence.summary.peg.as_ref()?;
    // Otherwise the end is that of a recording, and not of the run.
    evidence.history.stop_reason()?;
    let in_air_at_end = is_in_air_at_end(evidence);
    let flights = in_phase(&evidence.peg_intervals, PegPhase::Flying);
    let lands = flights.last()?.to;
    // Bounces between impacts are one flight.
    let bounces_to_end = in_air_at_end
        && flights.len() == 1
        && evidence
            .observations
            .impacts
            .zip(evidence.history.stop_time())
            .is_some_and(|(impacts, end)| end - impacts.last <= impacts.longest_gap);
    Some(Claim::Bounces {
        hops: peg.hops?,
        impacts: peg.impacts?,
        lost: peg.impact_loss?,
        starts_in_air: starts_in_air(evidence),
        lands: Some(lands).filter(|_| !in_air_at_end),
        bounces_to_end,
    })
}

/// Whether the peg is in the air at the end: its last event decides, because what follows may take no time.
fn is_in_air_at_end(evidence: &Evidence) -> bool {
    let mut is_in_air = starts_in_air(evidence);
    for event in &evidence.history.events {
        match event.kind {
            Some(EventKind::LiftOff) => is_in_air = true,
            Some(
                EventKind::Landing
                | EventKind::RollBegins
                | EventKind::RollEnds
                | EventKind::Rest
                | EventKind::Pivot,
            ) => is_in_air = false,
            _ => {}
        }
    }
    is_in_air
}

fn rests(evidence: &Evidence) -> Option<Claim> {
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
