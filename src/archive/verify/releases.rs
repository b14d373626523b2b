//! The schemas of released versions.
//!
//! A recording of another version has descriptions that this version doesn't know. Those of a release are compared with
//! a table of digests, so that a forged unit or description is found for as long as recordings are verified.

use super::difference::Difference;
use crate::archive::format::{Entries, TELEMETRY, VERSION};
use crate::archive::recording::Recording;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::supplement::{Supplement, supplements};
use crate::telemetry::views::VIEW_CHANNELS;
use crate::telemetry::{channels, table};
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};

/// The releases, oldest first. A release is a line with its version and telemetry, and a line for each schema.
pub(super) const RELEASES: &str = include_str!("releases.txt");

/// First word of a release.
const RELEASE: &str = "release";

/// The schemas of a release: SHA-256 by name and encoding.
pub(super) struct KnownRelease<'t> {
    version: &'t str,
    schemas: BTreeMap<(&'t str, &'t str), &'t str>,
}

impl<'t> KnownRelease<'t> {
    /// Finds the release that made a recording, if its version is one of `table`.
    pub(super) fn find(table: &'t str, run: &Entries) -> Option<Self> {
        let (version, telemetry) = (run.get(VERSION)?, run.get(TELEMETRY)?);
        let mut lines = table.lines().map(words);
        let version = lines.find_map(|words| match words[..] {
            [RELEASE, name, "telemetry", number] if name == version && number == telemetry => {
                Some(name)
            }
            _ => None,
        })?;
        let mut schemas = BTreeMap::new();
        for words in lines {
            let [name, encoding, digest] = words[..] else {
                break;
            };
            schemas.insert((name, encoding), digest);
        }
        Some(Self { version, schemas })
    }

    /// The first channel or scenario whose words are not those of the release.
    pub(super) fn difference(&self, recording: &Recording) -> Option<Difference> {
        for channel in recording.channels() {
            let schema = channel.schema.as_deref();
            let (encoding, data) = schema.map_or(("", &[][..]), |s| (&s.encoding, &s.data));
            let found = describe(&digest(data), &channel.metadata);
            // Names have been compared with those of this version.
            let expected = self
                .schemas
                .get(&(channel.schema_name(), encoding))
                .map(|digest| describe(digest, &Entries::new()));
            if Some(&found) != expected.as_ref() {
                let field = format!("schema of toprise {}", self.version);
                return Some(Difference::new(
                    &channel.topic,
                    &field,
                    [Some(found), expected],
                ));
            }
        }
        added_line(recording)
    }
}

/// The entry of a version in the table of releases, with the schemas of this one. `release/prepare` adds it.
pub fn release_entry(version: &str) -> String {
    let mut schemas = BTreeSet::new();
    for channel in channels() {
        for encoding in Encoding::ALL {
            let digest = digest(&encoding.schema(channel));
            schemas.insert((channel.schema, encoding.schema_encoding(), digest));
        }
    }
    for Supplement { info, .. } in supplements() {
        let digest = digest(&Encoding::Json.schema(info));
        schemas.insert((info.schema, Encoding::Json.schema_encoding(), digest));
    }
    for view in VIEW_CHANNELS {
        let digest = digest(view.definition.as_bytes());
        schemas.insert((view.schema, "ros2msg", digest));
    }
    let mut text = format!("{RELEASE} {version} telemetry {}\n", table::VERSION);
    for (name, encoding, digest) in schemas {
        text += &format!("{name} {encoding} {digest}\n");
    }
    text
}

/// The words of a line; none if it is a comment.
fn words(line: &str) -> Vec<&str> {
    let text = line.split('#').next().unwrap_or_default();
    text.split_whitespace().collect()
}

fn digest(data: &[u8]) -> String {
    format!("{:x}", Sha256::digest(data))
}

/// The digest of a schema and the metadata of its channel, of which releases have none.
fn describe(digest: &str, metadata: &Entries) -> String {
    if metadata.is_empty() {
        format!("SHA-256 {digest}")
    } else {
        format!("SHA-256 {digest} and metadata {metadata:?}")
    }
}

/// The first line of the recorded scenario that toprise does not write, such as a comment. Releases write keys and
/// values only, and later ones may write further keys.
fn added_line(recording: &Recording) -> Option<Difference> {
    // Without a scenario there is nothing to run, and the comparison has ended before.
    let text = recording.scenario_text().ok()?;
    let scenario = recording.scenario().ok()?.to_toml();
    // Each search goes on after the line found before, so the order counts, too.
    let mut written = scenario.lines();
    let added = text.lines().find(|line| !written.any(|own| own == *line))?;
    let values = [Some(added.to_owned()), None];
    Some(Difference::new("scenario.toml", "line", values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::archive::format::end_entries;
    use crate::archive::verify::{Equality, Report, SchemaCheck, Verdict, verify_with};
    use crate::archive::writer::{ChunkWriter, Form, Header, RegisteredChannel, RunEncoder};
    use crate::run::scenario::{Preset, Scenario};
    use crate::telemetry::supplement::FIT_DATA;
    use crate::telemetry::{RunError, RunMessages, Topics};
    use std::fs;

    /// Whether recordings of a version are verified by all later ones.
    fn is_release(version: &str) -> bool {
        !version.starts_with("0.") && !version.contains('-')
    }

    /// The schemas of a release stay as they are. To change a description, set another version first:
    /// `release/version 1.0.1-dev`.
    #[test]
    fn regress_schemas_of_this_release() {
        let version = env!("CARGO_PKG_VERSION");
        assert_eq!(
            RELEASES.contains(&release_entry(version)),
            is_release(version),
            "{version} is released with other schemas, or release/prepare has not added it"
        );
    }

    #[test]
    fn releases_are_in_the_format_of_the_table() {
        for line in RELEASES
            .lines()
            .map(words)
            .filter(|words| !words.is_empty())
        {
            let is_right = match line[..] {
                [RELEASE, version, "telemetry", number] => {
                    is_release(version) && number.parse::<u32>().is_ok()
                }
                [_, "jsonschema" | "protobuf" | "ros2msg", digest] => digest.len() == 64,
                _ => false,
            };
            assert!(is_right, "{line:?}");
        }
    }

    /// Records a short run with a changed header.
    fn record(change: impl FnOnce(&mut Header)) -> Vec<u8> {
        let mut values = Preset::find("paper").unwrap().values().unwrap();
        values.set("stop.duration", "0.01").unwrap();
        let scenario = Scenario::new(values).unwrap();
        let mut run = RunMessages::new(&scenario, &Topics::All).unwrap();
        let mut header = Header::new(&scenario, run.telemetry(), Form::default());
        change(&mut header);
        let (mut chunks, ids) = ChunkWriter::open(Vec::new(), &header).unwrap();
        let mut encoder = RunEncoder::new(&header, &ids);
        while run
            .next(|message| {
                encoder.batch.clear();
                encoder.encode(message);
                chunks.write(&encoder.batch).unwrap();
                Ok::<(), RunError>(())
            })
            .is_some()
        {}
        chunks.finish(end_entries(&run.end())).unwrap().0
    }

    /// Verifies a recording with this version's schemas as those of a release 9.0.0.
    fn report(bytes: &[u8]) -> Report {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        fs::write(&path, bytes).unwrap();
        let releases = release_entry("8.0.0") + "# The next.\n" + &release_entry("9.0.0");
        verify_with(&Recording::open(&path).unwrap(), &releases, &|_| {}).unwrap()
    }

    fn claim_release(header: &mut Header) {
        header.run.insert(VERSION.to_owned(), "9.0.0".to_owned());
    }

    fn replace(bytes: &mut Vec<u8>, from: &str, to: &str) {
        let text = String::from_utf8(bytes.clone()).unwrap();
        assert!(text.contains(from), "{text}");
        *bytes = text.replacen(from, to, 1).into_bytes();
    }

    #[test]
    fn verifies_released_schemas() {
        let report = report(&record(claim_release));
        assert_eq!(report.verdict, Verdict::Verified, "{report:#?}");
        assert_eq!(report.equality, Some(Equality::SameValues));
        assert_eq!(report.schemas, Some(SchemaCheck::Released));
    }

    #[test]
    fn releases_have_the_schemas_of_supplements() {
        let data = Supplement::find(FIT_DATA).unwrap();
        for (is_forged, verdict) in [(false, Verdict::Verified), (true, Verdict::Different)] {
            let report = report(&record(|header| {
                claim_release(header);
                let mut channel = RegisteredChannel::supplement(data);
                if is_forged {
                    replace(&mut channel.schema, "measured", "invented");
                }
                header.channels.push(channel);
            }));
            assert_eq!(report.verdict, verdict, "{report:#?}");
        }
    }

    #[test]
    fn rejects_forged_words_of_releases() {
        type Forge = fn(&mut Header);
        let forgeries: [(&str, Forge, &str); 5] = [
            (
                "a unit",
                |header| replace(&mut header.channels[0].schema, "[rad/s]", "[deg/s]"),
                "/top/state",
            ),
            (
                "a schema without descriptions",
                |header| header.channels[5].schema = b"{}".to_vec(),
                "/top/energy",
            ),
            (
                "a definition of a view",
                |header| {
                    replace(
                        &mut header.channels.last_mut().unwrap().schema,
                        "uint8 level",
                        "int8 level",
                    );
                },
                "/log",
            ),
            (
                "a comment in the scenario",
                |header| header.scenario.data.to_mut().extend(b"# measured\n"),
                "scenario.toml",
            ),
            (
                "a comment after a key",
                |header| {
                    replace(
                        header.scenario.data.to_mut(),
                        "\nk = 0.03",
                        "\nk = 0.03 # measured",
                    );
                },
                "scenario.toml",
            ),
        ];
        for (name, forge, place) in forgeries {
            let report = report(&record(|header| {
                claim_release(header);
                forge(header);
            }));
            assert_eq!(report.verdict, Verdict::Different, "{name}: {report:#?}");
            assert_eq!(report.difference.unwrap().place, place, "{name}");
        }
    }

    #[test]
    fn reports_unreleased_versions_as_unknown() {
        for (key, value) in [(VERSION, "9.0.1"), (VERSION, "0.9.0"), (TELEMETRY, "1000")] {
            let report = report(&record(|header| {
                claim_release(header);
                header.run.insert(key.to_owned(), value.to_owned());
                header.channels[0].schema.push(b' ');
            }));
            assert_eq!(report.verdict, Verdict::Verified, "{report:#?}");
            assert_eq!(report.schemas, Some(SchemaCheck::Unknown), "{value}");
        }
    }
}
