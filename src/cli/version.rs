//! The version of the program.

use crate::archive::provenance::Build;
use crate::telemetry::table;

/// The features of the program, each with whether it has the feature, its commands, and its options of other commands.
pub(super) const FEATURES: [(&str, bool, &[&str]); 3] = [
    ("fit", cfg!(feature = "fit"), &["fit"]),
    (
        "rerun",
        cfg!(feature = "rerun"),
        &["view", "--rrd", "--no-rrd", "--spawn", "--connect"],
    ),
    (
        "sweep",
        cfg!(feature = "sweep"),
        &["sweep", "--row", "--sweep"],
    ),
];

/// Version, telemetry version, features and build, for `--version`.
pub(super) fn long() -> String {
    let mut features = vec!["cli"];
    for (name, is_enabled, _) in FEATURES {
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
