//! The report of a fit.

use super::conclusion::Conclusion;
use super::failure::{self, Failure};
use super::note::{self, Note};
use crate::fit::problem::model::Loss;
use crate::measured::FileReading;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The result of a fit as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model describes the data and, if laws were compared, one of them is clearly best.
    Fitted,
    /// The model does not describe the data: p < 0.001, or the residuals are not white or have a mean, or an estimated
    /// standard deviation is far above the scatter of the data. In a comparison, none of the laws describes them.
    BadFit,
    /// Laws were compared, and the data can't tell them apart.
    Undecided,
    /// No minimum was found.
    NotConverged,
}

/// Result of fitting a scenario to data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// The result as a whole.
    pub verdict: Verdict,
    /// The scenario's name.
    pub scenario: String,
    /// Law of friction whose parameters and signals are reported: the preferred one of a comparison, or the scenario's.
    pub law: String,
    /// Time in the data at which the scenario starts, s.
    pub origin: f64,
    /// How residuals count.
    pub loss: Loss,
    /// End of the data that were fitted, s after the start.
    pub until: f64,
    /// The signals.
    pub signals: Vec<SignalReport>,
    /// What was read of each file.
    #[serde(default)]
    pub files: Vec<FileReading>,
    /// Parts of recordings that could not be read.
    pub losses: Vec<String>,
    /// Remarks on the data and on what they determine.
    #[serde(
        flatten,
        serialize_with = "note::NoteMembers::serialize",
        deserialize_with = "note::NoteMembers::deserialize"
    )]
    #[schemars(with = "note::NoteMembers")]
    pub notes: Vec<Note>,
    /// The parameters.
    pub parameters: Vec<Estimate>,
    /// Correlations between parameters that are above 0.9.
    pub correlations: Vec<Correlation>,
    /// Goodness of the fit.
    pub quality: Quality,
    /// Other minima within Δχ² < 6.
    pub modes: Vec<Mode>,
    /// Profile likelihoods.
    pub profiles: Vec<Profile>,
    /// The comparison of laws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
    /// Number of simulations.
    pub evaluations: u64,
}

/// A signal and its residuals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SignalReport {
    /// The field of the simulation.
    pub field: String,
    /// The column or topic.
    pub source: String,
    /// Number of the file, from 1.
    pub file: usize,
    /// Unit; empty for pure numbers.
    pub unit: String,
    /// Standard deviation; the median if it varies.
    pub sigma: f64,
    /// Whether the standard deviation was estimated from the residuals.
    pub is_sigma_estimated: bool,
    /// Number of samples in the fit.
    pub samples: usize,
    /// Number of rows without a value.
    pub missing: u64,
    /// Number of samples that are neither fitted nor held out: before the start or after the end, or at times of another
    /// file's clock at which there is no motion.
    pub outside: usize,
    /// Number of rows that were earlier than the row before them.
    pub out_of_order: u64,
    /// Root mean square of the residuals, in σ.
    pub rms: f64,
    /// Root mean square of the residuals in the held-out part, in σ; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_out_rms: Option<f64>,
    /// Number of samples in the held-out part.
    pub held_out_samples: usize,
    /// Number of residuals above 5 σ.
    pub outliers: usize,
    /// p-value of the Ljung–Box test for uncorrelated residuals; absent if it can't be made, or if the residuals are
    /// below 0.1 σ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub whiteness: Option<f64>,
    /// Mean of the residuals, in σ.
    pub mean: f64,
    /// p-value of a mean of zero; absent if the residuals are below 0.1 σ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_p_value: Option<f64>,
    /// Standard deviation of the scatter between neighbours; absent if the standard deviation was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scatter: Option<f64>,
}

impl SignalReport {
    /// Whether more than half of the residuals are outliers: the fit describes a minority.
    pub(crate) fn is_mostly_outliers(&self) -> bool {
        2 * self.outliers > self.samples
    }

    /// The estimated standard deviation, in that of the scatter between neighbours, if it is many times larger: the fit does
    /// not describe the data then.
    pub(crate) fn excess_scatter(&self) -> Option<f64> {
        /// Noise and its estimates from neighbours differ by less, also if it is correlated a little.
        const MAX_RATIO: f64 = 5.0;
        let ratio = self.sigma / self.scatter?;
        Some(ratio).filter(|ratio| *ratio > MAX_RATIO)
    }
}

/// A parameter and its uncertainty.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// Name of the parameter.
    pub name: String,
    /// Unit; may be empty.
    pub unit: String,
    /// Value at the start of the fit.
    pub start: f64,
    /// The estimate; the bound for a parameter at its bound.
    pub value: f64,
    /// Standard deviation; absent for a parameter at a bound, or one that the data don't determine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sd: Option<f64>,
    /// 95 % interval, from the curvature of χ². It reaches over all minima in `modes`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval: Option<[f64; 2]>,
    /// One-sided 95 % limit, for a parameter at a bound or not clearly above zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<Limit>,
}

/// A one-sided limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// The parameter is below this.
    Below(f64),
    /// The parameter is above this.
    Above(f64),
    /// It is at its bound; the limit was not computed.
    AtBound,
    /// The data don't limit it.
    None,
}

/// A correlation of two parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Correlation {
    /// Names of the parameters.
    pub parameters: [String; 2],
    /// Coefficient of correlation.
    pub correlation: f64,
}

/// Goodness of a fit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Quality {
    /// Sum of the squared residuals, in σ²; with Huber's loss, that loss.
    pub chi2: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Probability of a larger χ²; absent with estimated standard deviations and with Huber's loss.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub p_value: Option<f64>,
    /// Whether a minimum was found.
    pub is_converged: bool,
    /// Akaike's information criterion.
    pub aic: f64,
    /// Bayes's information criterion.
    pub bic: f64,
}

/// Another minimum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Mode {
    /// χ² above that of the best minimum.
    pub delta_chi2: f64,
    /// Values of the parameters, in their order.
    pub values: Vec<f64>,
    /// Standard deviations.
    pub sds: Vec<f64>,
}

/// The profile likelihood of a parameter: χ² minimised over all others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Profile {
    /// The parameter.
    pub parameter: String,
    /// Values, ascending.
    pub values: Vec<f64>,
    /// χ² above the minimum for each value.
    pub delta_chi2: Vec<f64>,
    /// Interval with Δχ² < 1 (68.3 %); sides on which it is not reached within the bounds are
    /// absent.
    pub interval_1: [Option<f64>; 2],
    /// Interval with Δχ² < 4 (95.4 %).
    pub interval_4: [Option<f64>; 2],
    /// Largest relative difference of the half widths at Δχ² = 4 from twice the standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curvature_error: Option<f64>,
}

/// Comparison of laws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "ComparisonReport")]
pub struct Comparison {
    /// The laws by BIC, lowest first. If it is decided, the first one is preferred.
    pub laws: Vec<LawFit>,
    /// Extensions of the data that are expected to decide between the two best laws, if undecided; none if no small one
    /// does.
    pub extensions: Vec<Extension>,
}

/// Comparison of laws.
#[derive(Serialize, JsonSchema)]
struct ComparisonReport {
    /// The laws by BIC, lowest first. If it is decided, the first one is preferred.
    laws: Vec<LawFit>,
    /// Whether one law is clearly best and describes the data.
    is_decided: bool,
    /// The verdict in a sentence.
    sentence: String,
    /// The verdict with its numbers.
    conclusion: Conclusion,
    /// Extensions of the data that are expected to decide between the two best laws, if undecided; none if no small one
    /// does.
    extensions: Vec<Extension>,
}

impl From<Comparison> for ComparisonReport {
    fn from(comparison: Comparison) -> Self {
        let conclusion = comparison.conclusion();
        Self {
            is_decided: comparison.is_decided(),
            sentence: conclusion.sentence().to_string(),
            conclusion,
            laws: comparison.laws,
            extensions: comparison.extensions,
        }
    }
}

/// As it is serialized: with the conclusion.
impl JsonSchema for Comparison {
    fn schema_name() -> Cow<'static, str> {
        "Comparison".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        ComparisonReport::json_schema(generator)
    }
}

/// The fit of one law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LawFit {
    /// The law.
    pub law: String,
    /// The verdict on this law alone: fitted, bad fit or not converged.
    pub verdict: Verdict,
    /// The law inside this one whose motion is the best of this one, too: its own parameters can't be determined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduces_to: Option<String>,
    /// Goodness of the fit; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quality: Option<Quality>,
    /// Lowest p-value of the tests of the residuals for correlations and a mean of zero; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_p_value: Option<f64>,
    /// AIC above the lowest; absent if there is no fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delta_aic: Option<f64>,
    /// BIC above the lowest; absent if there is no fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delta_bic: Option<f64>,
    /// Standard deviation of each signal; the median if it varies. Estimated ones are those of this law.
    pub sigmas: Vec<f64>,
    /// Root mean square of the residuals in the held-out part, in σ; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_out_rms: Option<f64>,
    /// The parameters of the law, and the others.
    pub parameters: Vec<Estimate>,
    /// Why there is no fit; other members are then meaningless.
    #[serde(
        flatten,
        serialize_with = "failure::FailureMembers::serialize",
        deserialize_with = "failure::FailureMembers::deserialize"
    )]
    #[schemars(with = "failure::FailureMembers")]
    pub failure: Option<Failure>,
}

/// An extension of the data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Extension {
    /// What is extended.
    pub kind: ExtensionKind,
    /// The new duration (s), or the factor of the number of samples; 1 for another signal.
    pub amount: f64,
    /// Expected Δχ² between the two laws.
    pub delta_chi2: f64,
}

/// Kind of an extension of the data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExtensionKind {
    /// A longer measurement.
    Longer,
    /// More samples in the same time, or repetitions.
    Finer,
    /// Measuring φ, too.
    Azimuth,
    /// Measuring θ, too.
    Inclination,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value as Json, json};

    /// A report in which the search was given up, and in which a law could not be fitted.
    fn report() -> Json {
        let quality = json!({
            "chi2": 300.0, "freedom": 297, "p_value": 0.4, "is_converged": true, "aic": 310.0, "bic": 320.0,
        });
        let law = |name| {
            json!({
                "law": name, "verdict": "fitted", "quality": quality, "delta_aic": 0.0, "delta_bic": 0.0, "sigmas": [0.001],
                "parameters": [],
            })
        };
        let mut failed = law("viscous");
        failed["verdict"] = json!("not_converged");
        failed["failure"] =
            json!("the model ends at t = 1.0000 s (it falls), the data at 2.0000 s");
        json!({
            "verdict": "fitted", "scenario": "paper", "law": "coulomb", "origin": 0.0, "loss": "squares", "until": 5.0,
            "signals": [], "losses": [], "notes": ["The search was given up."], "parameters": [], "correlations": [],
            "quality": quality, "modes": [], "profiles": [], "evaluations": 1,
            "comparison": {
                "laws": [law("coulomb"), failed], "is_decided": true, "sentence": "coulomb describes the data.",
                "extensions": [],
            },
        })
    }

    #[test]
    fn reports_without_facts_keep_their_sentences() {
        let old = report();
        let report: Report = serde_json::from_value(old.clone()).unwrap();
        let new = serde_json::to_value(&report).unwrap();
        assert_eq!(new["notes"], old["notes"]);
        let [before, after] = [&old, &new].map(|report| &report["comparison"]);
        assert_eq!(after["sentence"], before["sentence"]);
        assert_eq!(after["is_decided"], before["is_decided"]);
        assert_eq!(after["laws"][1]["failure"], before["laws"][1]["failure"]);
        assert_eq!(after["laws"][0].get("failure"), None);
    }

    #[test]
    fn facts_are_read_back() {
        let mut report: Report = serde_json::from_value(report()).unwrap();
        report.notes = vec![Note::SpinsTried {
            range: [120.0, 300.5],
            is_complete: false,
        }];
        if let Some(comparison) = &mut report.comparison {
            comparison.laws[1].failure = Some(Failure::TooManySteps);
        }
        let json = serde_json::to_value(&report).unwrap();
        assert_eq!(
            json["remarks"],
            json!([{ "spins_tried": { "range": [120.0, 300.5], "is_complete": false } }])
        );
        assert_eq!(
            json["comparison"]["conclusion"]["decided"]["law"],
            "coulomb"
        );
        assert_eq!(serde_json::from_value::<Report>(json).unwrap(), report);
    }
}
