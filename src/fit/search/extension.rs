//! Which further data would tell two laws apart.

use super::fitted::Fitted;
use super::monitor::Monitor;
use super::solve::{complete, minimise};
use crate::fit::error::FitError;
use crate::fit::problem::model::{Point, Problem};
use crate::fit::report::{Extension, ExtensionKind};
use crate::measured::Signal;
use crate::telemetry::fields::{NumberField, state};

/// Expected Δχ² that decides: the right law then wins in 99 % of cases.
const WANTED: f64 = 20.0;

/// More samples than this times those of the data are no small extension.
const MAX_FINER: f64 = 100.0;

/// Relative change of χ² that counts as none: expectations need no more.
const PRECISION: f64 = 1e-3;

/// Trial durations, relative to that of the data.
const LONGER: [f64; 6] = [1.25, 1.5, 2.0, 3.0, 4.0, 6.0];

/// The smallest extensions for which the expected Δχ² reaches [`WANTED`], if `best` is the right law.
pub(in crate::fit) fn extensions(
    best: &Fitted,
    rival: &Fitted,
    monitor: &Monitor<'_>,
) -> Result<Vec<Extension>, FitError> {
    let mut found = Vec::new();
    let rival = &coarse(rival);
    let split = &best.split;
    let points = &split.fitted;
    for factor in LONGER {
        let longer = extended_points(points, factor);
        let Some(delta_chi2) = expected(best, rival, &longer, monitor)? else {
            break;
        };
        // The shortest one that suffices is of interest only.
        if delta_chi2 >= WANTED {
            found.push(Extension {
                kind: ExtensionKind::Longer,
                amount: factor * split.end,
                delta_chi2,
            });
            break;
        }
    }
    // Δχ² is proportional to the number of samples in the same time.
    if let Some(now) = expected(best, rival, points, monitor)?
        && now > 0.0
    {
        let amount = (WANTED / now).max(1.0);
        if (1.0..=MAX_FINER).contains(&amount) {
            found.push(Extension {
                kind: ExtensionKind::Finer,
                amount,
                delta_chi2: amount * now,
            });
        }
    }
    for (kind, field) in [
        (ExtensionKind::Azimuth, state::PHI),
        (ExtensionKind::Inclination, state::THETA),
    ] {
        if let Some([best, rival]) = with_signal([best, rival], field) {
            let more = with_points(points, &best.problem);
            if let Some(delta_chi2) = expected(&best, &rival, &more, monitor)?
                && delta_chi2 >= WANTED
            {
                found.push(Extension {
                    kind,
                    amount: 1.0,
                    delta_chi2,
                });
            }
        }
    }
    Ok(found)
}

/// A fit whose minima need no more digits than an expectation.
fn coarse(fitted: &Fitted) -> Fitted {
    let mut coarse = fitted.clone();
    coarse.problem.precision = PRECISION;
    coarse
}

/// Points with the same spacing over a longer time.
fn extended_points(points: &[Point], factor: f64) -> Vec<Point> {
    let mut longer = points.to_vec();
    let mut signals: Vec<usize> = points.iter().map(|point| point.signal).collect();
    signals.sort_unstable();
    signals.dedup();
    for signal in signals {
        let own: Vec<Point> = points
            .iter()
            .filter(|p| p.signal == signal)
            .copied()
            .collect();
        let (Some(first), Some(last)) = (own.first(), own.last()) else {
            continue;
        };
        let span = last.time - first.time;
        let period = span / (own.len() - 1).max(1) as f64;
        let more = ((factor - 1.0) * span / period) as usize;
        for index in 1..=more {
            longer.push(Point {
                time: last.time + index as f64 * period,
                ..*last
            });
        }
    }
    longer
}

/// Both fits with a further signal, as precise as the angles measured so far; `None` if it is measured already, or no
/// angle is.
fn with_signal(candidates: [&Fitted; 2], field: NumberField) -> Option<[Fitted; 2]> {
    let signals = &candidates[0].problem.signals;
    if signals.iter().any(|signal| signal.field == field) {
        return None;
    }
    let angle = signals.iter().find(|signal| signal.field.unit() == "rad")?;
    let added = Signal {
        field,
        ..angle.clone()
    };
    Some(candidates.map(|candidate| {
        let mut problem = candidate.problem.clone();
        problem.signals.push(added.clone());
        Fitted {
            problem,
            ..(*candidate).clone()
        }
    }))
}

/// The points, and those of the last signal at the times of another angle.
fn with_points(points: &[Point], problem: &Problem) -> Vec<Point> {
    let added = problem.signals.len() - 1;
    let signals = &problem.signals;
    // The same angle whose precision the added signal has.
    let angle = signals
        .iter()
        .position(|signal| signal.field.unit() == "rad");
    let mut more = points.to_vec();
    // Their measured values don't matter: an expectation takes those of the best law.
    for point in points {
        if Some(point.signal) == angle {
            more.push(Point {
                signal: added,
                ..*point
            });
        }
    }
    more
}

/// The expected Δχ²: that of the rival, fitted to the motion of the best law without noise. `None` if a motion ends
/// before.
fn expected(
    best: &Fitted,
    rival: &Fitted,
    points: &[Point],
    monitor: &Monitor<'_>,
) -> Result<Option<f64>, FitError> {
    let Ok(motion) = best.problem.predict(&best.solution.values, points) else {
        return Ok(None);
    };
    let mut exact = points.to_vec();
    for (point, value) in exact.iter_mut().zip(motion) {
        point.value = value;
    }
    let problem = &rival.problem;
    let Ok(start) = complete(problem, &exact, rival.solution.values.clone()) else {
        return Ok(None);
    };
    let fixed = vec![false; start.len()];
    let found = minimise(problem, &exact, &start, None, &fixed, monitor)?;
    Ok(found.is_converged.then_some(found.chi2))
}
