//! Remarks on the data of a fit and on what they determine.

use crate::fit::problem::degeneracy::or;
use crate::fit::problem::parameter::Parameter;
use crate::words::{Piece, Sentence, and, plural, sentence};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A remark on the data of a fit, or on what they determine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Note {
    /// No signal depends on some parameters of a group, which keep their values.
    Unseen {
        /// The parameters.
        parameters: Vec<String>,
    },
    /// The signals hardly depend on some parameters of a group, which are kept. The standard deviations of the others include
    /// what is not known of them.
    Kept {
        /// The parameters.
        parameters: Vec<KeptParameter>,
    },
    /// A signal is sampled too slowly for the nutation.
    Aliased {
        /// Frequency of the nutation, Hz.
        nutation: f64,
        /// Frequency of the samples, Hz.
        sampling: f64,
    },
    /// The search began again with the spin that the precession shows.
    Restarted {
        /// The spin, rad/s.
        spin: f64,
    },
    /// The search was given up.
    GivenUp {
        /// The integrator steps that it took, in those of the motion at the start.
        motions: u64,
    },
    /// Other spins that describe the data were looked for.
    SpinsTried {
        /// The lowest and the highest spin at the start, rad/s.
        range: [f64; 2],
        /// Whether no minimum beyond them was left untried that the data may not exclude.
        is_complete: bool,
    },
    /// A remark of a report without facts, in words.
    Words(String),
}

/// A parameter that is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KeptParameter {
    /// Name of the parameter.
    pub name: String,
    /// Unit; may be empty.
    pub unit: String,
    /// The value, which is the scenario's.
    pub value: f64,
    /// Standard deviation of what is known of it, from its typical range.
    pub width: f64,
}

impl From<&Parameter> for KeptParameter {
    fn from(parameter: &Parameter) -> Self {
        Self {
            name: parameter.name(),
            unit: parameter.unit().to_owned(),
            value: parameter.start,
            width: parameter.prior,
        }
    }
}

impl KeptParameter {
    fn clause(&self) -> Sentence {
        sentence!(
            "{} = {}",
            Piece::key(self.name.clone()),
            Piece::estimate(self.value, self.width, self.unit.clone())
        )
    }
}

impl Note {
    /// Whether it is about spins that were tried.
    pub(super) fn is_on_spins(&self) -> bool {
        matches!(self, Self::SpinsTried { .. })
    }

    /// The remark in a sentence.
    pub fn sentence(&self) -> Sentence {
        match self {
            Self::Unseen { parameters } => sentence!(
                "No signal depends on {}: kept at the scenario's {}.",
                or(parameters),
                plural(parameters.len() as u64, "value")
            ),
            Self::Kept { parameters } => sentence!(
                "The signals hardly show {}: kept at the scenario's value, and the ± of the other estimates include this width.",
                and(parameters.iter().map(KeptParameter::clause).collect())
            ),
            Self::Aliased { nutation, sampling } => sentence!(
                "The nutation at {} is sampled at {}: it appears at other frequencies, and there may be several solutions.",
                Piece::fixed(*nutation, 1, "Hz"),
                Piece::fixed(*sampling, 1, "Hz")
            ),
            Self::Restarted { spin } => sentence!(
                "From the start no minimum near the data was found. The search began again with {} = {}, the spin that belongs to the precession at the beginning of the data.",
                Piece::key("initial.psi_dot"),
                Piece::rounded(*spin, 4, "rad/s")
            ),
            Self::GivenUp { motions } => sentence!(
                "The search was given up after {} times the steps of the motion at the start.",
                motions.to_string()
            ),
            Self::SpinsTried {
                range: [low, high],
                is_complete,
            } => sentence!(
                "Without φ or ψ, the phase of the nutation is all that shows the spin: other spins that describe the data were looked for, with {} from {} to {}{}.",
                Piece::key("initial.psi_dot"),
                Piece::fixed(*low, 1, "rad/s").without_unit(),
                Piece::fixed(*high, 1, "rad/s"),
                if *is_complete {
                    ""
                } else {
                    "; spins beyond may describe the data as well"
                }
            ),
            Self::Words(text) => text.into(),
        }
    }
}

/// The members of notes in reports.
#[derive(Serialize, Deserialize, JsonSchema)]
pub(super) struct NoteMembers {
    /// Remarks on the data and on what they determine.
    notes: Vec<String>,
    /// The same remarks with their numbers.
    #[serde(default)]
    remarks: Option<Vec<Note>>,
}

impl NoteMembers {
    pub(super) fn serialize<S: serde::Serializer>(
        notes: &[Note],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        let members = Self {
            notes: notes
                .iter()
                .map(|note| note.sentence().to_string())
                .collect(),
            remarks: Some(notes.to_vec()),
        };
        Serialize::serialize(&members, serializer)
    }

    pub(super) fn deserialize<'de, D: serde::Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<Note>, D::Error> {
        let Self { notes, remarks } = Deserialize::deserialize(deserializer)?;
        // Reports of 1.0 have no facts.
        Ok(remarks.unwrap_or_else(|| notes.into_iter().map(Note::Words).collect()))
    }
}
