//! Findings about the motion averaged over nutations.

use super::crossing::MeanCrossing;
use super::finding::{Dependence, Finding};
use super::quantity::Quantity;
use crate::analysis::diff::averages::Deviation;
use crate::analysis::diff::evidence::Evidence;
use crate::analysis::diff::integration_error::combined;
use crate::analysis::diff::topic::derived::{AXIAL_SPIN, AXIS_ANGLE};
use crate::analysis::diff::topic::field::FieldDifference;
use crate::analysis::history::{Cycle, RunHistory};
use crate::physics::math::sin;
use crate::run::time::seconds;
use crate::telemetry::fields::{NumberField, nutation, state};
use crate::telemetry::side::Side;
use std::f64::consts::TAU;

/// The times at which the averaged motions cross a common level.
pub(super) fn crossing(evidence: &Evidence<'_>) -> Option<Finding> {
    let [a, b] = evidence.histories();
    let errors = match evidence.integrations {
        Some(integrations) => Side::BOTH.map(|side| {
            let error = integrations.averages(side).largest(nutation::THETA_MEAN);
            combined([error, 0.0], [0.0; 2])
        }),
        None => [0.0; 2],
    };
    let found = MeanCrossing::find(a, b, errors)?;
    let quantity = Quantity::MeanCrossing {
        level: found.level,
        farthest: found.farthest,
    };
    let [relative, change] = found.lower;
    Some(Finding {
        integration_error: evidence.integrations.map(|_| found.integration_error),
        dependences: vec![
            Dependence::Level { relative, change },
            Dependence::Nutation {
                change: found.ripple,
            },
        ],
        ..Finding::new(quantity, found.times.map(Some))
    })
}

/// Differences of the averaged motions at equal times.
pub(super) fn means(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(averaged) = evidence.averaged else {
        return Vec::new();
    };
    let mut found = Vec::new();
    if let Some(theta) = averaged.field(nutation::THETA_MEAN) {
        let quantity = Quantity::MeanTheta { at: theta.at };
        found.extend(mean(evidence, nutation::THETA_MEAN, theta, quantity));
    }
    for rate in &averaged.turning {
        let at = rate.at;
        let (field, quantity) = if rate.quantity == nutation::PHI_DOT_MEAN.path() {
            (nutation::PHI_DOT_MEAN, Quantity::MeanPrecession { at })
        } else {
            (nutation::PSI_DOT_MEAN, Quantity::MeanSpin { at })
        };
        let [a, b] = evidence.histories().map(|run| change_by_nutation(run, at));
        let change = a.zip(b).map(|(a, b)| a + b);
        found.extend(mean(evidence, field, rate, quantity).map(|mean| {
            Finding {
                dependences: change
                    .into_iter()
                    .map(|change| Dependence::Nutation { change })
                    .collect(),
                ..mean
            }
        }));
    }
    found
}

fn mean(
    evidence: &Evidence<'_>,
    field: NumberField,
    deviation: &Deviation,
    quantity: Quantity,
) -> Option<Finding> {
    let error = evidence.error(deviation.values, |integrations, side| {
        integrations.averages(side).field(field, deviation.at)
    });
    Finding::new(quantity, deviation.values.map(Some)).with_error(error)
}

/// By how much the nutation changes the means of φ̇ and ψ̇ at a time (s), rad/s: by its frequency times (δθ / sin θ)², with its
/// amplitude δθ.
fn change_by_nutation(run: &RunHistory, time: f64) -> Option<f64> {
    let frequency = TAU / run.curve(|cycle| cycle.period).at(time)?;
    let amplitude = run.curve(Cycle::amplitude_of_theta).at(time)?;
    let part = amplitude / sin(run.curve(|cycle| cycle.means[0]).at(time)?);
    Some(frequency * part * part)
}

/// RMS angles between the axes: at equal times, and with the axes turned about the vertical to an equal azimuth.
pub(super) fn distances(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(until) = evidence.paired.common_end().map(seconds) else {
        return Vec::new();
    };
    let of_axes = evidence.state(AXIS_ANGLE).and_then(|angle| {
        let FieldDifference {
            largest, at, rms, ..
        } = angle;
        let quantity = Quantity::AxisDistance { until, largest, at };
        let error = evidence.error_of_field(AXIS_ANGLE, [0.0; 2]);
        Finding::from_difference(quantity, rms).with_error(error)
    });
    let theta = state::THETA.path();
    let of_theta = evidence.state(theta).and_then(|field| {
        let FieldDifference {
            largest, at, rms, ..
        } = field;
        let largest = largest.abs();
        let quantity = Quantity::InclinationDistance { until, largest, at };
        let error = evidence.error_of_field(theta, [field.scale; 2]);
        Finding::from_difference(quantity, rms).with_error(error)
    });
    of_axes.into_iter().chain(of_theta).collect()
}

/// The largest difference of ω·n at equal times.
pub(super) fn axial_spin(evidence: &Evidence<'_>) -> Option<Finding> {
    let spin = evidence.state(AXIAL_SPIN)?;
    let quantity = Quantity::AxialSpin { at: spin.at };
    let error = evidence.error_of_field(AXIAL_SPIN, spin.values?);
    Finding::new(quantity, spin.values?.map(Some)).with_error(error)
}

/// The lead of B's nutation over A's.
pub(super) fn phase_lead(evidence: &Evidence<'_>) -> Option<Finding> {
    let phase = evidence.averaged?.phase.as_ref()?;
    // The lead is the difference of two numbers of cycles.
    let cycles = evidence.histories().map(|run| run.cycles.len() as f64);
    let error = evidence.error(cycles, |integrations, side| {
        integrations.averages(side).phase(phase.at)
    });
    let quantity = Quantity::PhaseLead { at: phase.at };
    Finding::from_difference(quantity, phase.ahead).with_error(error)
}

/// The nutation amplitudes at the end of the common nutations.
pub(super) fn amplitude(evidence: &Evidence<'_>) -> Option<Finding> {
    let averaged = evidence.averaged?;
    let amplitudes = averaged.amplitudes?;
    let error = evidence.error(amplitudes, |integrations, side| {
        integrations.averages(side).amplitude(averaged.to)
    });
    let quantity = Quantity::Amplitude { at: averaged.to };
    Finding::new(quantity, amplitudes.map(Some)).with_error(error)
}
