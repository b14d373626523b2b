//! The result of explaining a run: sentences, and the numbers in them.

use crate::analysis::course::CourseReport;
use schemars::JsonSchema;
use serde::Serialize;

/// What happened in a run and why, in words and numbers.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Story {
    /// What happened, in a few words.
    pub title: String,
    /// The chapters.
    pub chapters: Vec<Chapter>,
    /// What happened, in numbers.
    pub course: CourseReport,
    /// Means over successive stages of the run: those with nutations have about the same number of them.
    pub stages: Vec<StageReport>,
    /// What changed the precession rate, in all; none if that is not known.
    pub precession: Option<PrecessionReport>,
    /// What of the recording could not be read or was left out.
    pub losses: Vec<String>,
}

/// A part of a story.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Chapter {
    /// The subject of the chapter.
    pub heading: &'static str,
    /// Sentences.
    pub sentences: Vec<String>,
    /// Whether each sentence stands by itself, as an entry of a list.
    pub is_list: bool,
    /// [`Story::stages`] as text: names of columns, and rows; none where they don't belong.
    #[serde(skip)]
    pub table: Option<(Vec<String>, Vec<Vec<String>>)>,
}

/// A chapter of sentences that belong together; none if there are none.
pub(super) fn chapter(heading: &'static str, sentences: Vec<String>) -> Option<Chapter> {
    let chapter = Chapter {
        heading,
        sentences,
        ..Chapter::default()
    };
    Some(chapter).filter(|chapter| !chapter.sentences.is_empty())
}

/// Means over a stage of a run: over whole nutations, or over a motion without nutation.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StageReport {
    /// Start of the stage, s.
    pub from: f64,
    /// End of the stage, s.
    pub to: f64,
    /// Number of nutations; 0 for a motion without nutation.
    pub nutations: u64,
    /// Inclination θ, rad.
    pub theta: f64,
    /// Nutation rate θ̇, rad/s.
    pub theta_dot: f64,
    /// The θ̇ at which the gyroscopic and Coriolis terms of φ̈ cancel the frictional one, rad/s.
    pub theta_dot_demanded: Option<f64>,
    /// Precession rate φ̇, rad/s.
    pub phi_dot: f64,
    /// Slow rate of regular precession at these means, rad/s; none where there is no real one.
    pub slow_root: Option<f64>,
    /// Fast rate of regular precession at these means, rad/s; none where there is no real one.
    pub fast_root: Option<f64>,
    /// Spin rate ψ̇, rad/s.
    pub psi_dot: f64,
}

/// What changed φ̇, and what friction changed ψ̇ by, from the first sample to the last or to where the axis first comes
/// near the vertical or the contact point sticks.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PrecessionReport {
    /// Start of the integrals, s.
    pub from: f64,
    /// End of the integrals, s.
    pub to: f64,
    /// φ̇ at the start, rad/s.
    pub first: f64,
    /// φ̇ at the end, rad/s.
    pub last: f64,
    /// ∫ of the gyroscopic term of φ̈, rad/s; none in recordings of the first version of the telemetry.
    pub gyroscopic: Option<f64>,
    /// ∫ of the Coriolis term of φ̈, rad/s; none in recordings of the first version of the telemetry.
    pub coriolis: Option<f64>,
    /// ∫ of the frictional term of φ̈, rad/s.
    pub frictional: f64,
    /// ψ̇ at the start, rad/s.
    pub spin_first: f64,
    /// ψ̇ at the end, rad/s.
    pub spin_last: f64,
    /// ∫ of the frictional term of ψ̈, rad/s.
    pub spin_frictional: f64,
}
