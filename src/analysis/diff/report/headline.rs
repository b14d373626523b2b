//! The report in a sentence, and in a few lines.

use super::{Report, Verdict};
use crate::analysis::diff::agreement::{Agreement, Precision};
use crate::analysis::diff::findings::contrast;
use crate::analysis::diff::findings::finding::Finding;
use crate::analysis::diff::findings::quantity::Quantity;
use crate::analysis::diff::tolerance::full_name;
use crate::analysis::diff::topic::ChannelDifference;
use crate::analysis::diff::topic::field::FieldDifference;
use crate::words::{Piece, Sentence, sentence};

impl Report {
    /// The result in a sentence. If the motions differ, it tells what sets them apart, by the size of the findings.
    pub fn headline(&self) -> Sentence {
        if self.verdict != Verdict::Different {
            return self.verdict.title().into();
        }
        if let Some(headline) = self.headline_of_agreement() {
            return headline;
        }
        contrast::headline(&self.contrasts, &self.findings)
            .or_else(|| self.headline_of_means())
            .or_else(|| self.headline_of_fields())
            .or_else(|| self.headline_of_labels())
            .unwrap_or_else(|| self.verdict.title().into())
    }

    /// Motions that agree as long as both run.
    fn headline_of_agreement(&self) -> Option<Sentence> {
        match self.agreement? {
            Agreement::WhileBothRun { ends: Some(_), .. } => {
                Some("The same motion as long as both run".into())
            }
            Agreement::WhileBothRun {
                precision: Precision::IntegrationError { .. },
                ends: None,
                ..
            } => Some("The same within the integration error".into()),
            Agreement::WhileBothRun { .. } | Agreement::Until { .. } => None,
        }
    }

    /// Motions without a large contrast, whose means differ.
    fn headline_of_means(&self) -> Option<Sentence> {
        let mean = self.differing().find_map(|finding| match finding.quantity {
            Quantity::MeanTheta { at } => Some((at, finding)),
            _ => None,
        });
        let (at, finding) = mean?;
        let difference = Piece::number(finding.difference?.abs(), 3, "rad");
        let relation = if finding.relative_difference()? < contrast::MIN_PACE {
            "Nearly the same"
        } else {
            "Different"
        };
        Some(sentence!(
            "{}: mean θ differs by up to {}, at {}",
            relation,
            difference,
            Piece::time(at)
        ))
    }

    /// Runs without a finding that differs, although fields are beyond the tolerances.
    fn headline_of_fields(&self) -> Option<Sentence> {
        let beyond = self.fields_beyond();
        let (channel, field) = beyond.first().filter(|_| self.is_limited)?;
        Some(sentence!(
            "Different: {} beyond the tolerances, most {}",
            Piece::count(beyond.len() as u64, "field"),
            Piece::field(full_name(&channel.topic, &field.field))
        ))
    }

    /// The fields that differ by more than the tolerances, with their topics; the one that differs most, relative to its
    /// largest magnitude, first.
    pub fn fields_beyond(&self) -> Vec<(&ChannelDifference, &FieldDifference)> {
        let mut beyond = Vec::new();
        for channel in &self.channels {
            let fields = channel.fields.iter();
            let own = fields.filter(|field| field.beyond > 0 && !field.is_derived);
            beyond.extend(own.map(|field| (channel, field)));
        }
        beyond.sort_by(|(_, one), (_, other)| other.relative().total_cmp(&one.relative()));
        beyond
    }

    /// Motions whose means don't differ: the first quantity that does, or what bounds the differences.
    fn headline_of_labels(&self) -> Option<Sentence> {
        if let Some(finding) = self.differing().next() {
            return Some(sentence!("Different: {}", finding.quantity.label()));
        }
        let is_compared = self.integration_errors.is_some() && !self.findings.is_empty();
        (is_compared && self.has_other_scenarios())
            .then(|| "No number differs by more than the integration error".into())
    }

    /// The findings that differ.
    pub fn differing(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.differs())
    }

    /// The headline, how far the motions agree, and a line for each key of the scenarios and each finding that differs.
    pub fn summary(&self) -> Vec<String> {
        let mut lines = vec![self.headline().to_string()];
        lines.extend(
            self.agreement
                .map(|agreement| agreement.sentence().to_string()),
        );
        for key in &self.setup.scenario {
            let [a, b] = [&key.a, &key.b].map(|value| value.as_deref().unwrap_or("–"));
            lines.push(format!("{}: A {a}, B {b}", key.key));
        }
        for finding in self.differing() {
            let [what, a, b, difference] = finding.cells();
            let mut parts = Vec::new();
            if finding.a.is_some() || finding.b.is_some() {
                parts.extend([format!("A {a}"), format!("B {b}")]);
            }
            if !difference.is_empty() {
                parts.push(format!("B − A {difference}"));
            }
            lines.push(format!("{what}: {}", parts.join(", ")));
        }
        lines.extend(self.remarks().map(|remark| remark.to_string()));
        lines
    }

    /// The remarks on the findings that differ.
    pub fn remarks(&self) -> impl Iterator<Item = Sentence> {
        self.differing().filter_map(Finding::remark)
    }
}
