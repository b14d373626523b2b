//! The averaged motions of two runs.
//!
//! `/top/nutation` has means and extremes of each nutation cycle. Each is treated as a curve through the midpoints of
//! the cycles; the curves of A and B are compared at equal times while both nutate. The phase (number of nutations) is
//! a curve through the starts of the cycles.

use crate::analysis::history::curve::Curve;
use crate::analysis::history::{Cycle, RunHistory};
use crate::archive::memory::Owned;
use crate::run::time::nanoseconds;
use crate::telemetry::fields::{NUTATION, NumberField, nutation};
use schemars::JsonSchema;
use serde::Serialize;

/// The differences B − A of the averaged motions.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Averaged {
    /// The first and the last time of the comparison, s.
    pub from: f64,
    /// The last time of the comparison, s.
    pub to: f64,
    /// Means, least and greatest values of θ and the rates.
    pub deviations: Vec<Deviation>,
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
    /// Its unit.
    pub unit: String,
    /// The difference with the largest magnitude.
    pub largest: f64,
    /// Time of that difference, s.
    pub at: f64,
    /// A's and B's values then.
    pub values: [f64; 2],
}

/// Compares the averaged motions; `None` if they don't nutate at the same time.
pub(super) fn compare(a: &RunHistory, b: &RunHistory) -> Option<Averaged> {
    let middles = [a, b].map(|history| history.of_cycles(Cycle::middle).domain());
    let [Some(of_a), Some(of_b)] = middles else {
        return None;
    };
    let (from, to) = (of_a.0.max(of_b.0), of_a.1.min(of_b.1));
    let all = [a, b].into_iter().flat_map(RunHistory::successive_cycles);
    let all = all.map(Cycle::middle);
    let mut times: Vec<f64> = all.filter(|time| (from..=to).contains(time)).collect();
    times.sort_by(f64::total_cmp);
    let deviation = |field: NumberField| {
        let curves = [a, b].map(|history| history.of_cycles(|cycle| cycle.of_field(field)));
        deviation(field, &times, &curves)
    };
    let is_quantity = |field: &NumberField| ![nutation::CYCLE, nutation::START].contains(field);
    let fields = NUTATION.numbers().filter(is_quantity);
    let amplitudes = [a, b].map(|history| history.of_cycles(Cycle::amplitude));
    let [first, second] = amplitudes.each_ref().map(|curve| curve.at(to));
    Some(Averaged {
        from,
        to,
        deviations: fields.filter_map(deviation).collect(),
        phase: phase(a, b),
        amplitudes: first.zip(second).map(|(a, b)| [a, b]),
    })
    .filter(|_| from <= to)
}

/// Lead of B over A, where both have counted their nutations without interruption.
fn phase(a: &RunHistory, b: &RunHistory) -> Option<Phase> {
    let last = |run: &RunHistory| Some(run.successive_cycles().last()?.start);
    let at = last(a)?.min(last(b)?);
    let is_counted = |run: &RunHistory| run.unbroken_until().is_some_and(|end| at <= end);
    let ahead = b.phase().at(at)? - a.phase().at(at)?;
    (is_counted(a) && is_counted(b)).then_some(Phase { at, ahead })
}

impl Averaged {
    /// The difference of a field of `/top/nutation`.
    pub(super) fn of(&self, field: NumberField) -> Option<&Deviation> {
        let mut all = self.deviations.iter();
        all.find(|deviation| deviation.quantity == field.path())
    }
}

fn deviation(field: NumberField, times: &[f64], [a, b]: &[Curve; 2]) -> Option<Deviation> {
    let values = times
        .iter()
        .filter_map(|time| Some((*time, [a.at(*time)?, b.at(*time)?])));
    let size = |[a, b]: [f64; 2]| (b - a).abs();
    let largest = values.reduce(|x, y| if size(y.1) > size(x.1) { y } else { x });
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
    let fields: Vec<NumberField> = NUTATION.numbers().collect();
    let curve = |field: &NumberField| b.of_cycles(|cycle| cycle.of_field(*field));
    let curves: Vec<Curve> = fields.iter().map(curve).collect();
    let cycles = a.successive_cycles().iter().filter_map(|cycle| {
        let time = cycle.middle();
        let numbers = fields.iter().zip(&curves);
        let numbers = numbers.map(|(field, of_b)| Some(of_b.at(time)? - cycle.of_field(*field)));
        Some(Owned {
            channel: NUTATION.index(),
            sequence: cycle.of_field(nutation::CYCLE) as u32,
            time_ns: nanoseconds(time),
            numbers: numbers.collect::<Option<_>>()?,
            texts: Vec::new(),
        })
    });
    cycles.collect()
}
