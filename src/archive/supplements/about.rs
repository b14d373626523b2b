//! What a recording says of itself: title, creators, licence and what else a repository asks, from a TOML file.
//!
//! It is written as one metadata record with the properties of the `DataCite` Metadata Schema 4.6 (DataCite Metadata Working
//! Group 2024, doi:10.14454/mzv1-5b55). Dates come from the file, never from a clock.

mod datacite;
mod terms;

pub use self::datacite::RECORD;
#[cfg(feature = "cli")]
pub(crate) use self::datacite::pruned;
pub use self::terms::{Date, Doi, Identifier, InvalidTerm, Licence, Orcid, Relation, Text};
use serde::Deserialize;
use thiserror::Error;

/// Error of a file about a recording: its line, the value and what is allowed.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}", .0.to_string().trim_end())]
pub struct AboutError(toml::de::Error);

/// What a recording says of itself.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct About {
    /// Title.
    pub title: Text,
    /// Those who made it, in the order in which they are cited.
    #[serde(deserialize_with = "terms::some")]
    pub creators: Vec<Creator>,
    /// Licence.
    #[serde(alias = "license")]
    pub licence: Licence,
    /// Day of publication.
    pub date: Date,
    /// Summary.
    pub description: Option<Text>,
    /// DOI of the recording.
    pub doi: Option<Doi>,
    /// Who publishes it, e.g. a repository.
    pub publisher: Option<Text>,
    /// Keywords.
    #[serde(default, deserialize_with = "terms::distinct")]
    pub keywords: Vec<Text>,
    /// Who paid for it.
    #[serde(default, deserialize_with = "terms::distinct")]
    pub funders: Vec<Funder>,
    /// Works to which it is related.
    #[serde(default, deserialize_with = "terms::distinct")]
    pub related: Vec<Related>,
}

/// A person or an organisation that made the recording.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Creator {
    /// Name; of a person as `Family, Given`.
    pub name: Text,
    /// ORCID of a person.
    pub orcid: Option<Orcid>,
    /// Where the person works.
    pub affiliation: Option<Text>,
}

/// A source of money.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Funder {
    /// Name.
    pub name: Text,
    /// Number of the grant.
    pub award: Option<Text>,
}

/// A related work.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Related {
    /// How the recording is related to it.
    pub relation: Relation,
    /// The work.
    pub id: Identifier,
}

impl About {
    /// Reads a TOML file.
    ///
    /// # Errors
    /// [`AboutError`] if it is not TOML, lacks a key, or has one that is unknown or wrong.
    pub fn from_toml(text: &str) -> Result<Self, AboutError> {
        toml::from_str(text).map_err(AboutError)
    }
}

impl Creator {
    /// Whether it is a person, and no organisation: it has an ORCID, or a family name and a given name.
    pub fn is_person(&self) -> bool {
        self.orcid.is_some() || self.name.as_str().contains(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least that a file must say.
    const LEAST: &str = r#"
title = "A rising top"
licence = "CC-BY-4.0"
date = 2026-11-29
creators = [{ name = "Doe, Jo" }]
"#;

    fn message(text: &str) -> String {
        About::from_toml(text).unwrap_err().to_string()
    }

    #[test]
    fn reads_dates_with_and_without_quotes() {
        let quoted = LEAST.replace("2026-11-29", "\"2026-11-29\"");
        assert_eq!(About::from_toml(&quoted), About::from_toml(LEAST));
        let american = LEAST.replace("licence", "license");
        assert_eq!(About::from_toml(&american), About::from_toml(LEAST));
        assert!(About::from_toml(LEAST).is_ok());
    }

    #[test]
    fn errors_name_the_line_and_what_is_allowed() {
        for (change, by, expected) in [
            ("A rising top", " ", "it is empty"),
            ("CC-BY-4.0", "CC BY 4.0", "SPDX"),
            ("CC-BY-4.0", "GPL3", "GPL-3.0"),
            ("CC-BY-4.0", "", "SPDX"),
            ("CC-BY-4.0", "NOASSERTION", "SPDX"),
            ("A rising top", "A\\u0000", "control"),
            (
                "[{ name = \"Doe, Jo\" }]",
                "[{ name = \"A\" }, { name = \"A\" }]",
                "listed twice",
            ),
            ("2026-11-29", "2026-11-29T10:00:00", "YYYY-MM-DD"),
            ("2026-11-29", "\"2026-02-30\"", "YYYY-MM-DD"),
            ("2026-11-29", "2026", "YYYY-MM-DD"),
            ("{ name = \"Doe, Jo\" }", "", "at least one is needed"),
            (
                "Jo\"",
                "Jo\", orcid = \"0000-0002-1825-0098\"",
                "check digit",
            ),
            (
                "Jo\"",
                "Jo\", orcid = \"0000-0002-1825\"",
                "0000-0002-1825-0097",
            ),
            ("Jo\"", "Jo\", mail = \"a@b\"", "unknown field `mail`"),
        ] {
            let message = message(&LEAST.replace(change, by));
            assert!(message.contains(expected), "{by}: {message}");
            assert!(message.contains("line "), "{by}: {message}");
        }
        let lines = "[[related]]\nrelation = \"isSupplementOf\"\nid = \"10.1234/a\"";
        let message = message(&format!("{LEAST}\n{lines}"));
        assert!(message.contains("IsSupplementTo"), "{message}");
        assert!(message.contains("line 8"), "{message}");
        assert!(super::tests::message("title = \"a\"").contains("missing field"));
    }
}
