//! The metadata record in `DataCite`'s words.

use super::{About, Creator, Doi, Identifier, Related, Text};
use crate::archive::format::Entries;
use serde_json::{Map, Value, json};

/// Name of the metadata record. Each of its values is the JSON of the property of `DataCite` that its key names.
pub const RECORD: &str = "datacite";

/// The schema that the record follows.
const SCHEMA: &str = "http://datacite.org/schema/kernel-4";

impl About {
    /// The entries of [`RECORD`].
    pub fn to_entries(&self) -> Entries {
        let entries = self.to_datacite().into_iter();
        entries
            .map(|(key, value)| (key, value.to_string()))
            .collect()
    }

    /// What the entries of [`RECORD`] say, if they are as [`Self::to_entries`] writes them.
    pub fn from_entries(entries: &Entries) -> Option<Self> {
        let mut properties = Map::new();
        for (key, text) in entries {
            properties.insert(key.clone(), serde_json::from_str(text).ok()?);
        }
        let about = Self::from_datacite(&properties.into())?;
        (about.to_entries() == *entries).then_some(about)
    }

    /// What `DataCite`'s JSON says, as far as toprise writes it.
    pub fn from_datacite(datacite: &Value) -> Option<Self> {
        let list = |name: &str, to_about: fn(&Value) -> Value| -> Value {
            let items = datacite[name].as_array();
            items.into_iter().flatten().map(to_about).collect()
        };
        let about = json!({
            "title": datacite["titles"][0]["title"],
            "creators": list("creators", |creator| json!({
                "name": creator["name"],
                "orcid": creator["nameIdentifiers"][0]["nameIdentifier"],
                "affiliation": creator["affiliation"][0]["name"],
            })),
            "licence": datacite["rightsList"][0]["rightsIdentifier"],
            "date": datacite["dates"][0]["date"],
            "description": datacite["descriptions"][0]["description"],
            "doi": datacite["doi"],
            "publisher": datacite["publisher"]["name"],
            "keywords": list("subjects", |subject| subject["subject"].clone()),
            "funders": list("fundingReferences", |funder| json!({
                "name": funder["funderName"],
                "award": funder["awardNumber"],
            })),
            "related": list("relatedIdentifiers", |related| json!({
                "relation": related["relationType"],
                "id": related["relatedIdentifier"],
            })),
        });
        serde_json::from_value(about).ok()
    }

    /// The properties of `DataCite`'s JSON.
    pub fn to_datacite(&self) -> Map<String, Value> {
        let properties = json!({
            "creators": self.creators.iter().map(creator).collect::<Vec<_>>(),
            "titles": [{ "title": self.title.as_str() }],
            "publicationYear": self.date.year(),
            "dates": [{ "date": self.date.to_string(), "dateType": "Issued" }],
            "types": { "resourceTypeGeneral": "Dataset", "resourceType": "Simulation" },
            "rightsList": [{
                "rights": self.licence.name,
                "rightsUri": self.licence.address(),
                "rightsIdentifier": self.licence.id,
                "rightsIdentifierScheme": "SPDX",
                "schemeUri": "https://spdx.org/licenses/",
            }],
            "schemaVersion": SCHEMA,
            "doi": self.doi.as_ref().map(Doi::as_str),
            "publisher": { "name": self.publisher.as_ref().map(Text::as_str) },
            "descriptions": self.description.iter().map(|text| json!({
                "description": text.as_str(),
                "descriptionType": "Abstract",
            })).collect::<Vec<_>>(),
            "subjects": self.keywords.iter().map(|keyword| json!({ "subject": keyword.as_str() })).collect::<Vec<_>>(),
            "fundingReferences": self.funders.iter().map(|funder| json!({
                "funderName": funder.name.as_str(),
                "awardNumber": funder.award.as_ref().map(Text::as_str),
            })).collect::<Vec<_>>(),
            "relatedIdentifiers": self.related.iter().map(related).collect::<Vec<_>>(),
        });
        match pruned(properties) {
            Value::Object(properties) => properties,
            _ => Map::new(),
        }
    }
}

/// The JSON without members that are null or empty: what is not known is left out.
pub(crate) fn pruned(value: Value) -> Value {
    match value {
        Value::Object(members) => {
            let members = members
                .into_iter()
                .map(|(name, value)| (name, pruned(value)));
            members.filter(|(_, value)| !is_empty(value)).collect()
        }
        Value::Array(items) => items.into_iter().map(pruned).collect(),
        value => value,
    }
}

fn is_empty(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Object(members) => members.is_empty(),
        Value::Array(items) => items.is_empty(),
        _ => false,
    }
}

fn creator(creator: &Creator) -> Value {
    let kind = if creator.is_person() {
        "Personal"
    } else {
        "Organizational"
    };
    json!({
        "name": creator.name.as_str(),
        "nameType": kind,
        "nameIdentifiers": creator.orcid.iter().map(|orcid| json!({
            "nameIdentifier": format!("https://orcid.org/{}", orcid.as_str()),
            "nameIdentifierScheme": "ORCID",
            "schemeUri": "https://orcid.org",
        })).collect::<Vec<_>>(),
        "affiliation": creator.affiliation.iter().map(|name| json!({ "name": name.as_str() })).collect::<Vec<_>>(),
    })
}

fn related(related: &Related) -> Value {
    let (kind, id) = match &related.id {
        Identifier::Doi(doi) => ("DOI", doi.as_str()),
        Identifier::Arxiv(number) => ("arXiv", number.as_str()),
        Identifier::Url(address) => ("URL", address.as_str()),
    };
    json!({
        "relationType": related.relation.as_str(),
        "relatedIdentifierType": kind,
        "relatedIdentifier": id,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_the_properties_of_datacite() {
        let about = About::from_toml(
            r#"
title = "A rising top"
description = "Figure 2 again"
licence = "CC-BY-4.0"
date = 2026-11-29
doi = "https://doi.org/10.5281/zenodo.1234567"
publisher = "Zenodo"
keywords = ["top"]

[[creators]]
name = "Carberry, Josiah"
orcid = "0000-0002-1825-0097"
affiliation = "Brown University"

[[creators]]
name = "Top Group"

[[funders]]
name = "ERC"
award = "101"

[[related]]
relation = "isSupplementTo"
id = "arXiv:1101.0001"
"#,
        )
        .unwrap();
        let expected = [
            (
                "creators",
                r#"[{"name":"Carberry, Josiah","nameType":"Personal","nameIdentifiers":[{"nameIdentifier":"https://orcid.org/0000-0002-1825-0097","nameIdentifierScheme":"ORCID","schemeUri":"https://orcid.org"}],"affiliation":[{"name":"Brown University"}]},{"name":"Top Group","nameType":"Organizational"}]"#,
            ),
            ("dates", r#"[{"date":"2026-11-29","dateType":"Issued"}]"#),
            (
                "descriptions",
                r#"[{"description":"Figure 2 again","descriptionType":"Abstract"}]"#,
            ),
            ("doi", r#""10.5281/zenodo.1234567""#),
            (
                "fundingReferences",
                r#"[{"funderName":"ERC","awardNumber":"101"}]"#,
            ),
            ("publicationYear", "2026"),
            ("publisher", r#"{"name":"Zenodo"}"#),
            (
                "relatedIdentifiers",
                r#"[{"relationType":"IsSupplementTo","relatedIdentifierType":"arXiv","relatedIdentifier":"arXiv:1101.0001"}]"#,
            ),
            (
                "rightsList",
                r#"[{"rights":"Creative Commons Attribution 4.0 International","rightsUri":"https://spdx.org/licenses/CC-BY-4.0","rightsIdentifier":"CC-BY-4.0","rightsIdentifierScheme":"SPDX","schemeUri":"https://spdx.org/licenses/"}]"#,
            ),
            ("schemaVersion", r#""http://datacite.org/schema/kernel-4""#),
            ("subjects", r#"[{"subject":"top"}]"#),
            ("titles", r#"[{"title":"A rising top"}]"#),
            (
                "types",
                r#"{"resourceTypeGeneral":"Dataset","resourceType":"Simulation"}"#,
            ),
        ];
        let expected = expected.map(|(key, value)| (key.to_owned(), value.to_owned()));
        assert_eq!(about.to_entries(), expected.into());
        assert_eq!(About::from_entries(&about.to_entries()), Some(about));
    }
}
