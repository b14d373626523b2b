//! The report of a comparison (data for all output formats).
//!
//! Differences are B − A throughout. Angles are in rad, times in s of simulated time.

mod headline;

use super::agreement::{Agreement, agreement};
use super::averages::{self, Averaged};
use super::discrepancy::{Discrepancy, Residuals};
use super::evidence::Evidence;
use super::findings::contrast::{Contrast, contrasts};
use super::findings::finding::{Finding, FindingReport, with_conclusions};
use super::findings::findings;
use super::integration_error::{IntegrationErrors, Integrations};
use super::others::{self, TopicBytes};
use super::pairing::{Paired, PairedRun};
use super::setup::{KeyDifference, SetupDifferences};
use super::tolerance::Options;
use super::topic::{ChannelDifference, TopicTally};
use super::variation::by_key::ByKey;
use super::variation::matching::Match;
use super::variation::sensitivity::Sensitivity;
use crate::analysis::history::RunSummary;
use crate::analysis::normal_force::NormalForces;
use crate::analysis::slip::SlipComparison;
use crate::analysis::subject::Subject;
use crate::archive::recording::Condition;
use crate::run::time::seconds;
use crate::telemetry::side::Side;
use schemars::JsonSchema;
use serde::Serialize;

/// The differences of two runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "DiffReport")]
pub struct Report {
    /// The first run.
    pub a: ComparedRun,
    /// The second run.
    pub b: ComparedRun,
    /// The result as a whole.
    pub verdict: Verdict,
    /// Whether both runs were read completely; otherwise the verdict covers the readable part.
    pub is_complete: bool,
    /// Whether tolerances, topics or ignored fields limit what counts as a difference.
    pub is_limited: bool,
    /// Extent to which the motions agree although the runs are different.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agreement: Option<Agreement>,
    /// The differences in the set-up.
    pub setup: SetupDifferences,
    /// The findings, the most important first; empty for foreign files.
    #[serde(serialize_with = "with_conclusions")]
    #[schemars(with = "Vec<FindingReport<'_>>")]
    pub findings: Vec<Finding>,
    /// The findings that set the motions apart, the most important first.
    pub contrasts: Vec<Contrast>,
    /// The topics of toprise, message by message.
    pub channels: Vec<ChannelDifference>,
    /// Topics compared byte by byte: foreign ones, and all if the values of the others are identical.
    pub others: Vec<TopicBytes>,
    /// The differences of the averaged motions; absent without nutations in common.
    pub averaged: Option<Averaged>,
    /// B's model evaluated at the states of A; requires both scenarios and `/top/state` of A.
    pub discrepancy: Option<Discrepancy>,
    /// The slip of both runs, and the coefficients of friction there; absent for foreign files.
    pub slip: Option<SlipComparison>,
    /// The normal forces of both runs; absent for foreign files.
    pub normal_forces: Option<NormalForces>,
    /// The integration errors; absent if not requested or not computable.
    pub integration_errors: Option<IntegrationErrors>,
    /// The part of each changed key in the findings, if it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_key: Option<ByKey>,
    /// A with the value of a key with which it comes closest to B, if it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matched: Option<Match>,
    /// The sensitivities of the findings, if they were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensitivities: Vec<Sensitivity>,
    /// Notes on this comparison.
    pub notes: Vec<String>,
}

/// The result of a comparison as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Messages are bit-identical, with their times and sequence numbers, and nothing else differs.
    Identical,
    /// All values are bit-identical, but encoding, the spelling of JSON, publish times, sequence numbers, attachments,
    /// metadata or the scenario name differ.
    SameValues,
    /// All compared messages agree within the tolerances.
    Equal,
    /// The compared parts agree within the tolerances, but not every message was compared: parts of a run can't be read, or
    /// one has samples between those of the other.
    Agreeing,
    /// Something differs.
    #[default]
    Different,
}

impl Verdict {
    /// The verdict in words.
    pub fn title(self) -> &'static str {
        match self {
            Self::Identical => "Identical (bit for bit)",
            Self::SameValues => "All values identical; other parts differ",
            Self::Equal => "Equal within the tolerances",
            Self::Agreeing => "Equal in the compared part",
            Self::Different => "Different",
        }
    }
}

/// One of the two runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ComparedRun {
    /// The name of its scenario or of its file.
    pub name: String,
    /// The file; absent for a scenario.
    pub file: Option<String>,
    /// The kind of file; absent for a scenario that is simulated now.
    pub state: Option<Condition>,
    /// The keys of the scenario as an object; absent if it is not known.
    pub scenario: Option<serde_json::Value>,
    /// Number of messages that were read.
    pub messages: u64,
    /// Time of the last message, s.
    pub last: f64,
    /// Parts that could not be read.
    pub losses: Vec<String>,
    /// A summary of the run; absent for foreign files.
    pub summary: Option<RunSummary>,
}

impl Report {
    /// The report of two runs of toprise.
    pub(super) fn from_runs(
        runs: [Subject<'_>; 2],
        paired: &Paired,
        mut setup: SetupDifferences,
        others: Vec<TopicBytes>,
        integrations: Option<Integrations>,
        options: &Options,
    ) -> Self {
        let errors = integrations
            .as_ref()
            .map(|integrations| &integrations.errors);
        let [a, b] = Side::BOTH.map(|side| {
            let PairedRun {
                history,
                losses,
                state,
                ..
            } = &paired.runs[side.index()];
            ComparedRun {
                state: *state,
                messages: history.messages,
                last: history.last_ns.map_or(0.0, seconds),
                summary: Some(history.summary()),
                ..ComparedRun::new(runs[side.index()], losses)
            }
        });
        let averaged = averages::compare(
            &paired.runs[0].history,
            &paired.runs[1].history,
            f64::INFINITY,
        );
        let discrepancy = paired.residuals.as_ref().and_then(Residuals::report);
        let evidence = Evidence {
            paired,
            averaged: averaged.as_ref(),
            discrepancy: discrepancy.as_ref(),
            integrations: integrations.as_ref(),
            scenarios: runs.map(Subject::scenario),
        };
        let findings = findings(&evidence, options);
        setup.fields_only_in = Side::BOTH.map(|side| {
            let fields = paired.compared().flat_map(|topic| topic.only_in(side));
            fields.cloned().collect()
        });
        // A file may be cut off without a loss in what was read of it.
        let is_cut = [(0, &a), (1, &b)].map(|(i, run)| runs[i].is_cut() || !run.losses.is_empty());
        let mut notes = Vec::new();
        for (run, name) in [(runs[0], "A"), (runs[1], "B")] {
            if let Subject::Recording(recording) = run
                && let Err(error) = recording.scenario()
            {
                notes.push(format!("{name}: {error}."));
            }
        }
        if runs.iter().any(|run| is_relogged(*run)) {
            let note = "Channels for viewers are not compared: log times are not time stamps.";
            notes.push(note.to_owned());
        }
        // Numbers of different events differ as a matter of course.
        let has_equal_values = paired.compared().all(TopicTally::is_identical);
        if has_equal_values && others.iter().all(|topic| topic.other_sequences == 0) {
            let sequences = paired
                .compared()
                .map(|topic| (topic.name(), topic.found.other_sequences));
            notes.extend(others::note("Sequence numbers differ", sequences));
        }
        notes.extend(others::notes(&others));
        let channels: Vec<_> = paired
            .compared()
            .map(|topic| topic.report(&|field| errors?.field(field)))
            .collect();
        let verdict = verdict(paired, &others, &setup, is_cut);
        let agreement = match verdict {
            Verdict::Different => agreement(&evidence, &findings, &channels),
            Verdict::Identical | Verdict::SameValues | Verdict::Equal | Verdict::Agreeing => None,
        };
        let contrasts = match verdict {
            Verdict::Different => contrasts(&evidence, &findings),
            Verdict::Identical | Verdict::SameValues | Verdict::Equal | Verdict::Agreeing => {
                Vec::new()
            }
        };
        Self {
            verdict,
            contrasts,
            is_complete: is_cut == [false; 2],
            is_limited: options.are_limited(),
            agreement,
            setup,
            findings,
            channels,
            others,
            averaged,
            discrepancy,
            slip: Some(paired.slip()),
            normal_forces: Some(paired.normal_forces()),
            integration_errors: integrations.map(|integrations| integrations.errors),
            notes,
            a,
            b,
            by_key: None,
            matched: None,
            sensitivities: Vec::new(),
        }
    }

    /// The report of two files, at least one of which is not a toprise recording.
    pub(super) fn from_files(
        runs: [Subject<'_>; 2],
        setup: SetupDifferences,
        others: Vec<TopicBytes>,
        losses: &[Vec<String>; 2],
    ) -> Self {
        let [a, b] = Side::BOTH.map(|side| {
            let at = side.index();
            let messages = others
                .iter()
                .map(|topic| topic.pairs() + topic.unmatched[at]);
            ComparedRun {
                messages: messages.sum(),
                ..ComparedRun::new(runs[at], &losses[at])
            }
        });
        let is_cut = [&a, &b].map(|run| !run.losses.is_empty());
        let is_complete = is_cut == [false; 2];
        let has_more = Side::BOTH.into_iter().any(|side| {
            let at = side.index();
            let lacks = !setup.topics_only_in[at].is_empty()
                || others.iter().any(|topic| topic.unmatched[at] > 0);
            lacks && !is_cut[side.other().index()]
        });
        let agrees = others
            .iter()
            .all(|topic| topic.different == 0 && !topic.is_described_differently);
        let verdict = if has_more || !agrees {
            Verdict::Different
        } else if !is_complete {
            Verdict::Agreeing
        } else if setup.files.is_empty() && others.iter().all(TopicBytes::is_identical) {
            Verdict::Identical
        } else {
            Verdict::SameValues
        };
        let mut notes = others::notes(&others);
        let has_more_topics = setup.topics_only_in.iter().any(|only| !only.is_empty());
        if [a.messages, b.messages] == [0; 2] && !has_more_topics {
            notes.push("Neither file has messages to compare.".to_owned());
        }
        Self {
            a,
            b,
            verdict,
            is_complete,
            setup,
            others,
            notes,
            ..Self::default()
        }
    }
}

impl ComparedRun {
    fn new(subject: Subject<'_>, losses: &[String]) -> Self {
        let mut run = Self {
            name: subject.name(),
            scenario: subject.scenario().map(|scenario| scenario.to_json()),
            losses: losses.to_vec(),
            ..Self::default()
        };
        if let Subject::Recording(recording) = subject {
            run.file = Some(recording.path().display().to_string());
            run.state = Some(recording.condition());
        }
        run
    }
}

/// The verdict on the messages. If a run is truncated, messages beyond its end are not a difference.
fn verdict(
    paired: &Paired,
    others: &[TopicBytes],
    setup: &SetupDifferences,
    is_cut: [bool; 2],
) -> Verdict {
    // Unmatched messages are a difference, unless the other run is truncated.
    let has_more = Side::BOTH
        .into_iter()
        .any(|side| has_more_than_other(side, paired, setup) && !is_cut[side.other().index()]);
    let agrees = paired.compared().all(TopicTally::is_equal);
    if has_more || !agrees || !others.iter().all(TopicBytes::is_equal) {
        return Verdict::Different;
    }
    // Samples between those of the other run have nothing to be compared with.
    let is_thinned = paired.compared().any(TopicTally::is_thinned);
    let is_whole = paired.compared().all(TopicTally::has_all_partners);
    if is_cut != [false; 2] || is_thinned || !is_whole {
        return Verdict::Agreeing;
    }
    let has_same_sequences = paired
        .compared()
        .all(|topic| topic.found.other_sequences == 0);
    if !paired.compared().all(TopicTally::is_identical) {
        Verdict::Equal
    } else if setup.is_same() && has_same_sequences && others.iter().all(TopicBytes::is_identical) {
        Verdict::Identical
    } else {
        Verdict::SameValues
    }
}

/// Whether a run has topics, fields or messages that the other lacks.
fn has_more_than_other(side: Side, paired: &Paired, setup: &SetupDifferences) -> bool {
    let names = [&setup.topics_only_in, &setup.fields_only_in];
    let has_names = names.iter().any(|only| !only[side.index()].is_empty());
    has_names || paired.compared().any(|topic| topic.unmatched(side) > 0)
}

impl Report {
    /// Whether the scenarios differ (except name and description).
    pub fn has_other_scenarios(&self) -> bool {
        self.setup
            .scenario
            .iter()
            .any(KeyDifference::changes_the_run)
    }
}

/// Whether other software logged the messages of a run at other times.
fn is_relogged(run: Subject<'_>) -> bool {
    match run {
        Subject::Scenario(_) => false,
        Subject::Recording(recording) => recording.relogged().is_some(),
    }
}
