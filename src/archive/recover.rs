//! What can be saved of an interrupted or damaged recording.

use crate::archive::container_check::is_sound_container;
use crate::archive::convert::{Copier, attachments, metadata_but, raw, wanted};
use crate::archive::format::{
    CONTENT_DIGEST, COUNTS, ENCODING, END_RECORD, LIBRARY, LIBRARY_PREFIX, LOST,
    ORIGINAL_CONTENT_DIGEST, RECOVERY_RECORD, RUN_RECORD, SCENARIO_ATTACHMENT, SCENARIO_DIGEST,
    STOP_REASON, STOP_TIME, TELEMETRY, VERSION, run_entries,
};
use crate::archive::publish::{Draft, Existing, refuse_inputs};
use crate::archive::recording::{
    Any, Condition, Entries, Loss, NoScenario, Recording, RecordingError, Selection,
};
use crate::archive::sink::{RecordError, Sink, SinkError};
use crate::archive::writer::{Archived, Ending, McapSink, Opening};
use crate::telemetry::channels;
use crate::telemetry::digest::ContentDigest;
use crate::telemetry::encoding::Encoding;
use std::ffi::OsStr;
use std::path::Path;
use thiserror::Error;

/// Why a recording can't be recovered.
#[derive(Debug, Error)]
pub enum RecoverError {
    /// The file was written by another program.
    #[error(
        "it is not a toprise recording, but written by {library:?}: `mcap recover` may save it"
    )]
    Foreign {
        /// What wrote it.
        library: String,
    },
    /// Nothing is wrong with the recording.
    #[error("it is complete and readable throughout: there is nothing to recover")]
    Whole,
    /// Not a single channel can be read.
    #[error("nothing can be saved: no description of its channels is readable{}", scenario_hint(*has_scenario))]
    Nothing {
        /// Whether its scenario is.
        has_scenario: bool,
    },
    /// Without its scenario the run can't be simulated again.
    #[error(transparent)]
    Scenario(#[from] NoScenario),
    /// The simulation gives other numbers than the recording has.
    #[error("the simulation gives another run than the one recorded: {0}")]
    Different(String),
    /// The simulation or the writing failed.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The recording is of a newer version.
    #[error(transparent)]
    Newer(#[from] RecordingError),
    /// The result can't be written.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

fn scenario_hint(has_scenario: bool) -> &'static str {
    if has_scenario {
        "; its scenario is, so --complete can simulate the run again"
    } else {
        ""
    }
}

/// What was saved, and what was not.
#[derive(Debug)]
pub struct Recovered {
    /// The new recording.
    pub archived: Archived,
    /// Messages in it.
    pub messages: u64,
    /// Messages that could not be decoded.
    pub undecodable: u64,
    /// Parts of the file that could not be read.
    pub losses: Vec<Loss>,
    /// What is lost, in a sentence; none if all the content is there.
    pub lost: Option<String>,
}

/// Writes everything of `recording` that can be read to `path`, as a well-formed recording that says
/// what was lost.
///
/// # Errors
/// [`RecoverError`]; nothing is left at `path` then.
pub fn recover(
    recording: &Recording,
    path: &Path,
    existing: Existing,
    progress: &dyn Fn(u64),
) -> Result<Recovered, RecoverError> {
    recover_doubting(recording, path, existing, None, progress)
}

/// Recovers a recording as [`recover`] does, of which it is known that something doesn't belong together: the
/// `doubt` is counted among what is lost.
///
/// # Errors
/// [`RecoverError`]; nothing is left at `path` then.
pub fn recover_doubting(
    recording: &Recording,
    path: &Path,
    existing: Existing,
    doubt: Option<&str>,
    progress: &dyn Fn(u64),
) -> Result<Recovered, RecoverError> {
    refuse_inputs(path, [recording.path()])?;
    if recording.condition() == Condition::Foreign {
        return Err(RecoverError::Foreign {
            library: recording.library().to_owned(),
        });
    }
    recording.refuse_newer()?;
    if !recording
        .channels()
        .iter()
        .any(|channel| channel.table.is_some())
    {
        return Err(RecoverError::Nothing {
            has_scenario: recording.scenario().is_ok(),
        });
    }
    let mut sink = McapSink::open(Draft::new(path, existing)?, &opening(recording))?;
    let saved = Saved {
        doubt: doubt.map(str::to_owned),
        ..salvage(recording, &mut sink, progress)?
    };
    if saved.is_whole(recording) && !is_partial(recording.path()) {
        return Err(RecoverError::Whole);
    }
    let lost = saved.lost(recording);
    let archived = sink.finish_with(ending(recording, &saved, lost.as_deref()))?;
    Ok(Recovered {
        archived,
        messages: saved.counts.iter().sum(),
        undecodable: saved.undecodable,
        losses: saved.losses,
        lost,
    })
}

/// Whether a complete recording has only not got its name: its run was cut off at the very end.
fn is_partial(path: &Path) -> bool {
    path.extension() == Some(OsStr::new("partial"))
}

fn opening(recording: &Recording) -> Opening {
    let run = run_record(recording).map(|entries| (RUN_RECORD.to_owned(), entries));
    let others = metadata_but(recording, &[RUN_RECORD, END_RECORD, RECOVERY_RECORD]);
    let metadata = run.into_iter().chain(others).collect();
    // The first scenario is the one that counts.
    let mut has_scenario = false;
    let is_wanted = |attachment: &mcap::Attachment<'_>| {
        attachment.name != SCENARIO_ATTACHMENT || !std::mem::replace(&mut has_scenario, true)
    };
    let attachments = attachments(recording).filter_map(Result::ok);
    Opening {
        library: LIBRARY,
        metadata,
        attachments: attachments.filter(is_wanted).collect(),
        version: recording.version().unwrap_or_default(),
        encoding: encoding(recording),
        wanted: wanted(recording),
        raw: raw(recording),
    }
}

/// The record of the run, written again from the scenario if it is lost or doesn't fit it; what it says of the form is what
/// is written.
fn run_record(recording: &Recording) -> Option<Entries> {
    let noted = recording.run().cloned();
    let Ok(scenario) = recording.scenario() else {
        return noted;
    };
    let mut entries = run_entries(&scenario);
    let version = recording.version().unwrap_or_default();
    let digest = entries.get(SCENARIO_DIGEST);
    if let Some(noted) = noted.filter(|noted| noted.get(SCENARIO_DIGEST) == digest) {
        entries = noted;
    } else if let Some(version) = recording.library().strip_prefix(LIBRARY_PREFIX) {
        entries.insert(VERSION.to_owned(), version.to_owned());
    }
    // The first version didn't say which it was, nor in which form it recorded.
    if version.number() == 1 {
        entries.remove(TELEMETRY);
    } else {
        entries.insert(TELEMETRY.to_owned(), version.number().to_string());
        entries.extend(recording.form_entries().unwrap_or_default());
        entries.insert(ENCODING.to_owned(), encoding(recording).name().to_owned());
    }
    Some(entries)
}

/// The encoding of what is saved.
fn encoding(recording: &Recording) -> Encoding {
    recording.encoding().unwrap_or(Encoding::Json)
}

/// What was found.
struct Saved {
    /// Messages on each channel of the table.
    counts: Vec<u64>,
    undecodable: u64,
    /// Messages that stand behind later ones of their channel, as those of a chunk that is repeated.
    repeated: u64,
    last_ns: u64,
    losses: Vec<Loss>,
    digest: String,
    /// What doesn't belong together, if that is known.
    doubt: Option<String>,
}

fn salvage(
    recording: &Recording,
    sink: &mut McapSink,
    progress: &dyn Fn(u64),
) -> Result<Saved, SinkError> {
    let copier = Copier::new(recording);
    let mut digest = ContentDigest::default();
    let mut version = recording.version().unwrap_or_default();
    let mut counts = vec![0; channels().len()];
    let (mut undecodable, mut last_ns) = (0, 0);
    let mut reader = recording.reader(Selection::default()).in_order_of_time();
    while let Some(message) = reader.next_of_any() {
        match message {
            Ok(Any::Decoded(message)) => {
                let narrowed = version.narrowed(&message);
                // It lacks numbers that its version has.
                if narrowed.numbers.iter().any(|n| !n.is_finite()) {
                    undecodable += 1;
                    continue;
                }
                sink.write(&message)?;
                digest.update(&narrowed);
                counts[message.channel] += 1;
                last_ns = message.time_ns;
            }
            Ok(Any::Other(other)) => copier.copy(&other, sink)?,
            Err(_) => undecodable += 1,
        }
        progress(reader.progress());
    }
    let mut losses = recording.losses().to_vec();
    losses.extend_from_slice(reader.losses());
    Ok(Saved {
        counts,
        undecodable,
        repeated: reader.left_out().map_or(0, |misplaced| misplaced.messages),
        last_ns,
        losses,
        digest: digest.finish(),
        doubt: None,
    })
}

impl Saved {
    /// Whether all content is there, as the end record proves.
    fn has_all(&self, recording: &Recording) -> bool {
        let noted = recording.end().and_then(|end| end.get(CONTENT_DIGEST));
        noted == Some(&self.digest)
    }

    /// Whether the recording needs no saving.
    fn is_whole(&self, recording: &Recording) -> bool {
        recording.condition() == Condition::Whole
            && self.lost(recording).is_none()
            && self.repeated == 0
            && is_sound_container(recording)
    }

    /// What is lost, in a sentence.
    fn lost(&self, recording: &Recording) -> Option<String> {
        let mut parts: Vec<String> = Vec::new();
        if recording.scenario_text().is_err() {
            parts.push("the scenario".to_owned());
        }
        for damaged in attachments(recording).filter_map(Result::err) {
            parts.push(damaged.to_string());
        }
        if self.has_all(recording) {
            if self.losses.is_empty() && !recording.data_checksum_is_right() {
                let doubt = "perhaps some of the metadata: the checksum of the data is wrong";
                parts.push(doubt.to_owned());
            }
        } else {
            self.name_lost_messages(recording, &mut parts);
        }
        parts.extend(self.doubt.clone());
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    fn name_lost_messages(&self, recording: &Recording, parts: &mut Vec<String>) {
        let before = parts.len();
        for loss in &self.losses {
            parts.extend(loss.span.map(|span| format!("messages {span}")));
        }
        if self.undecodable > 0 {
            parts.push(format!(
                "{} messages that can't be decoded",
                self.undecodable
            ));
        }
        if self.repeated > 0 {
            let repeated = self.repeated;
            parts.push(format!(
                "{repeated} messages that come twice or out of order"
            ));
        }
        if recording.end().is_none() {
            parts.push(format!(
                "the end of the run after {} s",
                self.last_ns as f64 / 1e9
            ));
        }
        if parts.len() == before {
            parts.push("some of the messages: the content digest is another one".to_owned());
        }
    }
}

fn ending(recording: &Recording, saved: &Saved, lost: Option<&str>) -> Ending {
    let Some(lost) = lost else {
        let end = recording.end().cloned().unwrap_or_default();
        return Ending {
            end: Some(end),
            ..Ending::default()
        };
    };
    let original = recording.end().cloned();
    let mut recovery = Entries::from([(LOST.to_owned(), lost.to_owned())]);
    if let Some(digest) = original.as_ref().and_then(|end| end.get(CONTENT_DIGEST)) {
        recovery.insert(ORIGINAL_CONTENT_DIGEST.to_owned(), digest.clone());
    }
    let mut end = original.unwrap_or_else(|| {
        Entries::from([
            (STOP_REASON.to_owned(), "interrupted".to_owned()),
            (
                STOP_TIME.to_owned(),
                format!("{:?}", saved.last_ns as f64 / 1e9),
            ),
        ])
    });
    for (key, topic) in COUNTS {
        end.insert(key.to_owned(), saved.counts[topic.index()].to_string());
    }
    Ending {
        metadata: vec![(RECOVERY_RECORD.to_owned(), recovery)],
        end: Some(end),
        digest: None,
    }
}
