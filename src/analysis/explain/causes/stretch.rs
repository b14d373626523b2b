//! The stretches of a run in which the top rises or sinks: each is told once.

use crate::analysis::explain::claim::Claim;
use crate::analysis::explain::evidence::{Evidence, ROUNDED};
use crate::analysis::explain::momentum::MomentumSpan;
use crate::analysis::explain::observations::Passage;
use crate::analysis::losses::Losses;
use crate::telemetry::fields::nutation;

/// Part of the range of the mean inclination by which it may turn back within a stretch.
const SMALL_PART: f64 = 0.1;

/// A stretch of a run in which the mean inclination changes in one sense, but for small parts of its range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// The angular momenta in it.
    pub(super) span: MomentumSpan,
    /// Its end, s; infinite if it lasts until the end of the run.
    until: f64,
    /// Change of the mean inclination, rad; negative in a rise.
    pub(super) change: f64,
    /// The first and the last nutation; absent if there are not two.
    nutations: Option<[Mean; 2]>,
}

impl Stretch {
    /// Whether a time, s, is in it.
    pub(super) fn contains(&self, time: f64) -> bool {
        time > self.span.from.time && time <= self.until
    }

    /// The losses that act in it.
    pub(super) fn losses(&self, evidence: &Evidence) -> Losses {
        let friction = &evidence.scenario.model.friction;
        Losses {
            has_friction: self.span.contact_friction > 0.0,
            has_air_drag: friction.has_air_drag(),
        }
    }
}

/// What a mean inclination is that of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MeanBasis {
    /// A nutation, or a motion without one.
    Nutation,
    /// A sample before the first nutation or in the last one.
    Sample,
}

/// A nutation, or the motion before or after all of them.
#[derive(Clone, Copy, Debug)]
struct Mean {
    /// Mean inclination, rad; without a nutation, the inclination at the end.
    theta: f64,
    basis: MeanBasis,
    /// The angular momenta in it.
    span: MomentumSpan,
    /// Number of impacts up to its end.
    impacts: u64,
}

impl Mean {
    /// `None` without angular momenta.
    fn new(theta: f64, basis: MeanBasis, passage: Passage) -> Option<Self> {
        Some(Self {
            theta,
            basis,
            span: passage.span?,
            impacts: passage.impacts,
        })
    }
}

/// The stretches of a run, in the order of time, up to the time from which the contact point grips to the end: static
/// friction changes the angular momenta of a rolling top to and fro, and holds one that sticks.
pub(super) fn stretches(evidence: &Evidence) -> Vec<Stretch> {
    let means = means(evidence).unwrap_or_default();
    let mut stretches = Vec::new();
    for ends in turning_points(&means).windows(2) {
        let (from, until) = (ends[0], ends[1]);
        // The first stretch begins with the run, and not with the end of its first nutation.
        let first = if from == 0 { 0 } else { from + 1 };
        let spans = means[first..=until].iter().map(|mean| mean.span);
        let mut nutations = means[from..=until]
            .iter()
            .filter(|mean| mean.basis == MeanBasis::Nutation);
        let (first, last) = (nutations.next(), nutations.next_back());
        if let Some(span) = spans.reduce(MomentumSpan::joined) {
            let is_last = until == means.len() - 1 && evidence.observations.grip.is_none();
            stretches.push(Stretch {
                span,
                until: if is_last { f64::INFINITY } else { span.to.time },
                change: means[until].theta - means[from].theta,
                nutations: first.zip(last).map(|(first, last)| [*first, *last]),
            });
        }
    }
    stretches
}

/// The nutations, and the motion after them. `None` if momenta are missing.
fn means(evidence: &Evidence) -> Option<Vec<Mean>> {
    let observations = &evidence.observations;
    let whole = observations.momentum.whole?;
    let (end, theta, rest) = match observations.grip {
        Some(grip) => (grip.from, grip.theta_at_start, grip.before),
        None => (whole.to.time, whole.to.theta, observations.latest()),
    };
    let mut means = Vec::new();
    let mut last = None;
    for (cycle, passage) in evidence.history.cycles.iter().zip(&observations.nutations) {
        if cycle.end() <= end || observations.grip.is_none() {
            means.push(Mean::new(cycle.means[0], MeanBasis::Nutation, *passage)?);
            last = Some(cycle);
        }
    }
    let Some(last) = last else {
        let start = Passage {
            span: Some(MomentumSpan::new(whole.from)),
            ..Passage::default()
        };
        means.push(Mean::new(whole.from.theta, MeanBasis::Sample, start)?);
        means.push(Mean::new(theta, MeanBasis::Sample, rest)?);
        return Some(means);
    };
    let rest = if last.is_last_before(end) {
        Mean::new(theta, MeanBasis::Nutation, rest)
    } else {
        // A part of a nutation changes the mean by as much as the axis leaves the last one.
        let least = last.field(nutation::THETA_MIN);
        let greatest = last.field(nutation::THETA_MAX);
        let departure = theta - theta.clamp(least, greatest);
        Mean::new(last.means[0] + departure, MeanBasis::Sample, rest)
    };
    means.extend(rest);
    Some(means)
}

/// The first and the last one, and those in between at which the mean inclination turns back by more than a small part
/// of its range.
fn turning_points(means: &[Mean]) -> Vec<usize> {
    let [first, .., _] = means else {
        return Vec::new();
    };
    let (mut least, mut greatest) = (first.theta, first.theta);
    for mean in means {
        least = least.min(mean.theta);
        greatest = greatest.max(mean.theta);
    }
    let small = SMALL_PART * (greatest - least);
    let mut points = vec![0];
    // The farthest in the present sense; at first, that is the sense of the first change that is not small.
    let (mut farthest, mut sense) = (0, 0.0);
    for (at, mean) in means.iter().enumerate() {
        let change = mean.theta - means[farthest].theta;
        if sense * change > 0.0 {
            farthest = at;
        } else if change.abs() > small {
            if farthest != 0 {
                points.push(farthest);
            }
            (farthest, sense) = (at, change.signum());
        }
    }
    points.push(means.len() - 1);
    points.dedup();
    points
}

/// The change of the mean inclination in a stretch, and the two parts of it.
pub(super) fn mean_inclination_changes(evidence: &Evidence, stretch: &Stretch) -> Option<Claim> {
    let span = stretch.span;
    let [first, last] = stretch.nutations?;
    let mean_theta = [first.theta, last.theta];
    let at_means = [first.span.to, last.span.to];
    // Only on the table is there a regular precession.
    let is_on_table = span.contact_friction > 0.0 || !evidence.scenario.model.support.is_free();
    // In a plane, both angular momenta are zero.
    let least_momentum = ROUNDED * evidence.observations.momentum.largest;
    let precesses = at_means
        .iter()
        .all(|at| at.vertical.abs().max(at.axial.abs()) > least_momentum);
    if evidence.is_constant_theta(mean_theta) || !is_on_table || !precesses {
        return None;
    }
    let top = evidence.scenario.model.nutating_top();
    Some(Claim::MeanInclinationChanges {
        from: span.from.time,
        until: span.to.time,
        mean_theta,
        nutation_ends: at_means.map(|at| at.time),
        regular_theta: at_means.map(|at| top.regular_inclination(at.vertical, at.axial)),
        has_impacts: last.impacts > first.impacts,
        losses: stretch.losses(evidence),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::explain::momentum::MomentumState;

    /// Means with these inclinations.
    fn means_of(thetas: &[f64]) -> Vec<Mean> {
        let span = MomentumSpan::new(MomentumState::default());
        thetas
            .iter()
            .map(|theta| Mean {
                theta: *theta,
                basis: MeanBasis::Nutation,
                span,
                impacts: 0,
            })
            .collect()
    }

    #[test]
    fn stretches_end_where_the_mean_turns_back() {
        for (thetas, expected) in [
            (&[][..], &[][..]),
            (&[1.0], &[]),
            (&[1.0, 0.5], &[0, 1]),
            (&[1.0, 0.9, 0.2, 0.25, 0.1], &[0, 4]),
            (&[1.0, 0.0, 0.5], &[0, 1, 2]),
            (&[0.5, 0.6, 0.0, 0.05], &[0, 1, 3]),
            (&[0.5, 0.52, 0.0, 0.5, 0.3], &[0, 2, 3, 4]),
            (&[0.5, 0.5], &[0, 1]),
        ] {
            assert_eq!(turning_points(&means_of(thetas)), expected, "{thetas:?}");
        }
    }
}
