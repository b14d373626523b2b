//! Small measurements that were read wrongly once: files of one top, in `tests/data/fit/cases`.

use crate::support::{Folder, assert_contains};
use serde_json::Value;
use std::path::Path;

const SIGMA: &str = "--signal theta:1mrad --signal phi:1mrad";

/// The rest of a command line for files of `cases`.
fn line(files: &str, options: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let cases = root.join("tests/data/fit/cases");
    let files: Vec<String> = files
        .split(' ')
        .map(|file| cases.join(file).display().to_string())
        .collect();
    format!(
        "fit {} {} --free friction.k,initial {options}",
        root.join("docs/example/mine.toml").display(),
        files.join(" ")
    )
}

fn report(files: &str, options: &str, status: i32) -> Value {
    let line = line(files, &format!("{options} --format json"));
    serde_json::from_str(&Folder::new().toprise(&line, status).stdout).unwrap()
}

/// An estimate and its standard deviation.
fn estimate(report: &Value, name: &str) -> [f64; 2] {
    let parameters = report["parameters"].as_array().unwrap();
    let found = parameters.iter().find(|p| p["name"] == name).unwrap();
    ["value", "sd"].map(|member| found[member].as_f64().unwrap())
}

fn assert_true_friction(report: &Value, name: &str) {
    let [k, sd] = estimate(report, "friction.k");
    assert!((k - 0.05).abs() < 4.0 * sd, "{name}: {k} ± {sd}");
    let [spin, sd] = estimate(report, "initial.psi_dot");
    assert!((spin - 230.0).abs() < 5.0 * sd, "{name}: {spin} ± {sd}");
}

#[test]
fn reads_what_tables_mean() {
    let plain = report("plain.csv", SIGMA, 0);
    assert_true_friction(&plain, "plain");
    for (name, files, options) in [
        ("parts of one recording", "part-0.csv part-1.csv", SIGMA),
        ("rows that are given twice", "rows-twice.csv", SIGMA),
    ] {
        let found = report(files, options, 0);
        for key in ["friction.k", "initial.psi_dot"] {
            let [[value, sd], [expected, expected_sd]] =
                [&found, &plain].map(|report| estimate(report, key));
            assert!(
                (value - expected).abs() < 1e-3 * sd,
                "{name} {key}: {value} {expected}"
            );
            assert!((sd / expected_sd - 1.0).abs() < 1e-3, "{name} {key}: {sd}");
        }
    }
    let twice = report("rows-twice.csv", SIGMA, 0);
    let left_out = &twice["files"][0]["left_out"][0];
    assert_eq!(
        (&left_out["reason"], &left_out["rows"]),
        (&"repeated".into(), &601.into())
    );
    let degrees = report("theta-deg.csv", "", 0);
    let columns = degrees["files"][0]["columns"].as_array().unwrap();
    let read: Vec<_> = columns
        .iter()
        .map(|column| (&column["measures"], &column["unit"]))
        .collect();
    assert_eq!(
        read,
        [
            (&"time".into(), &"s".into()),
            (&"/top/state.theta".into(), &"deg".into()),
            (&"/top/state.phi".into(), &"rad".into()),
        ] as [(&Value, &Value); 3]
    );
    assert_true_friction(&degrees, "degrees");
}

#[test]
fn measured_up_to_turns_and_signs() {
    for name in ["wrapped-one-outlier.csv", "unwrapped-one-outlier.csv"] {
        let found = report(name, &format!("{SIGMA} --loss huber"), 0);
        assert_true_friction(&found, name);
        assert_eq!(found["signals"][1]["outliers"], 1, "{name}");
    }
    let components = ["x", "y", "z", "w"]
        .map(|axis| format!("--signal /top/pose.orientation.{axis}=q{axis}:0.001"))
        .join(" ");
    for name in ["quaternion.csv", "quaternion-w-positive.csv"] {
        let found = report(name, &components, 0);
        assert_true_friction(&found, name);
    }
}

#[test]
fn refuses_what_cannot_be_meant() {
    for (files, options, expected) in [
        (
            "unclosed-quote.csv",
            SIGMA,
            "a quote in this line is not closed",
        ),
        ("plain.csv copy.csv", SIGMA, "repeats the values of"),
        ("days.csv", "", "the data span 6.94 × 10⁻⁵ s"),
        ("theta-negative.csv", "", "most values are negative"),
    ] {
        let stderr = Folder::new().toprise(&line(files, options), 2).stderr;
        assert_contains(&stderr, expected);
    }
}

#[test]
fn says_what_was_seen_of_data_without_such_a_motion() {
    for (files, expected) in [
        ("slow-motion.csv", "times slower than a top like this"),
        ("rest-before.csv", "nothing moves until t = 2 s: --start 2"),
    ] {
        let stderr = Folder::new().toprise(&line(files, SIGMA), 3).stderr;
        assert_contains(&stderr, expected);
    }
}

#[test]
fn compares_an_estimated_deviation_with_the_scatter() {
    let found = report("zeros.csv", "", 1);
    let signal = &found["signals"][0];
    let ratio = signal["sigma"].as_f64().unwrap() / signal["scatter"].as_f64().unwrap();
    assert!(ratio > 20.0, "{ratio}");
    let text = Folder::new().toprise(&line("zeros.csv", ""), 1).stdout;
    assert_contains(&text, "times the scatter");
    assert_contains(&text, "--loss huber");
}

#[test]
fn takes_times_from_messages() {
    let signals = "--signal theta=/cam.theta:1mrad --signal phi=/cam.phi:1mrad";
    let text = Folder::new()
        .toprise(&line("stamps.mcap", signals), 1)
        .stdout;
    assert_contains(&text, "--time timestamp");
    let found = report("stamps.mcap", &format!("{signals} --time timestamp"), 0);
    assert_true_friction(&found, "stamps");
}
