//! Explanation for a free peg.

use super::evidence::{Evidence, known_deviations};
use super::fact::Fact;
use super::fixed;
use crate::analysis::history::PegHistory;
use std::f64::consts::FRAC_PI_2;

/// What happened.
pub(super) fn motion(evidence: &Evidence) -> Vec<Fact> {
    let history = &evidence.history;
    let end = history.stop_time().unwrap_or(0.0);
    let mut facts = vec![fixed::start(evidence)];
    facts.extend(fixed::mean_theta(evidence));
    facts.extend(fixed::end(evidence));
    if history.is_tippe_top() {
        let starts_inverted = evidence.scenario.angles.theta >= FRAC_PI_2;
        facts.extend(match history.inverted {
            Some(time) if history.has_exact_inversion() && history.is_inverted_at_end() => {
                Some(Fact::Inverted { time })
            }
            Some(time) if history.has_exact_inversion() => Some(Fact::PassesHorizontal { time }),
            None if !starts_inverted => Some(Fact::NotInverted { time: end }),
            _ => None,
        });
    } else {
        facts.extend(fixed::loops(evidence));
        facts.extend(fixed::limits(evidence));
    }
    let Some(peg) = &evidence.summary.peg else {
        return facts;
    };
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

/// The causes of the motion of the axis.
pub(super) fn cause(evidence: &Evidence) -> Vec<Fact> {
    let is_constant = !evidence.scenario.model.friction.has_losses();
    let peg = evidence.summary.peg.as_ref();
    match peg.and_then(|peg| peg.jellett_deviation) {
        Some(deviation) if known_deviations(is_constant).contains(&deviation) => {
            vec![Fact::Jellett {
                deviation,
                is_constant,
            }]
        }
        _ => Vec::new(),
    }
}

/// The losses of energy.
pub(super) fn energy(evidence: &Evidence) -> Vec<Fact> {
    let mut facts = fixed::balance(evidence);
    let peg = evidence.summary.peg.as_ref();
    if let Some([sliding, losses, ..]) = peg.and_then(|peg| peg.lost)
        && sliding > 0.0
    {
        facts.push(Fact::Sliding { sliding, losses });
    }
    if let Some((count @ 1.., lost)) = peg.and_then(|peg| peg.impacts.zip(peg.impact_loss)) {
        let history = evidence.history.peg.as_ref();
        facts.push(Fact::Impacts {
            count,
            after_samples: history.map_or(0, PegHistory::impacts_after_samples),
            lost,
        });
    }
    let path = evidence.summary.slip_path.filter(|path| *path > 0.0);
    facts.extend(path.map(|length| Fact::SlipPath { length }));
    facts
}
