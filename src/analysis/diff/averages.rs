//! Section c of a report: the averaged motions of two runs.
//!
//! `/top/nutation` tells the means of each nutation cycle, and the states of a cycle the least and greatest values.
//! Each of these quantities is a curve through the middles of the cycles; A's and B's curves are compared at the
//! middles of A's cycles. How many nutations a run has done by a time, its phase, is known where cycles begin and end;
//! there B's phase is compared with A's. The amplitude is half the range of θ̇ in a cycle: that of θ is widened by the
//! drift.

use super::moments::Moments;
use crate::analysis::course::curve::Curve;
use crate::analysis::course::{Course, Cycle};
use crate::telemetry::fields::{NumberField, state};
use schemars::JsonSchema;
use serde::Serialize;

/// The quantities that cycles have means and ranges of, in their order.
const QUANTITIES: [NumberField; 4] = [
    state::THETA,
    state::THETA_DOT,
    state::PHI_DOT,
    state::PSI_DOT,
];

/// Two runs no longer nutate together when they are apart by this part of a nutation: from a quarter on, one rises while the
/// other falls.
const DECORRELATED: f64 = 0.25;

/// Section c: the averaged motion, at the middle of each of A's nutation cycles.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Averaged {
    /// Middle of the first cycle, s.
    pub from: f64,
    /// Middle of the last cycle, s.
    pub to: f64,
    /// Number of A's cycles in between.
    pub cycles: u64,
    /// Means over a cycle: θ, θ̇, φ̇, ψ̇.
    pub means: Vec<Deviation>,
    /// Least and greatest values within a cycle; those of the rates need `/top/state`.
    pub envelopes: Vec<Deviation>,
    /// The nutation frequency, Hz.
    pub frequency: Deviation,
    /// How many nutations B is ahead of A.
    pub phase: Deviation,
    /// How many nutations B is ahead at the last nutation of both.
    pub phase_last: f64,
    /// When B is first ahead or behind by a quarter of a nutation, s: from there on, differences at equal
    /// times say nothing about the nutation.
    pub decorrelated: Option<f64>,
    /// Amplitude of B's nutation over that of A's in the first cycle. The amplitude is half the range of θ̇.
    pub amplitude_ratio_first: Option<f64>,
    /// Amplitude of B's nutation over that of A's in the last cycle.
    pub amplitude_ratio_last: Option<f64>,
    /// What doesn't depend on which of the two is called A, but for signs.
    pub either_way: EitherWay,
}

/// Comparisons at the cycles of both runs: those that are told in sentences.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct EitherWay {
    /// Largest magnitudes of the differences of the means θ, θ̇, φ̇ and ψ̇ at the middles of the cycles of A and of B.
    pub means: Vec<f64>,
    /// The end of the last cycle that both have finished, s.
    pub end: f64,
    /// How many nutations B is ahead of A there; none where the nutation of one was broken before, as by impacts or where
    /// rolling begins.
    pub phase: Option<f64>,
    /// Amplitude of B's nutation over that of A's in the middle of the last cycle of the one that nutates for less long.
    pub amplitude_ratio: Option<f64>,
    /// When one is first ahead by a quarter of a nutation, at an end of a cycle of either, before the nutation of one is broken,
    /// s.
    pub out_of_step: Option<f64>,
}

/// How far two curves lie apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Deviation {
    /// The quantity.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The difference of largest magnitude.
    pub largest: f64,
    /// When it was largest, s.
    pub at: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// The larger magnitude of the two: what the difference is to be compared with.
    pub scale: f64,
}

/// Compares the averaged motions at the middles of A's cycles.
pub(super) fn compare(a: &Course, b: &Course) -> Option<Averaged> {
    let middles: Vec<f64> = a.cycles.iter().map(Cycle::middle).collect();
    let (first, last) = b.of_cycles(Cycle::middle).domain()?;
    // Either way round: a cycle of each lies within those of the other.
    let (first_a, last_a) = a.of_cycles(Cycle::middle).domain()?;
    let is_mutual = b
        .cycles
        .iter()
        .map(Cycle::middle)
        .any(|t| first_a <= t && t <= last_a);
    if !is_mutual {
        return None;
    }
    let common: Vec<f64> = middles
        .into_iter()
        .filter(|t| first <= *t && *t <= last)
        .collect();
    let at_middles = |name: &str, unit: &str, quantity: &dyn Fn(&Cycle) -> f64| {
        let curves = [a, b].map(|course| course.of_cycles(quantity));
        deviation(name, unit, &common, &curves)
    };
    let mut means = Vec::new();
    let mut envelopes = Vec::new();
    for (at, quantity) in QUANTITIES.into_iter().enumerate() {
        let (name, unit) = (quantity.path(), quantity.unit());
        means.extend(at_middles(&format!("{name}_mean"), unit, &|c| c.means[at]));
        for (end, ending) in ["min", "max"].iter().enumerate() {
            let name = format!("{name}_{ending}");
            envelopes.extend(at_middles(&name, unit, &|c| c.ranges[at][end]));
        }
    }
    let phases = [a, b].map(Course::phase);
    let boundaries: Vec<f64> = boundaries(a)
        .filter(|t| phases[1].at(*t).is_some())
        .collect();
    let amplitudes = [a, b].map(|course| course.of_cycles(Cycle::amplitude));
    let ratio = |time: Option<&f64>| {
        let [a, b] = &amplitudes;
        let time = *time?;
        Some(b.at(time)? / a.at(time)?).filter(|ratio| ratio.is_finite())
    };
    Some(Averaged {
        from: *common.first()?,
        to: *common.last()?,
        cycles: common.len() as u64,
        means,
        envelopes,
        frequency: at_middles("nutation_frequency", "Hz", &|c| 1.0 / c.period)?,
        phase: deviation("nutations", "", &boundaries, &phases)?,
        phase_last: ahead(&phases, *boundaries.last()?)?,
        decorrelated: boundaries
            .iter()
            .copied()
            .find(|time| ahead(&phases, *time).is_some_and(|ahead| ahead.abs() >= DECORRELATED)),
        amplitude_ratio_first: ratio(common.first()),
        amplitude_ratio_last: ratio(common.last()),
        either_way: either_way([a, b])?,
    })
}

fn either_way(courses: [&Course; 2]) -> Option<EitherWay> {
    let at_cycles = |times: &dyn Fn(&Course) -> Vec<f64>| -> Vec<f64> {
        let mut all = courses.map(times).concat();
        all.sort_by(f64::total_cmp);
        all
    };
    let middles = at_cycles(&|course| course.cycles.iter().map(Cycle::middle).collect());
    let boundaries = at_cycles(&|course| boundaries(course).collect());
    let phases = courses.map(Course::phase);
    let amplitudes = courses.map(|course| course.of_cycles(Cycle::amplitude));
    let last = |curves: &[Curve; 2]| -> Option<f64> {
        let [a, b] = curves.each_ref().map(|curve| curve.domain());
        Some(a?.1.min(b?.1))
    };
    let mean = |at: usize| {
        let curves = courses.map(|course| course.of_cycles(|cycle| cycle.means[at]));
        let found = deviation("", "", &middles, &curves)?;
        Some(found.largest.abs())
    };
    let end = last(&phases)?;
    let unbroken = courses.map(Course::unbroken_until);
    let known_until = unbroken[0]?.min(unbroken[1]?);
    Some(EitherWay {
        means: (0..QUANTITIES.len()).map(mean).collect::<Option<_>>()?,
        end,
        phase: ahead(&phases, end).filter(|_| end <= known_until),
        amplitude_ratio: last(&amplitudes).and_then(|time| {
            let [a, b] = &amplitudes;
            Some(b.at(time)? / a.at(time)?).filter(|ratio| ratio.is_finite())
        }),
        out_of_step: boundaries
            .into_iter()
            .take_while(|time| *time <= known_until)
            .find(|time| ahead(&phases, *time).is_some_and(|ahead| ahead.abs() >= DECORRELATED)),
    })
}

/// The times at which A's cycles begin and end.
fn boundaries(a: &Course) -> impl Iterator<Item = f64> + '_ {
    let end = a.cycles.last().map(|last| last.start + last.period);
    a.cycles.iter().map(|cycle| cycle.start).chain(end)
}

/// How many nutations B is ahead of A.
fn ahead([a, b]: &[Curve; 2], time: f64) -> Option<f64> {
    Some(b.at(time)? - a.at(time)?)
}

/// How far B's curve is from A's at these times, as far as both are known.
fn deviation(name: &str, unit: &str, times: &[f64], [a, b]: &[Curve; 2]) -> Option<Deviation> {
    let mut found = Deviation {
        quantity: name.to_owned(),
        unit: unit.to_owned(),
        ..Deviation::default()
    };
    let (mut count, mut differences) = (0, Moments::default());
    for time in times {
        let (Some(a), Some(b)) = (a.at(*time), b.at(*time)) else {
            continue;
        };
        let difference = b - a;
        if difference.abs() > found.largest.abs() {
            (found.largest, found.at) = (difference, *time);
        }
        found.scale = found.scale.max(a.abs()).max(b.abs());
        differences.add(difference);
        count += 1;
    }
    found.rms = differences.rms(count);
    (count > 0).then_some(found)
}
