//! What several tests need.

use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;
use tempfile::TempDir;
use toprise::archive::input::Input;
use toprise::archive::memory::Owned;
use toprise::archive::pipeline::{Archived, McapSink};
use toprise::archive::publish::Existing;
use toprise::archive::recording::Recording;
use toprise::archive::sink::{Sink, SinkError, record_all};
use toprise::archive::verify::{Report, Verdict, verify};
use toprise::archive::writer::Form;
use toprise::physics::friction::{Branch, Dissipation, Friction, FrictionLaw};
use toprise::run::scenario::{Preset, Scenario};
use toprise::run::simulation::{
    Event, EventKind, ImpactRecord, NutationCycle, Record, RunEnd, Sample, Simulation,
};
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::{Message, RunMessages, Topics};

/// All messages, and their digest.
#[derive(Clone, Debug, Default)]
pub struct MemorySink {
    /// In order of arrival.
    pub messages: Vec<Owned>,
    /// Digest of all of them.
    pub digest: ContentDigest,
}

impl Sink for MemorySink {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.digest.update(message);
        self.messages.push(Owned::from(message));
        Ok(())
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        Ok(())
    }
}

/// A preset with some keys set otherwise.
pub fn scenario(preset: &str, overrides: &[(&str, &str)]) -> Scenario {
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for (key, value) in overrides {
        values.set(key, value).unwrap();
    }
    Scenario::new(values).unwrap()
}

/// A top that exchanges little energy in a fast precession, as changes of `rise-by-loss-of-spin`.
pub const FAST_PRECESSION: [(&str, &str); 8] = [
    ("formulation", "body"),
    ("top.mass", "1.6"),
    ("top.transverse_moment", "0.053"),
    ("top.axial_moment", "0.0076"),
    ("top.center_distance", "0.168"),
    ("top.peg_radius", "0.0032"),
    ("initial.psi_dot", "73"),
    ("initial.theta", "0.48"),
];

/// Everything that a run yields.
pub struct Run {
    pub samples: Vec<Sample>,
    pub events: Vec<Event>,
    pub cycles: Vec<NutationCycle>,
    pub impacts: Vec<ImpactRecord>,
    pub end: RunEnd,
}

impl Run {
    pub fn of(scenario: &Scenario) -> Self {
        let mut simulation = Simulation::new(scenario).unwrap();
        let (mut samples, mut events, mut cycles) = (Vec::new(), Vec::new(), Vec::new());
        let mut impacts = Vec::new();
        for record in simulation.by_ref() {
            match record.unwrap() {
                Record::Sample(sample) => samples.push(*sample),
                Record::Event(event) => events.push(*event),
                Record::Nutation(cycle) => cycles.push(*cycle),
                Record::Impact(landing) => impacts.push(*landing),
            }
        }
        Self {
            samples,
            events,
            cycles,
            impacts,
            end: simulation.end(),
        }
    }

    /// A run of a preset with some keys set otherwise.
    pub fn with(preset: &str, overrides: &[(&str, &str)]) -> Self {
        Self::of(&scenario(preset, overrides))
    }

    /// The sample at a time in seconds that is one of the sample times.
    pub fn at(&self, time: f64) -> &Sample {
        let time_ns = (time * 1e9).round() as u64;
        let found = self.samples.iter().find(|s| s.time_ns == time_ns);
        found.unwrap_or_else(|| panic!("no sample at {time} s"))
    }

    pub fn events_of(&self, kind: EventKind) -> impl Iterator<Item = &Event> {
        self.events.iter().filter(move |event| event.kind == kind)
    }

    pub fn times_of(&self, kind: EventKind) -> Vec<f64> {
        self.events_of(kind).map(|event| event.time).collect()
    }

    pub fn first(&self, kind: EventKind) -> &Event {
        self.events_of(kind)
            .next()
            .unwrap_or_else(|| panic!("no {kind:?}"))
    }
}

/// Asserts |actual − expected| ≤ tolerance.
#[track_caller]
pub fn assert_near(what: &str, actual: f64, expected: f64, tolerance: f64) {
    let error = (actual - expected).abs();
    assert!(
        error <= tolerance,
        "{what}: {actual:?} differs from {expected:?} by {error:e}, more than {tolerance:e}"
    );
}

/// Asserts that a text contains a part.
#[track_caller]
pub fn assert_contains(text: &str, part: &str) {
    assert!(text.contains(part), "{part:?} is not in\n{text}");
}

/// A temporary directory, in which the program runs.
pub struct Folder(TempDir);

/// Output of the program.
pub struct Printed {
    pub stdout: String,
    pub stderr: String,
}

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The path of a file.
    pub fn at(&self, name: impl AsRef<Path>) -> PathBuf {
        self.path().join(name)
    }

    pub fn read(&self, name: impl AsRef<Path>) -> Vec<u8> {
        fs::read(self.at(name)).unwrap()
    }

    pub fn text(&self, name: impl AsRef<Path>) -> String {
        fs::read_to_string(self.at(name)).unwrap()
    }

    /// Writes a file; returns its path.
    pub fn write(&self, name: impl AsRef<Path>, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.at(name);
        fs::write(&path, content).unwrap();
        path
    }

    /// The names of all files and folders in it, hidden ones too, in alphabetical order.
    pub fn files(&self) -> Vec<String> {
        files(self.path())
    }

    /// The program with these words as arguments.
    pub fn program(&self, line: &str) -> Command {
        let mut program = Command::new(env!("CARGO_BIN_EXE_toprise"));
        program
            .current_dir(self.path())
            .args(line.split_whitespace());
        program
    }

    /// Runs the program with these words as arguments. It must end with this code.
    #[track_caller]
    pub fn toprise(&self, line: &str, code: i32) -> Printed {
        printed(&mut self.program(line), line, code)
    }

    /// Runs the program where no file may have more blocks, of 1024 bytes.
    #[cfg(target_os = "linux")]
    pub fn limited(&self, blocks: u32, line: &str) -> Output {
        let program = env!("CARGO_BIN_EXE_toprise");
        let script = format!("ulimit -f {blocks}; trap '' XFSZ; exec {program} {line}");
        let mut bash = std::process::Command::new("bash");
        let bash = bash.current_dir(self.path()).args(["-c", &script]);
        bash.output().unwrap()
    }

    /// Runs the program, which must refuse this at once, with exit code 2 and an error that contains `part`.
    #[track_caller]
    pub fn refuses(&self, line: &str, part: &str) -> Printed {
        let mut program = self.program(line);
        let printed = printed(program.timeout(Duration::from_mins(1)), line, 2);
        let error = &printed.stderr;
        assert!(error.contains(part), "{line}: {part:?} is not in\n{error}");
        printed
    }
}

/// Runs the program, here described by `line`. It must end with this code.
#[track_caller]
pub fn printed(program: &mut Command, line: &str, code: i32) -> Printed {
    let output = program.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    let found = output.status.code();
    assert_eq!(found, Some(code), "{line}\n{stdout}\n{stderr}");
    Printed { stdout, stderr }
}

/// The names of all files and folders in a directory, hidden ones too, in alphabetical order.
pub fn files(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<_> = names.collect();
    names.sort();
    names
}

/// A run into memory, with all its messages.
pub fn in_memory(scenario: &Scenario) -> (MemorySink, RunEnd) {
    let mut sink = MemorySink::default();
    let mut run = RunMessages::new(scenario, &Topics::All).unwrap();
    let recorded = record_all(&mut run, &mut [&mut sink]).unwrap();
    assert!(recorded.error.is_none(), "{:?}", recorded.error);
    (sink, recorded.outcome.end)
}

/// Records a run with these topics, all if there are none.
pub fn archive(
    path: &Path,
    scenario: &Scenario,
    topics: &[&str],
    form: Form,
) -> Result<Archived, SinkError> {
    let topics = match topics {
        [] => Topics::All,
        topics => Topics::named(topics).unwrap(),
    };
    archive_topics(path, scenario, &topics, form)
}

fn archive_topics(
    path: &Path,
    scenario: &Scenario,
    topics: &Topics,
    form: Form,
) -> Result<Archived, SinkError> {
    let mut run = RunMessages::new(scenario, topics).unwrap();
    let mut sink = McapSink::create(path, Existing::Keep, scenario, run.telemetry(), form)?;
    let recorded = record_all(&mut run, &mut [&mut sink])?;
    sink.finish(&recorded.outcome.end)
}

/// The bytes of a recording.
pub fn recorded(scenario: &Scenario, topics: &[&str], form: Form) -> Vec<u8> {
    let folder = Folder::new();
    archive(&folder.at("run.mcap"), scenario, topics, form).unwrap();
    folder.read("run.mcap")
}

/// Repeats the run of a file in the file's form, as `toprise run FILE` does; gives the bytes of the new recording, none if
/// the file has no scenario.
pub fn run_again(file: &Path) -> Option<Vec<u8>> {
    let input = Input::open(file).ok()?;
    let scenario = Scenario::new(input.values().ok()?).unwrap();
    let (form, topics) = input.form().unwrap_or_default();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("again.mcap");
    archive_topics(&path, &scenario, &topics, form).unwrap();
    Some(fs::read(path).unwrap())
}

/// The result of verifying a file.
pub fn verified(file: &Path) -> Report {
    verify(&Recording::open(file).unwrap(), &|_| {}).unwrap()
}

/// Whether `verify` reports that something is wrong with a file, or missing.
pub fn is_noticed(file: &Path) -> bool {
    let Ok(recording) = Recording::open(file) else {
        return true;
    };
    !verify(&recording, &|_| {}).is_ok_and(|report| report.verdict == Verdict::Verified)
}

/// Friction with a sliding law and no losses.
pub fn sliding_friction(law: FrictionLaw, dissipation: Dissipation) -> Friction {
    Friction {
        law,
        dissipation,
        losses: None,
        branch: Branch::default(),
    }
}
