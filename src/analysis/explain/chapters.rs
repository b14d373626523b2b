//! The facts of an explanation, chapter by chapter.

use super::evidence::{Evidence, ROUNDED, known_deviations};
use super::fact::Fact;
use super::precession;
use crate::analysis::history::{PegHistory, PegSummary};
use crate::analysis::losses::Losses;
use crate::physics::friction::Dissipation;
use crate::run::simulation::EventKind;
use std::f64::consts::FRAC_PI_2;

/// What happened.
pub(super) fn motion(evidence: &Evidence) -> Vec<Fact> {
    let mut facts = vec![start(evidence)];
    facts.extend(mean_theta(evidence));
    facts.extend(end(evidence));
    if evidence.history.is_tippe_top() {
        facts.extend(inversion(evidence));
    } else {
        facts.extend(loops(evidence));
        facts.extend(limits(evidence));
    }
    if evidence.scenario.model.support.is_free() {
        facts.extend(evidence.summary.peg.iter().flat_map(peg_motion));
    } else {
        facts.extend(sticks(evidence));
    }
    facts
}

/// Whether a tippe top turns over.
fn inversion(evidence: &Evidence) -> Option<Fact> {
    let history = &evidence.history;
    match history.inverted() {
        Some(_) if history.is_inverted_at_end() => {
            let time = history.last_inversion()?;
            Some(Fact::Inverted { time })
        }
        Some(time) => Some(Fact::PassesHorizontal { time }),
        None if evidence.scenario.angles.theta < FRAC_PI_2 => Some(Fact::NotInverted {
            time: history.stop_time().unwrap_or(0.0),
        }),
        None => None,
    }
}

/// Flights and rolling of a free peg.
fn peg_motion(peg: &PegSummary) -> Vec<Fact> {
    let mut facts = Vec::new();
    if let (Some(count @ 1..), Some(first)) = (peg.hops, peg.first_flight) {
        facts.push(Fact::Hops { count, first });
    }
    match (peg.rolls_to_end_from, peg.first_roll, peg.time_rolling) {
        (Some(from), ..) => facts.push(Fact::Rolls {
            from,
            theta: peg.rolls_to_end_at.unwrap_or(f64::NAN),
        }),
        (None, Some(first), Some(duration)) => {
            facts.push(Fact::RollsAtTimes { first, duration });
        }
        _ => {}
    }
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
fn limits(evidence: &Evidence) -> Vec<Fact> {
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
fn end(evidence: &Evidence) -> Option<Fact> {
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
fn loops(evidence: &Evidence) -> Option<Fact> {
    let mut loops = evidence.history.events_of(EventKind::LoopingBegins);
    let first = loops.next()?.time;
    Some(Fact::Loops {
        count: 1 + loops.count() as u64,
        first,
    })
}

/// The causes of the motion of the axis.
pub(super) fn cause(evidence: &Evidence) -> Vec<Fact> {
    if evidence.scenario.model.support.is_free() {
        jellett(evidence).into_iter().collect()
    } else {
        precession_terms(evidence)
    }
}

/// Jellett's integral of a free peg, which no contact force changes.
fn jellett(evidence: &Evidence) -> Option<Fact> {
    let is_constant = !evidence.scenario.model.friction.has_losses();
    let deviation = evidence.summary.peg.as_ref()?.jellett_deviation?;
    known_deviations(is_constant)
        .contains(&deviation)
        .then_some(Fact::Jellett {
            deviation,
            is_constant,
        })
}

/// The terms of the precession of a top with a fixed peg.
fn precession_terms(evidence: &Evidence) -> Vec<Fact> {
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
    if let Some(peg) = &evidence.summary.peg {
        facts.extend(peg_losses(evidence, peg));
    }
    let path = evidence.summary.slip_path.filter(|path| *path > 0.0);
    facts.extend(path.map(|length| Fact::SlipPath { length }));
    if !evidence.scenario.model.support.is_free() {
        facts.extend(vertical_momentum(evidence));
    }
    facts
}

/// Losses of a free peg by sliding and in impacts.
fn peg_losses(evidence: &Evidence, peg: &PegSummary) -> Vec<Fact> {
    let mut facts = Vec::new();
    if let Some([sliding, losses, ..]) = peg.lost
        && sliding > 0.0
    {
        facts.push(Fact::Sliding { sliding, losses });
    }
    if let Some((count @ 1.., lost)) = peg.impacts.zip(peg.impact_loss) {
        let history = evidence.history.peg.as_ref();
        facts.push(Fact::Impacts {
            count,
            after_samples: history.map_or(0, PegHistory::impacts_after_samples),
            lost,
        });
    }
    facts
}

/// The angular momentum about the vertical, which only some models of friction change.
fn vertical_momentum(evidence: &Evidence) -> Option<Fact> {
    let friction = &evidence.scenario.model.friction;
    let is_constant = !friction.turns_about_vertical() || evidence.scenario.is_frictionless();
    let deviation = evidence.summary.vertical_momentum_deviation?;
    known_deviations(is_constant)
        .contains(&deviation)
        .then_some(Fact::VerticalMomentum {
            deviation,
            is_constant,
        })
}

/// The change of energy and its agreement with the work of friction.
fn balance(evidence: &Evidence) -> Vec<Fact> {
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
        let is_constant = deviation <= ROUNDED * energies.size;
        return vec![if is_constant {
            Fact::EnergyConstant { energy, deviation }
        } else {
            Fact::EnergyImbalance { deviation }
        }];
    }
    let balance = Fact::Balance {
        within,
        losses: Losses::new(&evidence.scenario.model.friction),
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
