//! The averaged motions of two runs.
//!
//! `/top/nutation` has means and extremes of each nutation cycle. Each is treated as a curve through the midpoints of
//! the cycles; the curves of A and B are compared at equal times while both nutate. Rates of φ and ψ are left out where
//! the axis passes the vertical. The phase (number of nutations) is
//! a curve through the starts of the cycles.

use crate::analysis::history::curve::CubicCurve;
use crate::analysis::history::{Cycle, RunHistory};
use crate::archive::memory::Owned;
use crate::run::simulation::UPRIGHT;
use crate::run::time::nanoseconds;
use crate::telemetry::fields::{NUTATION, NumberField, nutation};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// The differences B − A of the averaged motions.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Averaged {
    /// The first and the last time of the comparison, s.
    pub from: f64,
    /// The last time of the comparison, s.
    pub to: f64,
    /// Means, least and greatest values of θ and the rates. Those of φ̇ and ψ̇ leave out cycles in which the axis passes
    /// the vertical.
    pub deviations: Vec<Deviation>,
    /// The means of φ̇ and ψ̇ where they tell precession and spin: not where the axis nutates near the vertical.
    pub turning: Vec<Deviation>,
    /// Phase lead of B over A; absent if nutation is interrupted.
    pub phase: Option<Phase>,
    /// The nutation amplitudes of A and B (half the range of θ̇) at the last time, rad/s.
    pub amplitudes: Option<[f64; 2]>,
}

/// Lead of B over A.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Phase {
    /// The last beginning of a nutation that both runs reach, s.
    pub at: f64,
    /// Phase lead of B, nutation cycles.
    pub ahead: f64,
}

/// Difference of one averaged quantity at equal times.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Deviation {
    /// The field of `/top/nutation`.
    pub quantity: String,
    /// The unit.
    pub unit: String,
    /// The difference with the largest magnitude.
    pub largest: f64,
    /// Time of that difference, s.
    pub at: f64,
    /// A's and B's values then.
    pub values: [f64; 2],
}

/// Compares the averaged motions up to a time (s); `None` if they don't nutate at the same time.
pub(super) fn compare(a: &RunHistory, b: &RunHistory, until: f64) -> Option<Averaged> {
    let middles = [a, b].map(|history| history.curve(Cycle::middle).domain());
    let [Some(of_a), Some(of_b)] = middles else {
        return None;
    };
    let (from, to) = (of_a.0.max(of_b.0), of_a.1.min(of_b.1).min(until));
    if from > to {
        return None;
    }
    let mut times: Vec<f64> = [a, b]
        .into_iter()
        .flat_map(RunHistory::successive_cycles)
        .map(Cycle::middle)
        .filter(|time| (from..=to).contains(time))
        .collect();
    times.sort_by(f64::total_cmp);
    let [first, second] = [a, b].map(|history| history.curve(Cycle::amplitude).at(to));
    Some(Averaged {
        from,
        to,
        deviations: NUTATION
            .numbers()
            // The number and the start of a cycle are not averages.
            .filter(|field| ![nutation::CYCLE, nutation::START].contains(field))
            .filter_map(|field| deviation(field, &times, &[a, b].map(|run| curve(run, field))))
            .collect(),
        turning: [nutation::PHI_DOT_MEAN, nutation::PSI_DOT_MEAN]
            .into_iter()
            .filter_map(|field| deviation(field, &times, &[a, b].map(|run| turning(run, field))))
            .collect(),
        phase: phase(a, b),
        amplitudes: first.zip(second).map(|(a, b)| [a, b]),
    })
}

/// A field of `/top/nutation` over time: through the middles of the cycles. It is NaN in cycles in which it has no
/// meaning, and between them and their neighbours.
fn curve(run: &RunHistory, field: NumberField) -> CubicCurve {
    let points = run.successive_cycles().iter().map(|cycle| {
        let is_meaningful = !is_of_azimuth(field) || is_away_from_vertical(cycle);
        let value = if is_meaningful {
            cycle.field(field)
        } else {
            f64::NAN
        };
        (cycle.middle(), value)
    });
    CubicCurve::new(points)
}

/// A mean of φ̇ or ψ̇ over time. It is NaN in cycles that nutate near the vertical.
fn turning(run: &RunHistory, field: NumberField) -> CubicCurve {
    let points = run.successive_cycles().iter().map(|cycle| {
        let is_told = is_away_from_vertical(cycle) && !nutates_near_vertical(cycle);
        let rate = if is_told {
            cycle.field(field)
        } else {
            f64::NAN
        };
        (cycle.middle(), rate)
    });
    CubicCurve::new(points)
}

/// Whether θ is not well above its nutation: near the vertical, a nutation of the amplitude δθ makes φ̇ so uneven that it
/// changes the mean by a part of n (δθ / sin θ)², with n the ratio of the frequencies of nutation and precession.
fn nutates_near_vertical(cycle: &Cycle) -> bool {
    /// Farther from the vertical, even cusps and loops leave the mean alone, rad.
    const NEAR: f64 = 0.2;
    /// With n = 60, as of the paper's top, the mean changes by 2.4 %.
    const AMPLITUDES: f64 = 50.0;
    let angle = cycle.means[0].min(PI - cycle.means[0]);
    angle < NEAR && angle < AMPLITUDES * cycle.amplitude_of_theta()
}

/// Whether a field belongs to the rotation about the vertical or about the axis alone. Where the axis is vertical, only
/// the sum of both rotations is defined.
fn is_of_azimuth(field: NumberField) -> bool {
    [
        nutation::PHI_DOT_MEAN,
        nutation::PHI_DOT_MIN,
        nutation::PHI_DOT_MAX,
        nutation::PSI_DOT_MEAN,
        nutation::PSI_DOT_MIN,
        nutation::PSI_DOT_MAX,
    ]
    .contains(&field)
}

/// Whether the axis passes neither the upper nor the lower vertical in a cycle. In a passage, φ changes by about π to
/// one side or the other, and the mean of φ̇ depends on the side and not on the precession.
fn is_away_from_vertical(cycle: &Cycle) -> bool {
    let least = cycle.field(nutation::THETA_MIN);
    let greatest = cycle.field(nutation::THETA_MAX);
    least >= UPRIGHT && greatest <= PI - UPRIGHT
}

/// Lead of B over A, where both have counted their nutations without interruption.
fn phase(a: &RunHistory, b: &RunHistory) -> Option<Phase> {
    let at = last_start(a)?.min(last_start(b)?);
    // The starts of cycles are exact events; in between the phase is interpolated.
    let ahead = b.phase().at(at)? - a.phase().at(at)?;
    let are_counted = [a, b]
        .into_iter()
        .all(|run| run.unbroken_until().is_some_and(|end| at <= end));
    are_counted.then_some(Phase { at, ahead })
}

/// The start of the last successive cycle, s.
fn last_start(run: &RunHistory) -> Option<f64> {
    Some(run.successive_cycles().last()?.start)
}

/// The largest differences between the averaged motions of several integrations of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct AverageErrors {
    /// The largest difference of each field of `/top/nutation`, by its path.
    fields: BTreeMap<String, f64>,
    /// Of the nutation phase, cycles.
    phase: f64,
    /// The end of the time in which all integrations nutate, s: for the averages, and for the phase; −∞ if there is no
    /// such time. Not set before the first integration is added.
    ends: Option<[f64; 2]>,
}

impl AverageErrors {
    /// Adds another integration, up to a time (s).
    pub(super) fn add(&mut self, own: &RunHistory, other: &RunHistory, until: f64) {
        let averaged = compare(own, other, until);
        for deviation in averaged.iter().flat_map(|averaged| &averaged.deviations) {
            let largest = self.fields.entry(deviation.quantity.clone()).or_insert(0.0);
            *largest = largest.max(deviation.largest.abs());
        }
        self.phase = self.phase.max(phase_distance([own, other], until));
        let ends = [
            averaged.as_ref().map(|averaged| averaged.to),
            averaged.and_then(|averaged| Some(averaged.phase?.at)),
        ];
        let known = self.ends.unwrap_or([f64::INFINITY; 2]);
        // All integrations of a run nutate with nearly the same period. The ends may differ by less than that.
        let slack = own
            .successive_cycles()
            .last()
            .map_or(0.0, |last| 0.5 * last.period);
        self.ends = Some(
            [0, 1].map(|at| ends[at].map_or(f64::NEG_INFINITY, |end| known[at].min(end + slack))),
        );
    }

    /// The error of a field, if all integrations have it at this time (s).
    pub(super) fn field(&self, field: NumberField, time: f64) -> Option<f64> {
        let is_covered = self.ends.is_some_and(|[end, _]| time <= end);
        self.fields
            .get(field.path())
            .copied()
            .filter(|_| is_covered)
    }

    /// The largest error of a field; 0 if it is unknown.
    pub(super) fn largest(&self, field: NumberField) -> f64 {
        self.fields.get(field.path()).copied().unwrap_or_default()
    }

    /// The error of the phase, cycles.
    pub(super) fn phase(&self, time: f64) -> Option<f64> {
        let is_covered = self.ends.is_some_and(|[_, end]| time <= end);
        is_covered.then_some(self.phase)
    }

    /// The error of the amplitude of θ̇ (half its range), rad/s.
    pub(super) fn amplitude(&self, time: f64) -> Option<f64> {
        let greatest = self.field(nutation::THETA_DOT_MAX, time)?;
        let least = self.field(nutation::THETA_DOT_MIN, time)?;
        Some(0.5 * (greatest + least))
    }
}

/// The largest distance of two nutation phases at the beginnings of cycles up to a time (s), cycles.
fn phase_distance(runs: [&RunHistory; 2], until: f64) -> f64 {
    let [a, b] = runs.map(RunHistory::phase);
    runs.into_iter()
        .flat_map(RunHistory::successive_cycles)
        .map(|cycle| cycle.start)
        .filter(|start| *start <= until)
        .filter_map(|start| Some((b.at(start)? - a.at(start)?).abs()))
        .fold(0.0, f64::max)
}

impl Averaged {
    /// The difference of a field of `/top/nutation`.
    pub(super) fn field(&self, field: NumberField) -> Option<&Deviation> {
        self.deviations
            .iter()
            .find(|deviation| deviation.quantity == field.path())
    }
}

fn deviation(field: NumberField, times: &[f64], [a, b]: &[CubicCurve; 2]) -> Option<Deviation> {
    let mut largest: Option<(f64, [f64; 2])> = None;
    for time in times {
        let (Some(of_a), Some(of_b)) = (a.at(*time), b.at(*time)) else {
            continue;
        };
        let is_larger = largest.is_none_or(|(_, [a, b])| (of_b - of_a).abs() > (b - a).abs());
        // NaN marks cycles in which a quantity has no meaning.
        if of_a.is_finite() && of_b.is_finite() && is_larger {
            largest = Some((*time, [of_a, of_b]));
        }
    }
    let (at, values) = largest?;
    Some(Deviation {
        quantity: field.path().to_owned(),
        unit: field.unit().to_owned(),
        largest: values[1] - values[0],
        at,
        values,
    })
}

/// B − A of the fields of `/top/nutation` at equal times: at the middle of each cycle of A, as long as B nutates.
pub(super) fn differences(a: &RunHistory, b: &RunHistory) -> Vec<Owned> {
    let mut curves: Vec<(NumberField, CubicCurve)> = Vec::new();
    for field in NUTATION.numbers() {
        curves.push((field, b.curve(|cycle| cycle.field(field))));
    }
    a.successive_cycles()
        .iter()
        .filter_map(|cycle| difference(cycle, &curves))
        .collect()
}

/// B − A at the middle of a cycle of A; `None` if B does not nutate then.
fn difference(cycle: &Cycle, curves_of_b: &[(NumberField, CubicCurve)]) -> Option<Owned> {
    let time = cycle.middle();
    let mut numbers = Vec::new();
    for (field, of_b) in curves_of_b {
        numbers.push(of_b.at(time)? - cycle.field(*field));
    }
    Some(Owned {
        channel: NUTATION.index(),
        sequence: cycle.field(nutation::CYCLE) as u32,
        time_ns: nanoseconds(time),
        numbers,
        texts: Vec::new(),
    })
}
