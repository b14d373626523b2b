//! The findings as comma-separated values.

use crate::analysis::diff::{Dependence, Finding, Report};

/// The names of the columns.
const HEADER: &str =
    "kind,what,unit,a,b,difference,integration_error,nutation_change,level_change,differs";

/// A line for each finding, after a header. Numbers have all digits; absent ones are empty.
pub(super) fn table(report: &Report) -> String {
    let mut text = format!("{HEADER}\n");
    for finding in &report.findings {
        text += &line(finding);
    }
    text
}

fn line(finding: &Finding) -> String {
    let (mut of_nutation, mut of_level) = (None, None);
    for dependence in &finding.dependences {
        match *dependence {
            Dependence::Nutation { change } => of_nutation = Some(change),
            Dependence::Level { change, .. } => of_level = Some(change),
        }
    }
    let numbers = [
        finding.a,
        finding.b,
        finding.difference,
        finding.integration_error,
        of_nutation,
        of_level,
    ];
    let numbers =
        numbers.map(|number| number.map_or_else(String::new, |value| format!("{value:?}")));
    // No label has a quotation mark.
    format!(
        "{},\"{}\",{},{},{}\n",
        finding.quantity.kind(),
        finding.quantity.label(),
        finding.quantity.unit(),
        numbers.join(","),
        finding.differs()
    )
}
