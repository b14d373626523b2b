//! Explanation for a fixed peg.

use super::evidence::{Evidence, ROUNDED, known_deviations};
use super::fact::Fact;
use super::precession;
use crate::physics::friction::Dissipation;
use crate::run::simulation::EventKind;

/// What happened.
pub(super) fn motion(evidence: &Evidence) -> Vec<Fact> {
    let mut facts = vec![start(evidence)];
    facts.extend(mean_theta(evidence));
    facts.extend(end(evidence));
    facts.extend(loops(evidence));
    facts.extend(limits(evidence));
    facts.extend(sticks(evidence));
    facts
}

/// The times at which the contact point stops slipping.
fn sticks(evidence: &Evidence) -> Option<Fact> {
    let mut first = None;
    let (mut count, mut slips) = (0, true);
    for event in &evidence.history.events {
        match event.kind {
            // It may stick in the moment in which it stops slipping.
            Some(EventKind::Stick | EventKind::SlipStops) if slips => {
                first = first.or(Some(event.time));
                count += 1;
                slips = false;
            }
            Some(EventKind::SlipResumes) => slips = true,
            _ => {}
        }
    }
    first.map(|time| Fact::Sticks {
        time,
        count,
        slips_at_end: slips,
    })
}

/// The inclinations at which a top has risen or fallen, if it reached them.
pub(super) fn limits(evidence: &Evidence) -> Vec<Fact> {
    let mut facts = Vec::new();
    if let Some(event) = evidence.history.first(EventKind::Risen) {
        facts.push(Fact::Risen {
            theta: event.state.theta,
            time: event.time,
        });
    }
    if let Some(event) = evidence.fall() {
        facts.push(Fact::Fallen {
            theta: event.state.theta,
            time: event.time,
        });
    }
    facts
}

/// The start of the run.
pub(super) fn start(evidence: &Evidence) -> Fact {
    Fact::Start {
        theta: evidence.scenario.angles.theta,
        psi_dot: evidence.scenario.rates.psi,
    }
}

/// The inclination in the first and the last nutation.
pub(super) fn mean_theta(evidence: &Evidence) -> Option<Fact> {
    let [first, last] = evidence.mean_theta()?;
    Some(if evidence.is_constant_theta([first, last]) {
        Fact::ThetaConstant { theta: last }
    } else {
        Fact::MeanTheta { first, last }
    })
}

/// The inclination at the end, unless the last nutation or the event that ends the run shows it.
pub(super) fn end(evidence: &Evidence) -> Option<Fact> {
    let history = &evidence.history;
    let [_, last] = history.states?;
    // Their facts have the inclination already.
    let is_at_limit = [EventKind::Risen, EventKind::Fallen]
        .into_iter()
        .filter_map(|kind| history.first(kind))
        .any(|event| Some(event.time) == history.stop_time());
    let mut nutation_end = None;
    if let [_, .., cycle] = &history.cycles[..] {
        let has_ended = cycle.is_last_before(last.time);
        // Where a tippe top ends is what it is about.
        if !has_ended && !history.is_tippe_top() {
            return None;
        }
        nutation_end = Some(cycle.end()).filter(|_| has_ended);
    }
    (!is_at_limit || nutation_end.is_some()).then_some(Fact::End {
        theta: last.theta,
        nutation_end,
    })
}

/// Loops of the axis.
pub(super) fn loops(evidence: &Evidence) -> Option<Fact> {
    let mut loops = evidence.history.events_of(EventKind::LoopingBegins);
    let first = loops.next()?.time;
    Some(Fact::Loops {
        count: 1 + loops.count() as u64,
        first,
    })
}

/// The causes of the motion of the axis.
pub(super) fn cause(evidence: &Evidence) -> Vec<Fact> {
    let friction = &evidence.scenario.model.friction;
    let mut facts = Vec::new();
    facts.extend(precession::regular(evidence));
    // Without friction there is no such term.
    if !evidence.scenario.is_frictionless() {
        facts.extend(precession::friction(evidence));
    }
    if let Some(Fact::FrictionOnPrecession { .. }) = facts.last() {
        facts.extend(precession::cancelling(evidence));
    }
    // Only sliding friction has parts.
    let is_part = friction.dissipation != Dissipation::Full && !friction.law.is_none();
    if is_part {
        facts.push(Fact::ModelPart {
            dissipation: evidence.scenario.word("friction.dissipation").to_owned(),
            drops_term: friction.dissipation.drops_euler_terms(),
        });
    }
    facts
}

/// The losses of energy.
pub(super) fn energy(evidence: &Evidence) -> Vec<Fact> {
    let mut facts = balance(evidence);
    let path = evidence.summary.slip_path.filter(|path| *path > 0.0);
    facts.extend(path.map(|length| Fact::SlipPath { length }));
    let friction = &evidence.scenario.model.friction;
    let is_constant = !friction.turns_about_vertical() || evidence.scenario.is_frictionless();
    if let Some(deviation) = evidence.summary.vertical_momentum_deviation
        && known_deviations(is_constant).contains(&deviation)
    {
        facts.push(Fact::VerticalMomentum {
            deviation,
            is_constant,
        });
    }
    facts
}

/// The change of energy and its agreement with the work of friction.
pub(super) fn balance(evidence: &Evidence) -> Vec<Fact> {
    let Some(energies) = evidence.history.energies else {
        return Vec::new();
    };
    let (first, last, within) = (energies.first, energies.last, energies.imbalance);
    let change = (last - first).abs();
    let peg = evidence.summary.peg.as_ref();
    // Impacts that were not recorded may have happened, if the peg flew.
    let has_impacts = peg.is_some_and(|peg| peg.impacts != Some(0) && peg.hops != Some(0));
    let conserves = evidence.scenario.is_frictionless() && !has_impacts;
    // A change below the error of the balance is none that is known.
    if conserves || energies.work.abs() <= within || change <= within {
        let (energy, deviation) = (first, change.max(within));
        // A larger deviation is an error of the integration or of the recording.
        let is_constant = deviation <= ROUNDED * first.abs();
        return vec![if is_constant {
            Fact::EnergyConstant { energy, deviation }
        } else {
            Fact::EnergyImbalance { deviation }
        }];
    }
    let friction = &evidence.scenario.model.friction;
    let balance = Fact::Balance {
        within,
        has_friction: friction.acts_at_contact(),
        has_air_drag: friction.has_air_drag(),
        has_impacts,
    };
    let energy = Fact::Energy {
        first,
        last,
        time: energies.until,
        within,
    };
    vec![energy, balance]
}
