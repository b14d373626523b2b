//! Findings about the motion averaged over nutations.

use super::crossing::MeanCrossing;
use super::finding::{Dependence, Finding};
use super::quantity::Quantity;
use crate::analysis::diff::averages::AverageErrors;
use crate::analysis::diff::evidence::Evidence;
use crate::analysis::diff::integration_error::{IntegrationError, combined};
use crate::telemetry::fields::{NumberField, nutation};

/// The times at which the averaged motions cross a common level.
pub(super) fn crossing(evidence: &Evidence<'_>) -> Option<Finding> {
    let [a, b] = evidence.histories();
    let errors = match evidence.integrations {
        Some(integrations) => integrations
            .average_errors()
            .map(|errors| combined([errors.largest(nutation::THETA_MEAN), 0.0], [0.0; 2])),
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
    let mut found = Vec::new();
    found.extend(mean(evidence, nutation::THETA_MEAN, |at| {
        Quantity::MeanTheta { at }
    }));
    found.extend(mean(evidence, nutation::PHI_DOT_MEAN, |at| {
        Quantity::MeanPrecession { at }
    }));
    found.extend(mean(evidence, nutation::PSI_DOT_MEAN, |at| {
        Quantity::MeanSpin { at }
    }));
    found
}

fn mean(
    evidence: &Evidence<'_>,
    field: NumberField,
    quantity: impl Fn(f64) -> Quantity,
) -> Option<Finding> {
    let deviation = evidence.averaged?.field(field)?;
    let error = error_of_averages(evidence, deviation.values, |errors| {
        errors.field(field, deviation.at)
    });
    Finding::new(quantity(deviation.at), deviation.values.map(Some)).with_error(error)
}

/// The lead of B's nutation over A's.
pub(super) fn phase_lead(evidence: &Evidence<'_>) -> Option<Finding> {
    let phase = evidence.averaged?.phase.as_ref()?;
    // The lead is the difference of two numbers of cycles.
    let cycles = evidence.histories().map(|run| run.cycles.len() as f64);
    let error = error_of_averages(evidence, cycles, |errors| errors.phase(phase.at));
    let quantity = Quantity::PhaseLead { at: phase.at };
    Finding::from_difference(quantity, phase.ahead).with_error(error)
}

/// The nutation amplitudes at the end of the common nutations.
pub(super) fn amplitude(evidence: &Evidence<'_>) -> Option<Finding> {
    let averaged = evidence.averaged?;
    let amplitudes = averaged.amplitudes?;
    let error = error_of_averages(evidence, amplitudes, |errors| errors.amplitude(averaged.to));
    let quantity = Quantity::Amplitude { at: averaged.to };
    Finding::new(quantity, amplitudes.map(Some)).with_error(error)
}

/// The error of the difference of two averages, from those of A and B.
fn error_of_averages(
    evidence: &Evidence<'_>,
    values: [f64; 2],
    error: impl Fn(&AverageErrors) -> Option<f64>,
) -> IntegrationError {
    let Some(integrations) = evidence.integrations else {
        return IntegrationError::Unknown;
    };
    match integrations.average_errors().map(error) {
        [Some(a), Some(b)] => IntegrationError::Within(combined([a, b], values)),
        [None, _] | [_, None] => IntegrationError::Undetermined,
    }
}
