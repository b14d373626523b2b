//! What a report says where the data allow several minima, and one estimate would mislead.

use super::super::estimate::TWO_SIDED;
use super::super::parameter::is_offset;
use super::super::report::{Estimate, Report};
use super::{estimate_cell, interval_cell, label};
use crate::words::number::{decimals_of_error, fixed};

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
pub(super) fn in_title(report: &Report) -> String {
    let minima = number(report);
    match Ambiguity::all(report).first() {
        Some(Ambiguity::Spin) => format!(" with {minima} different spins"),
        Some(Ambiguity::Clock(_)) => format!(" with {minima} different offsets"),
        None => String::new(),
    }
}

/// What the fit says of its first parameter, in a sentence; empty without parameters.
pub(super) fn headline(report: &Report) -> String {
    // Where there is no minimum, there is no estimate either.
    let Some(first) = report
        .parameters
        .first()
        .filter(|_| report.quality.is_converged)
    else {
        return String::new();
    };
    let (name, interval) = (label(first), interval_cell(first));
    if first.is_over_minima() {
        let reason = match Ambiguity::all(report).first() {
            Some(Ambiguity::Spin) => "because θ alone does not show the spin",
            Some(Ambiguity::Clock(_)) | None => "because several values describe the data",
        };
        format!("{name}: {interval} (95 %), {reason}")
    } else if first.limit.is_some() {
        format!("{name}: {interval}")
    } else {
        let estimate = estimate_cell(first, false);
        format!("{name} = {estimate}, 95 % interval {interval}")
    }
}

/// The ends of an interval over several minima, with the digits that its width leaves.
pub(super) fn ends(low: f64, high: f64) -> [String; 2] {
    let digits = decimals_of_error((high - low) / (2.0 * TWO_SIDED));
    [low, high].map(|end| fixed(end, digits))
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
pub(super) fn remarks(report: &Report) -> Vec<String> {
    let minima = number(report);
    let mut remarks = Vec::new();
    for ambiguity in Ambiguity::all(report) {
        remarks.push(match ambiguity {
            Ambiguity::Spin => format!(
                "θ alone does not show the spin: {minima} different spins describe the data, each with its own values of the others, and the intervals contain them all. Measure φ, too, or hold {SPIN} at a known value."
            ),
            Ambiguity::Clock(name) => format!(
                "Several values of {name} describe the data, each with its own values of the others, and the intervals contain them all. A longer overlap of the files, or a signal that does not repeat with the nutation, such as φ or ω·n, would show more."
            ),
        });
    }
    remarks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Interface;
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

    #[test]
    fn several_minima_have_no_single_estimate() {
        let far = json!({"delta_chi2": 2.0, "values": [0.03, 140.0], "sds": [0.0004, 0.5]});
        let near = json!({"delta_chi2": 5.9, "values": [0.0496, 168.9], "sds": [0.0004, 0.5]});
        let report = report(&[far, near], [0.0291, 0.0596], SPIN, [139.3, 200.4]);
        let words = report.words(Interface::Terminal, false);
        assert_eq!(
            words.title,
            "paper (coulomb): describes the data with 3 different spins"
        );
        assert_eq!(
            words.headline,
            "friction.k: 0.0291 to 0.0596 (95 %), because θ alone does not show the spin"
        );
        assert_eq!(words.parameters.rows[0][1], "several values");
        assert_eq!(words.parameters.rows[1][1], "several values");
        assert!(words.remarks[0].starts_with("θ alone does not show the spin: 3 different spins"));
    }

    #[test]
    fn page_has_degrees() {
        let other = json!({"delta_chi2": 2.0, "values": [0.0587, 0.6], "sds": [0.00044, 0.001]});
        let mut report = report(
            &[other],
            [0.05784, 0.05956],
            "initial.theta",
            [0.498, 0.602],
        );
        "rad".clone_into(&mut report.parameters[1].unit);
        (report.parameters[1].start, report.parameters[1].value) = (0.5, 0.5);
        report.parameters[1].sd = Some(0.001);
        let terminal = report.words(Interface::Terminal, false);
        let page = report.words(Interface::Page, false);
        assert_eq!(
            terminal.parameters.rows[1],
            [
                "initial.theta [rad]",
                "several values",
                "0.498 to 0.602",
                "0.5"
            ]
        );
        assert_eq!(
            page.parameters.rows[1],
            [
                "initial.theta [°]",
                "several values",
                "28.5 to 34.5",
                "28.65"
            ]
        );
        assert_eq!(page.modes.header[2], "initial.theta [°]");
        assert_eq!(page.modes.rows[0][2], "34.377 ± 0.057");
    }

    #[test]
    fn several_offsets_leave_the_other_estimates() {
        let other = json!({"delta_chi2": 1.4, "values": [0.0587, 202.0], "sds": [0.00044, 0.5]});
        let report = report(&[other], [0.05784, 0.05956], "offset", [198.4, 202.6]);
        let words = report.words(Interface::Terminal, false);
        assert_eq!(
            words.title,
            "paper (coulomb): describes the data with 2 different offsets"
        );
        assert_eq!(
            words.headline,
            "friction.k = 0.05870 ± 0.00044, 95 % interval 0.05784 to 0.05956"
        );
        assert_eq!(words.parameters.rows[1][1], "several values");
        assert!(words.remarks[0].starts_with("Several values of offset describe the data, "));
    }

    #[test]
    fn a_single_minimum_has_an_estimate() {
        let report = report(&[], [0.05784, 0.05956], SPIN, [198.42, 200.38]);
        let words = report.words(Interface::Terminal, false);
        assert_eq!(words.title, "paper (coulomb): describes the data");
        assert_eq!(
            words.headline,
            "friction.k = 0.05870 ± 0.00044, 95 % interval 0.05784 to 0.05956"
        );
        assert!(words.remarks.is_empty());
    }
}
