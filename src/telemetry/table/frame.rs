//! The frames that components of vectors refer to, as recordings name them.

pub(in crate::telemetry) const BODY: &str = "body";
pub(super) const WORLD: &str = "world";
pub(super) const NODE: &str = "node: x line of nodes, y perpendicular n × e_N, z symmetry axis";
