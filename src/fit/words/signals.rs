//! Signals in words.

use super::super::report::SignalReport;
use super::cells::{labelled_probability, or_dash};
use crate::words::{Piece, Section, Sentence, Table, grouped, sentence};

/// The signals and their residuals.
pub(super) fn section(signals: &[SignalReport]) -> Section {
    let has_held_out = signals.iter().any(|signal| signal.held_out_samples > 0);
    let mut header = vec!["", "samples", "σ", "RMS/σ"];
    if has_held_out {
        header.push("held-out RMS/σ");
    }
    header.extend(["uncorrelated", ""]);
    let mut section = Section::new("Signals");
    section.table(Table {
        header: header.into_iter().map(Sentence::from).collect(),
        rows: signals
            .iter()
            .map(|signal| row(signal, has_held_out))
            .collect(),
        left: 1,
    });
    section
}

fn row(signal: &SignalReport, has_held_out: bool) -> Vec<Sentence> {
    let sigma = Piece::rounded(signal.sigma, 3, signal.unit.clone());
    let mut row = vec![
        Piece::field(signal.field.clone()).into(),
        grouped(signal.samples as u64).into(),
        if signal.is_sigma_estimated {
            sentence!("{} (estimated)", sigma)
        } else {
            sigma.into()
        },
        Piece::rounded(signal.rms, 3, "").into(),
    ];
    if has_held_out {
        let rms = signal.held_out_rms.map(|rms| Piece::rounded(rms, 3, ""));
        row.push(or_dash(rms));
    }
    row.push(or_dash(signal.whiteness.map(labelled_probability)));
    row.push(losses(signal).into());
    row
}

/// What a signal lacks.
fn losses(signal: &SignalReport) -> String {
    let mut losses = Vec::new();
    for (count, what) in [
        (signal.missing, "without a value"),
        (signal.out_of_order, "earlier than the row before"),
        (signal.outside as u64, "outside the fitted time"),
        (signal.outliers as u64, "above 5 σ"),
    ] {
        if count > 0 {
            losses.push(format!("{} {what}", grouped(count)));
        }
    }
    losses.join(", ")
}
