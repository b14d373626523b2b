//! The human-readable report of a fit.

use super::FitReport;
use crate::cli::numbers::{format_count, format_fixed, format_integer};
use crate::cli::page::{Section, Tone};
use crate::cli::report::WrittenFile;
use crate::cli::table::Table;
use crate::fit::Loss;
use crate::fit::report::{
    Comparison, Estimate, Extension, ExtensionKind, LawFit, Limit, Mode, Oddity, Profile, Quality,
    Report, SignalReport, Verdict,
};

/// A profile whose interval differs from the curvature's by more than this is mentioned.
const CURVATURE_LIES: f64 = 0.2;

/// p-values below this reject a fit.
const REJECTED: f64 = 1e-3;

/// p-values below this are printed as a bound.
const SMALLEST_P: f64 = 1e-6;

/// The report as sections.
pub(super) fn page(report: &FitReport, all: bool) -> Vec<Section> {
    let fit = &report.fit;
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
    let written = report.written.iter().map(WrittenFile::line);
    sections.push(Section::from_lines("Written", written));
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
        plain(fit.until),
        plain(fit.origin),
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
        Some(p) => format!("{chi2}, {}", probability(p)),
        None => chi2,
    }
}

fn probability(p: f64) -> String {
    if p < SMALLEST_P {
        "p < 1e-6".to_owned()
    } else if p < 0.01 {
        format!("p = {p:.1e}")
    } else {
        format!("p = {p:.2}")
    }
}

/// A number without trailing zeros.
fn plain(value: f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    short.replace('-', "−")
}

fn parameters(fit: &Report, all: bool) -> Section {
    let mut section = Section::new("Parameters");
    section.table(estimates(&fit.parameters, all));
    for correlation in &fit.correlations {
        let [a, b] = &correlation.parameters;
        let value = format_fixed(correlation.correlation, 3);
        section.line(format!("{a} and {b} are correlated: {value}."));
    }
    section
}

fn estimates(parameters: &[Estimate], all: bool) -> Table {
    let mut header = ["", "estimate ± sd", "95 % interval", "start"].map(str::to_owned);
    let mut rows = Vec::new();
    for estimate in parameters {
        let name = match estimate.unit.as_str() {
            "" => estimate.name.clone(),
            unit => format!("{} [{unit}]", estimate.name),
        };
        let value = match (estimate.sd, estimate.limit) {
            (Some(sd), None) => with_error(estimate.value, sd),
            (Some(_) | None, _) => "–".to_owned(),
        };
        let interval = match (estimate.interval, estimate.limit) {
            (_, Some(Limit::Below(limit))) => format!("< {}", rounded(limit, 3)),
            (_, Some(Limit::Above(limit))) => format!("> {}", rounded(limit, 3)),
            (_, Some(Limit::AtBound)) => format!("at its bound, {}", rounded(estimate.value, 3)),
            (_, Some(Limit::None)) => "not determined".to_owned(),
            (Some([low, high]), None) => {
                let sd = estimate.sd.unwrap_or_default();
                let digits = decimals(sd);
                format!("{} to {}", fixed(low, digits), fixed(high, digits))
            }
            (None, None) => "–".to_owned(),
        };
        let start = rounded(estimate.start, 4);
        let value = if all && estimate.limit.is_some() {
            rounded(estimate.value, 6)
        } else {
            value
        };
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

/// Decimals that show two digits of a standard deviation.
fn decimals(sd: f64) -> usize {
    // The exponent of the rounded number: 0.0996 with two digits is 0.10.
    let scientific = format!("{sd:.1e}");
    let exponent = scientific.rsplit_once('e').map_or("0", |(_, e)| e);
    let exponent: i32 = exponent.parse().unwrap_or_default();
    usize::try_from(1 - exponent).unwrap_or_default().min(17)
}

fn fixed(value: f64, digits: usize) -> String {
    format_fixed(value, digits)
}

/// An estimate and its standard deviation with the digits that are known.
fn with_error(value: f64, sd: f64) -> String {
    let digits = decimals(sd);
    format!("{} ± {}", fixed(value, digits), fixed(sd, digits))
}

/// A number with significant digits.
fn rounded(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let rounded: f64 = scientific.parse().unwrap_or(value);
    let text = if (1e-4..1e6).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        scientific
    };
    text.replacen('-', "−", usize::from(value < 0.0))
}

fn signals(signals: &[SignalReport]) -> Section {
    let has_held_out = signals.iter().any(|signal| signal.held_out_samples > 0);
    let mut header = vec!["", "samples", "σ", "RMS/σ"];
    if has_held_out {
        header.push("held out");
    }
    header.extend(["white", ""]);
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
            format!("{} {}{given}", rounded(signal.sigma, 3), signal.unit),
            rounded(signal.rms, 3),
        ];
        if has_held_out {
            row.push(
                signal
                    .held_out_rms
                    .map_or("–".to_owned(), |rms| rounded(rms, 3)),
            );
        }
        row.push(signal.whiteness.map_or("–".to_owned(), probability));
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

/// What a signal lacks.
fn losses(signal: &SignalReport) -> String {
    let mut losses = Vec::new();
    if signal.missing > 0 {
        losses.push(format!("{} missing", format_integer(signal.missing)));
    }
    if signal.out_of_order > 0 {
        losses.push(format!(
            "{} out of order",
            format_integer(signal.out_of_order)
        ));
    }
    if signal.outside > 0 {
        losses.push(format!("{} outside", format_integer(signal.outside as u64)));
    }
    if signal.outliers > 0 {
        losses.push(format!(
            "{} above 5 σ",
            format_integer(signal.outliers as u64)
        ));
    }
    losses.join(", ")
}

fn remarks(fit: &Report) -> Section {
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
    let mut tests = fit.signals.iter().filter_map(|signal| signal.whiteness);
    if tests.any(|p| p < REJECTED) {
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
                rounded(signal.mean, 2)
            ));
        }
        match signal.oddity {
            Some(Oddity::Constant { value }) => remarks.push(format!(
                "All values of {field} are {} {unit}: they have no noise from which σ could be estimated. Check the sensor, or give σ.",
                rounded(value, 6)
            )),
            Some(Oddity::OneValue { time, value }) => remarks.push(format!(
                "One value of {field}, {} {unit} at {} s after the start, makes most of the estimated σ. Remove it, or give σ.",
                rounded(value, 6),
                plain(time)
            )),
            None => {}
        }
    }
    let outliers: usize = fit.signals.iter().map(|signal| signal.outliers).sum();
    if outliers > 0 && fit.loss == Loss::Squares {
        let outliers = format_count(outliers as u64, "residual");
        remarks.push(format!(
            "{outliers} above 5 σ: if these are outliers, use --loss huber."
        ));
    }
    Section::from_lines("Remarks", remarks.into_iter())
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
    let row = |mode: &Mode| {
        let mut row = vec![format_fixed(mode.delta_chi2, 2)];
        for (value, sd) in mode.values.iter().zip(&mode.sds) {
            row.push(with_error(*value, *sd));
        }
        row
    };
    section.table(Table {
        header,
        rows: fit.modes.iter().map(row).collect(),
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
        let [low, high] = [low, high].map(|side| match side {
            Some(value) => rounded(value, 6),
            None => "not reached".to_owned(),
        });
        section.line(format!("{level}: {low} to {high}"));
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
                .map(|(value, delta)| vec![rounded(*value, 8), format_fixed(*delta, 4)])
                .collect(),
            left: 0,
        });
    }
    section
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
    let mut header = vec!["", "parameters", size, "p", "white", "ΔAIC", "ΔBIC"];
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
            cell_of_probability(quality.p_value),
            cell_of_probability(law.residual_p_value),
            format_fixed(law.delta_aic, 1),
            format_fixed(law.delta_bic, 1),
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

/// A p-value as a cell under a header that names it.
fn cell_of_probability(p: Option<f64>) -> String {
    let Some(p) = p else {
        return "–".to_owned();
    };
    let text = probability(p);
    text.trim_start_matches("p ")
        .trim_start_matches("= ")
        .to_owned()
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
    section.table(estimates(&law.parameters, true));
    section
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_estimates_to_their_errors() {
        for (value, sd, expected) in [
            (0.0517144, 1.507e-5, "0.051714 ± 0.000015"),
            (-0.1203, 0.0047, "−0.1203 ± 0.0047"),
            (231.0009, 0.0996, "231.00 ± 0.10"),
            (1234.0, 56.0, "1234 ± 56"),
        ] {
            assert_eq!(with_error(value, sd), expected);
        }
        assert_eq!(rounded(0.00001234, 3), "1.23e-5");
        assert_eq!(rounded(-2.0, 3), "−2");
    }
}
