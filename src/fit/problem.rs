//! What is fitted: the request, its free parameters, and the model with the data, after the checks of what the data can
//! determine.

pub(in crate::fit) mod degeneracy;
pub(in crate::fit) mod identify;
pub(in crate::fit) mod law;
pub(in crate::fit) mod meeting;
pub(in crate::fit) mod model;
pub(in crate::fit) mod parameter;
pub(in crate::fit) mod plausibility;
pub(in crate::fit) mod prepare;
pub(in crate::fit) mod request;
pub(in crate::fit) mod turns;
