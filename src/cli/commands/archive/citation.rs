//! How an archive is cited: the Citation File Format 1.2.0 (Druskat et al. 2021, doi:10.5281/zenodo.5171937), and the
//! metadata of a deposit at Zenodo.

use crate::archive::supplements::about::{
    About, Creator, Doi, Identifier, Orcid, Related, Text, pruned,
};
use serde_json::{Value, json};

/// The text of `CITATION.cff`.
pub(super) fn cff(about: &About) -> String {
    let mut lines = vec![
        "cff-version: 1.2.0".to_owned(),
        "message: If you use these recordings, please cite them as below.".to_owned(),
        "type: dataset".to_owned(),
        format!("title: {}", quoted(about.title.as_str())),
        format!("license: {}", about.licence.id),
        format!("date-released: {}", about.date),
    ];
    if let Some(text) = &about.description {
        lines.push(format!("abstract: {}", quoted(text.as_str())));
    }
    if let Some(doi) = &about.doi {
        lines.push(format!("doi: {}", quoted(doi.as_str())));
    }
    lines.push("authors:".to_owned());
    lines.extend(about.creators.iter().flat_map(author));
    if !about.keywords.is_empty() {
        lines.push("keywords:".to_owned());
        let keywords = about.keywords.iter();
        lines.extend(keywords.map(|keyword| format!("  - {}", quoted(keyword.as_str()))));
    }
    lines.join("\n") + "\n"
}

/// A string of JSON is one of YAML.
fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

fn author(creator: &Creator) -> Vec<String> {
    let mut properties = Vec::new();
    let name = creator.name.as_str();
    match name.split_once(", ") {
        Some((family, given)) => {
            properties.push(format!("family-names: {}", quoted(family)));
            properties.push(format!("given-names: {}", quoted(given)));
        }
        None if creator.is_person() => properties.push(format!("family-names: {}", quoted(name))),
        None => properties.push(format!("name: {}", quoted(name))),
    }
    if let Some(orcid) = &creator.orcid {
        properties.push(format!("orcid: \"https://orcid.org/{}\"", orcid.as_str()));
    }
    if let (Some(affiliation), true) = (&creator.affiliation, creator.is_person()) {
        properties.push(format!("affiliation: {}", quoted(affiliation.as_str())));
    }
    let lines = properties.into_iter().enumerate();
    lines
        .map(|(place, property)| format!("  {} {property}", if place == 0 { "-" } else { " " }))
        .collect()
}

/// The content of `.zenodo.json`.
pub(super) fn zenodo(about: &About) -> Value {
    let description = about.description.as_ref().unwrap_or(&about.title);
    pruned(json!({
        "title": about.title.as_str(),
        "upload_type": "dataset",
        "access_right": "open",
        "description": html(description.as_str()),
        "creators": about.creators.iter().map(zenodo_creator).collect::<Vec<_>>(),
        "license": about.licence.id.to_lowercase(),
        "publication_date": about.date.to_string(),
        "doi": about.doi.as_ref().map(Doi::as_str),
        "keywords": about.keywords.iter().map(Text::as_str).collect::<Vec<_>>(),
        "related_identifiers": about.related.iter().map(zenodo_related).collect::<Vec<_>>(),
    }))
}

/// Zenodo takes descriptions as HTML.
fn html(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

fn zenodo_creator(creator: &Creator) -> Value {
    json!({
        "name": creator.name.as_str(),
        "affiliation": creator.affiliation.as_ref().map(Text::as_str),
        "orcid": creator.orcid.as_ref().map(Orcid::as_str),
    })
}

/// Zenodo begins the relations of `DataCite` with small letters.
fn zenodo_related(related: &Related) -> Value {
    let (first, rest) = related.relation.as_str().split_at(1);
    let id = match &related.id {
        Identifier::Doi(doi) => doi.as_str(),
        Identifier::Arxiv(text) | Identifier::Url(text) => text,
    };
    json!({ "identifier": id, "relation": first.to_lowercase() + rest })
}
