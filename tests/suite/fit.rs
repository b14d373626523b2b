//! `toprise fit`.

use crate::support::{Folder, assert_contains, scenario};
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use toprise::fit::{
    Data, Layout, Loss, Note, Report, Request, Signal, SignalSpec, Verdict, fit, read, read_bytes,
    sensitivities, usual_parameters,
};
use toprise::run::scenario::{Preset, Scenario};
use toprise::run::simulation::{Record, Simulation, sample_at};
use toprise::telemetry::fields::{NumberField, pose, state};
use toprise::words::{Argument, Part, markdown};

/// A file of measured data or of its reference. Its path doesn't depend on the current directory: the suite may run in any.
fn data_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/fit")
        .join(name)
}

fn json_file(name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(data_file(name)).unwrap()).unwrap()
}

/// Numbers of two independent integrators, with exact derivatives: see tests/data/README.md.
fn reference() -> Value {
    json_file("reference.json")
}

pub(crate) fn preset(name: &str) -> Scenario {
    Preset::find(name).unwrap().scenario().unwrap()
}

/// Deterministic normal noise: a linear congruential generator and the sum of twelve uniform numbers.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Measures fields of a scenario's motion at a rate, Hz, for a time, s, with noise of these standard deviations.
pub(crate) fn measure(
    scenario: &Scenario,
    rate: f64,
    duration: f64,
    fields: &[(NumberField, f64)],
    noise: Option<u64>,
) -> Data {
    let count = (duration * rate).floor() as usize;
    let times: Vec<f64> = (0..=count).map(|i| i as f64 / rate).collect();
    let mut columns = vec![Vec::new(); fields.len()];
    sample_at(scenario, &times, &mut |_, sample| {
        for (column, (field, _)) in columns.iter_mut().zip(fields) {
            column.push(field.of_sample(sample));
        }
    })
    .unwrap();
    let mut generator = Noise(noise.unwrap_or_default());
    let mut signals = Vec::new();
    for (mut column, (field, sigma)) in columns.into_iter().zip(fields) {
        assert_eq!(column.len(), times.len());
        for value in &mut column {
            if noise.is_some() {
                *value += sigma * generator.normal();
            }
        }
        signals.push(Signal::from_values(*field, &times, &column, Some(*sigma)).unwrap());
    }
    Data {
        starts_with_run: true,
        ..Data::from_signals(signals)
    }
}

pub(crate) const THETA_PHI: [(NumberField, f64); 2] = [(state::THETA, 1e-3), (state::PHI, 1e-3)];

#[test]
fn val_derivatives_equal_the_reference() {
    let fields = [
        ("theta", state::THETA),
        ("phi", state::PHI),
        ("psi", state::PSI),
        ("theta_dot", state::THETA_DOT),
        ("phi_dot", state::PHI_DOT),
        ("psi_dot", state::PSI_DOT),
    ];
    // With the steps of the differences.
    let keys = [
        ("d/dk", "friction.k", 3e-8),
        ("d/dtheta0", "initial.theta", 5e-7),
        ("d/dphid0", "initial.phi_dot", 2.5e-6),
        ("d/dthetad0", "initial.theta_dot", 1e-6),
        ("d/dpsid0", "initial.psi_dot", 1.7e-4),
        ("d/dIx", "top.transverse_moment", 8.52e-11),
        ("d/dIz", "top.axial_moment", 7.25e-11),
        ("d/dM", "top.mass", 1.1e-7),
    ];
    let times = [1.0, 5.0, 10.0, 20.0, 24.0];
    let mut signals = Vec::new();
    for (_, field) in fields {
        signals.push(Signal::from_values(field, &times, &[0.0; 5], Some(1.0)).unwrap());
    }
    let data = Data {
        starts_with_run: true,
        ..Data::from_signals(signals)
    };
    let free = keys.map(|(_, key, _)| key);
    let columns = sensitivities(&Request::new(preset("full-coulomb"), data, &free)).unwrap();
    let reference = reference();
    for (symbol, key, step) in keys {
        let (_, column) = columns.iter().find(|(name, _)| name == key).unwrap();
        for (row, (name, _)) in fields.iter().enumerate() {
            // Derivatives oscillate with the nutation. Where one passes through zero, its size at other times counts.
            let entry = |time: &str| {
                reference["derivatives"][time][name][symbol]
                    .as_f64()
                    .unwrap()
            };
            let all = times.map(|time| entry(&format!("t={time}")));
            for (at, expected) in all.iter().enumerate() {
                let found = column[row * times.len() + at];
                let largest = all.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
                let scale = expected.abs().max(0.1 * largest);
                // The integrator's error, 1e-12 of the value, is divided by the step.
                let value = reference["derivatives"][format!("t={}", times[at])][name]["value"]
                    .as_f64()
                    .unwrap();
                let rounding = 1e-12 * value.abs() / step;
                let error = (found - expected).abs();
                assert!(
                    error < 1e-5 * scale + rounding,
                    "{name} {symbol} t={}: {found} {expected} {error:e}",
                    times[at]
                );
            }
        }
    }
}

#[test]
fn val_standard_deviations_equal_cramer_and_rao() {
    let reference = reference();
    let names = [
        ("k", "friction.k"),
        ("phi0", "initial.phi"),
        ("theta0", "initial.theta"),
        ("phid0", "initial.phi_dot"),
        ("thetad0", "initial.theta_dot"),
        ("psid0", "initial.psi_dot"),
    ];
    for (duration, key) in [(1.0, "T=1"), (5.0, "T=5"), (20.0, "T=20")] {
        let scenario = preset("full-coulomb");
        let data = measure(&scenario, 100.0, duration, &THETA_PHI, None);
        for (free, set) in [
            (&["friction.k"][..], "k"),
            (&["friction.k", "initial"][..], "k+initial"),
        ] {
            let report = fit(&Request::new(scenario.clone(), data.clone(), free), &|_| {})
                .unwrap()
                .report;
            let expected = &reference["crlb"]["theta+phi 100 Hz 1 mrad"][key][set]["sd"];
            for (symbol, name) in names {
                let Some(expected) = expected[symbol].as_f64() else {
                    continue;
                };
                let estimate = report.parameters.iter().find(|p| p.name == name).unwrap();
                let found = estimate.sd.unwrap();
                let error = (found / expected - 1.0).abs();
                assert!(
                    error < 1e-3,
                    "{key} {set} {name}: {found} {expected} {error:e}"
                );
            }
        }
    }
}

/// The keys of the data sets that another integrator made; see tests/data/README.md.
pub(crate) fn data_set(name: &str) -> (Value, Scenario) {
    let set = json_file(&format!("{name}.json"));
    let truth = set["truth"]["values"].as_object().unwrap();
    let start = set["start"].as_object().unwrap();
    let tops = truth
        .iter()
        .filter(|(key, _)| key.starts_with("top.") || *key == "gravity");
    let changes: Vec<(&str, toml::Value)> = tops
        .chain(start)
        .filter(|(key, _)| *key != "offset")
        .map(|(key, value)| (key.as_str(), value.as_f64().unwrap().into()))
        .collect();
    let scenario = preset("full-coulomb").with(changes).unwrap();
    (set, scenario)
}

/// Reads CSV files of a data set with these signals.
pub(crate) fn data(files: &[&str], signals: &[&str]) -> Data {
    let files: Vec<_> = files.iter().map(|file| data_file(file)).collect();
    let specs: Vec<_> = signals
        .iter()
        .map(|text| SignalSpec::parse(text).unwrap())
        .collect();
    read(&files, &specs, &Layout::default()).unwrap()
}

/// A report in words.
fn text(report: &Report) -> String {
    markdown(&report.words(false).sections, Argument::plain)
}

/// What a comparison of laws has shown, in a sentence.
fn conclusion(report: &Report) -> String {
    let comparison = report.comparison.as_ref().unwrap();
    comparison.conclusion().sentence().to_string()
}

/// The estimates in the table of parameters.
fn estimates(report: &Report) -> Vec<String> {
    let sections = report.words(false).sections;
    let mut parts = sections.iter().flat_map(|section| &section.parts);
    let table = parts.find_map(|part| match part {
        Part::Table(table) => Some(table),
        Part::Line(_) | Part::Paragraph(_) | Part::Code(_) => None,
    });
    let rows = &table.unwrap().rows;
    rows.iter().map(|row| row[1].to_string()).collect()
}

/// Checks that the estimates are within some standard deviations of the reference.
fn assert_near(report: &Report, reference: &Value, deviations: f64) {
    for (name, expected) in reference["estimate"].as_object().unwrap() {
        let estimate = report.parameters.iter().find(|p| p.name == *name).unwrap();
        let sd = reference["sd"][name].as_f64().unwrap();
        let error = (estimate.value - expected.as_f64().unwrap()).abs() / sd;
        assert!(
            error < deviations,
            "{name}: {} {expected} {error}",
            estimate.value
        );
    }
}

#[test]
fn val_outliers_are_recovered_with_a_robust_loss_only() {
    let (set, scenario) = data_set("outliers");
    let data = data(&["outliers.csv"], &["theta:1mrad", "phi:1mrad"]);
    let mut request = Request::new(scenario, data, &["friction.k", "initial"]);
    let plain = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(plain.verdict, Verdict::BadFit);
    assert!(plain.quality.chi2 > 10.0 * plain.quality.freedom as f64);
    request.loss = Loss::Huber;
    let robust = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(robust.verdict, Verdict::Fitted);
    assert_near(&robust, &set["reference"]["without_outlier_rows"], 4.0);
    let huber = &set["reference"]["huber_1_345_all_rows"]["estimate"];
    for estimate in &robust.parameters {
        let expected = huber[&estimate.name].as_f64().unwrap();
        // The same minimum: the reference has nine digits.
        let error = (estimate.value - expected).abs() / estimate.sd.unwrap();
        assert!(
            error < 1e-2,
            "{}: {} {expected}",
            estimate.name,
            estimate.value
        );
    }
}

#[test]
fn val_clock_offsets_are_found() {
    let (set, scenario) = data_set("offset");
    let files = ["offset_camera.csv", "offset_gyro.csv"];
    let signals = [
        "theta:1.5mrad",
        "phi:1.5mrad",
        "omega_n:0.05",
        "theta_dot:0.03",
    ];
    let data = data(&files, &signals);
    let report = fit(
        &Request::new(scenario, data, &["friction.k", "initial", "offset"]),
        &|_| {},
    )
    .unwrap()
    .report;
    assert_eq!(report.verdict, Verdict::Fitted);
    let reference = &set["reference"]["both"];
    assert_near(&report, reference, 0.01);
    let chi2 = reference["chi2"].as_f64().unwrap();
    assert!(
        (report.quality.chi2 - chi2).abs() < 1e-3,
        "{}",
        report.quality.chi2
    );
    assert_eq!(report.quality.freedom, 4797);
}

#[test]
fn val_distinguishes_stribeck_from_other_laws() {
    let (set, scenario) = data_set("stribeck");
    let data = data(
        &["stribeck.csv"],
        &["theta:2mrad", "phi:2mrad", "psi_dot:0.3"],
    );
    let mut request = Request::new(scenario, data, &["friction.k", "initial"]);
    request.compare = ["coulomb", "viscous", "stribeck"]
        .map(str::to_owned)
        .to_vec();
    let fitted = fit(&request, &|_| {}).unwrap();
    let report = fitted.report;
    // The scenario's own law is Coulomb's, which does not describe these data.
    assert_eq!(
        (report.verdict, report.law.as_str()),
        (Verdict::Fitted, "stribeck")
    );
    let mut parameters = report.parameters.iter();
    assert!(parameters.any(|p| p.name == "friction.static_k"));
    assert!(fitted.scenario.to_toml().contains("\"stribeck\""));
    let comparison = report.comparison.unwrap();
    assert!(comparison.is_decided(), "{:?}", comparison.conclusion());
    assert_eq!(comparison.laws[0].law, "stribeck");
    for law in &comparison.laws {
        let chi2 = set["reference"][&law.law]["chi2"].as_f64().unwrap();
        let quality = law.quality.as_ref().unwrap();
        assert!(quality.chi2 < chi2 + 0.5, "{} {}", law.law, quality.chi2);
        assert_eq!(quality.p_value.unwrap() < 1e-3, law.law != "stribeck");
        assert_eq!(law.verdict == Verdict::Fitted, law.law == "stribeck");
    }
    assert_eq!(
        (comparison.laws[0].delta_aic, comparison.laws[0].delta_bic),
        (Some(0.0), Some(0.0))
    );
}

#[test]
fn laws_without_free_parameters_are_evaluated() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(3));
    let mut request = Request::new(truth, data, &["friction.k"]);
    request.compare = ["coulomb", "none"].map(str::to_owned).to_vec();
    let comparison = fit(&request, &|_| {}).unwrap().report.comparison.unwrap();
    let none = comparison
        .laws
        .iter()
        .find(|law| law.law == "none")
        .unwrap();
    assert_eq!((none.failure.as_ref(), none.parameters.len()), (None, 0));
    assert!(comparison.is_decided(), "{:?}", comparison.conclusion());
}

/// The same data with other values of the first signal, whose standard deviation is unknown.
fn with_unknown_sigma(mut data: Data, change: impl Fn(usize, f64) -> f64) -> Data {
    let Signal {
        field,
        times,
        values,
        ..
    } = data.signals[0].clone();
    let values: Vec<f64> = (values.iter().enumerate())
        .map(|(at, value)| change(at, *value))
        .collect();
    data.signals[0] = Signal::from_values(field, &times, &values, None).unwrap();
    data
}

#[test]
fn a_constant_error_does_not_describe_the_data() {
    let truth = preset("full-coulomb");
    let mut data = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(3));
    for value in &mut data.signals[1].values {
        *value += 0.5e-3;
    }
    let mut request = Request::new(truth, data, &["friction.k"]);
    let report = fit(&request, &|_| {}).unwrap().report;
    assert!(report.quality.p_value.unwrap() > 1e-3);
    assert!(report.signals[1].mean_p_value.unwrap() < 1e-3);
    assert_eq!(report.verdict, Verdict::BadFit);
    assert_contains(&text(&report), "a camera that is not level");
    request.compare = ["coulomb", "viscous"].map(str::to_owned).to_vec();
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::BadFit);
    let sentence = conclusion(&report);
    assert!(sentence.starts_with("None of the laws"), "{sentence}");
}

#[test]
fn wrong_model_is_not_reported_as_constant_error() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(3));
    let faster = truth.with([("initial.psi_dot", 171.0.into())]).unwrap();
    let request = Request::new(faster, data, &["friction.k"]);
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::BadFit);
    let p_values = report
        .signals
        .iter()
        .filter_map(|signal| signal.mean_p_value);
    assert!(p_values.fold(1.0, f64::min) < 1e-3);
    let text = text(&report);
    assert_contains(&text, "the model misses something");
    assert!(!text.contains("not level"), "{text}");
}

#[test]
fn deviations_far_above_the_scatter_do_not_describe_the_data() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(3));
    for (name, data) in [
        (
            "one wrong value",
            with_unknown_sigma(data.clone(), |at, v| if at == 77 { 1e20 } else { v }),
        ),
        (
            "some wrong values",
            with_unknown_sigma(data, |at, v| if at % 50 == 7 { 0.0 } else { v }),
        ),
    ] {
        let mut request = Request::new(truth.clone(), data, &["friction.k"]);
        request.holdout = 0.2;
        let report = fit(&request, &|_| {}).unwrap().report;
        assert_eq!(report.verdict, Verdict::BadFit, "{name}");
        let signal = &report.signals[0];
        let ratio = signal.sigma / signal.scatter.unwrap();
        assert!(ratio > 5.0, "{name}: {ratio}");
        assert_contains(
            &text(&report),
            "times the scatter between neighbouring values",
        );
    }
}

#[test]
fn constant_values_contradict_the_model() {
    let truth = preset("full-coulomb");
    let mut data = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(3));
    data.signals[0].values.fill(0.5);
    let request = Request::new(truth, data, &["friction.k", "initial"]);
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::BadFit);
}

#[test]
fn suggests_units_that_data_seem_to_have() {
    let folder = Folder::new();
    let fields = [
        (state::THETA, 1e-3),
        (state::PHI, 1e-3),
        (pose::OMEGA_BODY.z(), 0.05),
    ];
    let data = measure(&preset("full-coulomb"), 100.0, 2.0, &fields, Some(2));
    for (name, header, scales, expected) in [
        (
            "inclination in degrees",
            "t,theta,phi",
            [180.0 / PI, 1.0],
            "most values are above π (median 27.7",
        ),
        (
            "inclination from the side",
            "t,theta (deg),phi",
            [-180.0 / PI, 1.0],
            "most values are negative (median −0.48",
        ),
    ] {
        let second = if header.contains("phi") { 1 } else { 2 };
        let mut text = format!("{header}\n");
        for (at, time) in data.signals[0].times.iter().enumerate() {
            let [a, b] = [0, second].map(|signal| data.signals[signal].values[at]);
            text += &format!("{time},{},{}\n", a * scales[0], b * scales[1]);
        }
        folder.write("data.csv", &text);
        let line = "fit full-coulomb data.csv --free friction.k,initial";
        let stderr = folder.toprise(line, 2).stderr;
        assert!(stderr.contains(expected), "{name}: {stderr}");
    }
}

/// A table of an inclination, an azimuth and the axial rate of `full-coulomb`.
fn table(header: &str, rows: &Data, scales: [f64; 4]) -> String {
    let mut text = format!("{header}\n");
    for (at, time) in rows.signals[0].times.iter().enumerate() {
        text += &(time * scales[0]).to_string();
        for (signal, scale) in rows.signals.iter().zip(&scales[1..]) {
            text += &format!(",{}", signal.values[at] * scale);
        }
        text += "\n";
    }
    text
}

#[test]
fn noise_of_hanging_top_is_not_a_wrong_unit() {
    let scenario = preset("tippe-top").with([
        ("initial.theta", 3.1405.into()),
        ("initial.psi_dot", (-120.0).into()),
    ]);
    let scenario = scenario.unwrap();
    let folder = Folder::new();
    for seed in 1..=3 {
        let data = measure(&scenario, 100.0, 0.3, &[(state::THETA, 0.02)], Some(seed));
        folder.write("tilt.csv", table("t,theta", &data, [1.0; 4]));
        let spec = SignalSpec::parse("theta:20mrad").unwrap();
        let data = read(&[folder.at("tilt.csv")], &[spec], &Layout::default()).unwrap();
        let result = fit(
            &Request::new(scenario.clone(), data, &["initial.theta"]),
            &|_| {},
        );
        let message = result.err().map(|error| error.to_string());
        assert_eq!(message, None, "seed {seed}");
    }
}

#[test]
fn members_of_json_messages_can_have_units() {
    let folder = Folder::new();
    let data = measure(&preset("full-coulomb"), 100.0, 2.0, &THETA_PHI, Some(2));
    let file = fs::File::create(folder.at("camera.mcap")).unwrap();
    let mut writer = mcap::Writer::new(std::io::BufWriter::new(file)).unwrap();
    let channel = writer
        .add_channel(
            0,
            "/camera/pose",
            "json",
            &std::collections::BTreeMap::new(),
        )
        .unwrap();
    for (at, time) in data.signals[0].times.iter().enumerate() {
        let [tilt, az] = [0, 1].map(|signal| data.signals[signal].values[at].to_degrees());
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: 0,
            log_time: (time * 1e9).round() as u64,
            publish_time: 0,
        };
        let text = format!("{{\"tilt\": {tilt}, \"az_deg\": {az}}}");
        writer
            .write_to_known_channel(&header, text.as_bytes())
            .unwrap();
    }
    writer.finish().unwrap();
    let path = [folder.at("camera.mcap")];
    let specs = [
        "theta=\"/camera/pose.tilt (deg)\"",
        "phi=/camera/pose.az_deg",
    ]
    .map(|text| SignalSpec::parse(text).unwrap());
    let found = read(&path, &specs, &Layout::default()).unwrap();
    for (signal, expected) in found.signals.iter().zip(&data.signals) {
        for (value, expected) in signal.values.iter().zip(&expected.values) {
            assert!((value - expected).abs() < 1e-12, "{}", signal.name);
        }
    }
    for (signals, expected) in [
        (
            &["theta=/camera/pose.tilt", "phi=/camera/pose.tilt (deg)"][..],
            "read twice as a signal",
        ),
        (
            &["theta=/camera/pose.tilt (rpm)"],
            "\"rpm\" is not a unit of angle",
        ),
        (
            &["theta=/camera/pose.roll"],
            "member /camera/pose.roll has no values",
        ),
    ] {
        let mut specs = Vec::new();
        for text in signals {
            specs.push(SignalSpec::parse(text).unwrap());
        }
        let message = read(&path, &specs, &Layout::default())
            .unwrap_err()
            .to_string();
        assert_contains(&message, expected);
    }
    let bare = SignalSpec::parse("theta=/camera/pose.tilt:2mrad").unwrap();
    let bare = read(&path, &[bare], &Layout::default()).unwrap();
    let error = fit(
        &Request::new(preset("full-coulomb"), bare, &["friction.k"]),
        &|_| {},
    );
    let message = error.unwrap_err().to_string();
    assert_contains(
        &message,
        "write /camera/pose.tilt (deg) into the header, or after the name in signal",
    );
}

#[test]
fn suggests_units_of_long_times() {
    let folder = Folder::new();
    let data = measure(
        &preset("tippe-top"),
        100.0,
        2.0,
        &[(state::THETA, 1e-3)],
        Some(2),
    );
    for (name, scale) in [("milliseconds", 1e3), ("microseconds", 1e6)] {
        let text = table("t,theta", &data, [scale, 1.0, 1.0, 1.0]);
        folder.write("data.csv", text);
        let line = "fit tippe-top data.csv --free friction.k";
        let stderr = folder.toprise(line, 2).stderr;
        assert!(stderr.contains("--time \"t (ms)\""), "{name}: {stderr}");
    }
    let spec = [SignalSpec::parse("theta:1mrad").unwrap()];
    let found = read(
        &[folder.at("data.csv")],
        &spec,
        &Layout::with_time("t (us)"),
    )
    .unwrap();
    assert_eq!(found.signals[0].times.last(), Some(&2.0));
}

#[test]
fn recovers_the_friction_of_its_own_motion() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 20.0, &THETA_PHI, None);
    for k in [0.015, 0.06] {
        let start = truth.with([("friction.k", k.into())]).unwrap();
        let report = fit(&Request::new(start, data.clone(), &["friction.k"]), &|_| {})
            .unwrap()
            .report;
        let error = (report.parameters[0].value / 0.03 - 1.0).abs();
        assert!(error < 1e-8, "{k}: {error:e}");
        assert_eq!(report.verdict, Verdict::Fitted);
    }
}

#[test]
fn estimates_scatter_as_their_standard_deviations_say() {
    let truth = preset("full-coulomb");
    let start = truth
        .with([
            ("friction.k", 0.045.into()),
            ("initial.psi_dot", 165.0.into()),
        ])
        .unwrap();
    let (mut sum, mut count) = (0.0, 0.0);
    for seed in 1..=8 {
        let data = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(seed));
        let report = fit(
            &Request::new(start.clone(), data, &["friction.k", "initial"]),
            &|_| {},
        )
        .unwrap()
        .report;
        for (name, value) in [
            ("friction.k", 0.03),
            ("initial.theta", 0.5),
            ("initial.psi_dot", 170.0),
        ] {
            let estimate = report.parameters.iter().find(|p| p.name == name).unwrap();
            let z = (estimate.value - value) / estimate.sd.unwrap();
            sum += z * z;
            count += 1.0;
        }
    }
    // The mean of 24 squares of normal numbers is 1 ± 0.29: six deviations are allowed upwards.
    assert!((0.1..2.7).contains(&(sum / count)), "{}", sum / count);
}

#[test]
fn frictionless_motion_gives_a_limit_and_no_estimate() {
    let data = measure(&preset("frictionless"), 100.0, 5.0, &THETA_PHI, Some(1));
    let report = fit(
        &Request::new(preset("full-coulomb"), data, &["friction.k", "initial"]),
        &|_| {},
    )
    .unwrap()
    .report;
    let k = &report.parameters[0];
    assert_eq!(k.interval, None);
    match k.limit {
        // The standard deviation of k is 5e-5 with this data.
        Some(toprise::fit::report::Limit::Below(limit)) => assert!(limit < 3e-4, "{limit}"),
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn refuses_degenerate_parameters() {
    let scenario = preset("full-coulomb");
    let data = measure(&scenario, 100.0, 5.0, &THETA_PHI, Some(1));
    let top = "top.mass,gravity,top.center_distance,top.transverse_moment,top.axial_moment,top.peg_radius,friction.k";
    for (free, expected) in [
        (
            "friction.k,top.peg_radius",
            "only k·R is determined (k × 2 and R ÷ 2 is the same motion)",
        ),
        // Not the same motion: χ² grows by 100 if both change by 1 %.
        (
            "top.axial_moment,friction.k,initial",
            "can't tell them apart (χ² differs by ",
        ),
        ("friction.k,initial.psi", "no signal depends on initial.psi"),
        (
            "friction.k,offset",
            "a time offset of all data together and a free start are the same motion",
        ),
        (top, "only 3 combinations are determined"),
        ("friction.law", "friction.law can't be fitted"),
        ("stop.duration", "stop.duration can't be fitted"),
        ("friction.q", "unknown key friction.q"),
    ] {
        let free: Vec<&str> = free.split(',').collect();
        let error = fit(
            &Request::new(scenario.clone(), data.clone(), &free),
            &|_| {},
        )
        .unwrap_err();
        assert!(error.to_string().contains(expected), "{free:?}: {error}");
    }
}

#[test]
fn omits_parameters_that_a_gyroscope_cannot_determine() {
    let scenario = preset("full-coulomb");
    let gyroscope = [(pose::OMEGA_BODY.z(), 0.05)];
    let data = measure(&scenario, 100.0, 10.0, &gyroscope, Some(5));
    let report = fit(
        &Request::new(scenario, data, &["friction.k", "initial"]),
        &|_| {},
    )
    .unwrap()
    .report;
    assert_eq!(report.verdict, Verdict::Fitted);
    let names: Vec<&str> = report.parameters.iter().map(|p| p.name.as_str()).collect();
    assert!(
        names.contains(&"friction.k") && !names.contains(&"initial.phi_dot"),
        "{names:?}"
    );
    assert!(
        report
            .notes
            .iter()
            .any(|note| matches!(note, Note::Kept { .. })),
        "{:?}",
        report.notes
    );
    let k = &report.parameters[0];
    assert!((k.value - 0.03).abs() < 4.0 * k.sd.unwrap(), "{k:?}");
}

#[test]
#[ignore = "takes minutes"]
fn says_undecided_if_the_inclination_alone_is_coarse() {
    let degree = std::f64::consts::PI / 180.0;
    let data = measure(
        &preset("stribeck"),
        30.0,
        5.0,
        &[(state::THETA, 0.3 * degree)],
        Some(5),
    );
    let mut request = Request::new(preset("full-coulomb"), data, &["friction.k", "initial"]);
    request.compare = ["coulomb", "stribeck"].map(str::to_owned).to_vec();
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::Undecided);
    assert!(
        conclusion(&report).starts_with("Undecided"),
        "{}",
        conclusion(&report)
    );
    let comparison = report.comparison.unwrap();
    // Only extensions that are expected to decide are named.
    assert!(comparison.extensions.iter().all(|e| e.delta_chi2 >= 20.0));
    assert!(
        report.notes.iter().any(
            |note| matches!(note, Note::Aliased { sampling, .. } if (sampling - 30.0).abs() < 0.1)
        ),
        "{:?}",
        report.notes
    );
}

#[test]
fn a_model_that_ends_before_the_data_is_an_error() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 20.0, &THETA_PHI, Some(1));
    let start = truth.with([("stop.theta_risen", 0.2.into())]).unwrap();
    let error = fit(&Request::new(start, data, &["friction.k"]), &|_| {}).unwrap_err();
    assert!(
        error.to_string().starts_with("the model ends at t = "),
        "{error}"
    );
}

#[test]
fn reports_are_the_same_for_any_number_of_threads() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 1.0, &THETA_PHI, Some(3));
    let mut request = Request::new(truth, data, &["friction.k", "initial"]);
    request.compare = ["coulomb", "viscous"].map(str::to_owned).to_vec();
    let report = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let fitted = pool.install(|| fit(&request, &|_| {}).unwrap());
        serde_json::to_string(&fitted.report).unwrap()
    };
    assert_eq!(report(1), report(3));
}

#[test]
fn samples_at_given_times_are_those_of_the_run() {
    for name in ["paper", "full-coulomb", "lifecycle", "free-paper"] {
        let scenario = preset(name).with([("stop.duration", 2.0.into())]).unwrap();
        let mut expected = Vec::new();
        for record in Simulation::new(&scenario).unwrap() {
            if let Record::Sample(sample) = record.unwrap() {
                expected.push((sample.angles, sample.tilt.rates));
            }
        }
        let times: Vec<f64> = (0..expected.len()).map(|i| i as f64 / 1000.0).collect();
        let mut found = Vec::new();
        sample_at(&scenario, &times, &mut |_, sample| {
            found.push((sample.angles, sample.tilt.rates));
        })
        .unwrap();
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn fits_a_recording_and_records_the_best_fit() {
    let folder = Folder::new();
    folder.toprise(
        "run full-coulomb --set stop.duration=3 --set sampling.period=0.01 -o a.mcap",
        0,
    );
    let line = "fit full-coulomb a.mcap --set friction.k=0.06 --free friction.k \
        --signal /top/state.theta:1mrad -o fit.mcap --scenario best.toml \
        --profile friction.k --figures figures --format json";
    let report: Value = serde_json::from_str(&folder.toprise(line, 0).stdout).unwrap();
    let k = report["parameters"][0]["value"].as_f64().unwrap();
    assert!((k / 0.03 - 1.0).abs() < 1e-8, "{k}");
    let verified = folder.toprise("verify fit.mcap", 0);
    assert_contains(&verified.stdout, "/fit/data (301 messages)");
    assert_contains(&verified.stdout, "/fit/residual (301 messages)");
    assert_contains(&verified.stdout, "fit-report.json");
    folder.toprise("run best.toml -o b.mcap", 0);
    // The runs are the same.
    let compared = folder.toprise("diff fit.mcap b.mcap", 0).stdout;
    assert_contains(&compared, "All values identical; other parts differ");
    assert_contains(&compared, "channel /fit/residual");
    assert!(!compared.contains("/top/"), "{compared}");
    for figure in ["data", "profile-friction.k"] {
        let svg = fs::read_to_string(folder.path().join(format!("figures/{figure}.svg"))).unwrap();
        assert_contains(&svg, "full-coulomb");
    }
    // The recorded data can be fitted again.
    let again =
        "fit full-coulomb fit.mcap --free friction.k --signal /top/state.theta:1mrad --until 3";
    folder.toprise(again, 0);
}

#[test]
fn cut_recording_gives_partial_result() {
    let folder = Folder::new();
    folder.toprise(
        "run full-coulomb --set stop.duration=3 --set sampling.period=0.01 -o a.mcap",
        0,
    );
    let whole = fs::read(folder.path().join("a.mcap")).unwrap();
    fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    let line = "fit full-coulomb cut.mcap --free friction.k --signal /top/state.theta:1mrad";
    assert_contains(&folder.toprise(line, 3).stdout, "Not read: cut.mcap: ");
}

#[test]
#[ignore = "takes minutes"]
fn intervals_across_minima_cover_the_truth() {
    // A pupil's video: the nutation is hardly above the noise, and any spin has its own cycle of noise.
    let truth = preset("full-coulomb")
        .with([("friction.k", 0.05.into())])
        .unwrap();
    for seed in [5, 6, 7] {
        let data = measure(&truth, 30.0, 5.0, &[(state::THETA, 5e-3)], Some(seed));
        let start = preset("full-coulomb");
        let report = fit(
            &Request::new(
                start,
                data,
                &["friction.k", "initial.theta", "initial.psi_dot"],
            ),
            &|_| {},
        )
        .unwrap()
        .report;
        assert!(!report.modes.is_empty(), "{seed}");
        for (estimate, truth) in report.parameters.iter().zip([0.05, 0.5, 170.0]) {
            let [low, high] = estimate.interval.unwrap();
            assert!((low..=high).contains(&truth), "{seed}: {estimate:?}");
        }
    }
}

#[test]
fn the_start_of_a_free_peg_has_the_velocity_that_the_scenario_gives() {
    for (name, expected) in [
        ("tippe-top", "initial.center_x_dot"),
        ("free-paper", "initial.peg_x_dot"),
    ] {
        let truth = preset(name);
        let data = measure(&truth, 200.0, 0.5, &THETA_PHI, Some(1));
        let request = Request::new(truth, data, &["initial"]);
        let report = fit(&request, &|_| {}).unwrap().report;
        let names: Vec<&str> = report.parameters.iter().map(|p| p.name.as_str()).collect();
        assert!(names.contains(&expected), "{name}: {names:?}");
    }
}

#[test]
fn a_fit_to_a_minority_does_not_describe_the_data() {
    let truth = preset("full-coulomb");
    let mut data = measure(&truth, 100.0, 1.0, &THETA_PHI, Some(1));
    let mut noise = Noise(2);
    for signal in &mut data.signals {
        for value in &mut signal.values {
            if noise.uniform() < 0.65 {
                *value += 0.3 * noise.uniform();
            }
        }
    }
    let mut request = Request::new(truth, data, &["friction.k", "initial"]);
    request.loss = Loss::Huber;
    let report = fit(&request, &|_| {}).unwrap().report;
    let outliers: Vec<usize> = report
        .signals
        .iter()
        .map(|signal| signal.outliers)
        .collect();
    assert!(outliers.iter().any(|count| 2 * count > 101), "{outliers:?}");
    assert_eq!(report.verdict, Verdict::BadFit);
    assert_contains(&text(&report), "a minority");
}

#[test]
fn rejects_data_that_no_motion_fits() {
    let times: Vec<f64> = (0..500).map(|i| f64::from(i) / 100.0).collect();
    let swings: Vec<f64> = times
        .iter()
        .map(|time| 0.5 * libm::cos(3.0 * time))
        .collect();
    // A pendulum: its plane stays, and the azimuth jumps by half a turn.
    let theta: Vec<f64> = swings.iter().map(|swing| swing.abs()).collect();
    let phi: Vec<f64> = swings
        .iter()
        .map(|swing| if *swing < 0.0 { PI } else { 0.0 })
        .collect();
    let data = Data::from_signals(vec![
        Signal::from_values(state::THETA, &times, &theta, None).unwrap(),
        Signal::from_values(state::PHI, &times, &phi, None).unwrap(),
    ]);
    let request = Request::new(preset("full-coulomb"), data, &["friction.k", "initial"]);
    // How it is seen that no motion of the top is like this does not matter.
    match fit(&request, &|_| {}) {
        Err(error) => assert!(error.is_of_motion(), "{error}"),
        Ok(fitted) => assert_ne!(fitted.report.verdict, Verdict::Fitted),
    }
}

#[test]
#[ignore = "takes minutes"]
fn minima_are_independent_of_the_start() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 30.0, 2.0, &[(state::THETA, 5e-3)], Some(7));
    let mut reports = Vec::new();
    for (spin, precession) in [(170.0, 1.75), (176.0, 1.6)] {
        let start = truth
            .with([
                ("initial.psi_dot", spin.into()),
                ("initial.phi_dot", precession.into()),
            ])
            .unwrap();
        let request = Request::new(start, data.clone(), &["friction.k", "initial"]);
        reports.push(fit(&request, &|_| {}).unwrap().report);
    }
    let [first, others @ ..] = &reports[..] else {
        panic!("no report")
    };
    for other in others {
        for (a, b) in first.parameters.iter().zip(&other.parameters) {
            let distance = (a.value - b.value).abs();
            assert!(distance < 0.02 * a.sd.unwrap(), "{}: {distance}", a.name);
        }
    }
    for report in &reports {
        let rows = estimates(report);
        for (at, (estimate, row)) in report.parameters.iter().zip(&rows).enumerate() {
            for mode in &report.modes {
                let distance = (mode.values[at] - estimate.value).abs();
                // A standard deviation beside minima that it doesn't reach would mislead.
                assert!(
                    !row.contains('±') || distance < 3.0 * estimate.sd.unwrap(),
                    "{row} {distance}"
                );
            }
        }
        let spin = report.parameters.last().unwrap();
        assert_eq!(spin.name, "initial.psi_dot");
        for mode in &report.modes {
            let distance = (mode.values.last().unwrap() - spin.value).abs();
            assert!(
                distance > 0.5 * spin.sd.unwrap(),
                "the best one is listed twice"
            );
            // Of 201 minima at most, 2 ln(201/0.05).
            assert!((0.0..16.6).contains(&mode.delta_chi2));
            for (estimate, value) in report.parameters.iter().zip(&mode.values) {
                let [low, high] = estimate.interval.unwrap();
                assert!((low..=high).contains(value), "{}", estimate.name);
                assert!(estimate.name != "friction.k" || low >= 0.0);
            }
        }
        assert!(
            report
                .notes
                .iter()
                .any(|note| matches!(note, Note::SpinsTried { .. })),
            "{:?}",
            report.notes
        );
    }
}

#[test]
fn laws_are_compared_with_that_of_the_scenario() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 3.0, &THETA_PHI, Some(1));
    let mut request = Request::new(truth, data, &["friction.k", "initial"]);
    request.compare = vec!["viscous".to_owned()];
    let report = fit(&request, &|_| {}).unwrap().report;
    let laws: Vec<&str> = report
        .comparison
        .iter()
        .flat_map(|c| &c.laws)
        .map(|law| law.law.as_str())
        .collect();
    assert_eq!(laws, ["coulomb", "viscous"]);
    assert_eq!(report.verdict, Verdict::Fitted);
}

#[test]
fn notes_overestimated_sigma() {
    let truth = preset("full-coulomb");
    for (name, noise, expected) in [("no noise", None, true), ("noise of σ", Some(3), false)] {
        let data = measure(&truth, 100.0, 1.0, &THETA_PHI, noise);
        let report = fit(&Request::new(truth.clone(), data, &["friction.k"]), &|_| {})
            .unwrap()
            .report;
        assert_eq!(report.verdict, Verdict::Fitted, "{name}");
        let text = text(&report);
        let is_said = text.contains("scatter much less than the given σ");
        assert_eq!(is_said, expected, "{name}: {text}");
    }
}

#[test]
fn reads_bytes_as_files() {
    let path = data_file("offset_camera.csv");
    let bytes = fs::read(&path).unwrap();
    let from_file = read(std::slice::from_ref(&path), &[], &Layout::default()).unwrap();
    assert_eq!(read_bytes(&path, bytes.clone(), &[]).unwrap(), from_file);
    let utf16: Vec<u8> = bytes.iter().flat_map(|byte| [*byte, 0]).collect();
    let folder = Folder::new();
    for (name, content) in [
        ("UTF-16", utf16),
        ("text in a number", b"t,theta\n0,abc\n1,0.5\n2,x\n".to_vec()),
        ("no field", b"t,x\n0,1\n".to_vec()),
        ("nothing", Vec::new()),
    ] {
        folder.write("a.csv", &content);
        let path = folder.at("a.csv");
        let expected = read(std::slice::from_ref(&path), &[], &Layout::default()).unwrap_err();
        let error = read_bytes(&path, content, &[]).unwrap_err();
        assert_eq!(error.to_string(), expected.to_string(), "{name}");
    }
}

#[test]
fn usual_parameters_are_those_of_the_law_and_the_start() {
    for (name, expected) in [
        ("full-coulomb", &["friction.k", "initial"][..]),
        ("frictionless", &["initial"]),
    ] {
        assert_eq!(usual_parameters(&preset(name)), expected, "{name}");
    }
}

#[test]
fn exit_codes_distinguish_bad_fits_from_bad_input() {
    let folder = Folder::new();
    folder.write(
        "a.csv",
        "t,theta\n0,0.5\n0.1,0.9\n0.2,0.1\n0.3,0.8\n0.4,0.2\n0.5,0.7\n",
    );
    folder.write("one.csv", "t,theta,phi\n4,0.5,0.1\n");
    folder.write("two.csv", "t,theta\n0,0.5\n0.1,0.49\n");
    let mut frames = String::new();
    for at in 0..30 {
        frames += &format!("{at},0.5\n");
    }
    folder.write("frames.csv", format!("t,theta\n{frames}"));
    folder.write("bad.csv", "t,theta\n0,0.5\n0.1,abc\n");
    folder.write("single.csv", "theta\n0.5\n0.4\n0.3\n");
    folder.write("twice.csv", "t,theta,theta\n0,0.5,0.5\n0.1,0.5,0.5\n");
    folder.write("clocks.csv", "t,time,theta\n0,0,0.5\n1,1,0.4\n");
    folder.write("clock.csv", "t,t,theta\n0,0,0.5\n1,1,0.4\n");
    folder.write("bare.csv", "0,0.5\n0.1,0.4\n");
    folder.write("both.csv", "t,theta,tilt\n0,0.5,0.5\n0.1,0.5,0.5\n");
    folder.write("huge.csv", "t,theta\n0,0.5\n0.1,1e290\n0.2,0.5\n");
    // The stray row is not the last one of the file.
    folder.write(
        "stray.csv",
        "# camera 2\nt,theta\n0,0.5\n0.1,0.9\n20000,0.1\n0.2,0.2\n0.3,0.7\n",
    );
    folder.write(
        "early.csv",
        "t,theta\n-9000,0.5\n-8999.9,0.9\n0,0.1\n0.1,0.2\n0.2,0.7\n",
    );
    let fit = "fit full-coulomb a.csv --free friction.k --signal theta:1mrad";
    folder.toprise(fit, 1);
    for (line, message) in [
        (
            "fit full-coulomb bad.csv --free friction.k",
            "bad.csv:3: column theta: \"abc\" is not a number",
        ),
        (
            "fit full-coulomb one.csv --free friction.k,initial",
            "2 samples at t = 4 s, where the scenario starts, can't determine a motion",
        ),
        (
            "fit full-coulomb one.csv --signal theta --free friction.k",
            "a single sample at t = 4 s",
        ),
        (
            "fit full-coulomb one.csv --start 3 --signal theta --free friction.k",
            "1 sample can't determine 1 parameter: at least 2 are needed",
        ),
        (
            "fit full-coulomb two.csv --free friction.k,initial",
            "2 samples can't determine 5 parameters: at least 6 are needed",
        ),
        (
            "fit full-coulomb frames.csv --until 0.3 --free friction.k",
            "frames.csv: column t has no unit, and read as s, the data span 29 s with a value every 1 s",
        ),
        (
            "fit full-coulomb a.csv --free friction.k,top.peg_radius",
            "only k·R is determined",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --bound friction.k=1..0",
            "the lower bound, 1, must be less than the upper one, 0",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --bound offset=-1..0",
            "offset can't be fitted: there is no file with this number",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --profile top.mass",
            "top.mass is not free, so it can't have a profile; add top.mass to --free",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --profile friction.kk",
            "unknown key friction.kk (did you mean friction.k?)",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --figures bad.csv",
            "--figures bad.csv is a file: name a directory",
        ),
        (
            "fit full-coulomb single.csv --free friction.k",
            "single.csv: no line names the times above rows with as many cells",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --signal phi",
            "no column or topic phi; there are: t, theta",
        ),
        (
            "fit full-coulomb none.csv --free friction.k",
            "cannot read none.csv",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --compare coulombs",
            "unknown law coulombs",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --start 7",
            "--start 7: the data are from t = 0 to 0.5 s",
        ),
        (
            "fit full-coulomb twice.csv --free friction.k",
            "twice.csv: the columns theta and theta both measure /top/state.theta",
        ),
        (
            "fit full-coulomb clocks.csv --free friction.k",
            "several columns are named like times: t, time",
        ),
        (
            "fit full-coulomb clock.csv --free friction.k",
            "clock.csv: several columns are named like times: t, t; choose one",
        ),
        (
            "fit full-coulomb clock.csv --free friction.k --time t",
            "clock.csv: several columns are called t: rename them",
        ),
        (
            "fit full-coulomb bare.csv --free friction.k",
            "the first lines are understood as “0 | 0.5”, “0.1 | 0.4”; write a first line",
        ),
        (
            "fit frictionless a.csv --free friction.k",
            "--set friction.law=coulomb --set friction.k=0.03 --set friction.dissipation=full",
        ),
        (
            "fit full-coulomb both.csv --free friction.k",
            "both.csv: the columns theta and tilt both measure /top/state.theta",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --signal theta:1mrad --signal theta:2mrad",
            "a.csv: theta is read twice",
        ),
        (
            "fit full-coulomb a.csv ./a.csv --free friction.k",
            "./a.csv is given twice",
        ),
        (
            "fit full-coulomb huge.csv --free friction.k",
            "huge.csv:3: column theta: the value 1e290 at t = 0.1 s",
        ),
        (
            "fit full-coulomb stray.csv --free friction.k",
            "a time may be wrong (1 row after it: stray.csv:5); remove it",
        ),
        (
            "fit full-coulomb early.csv --free friction.k",
            "a time may be wrong (2 rows before it, next to it early.csv:3)",
        ),
        (
            "fit full-coulomb a.csv --free friction.k --scenario a.csv --force",
            "a.csv",
        ),
        (
            "fit full-coulomb a.csv --free friction.k -o x.rrd",
            if cfg!(feature = "rerun") {
                "-o is for the MCAP file"
            } else {
                "-o writes an MCAP file"
            },
        ),
        (
            "fit full-coulomb a.csv --free friction.k -o x.mcap --scenario x.mcap",
            "are the same file",
        ),
    ] {
        assert_contains(&folder.toprise(line, 2).stderr, message);
    }
    let ends = format!("{fit} --set stop.theta_risen=0.4999");
    assert_contains(&folder.toprise(&ends, 3).stderr, "the model ends at t = ");
}

#[test]
fn refuses_existing_outputs_before_fitting() {
    let folder = Folder::new();
    fs::create_dir(folder.at("figures")).unwrap();
    for name in [
        "fit.mcap",
        "best.toml",
        "figures/data.svg",
        "figures/profile-friction.k.svg",
        "figures/correlations.svg",
    ] {
        folder.write(name, "");
    }
    // The data don't exist, so that reading them would be the first error.
    for (outputs, taken) in [
        ("-o fit.mcap", "fit.mcap exists"),
        ("--scenario best.toml", "best.toml exists"),
        ("--figures figures", "data.svg exists"),
    ] {
        let line = format!("fit full-coulomb none.csv --free friction.k {outputs}");
        assert_contains(&folder.toprise(&line, 2).stderr, taken);
        let forced = format!("{line} --force");
        assert_contains(&folder.toprise(&forced, 2).stderr, "cannot read none.csv");
    }
    fs::remove_file(folder.at("figures/data.svg")).unwrap();
    for (options, taken) in [
        ("friction.k --profile friction.k", "profile-friction.k.svg"),
        ("initial", "correlations.svg"),
        ("friction.k", "cannot read none.csv"),
    ] {
        let line = format!("fit full-coulomb none.csv --figures figures --free {options}");
        assert_contains(&folder.toprise(&line, 2).stderr, taken);
    }
}

#[test]
fn val_robust_losses_estimate_the_noise_without_outliers() {
    let (_, scenario) = data_set("outliers");
    let data = data(&["outliers.csv"], &["theta", "phi"]);
    let mut request = Request::new(scenario, data, &["friction.k", "initial"]);
    request.loss = Loss::Huber;
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::Fitted);
    for signal in &report.signals {
        // The truth is 1 mrad. 4 % of outliers, each counted as 1.345 σ, add 6 %. The standard error of this estimate is
        // 0.87/√n, 2.5 % for 1201 values; three of them are allowed.
        let error = signal.sigma / 1.06e-3 - 1.0;
        assert!(error.abs() < 0.075, "{}: {}", signal.field, signal.sigma);
    }
    let estimate = &report.parameters[0];
    assert!((estimate.value - 0.0517).abs() < 4.0 * estimate.sd.unwrap());
}

#[test]
fn refuses_unknown_signals() {
    let folder = Folder::new();
    folder.toprise("run paper --set stop.duration=0.1 -o run.mcap", 0);
    folder.write("camera.csv", "t,theta,x\n0,0.5,1\n0.1,0.5,1\n");
    folder.write("gyro.csv", "t,gyro z\n0,100\n0.1,100\n");
    for (name, files, signals, expected) in [
        (
            "beside one that is found",
            &["camera.csv"][..],
            &["theta", "phi"][..],
            &["no column or topic phi; there are: t, theta, x"][..],
        ),
        (
            "in a recording",
            &["run.mcap"],
            &["theta", "phi=/top/state.phii"],
            &["no column or topic /top/state.phii; there are: /"],
        ),
        (
            "in several files",
            &["camera.csv", "gyro.csv"],
            &["theta", "omega_n=gyroz"],
            &[
                "no column or topic gyroz in any file; in ",
                "camera.csv there are: t, theta, x; in ",
                "gyro.csv there are: t, gyro z",
            ],
        ),
        (
            "a file without any",
            &["camera.csv", "gyro.csv"],
            &["theta", "phi=x"],
            &["gyro.csv: none of the signals is in this file"],
        ),
    ] {
        let paths: Vec<_> = files.iter().map(|file| folder.at(file)).collect();
        let specs: Vec<_> = signals
            .iter()
            .map(|text| SignalSpec::parse(text).unwrap())
            .collect();
        let message = read(&paths, &specs, &Layout::default())
            .unwrap_err()
            .to_string();
        for part in expected {
            assert!(message.contains(part), "{name}: {message}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn failed_output_keeps_other_files() {
    let folder = Folder::new();
    let data = measure(&preset("paper"), 50.0, 1.0, &THETA_PHI, None);
    let mut text = "t,theta,phi\n".to_owned();
    for (at, time) in data.signals[0].times.iter().enumerate() {
        let [theta, phi] = [0, 1].map(|signal| data.signals[signal].values[at]);
        text += &format!("{time},{theta},{phi}\n");
    }
    folder.write("data.csv", text);
    folder.write("best.toml", "mine\n");
    folder.write("fit.mcap", "mine, too\n");
    // A scenario has less than 8 KiB, a recording of one second more.
    let output = folder.limited(
        8,
        "fit paper data.csv --free friction.k --signal theta:1mrad --signal phi:1mrad \
         --scenario best.toml -o fit.mcap --force",
    );
    assert_eq!(output.status.code(), Some(2));
    assert_contains(&String::from_utf8_lossy(&output.stderr), "fit.mcap");
    assert_eq!(folder.text("best.toml"), "mine\n");
    assert_eq!(folder.text("fit.mcap"), "mine, too\n");
    assert_eq!(folder.files(), ["best.toml", "data.csv", "fit.mcap"]);
}

#[test]
fn refuses_scenario_files_with_other_extensions() {
    Folder::new().refuses(
        "fit full-coulomb none.csv --free friction.k --scenario best.mcap",
        "--scenario writes a scenario file: call it best.toml",
    );
}

/// The nutation of the start values may have another frequency than that of the data.
#[test]
fn sampling_note_uses_the_fitted_motion() {
    let spinning = |spin| scenario("full-coulomb", &[("initial.psi_dot", spin)]);
    let data = measure(&spinning("185"), 30.0, 3.0, &THETA_PHI, Some(3));
    let mut remarks = Vec::new();
    for start in ["170", "190"] {
        let request = Request::new(spinning(start), data.clone(), &["friction.k", "initial"]);
        let notes = fit(&request, &|_| {}).unwrap().report.notes;
        remarks.extend(
            notes
                .into_iter()
                .filter(|note| matches!(note, Note::Aliased { .. }))
                .map(|note| note.sentence().to_string()),
        );
    }
    assert_eq!(remarks.len(), 2);
    assert_eq!(remarks[0], remarks[1]);
}

/// A start that is much too slow, too fast, or spins the other way.
#[test]
fn precession_shows_a_spin_from_which_the_fit_succeeds() {
    let spinning = |spin| scenario("full-coulomb", &[("initial.psi_dot", spin)]);
    let data = measure(&spinning("185"), 30.0, 3.0, &THETA_PHI, Some(4));
    for start in ["40", "300", "-170"] {
        let request = Request::new(spinning(start), data.clone(), &["friction.k", "initial"]);
        let report = fit(&request, &|_| {}).unwrap().report;
        assert_eq!(report.verdict, Verdict::Fitted, "from {start}");
        let mut parameters = report.parameters.iter();
        let spin = parameters.find(|p| p.name == "initial.psi_dot").unwrap();
        let [low, high] = spin.interval.unwrap();
        assert!(
            (low..=high).contains(&185.0),
            "from {start}: {low} to {high}"
        );
        let remark = report
            .notes
            .iter()
            .find(|note| matches!(note, Note::Restarted { .. }));
        assert!(remark.is_some(), "from {start}: {:?}", report.notes);
    }
}

/// The nutation has other phases in which a motion comes near the data, but not to them.
#[test]
fn restarts_from_minimum_far_from_the_data() {
    let truth = scenario(
        "paper",
        &[("initial.theta", "1.3"), ("stop.theta_risen", "")],
    );
    let data = measure(
        &truth,
        100.0,
        3.0,
        &[(state::THETA, 1e-3), (state::PHI, 5e-3)],
        Some(5),
    );
    let start = scenario(
        "paper",
        &[
            ("initial.theta", "1.3"),
            ("initial.psi_dot", "-100"),
            ("stop.theta_risen", ""),
        ],
    );
    let request = Request::new(start, data, &["friction.k", "initial"]);
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::Fitted);
    let mut parameters = report.parameters.iter();
    let spin = parameters.find(|p| p.name == "initial.psi_dot").unwrap();
    let [low, high] = spin.interval.unwrap();
    assert!((low..=high).contains(&170.0), "{low} to {high}");
}
