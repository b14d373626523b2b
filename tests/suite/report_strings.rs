//! Strings in reports: each one is a name, a value, or words that are derived from other members.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The members of reports that are free strings, by the reason for which they may be.
const ALLOWED: [(&str, &[&str]); 8] = [
    (
        "names of topics, fields, keys, signals, laws, parameters, figures, runs and events",
        &[
            "ArchiveCheck.made_by",
            "ArchiveReport.recordings[]",
            "ChannelDifference.topic",
            "ChannelOverview.encoding",
            "ChannelOverview.schema",
            "ChannelOverview.topic",
            "ChannelSchema.schema",
            "ChannelSchema.topic",
            "ColumnReading.column",
            "ColumnReading.measures",
            "ComparedRun.name",
            "Conclusion.alike[]",
            "Conclusion.law",
            "Conclusion.lowest",
            "Conclusion.unfinished[]",
            "Correlation.parameters[]",
            "Deviation.quantity",
            "Difference.field",
            "Difference.place",
            "Estimate.name",
            "EventOverview.name",
            "EventSummary.name",
            "Fact.dissipation",
            "FieldDifference.field",
            "FigureFile.figure",
            "FigureFile.runs[]",
            "FirstDifference.field",
            "FileReading.unused[]",
            "FitReport.law",
            "FitReport.scenario",
            "InfoReport.library",
            "IntegratorError.fields[]",
            "KeyChange.after[]",
            "KeyChange.keys[]",
            "KeyDifference.key",
            "Lacking.figure",
            "Lacking.missing",
            "Lacking.run",
            "LawFit.law",
            "LawParameter.key",
            "LawReport.name",
            "LeftOut.figure",
            "LeftOut.run",
            "KeptParameter.name",
            "LawFit.reduces_to",
            "Match.key",
            "Note.parameters[]",
            "PresetReport.name",
            "Profile.parameter",
            "Residual.quantity",
            "Rival.law",
            "RunLoss.run",
            "RunReport.scenario",
            "RunSummary.stop_reason",
            "SetupDifferences.fields_only_in[][]",
            "SetupDifferences.topics_only_in[][]",
            "ShownRecording.name",
            "SignalReport.field",
            "SignalReport.source",
            "StatisticsFault.name",
            "Supplementary.entries[]",
            "Supplementary.name",
            "Supplementary.topic",
            "TopicBytes.topic",
            "VerifiedFile.repeated[]",
            "VerifiedFile.unknown[]",
            "VerifiedFile.without[]",
        ],
    ),
    (
        "paths",
        &[
            "ArchiveFault.file",
            "ArchiveReport.path",
            "ComparedRun.file",
            "FigureFile.path",
            "FileReading.file",
            "InfoReport.file",
            "ShownRecording.file",
            "SweepReport.parts",
            "VerifiedFile.file",
            "WrittenFile.path",
        ],
    ),
    (
        "units",
        &[
            "ColumnReading.unit",
            "Deviation.unit",
            "Estimate.unit",
            "FieldDifference.unit",
            "Finding.unit",
            "KeptParameter.unit",
            "KeyDifference.unit",
            "LawParameter.unit",
            "Match.unit",
            "Residual.unit",
            "SignalReport.unit",
        ],
    ),
    (
        "digests and versions",
        &[
            "RunReport.content_digest",
            "RunReport.scenario_digest",
            "VerifiedFile.recorded_by",
        ],
    ),
    (
        "values and texts as they stand in a file or a scenario",
        &[
            "Difference.recorded",
            "Difference.simulated",
            "Difference.time",
            "FirstDifference.a",
            "FirstDifference.b",
            "InfoReport.end[]",
            "InfoReport.run[]",
            "InfoReport.scenario",
            "KeyDifference.a",
            "KeyDifference.b",
            "PresetReport.scenario",
            "RunReport.changes[]",
        ],
    ),
    (
        "documentation, which is the same in all reports",
        &[
            "ChannelSchema.definition",
            "ChannelSchema.meaning",
            "LawParameter.allowed",
            "LawParameter.meaning",
            "LawReport.formula",
            "LawReport.source",
            "LawReport.typical",
            "PresetReport.description",
        ],
    ),
    (
        "labels and words that other members derive",
        &[
            "Chapter.heading",
            "Comparison.sentence",
            "DiffReport.notes[]",
            "EventOverview.description",
            "EventSummary.description",
            "ExplainReport.title",
            "FigureFile.title",
            "Finding.what",
            "FitReport.notes[]",
            "LawFit.failure",
            "Note.words",
        ],
    ),
    (
        "messages about what could not be read or computed, of which no member has the facts",
        &[
            "ComparedRun.losses[]",
            "ExplainReport.losses[]",
            "Failure.error",
            "FitReport.losses[]",
            "InfoReport.faults[]",
            "LeftOut.because",
            "LossReport.reason",
            "RowError.error",
            "RunLoss.loss",
            "ShownRecording.losses[]",
            "FaultKind.unreadable",
            "VerifiedFile.error",
        ],
    ),
];

/// Adds the members that are free strings, each behind the name of its type.
fn add_strings(node: &Value, owner: &str, member: &str, found: &mut BTreeSet<String>) {
    let Some(object) = node.as_object() else {
        return;
    };
    let is_string = match &object.get("type") {
        Some(Value::String(kind)) => kind == "string",
        Some(Value::Array(kinds)) => kinds.iter().any(|kind| kind == "string"),
        _ => false,
    };
    if is_string && !object.contains_key("const") && !object.contains_key("enum") {
        found.insert(format!("{owner}.{member}"));
    }
    for (key, value) in object {
        match (key.as_str(), value) {
            ("properties", Value::Object(members)) => {
                for (name, schema) in members {
                    add_strings(schema, owner, name, found);
                }
            }
            ("$defs", Value::Object(types)) => {
                for (name, schema) in types {
                    add_strings(schema, name, "", found);
                }
            }
            ("items" | "additionalProperties", element) => {
                add_strings(element, owner, &format!("{member}[]"), found);
            }
            ("oneOf" | "anyOf" | "allOf" | "prefixItems", Value::Array(schemas)) => {
                for schema in schemas {
                    add_strings(schema, owner, member, found);
                }
            }
            _ => {}
        }
    }
}

#[test]
fn strings_of_reports_are_names_values_or_derived() {
    let mut found = BTreeSet::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas");
    for file in fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let name = name.trim_start_matches("toprise.");
        let Some(report) = name.strip_suffix(".json").filter(|n| n.ends_with("Report")) else {
            continue;
        };
        let schema: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        add_strings(&schema, report, "", &mut found);
    }
    let mut allowed = BTreeSet::new();
    for (_, members) in ALLOWED {
        allowed.extend(members.iter().map(ToString::to_string));
    }
    let unlisted: Vec<_> = found.difference(&allowed).collect();
    let gone: Vec<_> = allowed.difference(&found).collect();
    assert!(
        unlisted.is_empty() && gone.is_empty(),
        "not listed: {unlisted:?}; no longer there: {gone:?}"
    );
}
