//! Remarks on the data and the model of a fit.

use super::numbers::{format_rounded, format_time};
use crate::cli::numbers::{format_count, format_integer};
use crate::cli::page::Section;
use crate::fit::Loss;
use crate::fit::report::{Oddity, Report, SignalReport};

/// p-values below this reject a fit.
const REJECTED: f64 = 1e-3;

/// What a signal lacks.
pub(super) fn losses(signal: &SignalReport) -> String {
    let mut losses = Vec::new();
    if signal.missing > 0 {
        losses.push(format!(
            "{} without a value",
            format_integer(signal.missing)
        ));
    }
    if signal.out_of_order > 0 {
        losses.push(format!(
            "{} earlier than the row before",
            format_integer(signal.out_of_order)
        ));
    }
    if signal.outside > 0 {
        losses.push(format!(
            "{} outside the fitted time",
            format_integer(signal.outside as u64)
        ));
    }
    if signal.outliers > 0 {
        losses.push(format!(
            "{} above 5 σ",
            format_integer(signal.outliers as u64)
        ));
    }
    losses.join(", ")
}

/// What the numbers of a fit say about its data and its model.
pub(super) fn remarks(fit: &Report) -> Section {
    let mut remarks = fit.notes.clone();
    for loss in &fit.losses {
        remarks.push(format!("Not read: {loss}."));
    }
    let quality = &fit.quality;
    let reduced = quality.chi2 / quality.freedom as f64;
    if quality.p_value.is_some_and(|p| p < REJECTED) {
        remarks.push(format!(
            "The residuals are larger than σ (χ²/ν = {reduced:.2}): the model is wrong, or σ is. The standard deviations of the parameters are too small."
        ));
    }
    let is_coloured = fit
        .signals
        .iter()
        .filter_map(|signal| signal.whiteness)
        .any(|p| p < REJECTED);
    if is_coloured {
        remarks.push(
            "The residuals are correlated in time: the model misses something, and the standard deviations of the parameters are too small."
                .to_owned(),
        );
    }
    for signal in &fit.signals {
        let SignalReport { field, unit, .. } = signal;
        if signal.mean_p_value.is_some_and(|p| p < REJECTED) {
            remarks.push(format!(
                "The residuals of {field} have the mean {} σ: a constant error, such as a camera that is not level.",
                format_rounded(signal.mean, 2)
            ));
        }
        match signal.oddity {
            Some(Oddity::Constant { value }) => remarks.push(format!(
                "All values of {field} are {} {unit}: they have no noise from which σ could be estimated. Check the sensor, or give σ.",
                format_rounded(value, 6)
            )),
            Some(Oddity::OneValue { time, value }) => remarks.push(format!(
                "One value of {field}, {} {unit} at {} s after the start, makes most of the estimated σ. Remove it, or give σ.",
                format_rounded(value, 6),
                format_time(time)
            )),
            None => {}
        }
    }
    let outliers: usize = fit.signals.iter().map(|signal| signal.outliers).sum();
    if outliers > 0 && fit.loss == Loss::Squares {
        remarks.push(format!(
            "{} above 5 σ: if these are outliers, use --loss huber.",
            format_count(outliers as u64, "residual")
        ));
    }
    Section::from_lines("Remarks", remarks.into_iter())
}
