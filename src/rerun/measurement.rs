//! Measured values that a run was fitted to.

pub(super) mod page;
pub(super) mod plots;
mod recorded;
pub(super) mod top;

use rerun::TextDocument;

use crate::telemetry::fields::{NumberField, pose, state};

/// Measured values, which are shown with the run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measurement {
    /// The signals.
    pub signals: Vec<MeasuredSignal>,
    /// The report on the fit, in Markdown.
    pub report: String,
}

/// Measured values of a field.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredSignal {
    /// The field.
    pub field: NumberField,
    /// The column or topic of the values.
    pub source: String,
    /// The values in order of time.
    pub values: Vec<MeasuredValue>,
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredValue {
    /// Time of the run, ns.
    pub time_ns: u64,
    /// The value, in the unit of its field.
    pub value: f64,
    /// Standard deviation.
    pub sigma: f64,
    /// (Run − value)/σ.
    pub residual: f64,
    /// Whether the value was predicted, not fitted.
    pub is_held_out: bool,
}

/// The angles of the top at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredPose {
    /// Time of the run, ns.
    pub(super) time_ns: u64,
    /// Inclination, rad.
    pub(super) theta: f64,
    /// Azimuth, rad.
    pub(super) phi: f64,
    /// Angle of the spin, rad; absent if it was not measured.
    pub(super) psi: Option<f64>,
}

/// Names of fields in titles; others are called by their paths.
const NAMES: [(NumberField, &str); 7] = [
    (state::THETA, "θ"),
    (state::PHI, "φ"),
    (state::PSI, "ψ"),
    (state::THETA_DOT, "dθ/dt"),
    (state::PHI_DOT, "dφ/dt"),
    (state::PSI_DOT, "dψ/dt"),
    (pose::OMEGA_BODY.z(), "ω·n, axial rate"),
];

/// Residuals beyond this many times their spread don't stretch the axes.
const FARTHEST: f64 = 6.0;

/// The smallest half range of an axis of residuals, σ.
const MIN_RANGE: f64 = 3.0;

impl Measurement {
    /// The paths of the signals' entities below those of their kinds. Signals of one field are numbered.
    pub(super) fn paths(&self) -> Vec<String> {
        let mut paths: Vec<String> = Vec::new();
        for (place, signal) in self.signals.iter().enumerate() {
            let field = signal.field;
            let mut path = format!("{}/{}", field.topic(), field.path().replace('.', "/"));
            let earlier = &self.signals[..place];
            let count = earlier.iter().filter(|other| other.field == field).count();
            if count > 0 {
                path += &format!("/{}", count + 1);
            }
            paths.push(path);
        }
        paths
    }

    /// The angles at the times at which both θ and φ were measured.
    pub(super) fn poses(&self) -> Vec<MeasuredPose> {
        let (Some(thetas), Some(phis)) = (self.values_of(state::THETA), self.values_of(state::PHI))
        else {
            return Vec::new();
        };
        let psis = self.values_of(state::PSI).unwrap_or_default();
        let mut poses = Vec::new();
        // Not interpolated: the angles of one row have equal times, and each file has a clock of its own.
        for theta in thetas {
            let time_ns = theta.time_ns;
            if let Some(phi) = value_at(phis, time_ns) {
                poses.push(MeasuredPose {
                    time_ns,
                    theta: theta.value,
                    phi,
                    psi: value_at(psis, time_ns),
                });
            }
        }
        poses
    }

    fn values_of(&self, field: NumberField) -> Option<&[MeasuredValue]> {
        let mut signals = self.signals.iter();
        let signal = signals.find(|signal| signal.field == field)?;
        Some(&signal.values)
    }

    /// A key to the colours, and the report.
    pub(super) fn document(&self) -> TextDocument {
        let mut key = "Orange: measured values. Blue: best fit, with ±2σ.".to_owned();
        if self.signals.iter().any(MeasuredSignal::has_held_out) {
            key += " Green: held-out values, which the fit predicts.";
        }
        let poses = self.poses();
        if let Some(pose) = poses.first() {
            key += " The orange top has the measured θ and φ";
            key += match pose.psi {
                Some(_) => ", and ψ.",
                None => "; its spin is that of the fit.",
            };
        }
        TextDocument::from_markdown(format!("{key}\n\n{}", self.report))
    }
}

impl MeasuredSignal {
    /// The name in titles. Where several signals measure the field, it contains the source.
    pub(super) fn name(&self, measurement: &Measurement) -> String {
        let known = NAMES.iter().find(|(field, _)| *field == self.field);
        let name = known.map_or(self.field.path(), |(_, name)| name);
        let signals = measurement.signals.iter();
        let count = signals.filter(|other| other.field == self.field).count();
        if count > 1 {
            format!("{name} from {}", self.source)
        } else {
            name.to_owned()
        }
    }

    /// Half the range of an axis on which most residuals are seen: a whole number of σ.
    pub(super) fn residual_limit(&self) -> f64 {
        /// Median of the size of a normal number with standard deviation 1.
        const MEDIAN: f64 = 0.6745;
        let mut sizes: Vec<f64> = self.values.iter().map(|v| v.residual.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let (Some(median), Some(greatest)) = (sizes.get(sizes.len() / 2), sizes.last()) else {
            return MIN_RANGE;
        };
        let limit = FARTHEST * (median / MEDIAN).max(1.0);
        greatest.min(limit).max(MIN_RANGE).ceil()
    }

    /// The least and the greatest of the values whose residuals are within a limit; reversed infinite bounds without any.
    pub(super) fn range(&self, limit: f64) -> [f64; 2] {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for value in &self.values {
            if value.residual.abs() <= limit {
                range = [range[0].min(value.value), range[1].max(value.value)];
            }
        }
        range
    }

    /// Whether a part of the values was predicted, not fitted.
    fn has_held_out(&self) -> bool {
        self.values.iter().any(|value| value.is_held_out)
    }

    /// Whether the last value is above the first.
    pub(super) fn is_rising(&self) -> bool {
        match (self.values.first(), self.values.last()) {
            (Some(first), Some(last)) => last.value > first.value,
            (Some(_), None) | (None, Some(_) | None) => false,
        }
    }

    /// The number of values whose residuals are beyond a limit.
    pub(super) fn count_beyond(&self, limit: f64) -> usize {
        let values = self.values.iter();
        values.filter(|value| value.residual.abs() > limit).count()
    }
}

/// The value at exactly this time.
fn value_at(values: &[MeasuredValue], time_ns: u64) -> Option<f64> {
    let place = values.binary_search_by_key(&time_ns, |value| value.time_ns);
    place.ok().map(|place| values[place].value)
}
