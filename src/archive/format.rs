//! The recording format: names and contents of MCAP records, shared by writer and readers.
//!
//! A recording holds, in this order: the metadata record [`RUN_RECORD`] and the scenario as an attachment; the
//! schemas and channels; the messages; the metadata record [`END_RECORD`]. A file without the last was
//! interrupted. Nothing in a recording depends on when or where it was made.
//!
//! In addition to the table's channels there are channels for viewers ([`crate::telemetry::views`]), which are not part
//! of the content digest. Names that begin with [`RESERVED_PREFIX`], that of the scenario's attachment and the topics of
//! the table and of the views are reserved; everything else in a recording is a supplement
//! ([`crate::archive::supplements`]).

use crate::run::outcome::Outcome;
use crate::run::scenario::Scenario;
use crate::run::simulation::RunEnd;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::fields::EVENTS;
use crate::telemetry::table;
use crate::telemetry::{Topic, Topics};
use mcap::Attachment;
use std::collections::BTreeMap;

/// Name of the metadata record at the start: identifies the run.
pub const RUN_RECORD: &str = "toprise.run";
/// Name of the metadata record at the end: end of the run and content digest.
pub const END_RECORD: &str = "toprise.end";
/// Name of the attachment that holds the scenario as TOML.
pub const SCENARIO_ATTACHMENT: &str = "scenario.toml";

/// Prefix of the names of metadata records, attachments and message types that belong to a run.
pub const RESERVED_PREFIX: &str = "toprise.";

/// Prefix of the library field of recordings; the version follows.
pub const LIBRARY_PREFIX: &str = "toprise/";
/// The library field of the recordings that this version writes.
pub const LIBRARY: &str = concat!("toprise/", env!("CARGO_PKG_VERSION"));

/// Key of [`RUN_RECORD`]: the version of toprise that simulated the run.
pub const VERSION: &str = "version";
/// Key of [`RUN_RECORD`]: the version of the telemetry, [`table::VERSION`].
pub const TELEMETRY: &str = "telemetry";
/// Key of [`RUN_RECORD`]: the encoding of the table's channels.
pub const ENCODING: &str = "encoding";
/// Key of [`RUN_RECORD`]: whether there are channels for viewers, `yes` or `no`.
pub const VIEWS: &str = "views";
/// Key of [`RUN_RECORD`]: the topics of the table that are recorded, separated by commas, or `all`.
pub const TOPICS: &str = "topics";
/// Key of [`RUN_RECORD`]: the digest of the scenario.
pub const SCENARIO_DIGEST: &str = "scenario_digest";
/// Key of [`RUN_RECORD`]: the time between samples, ns.
pub const SAMPLE_PERIOD: &str = "sample_period_ns";
/// Key of [`END_RECORD`]: why the run ended.
pub const STOP_REASON: &str = "stop_reason";
/// Key of [`END_RECORD`]: when the run ended, s.
pub const STOP_TIME: &str = "stop_time";
/// Key of [`END_RECORD`]: the time at which the axis of a tippe top passed the horizontal, s; absent if it did not.
pub const INVERSION_TIME: &str = "inversion_time";
/// Key of [`END_RECORD`]: number of samples.
pub const SAMPLE_COUNT: &str = "samples";
/// Key of [`END_RECORD`]: number of events.
pub const EVENT_COUNT: &str = "events";
/// Key of [`END_RECORD`]: number of nutation cycles.
pub const NUTATION_COUNT: &str = "nutations";
/// Key of [`END_RECORD`]: how many steps the integrator took.
pub const STEPS: &str = "steps_accepted";
/// Key of [`END_RECORD`]: the digest of all messages of the table's channels.
pub const CONTENT_DIGEST: &str = "content_digest";
/// Topics and fields of words that earlier versions recorded; they have no values.
pub(crate) const FORMER_WORDS: [(Topic, &str); 1] = [(EVENTS, "description")];
/// The value of [`TOPICS`] for all topics of the table.
const ALL_TOPICS: &str = "all";

/// Format options of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// The encoding of the table's channels.
    pub encoding: Encoding,
    /// Whether view channels are written.
    pub views: bool,
}

impl Default for Form {
    /// JSON, with views.
    fn default() -> Self {
        Self {
            encoding: Encoding::Json,
            views: true,
        }
    }
}

/// Entries of a metadata record.
pub type Entries = BTreeMap<String, String>;

/// Whether a metadata record or a message type of this name belongs to a run.
pub fn is_reserved(name: &str) -> bool {
    name.starts_with(RESERVED_PREFIX)
}

/// Whether an attachment of this name belongs to a run.
pub fn is_reserved_attachment(name: &str) -> bool {
    name == SCENARIO_ATTACHMENT || is_reserved(name)
}

/// The attachment that holds a scenario.
pub fn scenario_attachment(toml: String) -> Attachment<'static> {
    Attachment {
        log_time: 0,
        create_time: 0,
        name: SCENARIO_ATTACHMENT.to_owned(),
        media_type: "application/toml".to_owned(),
        data: toml.into_bytes().into(),
    }
}

/// The entries of [`RUN_RECORD`] that identify the run.
pub fn run_entries(scenario: &Scenario) -> Entries {
    entries([
        (VERSION, env!("CARGO_PKG_VERSION").to_owned()),
        (TELEMETRY, table::VERSION.to_string()),
        ("scenario", scenario.name().to_owned()),
        (SCENARIO_DIGEST, scenario.digest()),
        ("formulation", scenario.word("formulation").to_owned()),
        ("friction_law", scenario.word("friction.law").to_owned()),
        (SAMPLE_PERIOD, scenario.sample_period_ns.to_string()),
        ("epoch", "simulation start".to_owned()),
    ])
}

/// The entries of [`RUN_RECORD`] for form and topics. Together with the scenario they determine every byte
/// of the file.
pub fn form_entries(form: Form, topics: &Topics) -> Entries {
    let topics = match topics {
        Topics::All => ALL_TOPICS.to_owned(),
        Topics::Only(topics) => {
            let names: Vec<_> = topics.iter().map(|topic| topic.name()).collect();
            names.join(",")
        }
    };
    let views = if form.views { "yes" } else { "no" };
    entries([
        (ENCODING, form.encoding.name().to_owned()),
        (VIEWS, views.to_owned()),
        (TOPICS, topics),
    ])
}

/// Form and topics from the entries of [`RUN_RECORD`]; `None` if they are missing.
pub fn recorded_form(run: &Entries) -> Option<(Form, Topics)> {
    let topics = match run.get(TOPICS)?.as_str() {
        ALL_TOPICS => Topics::All,
        "" => Topics::Only(Vec::new()),
        names => Topics::named(&names.split(',').collect::<Vec<_>>()).ok()?,
    };
    let views = match run.get(VIEWS)?.as_str() {
        "yes" => true,
        "no" => false,
        _ => return None,
    };
    let encoding = Encoding::find(run.get(ENCODING)?)?;
    Some((Form { encoding, views }, topics))
}

/// The entries of [`END_RECORD`], except the content digest.
pub fn end_entries(end: &RunEnd) -> Entries {
    let statistics = &end.statistics;
    let mut all = entries([
        (STOP_REASON, end.stop.name().to_owned()),
        // `{:?}` has the digits from which the same number follows.
        (STOP_TIME, format!("{:?}", end.time)),
        (SAMPLE_COUNT, end.samples.to_string()),
        (EVENT_COUNT, end.events.to_string()),
        (NUTATION_COUNT, end.nutations.to_string()),
        (STEPS, statistics.accepted.to_string()),
        ("steps_rejected", statistics.rejected.to_string()),
        ("evaluations", statistics.evaluations.to_string()),
        ("smallest_step", format!("{:?}", statistics.smallest_step)),
        ("largest_step", format!("{:?}", statistics.largest_step)),
    ]);
    if let Some(time) = end.inversion_time {
        all.insert(INVERSION_TIME.to_owned(), format!("{time:?}"));
    }
    all
}

/// Whether an end record agrees with an outcome.
pub fn is_end_of(end: &Entries, outcome: &Outcome) -> bool {
    // The steps differ wherever the motion does.
    [
        (STOP_REASON, outcome.end.stop.name().to_owned()),
        (STOP_TIME, format!("{:?}", outcome.end.time)),
        (STEPS, outcome.end.statistics.accepted.to_string()),
    ]
    .iter()
    .all(|(key, value)| end.get(*key) == Some(value))
}

fn entries<const N: usize>(entries: [(&str, String); N]) -> Entries {
    entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
}
