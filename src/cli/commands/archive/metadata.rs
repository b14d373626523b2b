//! The metadata of an archive: RO-Crate 1.2 (Sefton et al. 2025, doi:10.5281/zenodo.13751027) with the profile Process Run
//! Crate 0.5 (Workflow Run RO-Crate working group, <https://w3id.org/ro/wfrun/process/0.5>).

use super::parts::{Archive, ArchiveFile, ArchivedRecording};
use crate::archive::format::VERSION;
use crate::archive::supplements::about::{About, Creator, Identifier, Text, pruned};
use crate::telemetry::Topics;
use serde_json::{Value, json};
use std::collections::BTreeSet;

const CONTEXT: &str = "https://w3id.org/ro/crate/1.2/context";
const SPECIFICATION: &str = "https://w3id.org/ro/crate/1.2";
const PROFILE: &str = "https://w3id.org/ro/wfrun/process/0.5";
/// Id of the program that made the archive.
pub(super) const MAKER: &str = "#maker";
/// Id of the action that made the archive.
const MAKING: &str = "#archive";

/// The text of `ro-crate-metadata.json`.
pub(super) fn json(archive: &Archive, files: &[ArchiveFile]) -> String {
    let about = &archive.about;
    let mut graph = vec![
        json!({
            "@id": "ro-crate-metadata.json",
            "@type": "CreativeWork",
            "conformsTo": { "@id": SPECIFICATION },
            "about": { "@id": "./" },
        }),
        root(archive, files),
        json!({ "@id": PROFILE, "@type": ["CreativeWork", "Profile"], "name": "Process Run Crate", "version": "0.5" }),
        json!({
            "@id": about.licence.address(),
            "@type": "CreativeWork",
            "name": about.licence.name,
            "identifier": about.licence.id,
        }),
    ];
    graph.extend(organisations(about));
    let creators = about.creators.iter().enumerate();
    graph.extend(creators.map(|(place, creator)| person(place, creator)));
    graph.extend(about.related.iter().map(|related| {
        json!({ "@id": address(&related.id), "@type": "CreativeWork", "name": address(&related.id) })
    }));
    graph.extend(versions(archive).iter().map(|version| software(version)));
    graph.push(maker(archive));
    graph.extend(archive.recordings.iter().map(|run| action(archive, run)));
    graph.push(making(archive, files));
    graph.extend(files.iter().map(data_entity));
    // One work may be related in two ways, and one person named twice.
    let mut ids = BTreeSet::new();
    graph.retain(|entity| ids.insert(entity["@id"].to_string()));
    let crate_ = pruned(json!({ "@context": CONTEXT, "@graph": graph }));
    format!("{crate_:#}\n")
}

/// References to entities: RO-Crate asks for a list only of several.
fn references(ids: impl IntoIterator<Item = String>) -> Value {
    let mut all: Vec<Value> = ids.into_iter().map(reference).collect();
    match all.as_mut_slice() {
        [one] => one.take(),
        _ => all.into(),
    }
}

fn reference(id: impl Into<Value>) -> Value {
    json!({ "@id": id.into() })
}

/// The path of a file as the address that it is in JSON-LD.
fn id_of(file: &str) -> String {
    let mut id = String::new();
    for byte in file.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                id.push(byte as char);
            }
            _ => id.push_str(&format!("%{byte:02X}")),
        }
    }
    id
}

/// The archive as a whole.
fn root(archive: &Archive, files: &[ArchiveFile]) -> Value {
    let about = &archive.about;
    let description = about.description.as_ref().unwrap_or(&about.title);
    let runs = archive.recordings.iter().map(action_id);
    let keywords: Vec<&str> = about.keywords.iter().map(Text::as_str).collect();
    let funders = (0..about.funders.len()).map(|place| format!("#funder-{place}"));
    json!({
        "@id": "./",
        "@type": "Dataset",
        "name": about.title.as_str(),
        "description": description.as_str(),
        "datePublished": about.date.to_string(),
        "license": reference(about.licence.address()),
        "conformsTo": reference(PROFILE),
        "author": references(creator_ids(about)),
        "mentions": references(runs.chain([MAKING.to_owned()])),
        "hasPart": references(files.iter().map(|file| id_of(&file.name))),
        "identifier": about.doi.as_ref().map(|doi| format!("https://doi.org/{}", doi.as_str())),
        "keywords": (!keywords.is_empty()).then(|| keywords.join(", ")),
        "publisher": about.publisher.as_ref().map(|_| reference("#publisher")),
        "funder": references(funders),
        "citation": references(about.related.iter().map(|related| address(&related.id))),
    })
}

/// The address of a related work.
fn address(id: &Identifier) -> String {
    match id {
        Identifier::Doi(doi) => format!("https://doi.org/{}", doi.as_str()),
        Identifier::Arxiv(number) => {
            format!(
                "https://arxiv.org/abs/{}",
                number.trim_start_matches("arXiv:")
            )
        }
        Identifier::Url(address) => address.clone(),
    }
}

/// Publisher, funders and affiliations.
fn organisations(about: &About) -> Vec<Value> {
    let mut found = Vec::new();
    if let Some(publisher) = &about.publisher {
        found.push(organisation("#publisher", publisher));
    }
    for (place, funder) in about.funders.iter().enumerate() {
        let mut entity = organisation(&format!("#funder-{place}"), &funder.name);
        let award = funder.award.as_ref();
        entity["description"] = json!(award.map(|award| format!("Grant {}", award.as_str())));
        found.push(entity);
    }
    for (place, creator) in about.creators.iter().enumerate() {
        if let Some(affiliation) = &creator.affiliation {
            found.push(organisation(&format!("#affiliation-{place}"), affiliation));
        }
    }
    found
}

fn organisation(id: &str, name: &Text) -> Value {
    json!({ "@id": id, "@type": "Organization", "name": name.as_str() })
}

fn creator_ids(about: &About) -> impl Iterator<Item = String> {
    let creators = about.creators.iter().enumerate();
    creators.map(|(place, creator)| creator_id(place, creator))
}

fn creator_id(place: usize, creator: &Creator) -> String {
    match &creator.orcid {
        Some(orcid) => format!("https://orcid.org/{}", orcid.as_str()),
        None => format!("#creator-{place}"),
    }
}

fn person(place: usize, creator: &Creator) -> Value {
    let kind = if creator.is_person() {
        "Person"
    } else {
        "Organization"
    };
    let affiliation = creator.affiliation.as_ref();
    json!({
        "@id": creator_id(place, creator),
        "@type": kind,
        "name": creator.name.as_str(),
        "affiliation": affiliation.map(|_| reference(format!("#affiliation-{place}"))),
    })
}

/// The versions of toprise that recorded the runs.
fn versions(archive: &Archive) -> BTreeSet<String> {
    archive.recordings.iter().map(version_of).collect()
}

fn version_of(run: &ArchivedRecording) -> String {
    let version = run.recording.run().and_then(|entries| entries.get(VERSION));
    version.cloned().unwrap_or_default()
}

fn software_id(version: &str) -> String {
    format!("#toprise-{version}")
}

fn software(version: &str) -> Value {
    json!({
        "@id": software_id(version),
        "@type": "SoftwareApplication",
        "name": "toprise",
        "version": version,
        "softwareVersion": version,
        "url": "https://crates.io/crates/toprise",
    })
}

/// The build that made the archive.
fn maker(archive: &Archive) -> Value {
    let mut entity = software(&archive.maker.version);
    entity["@id"] = MAKER.into();
    let commit = archive.maker.commit.as_ref();
    entity["identifier"] = json!(commit.map(|commit| format!("commit {commit}")));
    entity
}

fn action_id(run: &ArchivedRecording) -> String {
    format!("#run-{}", id_of(&run.name))
}

/// The run of a scenario.
fn action(archive: &Archive, run: &ArchivedRecording) -> Value {
    let command = command(run);
    let mut entity = create_action(archive, &action_id(run), &command);
    entity["instrument"] = reference(software_id(&version_of(run)));
    entity["object"] = reference(id_of(&run.scenario_path()));
    entity["result"] = reference(id_of(&run.path()));
    entity
}

/// A path as a word of a shell. Names in archives have no quotes of their own.
fn quoted(path: String) -> String {
    let mut bytes = path.bytes();
    if bytes.all(|byte| byte.is_ascii_alphanumeric() || b"-._/".contains(&byte)) {
        path
    } else {
        format!("'{path}'")
    }
}

/// The command that records the run; what else the recording holds doesn't come from it.
fn command(run: &ArchivedRecording) -> String {
    let mut words = vec![
        "toprise".to_owned(),
        "run".to_owned(),
        quoted(run.scenario_path()),
    ];
    words.extend(["-o".to_owned(), quoted(run.path())]);
    if let Some((form, topics)) = run.recording.form() {
        words.extend(["--encoding".to_owned(), form.encoding.name().to_owned()]);
        if !form.views {
            words.push("--no-views".to_owned());
        }
        if let Topics::Only(topics) = topics {
            let names: Vec<&str> = topics.iter().map(|topic| topic.name()).collect();
            words.extend(["--topics".to_owned(), names.join(",")]);
        }
    }
    words.join(" ")
}

/// The making of reports and figures.
fn making(archive: &Archive, files: &[ArchiveFile]) -> Value {
    let recordings = archive.recordings.iter();
    let is_made = |file: &&ArchiveFile| {
        let mut folders = ["reports/", "figures/"].iter();
        folders.any(|folder| file.name.starts_with(folder))
    };
    let made = files.iter().filter(is_made);
    let mut entity = create_action(archive, MAKING, "toprise archive");
    entity["instrument"] = reference(MAKER);
    entity["object"] = references(recordings.map(|run| id_of(&run.path())));
    entity["result"] = references(made.map(|file| id_of(&file.name)));
    entity
}

fn create_action(archive: &Archive, id: &str, command: &str) -> Value {
    let about = &archive.about;
    json!({
        "@id": id,
        "@type": "CreateAction",
        "name": command,
        "description": command,
        "agent": about.creators.first().map(|creator| reference(creator_id(0, creator))),
        "actionStatus": "http://schema.org/CompletedActionStatus",
    })
}

fn data_entity(file: &ArchiveFile) -> Value {
    json!({
        "@id": id_of(&file.name),
        "@type": "File",
        "name": file.name,
        "description": file.meaning,
        "encodingFormat": file.media_type,
        "contentSize": file.bytes.to_string(),
        "sha256": file.sha256,
    })
}
