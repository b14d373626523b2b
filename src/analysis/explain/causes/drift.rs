//! How the mean inclination changes, and by what.

use crate::analysis::explain::claim::Claim;
use crate::analysis::explain::evidence::Evidence;
use crate::analysis::explain::momentum::MomentumState;
use crate::analysis::explain::observations::MotionState;
use crate::analysis::losses::Losses;

/// Part of the range of the mean inclination by which it may turn back and still change in one sense.
const SMALL_PART: f64 = 0.25;

/// The mean motion at the end of a nutation, or the motion at the end of a run that no longer nutates.
#[derive(Clone, Copy)]
struct MeanMotion {
    /// Mean inclination, rad.
    theta: f64,
    momentum: MomentumState,
    /// Number of impacts up to then.
    impacts: u64,
}

impl MeanMotion {
    /// `None` without angular momenta.
    fn new(theta: f64, state: MotionState) -> Option<Self> {
        Some(Self {
            theta,
            momentum: state.momentum?,
            impacts: state.impacts,
        })
    }
}

/// Each rise and fall of the mean inclination while the contact point slips.
pub(super) fn drifts(evidence: &Evidence) -> Vec<Claim> {
    let motions = mean_motions(evidence).unwrap_or_default();
    let Some(turning) = turning(&motions) else {
        return Vec::new();
    };
    let top = evidence.scenario.model.nutating_top();
    let mut claims = Vec::new();
    for part in [&motions[..=turning], &motions[turning..]] {
        let [first, .., last] = part else {
            continue;
        };
        let ends = [first, last];
        claims.push(Claim::MeanInclinationChanges {
            from: first.momentum.time,
            until: last.momentum.time,
            mean_theta: ends.map(|motion| motion.theta),
            regular_theta: ends.map(|motion| {
                top.regular_inclination(motion.momentum.vertical, motion.momentum.axial)
            }),
            has_impacts: last.impacts > first.impacts,
            losses: Losses::new(&evidence.scenario.model.friction),
        });
    }
    claims
}

/// The mean motions in the order of time, up to the time from which the contact point grips to the end: static friction
/// changes the angular momenta of a rolling top to and fro, and holds one that sticks. `None` if momenta are missing.
fn mean_motions(evidence: &Evidence) -> Option<Vec<MeanMotion>> {
    let observations = &evidence.observations;
    let whole = observations.momentum.whole()?;
    let (end, theta, last_state) = match observations.grip {
        Some(grip) => (grip.from, grip.theta_at_start, grip.before),
        None => (f64::INFINITY, whole.to.theta, observations.latest()),
    };
    let mut motions = Vec::new();
    let mut last = None;
    let cycles = &evidence.history.cycles;
    for (cycle, state) in cycles.iter().zip(&observations.nutation_ends) {
        if cycle.end() <= end {
            motions.push(MeanMotion::new(cycle.means[0], *state)?);
            last = Some(cycle);
        }
    }
    if last.is_some_and(|last| last.is_last_before(end.min(whole.to.time))) {
        motions.push(MeanMotion::new(theta, last_state)?);
    }
    Some(motions)
}

/// The motion with the greatest mean inclination or with the least, whichever is farther beyond those of the first and the
/// last one; the last one if neither is by more than a small part of the range. `None` if there are fewer than two.
fn turning(motions: &[MeanMotion]) -> Option<usize> {
    let [first, .., end] = motions else {
        return None;
    };
    let (mut least, mut greatest) = (0, 0);
    for (at, motion) in motions.iter().enumerate() {
        if motion.theta < motions[least].theta {
            least = at;
        }
        if motion.theta > motions[greatest].theta {
            greatest = at;
        }
    }
    let below = first.theta.min(end.theta) - motions[least].theta;
    let above = motions[greatest].theta - first.theta.max(end.theta);
    let (farthest, distance) = if below > above {
        (least, below)
    } else {
        (greatest, above)
    };
    let range = motions[greatest].theta - motions[least].theta;
    Some(if distance > SMALL_PART * range {
        farthest
    } else {
        motions.len() - 1
    })
}
