//! The Rerun side of commands.

#[cfg(feature = "fit")]
mod attached;
#[cfg(not(feature = "fit"))]
mod attached {
    /// No report can be read.
    pub(super) fn report(_json: &[u8]) -> Option<String> {
        None
    }
}
pub(super) mod diff;
#[cfg(feature = "fit")]
pub(super) mod fit;
pub(super) mod run;
pub(super) mod view;
pub(super) mod viewer;
