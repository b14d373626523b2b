//! The human-readable report of a fit.

use super::numbers::{
    decimals, format_estimate, format_probability, format_probability_cell, format_rounded,
    format_time,
};
use super::remarks::{losses, remarks};
use crate::cli::numbers::{format_count, format_fixed, format_integer};
use crate::cli::page::{Section, Tone};
use crate::cli::report::WrittenFile;
use crate::cli::table::Table;
use crate::fit::Loss;
use crate::fit::report::{
    Comparison, Estimate, Extension, ExtensionKind, LawFit, Limit, Profile, Quality, Report,
    SignalReport, Verdict,
};

/// A profile whose interval differs from the curvature's by more than this is mentioned.
const CURVATURE_LIES: f64 = 0.2;

/// The report of a fit and the files that were written, as sections.
pub(super) fn page(fit: &Report, written: &[WrittenFile], all: bool) -> Vec<Section> {
    let mut sections = vec![headline(fit), parameters(fit, all), signals(&fit.signals)];
    sections.push(remarks(fit));
    if !fit.modes.is_empty() {
        sections.push(modes(fit));
    }
    for profile in &fit.profiles {
        sections.push(profile_section(profile, all));
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

fn headline(fit: &Report) -> Section {
    let name = &fit.scenario;
    let law = &fit.law;
    let is_comparison = fit.comparison.is_some();
    let (tone, title) = match fit.verdict {
        Verdict::Fitted => (Tone::Good, format!("{name} ({law}): describes the data")),
        Verdict::Undecided => (Tone::Weak, format!("{name}: undecided between laws")),
        Verdict::BadFit if is_comparison => (
            Tone::Bad,
            format!("{name}: none of the laws describes the data"),
        ),
        Verdict::BadFit => (
            Tone::Bad,
            format!("{name} ({law}): does not describe the data"),
        ),
        Verdict::NotConverged if is_comparison => (
            Tone::Bad,
            format!("{name}: no minimum was found for the best law"),
        ),
        Verdict::NotConverged => (Tone::Bad, format!("{name} ({law}): no minimum was found")),
    };
    let mut section = Section::with_tone(tone, title);
    // The verdict on several laws has no χ² of its own.
    if is_comparison && fit.verdict != Verdict::Fitted {
        section.line(format!(
            "Parameters, signals and remarks are those of {law}."
        ));
    } else {
        section.note = match fit.loss {
            Loss::Squares => goodness(&fit.quality),
            // The loss has no known distribution.
            Loss::Huber => format!("Huber's loss {:.1}", fit.quality.chi2),
        };
    }
    let samples: usize = fit.signals.iter().map(|signal| signal.samples).sum();
    section.line(format!(
        "{} in {} s; the scenario starts at t = {} s in the data. {}.",
        format_count(samples as u64, "sample"),
        format_time(fit.until),
        format_time(fit.origin),
        format_count(fit.evaluations, "simulation")
    ));
    section
}

/// χ² and its probability in a line.
fn goodness(quality: &Quality) -> String {
    let chi2 = format!(
        "χ²/ν = {:.3} ({:.1}/{})",
        quality.chi2 / quality.freedom as f64,
        quality.chi2,
        quality.freedom
    );
    match quality.p_value {
        Some(p) => format!("{chi2}, {}", format_probability(p)),
        None => chi2,
    }
}

fn parameters(fit: &Report, all: bool) -> Section {
    let mut section = Section::new("Parameters");
    section.table(estimates(&fit.parameters, all));
    if let Some(sentence) = explain_limits(&fit.parameters) {
        section.line(sentence);
    }
    for correlation in &fit.correlations {
        let [a, b] = &correlation.parameters;
        let value = format_fixed(correlation.correlation, 3);
        section.line(format!("{a} and {b} are correlated: {value}."));
    }
    section
}

/// A sentence on the parameters that have a limit and no estimate.
fn explain_limits(parameters: &[Estimate]) -> Option<String> {
    let mut one_sided = Vec::new();
    for Estimate { name, limit, .. } in parameters {
        match limit {
            Some(Limit::Below(_) | Limit::Above(_)) => one_sided.push(name.as_str()),
            Some(Limit::AtBound | Limit::None) | None => {}
        }
    }
    (!one_sided.is_empty()).then(|| {
        format!(
            "{}: a limit and no estimate, because the best value is at a bound or less than two standard deviations above zero.",
            one_sided.join(", ")
        )
    })
}

fn estimates(parameters: &[Estimate], all: bool) -> Table {
    let mut header = ["", "estimate ± sd", "95 % interval", "start value"].map(str::to_owned);
    let mut rows = Vec::new();
    for estimate in parameters {
        let name = match estimate.unit.as_str() {
            "" => estimate.name.clone(),
            unit => format!("{} [{unit}]", estimate.name),
        };
        // The standard deviation of a parameter with a limit only would mislead, so only --all shows its estimate.
        let value = match (estimate.sd, estimate.limit) {
            (Some(sd), None) => format_estimate(estimate.value, sd),
            (Some(_) | None, Some(_)) if all => format_rounded(estimate.value, 6),
            (Some(_) | None, _) => "–".to_owned(),
        };
        let interval = match (estimate.interval, estimate.limit) {
            (_, Some(Limit::Below(limit))) => format!("< {} (95 %)", format_rounded(limit, 3)),
            (_, Some(Limit::Above(limit))) => format!("> {} (95 %)", format_rounded(limit, 3)),
            (_, Some(Limit::AtBound)) => {
                format!("at its bound, {}", format_rounded(estimate.value, 3))
            }
            (_, Some(Limit::None)) => "not determined".to_owned(),
            (Some([low, high]), None) => {
                // With as many decimals as the estimate next to it.
                let sd = estimate.sd.unwrap_or_default();
                let digits = decimals(sd);
                format!(
                    "{} to {}",
                    format_fixed(low, digits),
                    format_fixed(high, digits)
                )
            }
            (None, None) => "–".to_owned(),
        };
        let start = format_rounded(estimate.start, 4);
        rows.push(vec![name, value, interval, start]);
    }
    if parameters.is_empty() {
        header.fill(String::new());
    }
    Table {
        header: header.into(),
        rows,
        left: 1,
    }
}

fn signals(signals: &[SignalReport]) -> Section {
    let has_held_out = signals.iter().any(|signal| signal.held_out_samples > 0);
    let mut header = vec!["", "samples", "σ", "RMS/σ"];
    if has_held_out {
        header.push("held-out RMS/σ");
    }
    header.extend(["uncorrelated", ""]);
    let mut rows = Vec::new();
    for signal in signals {
        let given = if signal.is_sigma_estimated {
            " (estimated)"
        } else {
            ""
        };
        let mut row = vec![
            signal.field.clone(),
            format_integer(signal.samples as u64),
            format!("{} {}{given}", format_rounded(signal.sigma, 3), signal.unit),
            format_rounded(signal.rms, 3),
        ];
        if has_held_out {
            row.push(
                signal
                    .held_out_rms
                    .map_or("–".to_owned(), |rms| format_rounded(rms, 3)),
            );
        }
        row.push(signal.whiteness.map_or("–".to_owned(), format_probability));
        row.push(losses(signal));
        rows.push(row);
    }
    let mut section = Section::new("Signals");
    section.table(Table {
        header: header.into_iter().map(str::to_owned).collect(),
        rows,
        left: 1,
    });
    section
}

fn modes(fit: &Report) -> Section {
    let mut section = Section::with_tone(Tone::Weak, "Other minima");
    "the data don't exclude them".clone_into(&mut section.note);
    let mut header = vec!["Δχ²".to_owned()];
    header.extend(
        fit.parameters
            .iter()
            .map(|parameter| parameter.name.clone()),
    );
    let mut rows = Vec::new();
    for mode in &fit.modes {
        let mut row = vec![format_fixed(mode.delta_chi2, 2)];
        for (value, sd) in mode.values.iter().zip(&mode.sds) {
            row.push(format_estimate(*value, *sd));
        }
        rows.push(row);
    }
    section.table(Table {
        header,
        rows,
        left: 0,
    });
    section
}

fn profile_section(profile: &Profile, all: bool) -> Section {
    let mut section = Section::new(format!("Profile of {}", profile.parameter));
    for (level, [low, high]) in [
        ("68.3 % (Δχ² < 1)", profile.interval_1),
        ("95.4 % (Δχ² < 4)", profile.interval_4),
    ] {
        section.line(format!(
            "{level}: {} to {}",
            format_bound(low),
            format_bound(high)
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
            header: vec![profile.parameter.clone(), "Δχ²".to_owned()],
            rows: rows
                .map(|(value, delta)| vec![format_rounded(*value, 8), format_fixed(*delta, 4)])
                .collect(),
            left: 0,
        });
    }
    section
}

/// Formats an end of an interval, which a profile may not have reached.
fn format_bound(bound: Option<f64>) -> String {
    match bound {
        Some(value) => format_rounded(value, 6),
        None => "not reached".to_owned(),
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
                let sigmas: Vec<String> =
                    law.sigmas.iter().map(|s| format_rounded(*s, 4)).collect();
                sigmas.join(", ")
            } else {
                format_rounded(quality.chi2 / quality.freedom as f64, 5)
            },
            format_probability_cell(quality.p_value),
            format_probability_cell(law.residual_p_value),
            format_fixed(law.delta_aic, 1),
            format_fixed(law.delta_bic, 1),
        ];
        if has_held_out {
            row.push(
                law.held_out_rms
                    .map_or("–".to_owned(), |rms| format_rounded(rms, 3)),
            );
        }
        let verdict = match law.verdict {
            Verdict::Fitted => "describes the data",
            Verdict::BadFit => "does not",
            Verdict::Undecided | Verdict::NotConverged => "no minimum found",
        };
        row.push(verdict.to_owned());
        rows.push(row);
    }
    section.table(Table {
        header: header.into_iter().map(str::to_owned).collect(),
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

fn extension(extension: &Extension) -> String {
    let delta = format_rounded(extension.delta_chi2, 2);
    match extension.kind {
        ExtensionKind::Longer => format!(
            "measure {} s (expected Δχ² = {delta})",
            format_rounded(extension.amount, 3)
        ),
        ExtensionKind::Finer => format!(
            "take {} times as many samples, or repeat the measurement as often (expected Δχ² = {delta})",
            format_rounded(extension.amount, 2)
        ),
        ExtensionKind::Azimuth => format!("measure φ, too (expected Δχ² = {delta})"),
        ExtensionKind::Inclination => format!("measure θ, too (expected Δχ² = {delta})"),
    }
}

fn law_parameters(law: &LawFit) -> Section {
    let mut section = Section::new(format!("Parameters of {}", law.law));
    section.table(estimates(&law.parameters, true));
    section
}
