//! The causes of a motion, a file each: they make the claims that hold in a run.

mod conservation;
mod fall;
mod flight;
mod grip;
mod rise;
mod stretch;
mod tippe;

use self::stretch::Stretch;
use super::claim::{Claim, Effect};
use super::evidence::Evidence;

/// The claims that hold in a run whose samples and events are all known, in the order of time.
pub(super) fn claims(evidence: &Evidence) -> Vec<Claim> {
    let mut claims = Vec::new();
    claims.extend(conservation::conserves(evidence));
    claims.extend(rise::friction_speeds_precession(evidence));
    claims.extend(rise::losses_align(evidence));
    claims.extend(flight::bounces(evidence));
    claims.extend(
        tippe::inverts(evidence)
            .or_else(|| tippe::stays_upright(evidence))
            .or_else(|| tippe::not_inverted(evidence)),
    );
    claims.extend(fall::weak_top_falls(evidence).or_else(|| fall::swings_down(evidence)));
    for stretch in stretch::stretches(evidence) {
        let change = change(evidence, &stretch, &claims);
        claims.extend(change);
    }
    claims.extend(grip::slip_ends(evidence, &claims));
    claims.extend(grip::rests(evidence));
    claims.sort_by(|one, other| one.interval().order(other.interval()));
    claims
}

/// Why the top rises or sinks in a stretch; `None` if a claim on the whole run, or on its fall, says it.
fn change(evidence: &Evidence, stretch: &Stretch, claims: &[Claim]) -> Option<Claim> {
    if let Some(raises) = rise::friction_raises(evidence, stretch) {
        return Some(raises);
    }
    let is_told = claims.iter().any(|claim| match claim.effect() {
        Effect::Rise => stretch.change < 0.0,
        Effect::Fall { time } => stretch.contains(time),
        // The mean inclination of a tippe top follows from its inversion.
        Effect::Inversion => true,
        Effect::Other => false,
    });
    // Without friction, it does not change.
    if is_told || evidence.scenario.is_frictionless() {
        return None;
    }
    fall::friction_lowers(evidence, stretch)
        .or_else(|| stretch::mean_inclination_changes(evidence, stretch))
}
