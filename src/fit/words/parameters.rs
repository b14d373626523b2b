//! Parameters in words: their estimates and limits.

use super::super::estimate::TWO_SIDED;
use super::super::report::{Estimate, Limit, Report};
use super::correlations;
use crate::fit::problem::parameter::is_offset;
use crate::words::number::{decimals_of_error, rounded};
use crate::words::{Piece, Section, Sentence, Table, sentence};

/// The estimates, and what the data determine of them.
pub(super) fn section(report: &Report, all: bool) -> Section {
    let mut section = Section::new("Parameters");
    section.table(estimates(&report.parameters, all));
    let one_sided: Vec<Sentence> = report
        .parameters
        .iter()
        .filter(|estimate| matches!(estimate.limit, Some(Limit::Below(_) | Limit::Above(_))))
        .map(name)
        .collect();
    if !one_sided.is_empty() {
        section.line(sentence!(
            "{}: a limit and no estimate, because the best value is at a bound or less than two standard deviations above zero.",
            Sentence::join(one_sided, ", ")
        ));
    }
    for line in correlations::lines(&report.correlations, all) {
        section.line(line);
    }
    section
}

/// The estimates of parameters. Those that have only a limit are shown with `all`.
pub(super) fn estimates(parameters: &[Estimate], all: bool) -> Table {
    let mut rows = Vec::new();
    for estimate in parameters {
        // Clocks differ by days, and offsets by nutations.
        let digits = if is_offset(&estimate.name) { 10 } else { 4 };
        rows.push(vec![
            label(estimate),
            estimate_cell(estimate, all),
            interval_cell(estimate),
            significant(estimate.start, digits, estimate).into(),
        ]);
    }
    Table {
        header: ["", "estimate ± sd", "95 % interval", "start value"]
            .map(Sentence::from)
            .into(),
        rows,
        left: 1,
    }
}

pub(super) fn name(estimate: &Estimate) -> Sentence {
    Piece::key(estimate.name.clone()).into()
}

/// A parameter's name with its unit.
pub(super) fn label(estimate: &Estimate) -> Sentence {
    match estimate.unit.as_str() {
        "" => name(estimate),
        unit => sentence!("{} [{}]", name(estimate), unit),
    }
}

/// A value of a parameter with at most `digits` significant digits. Its label has the unit.
fn significant(value: f64, digits: usize, estimate: &Estimate) -> Piece {
    Piece::rounded(value, digits, estimate.unit.clone()).without_unit()
}

/// A value of a parameter with `decimals` decimals. Its label has the unit.
fn fixed(value: f64, decimals: usize, estimate: &Estimate) -> Piece {
    Piece::fixed(value, decimals, estimate.unit.clone()).without_unit()
}

/// A value of a parameter with its standard deviation. Its label has the unit.
pub(super) fn with_sd(value: f64, sd: f64, estimate: &Estimate) -> Sentence {
    Piece::estimate(value, sd, estimate.unit.clone())
        .without_unit()
        .into()
}

pub(super) fn estimate_cell(estimate: &Estimate, all: bool) -> Sentence {
    // The standard deviation of a parameter with a limit only would mislead, so its estimate has none.
    match (estimate.sd, estimate.limit) {
        (Some(_), None) if estimate.is_over_minima() && !all => "several values".into(),
        (Some(_), None) if estimate.is_over_minima() => {
            significant(estimate.value, 6, estimate).into()
        }
        (Some(sd), None) => with_sd(estimate.value, sd, estimate),
        // The search ended there, but in no minimum.
        (None, None) => significant(estimate.value, 4, estimate).into(),
        (Some(_) | None, Some(_)) if all => significant(estimate.value, 6, estimate).into(),
        (Some(_) | None, _) => "–".into(),
    }
}

pub(super) fn interval_cell(estimate: &Estimate) -> Sentence {
    match (estimate.interval, estimate.limit) {
        (_, Some(Limit::Below(limit) | Limit::Above(limit)))
            if rounded(limit, 3) == rounded(estimate.value, 3) =>
        {
            at_bound(estimate)
        }
        (_, Some(Limit::Below(limit))) => {
            sentence!("< {} (95 %)", significant(limit, 3, estimate))
        }
        (_, Some(Limit::Above(limit))) => {
            sentence!("> {} (95 %)", significant(limit, 3, estimate))
        }
        (_, Some(Limit::AtBound)) => at_bound(estimate),
        (_, Some(Limit::None)) => "not determined".into(),
        (Some([low, high]), None) => {
            let decimals = if estimate.is_over_minima() {
                decimals_of_interval(low, high)
            } else {
                // As many as the estimate next to it has.
                decimals_of_error(estimate.sd.unwrap_or_default())
            };
            sentence!(
                "{} to {}",
                fixed(low, decimals, estimate),
                fixed(high, decimals, estimate)
            )
        }
        (None, None) => "–".into(),
    }
}

/// The decimals that the width of an interval over several minima leaves its ends.
fn decimals_of_interval(low: f64, high: f64) -> usize {
    decimals_of_error((high - low) / (2.0 * TWO_SIDED))
}

fn at_bound(estimate: &Estimate) -> Sentence {
    sentence!("at its bound, {}", significant(estimate.value, 3, estimate))
}
