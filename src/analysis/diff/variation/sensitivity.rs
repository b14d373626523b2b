//! The sensitivity of findings to the numbers that a person measures.

use crate::analysis::diff::findings::finding::Finding;
use crate::analysis::diff::findings::measure::measure;
use crate::analysis::diff::findings::quantity::Quantity;
use crate::run::scenario::Scenario;
use schemars::JsonSchema;
use serde::Serialize;

/// The keys that a person measures, with their symbols.
pub const MEASURED: [(&str, &str); 5] = [
    ("friction.k", "k"),
    ("top.peg_radius", "R"),
    ("top.axial_moment", "I_z"),
    ("top.transverse_moment", "I_x"),
    ("top.center_distance", "l"),
];

/// Relative change of a key.
const CHANGE: f64 = 0.01;

/// The sensitivity of a finding.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Sensitivity {
    /// The finding.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// Half the change of B − A between −1 % and +1 % of `friction.k`, `top.peg_radius`, `top.axial_moment`,
    /// `top.transverse_moment` and `top.center_distance` in both runs, at the same levels and times; absent where a run has
    /// no such number.
    pub changes: [Option<f64>; MEASURED.len()],
}

/// The sensitivities of the findings that differ and that each run has for itself. `count` is called after each simulation.
pub fn sensitivities(
    [a, b]: [&Scenario; 2],
    findings: &[Finding],
    count: &dyn Fn(),
) -> Vec<Sensitivity> {
    let mut quantities = Vec::new();
    for finding in findings.iter().filter(|finding| finding.differs()) {
        if finding.a.is_some() && finding.b.is_some() && finding.difference.is_some() {
            quantities.push(finding.quantity);
        }
    }
    let mut found = Vec::new();
    for quantity in &quantities {
        found.push(Sensitivity {
            quantity: *quantity,
            changes: [None; MEASURED.len()],
        });
    }
    for (at, (key, _)) in MEASURED.into_iter().enumerate() {
        let [less, more] = [1.0 - CHANGE, 1.0 + CHANGE].map(|factor| {
            let [of_a, of_b] = [a, b].map(|scenario| {
                let numbers = scaled(scenario, key, factor).map(|s| measure(&s, &quantities));
                count();
                numbers.unwrap_or_else(|| vec![None; quantities.len()])
            });
            let pairs = of_a.into_iter().zip(of_b);
            pairs.map(|(a, b)| Some(b? - a?)).collect::<Vec<_>>()
        });
        for ((sensitivity, less), more) in found.iter_mut().zip(less).zip(more) {
            sensitivity.changes[at] = more.zip(less).map(|(more, less)| 0.5 * (more - less));
        }
    }
    found
}

/// A scenario with a number changed by a factor.
fn scaled(scenario: &Scenario, key: &str, factor: f64) -> Option<Scenario> {
    let number = scenario.number(key)?;
    scenario.with([(key, (factor * number).into())]).ok()
}
