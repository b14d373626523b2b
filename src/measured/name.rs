//! Names of columns: one rule to read them.
//!
//! A name is split into words. One of them names a field or the time, one may be a unit, and some mean nothing. So
//! `thetaDeg`, `theta (°) Run 1`, `tilt angle [deg]` and `Latest: Time (s)` are read alike.

use super::unit::{Dimension, Token, Unit, tokens};
use crate::telemetry::fields::{NumberField, pose, state};

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    Time,
    Field(NumberField),
}

/// Names of fields.
#[rustfmt::skip]
const FIELDS: &[(&[&str], NumberField)] = &[
    (&["theta", "θ", "ϑ", "tilt", "inclination", "nutation"], state::THETA),
    (&["phi", "φ", "ϕ", "azimuth", "precession"], state::PHI),
    (&["psi", "ψ", "spin angle"], state::PSI),
    (&["theta_dot", "θ̇", "dtheta/dt"], state::THETA_DOT),
    (&["phi_dot", "φ̇", "dphi/dt"], state::PHI_DOT),
    (&["psi_dot", "ψ̇", "dpsi/dt"], state::PSI_DOT),
    (&["omega_n", "ω_n", "axial rate", "gyroscope z", "gyro z", "wz"], pose::OMEGA_BODY.z()),
];

/// Words for times. A unit of time in full stands for them, too: `seconds`.
const TIMES: &[&str] = &["t", "time", "timestamp", "stamp", "elapsed", "zeit"];

/// Words that mean nothing: `Latest: Time (s)`, `tilt angle`, `Zeit in s`, `field.theta`.
const IGNORED: &[&str] = &["latest", "angle", "in", "field"];

/// Words that mean nothing with the number after them: `Run 2`, `Data Set 1`.
const NUMBERED: &[&str] = &["run", "data", "set"];

/// The shortest unit of time that names a column by itself.
const MIN_UNIT: usize = 6;

/// A name of a column as it is understood.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ColumnName {
    pub meaning: Option<Meaning>,
    pub unit: Option<&'static Unit>,
    /// Words that are neither understood nor ignored.
    pub rest: Vec<String>,
    /// All words but the unit.
    words: Vec<Token>,
}

impl ColumnName {
    pub(super) fn parse(text: &str) -> Self {
        let tokens = tokens(text);
        let mut name = Self {
            meaning: None,
            unit: None,
            rest: Vec::new(),
            words: Vec::new(),
        };
        let mut at = 0;
        while at < tokens.len() {
            at += name.take(&tokens[at..], text);
        }
        if let (None, Some(unit)) = (name.meaning, name.unit)
            && unit.dimension == Dimension::Time
            && text.trim().len() >= MIN_UNIT
            && name.rest.is_empty()
        {
            name.meaning = Some(Meaning::Time);
        }
        name
    }

    /// Takes what some tokens begin with. Returns the number of tokens.
    fn take(&mut self, tokens: &[Token], text: &str) -> usize {
        let meaning = beginning(tokens, text);
        let unit = Unit::beginning(tokens);
        let (length, is_new) = match (meaning, unit) {
            (Some((meaning, length)), _) if unit.is_none_or(|(_, other)| length >= other) => {
                let is_new = self.meaning.is_none_or(|known| known == meaning);
                self.meaning.get_or_insert(meaning);
                (length, is_new)
            }
            (_, Some((unit, length))) => {
                let is_new = self.unit.is_none();
                self.unit.get_or_insert(unit);
                if is_new {
                    return length;
                }
                (length, false)
            }
            (_, None) => {
                let length = ignored(tokens);
                (length.max(1), length > 0 || !tokens[0].is_word())
            }
        };
        for token in tokens[..length].iter().filter(|token| token.is_word()) {
            self.words.push(token.clone());
            if !is_new {
                self.rest.push(token.text().to_owned());
            }
        }
        length
    }

    /// Whether another name stands for this one: it has the same words, and the same unit if both have one.
    pub(super) fn is_called(&self, other: &Self) -> bool {
        let is_same_unit = match (self.unit, other.unit) {
            (Some(own), Some(other)) => own == other,
            (Some(_) | None, _) => true,
        };
        is_same_unit && !self.words.is_empty() && self.words == other.words
    }
}

/// The longest name with which tokens begin, and its length.
fn beginning(tokens: &[Token], text: &str) -> Option<(Meaning, usize)> {
    let mut longest: Option<(Meaning, usize)> = None;
    let fields = FIELDS
        .iter()
        .flat_map(|(names, field)| names.iter().map(|name| (*name, Meaning::Field(*field))));
    for (name, meaning) in fields.chain(TIMES.iter().map(|name| (*name, Meaning::Time))) {
        let spelled = super::unit::tokens(name);
        let is_longer = longest.is_none_or(|(_, length)| spelled.len() > length);
        // `T` is a temperature.
        let is_temperature = name == "t" && !text.contains('t');
        if is_longer && !is_temperature && tokens.starts_with(&spelled) {
            longest = Some((meaning, spelled.len()));
        }
    }
    longest
}

/// The number of tokens at the beginning that mean nothing.
fn ignored(tokens: &[Token]) -> usize {
    let word = tokens[0].text();
    if IGNORED.contains(&word) {
        return 1;
    }
    if NUMBERED.contains(&word) {
        return if tokens.get(1).is_some_and(Token::is_number) {
            2
        } else {
            1
        };
    }
    let numbered = NUMBERED.iter().find_map(|name| word.strip_prefix(name));
    usize::from(numbered.is_some_and(|number| number.parse::<u32>().is_ok()))
}

/// The field with one of the names that columns have.
pub(super) fn field_named(name: &str) -> Option<NumberField> {
    let read = ColumnName::parse(name);
    match read.meaning {
        Some(Meaning::Field(field)) if read.rest.is_empty() && read.unit.is_none() => Some(field),
        Some(_) | None => None,
    }
}

/// The unit in a name, or what stands in brackets in its place; may be empty.
pub(super) fn unit_of(name: &str) -> &str {
    let read = ColumnName::parse(name);
    match read.unit {
        Some(unit) => unit.name(),
        None if read.rest.is_empty() => "",
        None => in_brackets(name).unwrap_or_default(),
    }
}

/// What stands in brackets at the end of a name.
fn in_brackets(name: &str) -> Option<&str> {
    for (open, close) in [('(', ')'), ('[', ']')] {
        if let Some(inner) = name.trim().strip_suffix(close) {
            return inner.rsplit_once(open).map(|(_, unit)| unit);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_names_by_one_rule() {
        let time = Some(Meaning::Time);
        let [theta, phi] = [state::THETA, state::PHI].map(|field| Some(Meaning::Field(field)));
        let rate = Some(Meaning::Field(pose::OMEGA_BODY.z()));
        let theta_dot = Some(Meaning::Field(state::THETA_DOT));
        for (text, meaning, unit, rest) in [
            ("t", time, "", ""),
            ("Time (s)", time, "s", ""),
            ("Time [ms]", time, "ms", ""),
            ("t / s", time, "s", ""),
            ("t_us", time, "µs", ""),
            ("Latest: Time (s)", time, "s", ""),
            ("Time (s) Run #1", time, "s", ""),
            ("Data Set 1:Time(s)", time, "s", ""),
            ("Zeit in s", time, "s", ""),
            ("seconds_elapsed", time, "s", ""),
            ("elapsed time", time, "", ""),
            ("seconds", time, "s", ""),
            ("%time", time, "", ""),
            ("timestamp (UTC)", time, "", "utc"),
            ("t (frames)", time, "", "frames"),
            ("T", None, "", "t"),
            ("s", None, "s", ""),
            ("theta deg", theta, "deg", ""),
            ("thetaDeg", theta, "deg", ""),
            ("theta (°) Run 1", theta, "deg", ""),
            ("θ (deg)", theta, "deg", ""),
            ("tilt angle (deg)", theta, "deg", ""),
            ("TILT/DEG", theta, "deg", ""),
            ("field.theta", theta, "", ""),
            ("theta_sd", theta, "", "sd"),
            ("theta phi", theta, "", "phi"),
            ("theta (grad)", theta, "", "grad"),
            ("Azimuth [mrad] Run2", phi, "mrad", ""),
            ("theta_dot (deg/s)", theta_dot, "deg/s", ""),
            ("θ̇ / rad·s⁻¹", theta_dot, "rad/s", ""),
            ("Gyroscope z (rad/s)", rate, "rad/s", ""),
            ("gyroZ_rad/s", rate, "rad/s", ""),
            ("Gyroscope x (rad/s)", None, "rad/s", "gyroscope x"),
            ("angle (rad)", None, "rad", ""),
        ] {
            let read = ColumnName::parse(text);
            let found = (read.meaning, read.unit.map_or("", Unit::name));
            assert_eq!(found, (meaning, unit), "{text}");
            assert_eq!(read.rest.join(" "), rest, "{text}");
        }
    }

    #[test]
    fn names_stand_for_columns_with_the_same_words() {
        for (column, name, expected) in [
            ("Tilt (deg)", "tilt", true),
            ("tilt", "tilt (deg)", true),
            ("Tilt (deg)", "tilt [°]", true),
            ("tilt (rad)", "tilt (deg)", false),
            ("Run 1: Time (s)", "Run 2: Time (s)", false),
            ("Latest: Angle (rad)", "latest: angle", true),
            ("#", "#", false),
        ] {
            let [column_name, other] = [column, name].map(ColumnName::parse);
            assert_eq!(column_name.is_called(&other), expected, "{column}, {name}");
        }
    }
}
