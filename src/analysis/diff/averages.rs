//! The averaged motions of two runs: means, envelopes, frequency, phase and amplitude of the nutation.

use super::report::{Averaged, Deviation};
use crate::analysis::course::curve::Curve;
use crate::analysis::course::{Course, Cycle};

/// The quantities of cycles: names, units.
const QUANTITIES: [(&str, &str); 4] = [
    ("theta", "rad"),
    ("theta_dot", "rad/s"),
    ("phi_dot", "rad/s"),
    ("psi_dot", "rad/s"),
];

/// Apart by so many nutations, two runs no longer nutate together.
const DECORRELATED: f64 = 0.25;

/// Compares the averaged motions at the middles of A's cycles.
pub(super) fn compare(a: &Course, b: &Course) -> Option<Averaged> {
    let middles: Vec<f64> = a.cycles.iter().map(Cycle::middle).collect();
    let (first, last) = b.of_cycles(Cycle::middle).domain()?;
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
    for (at, (name, unit)) in QUANTITIES.iter().enumerate() {
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

fn deviation(name: &str, unit: &str, times: &[f64], [a, b]: &[Curve; 2]) -> Option<Deviation> {
    let mut found = Deviation {
        quantity: name.to_owned(),
        unit: unit.to_owned(),
        ..Deviation::default()
    };
    let (mut count, mut squares) = (0_u64, 0.0);
    for time in times {
        let (Some(a), Some(b)) = (a.at(*time), b.at(*time)) else {
            continue;
        };
        let difference = b - a;
        if difference.abs() > found.largest.abs() {
            (found.largest, found.at) = (difference, *time);
        }
        found.scale = found.scale.max(a.abs()).max(b.abs());
        squares += difference * difference;
        count += 1;
    }
    found.rms = (squares / count.max(1) as f64).sqrt();
    (count > 0).then_some(found)
}
