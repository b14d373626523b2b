//! Figures: what they show, their bytes, and the command that draws them.

use crate::support::{archive, scenario};
use assert_cmd::Command;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;
use tempfile::{TempDir, tempdir};
use toprise::analysis::figures::{FIGURES, Figure, Run};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::telemetry::encoding::Encoding;

fn all() -> Vec<&'static Figure> {
    FIGURES.iter().collect()
}

fn short(preset: &str) -> Run {
    let scenario = scenario(preset, &[("stop.duration", "1.0")]);
    Run::read(&scenario, preset, &all(), &|_| {})
}

/// Records a short run with these topics, all if there are none.
fn record(directory: &TempDir, name: &str, topics: &[&str]) {
    let scenario = scenario("paper", &[("stop.duration", "0.5")]);
    let path = directory.path().join(name);
    archive(&path, &scenario, topics, Form::default()).unwrap();
}

fn figures(directory: &TempDir, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("toprise").unwrap();
    command.current_dir(directory.path()).arg("figures");
    command.args(arguments);
    command
}

fn error_of(command: &mut Command, code: i32) -> String {
    let output = command.assert().code(code).get_output().clone();
    String::from_utf8(output.stderr).unwrap()
}

/// Asserts that a document is one element whose tags and quotes match; tells how many elements it has.
fn elements(xml: &str) -> usize {
    let body = xml
        .strip_prefix("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n")
        .unwrap();
    let (mut open, mut count) = (Vec::new(), 0);
    for (index, piece) in body.split('<').enumerate() {
        let Some((tag, text)) = piece.split_once('>') else {
            assert!(index == 0 && piece.is_empty(), "{piece}");
            continue;
        };
        assert!(!text.contains('&') || text.contains(';'), "{text}");
        assert!(tag.matches('"').count() % 2 == 0, "{tag}");
        let name = tag.split([' ', '/']).next().unwrap();
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed), "{closed}");
        } else {
            count += 1;
            assert!(count == 1 || !open.is_empty(), "{name} stands outside");
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "{open:?}");
    count
}

#[test]
fn every_figure_of_a_short_run_draws_and_is_well_formed() {
    let runs = [short("paper"), short("full-coulomb"), short("frictionless")];
    let runs: Vec<_> = runs.iter().collect();
    for figure in FIGURES {
        for runs in [&runs[..1], &runs] {
            if runs.len() < figure.least_runs {
                continue;
            }
            assert!(
                runs.iter().all(|run| figure.missing(run).is_none()),
                "{}",
                figure.name
            );
            for width in [85.0, 170.0] {
                let drawing = figure.draw(runs, width);
                let svg = drawing.svg();
                assert!(elements(&svg) > 50, "{}", figure.name);
                assert!(
                    svg.contains(&format!("width=\"{width}mm\"")),
                    "{}",
                    figure.name
                );
                let png = drawing.png().unwrap();
                assert!(png.starts_with(b"\x89PNG"));
                let pixels = u32::from_be_bytes(png[16..20].try_into().unwrap());
                assert_eq!(pixels, (width / 25.4 * 300.0).round() as u32);
            }
        }
    }
}

#[test]
fn axes_are_named_with_symbols_and_units() {
    let run = short("paper");
    let svg = |name| Figure::find(name).unwrap().draw(&[&run], 85.0).svg();
    for (name, labels) in [
        (
            "figure-2",
            &[
                "θ (rad)",
                "θ\u{307} (10^−3 rad/s)",
                "φ\u{307} (rad/s)",
                "ψ\u{307} (rad/s)",
                "t (s)",
            ][..],
        ),
        ("figure-3", &["n_x", "n_y", "z′"]),
        (
            "acceleration",
            &["mean θ\u{308} (rad/s²)", "mean φ\u{308} (rad/s²)"],
        ),
        ("torque", &["τ (10^−6 N m)"]),
        ("slip", &["|v| (m/s)", "s (m)"]),
        ("energy", &["E (J)", "ΔE (10^−3 J)"]),
    ] {
        let svg = svg(name);
        for label in labels {
            let found = svg.contains(&format!("aria-label=\"{label}\""));
            assert!(found, "{name} doesn't name {label}");
        }
    }
}

#[test]
fn names_of_runs_are_escaped() {
    let mut run = short("paper");
    run.name = "<a & \"b\">\u{1}".to_owned();
    let svg = Figure::find("figure-2")
        .unwrap()
        .draw(&[&run, &run], 85.0)
        .svg();
    assert!(elements(&svg) > 50);
    assert!(
        svg.contains("&lt;a &amp; &quot;b&quot;&gt;\u{fffd}"),
        "{}",
        &svg[..500]
    );
}

/// Figures, and the SHA-256 of their SVG and PNG.
///
/// They change with the looks of figures, and with the physics. They must be the same on every machine.
#[rustfmt::skip]
const GOLDEN: &[(&str, &str, &str)] = &[
    ("figure-2",
     "87f755dd8e59fe9c72b01a1ad8d863c810af325cbbc7735e61ca904cc0a277c0",
     "1f84649ff2e35b75c3e9fe79b7e29f1c7b0013b18c1ab87cad17b7478b219870"),
    ("figure-3",
     "e0031daffc360d7b10fa9164de6bea9cdb376b19cb3236930a7db5f644ecaea9",
     "7ed15d2c2ed2d7029eeeae85454d81a8d103cdc963289ffd8bd97d3080461e45"),
    ("precession",
     "63f7adedfcc80398aa1aa148116f98e4f60e2a0ac882859cc68f79a2a2c20c5b",
     "42d0576b188d4c2ba6be5fc226047fdb0e563eccd5029439c057529acaeba786"),
];

#[test]
fn regress_bytes() {
    let found: Vec<_> = ["figure-2", "figure-3", "precession"]
        .into_iter()
        .map(|name| {
            let draw = || {
                let drawing = Figure::find(name).unwrap().draw(&[&short("paper")], 85.0);
                let sum = |bytes: &[u8]| format!("{:x}", Sha256::digest(bytes));
                (sum(drawing.svg().as_bytes()), sum(&drawing.png().unwrap()))
            };
            let (svg, png) = draw();
            assert_eq!(
                (svg.clone(), png.clone()),
                draw(),
                "{name} differs from itself"
            );
            (name, svg, png)
        })
        .collect();
    let golden = |(name, svg, png): &(&'static str, &str, &str)| {
        (*name, (*svg).to_owned(), (*png).to_owned())
    };
    assert_eq!(found, GOLDEN.iter().map(golden).collect::<Vec<_>>());
}

#[test]
fn whole_runs_make_small_files() {
    let run = Run::read(&scenario("paper", &[]), "paper", &all(), &|_| {});
    let other = Run::read(
        &scenario("paper-spin-term-only", &[]),
        "paper-spin-term-only",
        &all(),
        &|_| {},
    );
    for figure in FIGURES {
        for runs in [&[&run][..], &[&run, &other]] {
            if runs.len() < figure.least_runs {
                continue;
            }
            for width in [85.0, 170.0] {
                let drawing = figure.draw(runs, width);
                let (svg, png) = (drawing.svg().len(), drawing.png().unwrap().len());
                let most = if runs.len() == 1 { 300_000 } else { 600_000 };
                assert!(
                    svg < most && png < most,
                    "{}: {svg} and {png} bytes",
                    figure.name
                );
            }
        }
    }
}

#[test]
fn recordings_draw_as_their_simulation() {
    let directory = tempdir().unwrap();
    let scenario = scenario("paper", &[("stop.duration", "1.0")]);
    for encoding in [Encoding::Json, Encoding::Protobuf] {
        let path = directory.path().join(format!("{encoding:?}.mcap"));
        let form = Form {
            encoding,
            ..Form::default()
        };
        archive(&path, &scenario, &[], form).unwrap();
        let recording = Recording::open(&path).unwrap();
        let run = Run::read(&recording, "paper", &all(), &|_| {});
        assert!(run == short("paper"), "{encoding:?}");
    }
}

#[test]
fn the_command_writes_both_kinds_and_overwrites_nothing() {
    let directory = tempdir().unwrap();
    record(&directory, "a.mcap", &[]);
    let arguments = ["a.mcap", "-o", "out", "--only", "figure-2,energy"];
    let output = figures(&directory, &arguments)
        .assert()
        .success()
        .get_output()
        .stdout
        .clone();
    let output = String::from_utf8(output).unwrap();
    let files = ["figure-2.svg", "figure-2.png", "energy.svg", "energy.png"];
    for file in files {
        assert!(output.contains(&format!("wrote out/{file}")), "{output}");
        assert!(directory.path().join("out").join(file).is_file());
    }
    assert_eq!(
        fs::read_dir(directory.path().join("out")).unwrap().count(),
        files.len()
    );
    fs::write(directory.path().join("out/energy.png"), "mine").unwrap();
    let error = error_of(&mut figures(&directory, &arguments), 2);
    assert!(
        error.contains("exists") && error.contains("--force"),
        "{error}"
    );
    assert_eq!(
        fs::read(directory.path().join("out/energy.png")).unwrap(),
        b"mine"
    );
    let forced = [&arguments[..], &["--force", "--format", "png,png"]].concat();
    figures(&directory, &forced).assert().success();
    assert!(fs::read(directory.path().join("out/energy.png")).unwrap() != b"mine");
}

#[test]
fn without_a_run_the_presets_are_drawn() {
    let directory = tempdir().unwrap();
    figures(
        &directory,
        &["--only", "figure-4", "--format", "svg", "--width", "170"],
    )
    .assert()
    .success();
    let svg = fs::read_to_string(directory.path().join("figures/figure-4.svg")).unwrap();
    for name in [
        "paper, average",
        "paper-precession-term-only",
        "paper-spin-term-only",
    ] {
        assert!(svg.contains(name), "{name}");
    }
}

#[test]
fn what_is_missing_is_told_and_the_rest_is_drawn() {
    let directory = tempdir().unwrap();
    record(&directory, "some.mcap", &["/top/state", "/top/nutation"]);
    record(&directory, "other.mcap", &["/events"]);
    let error = error_of(
        &mut figures(&directory, &["some.mcap", "--format", "svg"]),
        3,
    );
    for part in [
        "some: figure-3 needs /top/pose",
        "some: energy needs /top/energy",
    ] {
        assert!(error.contains(part), "{part} is not in {error}");
    }
    let drawn: Vec<_> = fs::read_dir(directory.path().join("figures"))
        .unwrap()
        .collect();
    assert_eq!(drawn.len(), 1);
    let error = error_of(&mut figures(&directory, &["other.mcap", "-o", "none"]), 2);
    assert!(error.contains("nothing can be drawn"), "{error}");
    let error = error_of(
        &mut figures(&directory, &["some.mcap", "--only", "figure-4"]),
        2,
    );
    assert!(error.contains("figure-4 compares runs"), "{error}");
}

#[test]
fn an_interrupted_run_is_drawn_as_far_as_it_goes() {
    let directory = tempdir().unwrap();
    record(&directory, "whole.mcap", &[]);
    let whole = fs::read(directory.path().join("whole.mcap")).unwrap();
    fs::write(directory.path().join("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    let arguments = ["cut.mcap", "--only", "figure-2", "--format", "svg"];
    let error = error_of(&mut figures(&directory, &arguments), 3);
    assert!(error.contains("cut: the run was cut off"), "{error}");
    assert!(directory.path().join("figures/figure-2.svg").is_file());
}

#[test]
fn bad_arguments_write_nothing() {
    let directory = tempdir().unwrap();
    fs::write(directory.path().join("file"), "").unwrap();
    for (arguments, part) in [
        (&["--only", "figure-5"][..], "figure-"),
        (&["--only", "precesion"], "'precession'"),
        (&["--width", "20"], "80 to 400"),
        (&["--format", "pdf"], "svg"),
        (&["missing.mcap"], "missing.mcap"),
        (&["file"], "file"),
        (&["-o", "file/figures", "--only", "slip"], "file"),
    ] {
        let error = error_of(&mut figures(&directory, arguments), 2);
        assert!(
            error.contains(part),
            "{arguments:?}: {part} is not in {error}"
        );
        assert!(!error.contains("panicked"), "{error}");
    }
    assert!(!Path::new(&directory.path().join("figures")).exists());
}
