//! How fast: the integrator beside another crate's, and whole runs.
//!
//! `cargo bench` measures everything; `cargo bench -- integrator` only that group.

use criterion::{Criterion, criterion_group, criterion_main};
use ivp::prelude::*;
use std::hint::black_box;
use std::path::Path;
use toprise::analysis::diff;
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::Existing;
use toprise::archive::recording::{Recording, Selection};
use toprise::archive::sink::record_all;
use toprise::archive::verify::verify;
use toprise::archive::writer::Form;
use toprise::figures::{FIGURES, RunData};
use toprise::physics::dynamics::{EulerAngles, Phase};
use toprise::physics::integrate::{Dop853, System, Tolerances};
use toprise::run::outcome;
use toprise::run::scenario::{Preset, Scenario};
use toprise::run::simulation::Simulation;
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::{RunMessages, Topics};

const START: [f64; 6] = [0.0, 0.5, 0.0, 1.75, 0.0, 170.0];
const SECONDS: u32 = 20;
const SAMPLES: u32 = SECONDS * 1000;

/// The paper's equations (7), the same for both integrators.
struct Paper;

impl Paper {
    #[inline]
    fn slope(y: &[f64; 6]) -> [f64; 6] {
        let (ix, iz) = (8.52e-5, 7.25e-5);
        let (friction, gravity) = (0.03 * 0.110 * 9.81 * 0.007, 0.110 * 9.81 * 0.020);
        let (s, c) = libm::sincos(y[1]);
        let [phi, theta, psi] = [y[3], y[4], y[5]];
        let f = friction * psi / (theta * theta + psi * psi * s * s).sqrt();
        let w = psi + phi * c;
        [
            phi,
            theta,
            psi,
            iz * theta * w / (ix * s) - 2.0 * theta * phi * c / s + f * c / ix,
            -iz * phi * s * w / ix + phi * phi * s * c + gravity * s / ix,
            -iz * theta * c * w / (ix * s) + 2.0 * theta * phi * c * c / s + theta * phi * s
                - f * (c * c / ix + s * s / iz),
        ]
    }
}

impl System<6> for Paper {
    #[inline]
    fn derivative(&self, _: f64, y: &[f64; 6]) -> [f64; 6] {
        Self::slope(y)
    }
}

impl FirstOrderSystem for Paper {
    fn derivative(&self, _: f64, y: &[f64], dydt: &mut [f64]) {
        if let Ok(y) = y.try_into() {
            dydt.copy_from_slice(&Self::slope(y));
        }
    }
}

/// 20 s of the paper's motion sampled at 1 kHz with this crate's integrator.
fn ours() -> f64 {
    let tolerances = Tolerances {
        relative: 1e-12,
        absolute: 1e-12,
    };
    let mut integrator = Dop853::new(Paper, 0.0, START, tolerances).expect("the start is regular");
    let (mut next, mut sum) = (0, 0.0);
    while next <= SAMPLES {
        integrator.step().expect("the motion is regular");
        let dense = integrator.dense();
        let end = dense.t0 + dense.h;
        while next <= SAMPLES && f64::from(next) / 1000.0 <= end {
            let s = (f64::from(next) / 1000.0 - dense.t0) / dense.h;
            sum += dense.at(s)[1];
            next += 1;
        }
    }
    sum
}

/// The same with the `ivp` crate.
fn theirs() -> f64 {
    let times = (0..=SAMPLES).map(|i| f64::from(i) / 1000.0).collect();
    let solution = Ivp::first_order(&Paper, 0.0, f64::from(SECONDS), &START)
        .method(Method::DOP853)
        .rtol(1e-12)
        .atol(1e-12)
        .t_eval(times)
        .solve()
        .expect("the motion is regular");
    solution.y.iter().map(|y| y[1]).sum()
}

fn integrator(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("integrator: 20 s of the paper at 1 kHz");
    group.bench_function("toprise", |b| b.iter(|| black_box(ours())));
    group.bench_function("ivp", |b| b.iter(|| black_box(theirs())));
    group.finish();
}

fn archive(scenario: &Scenario, topics: &[String], encoding: Encoding, directory: &Path) {
    let topics = if topics.is_empty() {
        Topics::All
    } else {
        Topics::named(topics).expect("the topics exist")
    };
    let mut run = RunMessages::new(scenario, &topics).expect("the preset is regular");
    let path = directory.join("bench.mcap");
    let form = Form {
        encoding,
        ..Form::default()
    };
    let mut sink = McapSink::create(&path, Existing::Replace, scenario, run.telemetry(), form)
        .expect("the directory is writable");
    let recorded = record_all(&mut run, &mut [&mut sink]).expect("the run succeeds");
    sink.finish(&recorded.outcome.end)
        .expect("the disk has room");
}

fn runs(criterion: &mut Criterion) {
    let scenario = Preset::find("paper")
        .and_then(Preset::scenario)
        .expect("the preset is sound");
    let directory = tempfile::tempdir().expect("there is a temporary directory");
    let mut group = criterion.benchmark_group("run: paper, 24.7 s at 1 kHz");
    group.sample_size(10);
    group.bench_function("simulation alone", |b| {
        b.iter(|| Simulation::new(&scenario).expect("regular").count());
    });
    group.bench_function("all channels to MCAP", |b| {
        b.iter(|| archive(&scenario, &[], Encoding::Json, directory.path()));
    });
    let three = ["/top/state", "/top/torque", "/top/contact"].map(str::to_owned);
    group.bench_function("state, torque and contact to MCAP", |b| {
        b.iter(|| archive(&scenario, &three, Encoding::Json, directory.path()));
    });
    group.finish();
}

/// Five seconds of the paper's top under each law, at the same tolerance.
fn laws(criterion: &mut Criterion) {
    let smoothing = ("friction.smoothing_speed", "0.005");
    let all: &[(&str, &[(&str, &str)])] = &[
        ("coulomb", &[]),
        ("coulomb-sqrt", &[smoothing]),
        ("coulomb-tanh", &[smoothing]),
        ("coulomb-rational", &[smoothing]),
        ("viscous", &[("friction.viscous_speed", "0.5")]),
        (
            "stribeck",
            &[
                ("friction.static_k", "0.045"),
                ("friction.stribeck_speed", "0.05"),
                ("friction.viscous_slope", "0.01"),
            ],
        ),
        ("contensou", &[("friction.patch_radius", "1.4e-4")]),
        ("formula", &[("friction.formula", "k")]),
        (
            "formula",
            &[
                ("friction.formula", "k + (a - k)*exp(-(v/b)^2) + c*v"),
                ("friction.a", "0.045"),
                ("friction.b", "0.05"),
                ("friction.c", "0.01"),
            ],
        ),
        (
            "coulomb",
            &[
                ("rolling.arm", "1e-4"),
                ("drilling.k", "0.03"),
                ("drilling.patch_radius", "1.4e-4"),
                ("air.axial", "1e-6"),
                ("air.transverse", "1e-6"),
                ("air.disc", "1e-8"),
            ],
        ),
    ];
    for formulation in ["euler", "body"] {
        let mut group =
            criterion.benchmark_group(format!("law: 5 s of the paper's top, {formulation}"));
        for (law, parameters) in all {
            let mut values = Preset::find("full-coulomb")
                .and_then(Preset::values)
                .expect("the preset is sound");
            let common = [
                ("formulation", formulation),
                ("friction.law", *law),
                ("stop.duration", "5"),
            ];
            for (key, value) in common.iter().chain(*parameters) {
                values.set(key, value).expect("the key exists");
            }
            let scenario = Scenario::new(values).expect("the scenario is sound");
            let detail = match parameters {
                [("friction.formula", formula), ..] => format!(" {formula}"),
                [("rolling.arm", _), ..] => " + losses".to_owned(),
                _ => String::new(),
            };
            group.bench_function(format!("{law}{detail}"), |b| {
                b.iter(|| Simulation::new(&scenario).expect("regular").count());
            });
        }
        group.finish();
    }
}

/// A preset with keys set otherwise.
fn changed(preset: &str, keys: &[(&str, &str)]) -> Scenario {
    let mut values = Preset::find(preset)
        .and_then(Preset::values)
        .expect("the preset is sound");
    for (key, value) in keys {
        values.set(key, value).expect("the key exists");
    }
    Scenario::new(values).expect("the scenario is sound")
}

/// The paper's rise integrated, and not looked at.
fn integrated(densely: bool) -> f64 {
    let paper = changed("paper", &[]);
    let state: [f64; EulerAngles::STATE_LENGTH] =
        EulerAngles::state(paper.angles, paper.rates, &paper.model);
    let (model, phase) = (paper.model, Phase::Sliding);
    let system = EulerAngles { model, phase };
    let mut integrator =
        Dop853::new(system, 0.0, state, paper.tolerances).expect("the start is regular");
    while integrator.t() < 24.719 {
        if densely {
            integrator.step_densely().expect("the motion is regular");
            black_box(integrator.dense());
        } else {
            integrator.step().expect("the motion is regular");
        }
    }
    integrator.y()[1]
}

/// Outcomes: the paper's whole rise, the same top held and free, and a peg that bounces to rest or doesn't bounce.
fn outcomes(criterion: &mut Criterion) {
    let viscous = [
        ("friction.law", "viscous"),
        ("friction.viscous_speed", "0.5"),
        ("stop.duration", "5"),
    ];
    let held = [&[("formulation", "body")][..], &viscous].concat();
    let all = [
        ("paper's rise", changed("paper", &[])),
        ("5 s, held, viscous", changed("full-coulomb", &held)),
        (
            "5 s, free, viscous",
            changed("free-viscous", &[("stop.duration", "5")]),
        ),
        (
            "drop, e = 0",
            changed("drop", &[("support.restitution", "0")]),
        ),
        (
            "drop, e = 0.98",
            changed("drop", &[("support.restitution", "0.98")]),
        ),
    ];
    let mut group = criterion.benchmark_group("outcome");
    group.sample_size(20);
    for (name, densely) in [
        ("its integration, plain steps", false),
        ("its integration, dense output of each step", true),
    ] {
        group.bench_function(format!("paper's rise: {name}"), |b| {
            b.iter(|| black_box(integrated(densely)));
        });
    }
    for (name, scenario) in all {
        let of = |scenario| outcome(scenario, || true).expect("the run succeeds");
        println!("{name}: {} impacts", of(&scenario).end.impacts);
        group.bench_function(name, |b| b.iter(|| black_box(of(&scenario))));
    }
    group.finish();
}

/// A preset's run, recorded in both encodings.
fn recorded(preset: &str, directory: &Path) -> [Recording; 2] {
    let scenario = Preset::find(preset)
        .and_then(Preset::scenario)
        .expect("the preset is sound");
    Encoding::ALL.map(|encoding| {
        archive(&scenario, &[], encoding, directory);
        let path = directory.join(format!("{preset}-{}.mcap", encoding.name()));
        std::fs::rename(directory.join("bench.mcap"), &path).expect("it was written");
        Recording::open(&path).expect("it is a recording")
    })
}

/// Comparing the paper's run with that of the whole friction torque.
fn diffs(criterion: &mut Criterion) {
    let directory = tempfile::tempdir().expect("there is a temporary directory");
    let [json_a, protobuf_a] = recorded("paper", directory.path());
    let [json_b, protobuf_b] = recorded("full-coulomb", directory.path());
    let mut group = criterion.benchmark_group("diff: paper and full-coulomb, 24.7 s at 1 kHz");
    group.sample_size(10);
    for (name, a, b) in [
        ("JSON", &json_a, &json_b),
        ("protobuf", &protobuf_a, &protobuf_b),
    ] {
        for (what, integration_error) in [("", false), (" with the integrators' errors", true)] {
            let options = diff::Options {
                integration_error,
                ..diff::Options::default()
            };
            group.bench_function(format!("{name}{what}"), |bencher| {
                bencher.iter(|| black_box(diff::compare(a, b, &options).expect("they are sound")));
            });
        }
    }
    group.finish();
}

/// Reading the paper's run back, in both encodings.
fn recordings(criterion: &mut Criterion) {
    let directory = tempfile::tempdir().expect("there is a temporary directory");
    let [json, protobuf] = recorded("paper", directory.path());
    for (name, recording) in [("JSON", &json), ("protobuf", &protobuf)] {
        let mut group = criterion.benchmark_group(format!("recording: paper in {name}"));
        group.sample_size(10);
        group.bench_function("verify", |b| {
            b.iter(|| black_box(verify(recording, &|_| {})));
        });
        group.bench_function("decode everything", |b| {
            b.iter(|| {
                let mut reader = recording.reader(Selection::default());
                let mut sum = 0.0;
                while let Some(message) = reader.next() {
                    sum += message.expect("it is sound").numbers[0];
                }
                black_box(sum)
            });
        });
        group.finish();
    }
}

/// Reading what all figures of the paper's run need, and drawing them.
fn figures(criterion: &mut Criterion) {
    let scenario = Preset::find("paper")
        .and_then(Preset::scenario)
        .expect("the preset is sound");
    let directory = tempfile::tempdir().expect("there is a temporary directory");
    archive(&scenario, &[], Encoding::Json, directory.path());
    let path = directory.path().join("bench.mcap");
    let recording = Recording::open(&path).expect("it is a recording");
    let wanted: Vec<_> = FIGURES.iter().filter(|f| f.min_runs == 1).collect();
    let read = || RunData::read(&recording, "paper", &wanted, &|_| {});
    let mut group = criterion.benchmark_group("figures: paper");
    group.sample_size(10);
    group.bench_function("read", |b| b.iter(|| black_box(read())));
    let run = read();
    for figure in &wanted {
        group.bench_function(figure.name, |b| {
            b.iter(|| {
                let drawing = figure.draw(&[&run], 85.0);
                black_box((drawing.svg(), drawing.png().expect("it has a size")))
            });
        });
    }
    group.finish();
}

criterion_group!(
    benches, integrator, runs, laws, outcomes, recordings, diffs, figures
);
criterion_main!(benches);
