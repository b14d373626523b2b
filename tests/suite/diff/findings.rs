//! Findings that could be false.

use super::*;
use toprise::analysis::diff::Dependence;
use toprise::physics::math::{atan2, cos, sin};

/// The mean θ of the cycles at a time, by straight lines between the middles.
fn mean_theta(run: &Run, time: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> = run
        .cycles
        .iter()
        .map(|cycle| (0.5 * (cycle.start + cycle.end), cycle.theta_mean))
        .collect();
    let pair = points
        .windows(2)
        .find(|p| p[0].0 <= time && time <= p[1].0)?;
    let part = (time - pair[0].0) / (pair[1].0 - pair[0].0);
    Some(pair[0].1 + part * (pair[1].1 - pair[0].1))
}

/// More friction lifts a free top faster: the crossing is earlier, at a level that both means really cross, and which is
/// not the one at which they stay when they roll.
#[test]
fn val_means_cross_levels_that_both_runs_cross() {
    let runs = ["0.03", "0.0301"].map(|k| scenario("free-paper", &[("friction.k", k)]));
    let report = compare(&runs[0], &runs[1], &quick()).unwrap();
    let crossing = finding(&report, "mean θ crosses").unwrap();
    assert!(
        crossing.difference.unwrap() < 0.0 && crossing.differs(),
        "{crossing:?}"
    );
    let Quantity::MeanCrossing { level, .. } = crossing.quantity else {
        panic!("{crossing:?}");
    };
    let rolling = values(&report, "θ at start of final rolling").map(Option::unwrap);
    for (at, scenario) in runs.iter().enumerate() {
        assert!(level > 1.05 * rolling[at], "{level} {rolling:?}");
        let run = Run::of(scenario);
        let time = values(&report, "mean θ crosses")[at].unwrap();
        let [before, here, after] = [-0.3, 0.0, 0.3].map(|d| mean_theta(&run, time + d).unwrap());
        assert!(before > here && here > after, "{before} {here} {after}");
        // Three digits of the level are shown.
        assert_near("level", here, level, 6e-4);
    }
}

/// The time of inversion is exact, not interpolated between samples.
#[test]
fn inversion_time_is_independent_of_sampling() {
    let runs =
        ["0.001", "0.02"].map(|period| scenario("tippe-top", &[("sampling.period", period)]));
    let report = compare(&runs[0], &runs[1], &quick()).unwrap();
    let [a, b] = values(&report, "inverts");
    assert!(a.is_some());
    assert_eq!(a, b);
}

/// Both tippe tops invert, the faster one first.
#[test]
fn val_tippe_tops_invert_when_the_axis_passes_the_horizontal() {
    let runs = ["80", "70"].map(|spin| scenario("tippe-top", &[("initial.psi_dot", spin)]));
    let report = compare(&runs[0], &runs[1], &quick()).unwrap();
    let found = values(&report, "inverts").map(Option::unwrap);
    for (scenario, time) in runs.iter().zip(found) {
        let run = Run::of(scenario);
        let is_over = |s: &&Sample| s.angles.theta >= std::f64::consts::FRAC_PI_2;
        let first = run.samples.iter().find(is_over).unwrap().time_ns as f64 / 1e9;
        let period = scenario.sample_period_ns as f64 / 1e9;
        assert!((first - period..=first).contains(&time), "{time} {first}");
    }
    assert!(found[0] < found[1]);
    // A tippe top can precess backward without loops.
    assert!(finding(&report, "loops").is_none());
}

/// Where only one run does something, nothing stands for the other.
#[test]
fn event_of_one_run_is_absent_in_the_other() {
    let (paper, free) = (scenario("paper", &[]), scenario("free-paper", &[]));
    let report = compare(&paper, &free, &quick()).unwrap();
    for what in [
        "first lifts off",
        "hops",
        "first rolls",
        "θ at start of final rolling",
    ] {
        let found = finding(&report, what).unwrap();
        assert!(found.a.is_none() && found.b.is_some(), "{found:?}");
        assert_eq!((found.difference, found.integration_error), (None, None));
        assert!(found.dependences.is_empty());
    }
    // The free top's run ends before the other has risen: it may have risen later.
    assert!(finding(&report, "θ first reaches").is_none());
    let mut command = Command::cargo_bin("toprise").unwrap();
    let command = command.args(["diff", "paper", "free-paper", "--no-floor"]);
    let page = command.args(["--color", "never"]).assert().code(1);
    let page = String::from_utf8(page.get_output().stdout.clone()).unwrap();
    let row = page.lines().find(|line| line.contains("first lifts off"));
    let words: Vec<_> = row.unwrap().split_whitespace().rev().take(2).collect();
    assert_eq!(words, ["3.2410", "–"], "{page}");
    let row = page
        .lines()
        .find(|line| line.trim_start().starts_with("hops"));
    assert!(row.unwrap().ends_with("  50"), "{page}");
}

/// A regularised law: the top sleeps rather than rolls, and the friction changes without bound near rest.
#[test]
fn compares_a_regularised_law_after_the_rise() {
    let smooth = [
        ("friction.law", "coulomb-sqrt"),
        ("friction.smoothing_speed", "0.001"),
        ("stop.duration", "20"),
    ];
    let (a, b) = (
        scenario("paper", &[("stop.duration", "20")]),
        scenario("paper", &smooth),
    );
    let report = compare(&a, &b, &quick()).unwrap();
    let [x, y] = [&a, &b].map(Run::of);
    let found = finding(&report, "mean θ at").unwrap();
    let deviations = &report.averaged.as_ref().unwrap().deviations;
    let theta = deviations
        .iter()
        .find(|d| d.quantity == "theta_mean")
        .unwrap();
    let expected = mean_theta(&y, theta.at).unwrap() - mean_theta(&x, theta.at).unwrap();
    // A straight line is off by h²/8 of the curvature: 0.05² / 8 · 1e-3 rad/s².
    assert_near("mean θ", found.difference.unwrap(), expected, 1e-6);
    // Less friction: the top with the smooth law is behind.
    assert!(
        finding(&report, "mean θ crosses")
            .unwrap()
            .difference
            .unwrap()
            > 0.0
    );
    let lost = [&x, &y].map(|run| {
        let [first, last] = [run.samples.first(), run.samples.last()].map(Option::unwrap);
        let energy = |s: &Sample| s.energy.kinetic + s.energy.potential;
        energy(first) - energy(last)
    });
    for (found, lost) in values(&report, "energy lost by 20").into_iter().zip(lost) {
        assert_near("energy", found.unwrap(), lost, 1e-12);
    }
}

/// Counts agree with the events and impacts of the simulation.
#[test]
fn val_counts_match_the_events() {
    let mut counted = 0.0;
    for scenario in free_tops(Random(17)).take(12) {
        let report = compare(&scenario, &scenario, &quick()).unwrap();
        let run = Run::of(&scenario);
        let summary = report.a.summary.as_ref().unwrap();
        let peg = summary.peg.as_ref().unwrap();
        let of = |kind| run.events_of(kind).count() as u64;
        assert_eq!(peg.impacts, Some(run.impacts.len() as u64));
        assert_eq!(summary.nutations.unwrap_or(0), run.cycles.len() as u64);
        // Each flight begins with a lift-off, unless the run does: a top may also start with a motion that lifts it.
        let starts_in_air = run.samples[0].regime() == Regime::Flying;
        assert_eq!(
            peg.hops,
            Some(of(EventKind::LiftOff) + u64::from(starts_in_air))
        );
        if let Some(loops) = finding(&report, "loops") {
            assert_eq!(loops.a, Some(of(EventKind::LoopingBegins) as f64));
        }
        counted += peg.hops.unwrap() as f64 + peg.impacts.unwrap() as f64;
    }
    assert!(counted > 20.0, "{counted}");
}

/// The differences of the means that an observer sees.
#[derive(Default)]
struct MeanDifferences(Vec<(f64, f64)>);

impl Observer for MeanDifferences {
    fn difference(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        if message.topic() == NUTATION {
            let difference = nutation::THETA_MEAN.of(message);
            self.0.push((message.time_ns as f64 / 1e9, difference));
        }
        Ok(())
    }
}

#[test]
fn val_means_are_compared_at_equal_times() {
    let (paper, free) = (scenario("paper", &[]), scenario("free-paper", &[]));
    let mut seen = MeanDifferences::default();
    compare_observed(&paper, &free, &quick(), &mut seen).unwrap();
    let (a, b) = (Run::of(&paper), Run::of(&free));
    for (time, difference) in &seen.0 {
        let expected = mean_theta(&b, *time).unwrap() - mean_theta(&a, *time).unwrap();
        // Hops interrupt the nutation for up to three of its periods.
        assert_near("mean θ", *difference, expected, 2e-3);
    }
    let at = |wanted: f64| seen.0.iter().find(|(time, _)| (time - wanted).abs() < 0.03);
    assert_near("at 6.84 s", at(6.84).unwrap().1, -0.235, 5e-4);
    assert!((9.9..10.0).contains(&seen.0.last().unwrap().0));
}

/// Energies are those of the last sample that both runs have, however far that is from the end.
#[test]
fn val_energies_are_compared_at_samples() {
    let end = [("stop.duration", "7.9"), ("sampling.period", "4.0")];
    let runs =
        ["0.03", "0.04"].map(|k| scenario("free-paper", &[end[0], end[1], ("friction.k", k)]));
    let report = compare(&runs[0], &runs[1], &quick()).unwrap();
    let found = values(&report, "energy lost by 4.0000 s");
    for (scenario, found) in runs.iter().zip(found) {
        let run = Run::of(scenario);
        let energy = |s: &Sample| s.energy.kinetic + s.energy.potential;
        let [first, last] = [run.samples.first(), run.samples.last()].map(Option::unwrap);
        assert_near(
            "energy",
            found.unwrap(),
            energy(first) - energy(last),
            1e-12,
        );
    }
}

/// The same motion, cut short: no finding but the end differs.
#[test]
fn shorter_run_of_the_same_motion_has_the_same_findings() {
    for end in ["0.06", "0.12", "1.0"] {
        let short = scenario("paper", &[("stop.duration", end)]);
        let report = compare(&scenario("paper", &[]), &short, &quick()).unwrap();
        let differing = report.findings.iter().filter(|found| found.differs());
        let differing: Vec<_> = differing
            .map(|found| found.quantity.label().to_string())
            .collect();
        let are_ends = differing.iter().all(|what| what.starts_with("ends"));
        assert!(are_ends, "{end}: {differing:?}");
    }
}

/// Where the events of two runs are of two kinds, their numbers are not compared.
#[test]
fn events_of_two_kinds_have_no_differences() {
    let runs = ["paper", "full-coulomb"].map(|name| scenario(name, &[]));
    let report = compare(&runs[0], &runs[1], &quick()).unwrap();
    let events = report.channels.iter().find(|c| c.topic == "/events");
    let events = events.unwrap();
    assert!(events.identical < events.pairs && events.first.is_some());
    let field = |name: &str| events.fields.iter().find(|f| f.field == name).unwrap();
    assert!(field("psi").largest.abs() < 10.0, "{:?}", field("psi"));
}

/// A turn about the symmetry axis changes nothing but the rounding, a little more friction the motion.
#[test]
fn val_rounding_makes_no_findings() {
    let differing = |name, change| {
        let short = ("stop.duration", "2.0");
        let [a, b] = [&[short][..], &[short, change]].map(|set| scenario(name, set));
        let report = compare(&a, &b, &Options::default()).unwrap();
        assert_eq!(report.verdict, Verdict::Different);
        let found = report.findings.iter().filter(|found| found.differs());
        found
            .map(|found| found.quantity.label().to_string())
            .collect::<Vec<_>>()
    };
    for name in ["drop", "nutation-free", "tippe-top"] {
        let turned = differing(name, ("initial.psi", "0.5"));
        assert!(turned.is_empty(), "{name}: {turned:?}");
    }
    let slowed = differing("drop", ("friction.k", "0.1000001"));
    for what in ["mean θ at", "first rolls", "energy lost"] {
        let is_found = slowed.iter().any(|found| found.starts_with(what));
        assert!(is_found, "{what}: {slowed:?}");
    }
}

/// Samples that are farther apart than a nutation don't show where θ first reaches a level; a run's own event does.
#[test]
fn val_unresolved_first_crossing_is_omitted() {
    let coarse = |key, value| scenario("full-coulomb", &[("sampling.period", "0.5"), (key, value)]);
    let (nods, b) = (
        coarse("initial.phi_dot", "20"),
        coarse("stop.theta_risen", "0.2"),
    );
    let report = compare(&nods, &b, &quick()).unwrap();
    assert!(finding(&report, "θ first reaches").is_none());
    let own = ["0.02", "0.1"].map(|period| {
        let scenario = scenario("paper-precession-term-only", &[("sampling.period", period)]);
        (Run::of(&scenario).end.time, scenario)
    });
    let report = compare(&own[0].1, &own[1].1, &quick()).unwrap();
    let times = own.map(|(time, _)| Some(time));
    assert_eq!(values(&report, "ends (risen"), times);
}

/// What a recording lacks is not zero in it.
#[test]
fn compares_only_what_both_runs_record() {
    let folder = Folder::new();
    let paper = scenario("paper", &[]);
    let whole = recorded(&folder, "whole.mcap", &paper, Encoding::Json);
    for topics in ["/top/state", "/top/state,/top/nutation", "/top/energy"] {
        let name = format!("{}.mcap", topics.len());
        let line = format!("run paper --topics {topics} -o {name} --quiet");
        folder.toprise(&line, 0);
        let part = Recording::open(&folder.at(&name)).unwrap();
        for (a, b) in [(&whole, &part), (&part, &whole)] {
            let report = compare(a, b, &quick()).unwrap();
            let differing: Vec<_> = report.findings.iter().filter(|f| f.differs()).collect();
            assert!(differing.is_empty(), "{topics}: {differing:?}");
            assert!(finding(&report, "loops").is_none(), "{topics}");
            // The end is recorded without any topic.
            assert!(finding(&report, "ends (risen").is_some(), "{topics}");
        }
    }
}

/// An event or a count is compared as far as both runs go.
#[test]
fn val_counts_cover_the_common_span() {
    let [long, short] = ["24.6", "24.4"].map(|end| scenario("paper", &[("stop.duration", end)]));
    let loops = |scenario: &Scenario, end: f64| {
        let times = Run::of(scenario).times_of(EventKind::LoopingBegins);
        times.iter().filter(|time| **time <= end).count() as f64
    };
    let expected = loops(&long, 24.4);
    assert!(expected > 0.0 && loops(&long, 24.6) > expected);
    for options in [quick(), Options::default()] {
        let report = compare(&long, &short, &options).unwrap();
        assert_eq!(values(&report, "loops by 24.4000 s"), [Some(expected); 2]);
    }
    // The other run ends before it could loop.
    let before = scenario("paper", &[("stop.duration", "20")]);
    let report = compare(&long, &before, &quick()).unwrap();
    assert!(finding(&report, "loops").is_none() && finding(&report, "first loop").is_none());
}

/// Times of one instant are one row, in runs of all kinds.
#[test]
fn simultaneous_events_share_a_row() {
    let slipping = [("friction.k", "0.1"), ("stop.duration", "1")];
    let more = [("friction.k", "0.11"), ("stop.duration", "1")];
    for (a, b) in [
        (scenario("paper", &[]), scenario("full-coulomb", &[])),
        (
            scenario("drop", &[]),
            scenario("drop", &[("friction.k", "0.11")]),
        ),
        (
            scenario("free-paper", &slipping),
            scenario("free-paper", &more),
        ),
        (
            scenario("spin-torque-only", &[]),
            scenario("spin-torque-only", &[("friction.k", "0.031")]),
        ),
    ] {
        let report = compare(&a, &b, &quick()).unwrap();
        let times = report.findings.iter().filter(|f| f.quantity.unit() == "s");
        let times: Vec<_> = times.map(|f| [f.a, f.b]).collect();
        assert!(!times.is_empty());
        for (at, time) in times.iter().enumerate() {
            assert!(!times[..at].contains(time), "{:?}", report.findings);
        }
    }
}

/// Ends at two levels are two conditions: the times don't have a difference.
#[test]
fn ends_of_two_kinds_have_no_difference() {
    let run = |level| scenario("spin-torque-only", &[("stop.theta_fallen", level)]);
    let report = compare(&run("1.5"), &run("1.2"), &quick()).unwrap();
    let end = finding(&report, "ends (fallen to 1.50 rad, fallen to 1.20 rad)").unwrap();
    assert!(end.a > end.b && end.differs());
    assert_eq!((end.difference, end.integration_error), (None, None));
    assert!(finding(&report, "falls").is_none());
}

/// Events that are missing without damage, e.g. in a filtered file, are noticed by their numbers.
#[test]
fn missing_events_are_not_counted() {
    let folder = Folder::new();
    let paper = scenario("paper", &[]);
    let path = folder.at("b.mcap");
    let (telemetry, form) = (Telemetry::default(), Form::default());
    let mut sink = McapSink::create(&path, Existing::Keep, &paper, &telemetry, form).unwrap();
    let (original, end) = in_memory(&paper);
    for message in original.messages {
        let is_event = message.channel == EVENTS.index();
        if !is_event || message.time_ns < 24_300_000_000 || message.time_ns > 24_500_000_000 {
            sink.write(&message.as_message()).unwrap();
        }
    }
    sink.finish(&end).unwrap();
    let b = Recording::open(&path).unwrap();
    let report = compare(&paper, &b, &quick()).unwrap();
    assert!(finding(&report, "loops").is_none());
}

/// The sum of both rotations is defined near the vertical, but not each of them.
#[test]
fn leaves_out_the_precession_near_the_vertical() {
    let sleeping = [("stop.duration", "36")];
    let run = |k| scenario("lifecycle", &[("friction.k", k), sleeping[0]]);
    let [a, b] = ["0.03", "0.0300001"].map(run);
    let report = compare(&a, &b, &quick()).unwrap();
    // It sleeps from about 28 s on.
    let late = Run::of(&a).cycles.iter().any(|cycle| cycle.start > 33.0);
    assert!(late);
    for name in ["phi_dot_mean", "psi_dot_mean"] {
        let deviations = &report.averaged.as_ref().unwrap().deviations;
        let found = deviations.iter().find(|d| d.quantity == name).unwrap();
        let cycles = Run::of(&a).cycles;
        let least = cycles
            .iter()
            .filter(|cycle| cycle.start <= found.at && found.at <= cycle.end)
            .map(|cycle| cycle.theta_min)
            .fold(f64::INFINITY, f64::min);
        assert!(least >= 0.01, "{name}: {least} at {}", found.at);
        assert!(found.largest.abs() < 1.0, "{found:?}");
    }
}

/// The error of a phase lead is that of both runs together.
#[test]
fn phase_lead_error_is_symmetric() {
    let [a, b] = ["full-coulomb", "viscous"].map(|name| scenario(name, &[("stop.duration", "3")]));
    let [there, back] = [(&a, &b), (&b, &a)].map(|(a, b)| {
        let report = compare(a, b, &Options::default()).unwrap();
        let lead = finding(&report, "nutation phase lead").unwrap().clone();
        (lead.difference.unwrap(), lead.integration_error.unwrap())
    });
    assert_eq!((there.0, there.1), (-back.0, back.1));
}

/// ± is the error of the integration: a level that the comparison chose, and the phase of the nutation, are told apart.
#[test]
fn val_dependence_on_the_level_is_that_of_the_curves() {
    let [a, b] = ["paper", "viscous"].map(|name| scenario(name, &[]));
    let report = compare(&a, &b, &quick()).unwrap();
    let crossing = finding(&report, "mean θ crosses").unwrap();
    let Quantity::MeanCrossing { level, .. } = crossing.quantity else {
        panic!("{crossing:?}");
    };
    let Some(Dependence::Level { relative, change }) = crossing.dependences.first() else {
        panic!("{crossing:?}");
    };
    let lower = level * (1.0 + relative);
    let times = [&a, &b].map(|scenario| {
        let cycles = Run::of(scenario).cycles;
        let pair = cycles
            .windows(2)
            .find(|pair| pair[1].theta_mean <= lower)
            .unwrap();
        let [from, to] = [&pair[0], &pair[1]].map(|cycle| 0.5 * (cycle.start + cycle.end));
        let part = (pair[0].theta_mean - lower) / (pair[0].theta_mean - pair[1].theta_mean);
        from + part * (to - from)
    });
    let expected = times[1] - times[0] - crossing.difference.unwrap();
    // A straight line between means 0.05 s apart, of slopes that change by 4 % there.
    assert_near("change", *change, expected, 2e-3);
    assert_near("relative", *relative, -0.02, 1e-12);
}

/// The headline tells what sets the motions apart, by the size of the findings.
#[test]
fn headline_is_a_sentence_on_the_motion() {
    let friction = [("friction.k", "0.0303")];
    let tolerance = [("integrator.relative_tolerance", "1e-10")];
    for (a, b, changes, expected) in [
        (
            "paper",
            "viscous",
            &[][..],
            "B rises 3.0 times slower than A and does not loop",
        ),
        (
            "viscous",
            "paper",
            &[],
            "B rises 3.0 times faster than A; unlike A, B loops",
        ),
        (
            "paper",
            "full-coulomb",
            &[],
            "The same but for the nutation: B's is 3.9 times weaker; B does not loop",
        ),
        ("paper", "paper", &friction, "B rises 0.98 % faster than A"),
        (
            "paper",
            "spin-torque-only",
            &[],
            "B does not rise to 0.0200 rad and does not loop",
        ),
        (
            "paper",
            "free-paper",
            &[],
            "B rises to a mean θ of 0.168 rad 3.0 times faster than A; unlike A, B rolls and hops",
        ),
        (
            "full-coulomb",
            "full-coulomb",
            &tolerance,
            "The same within the integration error",
        ),
    ] {
        let [a, b] = [scenario(a, &[]), scenario(b, changes)];
        let headline = compare(&a, &b, &Options::default()).unwrap().headline();
        let headline = headline.to_string();
        assert!(headline.starts_with(expected), "{headline}");
    }
}

/// Numbers of the CSV table are those of the JSON report, and text in a pipe has plain numbers.
#[test]
fn programs_read_findings_as_csv() {
    let print = |format: &str| {
        let mut command = Command::cargo_bin("toprise").unwrap();
        let line = "diff paper full-coulomb --set stop.duration=3 --no-floor --format";
        let command = command.args(line.split(' ')).arg(format);
        let output = command.assert().code(1).get_output().stdout.clone();
        String::from_utf8(output).unwrap()
    };
    let report: Value = serde_json::from_str(&print("json")).unwrap();
    let id = concat!("urn:toprise:", env!("CARGO_PKG_VERSION"), ":DiffReport");
    assert_eq!(report["$schema"], id);
    assert_eq!(report["a"]["scenario"]["friction"]["k"], 0.03);
    let csv = print("csv");
    let mut lines = csv.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("kind,what,unit,a,b,difference,")
    );
    let findings = report["findings"].as_array().unwrap();
    assert_eq!(lines.clone().count(), findings.len());
    for (line, finding) in lines.zip(findings) {
        let (before, after) = line.rsplit_once('"').unwrap();
        assert!(before.starts_with(finding["kind"].as_str().unwrap()));
        let cells: Vec<&str> = after.split(',').collect();
        for (cell, name) in [(2, "a"), (3, "b"), (4, "difference")] {
            assert_eq!(cells[cell].parse().ok(), finding[name].as_f64(), "{line}");
        }
    }
    let text = print("text");
    assert!(text.contains("e-") && !text.contains(['−', '⁻']), "{text}");
    for row in text.lines().filter(|line| line.contains("[s]")) {
        assert!(!row.contains(" ms") && !row.contains(" µs"), "{row}");
    }
}

/// Rows within the ripple of the nutation are equal, and below those that differ.
#[test]
fn equal_rows_stand_below_the_differences() {
    let mut command = Command::cargo_bin("toprise").unwrap();
    let command = command.args(["diff", "paper", "full-coulomb", "--no-floor"]);
    let page = command.args(["--color", "never"]).assert().code(1);
    let page = String::from_utf8(page.get_output().stdout.clone()).unwrap();
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text}: {page}"));
    assert!(place("first loop [s]") < place("equal within"));
    assert!(place("equal within") < place("ends (risen to 0.0200 rad)"));
}

/// φ̇ and ψ̇ of a top that starts near the vertical differ by 108 rad/s each, and ω·n by 0.3.
#[test]
fn val_compares_the_spin_along_the_axis_instead_of_its_parts() {
    let until = [("stop.duration", "1")];
    let [a, b] = ["tippe-top", "tippe-top-hangs"].map(|name| scenario(name, &until));
    let report = compare(&a, &b, &quick()).unwrap();
    let spin = finding(&report, "ω·n at").unwrap();
    let Quantity::AxialSpin { at } = spin.quantity else {
        panic!("{spin:?}");
    };
    let [x, y] = [&a, &b].map(Run::of);
    let axial = |sample: &Sample| {
        let rates = sample.tilt.rates;
        rates.phi * cos(sample.angles.theta) + rates.psi
    };
    let pairs = x.samples.iter().zip(&y.samples);
    let (time, expected) = pairs
        .map(|(x, y)| (x.time_ns, [axial(x), axial(y)]))
        .max_by(|(_, [a, b]), (_, [c, d])| (b - a).abs().total_cmp(&(d - c).abs()))
        .unwrap();
    assert_near("time", at, time as f64 / 1e9, 1e-12);
    for (found, expected) in [spin.a, spin.b].into_iter().zip(expected) {
        assert_near("ω·n", found.unwrap(), expected, 1e-11);
    }
    for parts in ["mean φ̇", "mean ψ̇"] {
        let found = finding(&report, parts).and_then(|found| found.difference);
        assert!(
            found.is_none_or(|difference| difference.abs() < 10.0),
            "{found:?}"
        );
    }
}

/// Distances that can be quoted are those of the samples.
#[test]
fn val_distances_are_those_of_the_axes() {
    let until = [("stop.duration", "12")];
    let [a, b] = ["paper", "viscous"].map(|name| scenario(name, &until));
    let report = compare(&a, &b, &quick()).unwrap();
    let [x, y] = [&a, &b].map(Run::of);
    let (mut axes, mut thetas, mut largest) = (0.0, 0.0, 0.0_f64);
    for (x, y) in x.samples.iter().zip(&y.samples) {
        let [x, y] = [x.angles, y.angles];
        // By the haversine formula, which is exact for small angles, too.
        let square = |angle: f64| sin(0.5 * angle) * sin(0.5 * angle);
        let half = square(y.theta - x.theta) + sin(x.theta) * sin(y.theta) * square(y.phi - x.phi);
        let angle = 2.0 * atan2(half.sqrt(), (1.0 - half).sqrt());
        axes += angle * angle;
        largest = largest.max(angle);
        thetas += (y.theta - x.theta) * (y.theta - x.theta);
    }
    let count = x.samples.len() as f64;
    let found = |what| finding(&report, what).unwrap().difference.unwrap();
    let axes = (axes / count).sqrt();
    assert_near("axes", found("RMS angle between the axes"), axes, 1e-12);
    let thetas = (thetas / count).sqrt();
    assert_near("θ", found("RMS angle at equal phase"), thetas, 1e-13);
    let Quantity::AxisDistance { largest: told, .. } =
        finding(&report, "RMS angle between").unwrap().quantity
    else {
        panic!();
    };
    assert_near("largest", told, largest, 1e-12);
}

/// A fixed peg presses with a constant force, a free one with forces that are told as a range.
#[test]
fn normal_forces_are_told_where_they_differ() {
    let until = [("stop.duration", "0.5")];
    let [paper, viscous, free] = ["paper", "viscous", "drop"].map(|name| scenario(name, &until));
    let sentence = |a, b| {
        let forces = compare(a, b, &quick()).unwrap().normal_forces;
        forces.unwrap().sentence().map(|found| found.to_string())
    };
    assert_eq!(sentence(&paper, &viscous), None);
    let found = sentence(&paper, &free).unwrap();
    assert!(
        found.starts_with("Normal force: a constant 1.08 N in A, 0"),
        "{found}"
    );
    let greatest = Run::of(&free)
        .samples
        .iter()
        .map(|sample| sample.contact.normal_force)
        .fold(0.0, f64::max);
    let forces = compare(&paper, &free, &quick())
        .unwrap()
        .normal_forces
        .unwrap();
    assert_near("greatest", forces.b.unwrap().greatest, greatest, 1e-12);
}

/// Tolerances apply to findings, too, and the fields that exceed them are named.
#[test]
fn tolerances_and_topics_limit_findings() {
    let [a, b] = ["0.03", "0.030001"].map(|k| short(&[("friction.k", k)]));
    let differing = |options: &Options| {
        let report = compare(&a, &b, options).unwrap();
        let found = report.differing().map(|found| found.quantity.unit());
        (found.collect::<Vec<_>>(), report)
    };
    let (all, report) = differing(&quick());
    assert!(all.contains(&"rad/s") && all.contains(&"J"), "{all:?}");
    assert!(!report.is_limited);
    let (none, report) = differing(&tolerating("*=1"));
    assert_eq!((none, report.verdict), (Vec::new(), Verdict::Equal));
    let (energy, report) = differing(&only("/top/energy"));
    assert_eq!(energy, ["J"]);
    let beyond = report.fields_beyond();
    assert!(beyond.iter().all(|(topic, _)| topic.topic == "/top/energy"));
    let headline = report.headline().to_string();
    let expected = format!(
        "Different: {} fields beyond the tolerances, most /top/",
        beyond.len()
    );
    assert!(headline.starts_with(&expected), "{headline}");
    let (without, _) = differing(&ignoring("/top/energy.total"));
    assert!(!without.contains(&"J"), "{without:?}");
    // B − A of a field has the values of both.
    let total = field(&report, "/top/energy", "total");
    let [x, y] = total.values.unwrap();
    assert_eq!(total.largest, y - x);
}

#[test]
fn page_names_the_fields_beyond_the_tolerances() {
    let mut command = Command::cargo_bin("toprise").unwrap();
    let line = "diff paper paper --set stop.duration=0.2 --set-b friction.k=0.031 --no-floor";
    let command = command.args(line.split(' ')).args(["--tol", "/top/*=1"]);
    let page = command.args(["--color", "never", "--rel", "1e-3"]).assert();
    let page = String::from_utf8(page.code(1).get_output().stdout.clone()).unwrap();
    assert_contains(&page, "beyond the tolerances");
    assert_contains(&page, "/events.");
}
