//! The version of the program.

use crate::archive::provenance::Build;
use crate::telemetry::table;

/// The features that this program was compiled with.
const FEATURES: [(&str, bool); 3] = [
    ("fit", cfg!(feature = "fit")),
    ("rerun", cfg!(feature = "rerun")),
    ("sweep", cfg!(feature = "sweep")),
];

/// Version, telemetry version, features and build, for `--version`.
pub(super) fn long() -> String {
    let mut features = vec!["cli"];
    for (name, is_enabled) in FEATURES {
        if is_enabled {
            features.push(name);
        }
    }
    let build = Build::this();
    let commit = build
        .commit
        .as_deref()
        .unwrap_or(match build.profile.as_str() {
            "release" => "unknown: built from neither a checkout nor a package",
            _ => "unknown: only release builds name it",
        });
    format!(
        "{}\ntelemetry {}\nfeatures {}\ncommit {commit}\ntarget {}\ncompiler {}\nprofile {}",
        build.version,
        table::VERSION,
        features.join(", "),
        build.target,
        build.compiler,
        build.profile
    )
}
