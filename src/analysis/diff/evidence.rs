//! The basis of findings, and comparisons of numbers that each run has for itself.

use super::findings::finding::Finding;
use super::findings::quantity::Quantity;
use crate::analysis::diff::averages::Averaged;
use crate::analysis::diff::discrepancy::Discrepancy;
use crate::analysis::diff::integration_error::{IntegrationError, Integrations, combined};
use crate::analysis::diff::pairing::Paired;
use crate::analysis::diff::tolerance::full_name;
use crate::analysis::diff::topic::field::FieldDifference;
use crate::analysis::history::RunHistory;
use crate::run::scenario::Scenario;
use crate::run::simulation::EventKind;
use crate::telemetry::fields::STATE;
use crate::telemetry::side::Side;

/// Everything that the findings are computed from.
pub(super) struct Evidence<'e> {
    pub(super) paired: &'e Paired,
    pub(super) averaged: Option<&'e Averaged>,
    pub(super) discrepancy: Option<&'e Discrepancy>,
    pub(super) integrations: Option<&'e Integrations>,
    pub(super) scenarios: [Option<Scenario>; 2],
}

impl Evidence<'_> {
    pub(super) fn histories(&self) -> [&RunHistory; 2] {
        self.paired.runs.each_ref().map(|run| &run.history)
    }

    /// Whether both runs have recorded their events.
    pub(super) fn has_events(&self) -> bool {
        self.histories()
            .into_iter()
            // Each run has it, so a recording without it has no events.
            .all(|run| run.first(EventKind::Start).is_some())
    }

    /// The difference of a field of `/top/state`, or of a quantity that is derived from it.
    pub(super) fn state(&self, name: &str) -> Option<FieldDifference> {
        let tally = self.paired.topics[STATE.index()].as_ref()?;
        let fields = tally.report(&|_| None).fields;
        fields.into_iter().find(|field| field.field == name)
    }

    /// The error of the difference of two values of such a field.
    pub(super) fn error_of_field(&self, name: &str, values: [f64; 2]) -> IntegrationError {
        let field = full_name(STATE.name(), name);
        self.error(values, |integrations, side| {
            integrations.errors.of(side).field(&field)
        })
    }

    /// The error of the difference of two numbers; `own` is that of the number of one run.
    pub(super) fn error(
        &self,
        numbers: [f64; 2],
        own: impl Fn(&Integrations, Side) -> Option<f64>,
    ) -> IntegrationError {
        let Some(integrations) = self.integrations else {
            return IntegrationError::Unknown;
        };
        match Side::BOTH.map(|side| own(integrations, side)) {
            [Some(a), Some(b)] => IntegrationError::Within(combined([a, b], numbers)),
            [None, _] | [_, None] => IntegrationError::Undetermined,
        }
    }

    /// The time up to which both runs go, s.
    fn common_end(&self) -> Option<f64> {
        let [a, b] = self.histories().map(RunHistory::stop_time);
        Some(a?.min(b?))
    }

    /// The error of the difference of a number that each run has for itself.
    fn error_of(&self, number: impl Fn(&RunHistory) -> Option<f64>) -> IntegrationError {
        let numbers = self.histories().map(|run| number(run).unwrap_or_default());
        self.error(numbers, |integrations, side| {
            integrations.error_of(side, &number)
        })
    }

    /// A finding about a number that each run has for itself, if it does not depend on the integration.
    pub(super) fn compare(
        &self,
        quantity: Quantity,
        number: impl Fn(&RunHistory) -> Option<f64>,
    ) -> Option<Finding> {
        let numbers = self.histories().map(&number);
        Finding::new(quantity, numbers).with_error(self.error_of(number))
    }

    /// A finding about the time of an event. If only one run has it, the other must go on for longer.
    pub(super) fn compare_times(
        &self,
        quantity: Quantity,
        time: impl Fn(&RunHistory) -> Option<f64>,
    ) -> Option<Finding> {
        let finding = self.compare(quantity, &time)?;
        let (only, lacking) = match [finding.a, finding.b] {
            [Some(_), Some(_)] => return Some(finding),
            [None, None] => return None,
            [Some(time), None] => (time, Side::B),
            [None, Some(time)] => (time, Side::A),
        };
        let end = self.histories()[lacking.index()].stop_time()?;
        (only + self.margin(&time)? < end).then_some(finding)
    }

    /// By how much an event must precede the end of the other run so that its absence there is certain, s.
    fn margin(&self, time: impl Fn(&RunHistory) -> Option<f64>) -> Option<f64> {
        let mut margin = 0.0;
        for error in [self.error_of(time), self.error_of(RunHistory::stop_time)] {
            match error {
                IntegrationError::Unknown => {}
                IntegrationError::Within(error) => margin += error,
                IntegrationError::Undetermined => return None,
            }
        }
        Some(margin)
    }

    /// A count of events up to the common end, if it is certain. `quantity` is that of a count up to a time (s).
    pub(super) fn compare_counts(
        &self,
        quantity: impl Fn(f64) -> Quantity,
        count: impl Fn(&RunHistory, f64) -> Option<usize>,
    ) -> Option<Finding> {
        let end = self.common_end()?;
        let margin = self.margin(RunHistory::stop_time)?;
        let finding = self.compare(quantity(end), |run| Some(count(run, end)? as f64))?;
        // The end is known within the margin: an event in it may count or not.
        let [before, after] =
            [end - margin, end + margin].map(|end| self.histories().map(|run| count(run, end)));
        let is_certain =
            before == after && finding.integration_error.is_none_or(|error| error < 1.0);
        let is_positive = finding.a > Some(0.0) || finding.b > Some(0.0);
        (is_certain && is_positive).then_some(Finding {
            // A count is right or wrong.
            integration_error: finding.integration_error.map(|_| 0.0),
            ..finding
        })
    }
}
