//! The human-readable report of a fit.

use crate::cli::report::WrittenFile;
use crate::fit::Interface;
use crate::fit::report::{Comparison, Extension, ExtensionKind, LawFit, Profile, Report, Verdict};
use crate::fit::words::{self, Correlations, Words};
use crate::words::number::{decimals_of_error, fixed, probability, rounded};
use crate::words::{Section, Sentence, Table, Tone, counted};

/// A profile whose interval differs from the curvature's by more than this is mentioned.
const CURVATURE_LIES: f64 = 0.2;

/// The report of a fit and the files that were written, as sections.
pub(in crate::cli) fn page(fit: &Report, written: &[WrittenFile], all: bool) -> Vec<Section> {
    let words = fit.words(Interface::Terminal, all);
    let mut sections = vec![
        headline(fit, &words),
        parameters(&words, all),
        signals(&words),
        Section::from_lines("Remarks", words.remarks.iter().cloned()),
    ];
    if !words.modes.rows.is_empty() {
        sections.push(modes(&words));
    }
    for profile in &fit.profiles {
        sections.push(profile_section(profile, !fit.modes.is_empty(), all));
    }
    if let Some(comparison) = &fit.comparison {
        sections.push(laws(fit, comparison));
        if all {
            for law in &comparison.laws {
                sections.push(law_parameters(law));
            }
        }
    }
    let lines = written.iter().map(WrittenFile::line);
    sections.push(Section::from_lines("Written", lines));
    sections.retain(|section| !section.parts.is_empty() || !section.note.is_empty());
    sections
}

/// The verdict and what was fitted.
fn headline(fit: &Report, words: &Words) -> Section {
    let tone = match fit.verdict {
        Verdict::Fitted => Tone::Good,
        Verdict::Undecided => Tone::Weak,
        Verdict::BadFit | Verdict::NotConverged => Tone::Bad,
    };
    let mut section = Section::with_tone(tone, &*words.title);
    section.note = words.note.as_str().into();
    for line in &words.extent {
        section.line(&**line);
    }
    section
}

fn parameters(words: &Words, all: bool) -> Section {
    let mut section = Section::new("Parameters");
    section.table(table(&words.parameters, 1));
    for line in &words.limits {
        section.line(&**line);
    }
    let Correlations { sentence, others } = &words.correlations;
    if !sentence.is_empty() {
        section.line(&**sentence);
    }
    if all {
        for line in others {
            section.line(&**line);
        }
    } else if !others.is_empty() {
        let count = counted(others.len() as u64, "more pair");
        section.line(format!("{count} with --all."));
    }
    section
}

fn signals(words: &Words) -> Section {
    let mut section = Section::new("Signals");
    section.table(table(&words.signals, 1));
    section
}

fn modes(words: &Words) -> Section {
    let mut section = Section::with_tone(Tone::Weak, "Other minima");
    section.note = "of χ²: each describes the data as well within the noise, and the 95 % intervals contain them all".into();
    section.table(table(&words.modes, 0));
    section
}

/// A table whose first `left` columns hold text.
fn table(words: &words::Table, left: usize) -> Table {
    Table {
        header: words.header.iter().map(Into::into).collect(),
        rows: words
            .rows
            .iter()
            .map(|row| row.iter().map(Into::into).collect())
            .collect(),
        left,
    }
}

fn profile_section(profile: &Profile, has_other_minima: bool, all: bool) -> Section {
    let mut section = Section::new(format!("Profile of {}", profile.parameter));
    if has_other_minima {
        section.note = "around the best minimum only".into();
    }
    let half_width = match profile.interval_1 {
        [Some(low), Some(high)] => Some(0.5 * (high - low)),
        [_, None] | [None, _] => None,
    };
    for (level, [low, high]) in [
        ("68.3 % (Δχ² < 1)", profile.interval_1),
        ("95.4 % (Δχ² < 4)", profile.interval_4),
    ] {
        section.line(format!(
            "{level}: {}",
            format_interval(low, high, half_width)
        ));
    }
    if let Some(error) = profile.curvature_error
        && error > CURVATURE_LIES
    {
        section.tone = Tone::Weak;
        section.line(format!(
            "The interval from the standard deviation is wrong by {:.0} %: use this one.",
            100.0 * error
        ));
    }
    if all {
        let rows = profile.values.iter().zip(&profile.delta_chi2);
        section.table(Table {
            header: vec![profile.parameter.as_str().into(), "Δχ²".into()],
            rows: rows
                .map(|(value, delta)| {
                    vec![
                        format_place(*value, half_width).into(),
                        fixed(*delta, 4).into(),
                    ]
                })
                .collect(),
            left: 0,
        });
    }
    section
}

/// Formats an interval, whose ends a profile may not have reached.
fn format_interval(low: Option<f64>, high: Option<f64>, half_width: Option<f64>) -> String {
    match (low, high) {
        (Some(low), Some(high)) => format!(
            "{} to {}",
            format_place(low, half_width),
            format_place(high, half_width)
        ),
        (None, Some(high)) => format!("up to {}; no lower end", format_place(high, half_width)),
        (Some(low), None) => format!("from {} on; no upper end", format_place(low, half_width)),
        (None, None) => "no ends".to_owned(),
    }
}

/// Formats a value of a parameter with the decimals of its estimate, and one more.
fn format_place(value: f64, half_width: Option<f64>) -> String {
    match half_width {
        Some(half_width) => fixed(value, decimals_of_error(half_width) + 1),
        None => rounded(value, 8),
    }
}

fn laws(fit: &Report, comparison: &Comparison) -> Section {
    let mut section = Section::with_tone(
        if comparison.is_decided {
            Tone::Good
        } else {
            Tone::Weak
        },
        "Laws",
    );
    let has_held_out = comparison.laws.iter().any(|law| law.held_out_rms.is_some());
    let has_estimated_sigma = fit.signals.iter().any(|signal| signal.is_sigma_estimated);
    // χ²/ν says nothing where each law has its own estimate of σ: σ does.
    let size = if has_estimated_sigma { "σ" } else { "χ²/ν" };
    let mut header = vec!["", "parameters", size, "p", "uncorrelated", "ΔAIC", "ΔBIC"];
    if has_held_out {
        header.push("held out RMS/σ");
    }
    header.push("verdict");
    let mut rows = Vec::new();
    for law in &comparison.laws {
        if let Some(failure) = &law.failure {
            section.line(format!("{} could not be fitted: {failure}", law.law));
            continue;
        }
        let quality = &law.quality;
        let mut row = vec![
            law.law.clone(),
            law.parameters.len().to_string(),
            if has_estimated_sigma {
                let sigmas: Vec<String> = law.sigmas.iter().map(|s| rounded(*s, 4)).collect();
                sigmas.join(", ")
            } else {
                rounded(quality.chi2 / quality.freedom as f64, 5)
            },
            probability_cell(quality.p_value),
            probability_cell(law.residual_p_value),
            fixed(law.delta_aic, 1),
            fixed(law.delta_bic, 1),
        ];
        if has_held_out {
            row.push(
                law.held_out_rms
                    .map_or("–".to_owned(), |rms| rounded(rms, 3)),
            );
        }
        let verdict = match law.verdict {
            Verdict::Fitted => "describes the data",
            Verdict::BadFit => "does not",
            Verdict::Undecided | Verdict::NotConverged => "no minimum found",
        };
        row.push(verdict.to_owned());
        rows.push(row.into_iter().map(Sentence::from).collect());
    }
    section.table(Table {
        header: header.into_iter().map(Sentence::from).collect(),
        rows,
        left: 1,
    });
    section.line(comparison.sentence.clone());
    if !comparison.extensions.is_empty() {
        let extensions: Vec<String> = comparison.extensions.iter().map(extension).collect();
        section.line(format!("To decide: {}.", extensions.join("; or ")));
    } else if fit.verdict == Verdict::Undecided
        && comparison.laws.first().map(|law| law.verdict) == Some(Verdict::Fitted)
    {
        section.line(
            "No small extension of the data is expected to decide: up to 6 times the duration, 100 times the samples, or another angle.",
        );
    }
    section
}

/// A p-value for a column whose header names it.
fn probability_cell(p: Option<f64>) -> String {
    p.map_or("–".to_owned(), probability)
}

fn extension(extension: &Extension) -> String {
    let delta = rounded(extension.delta_chi2, 2);
    match extension.kind {
        ExtensionKind::Longer => format!(
            "measure {} s (expected Δχ² = {delta})",
            rounded(extension.amount, 3)
        ),
        ExtensionKind::Finer => format!(
            "take {} times as many samples, or repeat the measurement as often (expected Δχ² = {delta})",
            rounded(extension.amount, 2)
        ),
        ExtensionKind::Azimuth => format!("measure φ, too (expected Δχ² = {delta})"),
        ExtensionKind::Inclination => format!("measure θ, too (expected Δχ² = {delta})"),
    }
}

fn law_parameters(law: &LawFit) -> Section {
    let mut section = Section::new(format!("Parameters of {}", law.law));
    section.table(table(&words::estimates(&law.parameters, true), 1));
    section
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profile_axis_shows_width_of_large_values() {
        for (value, half_width, expected) in [
            (4_999.267_231_4, Some(3.9e-4), "4999.267231"),
            (0.035_022_1, Some(5.9e-5), "0.0350221"),
            (172.002, Some(25.0), "172.0"),
            (0.035_022_1, None, "0.0350221"),
        ] {
            assert_eq!(format_place(value, half_width), expected);
        }
    }
}
