//! The search for minima of χ²: growing windows of data, other spins, the offsets of clocks, and estimated standard
//! deviations.

pub(in crate::fit) mod derivatives;
pub(in crate::fit) mod extension;
pub(in crate::fit) mod first;
pub(in crate::fit) mod fitted;
pub(in crate::fit) mod modes;
pub(in crate::fit) mod monitor;
pub(in crate::fit) mod objective;
pub(in crate::fit) mod offset;
pub(in crate::fit) mod scan;
pub(in crate::fit) mod sigma;
pub(in crate::fit) mod solve;
pub(in crate::fit) mod spin_guess;
pub(in crate::fit) mod step_limit;
