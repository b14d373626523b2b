//! Flights and impacts of a free peg.

use crate::analysis::explain::claim::Claim;
use crate::analysis::explain::evidence::Evidence;
use crate::analysis::history::{Interval, PegPhase, in_phase};
use crate::run::simulation::EventKind;

/// A peg that hops or bounces.
pub(super) fn bounces(evidence: &Evidence) -> Option<Claim> {
    let peg = evidence.summary.peg.as_ref()?;
    // Otherwise the end is that of a recording, and not of the run.
    evidence.history.stop_reason()?;
    let flights = in_phase(&evidence.peg_intervals, PegPhase::Flying);
    let (first, last) = (flights.first()?, flights.last()?);
    let lands = landing(evidence, last);
    // Bounces between impacts are one flight.
    let bounces_to_end = lands.is_none()
        && flights.len() == 1
        && evidence
            .observations
            .impacts
            .zip(evidence.history.stop_time())
            .is_some_and(|(impacts, end)| end - impacts.last <= impacts.longest_gap);
    Some(Claim::Bounces {
        from: first.from,
        hops: peg.hops?,
        impacts: peg.impacts?,
        lost: peg.impact_loss?,
        starts_in_air: starts_in_air(evidence),
        lands,
        bounces_to_end,
    })
}

fn starts_in_air(evidence: &Evidence) -> bool {
    let scenario = &evidence.scenario;
    // Another may lift off at once: nothing pulls it down to the table.
    scenario.model.support.is_free() && scenario.start().is_in_flight(scenario.model.top.peg_radius)
}

/// The end of the last flight, s; `None` if the peg is in the air at the end: its last event decides, because what follows
/// may take no time.
fn landing(evidence: &Evidence, last_flight: &Interval) -> Option<f64> {
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
    (!is_in_air).then_some(last_flight.to)
}
