//! Three or more runs, compared with each other.

use super::report::{ComparedRun, Report};
use schemars::JsonSchema;
use serde::Serialize;

/// Several runs, each compared with the first.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Matrix {
    /// The runs, in the order in which they were given.
    pub runs: Vec<MatrixRow>,
    /// For each two runs the root mean square difference of θ averaged over nutations, rad; absent where it
    /// can't be computed.
    pub theta_distance: Vec<Vec<Option<f64>>>,
    /// Each of the others compared with the first.
    pub against_first: Vec<Report>,
}

/// A run among others.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MatrixRow {
    /// The run's name.
    pub name: String,
    /// Why the run ended.
    pub stop_reason: Option<String>,
    /// When the top had risen, s.
    pub rise_time: Option<f64>,
    /// Energy lost up to the last sample, J.
    pub energy_lost: Option<f64>,
    /// Number of whole nutation cycles.
    pub nutations: Option<u64>,
}

impl Matrix {
    /// Puts the reports of all pairs together: `pairs(i, j)` for i < j. Two that can't be compared have no
    /// distance, but each must be comparable with the first.
    ///
    /// # Errors
    /// The first error of `pairs` with the first run.
    pub fn new<E>(
        count: usize,
        mut pairs: impl FnMut(usize, usize) -> Result<Report, E>,
    ) -> Result<Self, E> {
        let mut theta_distance = vec![vec![None; count]; count];
        let mut runs = Vec::new();
        let mut against_first = Vec::new();
        for (at, row) in theta_distance.iter_mut().enumerate() {
            row[at] = Some(0.0);
        }
        for (i, j) in (0..count).flat_map(|i| (i + 1..count).map(move |j| (i, j))) {
            let report = match pairs(i, j) {
                Ok(report) => report,
                Err(error) if i == 0 => return Err(error),
                Err(_) => continue,
            };
            let averaged = report.averaged.as_ref();
            let distance = averaged.and_then(|a| a.means.first()).map(|mean| mean.rms);
            theta_distance[i][j] = distance;
            theta_distance[j][i] = distance;
            if i == 0 {
                if runs.is_empty() {
                    runs.push(row(&report.a));
                }
                runs.push(row(&report.b));
                against_first.push(report);
            }
        }
        Ok(Self {
            runs,
            theta_distance,
            against_first,
        })
    }
}

fn row(run: &ComparedRun) -> MatrixRow {
    let course = run.course.clone().unwrap_or_default();
    MatrixRow {
        name: run.name.clone(),
        energy_lost: course
            .energy_first
            .zip(course.energy_last)
            .map(|(first, last)| first - last),
        stop_reason: course.stop_reason,
        rise_time: course.rise_time,
        nutations: course.nutations,
    }
}
