//! Sentences about the averaged motions and the nutation.

use super::averages::Averaged;
use super::tale::Tale;
use super::tolerance::full_name;
use crate::analysis::phrase::{self, list, moment, quantity, significant, symbol};
use crate::telemetry::fields::{NumberField, nutation, state};

/// The averages that are told, in the order of the means.
const AVERAGED: [(usize, NumberField); 3] = [
    (0, nutation::THETA_MEAN),
    (2, nutation::PHI_DOT_MEAN),
    (3, nutation::PSI_DOT_MEAN),
];
/// A part of a nutation by which one may be ahead without its being told: a millionth of a turn is no more than the
/// rounding of the times at which cycles end, 1e-9 of some ten nutations.
const UNTOLD_PHASE: f64 = 1e-6;

/// How far the averaged motions are apart, or without averages the motions themselves.
pub(super) fn averaged(tale: Tale<'_>) -> Option<String> {
    let Some(averaged) = &tale.report.averaged else {
        return pointwise(tale);
    };
    let floor = tale.report.floor.as_ref();
    let error = |field: NumberField| floor.and_then(|floor| floor.of(&field.to_string()));
    let is_clear = |(at, field): &(usize, NumberField)| {
        averaged.either_way.means[*at] > error(*field).unwrap_or(0.0)
    };
    let clear: Vec<_> = AVERAGED.into_iter().filter(is_clear).collect();
    let told = |(at, field): &(usize, NumberField)| {
        let size = quantity(averaged.either_way.means[*at], 2, field.unit());
        format!("{size} in {}", symbol(field.path()))
    };
    let told: Vec<String> = clear.iter().map(told).collect();
    Some(if told.is_empty() {
        "The averaged motions are the same.".to_owned()
    } else {
        format!(
            "At equal times the averages differ by up to {}.",
            list(&told)
        )
    })
}

/// How far the motions are apart where they are compared.
fn pointwise(tale: Tale<'_>) -> Option<String> {
    let told = [state::THETA, state::PHI_DOT, state::PSI_DOT].map(|number| {
        let name = number.to_string();
        let mut fields = tale.report.signals.fields();
        let (_, field) = fields.find(|(topic, field)| full_name(topic, &field.field) == name)?;
        let is_clear = field.largest != 0.0 && !field.is_below_floor;
        let size = quantity(field.largest.abs(), 2, &field.unit);
        is_clear.then(|| format!("{size} in {}", symbol(&field.field)))
    });
    let told: Vec<String> = told.into_iter().flatten().collect();
    (!told.is_empty()).then(|| {
        format!(
            "Point by point, the motions differ by up to {}.",
            list(&told)
        )
    })
}

/// Amplitude and phase of the nutation.
pub(super) fn nutation(tale: Tale<'_>) -> Option<String> {
    let averaged = tale.report.averaged.as_ref()?;
    let found = &averaged.either_way;
    let time = moment(found.end);
    let mut told = Vec::new();
    told.extend(strength(averaged));
    let out_of_step = found
        .out_of_step
        .map(|time| format!("out of step from {} on", moment(time)));
    if let Some(ahead) = found.phase.filter(|ahead| ahead.abs() > UNTOLD_PHASE) {
        let order = if ahead > 0.0 { "ahead" } else { "behind" };
        let phase = significant(ahead.abs(), 2);
        let out_of_step = out_of_step.map_or(String::new(), |told| format!(", {told}"));
        told.push(format!("{phase} cycles {order}{out_of_step}"));
    } else {
        told.extend(out_of_step);
    }
    let b = tale.b;
    (!told.is_empty()).then(|| format!("At {time} {b}'s nutation is {}.", list(&told)))
}

/// How many times stronger or weaker B's nutation is, to two digits, if that isn't once.
fn strength(averaged: &Averaged) -> Option<String> {
    let ratio = averaged
        .either_way
        .amplitude_ratio
        .filter(|ratio| *ratio > 0.0)?;
    let (times, order) = if ratio < 1.0 {
        (1.0 / ratio, "weaker")
    } else {
        (ratio, "stronger")
    };
    let times = phrase::times(times);
    (times != phrase::times(1.0)).then(|| format!("{times} times {order}"))
}
