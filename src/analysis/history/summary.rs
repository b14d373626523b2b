//! A summary of a run's history.

use super::peg::PegSummary;
use schemars::JsonSchema;
use serde::Serialize;

/// A summary of a run. Numbers that were not recorded are absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct RunSummary {
    /// The reason for the run's end.
    pub stop_reason: Option<String>,
    /// Time of its end, s.
    pub stop_time: Option<f64>,
    /// Time at which the top had risen, s.
    pub rise_time: Option<f64>,
    /// Number of nutation cycles.
    pub nutations: Option<u64>,
    /// Energy at the start, J.
    pub energy_first: Option<f64>,
    /// Energy in the last sample, J.
    pub energy_last: Option<f64>,
    /// Work of friction, air drag and impacts up to the last sample, J.
    pub friction_work: Option<f64>,
    /// The largest deviation of the energy from that at the start and this work, J.
    pub energy_imbalance: Option<f64>,
    /// Length of the path slipped up to the last sample, m.
    pub slip_path: Option<f64>,
    /// The largest deviation of the angular momentum about the vertical, relative; absent for free pegs, which friction
    /// turns about the vertical.
    pub vertical_momentum_deviation: Option<f64>,
    /// Motion of a free peg.
    pub peg: Option<PegSummary>,
}
