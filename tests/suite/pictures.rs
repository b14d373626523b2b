//! The pictures in the documents show what toprise draws today: `docs/pictures` makes them anew.

use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use toprise::analysis::figures::{Figure, Map, MapAxis, MapRun, Run};
use toprise::run::scenario::Preset;

const NOTED: &str = "docs/pictures.json";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn digest(bytes: impl AsRef<[u8]>) -> String {
    format!("{:x}", Sha256::digest(bytes))
}

fn of_file(path: &str) -> String {
    digest(fs::read(root().join(path)).unwrap())
}

fn figure_2() -> String {
    let figure = Figure::find("figure-2").unwrap();
    let scenario = Preset::find("paper").unwrap().scenario().unwrap();
    let run = Run::read(&scenario, "paper", &[figure], &|_| {});
    digest(figure.draw(&[&run], 170.0).svg())
}

/// Of a small map: how maps are drawn, in a moment.
fn map() -> String {
    let axis = |name: &str| MapAxis {
        name: name.to_owned(),
        ..MapAxis::default()
    };
    let run = |cell: u8| MapRun {
        x: f64::from(1 << (cell % 4)),
        y: f64::from(cell / 4),
        color: if cell == 0 { f64::NAN } else { f64::from(cell) },
        stop: Some("duration".to_owned()),
        loops: Some(cell > 5),
        ..MapRun::default()
    };
    let map = Map {
        x: axis("friction_k"),
        y: Some(axis("initial_psi_dot")),
        color: axis("rise_time"),
        runs: (0..12).map(run).collect(),
    };
    digest(map.draw(85.0).unwrap().svg())
}

/// The code that makes the scene and its layouts, without comments.
fn scene() -> String {
    let mut files = Vec::new();
    let mut directories = vec![root().join("src/rerun")];
    while let Some(directory) = directories.pop() {
        for entry in fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                directories.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    let code = |path: &PathBuf| {
        let text = fs::read_to_string(path).unwrap();
        let lines = text.lines().map(str::trim);
        let lines: Vec<_> = lines.filter(|line| !line.starts_with("//")).collect();
        lines.join("\n")
    };
    digest(files.iter().map(code).collect::<String>())
}

#[test]
fn pictures_show_what_is_drawn_today() {
    let shown = BTreeMap::from([
        ("figure-2.png", figure_2()),
        ("map.png", map()),
        ("page.png", of_file("docs/toprise.html")),
        ("paper-in-rerun.png", scene()),
        ("diff-in-rerun.png", scene()),
        (
            "mcap-in-rerun.png",
            of_file("recordings/reference/paper.mcap"),
        ),
    ]);
    let path = root().join(NOTED);
    let text = fs::read_to_string(&path).unwrap_or_else(|_| "{}".to_owned());
    let mut noted: BTreeMap<&str, String> = serde_json::from_str(&text).unwrap();
    // Those that have just been made.
    if let Ok(made) = std::env::var("TOPRISE_PICTURES") {
        let made = shown
            .iter()
            .filter(|(picture, _)| made.split(',').any(|name| name == **picture));
        noted.extend(made.map(|(picture, digest)| (*picture, digest.clone())));
        fs::write(&path, serde_json::to_string_pretty(&noted).unwrap() + "\n").unwrap();
        return;
    }
    for (picture, digest) in shown {
        assert_eq!(
            noted.get(picture),
            Some(&digest),
            "docs/{picture} is stale: `docs/pictures {picture}` makes it anew"
        );
        assert!(root().join("docs").join(picture).exists(), "{picture}");
    }
}
