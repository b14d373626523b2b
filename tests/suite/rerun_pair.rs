//! Two runs in one Rerun recording, as far as it can be tested without a viewer.

use crate::support::{in_memory, scenario};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::external::re_log_types::LogMsg;
use rerun::log::Chunk;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs::File;
use std::path::Path;
use std::sync::LazyLock;
use tempfile::tempdir;
use toprise::archive::memory::Owned;
use toprise::archive::sink::Sink;
use toprise::physics::math::log10;
use toprise::rerun::{Destinations, Identity, PairIdentity, PairSink, Playback, RerunSink};
use toprise::run::scenario::Scenario;
use toprise::telemetry::side::Side;
use toprise::telemetry::{Message, Topic};

const DURATION: (&str, &str) = ("stop.duration", "0.3");

/// A run with all its messages.
struct Run {
    name: &'static str,
    scenario: Scenario,
    messages: Vec<Owned>,
}

impl Run {
    fn new(preset: &'static str) -> Self {
        Self::with(preset, DURATION)
    }

    fn with(preset: &'static str, change: (&str, &str)) -> Self {
        let scenario = scenario(preset, &[change]);
        let messages = in_memory(&scenario).0.messages;
        Self {
            name: preset,
            scenario,
            messages,
        }
    }

    fn identity(&self, topics: &[Topic]) -> Identity {
        let topics = topics.to_vec();
        Identity::new(self.name, &self.scenario, topics, Playback::FromStart)
    }

    /// The messages of these topics.
    fn messages(&self, topics: &[Topic]) -> impl Iterator<Item = &Owned> {
        let topics = topics.to_vec();
        let wanted = move |message: &&Owned| topics.contains(&message.as_message().topic());
        self.messages.iter().filter(wanted)
    }
}

static PAPER: LazyLock<Run> = LazyLock::new(|| Run::new("paper"));
static FULL: LazyLock<Run> = LazyLock::new(|| Run::new("full-coulomb"));

fn all_topics() -> Vec<Topic> {
    Topic::all_with(toprise::physics::dynamics::Support::FixedPeg).collect()
}

/// The differences of the messages that both runs have.
fn differences(a: &[&Owned], b: &[&Owned]) -> Vec<Owned> {
    let key = |message: &Owned| (message.channel, message.sequence);
    let of_b: HashMap<_, _> = b.iter().map(|message| (key(message), message)).collect();
    let difference = |a: &&Owned| {
        let b = of_b.get(&key(a))?;
        let numbers = a.numbers.iter().zip(&b.numbers).map(|(a, b)| b - a);
        Some(Owned {
            numbers: numbers.collect(),
            texts: Vec::new(),
            ..(*a).clone()
        })
    };
    a.iter().filter_map(difference).collect()
}

/// Writes both runs with these topics.
fn write(path: &Path, (a, topics_a): (&Run, &[Topic]), (b, topics_b): (&Run, &[Topic])) {
    let identity = PairIdentity {
        recording_id: "pair".to_owned(),
        name: "a pair".to_owned(),
        a: a.identity(topics_a),
        b: b.identity(topics_b),
    };
    let destinations = Destinations {
        file: Some(File::create(path).unwrap()),
        live: None,
    };
    let mut sink = PairSink::new(&identity, destinations);
    let of_a: Vec<_> = a.messages(topics_a).collect();
    let of_b: Vec<_> = b.messages(topics_b).collect();
    for message in &of_a {
        sink.write(Side::A, &message.as_message());
    }
    for message in &of_b {
        sink.write(Side::B, &message.as_message());
    }
    for message in differences(&of_a, &of_b) {
        let message = Message {
            texts: &[],
            ..message.as_message()
        };
        sink.difference(&message);
    }
    sink.summarize("They differ.");
    assert!(!sink.is_live());
    assert!(sink.finish().unwrap().is_empty());
}

/// What there is in a file.
#[derive(Default)]
struct Content {
    data: Vec<Chunk>,
    blueprint: Vec<Chunk>,
}

impl Content {
    fn read(path: &Path) -> Self {
        let mut content = Self::default();
        let file = std::io::BufReader::new(File::open(path).unwrap());
        for message in DecoderApp::decode_eager(file).unwrap() {
            if let LogMsg::ArrowMsg(store, message) = message.unwrap() {
                let chunk = Chunk::from_arrow_msg(&message).unwrap();
                let chunks = if store.is_recording() {
                    &mut content.data
                } else {
                    &mut content.blueprint
                };
                chunks.push(chunk);
            }
        }
        content
    }

    /// The entities with the number of their rows, static ones not counted.
    fn rows(&self) -> BTreeMap<String, usize> {
        let mut rows = BTreeMap::new();
        for chunk in &self.data {
            let count = if chunk.is_static() {
                0
            } else {
                chunk.num_rows()
            };
            *rows.entry(chunk.entity_path().to_string()).or_default() += count;
        }
        rows
    }

    /// The numbers of an entity, in order.
    fn numbers(&self, entity: &str) -> Vec<Vec<f64>> {
        let chunks = self.data.iter();
        let chunks = chunks.filter(|chunk| chunk.entity_path().to_string() == entity);
        chunks
            .flat_map(|chunk| chunk.iter_slices::<f64>("Scalars:scalars".into()))
            .map(<[f64]>::to_vec)
            .collect()
    }

    /// What a text document says at last.
    fn text(&self, entity: &str) -> String {
        let chunks = self.data.iter();
        let chunks = chunks.filter(|chunk| chunk.entity_path().to_string() == entity);
        let texts = chunks.flat_map(|chunk| texts(chunk, "TextDocument:text"));
        texts.last().unwrap()
    }

    /// The entities that the views show, by the names of the views' parts of the blueprint.
    fn shown(&self) -> Vec<String> {
        let mut origins = HashMap::new();
        for chunk in &self.blueprint {
            let path = chunk.entity_path().to_string();
            for origin in texts(chunk, "ViewBlueprint:space_origin") {
                origins.insert(path.clone(), origin);
            }
        }
        let mut shown = Vec::new();
        for chunk in &self.blueprint {
            let path = chunk.entity_path().to_string();
            for query in texts(chunk, "ViewContents:query") {
                let origin = &origins[path.trim_end_matches("/ViewContents")];
                shown.extend(query.lines().map(|line| {
                    let entity = line.trim_start_matches("+ ").replace("$origin", origin);
                    format!("/{}", entity.trim_start_matches('/'))
                }));
            }
        }
        shown
    }
}

/// The names of all parts of the layout, in its final form.
fn names(content: &Content) -> Vec<String> {
    let mut names: BTreeMap<String, String> = BTreeMap::new();
    for chunk in &content.blueprint {
        let path = chunk.entity_path().to_string();
        let mut cleared = chunk.iter_slices::<bool>("Clear:is_recursive".into());
        if cleared.next().is_some() {
            names.remove(&path);
        }
        for name in texts(chunk, "ViewBlueprint:display_name") {
            names.insert(path.clone(), name);
        }
    }
    names.into_values().collect()
}

fn texts(chunk: &Chunk, component: &'static str) -> Vec<String> {
    chunk
        .iter_slices::<String>(component.into())
        .flatten()
        .map(|text| text.to_string())
        .collect()
}

/// Asserts that each view has something to show.
fn assert_no_view_is_empty(content: &Content) {
    let rows = content.rows();
    let shown = content.shown();
    assert!(!shown.is_empty());
    for entity in shown {
        let full = match entity.strip_suffix("/**") {
            Some(parent) => rows.keys().any(|entity| entity.starts_with(parent)),
            None if ["/summary", "/about", "/legend"]
                .iter()
                .any(|end| entity.ends_with(end)) =>
            {
                !content.text(&entity).is_empty()
            }
            None => rows.get(&entity).is_some_and(|rows| *rows > 0),
        };
        assert!(full, "nothing in {entity}");
    }
}

/// A viewer's time axes reach to the end of the longer run.
#[test]
fn differences_extend_to_the_longer_run() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let topics = all_topics();
    let longer = Run::with("full-coulomb", ("stop.duration", "0.5"));
    write(&path, (&PAPER, &topics), (&longer, &topics));
    let content = Content::read(&path);
    let [a, b, difference] =
        ["a", "b", "diff"].map(|run| content.numbers(&format!("/{run}/top/state/theta")));
    assert!(a.len() < b.len());
    assert_eq!(difference.len(), a.len() + 1);
    assert!(difference.last().unwrap()[0].is_nan());
}

#[test]
fn pair_contains_runs_and_differences() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let topics = all_topics();
    write(&path, (&PAPER, &topics), (&FULL, &topics));
    let content = Content::read(&path);
    assert_no_view_is_empty(&content);
    let rows = content.rows();
    for entity in [
        "/top/state/theta",
        "/top/state/phi_dot",
        "/top/contact/slip_speed",
    ] {
        let count = rows[&format!("/a{entity}")];
        assert!(count > 0, "{entity}");
        assert_eq!(rows[&format!("/b{entity}")], count, "{entity}");
        assert_eq!(rows[&format!("/diff{entity}")], count, "{entity}");
    }
    // No view shows them.
    assert!(!rows.contains_key("/a/top/pose/omega_world"));
    for entity in [
        "/a/events",
        "/b/events",
        "/a/scene/top",
        "/b/scene/top",
        "/a/scene/trail/above",
        "/b/scene/friction_force",
        "/diff/top/nutation/theta_mean",
        "/diff_log10/top/nutation/theta_mean",
    ] {
        assert!(rows[entity] > 0, "{entity}");
    }
    assert!(rows.contains_key("/scene/table"));
    assert!(content.text("/summary").ends_with("They differ."));

    let [a, b, difference, logarithm] = ["a", "b", "diff", "diff_log10"]
        .map(|run| content.numbers(&format!("/{run}/top/state/theta")));
    let expected: Vec<_> = a.iter().zip(&b).map(|(a, b)| b[0] - a[0]).collect();
    assert_eq!(difference.concat(), expected);
    // Zero has no logarithm.
    let sizes = expected.iter().map(|number| number.abs());
    let expected = sizes.filter(|size| *size > 0.0).map(log10);
    assert_eq!(logarithm.concat(), expected.collect::<Vec<_>>());
    assert!(logarithm.len() < difference.len());
    assert_eq!(difference[0], [0.0]);
    assert!(difference.last().unwrap()[0] != 0.0);
}

/// Asserts that what decides how curves look is not left to the defaults of viewers, which change.
fn assert_curves_are_defined(content: &Content) {
    let mut settled = BTreeMap::new();
    for chunk in &content.data {
        let entity = chunk.entity_path().to_string();
        let has = |component: &'static str| chunk.components().contains_component(component.into());
        let (is_settled, has_numbers) = settled.entry(entity).or_insert((false, false));
        let is_line =
            has("SeriesLines:aggregation_policy") && has("SeriesLines:interpolation_mode");
        *is_settled |= chunk.is_static() && (is_line || has("SeriesPoints:markers"));
        *has_numbers |= has("Scalars:scalars");
    }
    let curves = settled.iter().filter(|(_, (_, has_numbers))| *has_numbers);
    assert!(curves.clone().count() > 20);
    for (entity, (is_settled, _)) in curves {
        assert!(is_settled, "{entity}");
    }
    let of_charts = |component: &'static str| {
        let chunks = content.blueprint.iter();
        chunks
            .filter(|chunk| chunk.components().contains_component(component.into()))
            .count()
    };
    let classes = content.blueprint.iter();
    let classes = classes.flat_map(|chunk| texts(chunk, "ViewBlueprint:class_identifier"));
    let charts = classes.filter(|class| class == "TimeSeries").count();
    assert!(charts > 10, "{charts}");
    for component in ["TimeAxis:link", "PlotLegend:visible"] {
        assert_eq!(of_charts(component), charts, "{component}");
    }
    // The trails of the tops have ranges of their own.
    assert!(of_charts("VisibleTimeRanges:ranges") > charts);
}

#[test]
fn layout_sets_every_property_of_curves() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("layout.rrd");
    let topics = all_topics();
    write(&path, (&PAPER, &topics), (&FULL, &topics));
    assert_curves_are_defined(&Content::read(&path));
    let file = Some(File::create(&path).unwrap());
    let destinations = Destinations { file, live: None };
    let mut sink = RerunSink::new(&PAPER.identity(&topics), destinations);
    for message in PAPER.messages(&topics) {
        sink.write(&message.as_message()).unwrap();
    }
    sink.finish().unwrap();
    assert_curves_are_defined(&Content::read(&path));
}

#[test]
fn views_travel_with_both_tops() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let topics: Vec<_> = Topic::all().collect();
    let [a, b] = ["free-paper", "free-viscous"].map(Run::new);
    write(&path, (&a, &topics), (&b, &topics));
    let content = Content::read(&path);
    let origins: BTreeSet<_> = content
        .blueprint
        .iter()
        .flat_map(|chunk| texts(chunk, "ViewBlueprint:space_origin"))
        .collect();
    let rows = content.rows();
    for origin in ["/a/scene/focus", "/b/scene/focus"] {
        assert!(origins.contains(origin));
        assert!(rows[origin] > 1, "{origin} moves");
    }
    let targets = content
        .blueprint
        .iter()
        .flat_map(|chunk| texts(chunk, "EyeControls3D:tracking_entity"));
    // A viewer doesn't know the place of a tracked entity when it opens a recording.
    assert_eq!(targets.count(), 0);
}

#[test]
fn shorter_run_is_marked_as_ended() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let topics = all_topics();
    let shorter = Run::with("full-coulomb", ("stop.duration", "0.2"));
    write(&path, (&PAPER, &topics), (&shorter, &topics));
    let content = Content::read(&path);
    for (run, ends_first) in [("a", false), ("b", true)] {
        let force = format!("/{run}/scene/friction_force");
        let mut last = [f32::NAN; 3];
        let mut end = Vec::new();
        for chunk in &content.data {
            let entity = chunk.entity_path().to_string();
            if entity == force {
                for vector in chunk
                    .iter_slices::<[f32; 3]>("Arrows3D:vectors".into())
                    .flatten()
                {
                    last = *vector;
                }
            }
            if entity == format!("/{run}/scene/focus/end") {
                end.extend(texts(chunk, "Points3D:labels"));
            }
        }
        assert_eq!(last == [0.0; 3], ends_first, "{run}: {last:?}");
        let expected: &[&str] = if ends_first {
            &["B ended at 0.2000 s"]
        } else {
            &[]
        };
        assert_eq!(end, expected);
    }
}

#[test]
fn missing_topics_leave_no_empty_views() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let all = all_topics();
    for topic in &all {
        let one = [*topic];
        for (a, b) in [
            (&all[..], &one[..]),
            (&one, &all),
            (&one, &one),
            (&one, &[]),
        ] {
            write(&path, (&PAPER, a), (&FULL, b));
            assert_no_view_is_empty(&Content::read(&path));
        }
    }
}

/// Views of events are narrow, and have no column for the run.
#[test]
fn events_begin_with_the_letter_of_their_run() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let topics = all_topics();
    write(&path, (&PAPER, &topics), (&FULL, &topics));
    let content = Content::read(&path);
    for (entity, start) in [
        ("/a/events", "A The top starts"),
        ("/b/events", "B The top starts"),
    ] {
        let chunks = content.data.iter();
        let mut lines = chunks
            .filter(|chunk| chunk.entity_path().to_string() == entity)
            .flat_map(|chunk| texts(chunk, "TextLog:text"));
        assert!(lines.any(|line| line.starts_with(start)), "{entity}");
    }
}

/// Zero has no logarithm.
#[test]
fn equal_runs_have_no_charts_of_logarithms() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let topics = all_topics();
    let longer = Run::with("paper", ("stop.duration", "0.5"));
    for (b, is_equal) in [(&longer, true), (&FULL, false)] {
        write(&path, (&PAPER, &topics), (b, &topics));
        let names = names(&Content::read(&path));
        let has = |name: &str| names.iter().any(|other| other == name);
        assert_eq!(has("θ: no difference"), is_equal, "{names:?}");
        assert_ne!(has("θ: B − A (rad)"), is_equal);
        assert_ne!(has("θ: log₁₀ |B − A|"), is_equal);
        assert!(has("θ (rad)"));
    }
}

#[test]
fn merges_repeated_events() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("run.rrd");
    let scenario = scenario("free-paper", &[("stop.duration", "1.4")]);
    let identity = Identity::new(
        "run",
        &scenario,
        Topic::all().collect(),
        Playback::FromStart,
    );
    let destinations = Destinations {
        file: Some(File::create(&path).unwrap()),
        live: None,
    };
    let mut sink = RerunSink::new(&identity, destinations);
    for message in &in_memory(&scenario).0.messages {
        sink.write(&message.as_message()).unwrap();
    }
    sink.finish().unwrap();
    let content = Content::read(&path);
    let lines = |entity: &str| {
        let chunks = content.data.iter();
        let chunks = chunks.filter(|chunk| chunk.entity_path().to_string() == entity);
        let lines = chunks.flat_map(|chunk| texts(chunk, "TextLog:text"));
        lines
            .map(|line| line.replace('\n', " "))
            .collect::<Vec<_>>()
    };
    let each = lines("/events/each");
    let loops = each.iter().filter(|line| line.contains("turns backward"));
    let expected = format!("{} more loops", loops.count() - 1);
    let summary = lines("/events");
    assert!(
        summary.iter().any(|line| line.starts_with(&expected)),
        "{summary:?}"
    );
    assert_eq!(summary.len(), 4, "{summary:?}");
    // The blueprint says at the end how fast to play it.
    let speeds = content.blueprint.iter().flat_map(|chunk| {
        chunk
            .iter_slices::<f64>("TimePanelBlueprint:playback_speed".into())
            .map(<[f64]>::to_vec)
            .collect::<Vec<_>>()
    });
    assert_eq!(speeds.collect::<Vec<_>>(), [[1.0], [0.05]]);
}

#[test]
fn legends_name_runs_by_letters() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("pair.rrd");
    let topics = all_topics();
    for b in [&PAPER, &FULL] {
        write(&path, (&PAPER, &topics), (b, &topics));
        let content = Content::read(&path);
        for (run, name) in [("a", "A θ"), ("b", "B θ")] {
            let entity = format!("/{run}/top/state/theta");
            let chunks = content.data.iter();
            let mut chunks = chunks.filter(|chunk| chunk.entity_path().to_string() == entity);
            assert!(chunks.any(|chunk| texts(chunk, "SeriesLines:names") == [name]));
        }
    }
}
