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
    /// Means over successive stages of the run, each with about the same number of nutations.
    pub stages: Vec<StageReport>,
    /// What changed the precession rate, in all; none if samples are missing.
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

/// Means over a stage of a run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StageReport {
    /// Start of the stage, s.
    pub from: f64,
    /// End of the stage, s.
    pub to: f64,
    /// Inclination θ, rad.
    pub theta: f64,
    /// Nutation rate θ̇, rad/s.
    pub theta_dot: f64,
    /// The θ̇ at which the gyroscopic and Coriolis terms of φ̈ cancel the frictional one, rad/s.
    pub theta_dot_demanded: Option<f64>,
    /// Precession rate φ̇, rad/s.
    pub phi_dot: f64,
    /// Slow rate of regular precession, rad/s; none where there is no real one.
    pub slow_root: Option<f64>,
    /// φ̇ less the slow rate, rad/s.
    pub excess: Option<f64>,
    /// Spin rate ψ̇, rad/s.
    pub psi_dot: f64,
    /// The part of the time during which θ̈ was negative.
    pub rising: f64,
}

/// The integrals of the terms of φ̈ and ψ̈ over a run, up to where the axis first comes near upright.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PrecessionReport {
    /// Gyroscopic term of φ̈, rad/s.
    pub gyroscopic: f64,
    /// Coriolis term of φ̈, rad/s.
    pub coriolis: f64,
    /// Frictional term of φ̈, rad/s.
    pub frictional: f64,
    /// Frictional term of ψ̈, rad/s.
    pub spin_frictional: f64,
    /// When the axis first came near upright, s.
    pub upright: Option<f64>,
}
