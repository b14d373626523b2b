//! What the numbers of a fit say about its data and its model.

use super::super::estimate::REJECTED;
use super::super::note::Note;
use super::super::report::{Quality, Report, SignalReport, Verdict};
use super::minima;
use crate::fit::problem::model::Loss;
use crate::fit::problem::parameter::is_offset;
use crate::words::{Piece, Sentence, grouped, sentence};

/// Probability of a smaller χ² below which σ was too large.
const TOO_SMALL: f64 = REJECTED;

/// The remarks on a report.
pub(super) fn remarks(report: &Report) -> Vec<Sentence> {
    let mut remarks = minima::remarks(report);
    remarks.extend(report.notes.iter().map(Note::sentence));
    for loss in &report.losses {
        remarks.push(sentence!("Not read: {}.", loss));
    }
    for file in &report.files {
        if let Some(clock) = file.unread_clock() {
            remarks.push(sentence!(
                "The times of {} are those of logging, which may be late: its messages have times of their own, {}.",
                &file.file,
                Piece::argument_with("time", clock)
            ));
        }
    }
    // Where there is no minimum, the residuals say nothing about the data.
    if !report.quality.is_converged {
        remarks.push(sentence!(
            "The values are those at which the search ended, and no estimates. To find a minimum, start closer to the motion ({}), or check what the columns measure, and in which units.",
            Piece::argument("set")
        ));
        return remarks;
    }
    remarks.extend(on_size(&report.quality));
    let is_coloured = report
        .signals
        .iter()
        .filter_map(|signal| signal.whiteness)
        .any(|p| p < REJECTED);
    if is_coloured {
        remarks.push(sentence!(
            "The residuals are correlated in time: the model misses something, and the standard deviations of the parameters are too small."
        ));
    }
    for signal in &report.signals {
        remarks.extend(on_signal(signal));
    }
    remarks.extend(on_outliers(report));
    let has_offsets = report
        .parameters
        .iter()
        .any(|estimate| is_offset(&estimate.name));
    if has_offsets && report.verdict == Verdict::BadFit {
        remarks.push(sentence!(
            "Clocks are aligned with the motion that the first file shows by itself: begin with the file that shows most, such as the angles of a camera."
        ));
    } else if report.files.len() > 1 && report.verdict == Verdict::BadFit {
        remarks.push(sentence!(
            "The files share one clock. If they don't, add offset to {}.",
            Piece::argument("free")
        ));
    }
    remarks
}

/// Whether χ² is improbably large or small.
fn on_size(quality: &Quality) -> Option<Sentence> {
    let p = quality.p_value?;
    let reduced = quality.chi2 / quality.freedom as f64;
    if p < REJECTED {
        Some(sentence!(
            "The residuals are larger than σ (χ²/ν = {}): the model is wrong, or σ is. The standard deviations of the parameters are too small.",
            Piece::fixed(reduced, 2, "")
        ))
    } else if p > 1.0 - TOO_SMALL {
        Some(sentence!(
            "The data scatter much less than the given σ (χ²/ν = {}): σ is too large, and so are the standard deviations of the parameters.",
            Piece::rounded(reduced, 2, "")
        ))
    } else {
        None
    }
}

/// How many residuals are outliers, unless they are most of a signal.
fn on_outliers(report: &Report) -> Option<Sentence> {
    let outliers: usize = report.signals.iter().map(|signal| signal.outliers).sum();
    let is_minority = report.signals.iter().any(SignalReport::is_mostly_outliers);
    if outliers == 0 || is_minority {
        return None;
    }
    let count = Piece::count(outliers as u64, "residual");
    Some(match report.loss {
        Loss::Squares => sentence!(
            "{} above 5 σ: if these are outliers, use {}.",
            count,
            Piece::argument_with("loss", "huber")
        ),
        Loss::Huber => sentence!(
            "{} above 5 σ: they are in RMS/σ, but count less in the fit (Huber's loss).",
            count
        ),
    })
}

/// Whether the residuals have a mean other than zero, and are noise about it: where the model misses something else, their
/// mean follows from that.
fn has_constant_error(signal: &SignalReport) -> bool {
    let is_white = signal.whiteness.is_none_or(|p| p >= REJECTED);
    is_white && signal.mean_p_value.is_some_and(|p| p < REJECTED)
}

fn on_signal(signal: &SignalReport) -> Vec<Sentence> {
    let field = Piece::field(signal.field.clone());
    let mut remarks = Vec::new();
    if has_constant_error(signal) {
        remarks.push(sentence!(
            "The residuals of {} have the mean {} σ: a constant error, such as a camera that is not level.",
            field.clone(),
            Piece::rounded(signal.mean, 2, "")
        ));
    }
    if signal.is_mostly_outliers() {
        remarks.push(sentence!(
            "{} of {} values of {} are above 5 σ: the fit describes the others, a minority. σ is too small, or the model is wrong.",
            grouped(signal.outliers as u64),
            grouped(signal.samples as u64),
            field.clone()
        ));
    }
    if let Some(ratio) = signal.excess_scatter() {
        remarks.push(sentence!(
            "The residuals of {} are {} times the scatter between neighbouring values, so the fit does not describe the data. If a few values are wrong, use {}.",
            field,
            Piece::rounded(ratio, 2, ""),
            Piece::argument_with("loss", "huber")
        ));
    }
    remarks
}
