//! A report in words: the program, the page and Python show the same.

mod correlations;
mod minima;
mod units;

pub use self::correlations::Correlations;

use super::estimate::REJECTED;
use super::model::Loss;
use super::modes::MAX_TRIALS;
use super::monitor::Progress;
use super::parameter::is_offset;
use super::remedy::{Interface, Remedy};
use super::report::{Estimate, Limit, Oddity, Quality, Report, SignalReport, Verdict};
use crate::words::number::{Digits, decimals_of_error, fixed, format, probability, rounded};
use crate::words::{Piece, counted, grouped};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};

/// Probability of a smaller χ² below which σ was too large.
const TOO_SMALL: f64 = REJECTED;

/// Number of other minima that are shown unless all are wanted.
const MAX_MODES: usize = 8;

/// A report in words, without the comparison of laws and profiles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Words {
    /// The verdict, with the scenario and its law.
    pub title: String,
    /// The verdict alone.
    pub verdict: String,
    /// The first parameter; empty without parameters, or without a minimum.
    pub headline: String,
    /// Goodness of the fit, next to the title.
    pub note: String,
    /// What was fitted.
    pub extent: Vec<String>,
    /// The parameters.
    pub parameters: Table,
    /// Parameters with a limit only.
    pub limits: Vec<String>,
    /// Correlated parameters.
    pub correlations: Correlations,
    /// The signals.
    pub signals: Table,
    /// What the numbers say about the data and the model.
    pub remarks: Vec<String>,
    /// The minima that the data don't exclude; no rows if there is only one.
    pub modes: Table,
}

/// A table of texts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// Names of the columns.
    pub header: Vec<String>,
    /// The cells.
    pub rows: Vec<Vec<String>>,
}

impl Report {
    /// The report in words, in the terms of an interface. `all` shows also estimates that would mislead.
    pub fn words(&self, interface: Interface, all: bool) -> Words {
        let report = &*units::shown(self, interface);
        let mut words = Words {
            title: title(report),
            verdict: verdict(report),
            headline: minima::headline(report),
            note: note(report),
            extent: extent(report),
            parameters: estimates(&report.parameters, all),
            limits: limits(report),
            correlations: Correlations::new(&report.correlations),
            signals: signals(&report.signals),
            remarks: remarks(report, interface),
            modes: modes(report, interface, all),
        };
        if interface == Interface::Page {
            words.move_note(report);
        }
        words
    }
}

impl Words {
    /// Moves the goodness of the fit from the title to the end, where its symbols don't come before the answer.
    fn move_note(&mut self, report: &Report) {
        let note = std::mem::take(&mut self.note);
        if report.loss == Loss::Squares && report.quality.p_value.is_none() {
            let untested = if report.verdict == Verdict::Fitted {
                "The deviations look like noise; whether they are only as large as the errors of the measurement is not tested"
            } else {
                "Whether the deviations are only as large as the errors of the measurement is not tested"
            };
            self.remarks.push(format!(
                "{untested}, because the size of these was estimated from the data themselves. To test it, say how right the angles are."
            ));
        } else if !note.is_empty() {
            self.extent.push(format!("{note}."));
        }
    }
}

impl Report {
    /// The report as text: the verdict, the estimates, the signals, the laws and the remarks, one per line.
    pub fn text(&self, interface: Interface) -> String {
        let words = self.words(interface, false);
        let mut lines = vec![
            format!("{}  {}", words.title, words.note)
                .trim_end()
                .to_owned(),
        ];
        for row in &words.parameters.rows {
            lines.push(format!("{}: {}, 95 % interval {}", row[0], row[1], row[2]));
        }
        lines.extend(words.limits);
        if !words.correlations.sentence.is_empty() {
            lines.push(words.correlations.sentence);
        }
        for signal in &self.signals {
            lines.push(format!(
                "{}: {}, RMS {} σ",
                signal.field,
                counted(signal.samples as u64, "sample"),
                rounded(signal.rms, 3)
            ));
        }
        if let Some(comparison) = &self.comparison {
            lines.push(comparison.sentence.clone());
        }
        lines.extend(words.remarks);
        lines.join("\n")
    }
}

/// Progress in a line.
impl Display for Progress {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "fitting {:.2} of {:.2} s of data",
            self.window, self.until
        )?;
        if self.spins > 0 {
            write!(
                f,
                ", with {} of up to {} other spins",
                self.spins,
                2 * MAX_TRIALS
            )?;
        }
        write!(
            f,
            ": χ² = {}, {} simulations",
            rounded(self.chi2, 4),
            self.evaluations
        )
    }
}

fn title(report: &Report) -> String {
    let Report { scenario, law, .. } = report;
    let verdict = verdict(report);
    if is_about_laws(report) {
        format!("{scenario}: {verdict}")
    } else {
        format!("{scenario} ({law}): {verdict}")
    }
}

fn verdict(report: &Report) -> String {
    let is_comparison = report.comparison.is_some();
    let words = match report.verdict {
        Verdict::Fitted => return format!("describes the data{}", minima::in_title(report)),
        Verdict::Undecided => "undecided between laws",
        Verdict::BadFit if is_comparison => "none of the laws describes the data",
        Verdict::BadFit => "does not describe the data",
        Verdict::NotConverged if is_comparison => "no minimum was found for the best law",
        Verdict::NotConverged => "no minimum was found",
    };
    words.to_owned()
}

/// Whether the title is a verdict on several laws, which has no χ² of its own.
fn is_about_laws(report: &Report) -> bool {
    report.comparison.is_some() && report.verdict != Verdict::Fitted
}

fn note(report: &Report) -> String {
    match report.loss {
        _ if is_about_laws(report) => String::new(),
        // χ²/ν is then about 1, whatever the fit.
        Loss::Squares
            if report
                .signals
                .iter()
                .any(|signal| signal.is_sigma_estimated) =>
        {
            "χ² can't be tested, because σ is estimated".to_owned()
        }
        Loss::Squares => goodness(&report.quality),
        // The loss has no known distribution.
        Loss::Huber => "χ² can't be tested, because outliers count less".to_owned(),
    }
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
        Some(p) => format!("{chi2}, {}", labelled_probability(p)),
        None => chi2,
    }
}

/// A probability with its symbol.
fn labelled_probability(p: f64) -> String {
    let text = probability(p);
    if text.starts_with('<') {
        format!("p {text}")
    } else {
        format!("p = {text}")
    }
}

fn extent(report: &Report) -> Vec<String> {
    let mut lines = Vec::new();
    if is_about_laws(report) {
        lines.push(format!(
            "Parameters, signals and remarks are those of {}.",
            report.law
        ));
    }
    let samples: usize = report.signals.iter().map(|signal| signal.samples).sum();
    lines.push(format!(
        "{} in {} s; the scenario starts at t = {} s in the data. {}.",
        counted(samples as u64, "sample"),
        format(report.until, Digits::AtMostDecimals(6)),
        format(report.origin, Digits::AtMostDecimals(6)),
        counted(report.evaluations, "simulation")
    ));
    lines
}

/// The estimates of parameters. Those that have only a limit are shown with `all`.
pub(crate) fn estimates(parameters: &[Estimate], all: bool) -> Table {
    let mut rows = Vec::new();
    for estimate in parameters {
        rows.push(vec![
            label(estimate),
            estimate_cell(estimate, all),
            interval_cell(estimate),
            // Clocks differ by days, and offsets by nutations.
            rounded(
                estimate.start,
                if is_offset(&estimate.name) { 10 } else { 4 },
            ),
        ]);
    }
    let mut header = ["", "estimate ± sd", "95 % interval", "start value"].map(str::to_owned);
    if parameters.is_empty() {
        header.fill(String::new());
    }
    Table {
        header: header.into(),
        rows,
    }
}

/// A parameter's name with its unit.
fn label(estimate: &Estimate) -> String {
    match estimate.unit.as_str() {
        "" => estimate.name.clone(),
        unit => format!("{} [{unit}]", estimate.name),
    }
}

fn estimate_cell(estimate: &Estimate, all: bool) -> String {
    // The standard deviation of a parameter with a limit only would mislead, so its estimate has none.
    match (estimate.sd, estimate.limit) {
        (Some(_), None) if estimate.is_over_minima() && !all => "several values".to_owned(),
        (Some(_), None) if estimate.is_over_minima() => rounded(estimate.value, 6),
        (Some(sd), None) => Piece::estimate(estimate.value, sd, "").to_string(),
        // The search ended there, but in no minimum.
        (None, None) => rounded(estimate.value, 4),
        (Some(_) | None, Some(_)) if all => rounded(estimate.value, 6),
        (Some(_) | None, _) => "–".to_owned(),
    }
}

fn interval_cell(estimate: &Estimate) -> String {
    match (estimate.interval, estimate.limit) {
        (_, Some(Limit::Below(limit) | Limit::Above(limit)))
            if rounded(limit, 3) == rounded(estimate.value, 3) =>
        {
            at_bound(estimate)
        }
        (_, Some(Limit::Below(limit))) => format!("< {} (95 %)", rounded(limit, 3)),
        (_, Some(Limit::Above(limit))) => format!("> {} (95 %)", rounded(limit, 3)),
        (_, Some(Limit::AtBound)) => at_bound(estimate),
        (_, Some(Limit::None)) => "not determined".to_owned(),
        (Some([low, high]), None) if estimate.is_over_minima() => {
            minima::ends(low, high).join(" to ")
        }
        (Some([low, high]), None) => {
            // With as many decimals as the estimate next to it.
            let digits = decimals_of_error(estimate.sd.unwrap_or_default());
            format!("{} to {}", fixed(low, digits), fixed(high, digits))
        }
        (None, None) => "–".to_owned(),
    }
}

fn at_bound(estimate: &Estimate) -> String {
    format!("at its bound, {}", rounded(estimate.value, 3))
}

/// A sentence on parameters that have a limit and no estimate.
fn limits(report: &Report) -> Vec<String> {
    let mut one_sided = Vec::new();
    for Estimate { name, limit, .. } in &report.parameters {
        match limit {
            Some(Limit::Below(_) | Limit::Above(_)) => one_sided.push(name.as_str()),
            Some(Limit::AtBound | Limit::None) | None => {}
        }
    }
    let mut sentences = Vec::new();
    if !one_sided.is_empty() {
        sentences.push(format!(
            "{}: a limit and no estimate, because the best value is at a bound or less than two standard deviations above zero.",
            one_sided.join(", ")
        ));
    }
    sentences
}

fn signals(signals: &[SignalReport]) -> Table {
    let has_held_out = signals.iter().any(|signal| signal.held_out_samples > 0);
    let mut header = vec!["", "samples", "σ", "RMS/σ"];
    if has_held_out {
        header.push("held-out RMS/σ");
    }
    header.extend(["uncorrelated", ""]);
    let mut rows = Vec::new();
    for signal in signals {
        let origin = if signal.is_sigma_estimated {
            " (estimated)"
        } else {
            ""
        };
        let mut row = vec![
            signal.field.clone(),
            grouped(signal.samples as u64),
            format!("{} {}{origin}", rounded(signal.sigma, 3), signal.unit),
            rounded(signal.rms, 3),
        ];
        if has_held_out {
            row.push(
                signal
                    .held_out_rms
                    .map_or("–".to_owned(), |rms| rounded(rms, 3)),
            );
        }
        row.push(
            signal
                .whiteness
                .map_or("–".to_owned(), labelled_probability),
        );
        row.push(losses(signal));
        rows.push(row);
    }
    Table {
        header: header.into_iter().map(str::to_owned).collect(),
        rows,
    }
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

/// The other minima. A long list is cut after the best ones unless `all` are wanted.
fn modes(report: &Report, interface: Interface, all: bool) -> Table {
    let modes = &report.modes;
    let mut header = vec![match interface {
        Interface::Page => "worse by Δχ²".to_owned(),
        Interface::Terminal | Interface::Python => "Δχ²".to_owned(),
    }];
    for parameter in &report.parameters {
        header.push(match interface {
            // Its units are not those of the keys.
            Interface::Page => label(parameter),
            Interface::Terminal | Interface::Python => parameter.name.clone(),
        });
    }
    let mut rows = Vec::new();
    let shown = if all { modes.len() } else { MAX_MODES };
    for mode in modes.iter().take(shown) {
        let mut row = vec![fixed(mode.delta_chi2, 2)];
        for (value, sd) in mode.values.iter().zip(&mode.sds) {
            row.push(Piece::estimate(*value, *sd, "").to_string());
        }
        rows.push(row);
    }
    let hidden = modes.len().saturating_sub(shown);
    if hidden > 0 {
        let mut row = vec![format!("{hidden} more")];
        row.resize(header.len(), "…".to_owned());
        rows.push(row);
    }
    Table { header, rows }
}

/// What the numbers of a fit say about its data and its model.
fn remarks(report: &Report, interface: Interface) -> Vec<String> {
    let mut remarks = minima::remarks(report);
    remarks.extend(report.notes.iter().cloned());
    for loss in &report.losses {
        remarks.push(format!("Not read: {loss}."));
    }
    // Where there is no minimum, the residuals say nothing about the data.
    if !report.quality.is_converged {
        remarks.push(format!(
            "The values are those at which the search ended, and no estimates. To find a minimum, {}.",
            Remedy::StartCloser.words(interface)
        ));
        return remarks;
    }
    remarks.extend(remark_on_size(&report.quality));
    let is_coloured = report
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
    for signal in &report.signals {
        remarks.extend(remarks_on_signal(signal));
    }
    let outliers: usize = report.signals.iter().map(|signal| signal.outliers).sum();
    let is_minority = report.signals.iter().any(SignalReport::is_mostly_outliers);
    if outliers > 0 && !is_minority {
        let count = counted(outliers as u64, "residual");
        remarks.push(match report.loss {
            Loss::Squares => format!(
                "{count} above 5 σ: if these are outliers, {}.",
                Remedy::CountOutliersLess.words(interface)
            ),
            Loss::Huber => format!(
                "{count} above 5 σ: they are in RMS/σ, but count less in the fit (Huber's loss)."
            ),
        });
    }
    let has_offsets = report
        .parameters
        .iter()
        .any(|estimate| is_offset(&estimate.name));
    if has_offsets && report.verdict == Verdict::BadFit {
        remarks.push(
            "Clocks are aligned with the motion that the first file shows by itself: begin with the file that shows most, such as the angles of a camera."
                .to_owned(),
        );
    }
    remarks
}

/// Whether χ² is improbably large or small.
fn remark_on_size(quality: &Quality) -> Option<String> {
    let p = quality.p_value?;
    let reduced = quality.chi2 / quality.freedom as f64;
    if p < REJECTED {
        Some(format!(
            "The residuals are larger than σ (χ²/ν = {reduced:.2}): the model is wrong, or σ is. The standard deviations of the parameters are too small."
        ))
    } else if p > 1.0 - TOO_SMALL {
        Some(format!(
            "The data scatter much less than the given σ (χ²/ν = {}): σ is too large, and so are the standard deviations of the parameters.",
            rounded(reduced, 2)
        ))
    } else {
        None
    }
}

/// Whether the residuals have a mean other than zero, and are noise about it: where the model misses something else, their
/// mean follows from that.
fn has_constant_error(signal: &SignalReport) -> bool {
    let is_white = signal.whiteness.is_none_or(|p| p >= REJECTED);
    is_white && signal.mean_p_value.is_some_and(|p| p < REJECTED)
}

fn remarks_on_signal(signal: &SignalReport) -> Vec<String> {
    let SignalReport { field, unit, .. } = signal;
    let mut remarks = Vec::new();
    if has_constant_error(signal) {
        remarks.push(format!(
            "The residuals of {field} have the mean {} σ: a constant error, such as a camera that is not level.",
            rounded(signal.mean, 2)
        ));
    }
    if signal.is_mostly_outliers() {
        remarks.push(format!(
            "{} of {} values of {field} are above 5 σ: the fit describes the others, a minority. σ is too small, or the model is wrong.",
            grouped(signal.outliers as u64),
            grouped(signal.samples as u64)
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
            format(time, Digits::AtMostDecimals(6))
        )),
        None => {}
    }
    remarks
}
