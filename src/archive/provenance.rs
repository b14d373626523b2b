//! The build of this program: what an archive says of the software that made a file.
//!
//! No recording holds any of it but the version: recordings of one version have the same bytes, whoever built it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A build of toprise.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Build {
    /// Version.
    pub version: String,
    /// Commit of the source, and whether it was changed; absent if the build doesn't know.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// Target of the compiler.
    pub target: String,
    /// Name and version of the compiler.
    pub compiler: String,
    /// Cargo's profile, `release` or `debug`.
    pub profile: String,
}

impl Build {
    /// The build that runs.
    pub fn this() -> Self {
        let commit = option_env!("TOPRISE_BUILD_COMMIT").filter(|commit| !commit.is_empty());
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: commit.map(str::to_owned),
            target: env!("TOPRISE_BUILD_TARGET").to_owned(),
            compiler: env!("TOPRISE_BUILD_COMPILER").to_owned(),
            profile: env!("TOPRISE_BUILD_PROFILE").to_owned(),
        }
    }
}
