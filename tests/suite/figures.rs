//! Figures: what they show, their bytes, and the command that draws them.

use crate::support::{Folder, archive, assert_contains, assert_near, files, scenario};
use roxmltree::{Document, Node};
use sha2::{Digest, Sha256};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::figures::{FIGURES, Figure, RunData};
use toprise::telemetry::encoding::Encoding;

fn all() -> Vec<&'static Figure> {
    FIGURES.iter().collect()
}

fn short(preset: &str) -> RunData {
    simulated(preset, &[("stop.duration", "1.0")])
}

/// Records a short run with these topics, all if there are none.
fn record(folder: &Folder, name: &str, topics: &[&str]) {
    let scenario = scenario("paper", &[("stop.duration", "0.5")]);
    archive(&folder.at(name), &scenario, topics, Form::default()).unwrap();
}

const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";

fn parsed(svg: &str) -> Document<'_> {
    Document::parse(svg).unwrap_or_else(|error| panic!("{error} in {}", &svg[..400.min(svg.len())]))
}

/// The labels of all groups, as a reader of the document gets them.
fn labels(svg: &str) -> Vec<String> {
    parsed(svg)
        .descendants()
        .filter_map(|node| node.attribute("aria-label"))
        .map(str::to_owned)
        .collect()
}

fn has_label(svg: &str, label: &str) -> bool {
    labels(svg).iter().any(|found| found == label)
}

#[track_caller]
fn assert_label(svg: &str, label: &str) {
    assert!(
        has_label(svg, label),
        "{label:?} is not in {:?}",
        labels(svg)
    );
}

/// The note that samples are too few to show nutation.
fn unresolved(svg: &str) -> Option<String> {
    labels(svg)
        .into_iter()
        .find(|label| label.contains("not resolved"))
}

/// The value of an attribute in mm.
fn millimetres(node: Node<'_, '_>, name: &str) -> f64 {
    let text = node.attribute(name).unwrap();
    text.strip_suffix("mm").unwrap().parse().unwrap()
}

/// Asserts that a document is an SVG image of this size in mm, made of known elements, whose references lead somewhere.
fn check_svg(svg: &str, (width, height): (f64, f64), what: &str) {
    let document = parsed(svg);
    let root = document.root_element();
    let tag = root.tag_name();
    assert!(root.has_tag_name((SVG, "svg")), "{what}: {tag:?}");
    let (svg_width, svg_height) = (millimetres(root, "width"), millimetres(root, "height"));
    // Lengths are whole hundredths of a millimetre, and the view box counts these.
    assert!((svg_width - width).abs() <= 0.005, "{what}");
    assert!((svg_height - height).abs() <= 0.005, "{what}");
    let view: Vec<f64> = root
        .attribute("viewBox")
        .unwrap()
        .split(' ')
        .map(|number| number.parse().unwrap())
        .collect();
    let expected = [0.0, 0.0, 100.0 * svg_width, 100.0 * svg_height];
    let is_right = view.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(is_right, "{what}: {view:?}");
    let title = root.first_element_child().unwrap();
    let has_title = title.has_tag_name((SVG, "title")) && title.text().is_some();
    assert!(has_title, "{what}");
    let known = ["svg", "title", "defs", "path", "rect", "g", "circle", "use"];
    let mut counts = [0; 8];
    for node in document.descendants().filter(Node::is_element) {
        let tag = node.tag_name();
        assert_eq!(tag.namespace(), Some(SVG), "{what}: {tag:?}");
        let kind = known.iter().position(|name| *name == tag.name());
        counts[kind.unwrap_or_else(|| panic!("{what}: {tag:?}"))] += 1;
        if tag.name() == "use" {
            let target = node.attribute((XLINK, "href")).unwrap();
            let id = target.strip_prefix('#').unwrap();
            let glyph = document
                .descendants()
                .find(|node| node.attribute("id") == Some(id));
            let is_drawn = glyph.is_some_and(|glyph| glyph.has_attribute("d"));
            assert!(is_drawn, "{what}: no {target}");
        }
        if tag.name() == "path" {
            let data = node.attribute("d").unwrap();
            // Spaces are the only glyphs without an outline.
            let is_space = node.has_attribute("id") && data.is_empty();
            assert!(data.starts_with('M') || is_space, "{what}: {data}");
            let is_finite = !data.contains("NaN") && !data.contains("inf");
            assert!(is_finite, "{what}: {data}");
        }
    }
    let [svgs, titles, defs, paths, .., groups, _, uses] = counts;
    assert_eq!((svgs, titles, defs), (1, 1, 1), "{what}");
    assert!(paths > 10 && groups > 5 && uses > 10, "{what}: {counts:?}");
}

#[test]
fn skips_inapplicable_figures_with_a_reason() {
    let (held, free) = (short("paper"), short("drop"));
    for figure in FIGURES {
        let applies = figure.exclusion(&held).is_none();
        assert_eq!(applies, figure.is_expected_for(&held), "{}", figure.name);
    }
    let inapplicable: Vec<_> = FIGURES
        .iter()
        .filter(|figure| figure.exclusion(&free).is_some())
        .map(|figure| figure.name)
        .collect();
    assert_eq!(inapplicable, ["acceleration", "precession"]);
    Folder::new().refuses("figures paper --only track", "the peg is fixed");
}

#[test]
fn skips_hops_of_a_peg_that_stays_on_the_table() {
    let hops = Figure::find("hops").unwrap();
    assert_eq!(
        hops.exclusion(&short("tippe-top")),
        Some("the peg does not leave the table")
    );
    assert_eq!(hops.exclusion(&short("drop")), None);
}

#[test]
fn fast_oscillation_is_a_band_with_its_average() {
    let run = simulated("free-paper", &[("stop.duration", "4.0")]);
    let svg = svg_of("torque", &[&run]);
    assert!(places(&svg, "free-paper: friction_node.y").len() > 1000);
    // The average is smooth: it has a point for each nutation.
    let average = places(&svg, "free-paper: friction, τ_y");
    assert!((100..400).contains(&average.len()), "{}", average.len());
    assert_label(&svg, "nutation; the line in it: its average");
    let smooth = svg_of("torque", &[&short("paper")]);
    assert!(!smooth.contains("the line in it"));
}

#[test]
fn tracks_show_sliding_rolling_and_flight() {
    let run = simulated("free-paper", &[("stop.duration", "8.0")]);
    let svg = svg_of("track", &[&run]);
    for part in ["sliding", "rolling", "in the air"] {
        assert_label(&svg, part);
        let group = format!("free-paper: track of the contact point, {part}");
        assert!(!places(&svg, &group).is_empty(), "{part}");
    }
    let short = svg_of("track", &[&short("tippe-top")]);
    assert!(!has_label(&short, "in the air"));
}

#[test]
fn every_figure_is_valid_svg_and_png() {
    let runs = [short("paper"), short("full-coulomb"), short("frictionless")];
    let held: Vec<_> = runs.iter().collect();
    let [free, tippe] = [short("drop"), short("tippe-top")];
    let free = vec![&free, &tippe];
    for figure in FIGURES {
        let is_of_held = figure.is_expected_for(held[0]);
        let mut runs = if is_of_held {
            held.clone()
        } else {
            free.clone()
        };
        runs.retain(|run| figure.exclusion(run).is_none());
        for runs in [&runs[..1], &runs[..]] {
            if runs.len() < figure.min_runs {
                continue;
            }
            let is_complete = runs.iter().all(|run| figure.missing(run).is_none());
            assert!(is_complete, "{}", figure.name);
            for width in [85.0, 170.0] {
                let drawing = figure.draw(runs, width);
                let what = format!("{} of {} runs, {width} mm", figure.name, runs.len());
                assert_eq!(drawing.size().0, width);
                check_svg(&drawing.svg(), drawing.size(), &what);
                let png = drawing.png().unwrap();
                assert!(png.starts_with(b"\x89PNG"));
                let pixels = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
                let expected = |length: f64| (length / 25.4 * 300.0).round() as u32;
                let (width, height) = drawing.size();
                let expected = (expected(width), expected(height));
                assert_eq!((pixels(16), pixels(20)), expected, "{what}");
            }
        }
    }
}

#[test]
fn axes_have_symbols_and_units() {
    let run = short("paper");
    let svg = |name| Figure::find(name).unwrap().draw(&[&run], 85.0).svg();
    for (name, expected) in [
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
        let found = labels(&svg(name));
        for label in expected {
            let is_there = found.iter().any(|found| found == label);
            assert!(is_there, "{name} doesn't name {label}");
        }
    }
}

fn simulated(preset: &str, changes: &[(&str, &str)]) -> RunData {
    RunData::read(&scenario(preset, changes), preset, &all(), &|_| {})
}

fn svg_of(name: &str, runs: &[&RunData]) -> String {
    Figure::find(name).unwrap().draw(runs, 85.0).svg()
}

/// The places on the lines and areas of a group, in hundredths of a millimetre from the upper left corner.
fn places(svg: &str, group: &str) -> Vec<(f64, f64)> {
    parsed(svg)
        .descendants()
        .filter(|node| node.attribute("aria-label") == Some(group))
        .flat_map(|group| group.children())
        .filter_map(|path| path.attribute("d"))
        .flat_map(places_on_path)
        .collect()
}

/// The places on a path of relative steps.
fn places_on_path(path: &str) -> Vec<(f64, f64)> {
    let numbers: Vec<f64> = path
        .replace('-', " -")
        .replace(['M', 'l', 'z'], " ")
        .split_whitespace()
        .map(|number| number.parse().unwrap())
        .collect();
    let mut places = Vec::new();
    let mut place = (0.0, 0.0);
    for step in numbers.chunks(2) {
        place = (place.0 + step[0], place.1 + step[1]);
        places.push(place);
    }
    places
}

/// The least and greatest heights of a group where it is between these parts of its width.
fn heights(svg: &str, group: &str, (from, to): (f64, f64)) -> (f64, f64) {
    let places = places(svg, group);
    let (left, right) = extremes(places.iter().map(|place| place.0));
    let part = |place: &&(f64, f64)| {
        let at = (place.0 - left) / (right - left);
        from <= at && at <= to
    };
    extremes(places.iter().filter(part).map(|place| -place.1))
}

fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

/// A top that spins so fast that the default samples are too few for its nutation, of 2.5 ms.
const FAST: [(&str, &str); 2] = [("initial.psi_dot", "3000"), ("stop.duration", "0.5")];

#[test]
fn val_simulations_are_sampled_finely_enough_for_nutation() {
    let run = simulated("frictionless", &FAST);
    let svg = svg_of("figure-2", &[&run]);
    for quantity in ["theta_dot", "phi_dot"] {
        let group = format!("frictionless: {quantity}");
        let part = |part: i32| (f64::from(part) / 20.0, f64::from(part + 1) / 20.0);
        let parts = (0..20).map(|number| heights(&svg, &group, part(number)));
        let parts: Vec<_> = parts.collect();
        // Without friction the envelope is constant; the width of a line is 25.
        for (low, high) in &parts {
            let changes = [low - parts[0].0, high - parts[0].1];
            let is_constant = changes.iter().all(|change| change.abs() < 25.0);
            assert!(is_constant, "{quantity}: {parts:?}");
        }
    }
    let svg = svg_of("acceleration", &[&run]);
    assert_eq!(unresolved(&svg), None);
    // The mean of the gyroscopic term balances gravity all the time.
    let (low, high) = heights(&svg, "frictionless: gyroscopic", (0.0, 1.0));
    let (top, bottom) = heights(&svg, "frame", (0.0, 1.0));
    assert!(high - low < 0.6 * (bottom - top).abs(), "{low} to {high}");
}

#[test]
fn notes_too_few_samples() {
    let folder = Folder::new();
    let path = folder.at("coarse.mcap");
    let changes = [("sampling.period", "0.02"), ("stop.duration", "2")];
    let coarse = scenario("paper", &changes);
    archive(&path, &coarse, &[], Form::default()).unwrap();
    let run = RunData::read(&Recording::open(&path).unwrap(), "coarse", &all(), &|_| {});
    for name in [
        "figure-3",
        "acceleration",
        "precession",
        "torque",
        "slip",
        "energy",
    ] {
        let svg = svg_of(name, &[&run]);
        let expected = "only 2.2 samples per nutation: nutation is not resolved";
        assert_eq!(unresolved(&svg).as_deref(), Some(expected), "{name}");
    }
    // The least and greatest θ of each nutation are recorded.
    let svg = svg_of("figure-4", &[&run, &run]);
    assert_eq!(unresolved(&svg), None);
    let group = "coarse: theta, range in each nutation";
    assert!(!places(&svg, group).is_empty());
    let fine = simulated("paper", &[("stop.duration", "2")]);
    let fine = svg_of("figure-2", &[&fine]);
    assert_eq!(unresolved(&fine), None);
}

#[test]
fn clips_and_marks_spikes_at_upright() {
    // The passages through upright are around 33 s.
    let upright = simulated("lifecycle", &[("stop.duration", "45")]);
    let svg = svg_of("figure-2", &[&upright]);
    assert_label(&svg, "key: beyond the axis");
    assert_label(&svg, "beyond the axis");
    let paper = svg_of("figure-2", &[&short("paper")]);
    assert!(!labels(&paper).iter().any(|label| label.contains("beyond")));
}

#[test]
fn legend_skips_absent_averages() {
    let average = "key: average over each nutation";
    let nutating = short("paper");
    assert!(has_label(&svg_of("figure-2", &[&nutating]), average));
    let falling = simulated("paper", &[("initial.psi_dot", "0")]);
    assert!(!has_label(&svg_of("figure-2", &[&falling]), average));
}

#[test]
fn precession_shares_a_panel_with_the_followed_root() {
    for (preset, changes, root, is_above) in [
        ("paper", &[][..], "slow_root", false),
        (
            "paper",
            &[("initial.psi_dot", "-170"), ("initial.phi_dot", "-1.75")],
            "slow_root",
            true,
        ),
        ("rise-by-loss-of-spin", &[], "fast_root", true),
    ] {
        let changes = [changes, &[("stop.duration", "1")]].concat();
        let svg = svg_of("precession", &[&simulated(preset, &changes)]);
        let height = |field: &str| heights(&svg, &format!("{preset}: {field}"), (0.0, 1.0));
        let (rate, followed) = (height("phi_dot"), height(root));
        let follows = rate.0 < followed.1 && followed.0 < rate.1;
        assert!(follows, "{preset}: {rate:?}, {followed:?}");
        let is_slow = root == "slow_root";
        let other = height(if is_slow { "fast_root" } else { "slow_root" });
        // Above on paper is above in value.
        assert_eq!(rate.0 > other.1, is_above, "{preset}: {rate:?}, {other:?}");
        assert_label(&svg, "break of the axis");
    }
}

#[test]
fn magnifies_separate_ends_separately() {
    let run = short("paper");
    let fallen = simulated(
        "paper",
        &[
            ("initial.theta", "1.4"),
            ("stop.duration", "3"),
            ("stop.theta_fallen", "2"),
        ],
    );
    assert!(!has_label(&svg_of("figure-3", &[&run, &run]), "(d)"));
    assert!(has_label(&svg_of("figure-3", &[&run, &fallen]), "(d)"));
}

#[test]
fn caption_of_small_circles_has_a_power_of_ten() {
    let run = simulated(
        "paper",
        &[
            ("initial.theta", "0.001"),
            ("stop.theta_risen", "0.0001"),
            ("stop.duration", "0.2"),
        ],
    );
    let found = labels(&svg_of("figure-3", &[&run]));
    let caption = found
        .iter()
        .find(|label| label.starts_with("circles at"))
        .unwrap();
    assert!(caption.ends_with("(10^−3 rad)"), "{caption}");
}

#[test]
fn escapes_names_of_runs() {
    let mut run = short("paper");
    run.name = "<a & \"b\">\u{1}".to_owned();
    let svg = svg_of("figure-2", &[&run, &run]);
    // XML has no way to write the control character.
    let name = "<a & \"b\">\u{fffd}";
    let title = format!("θ, θ\u{307}, φ\u{307} and ψ\u{307} over time — {name}, {name}");
    let document = parsed(&svg);
    let found = document.root_element().first_element_child().unwrap();
    assert_eq!(found.text(), Some(title.as_str()));
    assert_label(&svg, &format!("key: {name}"));
}

/// Figures, and the SHA-256 of their SVG and PNG.
///
/// They change with the style of figures, and with the physics. They must be the same on every machine.
#[rustfmt::skip]
const GOLDEN: &[(&str, &str, &str)] = &[
    ("figure-2",
     "d9d6cf29c90f779424872505577609619082ddf6528664d2f992b13e3f28f745",
     "41b520b0c7acd574a5fffafe9194e3752be6aa883021ade49e6dd520fd46a624"),
    ("figure-3",
     "e0031daffc360d7b10fa9164de6bea9cdb376b19cb3236930a7db5f644ecaea9",
     "7ed15d2c2ed2d7029eeeae85454d81a8d103cdc963289ffd8bd97d3080461e45"),
    ("precession",
     "d0fc86ad352a089e4615575beef4d3702abf88211aab7742103ba518d5e151c6",
     "d34ab2dde661d2393cb7410b0eb34d714d5c2e6675328df9105c8ef44bb97d0c"),
];

/// The SHA-256 of the SVG and the PNG of a figure.
fn digests(name: &str) -> [String; 2] {
    let drawing = Figure::find(name).unwrap().draw(&[&short("paper")], 85.0);
    [drawing.svg().into_bytes(), drawing.png().unwrap()]
        .map(|bytes| format!("{:x}", Sha256::digest(bytes)))
}

#[test]
fn leaves_out_panels_of_zeros() {
    let [with, without] =
        ["paper", "frictionless"].map(|preset| svg_of("energy", &[&short(preset)]));
    for (label, needs_friction) in [("E (", false), ("ΔE (", true), ("P (", true)] {
        let label = format!("aria-label=\"{label}");
        assert!(with.contains(&label), "{label}");
        assert_eq!(without.contains(&label), !needs_friction, "{label}");
    }
    let torques = labels(&svg_of("torque", &[&short("frictionless")]));
    assert!(
        !torques.iter().any(|label| label.starts_with("friction, ")),
        "{torques:?}"
    );
}

/// An axis that showed nothing but rounding errors would be full of them.
#[test]
fn axes_do_not_magnify_rounding_errors() {
    let svg = svg_of("energy", &[&short("frictionless")]);
    let labels: Vec<f64> = parsed(&svg)
        .descendants()
        .filter_map(|node| node.attribute("aria-label")?.parse().ok())
        .filter(|value| (1.0..1.2).contains(value))
        .collect();
    let (low, high) = extremes(labels.iter().copied());
    assert!(
        high - low > 0.005,
        "ticks of the energy from {low} to {high} J"
    );
}

#[test]
fn regress_bytes() {
    for (name, svg, png) in GOLDEN {
        // Twice: nothing depends on the order of a hash table.
        for _ in 0..2 {
            assert_eq!(digests(name), [*svg, *png], "{name}");
        }
    }
}

#[test]
fn tracks_fill_the_width_up_to_110_mm() {
    let run = short("drop");
    let edges = |width: f64| {
        let svg = Figure::find("track").unwrap().draw(&[&run], width).svg();
        let places = places(&svg, "frame");
        let (left, right) = extremes(places.iter().map(|place| place.0 / 100.0));
        let (top, bottom) = extremes(places.iter().map(|place| place.1 / 100.0));
        [[left, right], [top, bottom]]
    };
    for width in [60.0, 85.0, 120.0] {
        let [[left, right], [top, bottom]] = edges(width);
        // Numbers and a label stand to the left, half a number may stick out to the right.
        assert!(left > 0.0 && left < 20.0, "{left} of {width}");
        assert!(right < width && right > width - 5.0, "{right} of {width}");
        assert_near("a square", right - left, bottom - top, 0.02);
    }
    let [[left, right], _] = edges(170.0);
    assert_near("the largest side, mm", right - left, 110.0, 0.02);
}

#[test]
fn files_of_whole_runs_are_small() {
    let run = simulated("paper", &[]);
    let other = simulated("paper-spin-term-only", &[]);
    for figure in FIGURES {
        for runs in [&[&run][..], &[&run, &other]] {
            if runs.len() < figure.min_runs {
                continue;
            }
            for width in [85.0, 170.0] {
                let drawing = figure.draw(runs, width);
                let (svg, png) = (drawing.svg().len(), drawing.png().unwrap().len());
                let most = if runs.len() == 1 { 300_000 } else { 600_000 };
                let sizes = format!("{}: {svg} and {png} bytes", figure.name);
                assert!(svg < most && png < most, "{sizes}");
            }
        }
    }
}

#[test]
fn recordings_and_simulations_have_equal_data() {
    let folder = Folder::new();
    let scenario = scenario("paper", &[("stop.duration", "1.0")]);
    for encoding in [Encoding::Json, Encoding::Protobuf] {
        let path = folder.at(format!("{encoding:?}.mcap"));
        let form = Form {
            encoding,
            ..Form::default()
        };
        archive(&path, &scenario, &[], form).unwrap();
        let recording = Recording::open(&path).unwrap();
        let run = RunData::read(&recording, "paper", &all(), &|_| {});
        assert!(run == short("paper"), "{encoding:?}");
    }
}

#[test]
fn command_writes_both_kinds_without_overwriting() {
    let folder = Folder::new();
    record(&folder, "a.mcap", &[]);
    let line = "figures a.mcap -o out --only figure-2,energy";
    let output = folder.toprise(line, 0).stdout;
    let written = ["energy.png", "energy.svg", "figure-2.png", "figure-2.svg"];
    for file in written {
        assert_contains(&output, &format!("out/{file}  "));
    }
    assert_eq!(files(&folder.at("out")), written);
    folder.write("out/energy.png", "mine");
    let error = folder.refuses(line, "exists").stderr;
    assert_contains(&error, "--force");
    assert_eq!(folder.read("out/energy.png"), b"mine");
    folder.toprise(&format!("{line} --force --kinds png,png"), 0);
    assert_ne!(folder.read("out/energy.png"), b"mine");
}

#[test]
fn command_without_runs_draws_the_paper() {
    let folder = Folder::new();
    folder.toprise("figures --only figure-4 --kinds svg --width 170", 0);
    let svg = folder.text("figures/figure-4.svg");
    for name in [
        "paper, average",
        "paper-precession-term-only",
        "paper-spin-term-only",
    ] {
        assert!(svg.contains(name), "{name}");
    }
}

#[test]
fn command_reports_missing_data_and_draws_the_rest() {
    let folder = Folder::new();
    record(&folder, "some.mcap", &["/top/state", "/top/nutation"]);
    record(&folder, "other.mcap", &["/events"]);
    let error = folder.toprise("figures some.mcap --kinds svg", 3).stderr;
    for part in [
        "figure-3 of some skipped: the run has no /top/pose",
        "energy of some skipped: the run has no /top/energy",
    ] {
        assert_contains(&error, part);
    }
    assert_eq!(files(&folder.at("figures")).len(), 1);
    folder.refuses("figures other.mcap -o none", "nothing can be drawn");
    let compares = "figure-4 compares runs";
    folder.refuses("figures some.mcap --only figure-4", compares);
}

#[test]
fn command_draws_interrupted_runs() {
    let folder = Folder::new();
    record(&folder, "whole.mcap", &[]);
    let whole = folder.read("whole.mcap");
    folder.write("cut.mcap", &whole[..whole.len() / 2]);
    let line = "figures cut.mcap --only figure-2 --kinds svg";
    let error = folder.toprise(line, 3).stderr;
    assert_contains(&error, "cut: missing end of the run");
    assert!(folder.at("figures/figure-2.svg").is_file());
}

#[test]
fn bad_arguments_write_nothing() {
    let folder = Folder::new();
    folder.write("file", "");
    for (arguments, part) in [
        ("--only figure-5", "figure-"),
        ("--only precesion", "a similar value exists: 'precession'"),
        ("--width 20", "80 to 400"),
        ("--kinds pdf", "svg"),
        ("missing.mcap", "missing.mcap"),
        ("file", "file"),
        ("-o file/figures --only slip", "file"),
    ] {
        let error = folder.refuses(&format!("figures {arguments}"), part).stderr;
        assert!(!error.contains("panicked"), "{error}");
    }
    assert!(!folder.at("figures").exists());
}
