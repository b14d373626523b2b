//! What stays constant without friction.

use crate::analysis::explain::chapters;
use crate::analysis::explain::claim::Claim;
use crate::analysis::explain::evidence::{Evidence, ROUNDED};
use crate::analysis::explain::fact::Fact;
use crate::analysis::history::Extent;

pub(super) fn conserves(evidence: &Evidence) -> Option<Claim> {
    let peg = evidence.summary.peg.as_ref();
    let may_have_impacts = peg.is_some_and(|peg| peg.impacts != Some(0));
    if !evidence.scenario.is_frictionless() || may_have_impacts {
        return None;
    }
    let energies = evidence.history.energies?;
    let energy_deviation = energies
        .imbalance
        .max((energies.last - energies.first).abs());
    let momentum = &evidence.observations.momentum;
    let (vertical, axial) = (momentum.vertical?, momentum.axial?);
    // Both may be zero: what counts is the size of the angular momentum.
    let size = momentum.largest;
    let is_constant = energy_deviation <= ROUNDED * energies.size
        && is_constant(vertical, size)
        && is_constant(axial, size);
    let mean_theta = match chapters::mean_theta(evidence) {
        Some(Fact::ThetaConstant { .. }) => evidence.mean_theta(),
        _ => None,
    };
    is_constant.then_some(Claim::Conserves {
        energy_deviation,
        momentum_deviations: [vertical.deviation(), axial.deviation()],
        mean_theta,
    })
}

/// Whether a part of a vector of this size is constant.
pub(super) fn is_constant(part: Extent, size: f64) -> bool {
    part.deviation() <= ROUNDED * size
}
