//! What a report says where the data allow several minima, and one estimate would mislead.

use super::super::report::{Estimate, Report};
use super::parameters::{estimate_cell, interval_cell, label, name, with_sd};
use crate::fit::problem::parameter::is_offset;
use crate::words::{Piece, Section, Sentence, Table, Tone, sentence};

/// Number of other minima that are shown unless all are wanted.
const MAX_MODES: usize = 8;

/// Distance of an interval's end from the estimate, in standard deviations, beyond which the estimate of the best minimum
/// would mislead: the interval of a single one ends at 1.96, and is hardly wider if the others agree with it.
const SINGLE: f64 = 3.0;

impl Estimate {
    /// Whether the interval reaches over several minima: the standard deviation is that of the best one only.
    pub(crate) fn is_over_minima(&self) -> bool {
        match (self.interval, self.sd) {
            (Some([low, high]), Some(sd)) => {
                (self.value - low).max(high - self.value) > SINGLE * sd
            }
            (Some(_) | None, _) => false,
        }
    }
}

/// The spin at the start.
const SPIN: &str = "initial.psi_dot";

/// Number of minima, with the best one.
fn number(report: &Report) -> u64 {
    1 + report.modes.len() as u64
}

/// What the title says of several minima; empty if there is only one.
pub(super) fn in_title(report: &Report) -> Sentence {
    let minima = number(report).to_string();
    match Ambiguity::all(report).first() {
        Some(Ambiguity::Spin) => sentence!(" with {} different spins", minima),
        Some(Ambiguity::Clock(_)) => sentence!(" with {} different offsets", minima),
        None => Sentence::default(),
    }
}

/// What the fit says of its first parameter, in a sentence; empty without parameters.
pub(super) fn headline(report: &Report) -> Sentence {
    // Where there is no minimum, there is no estimate either.
    let Some(first) = report
        .parameters
        .first()
        .filter(|_| report.quality.is_converged)
    else {
        return Sentence::default();
    };
    let (name, interval) = (label(first), interval_cell(first));
    if first.is_over_minima() {
        let reason = match Ambiguity::all(report).first() {
            Some(Ambiguity::Spin) => "because θ alone does not show the spin",
            Some(Ambiguity::Clock(_)) | None => "because several values describe the data",
        };
        sentence!("{}: {} (95 %), {}", name, interval, reason)
    } else if first.limit.is_some() {
        sentence!("{}: {}", name, interval)
    } else {
        let estimate = estimate_cell(first, false);
        sentence!("{} = {}, 95 % interval {}", name, estimate, interval)
    }
}

/// The other minima. A long list is cut after the best ones unless `all` are wanted.
pub(super) fn section(report: &Report, all: bool) -> Section {
    let modes = &report.modes;
    let mut header = vec![Sentence::from("Δχ²")];
    header.extend(report.parameters.iter().map(name));
    let mut rows = Vec::new();
    let shown = if all { modes.len() } else { MAX_MODES };
    for mode in modes.iter().take(shown) {
        let mut row = vec![Piece::fixed(mode.delta_chi2, 2, "").into()];
        let values = mode.values.iter().zip(&mode.sds);
        for ((value, sd), parameter) in values.zip(&report.parameters) {
            row.push(with_sd(*value, *sd, parameter));
        }
        rows.push(row);
    }
    let hidden = modes.len().saturating_sub(shown);
    if hidden > 0 {
        let mut row = vec![sentence!("{} more", hidden.to_string())];
        row.resize(header.len(), "…".into());
        rows.push(row);
    }
    let mut section = Section::with_tone(Tone::Weak, "What describes the data as well");
    section.note = sentence!(
        "within the noise, with χ² higher by Δχ²: the 95 % intervals contain all of these"
    );
    section.table(Table {
        header,
        rows,
        left: 0,
    });
    section
}

/// What the data show only up to whole nutations.
enum Ambiguity<'a> {
    /// The spin, from θ alone.
    Spin,
    /// The offset of a clock with this name.
    Clock(&'a str),
}

impl<'a> Ambiguity<'a> {
    /// All that a report has.
    fn all(report: &'a Report) -> Vec<Self> {
        let (mut clocks, mut is_spin_open) = (Vec::new(), false);
        for estimate in report.parameters.iter().filter(|e| e.is_over_minima()) {
            if is_offset(&estimate.name) {
                clocks.push(Self::Clock(&estimate.name));
            }
            is_spin_open |= estimate.name == SPIN;
        }
        // Minima of a clock differ a little in the spin, too.
        if clocks.is_empty() && is_spin_open {
            return vec![Self::Spin];
        }
        clocks
    }
}

/// Why there is no single estimate, and what would give one.
pub(super) fn remarks(report: &Report) -> Vec<Sentence> {
    let minima = number(report).to_string();
    let mut remarks = Vec::new();
    for ambiguity in Ambiguity::all(report) {
        remarks.push(match ambiguity {
            Ambiguity::Spin => sentence!(
                "θ alone does not show the spin: {} different spins describe the data, each with its own values of the others, and the intervals contain them all. Measure φ, too, or hold {} at a known value.",
                &minima,
                Piece::key(SPIN)
            ),
            Ambiguity::Clock(name) => sentence!(
                "Several values of {} describe the data, each with its own values of the others, and the intervals contain them all. A longer overlap of the files, or a signal that does not repeat with the nutation, such as φ or ω·n, would show more.",
                Piece::key(name.to_owned())
            ),
        });
    }
    remarks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::Part;
    use serde_json::{Value as Json, json};

    /// A report on the friction and another parameter with this name and interval, which has the value 199.4 ± 0.5.
    fn report(modes: &[Json], k_interval: [f64; 2], name: &str, interval: [f64; 2]) -> Report {
        serde_json::from_value(json!({
            "verdict": "fitted", "scenario": "paper", "law": "coulomb", "origin": 0.0, "loss": "squares", "until": 5.0,
            "signals": [], "losses": [], "notes": [], "correlations": [], "profiles": [], "evaluations": 1,
            "parameters": [
                {"name": "friction.k", "unit": "", "start": 0.03, "value": 0.0587, "sd": 0.00044, "interval": k_interval},
                {"name": name, "unit": "", "start": 170.0, "value": 199.4, "sd": 0.5, "interval": interval},
            ],
            "quality": {"chi2": 300.0, "freedom": 297, "p_value": 0.4, "is_converged": true, "aic": 0.0, "bic": 0.0},
            "modes": modes,
        }))
        .unwrap()
    }

    /// The title of a report, its headline, the first remark, and the estimates in its table.
    fn words(report: &Report) -> (String, String, String, Vec<String>) {
        let words = report.words(false);
        let mut remark = String::new();
        let mut estimates = Vec::new();
        for section in &words.sections {
            match (section.title.to_string().as_str(), &section.parts[0]) {
                ("Remarks", Part::Line(line)) => remark = line.to_string(),
                ("Parameters", Part::Table(table)) => {
                    estimates.extend(table.rows.iter().map(|row| row[1].to_string()));
                }
                _ => {}
            }
        }
        let title = words.sections[0].title.to_string();
        (title, words.headline.to_string(), remark, estimates)
    }

    #[test]
    fn several_minima_have_no_single_estimate() {
        let far = json!({"delta_chi2": 2.0, "values": [0.03, 140.0], "sds": [0.0004, 0.5]});
        let near = json!({"delta_chi2": 5.9, "values": [0.0496, 168.9], "sds": [0.0004, 0.5]});
        let report = report(&[far, near], [0.0291, 0.0596], SPIN, [139.3, 200.4]);
        let (title, headline, remark, estimates) = words(&report);
        assert_eq!(
            title,
            "paper (coulomb): describes the data with 3 different spins"
        );
        assert_eq!(
            headline,
            "friction.k: 0.0291 to 0.0596 (95 %), because θ alone does not show the spin"
        );
        assert_eq!(estimates, ["several values", "several values"]);
        assert!(remark.starts_with("θ alone does not show the spin: 3 different spins"));
    }

    #[test]
    fn several_offsets_leave_the_other_estimates() {
        let other = json!({"delta_chi2": 1.4, "values": [0.0587, 202.0], "sds": [0.00044, 0.5]});
        let report = report(&[other], [0.05784, 0.05956], "offset", [198.4, 202.6]);
        let (title, headline, remark, estimates) = words(&report);
        assert_eq!(
            title,
            "paper (coulomb): describes the data with 2 different offsets"
        );
        assert_eq!(
            headline,
            "friction.k = 0.05870 ± 0.00044, 95 % interval 0.05784 to 0.05956"
        );
        assert_eq!(estimates[1], "several values");
        assert!(remark.starts_with("Several values of offset describe the data, "));
    }

    #[test]
    fn a_single_minimum_has_an_estimate() {
        let report = report(&[], [0.05784, 0.05956], SPIN, [198.42, 200.38]);
        let (title, headline, remark, _) = words(&report);
        assert_eq!(title, "paper (coulomb): describes the data");
        assert_eq!(
            headline,
            "friction.k = 0.05870 ± 0.00044, 95 % interval 0.05784 to 0.05956"
        );
        assert_eq!(remark, "");
    }
}
