//! The report of what happened in one run.

use super::peg::PegReport;
use schemars::JsonSchema;
use serde::Serialize;

/// What happened in one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct CourseReport {
    /// Why the run ended.
    pub stop_reason: Option<String>,
    /// Time at which the run ended, s.
    pub stop_time: Option<f64>,
    /// Time at which the top had risen, s: when θ first reached the scenario's `stop.theta_risen`.
    pub rise_time: Option<f64>,
    /// Time of the last sample, s: integrals over the run end there.
    pub last_sample: Option<f64>,
    /// Number of whole nutation cycles.
    pub nutations: Option<u64>,
    /// Mechanical energy at the first sample, J.
    pub energy_first: Option<f64>,
    /// Mechanical energy at the last sample, J.
    pub energy_last: Option<f64>,
    /// Work of friction up to the last sample, J, as the integrator summed it.
    pub friction_work: Option<f64>,
    /// Work of friction about the line of nodes (on the nutation), the perpendicular n × e_N (on the precession) and
    /// the symmetry axis (on the spin), J: as the integrator summed it, or in recordings of the first version of the telemetry
    /// integrated from the samples. None where the peg is free.
    pub friction_work_node: Option<[f64; 3]>,
    /// Length of the path that the contact point slipped, m.
    pub slip_path: Option<f64>,
    /// Spin rate ψ̇ when the run stopped, rad/s.
    pub spin_rate_last: Option<f64>,
    /// Precession rate φ̇ when the run stopped, rad/s.
    pub precession_rate_last: Option<f64>,
    /// Largest change of the angular momentum about the vertical, as a part of its first value; none where the peg is free.
    pub vertical_momentum_drift: Option<f64>,
    /// Largest difference between the energy and the first energy plus the work of friction, J.
    pub energy_imbalance: Option<f64>,
    /// What the peg did, if it is free.
    pub peg: Option<PegReport>,
}
