//! What a comparison found: numbers, from which every form of the report is made.
//!
//! Differences are B − A throughout. Angles are in rad, times in s of simulated time unless a name says
//! otherwise. Quantities that one of the runs doesn't have are absent.

use super::tolerance::Tolerance;
use crate::analysis::course::CourseReport;
use crate::archive::recording::Condition;
use schemars::JsonSchema;
use serde::Serialize;

/// How a comparison ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Every message is the same, to the last bit.
    Identical,
    /// All numbers agree within the tolerances.
    Equal,
    /// Something differs.
    Different,
}

/// What two runs have in common and in what they differ.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// The first run.
    pub a: Run,
    /// The second run.
    pub b: Run,
    /// How the comparison ended.
    pub verdict: Verdict,
    /// Whether everything could be read; if not, the verdict is about the rest.
    pub is_complete: bool,
    /// The findings in a few sentences.
    pub summary: Vec<String>,
    /// What was different in the set-up.
    pub setup: Setup,
    /// What was different in what happened; only for recordings of toprise.
    pub happened: Option<Happened>,
    /// How the averaged motions differ; needs `/top/nutation` of both.
    pub averaged: Option<Averaged>,
    /// How the signals differ, point by point.
    pub signals: Signals,
    /// What B's model would have done along A's motion; needs both scenarios and `/top/state` of A.
    pub discrepancy: Option<Discrepancy>,
    /// The errors of the integrators; absent if they were not asked for or can't be computed.
    pub floor: Option<Floor>,
    /// What else must be known to read this.
    pub notes: Vec<String>,
}

/// One of the two runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Run {
    /// What it is called here.
    pub name: String,
    /// Its file; absent for a scenario that was run on the fly.
    pub file: Option<String>,
    /// What kind of file it is.
    pub condition: Option<Condition>,
    /// What wrote it.
    pub library: String,
    /// The encoding of its messages.
    pub encoding: Option<String>,
    /// Number of messages that were read.
    pub messages: u64,
    /// Time of the last message, s.
    pub last: f64,
    /// SHA-256 of its content, where that is noted.
    pub content_digest: Option<String>,
    /// What of it could not be read.
    pub losses: Vec<String>,
    /// What happened in it.
    pub course: Option<CourseReport>,
}

/// Section a: the set-up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Setup {
    /// Keys of the scenarios with different values.
    pub scenario: Vec<KeyDifference>,
    /// Number of keys that both scenarios have with equal values.
    pub equal_keys: u64,
    /// What the files say about themselves: versions, encodings, entries of metadata records.
    pub files: Vec<KeyDifference>,
    /// Topics with schemas that differ.
    pub schemas: Vec<String>,
    /// Topics that only A has.
    pub topics_only_in_a: Vec<String>,
    /// Topics that only B has.
    pub topics_only_in_b: Vec<String>,
    /// Fields of common topics that only A has.
    pub fields_only_in_a: Vec<String>,
    /// Fields of common topics that only B has.
    pub fields_only_in_b: Vec<String>,
}

/// A key and its two values.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct KeyDifference {
    /// The key.
    pub key: String,
    /// The unit of the values.
    pub unit: String,
    /// A's value; absent if it has none.
    pub a: Option<String>,
    /// B's value; absent if it has none.
    pub b: Option<String>,
}

/// Section b: what happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Happened {
    /// Kinds of events that both or one of them have.
    pub kinds: Vec<EventKindDifference>,
    /// Pairs of events, but for nutation extremes.
    pub matched: Vec<EventPair>,
    /// Events that only A has; nutation extremes too.
    pub only_in_a: Vec<EventMoment>,
    /// Events that only B has; nutation extremes too.
    pub only_in_b: Vec<EventMoment>,
    /// The shift of the rise, s.
    pub rise_shift: Option<f64>,
    /// By how much the nutation alone can have moved the rise, s: half the ripple over the drift.
    pub rise_shift_uncertainty: Option<f64>,
    /// The level of the averaged θ that both reach, rad.
    pub averaged_level: Option<f64>,
    /// When A's averaged θ reaches it, s.
    pub averaged_crossing_a: Option<f64>,
    /// When B's does, s.
    pub averaged_crossing_b: Option<f64>,
}

/// Events of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventKindDifference {
    /// The kind.
    pub name: String,
    /// How many A has.
    pub count_a: u64,
    /// How many B has.
    pub count_b: u64,
    /// How many of them were matched.
    pub matched: u64,
    /// The mean shift of those, s.
    pub mean_shift: Option<f64>,
    /// The shift of largest magnitude, s.
    pub largest_shift: Option<f64>,
}

/// Two events that are the same, but for when.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventPair {
    /// The kind.
    pub name: String,
    /// When in A, s.
    pub time_a: f64,
    /// When in B, s.
    pub time_b: f64,
    /// θ then in A, rad.
    pub theta_a: f64,
    /// θ then in B, rad.
    pub theta_b: f64,
}

/// An event that only one run has.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventMoment {
    /// The kind.
    pub name: String,
    /// When, s.
    pub time: f64,
    /// What happened, for people.
    pub description: String,
}

/// Section c: the averaged motion, at the middle of each of A's nutation cycles.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Averaged {
    /// From the middle of this cycle, s.
    pub from: f64,
    /// To the middle of this one, s.
    pub to: f64,
    /// Number of A's cycles in between.
    pub cycles: u64,
    /// Means over the cycle: θ, θ̇, φ̇, ψ̇.
    pub means: Vec<Deviation>,
    /// Least and greatest values within the cycle; those of the rates need `/top/state`.
    pub envelopes: Vec<Deviation>,
    /// The nutation frequency, Hz.
    pub frequency: Deviation,
    /// How many nutations B is ahead of A.
    pub phase: Deviation,
    /// The same at the last nutation of both.
    pub phase_last: f64,
    /// When B is first ahead or behind by a quarter of a nutation, s: from there on, differences at equal
    /// times say nothing about the nutation.
    pub decorrelated: Option<f64>,
    /// The amplitude of the nutation, half the range of θ̇ within a cycle, of B over that of A: at first.
    pub amplitude_ratio_first: Option<f64>,
    /// The same at the end.
    pub amplitude_ratio_last: Option<f64>,
}

/// How far two curves lie apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Deviation {
    /// The quantity.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The difference of largest magnitude.
    pub largest: f64,
    /// When, s.
    pub at: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// The larger magnitude of the two: what the difference is to be compared with.
    pub scale: f64,
}

/// Section d: the signals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Signals {
    /// What was compared with what.
    pub alignment: String,
    /// The first time at which both have a signal, s.
    pub from: f64,
    /// The last time at which both have a signal, s.
    pub to: f64,
    /// The common topics.
    pub channels: Vec<ChannelDifference>,
    /// In which order the fields parted: time and field.
    pub parted: Vec<Parting>,
    /// How the difference of the angles grew.
    pub growth: Vec<Growth>,
}

/// A topic that both have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ChannelDifference {
    /// The topic.
    pub topic: String,
    /// Messages of A.
    pub messages_a: u64,
    /// Messages of B.
    pub messages_b: u64,
    /// Messages compared with each other.
    pub pairs: u64,
    /// Pairs that are the same to the last bit.
    pub identical: u64,
    /// Messages of A within the time of both that B has no counterpart for.
    pub only_in_a: u64,
    /// Messages of B within the time of both that A has no counterpart for.
    pub only_in_b: u64,
    /// Messages of A beyond the end of B, or before its start.
    pub beyond_in_a: u64,
    /// Messages of B beyond the end of A, or before its start.
    pub beyond_in_b: u64,
    /// Messages that came too late to be compared: their times went backward.
    pub out_of_order: u64,
    /// The first text that differs: when, A's and B's.
    pub texts: Option<TextDifference>,
    /// Its fields, with derived ones at the end.
    pub fields: Vec<FieldDifference>,
}

impl Signals {
    /// How many fields differ and have a floor, and how many of them by no more than it.
    #[must_use]
    pub fn at_floor(&self) -> (usize, usize) {
        let judged = |field: &&FieldDifference| field.largest != 0.0 && field.floor.is_some();
        let fields = || self.fields().map(|(_, field)| field);
        let below = fields().filter(|field| field.is_below_floor).count();
        (fields().filter(judged).count(), below)
    }

    /// The fields of all topics.
    pub fn fields(&self) -> impl Iterator<Item = (&str, &FieldDifference)> {
        let channels = self.channels.iter();
        channels.flat_map(|channel| {
            channel
                .fields
                .iter()
                .map(|field| (channel.topic.as_str(), field))
        })
    }
}

impl ChannelDifference {
    /// Whether there are no messages of it at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.messages_a + self.messages_b == 0
    }
}

/// Two texts that differ.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TextDifference {
    /// When, s.
    pub time: f64,
    /// A's.
    pub a: String,
    /// B's.
    pub b: String,
    /// How many differ.
    pub count: u64,
}

/// A field that both have.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct FieldDifference {
    /// The field.
    pub field: String,
    /// Its unit.
    pub unit: String,
    /// Whether it is computed from others: angles between directions.
    pub is_derived: bool,
    /// Pairs of numbers.
    pub count: u64,
    /// Pairs of which one is not a number.
    pub not_numbers: u64,
    /// The difference of largest magnitude.
    pub largest: f64,
    /// When, s.
    pub at: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Mean.
    pub mean: f64,
    /// The largest magnitude of the field in either run.
    pub scale: f64,
    /// The largest difference over the scale.
    pub relative: f64,
    /// The largest number of doubles from one to the other, where it is all there is: below 2^16.
    pub ulp: Option<u64>,
    /// When the two were first not the same to the last bit, s.
    pub first_different: Option<f64>,
    /// When they were first apart by more than the tolerance, s, and how often.
    pub first_beyond: Option<f64>,
    /// How many pairs are apart by more than the tolerance.
    pub beyond: u64,
    /// The tolerance.
    pub tolerance: Tolerance,
    /// Largest error of interpolating one run at the other's times, as estimated by leaving out every
    /// eighth message; absent where nothing was interpolated.
    pub interpolation_error: Option<f64>,
    /// The errors of both integrators together, if they are known.
    pub floor: Option<f64>,
    /// Whether the difference is not larger than those.
    pub is_below_floor: bool,
}

/// When a field parted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Parting {
    /// When its difference reached the threshold, s; rounded up to the next power of two of it.
    pub time: f64,
    /// Topic and field.
    pub field: String,
    /// What kind of quantity it is: torque, acceleration, rate, angle.
    pub kind: String,
    /// The threshold, in the field's unit.
    pub threshold: f64,
}

/// The law by which a difference grew.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Growth {
    /// The field.
    pub field: String,
    /// The law.
    pub law: GrowthLaw,
    /// Its parameter: the exponent p of t^p, or the rate in 1/s of an exponential; 0 if bounded.
    pub parameter: f64,
    /// The part of the variance of the logarithm that the law explains; for a bounded difference, 1 less
    /// the part that a power law would explain.
    pub quality: f64,
}

/// Laws of growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GrowthLaw {
    /// It doesn't grow.
    Bounded,
    /// As a power of time.
    Power,
    /// Exponentially.
    Exponential,
}

/// Section e: what B's model does at the states that A went through, less what A's model does there.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Discrepancy {
    /// Number of states.
    pub states: u64,
    /// Components and magnitude of the torque of friction in the node frame, N m; frictional and whole
    /// accelerations, rad/s².
    pub quantities: Vec<Residual>,
}

/// A difference between two models along one motion.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Residual {
    /// The quantity.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The largest magnitude of the difference.
    pub largest: f64,
    /// When, s.
    pub at: f64,
    /// Root of the mean square of the difference.
    pub rms: f64,
    /// Root of the mean square of the quantity itself, by A's model.
    pub rms_a: f64,
}

/// Section f: how far each run would be from itself with a hundredth of its tolerances.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Floor {
    /// A's.
    pub a: IntegratorError,
    /// B's.
    pub b: IntegratorError,
}

/// The error of an integrator.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct IntegratorError {
    /// The relative tolerance of the run.
    pub relative_tolerance: f64,
    /// The relative tolerance that it was compared with.
    pub compared_with: f64,
    /// Fields and their largest differences.
    pub fields: Vec<(String, f64)>,
    /// Largest shift of an event, s.
    pub event_shift: f64,
    /// Largest difference of the mean of θ over a nutation, rad.
    pub theta_mean: f64,
}

/// The JSON Schemas of reports, as their files in `schemas/`: names and texts.
#[must_use]
pub fn schemas() -> [(&'static str, String); 2] {
    let text = |schema: schemars::Schema| format!("{:#}\n", schema.as_value());
    [
        (
            "toprise.DiffReport.json",
            text(schemars::schema_for!(Report)),
        ),
        (
            "toprise.DiffMatrix.json",
            text(schemars::schema_for!(super::Matrix)),
        ),
    ]
}
