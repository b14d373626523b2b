//! The report in words.

use super::{Equality, Report, SchemaCheck, Verdict};
use crate::archive::container::loss::loss_lines;
use crate::archive::recording::Condition;
use crate::telemetry::table;
use crate::words::{Section, Table, Tone, counted};

impl Report {
    /// The report on a file with this name, for people.
    pub fn section(&self, file: &str) -> Section {
        let (tone, conclusion) = match self.verdict {
            Verdict::Verified => (Tone::Good, verified(self)),
            Verdict::Incomplete if self.equal == Some(0) => (Tone::Weak, "nothing can be compared"),
            Verdict::Incomplete => (Tone::Weak, "all readable messages match"),
            Verdict::Different => (Tone::Bad, "DIFFERENT from a new run of its scenario"),
        };
        let state = match (self.verdict, self.state) {
            // A complete file can contain an incomplete run.
            (Verdict::Incomplete, Condition::Whole) => "incomplete run: ".to_owned(),
            (Verdict::Incomplete, state) => format!("{}: ", state.name()),
            _ => String::new(),
        };
        let mut section = Section::with_tone(tone, format!("{file}: {state}{conclusion}"));
        let mut facts = Vec::new();
        if let Some(difference) = &self.difference {
            facts.push(("difference", difference.to_string()));
        }
        facts.extend(loss_lines(&self.losses, self.more_losses));
        if let Some(version) = &self.recorded_by {
            let this = format!(
                "{} (telemetry {})",
                env!("CARGO_PKG_VERSION"),
                table::VERSION
            );
            facts.push(("recorded by", format!("toprise {version}; this is {this}")));
        }
        if let Some(relogged) = self.relogged {
            facts.push(("log times", relogged.fact()));
        }
        if let Some(equal) = self.equal {
            facts.push(("equal", counted(equal, "message")));
        }
        if self.missing > 0 {
            facts.push(("missing", counted(self.missing, "message")));
        }
        if !self.unknown.is_empty() {
            facts.push(("not compared", self.unknown.join(", ")));
        }
        for supplement in &self.supplements {
            facts.push(("in addition", format!("{supplement}, not verified")));
        }
        if !self.repeated.is_empty() {
            facts.push(("repeated", self.repeated.join(", ")));
        }
        if let Some(check) = self.schemas {
            facts.push(("not compared", not_compared(check).to_owned()));
        }
        if !self.without.is_empty() {
            facts.push(("not recorded", self.without.join(", ")));
        }
        section.table(Table::from_facts(facts));
        section
    }
}

fn verified(report: &Report) -> &'static str {
    match report.equality {
        Some(Equality::ByteIdentical) | None => "verified (byte-identical to a new run)",
        Some(Equality::PackedOtherwise) if report.relogged.is_some() => {
            "verified (same run, at other log times)"
        }
        Some(Equality::PackedOtherwise) if !report.supplements.is_empty() => {
            "verified (same run, in a file that holds more)"
        }
        Some(Equality::PackedOtherwise) => "verified (same content, repacked)",
        Some(Equality::SameValues) => "verified (same values, recorded by another version)",
    }
}

/// The parts of a recording of another version that are not compared.
fn not_compared(check: SchemaCheck) -> &'static str {
    match check {
        SchemaCheck::Released => "channels for viewers",
        SchemaCheck::Unknown => {
            "channels for viewers; units and descriptions, because this version doesn't know those of the other"
        }
    }
}
