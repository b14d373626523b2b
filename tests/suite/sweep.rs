//! Sweeps: the table is a function of the spec, however it is computed.

use crate::support::{Folder, assert_contains, files, scenario};
use arrow_array::cast::AsArray as _;
use arrow_array::types::{Float64Type, Int32Type, Int64Type};
use arrow_array::{
    Array as _, ArrayRef, DictionaryArray, Float32Array, Float64Array, LargeStringArray,
    RecordBatch, StringArray, StringViewArray,
};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{BrotliLevel, Compression, GzipLevel, ZstdLevel};
use parquet::column::writer::ColumnCloseResult;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use sha2::{Digest as _, Sha256};
use std::collections::HashMap;
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use toprise::run::outcome;
use toprise::run::outcome::Cell;
use toprise::run::scenario::{Scenario, Value};
use toprise::sweep::{
    Axis, Base, Columns, Design, Finished, Method, Options, RowError, RunResult, Sample, Shard,
    Spec, Sweep, SweepError, Table, Watch, parts_directory, remaining_rows, run,
    threads as threads_for, values_of_row,
};

/// Runs that end at once, over a grid of 2,400: three parts.
fn spec(varied: &[(&str, &str)]) -> Spec {
    let mut set = vec![("stop.duration", "0.002"), ("sampling.period", "0.001")];
    set.retain(|(key, _)| varied.iter().all(|(axis, _)| axis != key));
    grid(vec![base("paper", &set)], varied)
}

fn grid(bases: Vec<Base>, varied: &[(&str, &str)]) -> Spec {
    Spec::new(bases, Design::Grid(axes(varied)), None).unwrap()
}

const AXES: &[(&str, &str)] = &[
    ("friction.k", "0.005..0.1/40log"),
    ("initial.psi_dot", "60..200/60"),
];

fn everything<T>(task: impl FnOnce(&Watch<'_>) -> T) -> T {
    task(&Watch {
        carry_on: &|| true,
        row_done: &|_| {},
    })
}

fn compute(sweep: &Sweep, table: &Path, options: &Options) -> Result<Finished, SweepError> {
    everything(|watch| run(sweep, table, options, watch))
}

/// Computes the whole table.
fn complete(sweep: &Sweep, table: &Path) -> Result<Finished, SweepError> {
    compute(sweep, table, &Options::default())
}

/// Computes a share of the table.
fn shard(index: u64, count: u64) -> Options {
    Options {
        shard: Some(Shard { index, count }),
        ..Options::default()
    }
}

fn base(preset: &str, set: &[(&str, &str)]) -> Base {
    let set = set.iter().map(|(k, v)| ((*k).into(), (*v).into()));
    Base::open(preset, Path::new(""), &set.collect::<Vec<_>>()).unwrap()
}

fn axes(axes: &[(&str, &str)]) -> Vec<Axis> {
    let axes = axes.iter();
    axes.map(|(key, text)| Axis::parse(key, text).unwrap())
        .collect()
}

fn digest(path: &Path) -> String {
    format!("{:x}", Sha256::digest(fs::read(path).unwrap()))
}

fn read(path: &Path) -> RecordBatch {
    let builder = ParquetRecordBatchReaderBuilder::try_new(File::open(path).unwrap()).unwrap();
    let mut reader = builder.with_batch_size(1_000_000).build().unwrap();
    let batch = reader.next().unwrap().unwrap();
    assert!(reader.next().is_none());
    batch
}

fn column<'a>(table: &'a RecordBatch, name: &str) -> &'a ArrayRef {
    table.column_by_name(name).unwrap()
}

fn numbers<'a>(table: &'a RecordBatch, name: &str) -> &'a Float64Array {
    column(table, name).as_primitive::<Float64Type>()
}

fn texts<'a>(table: &'a RecordBatch, name: &str) -> &'a StringArray {
    column(table, name).as_string()
}

fn errors(table: &RecordBatch) -> Vec<(usize, String)> {
    let column = texts(table, "error");
    let rows = (0..column.len()).filter(|row| column.is_valid(*row));
    rows.map(|row| (row, column.value(row).to_owned()))
        .collect()
}

#[test]
fn table_bytes_do_not_depend_on_threads_or_shards() {
    let folder = Folder::new();
    let sweep = Sweep::new(spec(AXES));
    assert_eq!(sweep.parts(), 3);
    let with = |name: &str, options: &[Options]| {
        let table = folder.at(name);
        for options in options {
            compute(&sweep, &table, options).unwrap();
        }
        assert!(!parts_directory(&table).exists());
        digest(&table)
    };
    let threads = |threads| Options {
        threads,
        ..Options::default()
    };
    let one = with("one.parquet", &[threads(1)]);
    assert_eq!(with("two.parquet", &[threads(2)]), one);
    let shards = [shard(1, 2), shard(0, 2), threads(1)];
    assert_eq!(with("shards.parquet", &shards), one);
    // One share of three is left to the sweep that merges.
    let shards = [shard(2, 3), shard(0, 3), threads(2)];
    assert_eq!(with("missing.parquet", &shards), one);
}

#[test]
fn resumes_after_interruption() {
    let folder = Folder::new();
    let sweep = Sweep::new(spec(AXES));
    let whole = folder.at("whole.parquet");
    complete(&sweep, &whole).unwrap();
    let table = folder.at("broken.parquet");
    for most in [500, 700, 1000] {
        let done = AtomicU64::new(0);
        let watch = Watch {
            carry_on: &|| done.load(Ordering::Relaxed) < most,
            row_done: &|_| {
                done.fetch_add(1, Ordering::Relaxed);
            },
        };
        let finished = run(&sweep, &table, &Options::default(), &watch).unwrap();
        assert!(finished.is_interrupted && !finished.is_merged && !table.exists());
    }
    let parts = fs::read_dir(parts_directory(&table)).unwrap().count();
    assert!((2..=3).contains(&parts), "{parts} files are there");
    let finished = complete(&sweep, &table).unwrap();
    assert!(finished.computed < 2400, "{finished:?}");
    assert_eq!(finished.counts.stops["duration"], 2400);
    assert_eq!(digest(&table), digest(&whole));
    // It is complete, and nothing is left to do.
    let again = complete(&sweep, &table).unwrap();
    assert_eq!((again.computed, again.counts), (0, finished.counts));
}

#[test]
fn table_bytes_do_not_depend_on_part_size() {
    let folder = Folder::new();
    let default = folder.at("default.parquet");
    complete(&Sweep::new(spec(AXES)), &default).unwrap();
    for size in [20, 500] {
        let sweep = Sweep::new(spec(AXES)).with_part_rows(size);
        assert_eq!(sweep.parts(), 2400_u64.div_ceil(size));
        let table = folder.at(format!("{size}.parquet"));
        compute(&sweep, &table, &shard(1, 3)).unwrap();
        complete(&sweep, &table).unwrap();
        assert_eq!(digest(&table), digest(&default), "{size}");
    }
}

#[test]
fn interruption_keeps_finished_parts() {
    let folder = Folder::new();
    let sweep = Sweep::new(spec(AXES)).with_part_rows(10);
    let table = folder.at("a.parquet");
    let done = AtomicU64::new(0);
    let watch = Watch {
        carry_on: &|| done.load(Ordering::Relaxed) < 500,
        row_done: &|_| {
            done.fetch_add(1, Ordering::Relaxed);
        },
    };
    let options = Options {
        threads: 1,
        ..Options::default()
    };
    let finished = run(&sweep, &table, &options, &watch).unwrap();
    // All but the part that was being computed.
    assert_eq!((finished.is_interrupted, finished.computed), (true, 500));
    assert_eq!(remaining_rows(&sweep, &table, None).unwrap(), 1900);
}

#[test]
fn part_size_follows_from_the_work_of_a_row() {
    for (duration, max_steps, rows) in [
        // 170 rad/s take about 510 steps per second.
        ("1", None, 1000),
        ("60", None, 40),
        ("6000", None, 1),
        ("6000", Some(5000), 250),
    ] {
        let set = [("stop.duration", duration)];
        let design = Design::Grid(axes(&[("friction.k", "0.01..0.1/5000")]));
        let spec = Spec::new(vec![base("paper", &set)], design, max_steps).unwrap();
        assert_eq!(Sweep::new(spec).part_rows(), rows, "{duration} s");
    }
    // The longest of all rows counts.
    let durations = [("stop.duration", "1..6000/64")];
    assert_eq!(Sweep::new(spec(&durations)).part_rows(), 1);
}

#[test]
fn row_is_the_outcome_of_its_scenario() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let bases = ["full-coulomb", "viscous", "free-paper"];
    let bases = bases.map(|name| base(name, &[("stop.duration", "0.5")]));
    let varied = [
        ("friction.k", "0.03..0.3/3log"),
        ("initial.psi_dot", "170,50"),
    ];
    let spec = grid(bases.to_vec(), &varied);
    complete(&Sweep::new(spec), &table).unwrap();
    let table = read(&table);
    assert_eq!(table.num_rows(), 18);
    let (names, digests) = (texts(&table, "scenario"), texts(&table, "scenario_digest"));
    let runs = column(&table, "run").as_primitive::<Int64Type>();
    for row in 0..table.num_rows() {
        assert_eq!(runs.value(row), row as i64);
        let set = |name| format!("{:?}", numbers(&table, name).value(row));
        let changes = [
            ("friction.k", &*set("friction_k")),
            ("initial.psi_dot", &set("initial_psi_dot")),
            ("stop.duration", "0.5"),
        ];
        let scenario = scenario(names.value(row), &changes);
        assert_eq!(digests.value(row), scenario.digest());
        let outcome = outcome(&scenario, || true).unwrap();
        for name in [
            "theta",
            "friction_work",
            "rise_time",
            "weak_time",
            "roll_time",
            "turns",
        ] {
            let column = numbers(&table, name);
            let found = column.is_valid(row).then(|| column.value(row).to_bits());
            let expected = match outcome.get(name) {
                Some(Cell::Number(number)) => Some(number.to_bits()),
                _ => None,
            };
            assert_eq!(found, expected, "row {row}: {name}");
        }
    }
    assert_eq!(errors(&table), []);
    let schema = table.schema();
    let field = schema.field_with_name("initial_psi_dot").unwrap();
    assert_eq!(field.metadata()["unit"], "rad/s");
}

/// Panics for one scenario and fails for none.
fn panicking(scenario: &Scenario, carry_on: &mut dyn FnMut() -> bool) -> RunResult {
    assert!(scenario.rates.psi != 110.0, "a test wants this");
    outcome(scenario, carry_on)
}

/// `--set` takes the numbers that `--over` takes, and leaves texts as they are.
#[test]
fn accepts_numbers_without_leading_digit() {
    let set = [
        ("initial.theta", ".5"),
        ("friction.k", "1."),
        ("description", ".5"),
    ];
    let base = base("paper", &set);
    let found = |key| base.values.get(key).cloned();
    assert_eq!(found("initial.theta"), Some(Value::Number(0.5)));
    assert_eq!(found("friction.k"), Some(Value::Number(1.0)));
    assert_eq!(found("description"), Some(Value::Text(".5".to_owned())));
    for text in ["fast", "inf", "nan", "1.5.", "--1"] {
        let set = [("initial.psi_dot".to_owned(), text.to_owned())];
        assert!(Base::open("paper", Path::new(""), &set).is_err(), "{text}");
    }
}

/// A table leaves a key to the base where a cell is empty.
#[test]
fn rejects_keys_both_set_and_varied() {
    let folder = Folder::new();
    let path = folder.at("design.csv");
    let base = base("paper", &[("friction.k", "0.2")]);
    let [with_gap, full] = ["0.1,0.5\n,0.4\n", "0.1,0.5\n0.2,0.4\n"].map(|rows| {
        fs::write(&path, format!("friction.k,initial.theta\n{rows}")).unwrap();
        let table = Design::Table(Table::read(&path).unwrap());
        Spec::new(vec![base.clone()], table, None)
    });
    assert!(with_gap.is_ok());
    let error = full.unwrap_err().to_string();
    assert_contains(&error, "friction.k is both set and varied");
}

#[test]
fn failed_rows_have_an_error() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    // θ = 0 can't be in Euler angles, beyond π is no inclination, and 10 s are over the budget.
    let axes = [
        ("stop.duration", "0.002,10"),
        ("initial.theta", "0,0.5,4"),
        ("initial.psi_dot", "100..150/6"),
    ];
    let mut spec = spec(&axes);
    spec.max_steps = Some(500);
    let sweep = Sweep::new(spec).with_run(panicking);
    let finished = complete(&sweep, &table).unwrap();
    let table = read(&table);
    assert_eq!(table.num_rows(), 36);
    let failed = errors(&table);
    let rows_with = |part: &str| {
        let rows = failed.iter().filter(|(_, error)| error.contains(part));
        rows.map(|(row, _)| *row).collect::<Vec<_>>()
    };
    let invalid = rows_with("initial.theta");
    let expected: Vec<usize> = [0..6, 12..18, 18..24, 30..36]
        .into_iter()
        .flatten()
        .collect();
    assert_eq!(invalid, expected);
    assert_eq!(rows_with("panic: a test wants this"), [7, 25]);
    assert_eq!(
        rows_with("not finished within 500 steps"),
        [24, 26, 27, 28, 29]
    );
    assert_eq!(failed.len(), 31);
    assert_eq!(finished.counts.errors, 31);
    assert_eq!(finished.counts.first_error.unwrap().run, 0);
    // No outcome, and no scenario where it is invalid.
    let theta = numbers(&table, "theta");
    let digests = column(&table, "scenario_digest");
    for (row, error) in &failed {
        assert!(theta.is_null(*row), "row {row}: {error}");
        assert_eq!(digests.is_null(*row), invalid.contains(row), "row {row}");
    }
    assert_eq!(theta.null_count(), 31);
}

#[test]
fn fail_fast_stops_at_first_error() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let sweep = Sweep::new(spec(&[("initial.theta", "0.4,0.5,4,5")]));
    let options = Options {
        fail_fast: true,
        ..Options::default()
    };
    let error = compute(&sweep, &table, &options).unwrap_err().to_string();
    assert!(error.starts_with("run 2: initial.theta = 4"), "{error}");
    assert!(!table.exists());
}

/// What is there is ended at too: the first row in order.
#[test]
fn regress_fail_fast_sees_errors_of_existing_parts() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    // The third of four parts has the first inclinations from which tops have fallen, the fourth has no others.
    let sweep = Sweep::new(spec(&[("initial.theta", "0.2..2.2/4000")]));
    let shard = |index| Some(Shard { index, count: 4 });
    let go = |shard, fail_fast| {
        let options = Options {
            shard,
            fail_fast,
            ..Options::default()
        };
        compute(&sweep, &table, &options)
    };
    assert_eq!(failed_row(go(shard(3), false)), None);
    assert_eq!(failed_row(go(shard(3), true)), Some(3000));
    assert_eq!(failed_row(go(shard(0), true)), None);
    // The part that is missing comes before the one that is there.
    let first = sweep.rows_of(2).find(|row| sweep.scenario(*row).is_err());
    assert!(first.is_some_and(|row| row > 2000), "{first:?}");
    assert_eq!(failed_row(go(None, true)), first);
    assert_eq!(failed_row(go(shard(2), false)), None);
    assert_eq!(failed_row(go(None, true)), first);
    assert!(!table.exists());
    assert_eq!(failed_row(go(None, false)), None);
    assert!(table.exists());
    assert_eq!(failed_row(go(None, true)), first);
}

/// The row whose error ended a sweep.
fn failed_row(result: Result<Finished, SweepError>) -> Option<u64> {
    match result {
        Err(SweepError::Row(row)) => Some(row.run),
        Ok(_) => None,
        Err(other) => panic!("{other}"),
    }
}

/// A row whose run fails comes before one whose values make no scenario.
#[test]
fn regress_fail_fast_reports_the_lowest_row() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let mut spec = spec(&[("stop.duration", "0.002,10,-1")]);
    spec.max_steps = Some(500);
    let options = Options {
        fail_fast: true,
        ..Options::default()
    };
    let error = compute(&Sweep::new(spec), &table, &options).unwrap_err();
    assert!(
        matches!(error, SweepError::Row(RowError { run: 1, .. })),
        "{error}"
    );
}

#[test]
fn never_overwrites_other_files() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let sweep = |text| Sweep::new(spec(&[("friction.k", text)]));
    let go = |text| complete(&sweep(text), &table);
    fs::write(&table, "precious").unwrap();
    let message = go("0.1").unwrap_err().to_string();
    assert_contains(&message, "is not a sweep table");
    assert_eq!(fs::read(&table).unwrap(), b"precious");
    fs::remove_file(&table).unwrap();
    go("0.1").unwrap();
    let before = digest(&table);
    let refused = go("0.2").unwrap_err().to_string();
    assert_contains(
        &refused,
        "over.friction.k is \"0.1\" in the file, \"0.2\" here",
    );
    assert_eq!(digest(&table), before);
    // The parts of another sweep that isn't complete.
    let table = folder.at("b.parquet");
    compute(&sweep("0.1"), &table, &shard(0, 1)).unwrap();
    let refused = compute(&sweep("0.3"), &table, &shard(0, 1));
    let message = refused.unwrap_err().to_string();
    assert_contains(&message, "belongs to another sweep");
    complete(&sweep("0.1"), &table).unwrap();
    assert_eq!(folder.read("a.parquet"), fs::read(&table).unwrap());
}

#[test]
fn samples_and_tables_define_rows() {
    let folder = Folder::new();
    let sample = |method, seed| {
        let sample = Sample {
            count: 64,
            method,
            seed,
        };
        let varied = axes(&[
            ("friction.k", "0.01..1/log"),
            ("friction.law", "coulomb,none"),
        ]);
        let design = Design::Sample(sample, varied);
        Sweep::new(Spec::new(vec![base("paper", &[])], design, None).unwrap()).design(0..64)
    };
    let sobol = sample(Method::Sobol, 0);
    let k = numbers(&sobol, "friction_k");
    assert_eq!(k.value(0), 0.01);
    // The second point of Sobol's sequence is the middle.
    assert!((k.value(1) - 0.1).abs() < 1e-15);
    let laws = texts(&sobol, "friction_law");
    assert_eq!(laws.iter().filter(|law| *law == Some("none")).count(), 32);
    assert_ne!(sobol, sample(Method::Sobol, 1));
    assert_ne!(sample(Method::Random, 1), sample(Method::Random, 2));
    assert_eq!(sample(Method::Random, 1), sample(Method::Random, 1));

    let csv = folder.at("design.csv");
    let text = "friction_k, initial.psi_dot\n0.01, 100\n,150\n0.02,\n";
    fs::write(&csv, text).unwrap();
    let of = |path: &Path| {
        let design = Design::new(Vec::new(), None, Some(Table::read(path).unwrap())).unwrap();
        Spec::new(vec![base("paper", &[])], design, None).unwrap()
    };
    let spec = of(&csv);
    let design = Sweep::new(spec.clone()).design(0..3);
    let k = numbers(&design, "friction_k");
    assert_eq!((k.value(0), k.is_null(1), k.value(2)), (0.01, true, 0.02));
    assert!(numbers(&design, "initial_psi_dot").is_null(2));
    // The same design as Parquet is the same sweep.
    let file = folder.at("design.parquet");
    let columns = design.project(&[2, 3]).unwrap();
    write(&file, &columns);
    assert_eq!(of(&file).to_json(), spec.to_json());

    // A quoted empty cell is a row, as pandas writes it; a blank line is not.
    for (text, cells) in [
        ("friction_k\n\n0.02\n\n", &[Some(0.02)][..]),
        ("\u{feff}friction_k\r\n\r\n0.02\r\n\r\n", &[Some(0.02)]),
        ("friction_k\n\"\"\n0.02\n\"\"", &[None, Some(0.02), None]),
    ] {
        fs::write(&csv, text).unwrap();
        let design = Sweep::new(of(&csv)).design(0..cells.len() as u64);
        let k: Vec<_> = numbers(&design, "friction_k").iter().collect();
        assert_eq!(k, cells, "{text:?}");
    }
    for (text, part) in [
        ("friction_k\nfast\n", "is not a number"),
        ("friction_kk\n1\n", "friction.k"),
        ("friction_k\n", "no rows"),
    ] {
        fs::write(&csv, text).unwrap();
        let error = Table::read(&csv).unwrap_err().to_string();
        assert_contains(&error, part);
    }
}

/// SciPy's numbers: `tests/data/sobol.py` wrote them.
#[test]
fn val_samples_are_the_sobol_sequence_of_scipy() {
    let data: serde_json::Value = serde_json::from_str(include_str!("../data/sobol.json")).unwrap();
    let keys = toprise::run::scenario::KEYS.iter();
    let keys: Vec<_> = keys.filter(|key| !key.kind.is_text()).collect();
    assert!(keys.len() > 40);
    let varied: Vec<_> = keys.iter().map(|key| (key.path, "0..1")).collect();
    let sample = Sample {
        count: 2_000_000,
        method: Method::Sobol,
        seed: 0,
    };
    let design = Design::Sample(sample, axes(&varied));
    let sweep = Sweep::new(Spec::new(vec![base("paper", &[])], design, None).unwrap());
    let points = data["points"].as_object().unwrap();
    assert!(points.len() > 20);
    for (row, point) in points {
        let row = row.parse().unwrap();
        let ours = sweep.design(row..row + 1);
        for (key, coordinate) in keys.iter().zip(point.as_array().unwrap()) {
            let column = numbers(&ours, &toprise::sweep::column_name(key));
            let (found, key) = (Some(column.value(0)), key.path);
            assert_eq!(found, coordinate.as_f64(), "{row}, {key}");
        }
    }
}

#[test]
fn command_resumes_and_reports() {
    let folder = Folder::new();
    let line = "sweep paper --set stop.duration=0.01 --over initial_theta=0.5,4 -o a.parquet";
    let answer = folder.toprise(&format!("{line} --dry-run"), 0).stdout;
    assert!(answer.starts_with("2 runs"), "{answer}");
    assert_eq!(folder.files().len(), 0);
    let answer = folder.toprise(&format!("{line} --format json"), 3).stdout;
    let report: serde_json::Value = serde_json::from_str(&answer).unwrap();
    assert_eq!(report["runs"], 2);
    assert_eq!(report["outcomes"]["duration"], 1);
    assert_eq!(report["first_error"]["run"], 1);
    let answer = folder.toprise(line, 3).stdout;
    assert_contains(&answer, "0 runs (all were already computed)");
    let message = "bases[0].scenario.stop.duration is 0.01 in the file, 0.02 here";
    folder.refuses(&line.replace("0.01", "0.02"), message);
    folder.refuses(
        "sweep paper --over friction.k=0.1..1 -o b.parquet",
        "a grid needs a number of values",
    );
    let spec = "bases = [\"paper\"]\nset = { \"stop.duration\" = 0.01 }\nover = { initial_theta = [0.5, 4] }\n";
    folder.write("spec.toml", spec);
    folder.toprise("sweep spec.toml -o c.parquet", 3);
    assert_eq!(folder.read("a.parquet"), folder.read("c.parquet"));
}

/// Any design: a grid over several bases, with words, a sample, and a table that leaves cells to the base.
#[test]
fn run_repeats_a_row() {
    let folder = Folder::new();
    folder.write("design.csv", "friction_k,initial.theta\n0.02,0.5\n,0.4\n");
    let brief = "--set stop.duration=0.1 --format json";
    for (sweep, row, run) in [
        (
            "paper viscous --over friction.k=0.01,0.03 --over formulation=euler,body",
            6,
            "viscous --set friction.k=0.03 --set formulation=euler",
        ),
        (
            "paper --sample 9 --over friction.k=0.25..0.75",
            1,
            "paper --set friction.k=0.5",
        ),
        (
            "paper --table design.csv",
            1,
            "paper --set initial.theta=0.4",
        ),
    ] {
        folder.toprise(&format!("sweep {sweep} {brief} -o a.parquet"), 0);
        let recorded = |what: &str, name: &str| {
            let rrd = if cfg!(feature = "rerun") {
                "--no-rrd"
            } else {
                ""
            };
            let line = format!("run {what} -q {rrd} -o {name}");
            folder.toprise(&line, 0);
            let bytes = folder.read(name);
            fs::remove_file(folder.at(name)).unwrap();
            bytes
        };
        let again = recorded(&format!("a.parquet --row {row}"), "again.mcap");
        let plain = recorded(&format!("{run} --set stop.duration=0.1"), "plain.mcap");
        assert!(again == plain, "{sweep}");
        fs::remove_file(folder.at("a.parquet")).unwrap();
    }
}

#[test]
fn rejects_missing_and_modified_rows() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let sweep = Sweep::new(spec(&[("initial.theta", "0.4,4")]));
    complete(&sweep, &table).unwrap();
    write_columns(
        &folder.at("design.parquet"),
        [("friction_k", column_of(&[0.1]))],
    );
    for (line, part) in [
        ("a.parquet --row 2", "no row 2: the table has 2 rows"),
        ("a.parquet --row 1", "initial.theta = 4"),
        ("a.parquet", "toprise run a.parquet --row 0"),
        ("design.parquet --row 0", "not the table of a sweep"),
        ("paper --row 0", "paper"),
    ] {
        folder.refuses(&format!("run {line} -o a.mcap"), part);
    }
    // The same file with another inclination in the row.
    let mut columns = read(&table).columns().to_vec();
    columns[2] = column_of(&[0.5, 4.0]);
    let reader = SerializedFileReader::new(File::open(&table).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata().key_value_metadata();
    let properties = WriterProperties::builder()
        .set_key_value_metadata(metadata.cloned())
        .build();
    let changed = RecordBatch::try_new(sweep.schema(), columns).unwrap();
    write_with(&table, &changed, Some(properties));
    let error = values_of_row(&table, 0).unwrap_err().to_string();
    assert_contains(&error, "the scenario of row 0 does not match its digest");
}

/// Whatever bit of it is wrong: the row is the one that was run, or the table is refused.
#[test]
fn damaged_tables_do_not_panic() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let sweep = Sweep::new(spec(&[("friction.k", "0.01..0.1/12")]));
    complete(&sweep, &table).unwrap();
    let sound = fs::read(&table).unwrap();
    let digest_of = |table: &Path| -> Result<String, SweepError> {
        Ok(Scenario::new(values_of_row(table, 3)?)?.digest())
    };
    let expected = digest_of(&table).unwrap();
    let names = ["friction_k", "rise_time"];
    let damaged = folder.at("b.parquet");
    for place in (4..sound.len()).step_by(3) {
        let mut bytes = sound.clone();
        bytes[place] ^= 1 << (place % 8);
        fs::write(&damaged, bytes).unwrap();
        // Name and description of a scenario are free text.
        let digest = digest_of(&damaged);
        assert!(digest.is_err() || digest.is_ok_and(|digest| digest == expected));
        let _ = Columns::read(&damaged, &names);
    }
}

#[test]
fn draws_maps_and_curves() {
    let folder = Folder::new();
    let sweep = "sweep paper viscous --set stop.duration=0.05 --over friction.k=0.01..1/5log --over initial.theta=0.3..0.5/3 -o a.parquet";
    folder.toprise(sweep, 0);
    let map = "figures --sweep a.parquet --x friction.k --y initial_theta --kinds svg";
    folder.refuses(&format!("{map} -o both"), "select with --where");
    // Nothing has risen yet: all cells have the colour that says so.
    folder.toprise(&format!("{map} --where scenario=paper -o risen"), 0);
    let svg = folder.text("risen/sweep.svg");
    for part in ["not reached", "\"k\"", "θ_0 (rad)", "0.01", "0.1"] {
        assert!(svg.contains(part), "{part} is not in the figure");
    }
    assert!(!svg.contains("rise time (s)"));
    folder.toprise(
        &format!("{map} --where scenario=paper --show energy -o energy"),
        0,
    );
    let svg = folder.text("energy/sweep.svg");
    assert!(svg.contains("energy (J)") && !svg.contains("not reached"));
    let curves = "figures --sweep a.parquet --x friction_k --show slip_path --where initial_theta=0.4 --kinds svg -o c";
    folder.toprise(curves, 0);
    let svg = folder.text("c/sweep.svg");
    for part in ["paper", "viscous", "slip path ("] {
        assert!(svg.contains(part), "{part} is not in the figure");
    }
    folder.refuses(
        "figures --sweep a.parquet --x friction --kinds svg -o d",
        "no column friction; columns: run, scenario",
    );
    let twice = "figures --sweep a.parquet --x friction_k --y friction.k -o d";
    folder.refuses(twice, "--x and --y are both friction_k: choose two columns");
}

/// A part is taken for that of this sweep only if it is, and every bit of it is as it was written. What is damaged is
/// computed again.
#[test]
fn never_merges_foreign_or_damaged_parts() {
    let folder = Folder::new();
    let (a, b) = (folder.at("a.parquet"), folder.at("b.parquet"));
    let sweep = |last| Sweep::new(spec(&[AXES[0], ("initial.psi_dot", last)]));
    let (first, second) = (sweep("60..200/60"), sweep("60..210/60"));
    compute(&first, &a, &shard(0, 1)).unwrap();
    compute(&second, &b, &shard(0, 1)).unwrap();
    let part = |table, number: u64| parts_directory(table).join(format!("{number:06}.parquet"));
    let sound = fs::read(part(&a, 2)).unwrap();
    let refused = |what: &str| {
        let error = complete(&first, &a).unwrap_err().to_string();
        assert!(error.contains("can't be merged"), "{what}: {error}");
        assert!(error.contains("000002.parquet"), "{what}: {error}");
        assert!(!a.exists(), "{what}");
    };
    fs::copy(part(&b, 2), part(&a, 2)).unwrap();
    refused("a part of another sweep");
    fs::copy(part(&a, 0), part(&a, 2)).unwrap();
    refused("another part");
    // Parts of another sweep are still seen where the file is gone that says of which they are.
    fs::copy(part(&b, 2), part(&a, 2)).unwrap();
    fs::remove_file(parts_directory(&a).join("sweep.json")).unwrap();
    refused("a part that does not name its sweep");
    let is_mended = |damaged: &[u8]| {
        fs::write(part(&a, 2), damaged).unwrap();
        let finished = compute(&first, &a, &shard(2, 3)).unwrap();
        finished.computed == 400 && fs::read(part(&a, 2)).unwrap() == sound
    };
    for place in (0..sound.len()).step_by(sound.len() / 100) {
        let mut damaged = sound.clone();
        damaged[place] ^= 1 << (place % 8);
        assert!(is_mended(&damaged), "a flipped bit at {place}");
    }
    for length in [0, 7, sound.len() / 2, sound.len() - 1] {
        assert!(is_mended(&sound[..length]), "cut off after {length} bytes");
    }
    assert_eq!(compute(&first, &a, &shard(2, 3)).unwrap().computed, 0);
    complete(&first, &a).unwrap();
    assert!(!parts_directory(&a).exists());
}

/// A table that is there is done only if every bit of it is as it was written.
#[test]
fn regress_rejects_damaged_table() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let sweep = Sweep::new(spec(AXES));
    let go = || complete(&sweep, &table);
    go().unwrap();
    let sound = fs::read(&table).unwrap();
    for place in (0..sound.len()).step_by(sound.len() / 200) {
        let mut damaged = sound.clone();
        damaged[place] ^= 1 << (place % 8);
        fs::write(&table, &damaged).unwrap();
        assert!(go().is_err(), "a flipped bit at {place}");
        // It may have been changed on purpose.
        assert!(fs::read(&table).unwrap() == damaged);
    }
    let mut damaged = sound.clone();
    damaged[2000..2100].fill(0);
    fs::write(&table, damaged).unwrap();
    let error = go().unwrap_err();
    assert_contains(&error.to_string(), "is damaged or was modified");
    fs::remove_file(&table).unwrap();
    go().unwrap();
    assert!(fs::read(&table).unwrap() == sound);
    assert_eq!(go().unwrap().computed, 0);
}

/// Row counts, names and types of a Parquet file are looked at before its columns.
#[test]
fn regress_checks_columns_before_reading_cells() {
    let folder = Folder::new();
    let path = folder.at("design.parquet");
    let written = |name: &str, column: ArrayRef| {
        write_columns(&path, [(name, column)]);
        let mut bytes = fs::read(&path).unwrap();
        let groups = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
        let (start, length) = groups.metadata().row_group(0).column(0).byte_range();
        // Who reads the column sees that it is damaged.
        bytes[start as usize..][..length as usize].fill(0xff);
        fs::write(&path, bytes).unwrap();
        Table::read(&path).unwrap_err().to_string()
    };
    let numbers = || column_of(&[0.1; 1000]);
    let words = || Arc::new(LargeStringArray::from(vec!["fast"; 1000])) as ArrayRef;
    for (name, column, part) in [
        ("friction_kk", numbers(), "did you mean"),
        ("friction_k", words(), "the values are words; expected"),
        (
            "friction_law",
            numbers(),
            "the values are numbers; expected",
        ),
    ] {
        let message = written(name, column);
        assert_contains(&message, part);
    }
    let message = written("friction_k", numbers());
    assert!(!message.contains("rows"), "{message}");
    // The same thousand rows, ten thousand times and once more.
    write_columns(&path, [("friction_k", numbers())]);
    let thousand = File::open(&path).unwrap();
    let reader = SerializedFileReader::new(thousand.try_clone().unwrap()).unwrap();
    let group = reader.metadata().row_group(0);
    let schema = reader.metadata().file_metadata().schema_descr();
    let many = folder.at("many.parquet");
    let output = File::create(&many).unwrap();
    let properties = Arc::default();
    let mut writer =
        SerializedFileWriter::new(output, schema.root_schema_ptr(), properties).unwrap();
    for _ in 0..10_001 {
        let mut copy = writer.next_row_group().unwrap();
        let close = ColumnCloseResult {
            bytes_written: group.column(0).compressed_size() as u64,
            rows_written: 1000,
            metadata: group.column(0).clone(),
            bloom_filter: None,
            column_index: None,
            offset_index: None,
        };
        copy.append_column(&thousand, close).unwrap();
        copy.close().unwrap();
    }
    writer.close().unwrap();
    let message = Table::read(&many).unwrap_err().to_string();
    assert_contains(&message, "more than 10000000 rows");
}

/// Threads that have nothing to do cost as much as others to start.
#[cfg(target_os = "linux")]
#[test]
fn regress_limits_threads_to_processors_and_runs() {
    let folder = Folder::new();
    let threads = || fs::read_dir("/proc/self/task").unwrap().count() as u64;
    let most = AtomicU64::new(0);
    let watch = Watch {
        carry_on: &|| true,
        row_done: &|_| {
            most.fetch_max(threads(), Ordering::Relaxed);
        },
    };
    let options = Options {
        threads: 1024,
        ..Options::default()
    };
    let sweep = Sweep::new(spec(&[("friction.k", "0.1,0.2,0.3")]));
    run(&sweep, &folder.at("a.parquet"), &options, &watch).unwrap();
    // Other tests have some too.
    assert!(most.into_inner() < 1024);
    let processors = std::thread::available_parallelism().unwrap().get();
    assert_eq!(threads_for(1024, 1), 1);
    assert_eq!(threads_for(1024, 1_000_000), processors);
    assert_eq!(threads_for(0, 1_000_000), processors);
    assert_eq!(threads_for(0, 0), 1);
}

/// A part that is finished late, after the sweep has been completed without it, leaves nothing behind.
#[test]
fn clears_late_parts() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let sweep = Sweep::new(spec(AXES));
    let late = shard(1, 2);
    let has_begun = AtomicBool::new(false);
    let watch = Watch {
        carry_on: &|| true,
        row_done: &|_| {
            if !has_begun.swap(true, Ordering::Relaxed) {
                complete(&sweep, &table).unwrap();
            }
        },
    };
    // While its first row is done, another process does everything.
    let finished = run(&sweep, &table, &late, &watch).unwrap();
    assert!(finished.is_merged, "{finished:?}");
    // The computed rows are reported, although they were not needed.
    assert_eq!(finished.computed, 1000);
    assert!(!parts_directory(&table).exists());
    // So is what a process left that was killed while it cleared.
    compute(&sweep, &folder.at("b.parquet"), &late).unwrap();
    let left = folder.at("b.parquet.parts");
    fs::rename(&left, parts_directory(&table)).unwrap();
    complete(&sweep, &table).unwrap();
    assert!(!parts_directory(&table).exists());
}

#[test]
fn rejects_damaged_spec_of_parts() {
    let folder = Folder::new();
    let table = folder.at("a.parquet");
    let sweep = Sweep::new(spec(&[("friction.k", "0.1")]));
    fs::create_dir(parts_directory(&table)).unwrap();
    for text in ["", "{", "\u{0}"] {
        fs::write(parts_directory(&table).join("sweep.json"), text).unwrap();
        let error = complete(&sweep, &table).unwrap_err();
        assert_contains(&error.to_string(), "is damaged (its spec is unreadable)");
    }
}

fn write(path: &Path, table: &RecordBatch) {
    write_with(path, table, None);
}

fn write_with(path: &Path, table: &RecordBatch, properties: Option<WriterProperties>) {
    let file = File::create(path).unwrap();
    let mut writer = ArrowWriter::try_new(file, table.schema(), properties).unwrap();
    writer.write(table).unwrap();
    writer.close().unwrap();
}

fn column_of(numbers: &[f64]) -> ArrayRef {
    Arc::new(Float64Array::from(numbers.to_vec()))
}

fn write_columns<const N: usize>(path: &Path, columns: [(&str, ArrayRef); N]) {
    write(path, &RecordBatch::try_from_iter(columns).unwrap());
}

#[test]
fn reads_every_compression() {
    let folder = Folder::new();
    let path = folder.at("design.parquet");
    let numbers: Vec<f64> = (0..1000).map(|row| 1e-4 * f64::from(row)).collect();
    let table = RecordBatch::try_from_iter([("friction_k", column_of(&numbers))]).unwrap();
    for compression in [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::GZIP(GzipLevel::default()),
        Compression::LZ4,
        Compression::LZ4_RAW,
        Compression::BROTLI(BrotliLevel::default()),
        Compression::ZSTD(ZstdLevel::default()),
    ] {
        let properties = WriterProperties::builder().set_compression(compression);
        write_with(&path, &table, Some(properties.build()));
        let design = Table::read(&path).unwrap();
        assert_eq!(design.rows(), 1000, "{compression}");
        let last = format!("Number({:?})", numbers[999]);
        assert!(format!("{design:?}").contains(&last), "{compression}");
    }
}

/// Decades are whole numbers of nanoseconds, as sampling periods must be.
#[test]
fn runs_decades_of_sampling_periods() {
    let axis = Axis::parse("sampling.period", "1e-4..1e-1/4log").unwrap();
    for row in 0..4 {
        let Value::Number(period) = axis.at(row) else {
            panic!("a period is a number");
        };
        let period = format!("{period:?}");
        let expected = 10_u64.pow(5 + row as u32);
        assert_eq!(
            scenario("paper", &[("sampling.period", &period)]).sample_period_ns,
            expected
        );
    }
}

/// A table as pandas writes it: its index is a column like any other, but for its name or what the schema says.
#[test]
fn ignores_pandas_index() {
    let folder = Folder::new();
    let path = folder.at("design.parquet");
    let design = |indices: &str| {
        let about = format!("{{\"index_columns\": {indices}}}");
        let about = HashMap::from([("pandas".to_owned(), about)]);
        let fields = ["__index_level_0__", "serial", "friction_k"];
        let fields = fields.map(|name| Field::new(name, DataType::Float64, true));
        let schema = Schema::new_with_metadata(fields.to_vec(), about);
        let columns = vec![column_of(&[0.01, 0.02]); 3];
        let table = RecordBatch::try_new(Arc::new(schema), columns);
        write(&path, &table.unwrap());
        Table::read(&path)
    };
    let paths = |table: Table| {
        let keys = table.keys().into_iter();
        keys.map(|key| key.path).collect::<Vec<_>>()
    };
    let table = design("[\"serial\"]").unwrap();
    assert_eq!((table.rows(), paths(table)), (2, vec!["friction.k"]));
    // Where keys are the index, they are keys still.
    let table = design("[\"serial\", \"friction_k\"]").unwrap();
    assert_eq!(paths(table), ["friction.k"]);
    let error = design("[{\"kind\": \"range\"}]").unwrap_err().to_string();
    assert_contains(&error, "unknown key serial");
}

/// Libraries have several types for texts and numbers, and write a table with others than it had.
#[test]
fn draws_tables_of_other_software() {
    let folder = Folder::new();
    let sweep = "sweep paper viscous --set stop.duration=0.05 --over friction.k=0.01,0.02,0.03 --over initial.theta=0.25,0.5 -o a.parquet";
    folder.toprise(sweep, 0);
    let table = read(&folder.at("a.parquet"));
    let line =
        "--x friction_k --y initial_theta --show energy --where scenario=viscous --kinds svg -o";
    let draw = |file: &str| {
        let line = format!("figures --sweep {file}.parquet {line} {file}");
        folder.toprise(&line, 0);
        folder.text(format!("{file}/sweep.svg"))
    };
    let texts = |name| texts(&table, name).iter();
    let words: [ArrayRef; 3] = [
        Arc::new(texts("scenario").collect::<DictionaryArray<Int32Type>>()),
        Arc::new(texts("scenario").collect::<LargeStringArray>()),
        Arc::new(texts("scenario").collect::<StringViewArray>()),
    ];
    let theta = numbers(&table, "initial_theta").iter();
    let theta: Float32Array = theta.map(|theta| theta.map(|theta| theta as f32)).collect();
    let mut drawn = Vec::new();
    for (index, scenario) in words.into_iter().enumerate() {
        let columns = table.schema_ref().fields().iter().zip(table.columns());
        let columns = columns.map(|(field, column)| -> (Field, ArrayRef) {
            let column = match field.name().as_str() {
                "scenario" => scenario.clone(),
                "stop_reason" => Arc::new(texts("stop_reason").collect::<LargeStringArray>()),
                "initial_theta" => Arc::new(theta.clone()),
                _ => column.clone(),
            };
            let field = field.as_ref().clone();
            (field.with_data_type(column.data_type().clone()), column)
        });
        let (fields, columns): (Vec<Field>, Vec<ArrayRef>) = columns.unzip();
        let other = RecordBatch::try_new(Arc::new(Schema::new(fields)), columns);
        let name = format!("other{index}");
        write(&folder.at(format!("{name}.parquet")), &other.unwrap());
        drawn.push(draw(&name));
    }
    assert_eq!(drawn[0], drawn[1]);
    assert_eq!(drawn[0], drawn[2]);
    // These angles are floats of 32 bits too.
    assert_eq!(drawn[0], draw("a"));

    for (condition, part) in [
        ("initial_theta=61", "values: 0.25, 0.5"),
        ("scenario=papr", "values: paper, viscous"),
    ] {
        let line = format!("figures --sweep a.parquet --x friction_k --where {condition}");
        let message = format!("no run has {}; {part}", condition.replace('=', " = "));
        folder.refuses(&line, &message);
    }
}

#[test]
fn rejects_table_without_name() {
    let folder = Folder::new();
    for name in ["..", "/", "new/"] {
        let line = format!("sweep paper --set stop.duration=0.01 -o {name}");
        folder.refuses(&line, "is not a file name");
    }
    let nameless = complete(&Sweep::new(spec(AXES)), Path::new(""));
    assert!(nameless.is_err_and(|error| error.to_string().contains("is not a file name")));
    assert_eq!(folder.files().len(), 0);
}

/// A name that leaves room for the directory of parts is a table's, and one that does not is not.
#[cfg(target_os = "linux")]
#[test]
fn rejects_too_long_names_early() {
    let folder = Folder::new();
    let table = folder.at("a".repeat(249));
    let sweep = Sweep::new(spec(&[("friction.k", "0.1,0.2")]));
    complete(&sweep, &table).unwrap();
    assert_eq!(folder.files().len(), 1);
    let table = folder.at("a".repeat(250));
    let done = AtomicU64::new(0);
    let watch = Watch {
        carry_on: &|| true,
        row_done: &|_| {
            done.fetch_add(1, Ordering::Relaxed);
        },
    };
    let refused = run(&sweep, &table, &Options::default(), &watch).unwrap_err();
    assert_contains(&refused.to_string(), "too long");
    assert_eq!(done.into_inner(), 0);
    assert_eq!(folder.files().len(), 1);
}

#[test]
fn keeps_foreign_files_next_to_parts() {
    let folder = Folder::new();
    let parts = folder.at("a.parquet.parts");
    fs::create_dir(&parts).unwrap();
    // The draft of a part, which a process that was killed has left, goes; nothing else does.
    for name in [
        ".000000.parquet.x1y2z3.tmp",
        ".000000.parquet.bak",
        ".000000.parquet.bak.tmp",
        ".sweep.json.mine",
        "000007.parquet",
        "1.parquet",
        "design.csv",
        "1.parquet.bak",
        "sweep.json~",
    ] {
        fs::write(parts.join(name), "initial.theta\n0.4\n").unwrap();
    }
    let line =
        "sweep paper --table a.parquet.parts/design.csv --set stop.duration=0.01 -o a.parquet";
    folder.toprise(line, 0);
    assert_eq!(
        files(&parts),
        [
            ".000000.parquet.bak",
            ".000000.parquet.bak.tmp",
            ".sweep.json.mine",
            "000007.parquet",
            "1.parquet",
            "1.parquet.bak",
            "design.csv",
            "sweep.json~"
        ]
    );
    // A table that has the name of a part would be taken for one.
    let table = folder.at("b.parquet.parts/000000.parquet");
    fs::create_dir(table.parent().unwrap()).unwrap();
    write_columns(&table, [("friction_k", column_of(&[0.1]))]);
    let line = "sweep paper --table b.parquet.parts/000000.parquet -o b.parquet";
    folder.refuses(line, "also an input or another output");
    assert!(table.exists());
    // So would a scenario.
    let scenario = scenario("paper", &[]).to_toml();
    fs::write(&table, &scenario).unwrap();
    let line = "sweep b.parquet.parts/000000.parquet --set stop.duration=0.01 -o b.parquet";
    folder.refuses(line, "also an input or another output");
    assert_eq!(fs::read_to_string(&table).unwrap(), scenario);
}

#[cfg(unix)]
#[test]
fn rejects_unwritable_folder() {
    let folder = Folder::new();
    // A file where the folder would have to be: nobody can write there, not even root.
    folder.write("a.parquet.parts", "");
    let sweep = Sweep::new(spec(&[("friction.k", "0.1")]));
    let error = complete(&sweep, &folder.at("a.parquet"));
    let error = error.unwrap_err().to_string();
    assert_contains(&error, "a.parquet.parts");
}

#[test]
fn outcome_columns_differ_from_keys() {
    let names: Vec<_> = outcome::COLUMNS.iter().map(|c| c.name).collect();
    for key in toprise::run::scenario::KEYS {
        let column = toprise::sweep::column_name(key);
        assert!(!names.contains(&column.as_str()), "{column}");
        assert!(!["run", "scenario", "scenario_digest", "error"].contains(&column.as_str()));
    }
}

/// A process that dies while it merges leaves its draft among the parts, which the next one clears away.
#[cfg(unix)]
#[test]
fn clears_drafts_of_killed_merges() {
    let folder = Folder::new();
    let line = "sweep paper --set stop.duration=0.002 --over friction.k=0.005..0.1/40log --over initial.psi_dot=60..200/60 -o a.parquet";
    folder.toprise(&format!("{line} --shard 0/1"), 0);
    let size = |name: &String| {
        let path = folder.at("a.parquet.parts").join(name);
        path.metadata().unwrap().len()
    };
    let parts = files(&folder.at("a.parquet.parts"));
    let largest = parts.iter().map(size).max().unwrap();
    // A file that grows beyond the limit, in units of 512 bytes, is the death of the process: here the table.
    let limit = largest / 512 + 1;
    let program = env!("CARGO_BIN_EXE_toprise");
    let limited = format!("ulimit -f {limit}; ulimit -c 0; exec {program} {line}");
    let mut command = std::process::Command::new("sh");
    let command = command.args(["-c", &limited]).current_dir(folder.path());
    assert_eq!(command.output().unwrap().status.code(), None);
    assert_eq!(folder.files(), ["a.parquet.parts"]);
    let left = files(&folder.at("a.parquet.parts"));
    let drafts = left.iter().filter(|name| name.starts_with(".a.parquet."));
    assert_eq!(drafts.count(), 1, "{left:?}");
    folder.toprise(line, 0);
    assert_eq!(folder.files(), ["a.parquet"]);
}

/// The directory of parts may be a link to another disk, from which a file can't be renamed.
#[cfg(target_os = "linux")]
#[test]
fn merges_parts_from_another_disk() {
    use std::os::unix::fs::MetadataExt as _;
    let folder = Folder::new();
    let Ok(other) = tempfile::tempdir_in("/dev/shm") else {
        return eprintln!("skipped: there is no /dev/shm");
    };
    let disk = |path: &Path| path.metadata().unwrap().dev();
    if disk(folder.path()) == disk(other.path()) {
        return eprintln!("skipped: /dev/shm is no other disk");
    }
    let sweep = Sweep::new(spec(&[("friction.k", "0.1,0.2")]));
    let [here, there] = ["a.parquet", "b.parquet"].map(|name| folder.at(name));
    complete(&sweep, &here).unwrap();
    std::os::unix::fs::symlink(other.path(), parts_directory(&there)).unwrap();
    complete(&sweep, &there).unwrap();
    assert_eq!(digest(&here), digest(&there));
    assert!(files(other.path()).is_empty());
}

/// Waiting for a writer at the other end of a pipe could take forever.
#[cfg(unix)]
#[test]
fn rejects_pipes_and_devices() {
    let folder = Folder::new();
    for name in ["a.parquet", "a.csv"] {
        let mut command = std::process::Command::new("mkfifo");
        let made = command.arg(folder.at(name)).status().unwrap();
        assert!(made.success());
    }
    for (line, part) in [
        ("sweep paper -o a.parquet", "a.parquet: it is a pipe"),
        (
            "sweep paper --dry-run -o a.parquet",
            "a.parquet: it is a pipe",
        ),
        (
            "sweep paper -o /dev/null",
            "/dev/null: it is a pipe or a device",
        ),
        (
            "sweep paper --table a.parquet -o b.parquet",
            "a.parquet: it is a pipe",
        ),
        (
            "sweep paper --table a.csv -o b.parquet",
            "a.csv: it is a pipe",
        ),
        (
            "figures --sweep a.parquet --x friction_k",
            "a.parquet: it is a pipe",
        ),
    ] {
        folder.refuses(
            &line.replace("paper", "paper --set stop.duration=0.01"),
            part,
        );
    }
    assert_eq!(folder.files().len(), 2);
}

/// Writes a table of others, one of whose columns has a dot in its name. Returns the arguments that draw it.
fn table_of_others(folder: &Folder, values: [f64; 3]) -> &'static str {
    let words = |word: &str| Arc::new(LargeStringArray::from(vec![word; 3])) as ArrayRef;
    let columns = [
        ("friction.k", column_of(&values)),
        ("initial_theta", column_of(&[0.1, 0.2, 0.3])),
        ("scenario", words("paper")),
        ("stop_reason", words("risen")),
        ("loops", column_of(&[0.0; 3])),
        ("rise_time", column_of(&[1.0, 2.0, 3.0])),
    ];
    write_columns(&folder.at("others.parquet"), columns);
    "figures --sweep others.parquet --x friction_k --y initial_theta --kinds svg --force"
}

#[test]
fn accepts_key_names_as_columns() {
    let folder = Folder::new();
    folder.toprise(table_of_others(&folder, [0.1, 0.2, 0.3]), 0);
}

#[test]
fn rejects_extreme_numbers_in_figures() {
    let folder = Folder::new();
    for beyond in [1e300, -1e308] {
        let line = table_of_others(&folder, [0.1, beyond, 0.3]);
        folder.refuses(line, "values above 1e100 can't be drawn");
    }
}

#[test]
fn warns_of_shared_names() {
    let folder = Folder::new();
    let line = "sweep paper viscous --set stop.duration=0.001";
    let stderr = folder.toprise(&format!("{line} -o a.parquet"), 0).stderr;
    assert!(!stderr.contains("warning"), "{stderr}");
    let line = format!("{line} --set name=one -o b.parquet");
    let stderr = folder.toprise(&line, 0).stderr;
    assert_contains(&stderr, "several scenarios have the name one");
}

#[test]
fn warns_of_a_sweep_that_varies_nothing() {
    let folder = Folder::new();
    let line = "sweep paper --set stop.duration=0.001 -o a.parquet";
    assert_contains(&folder.toprise(line, 0).stderr, "vary a key, e.g. --over");
}

#[test]
fn refuses_dash_as_a_file() {
    let folder = Folder::new();
    folder.refuses("sweep --table - -o a.parquet", "error: -");
    let stdout = "sweep --set stop.duration=0.05 -o -";
    folder.refuses(stdout, "is not a file name");
    assert!(folder.files().is_empty());
}
