//! The comparison of laws in words.

use super::super::report::{Comparison, Extension, ExtensionKind, LawFit, Report, Verdict};
use super::cells::or_dash;
use super::parameters::estimates;
use crate::words::{Piece, Section, Sentence, Table, Tone, sentence};

/// The laws, the conclusion, and what would decide between them.
pub(super) fn section(report: &Report, comparison: &Comparison) -> Section {
    let tone = if comparison.is_decided() {
        Tone::Good
    } else {
        Tone::Weak
    };
    let mut section = Section::with_tone(tone, "Laws");
    for law in &comparison.laws {
        if let Some(failure) = &law.failure {
            section.line(sentence!(
                "{} could not be fitted: {}",
                &law.law,
                failure.sentence()
            ));
        }
    }
    section.table(table(report, comparison));
    for law in &comparison.laws {
        if let Some(inner) = &law.reduces_to {
            section.line(sentence!(
                "The best fit of {} reduces to that of {}, which it contains: its own parameters can't be determined.",
                &law.law,
                inner
            ));
        }
    }
    section.line(comparison.conclusion().sentence());
    let extensions: Vec<Sentence> = comparison.extensions.iter().map(extension).collect();
    let describes = comparison.laws.first().map(|law| law.verdict) == Some(Verdict::Fitted);
    if !extensions.is_empty() {
        section.line(sentence!(
            "To decide: {}.",
            Sentence::join(extensions, "; or ")
        ));
    } else if report.verdict == Verdict::Undecided && describes {
        section.line(
            "No small extension of the data is expected to decide: up to 6 times the duration, 100 times the samples, or another angle.",
        );
    }
    section
}

/// The parameters of a law.
pub(super) fn parameters(law: &LawFit) -> Section {
    let mut section = Section::new(sentence!("Parameters of {}", &law.law));
    section.table(estimates(&law.parameters, true));
    section
}

/// The laws that could be fitted.
fn table(report: &Report, comparison: &Comparison) -> Table {
    let columns = LawColumns {
        has_estimated_sigma: report
            .signals
            .iter()
            .any(|signal| signal.is_sigma_estimated),
        has_held_out: comparison.laws.iter().any(|law| law.held_out_rms.is_some()),
    };
    Table {
        header: columns.header(),
        rows: comparison
            .laws
            .iter()
            .filter(|law| law.failure.is_none())
            .map(|law| columns.row(law))
            .collect(),
        left: 1,
    }
}

/// The columns that not all comparisons have.
#[derive(Clone, Copy)]
struct LawColumns {
    has_estimated_sigma: bool,
    has_held_out: bool,
}

impl LawColumns {
    fn header(self) -> Vec<Sentence> {
        // χ²/ν says nothing where each law has its own estimate of σ: σ does.
        let size = if self.has_estimated_sigma {
            "σ"
        } else {
            "χ²/ν"
        };
        let mut header = vec!["", "parameters", size, "p", "uncorrelated", "ΔAIC", "ΔBIC"];
        if self.has_held_out {
            header.push("held out RMS/σ");
        }
        header.push("verdict");
        header.into_iter().map(Sentence::from).collect()
    }

    fn row(self, law: &LawFit) -> Vec<Sentence> {
        let quality = law.quality.as_ref();
        let mut row =
            vec![
                Sentence::from(&law.law),
                law.parameters.len().to_string().into(),
                if self.has_estimated_sigma {
                    let sigmas = law
                        .sigmas
                        .iter()
                        .map(|sigma| Piece::rounded(*sigma, 4, "").into());
                    Sentence::join(sigmas, ", ")
                } else {
                    or_dash(quality.map(|quality| {
                        Piece::rounded(quality.chi2 / quality.freedom as f64, 5, "")
                    }))
                },
                or_dash(
                    quality
                        .and_then(|quality| quality.p_value)
                        .map(Piece::probability),
                ),
                or_dash(law.residual_p_value.map(Piece::probability)),
                or_dash(law.delta_aic.map(|delta| Piece::fixed(delta, 1, ""))),
                or_dash(law.delta_bic.map(|delta| Piece::fixed(delta, 1, ""))),
            ];
        if self.has_held_out {
            row.push(or_dash(
                law.held_out_rms.map(|rms| Piece::rounded(rms, 3, "")),
            ));
        }
        row.push(
            match law.verdict {
                _ if law.reduces_to.is_some() => "reduces to another law",
                Verdict::Fitted => "describes the data",
                Verdict::BadFit => "does not",
                Verdict::Undecided | Verdict::NotConverged => "no minimum found",
            }
            .into(),
        );
        row
    }
}

fn extension(extension: &Extension) -> Sentence {
    let what = match extension.kind {
        ExtensionKind::Longer => sentence!("measure {}", Piece::rounded(extension.amount, 3, "s")),
        ExtensionKind::Finer => sentence!(
            "take {} times as many samples, or repeat the measurement as often",
            Piece::rounded(extension.amount, 2, "")
        ),
        ExtensionKind::Azimuth => sentence!("measure φ, too"),
        ExtensionKind::Inclination => sentence!("measure θ, too"),
    };
    sentence!(
        "{} (expected Δχ² = {})",
        what,
        Piece::rounded(extension.delta_chi2, 2, "")
    )
}
