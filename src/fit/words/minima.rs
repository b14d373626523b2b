//! What a report says where the data allow several minima, and one estimate would mislead.

use super::super::estimate::TWO_SIDED;
use super::super::numbers::decimals;
use super::super::report::{Estimate, Report};
use super::{estimate_cell, interval_cell, label};
use crate::run::decimal::fixed;

/// Distance of an interval's end from the estimate, in standard deviations, beyond which the interval reaches over other
/// minima: that of a single one ends at 1.96.
const SINGLE: f64 = 2.0;

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

/// Number of minima within the 95 % intervals, with the best one.
pub(super) fn number(report: &Report) -> u64 {
    let others = report
        .modes
        .iter()
        .filter(|mode| mode.delta_chi2 < TWO_SIDED * TWO_SIDED);
    1 + others.count() as u64
}

/// What the fit says of its first parameter, in a sentence; empty without parameters.
pub(super) fn headline(report: &Report) -> String {
    let Some(first) = report.parameters.first() else {
        return String::new();
    };
    let (name, interval) = (label(first), interval_cell(first));
    if first.is_over_minima() {
        format!("{name}: {interval} (95 %), because θ alone does not show the spin")
    } else if first.limit.is_some() {
        format!("{name}: {interval}")
    } else {
        let estimate = estimate_cell(first, false);
        format!("{name} = {estimate}, 95 % interval {interval}")
    }
}

/// The ends of an interval over several minima, with the digits that its width leaves.
pub(super) fn ends(low: f64, high: f64) -> [String; 2] {
    let digits = decimals((high - low) / (2.0 * TWO_SIDED));
    [low, high].map(|end| fixed(end, digits))
}

/// Why there is no single estimate, and what would give one.
pub(super) fn remark(report: &Report) -> Option<String> {
    // Minima are looked for only where θ alone, or its derivatives, were measured and the spin is free.
    let minima = number(report);
    (minima > 1).then(|| {
        format!(
            "θ alone does not show the spin: {minima} minima with different spins describe the data, and the intervals reach over them. Measure φ, too, or hold initial.psi_dot at a known value."
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value as Json, json};

    /// A report on the friction and the spin, whose best fit is at k = 0.0587, with other minima.
    fn report(modes: &[Json], k_interval: [f64; 2]) -> Report {
        serde_json::from_value(json!({
            "verdict": "fitted", "scenario": "paper", "law": "coulomb", "origin": 0.0, "loss": "squares", "until": 5.0,
            "signals": [], "losses": [], "notes": [], "correlations": [], "profiles": [], "evaluations": 1,
            "parameters": [
                {"name": "friction.k", "unit": "", "start": 0.03, "value": 0.0587, "sd": 0.00044, "interval": k_interval},
                {"name": "initial.psi_dot", "unit": "rad/s", "start": 170.0, "value": 199.4, "sd": 0.5, "interval": [198.4, 200.4]},
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
        let words = report(&[far, near], [0.0291, 0.0596]).words(false);
        assert_eq!(
            words.title,
            "paper (coulomb): describes the data with 2 different spins"
        );
        assert_eq!(
            words.headline,
            "friction.k: 0.0291 to 0.0596 (95 %), because θ alone does not show the spin"
        );
        assert_eq!(words.parameters.rows[0][1], "several minima");
        assert_eq!(words.parameters.rows[1][1], "199.40 ± 0.50");
        assert!(words.remarks[0].starts_with("θ alone does not show the spin: 2 minima"));
    }

    #[test]
    fn a_single_minimum_has_an_estimate() {
        let words = report(&[], [0.05784, 0.05956]).words(false);
        assert_eq!(words.title, "paper (coulomb): describes the data");
        assert_eq!(
            words.headline,
            "friction.k = 0.05870 ± 0.00044, 95 % interval 0.05784 to 0.05956"
        );
        assert!(words.remarks.is_empty());
    }
}
