//! The causes of a motion, a file each: they make the claims that hold in a run.

mod conservation;
mod drift;
mod fall;
mod flight;
mod grip;
mod rise;
mod tippe;

use super::claim::Claim;
use super::evidence::Evidence;

/// The claims that hold in a run whose samples and events are all known, in the order of time.
pub(super) fn claims(evidence: &Evidence) -> Vec<Claim> {
    let mut claims = Vec::new();
    claims.extend(conservation::conserves(evidence));
    claims.extend(rise::friction_raises(evidence));
    claims.extend(rise::friction_speeds_precession(evidence));
    claims.extend(rise::losses_align(evidence));
    claims.extend(flight::bounces(evidence));
    claims.extend(
        tippe::inverts(evidence)
            .or_else(|| tippe::stays_upright(evidence))
            .or_else(|| tippe::not_inverted(evidence)),
    );
    claims.extend(grip::slip_ends(evidence, &claims));
    claims.extend(
        fall::weak_top_falls(evidence)
            .or_else(|| fall::friction_lowers(evidence))
            .or_else(|| fall::swings_down(evidence)),
    );
    claims.extend(unexplained_drifts(evidence, &claims));
    claims.extend(grip::rests(evidence));
    claims.sort_by(|one, other| one.interval().order(other.interval()));
    claims
}

/// The rises and falls of the mean inclination that no other claim explains.
fn unexplained_drifts(evidence: &Evidence, claims: &[Claim]) -> Vec<Claim> {
    // Without friction, the mean inclination does not change; that of a tippe top follows from its inversion.
    if evidence.scenario.is_frictionless() || claims.iter().any(Claim::is_inversion) {
        return Vec::new();
    }
    let rises = claims.iter().any(Claim::is_rise);
    let falls = claims.iter().any(Claim::is_fall);
    let mut drifts = drift::drifts(evidence);
    drifts.retain(|drift| match drift {
        Claim::MeanInclinationChanges {
            mean_theta: [first, last],
            ..
        } if last < first => !rises,
        _ => !falls,
    });
    drifts
}
