//! The values of a file about a recording, each checked as it is read.

use crate::run::suggestion::{did_you_mean, suggestion};
use crate::words::is_control;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use std::fmt;
use thiserror::Error;
use toml::value::Datetime;

/// A value that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{value:?} is no {expected}")]
pub struct InvalidTerm {
    /// The value.
    pub value: String,
    /// What it would have to be.
    pub expected: String,
}

impl InvalidTerm {
    fn new(value: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            value: value.into(),
            expected: expected.into(),
        }
    }
}

/// A list that must not be empty.
pub(super) fn some<'de, T: Deserialize<'de> + PartialEq, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    let list = distinct(deserializer)?;
    if list.is_empty() {
        return Err(D::Error::custom("at least one is needed"));
    }
    Ok(list)
}

/// A list without repetitions.
pub(super) fn distinct<'de, T: Deserialize<'de> + PartialEq, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    let list: Vec<T> = Vec::deserialize(deserializer)?;
    let is_repeated = |(at, item): (usize, &T)| list[..at].contains(item);
    if list.iter().enumerate().any(is_repeated) {
        return Err(D::Error::custom("something is listed twice"));
    }
    Ok(list)
}

/// Declares a text that is checked as it is read.
macro_rules! checked {
    ($(#[$meta:meta])* $Name:ident) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
        #[serde(try_from = "String")]
        pub struct $Name(String);

        impl $Name {
            /// The text.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }
    };
}

checked! {
    /// A text that is not empty.
    Text
}

/// A licence of SPDX's list (ISO/IEC 5962, annex A).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Licence {
    /// Identifier, e.g. `CC-BY-4.0`.
    pub id: &'static str,
    /// Full name.
    pub name: &'static str,
}

impl<'de> Deserialize<'de> for Licence {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let id = String::deserialize(deserializer)?;
        Self::try_from(id).map_err(D::Error::custom)
    }
}

checked! {
    /// An ORCID, e.g. `0000-0002-1825-0097`, with a right check digit (ISO/IEC 7064, MOD 11-2).
    Orcid
}

checked! {
    /// A DOI without a prefix, e.g. `10.5281/zenodo.1234567`.
    Doi
}

checked! {
    /// How a recording is related to another work, in the words of `DataCite`, e.g. `IsSupplementTo`.
    Relation
}

impl TryFrom<String> for Text {
    type Error = InvalidTerm;

    fn try_from(text: String) -> Result<Self, InvalidTerm> {
        // In one line, as every format takes it.
        let words: Vec<&str> = text.split_whitespace().collect();
        let text = words.join(" ");
        if text.is_empty() {
            return Err(InvalidTerm::new(text, "text: it is empty"));
        }
        if text.contains(is_control) {
            return Err(InvalidTerm::new(text, "text without control characters"));
        }
        Ok(Self(text))
    }
}

impl TryFrom<String> for Licence {
    type Error = InvalidTerm;

    fn try_from(value: String) -> Result<Self, InvalidTerm> {
        // These say that there is none.
        let is_licence = !["NONE", "NOASSERTION"].contains(&value.as_str());
        if let Some(id) = spdx::license_id(&value).filter(|_| is_licence) {
            return Ok(Self {
                id: id.name,
                name: id.full_name,
            });
        }
        let nearest = spdx::imprecise_license_id(&value).map(|(id, _)| id.name);
        let hint = did_you_mean(nearest.as_slice());
        let expected = format!(
            "licence of SPDX's list, such as CC-BY-4.0{hint}: see https://spdx.org/licenses"
        );
        Err(InvalidTerm::new(value, expected))
    }
}

impl Licence {
    /// The address of its text in SPDX's list.
    pub fn address(self) -> String {
        format!("https://spdx.org/licenses/{}", self.id)
    }
}

const ORCID: &str = "ORCID, such as 0000-0002-1825-0097";
const CHECK_DIGIT: &str = "ORCID: its check digit (the last) doesn't fit the others";

impl TryFrom<String> for Orcid {
    type Error = InvalidTerm;

    fn try_from(value: String) -> Result<Self, InvalidTerm> {
        let id = value.strip_prefix("https://orcid.org/").unwrap_or(&value);
        let groups: Vec<&str> = id.split('-').collect();
        if groups.len() != 4 || groups.iter().any(|group| group.len() != 4) {
            return Err(InvalidTerm::new(value, ORCID));
        }
        let digits: Option<Vec<u32>> = groups.concat().chars().map(orcid_digit).collect();
        match digits.as_deref().and_then(<[u32]>::split_last) {
            Some((last, digits)) if !digits.contains(&10) && digits.len() == 15 => {
                let sum = digits.iter().fold(0, |sum, digit| (sum + digit) * 2 % 11);
                if (12 - sum) % 11 == *last {
                    Ok(Self(id.to_owned()))
                } else {
                    Err(InvalidTerm::new(value, CHECK_DIGIT))
                }
            }
            Some(_) | None => Err(InvalidTerm::new(value, ORCID)),
        }
    }
}

/// The value of a character of an ORCID; `X` is ten.
fn orcid_digit(character: char) -> Option<u32> {
    match character {
        'X' => Some(10),
        character => character.to_digit(10),
    }
}

impl TryFrom<String> for Doi {
    type Error = InvalidTerm;

    fn try_from(value: String) -> Result<Self, InvalidTerm> {
        match bare_doi(&value) {
            Some(doi) => Ok(Self(doi.to_owned())),
            None => Err(InvalidTerm::new(
                value,
                "DOI, such as 10.5281/zenodo.1234567",
            )),
        }
    }
}

/// A DOI without its prefix, if a text is one of today's form (Crossref, "DOIs and matching regular expressions").
fn bare_doi(text: &str) -> Option<&str> {
    let prefixes = [
        "https://doi.org/",
        "http://doi.org/",
        "https://dx.doi.org/",
        "http://dx.doi.org/",
        "doi:",
        "DOI:",
    ];
    let bare = prefixes
        .iter()
        .find_map(|prefix| text.strip_prefix(prefix))
        .unwrap_or(text);
    let (prefix, suffix) = bare.split_once('/')?;
    let registrant = prefix.strip_prefix("10.")?;
    let is_number = (4..=9).contains(&registrant.len())
        && registrant.chars().all(|c| c.is_ascii_digit() || c == '.');
    let is_allowed = |c: char| c.is_ascii_alphanumeric() || "-._;()/:[]".contains(c);
    (is_number && !suffix.is_empty() && suffix.chars().all(is_allowed)).then_some(bare)
}

/// A day.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Date(toml::value::Date);

impl Date {
    /// The year.
    pub fn year(self) -> u16 {
        self.0.year
    }
}

impl fmt::Display for Date {
    /// As `YYYY-MM-DD`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl<'de> Deserialize<'de> for Date {
    /// From a date, or a text that is one.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = toml::Value::deserialize(deserializer)?;
        let datetime: Option<Datetime> = match &value {
            toml::Value::Datetime(datetime) => Some(*datetime),
            toml::Value::String(text) => text.parse().ok(),
            _ => None,
        };
        if let Some(Datetime {
            date: Some(date),
            time: None,
            offset: None,
        }) = datetime
        {
            return Ok(Self(date));
        }
        let text = value.to_string();
        Err(D::Error::custom(InvalidTerm::new(text, "day, YYYY-MM-DD")))
    }
}

impl TryFrom<String> for Relation {
    type Error = InvalidTerm;

    fn try_from(value: String) -> Result<Self, InvalidTerm> {
        let mut relations = RELATIONS.split_whitespace();
        if let Some(name) = relations.find(|name| name.eq_ignore_ascii_case(&value)) {
            return Ok(Self(name.to_owned()));
        }
        let hint = suggestion(&value, RELATIONS.split_whitespace());
        let expected = format!("relation of DataCite, such as isSupplementTo{hint}");
        Err(InvalidTerm::new(value, expected))
    }
}

/// The relations of `DataCite` 4.6 (controlled list `relationType`).
const RELATIONS: &str = "
    IsCitedBy Cites IsCollectedBy Collects IsSupplementTo IsSupplementedBy IsContinuedBy Continues
    IsDescribedBy Describes HasMetadata IsMetadataFor HasVersion IsVersionOf IsNewVersionOf
    IsPreviousVersionOf IsPartOf HasPart IsPublishedIn IsReferencedBy References IsDocumentedBy
    Documents IsCompiledBy Compiles IsVariantFormOf IsOriginalFormOf IsIdenticalTo IsReviewedBy Reviews
    IsDerivedFrom IsSourceOf IsRequiredBy Requires Obsoletes IsObsoletedBy HasTranslation
    IsTranslationOf";

/// What identifies a work.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub enum Identifier {
    /// A DOI.
    Doi(Doi),
    /// A number of arXiv, e.g. `arXiv:1101.0001`.
    Arxiv(String),
    /// An address on the web.
    Url(String),
}

impl TryFrom<String> for Identifier {
    type Error = InvalidTerm;

    fn try_from(value: String) -> Result<Self, InvalidTerm> {
        if let Some(doi) = bare_doi(&value) {
            return Ok(Self::Doi(Doi(doi.to_owned())));
        }
        let begins_with = |prefix: &str| {
            let rest = value.strip_prefix(prefix);
            rest.is_some_and(|rest| !rest.is_empty() && rest.chars().all(|c| c.is_ascii_graphic()))
        };
        if begins_with("arXiv:") && value.contains(|c: char| c.is_ascii_digit()) {
            Ok(Self::Arxiv(value))
        } else if begins_with("https://") || begins_with("http://") {
            Ok(Self::Url(value))
        } else {
            let expected = "DOI, arXiv number (arXiv:1101.0001) or address (https://…)";
            Err(InvalidTerm::new(value, expected))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_orcids_have_right_check_digits() {
        // Examples of ORCID's documentation ("Structure of the ORCID Identifier").
        for id in [
            "0000-0002-1825-0097",
            "0000-0001-5109-3700",
            "0000-0002-1694-233X",
        ] {
            let address = format!("https://orcid.org/{id}");
            assert_eq!(Orcid::try_from(address).unwrap().as_str(), id);
            assert!(Orcid::try_from(id.to_owned()).is_ok(), "{id}");
            let others = "0123456789X".chars().filter(|last| !id.ends_with(*last));
            for last in others {
                let wrong = format!("{}{last}", &id[..18]);
                let expected = Err(InvalidTerm::new(&wrong, CHECK_DIGIT));
                assert_eq!(Orcid::try_from(wrong), expected);
            }
        }
        for text in [
            "",
            "0000-0002-1825-009",
            "0000000218250097",
            "000X-0002-1825-0097",
            "ää-ää-ää-ää",
        ] {
            let expected = Err(InvalidTerm::new(text, ORCID));
            assert_eq!(Orcid::try_from(text.to_owned()), expected);
        }
    }

    #[test]
    fn knows_identifiers_by_their_form() {
        let identifier = |text: &str| Identifier::try_from(text.to_owned());
        let doi = Identifier::Doi(Doi("10.5281/zenodo.1".to_owned()));
        for prefix in ["", "doi:", "https://doi.org/"] {
            assert_eq!(
                identifier(&format!("{prefix}10.5281/zenodo.1")),
                Ok(doi.clone())
            );
        }
        let arxiv = "arXiv:1101.0001";
        assert_eq!(identifier(arxiv), Ok(Identifier::Arxiv(arxiv.to_owned())));
        let url = "https://example.org/a";
        assert_eq!(identifier(url), Ok(Identifier::Url(url.to_owned())));
        for text in [
            "",
            "10.5281",
            "10./a",
            "10.5281/",
            "https://",
            "a b",
            "ftp://a",
            "https://a b",
        ] {
            assert_eq!(identifier(text).unwrap_err().value, text);
        }
    }
}
