//! The recordings that are written: of a run, of a run with its explanation, and of two runs that are compared.

mod events;
pub(super) mod explained;
pub(super) mod pair;
mod properties;
pub(super) mod run;
pub(super) mod stream;
pub(super) mod why;
