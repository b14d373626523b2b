//! The pages of `docs` that are generated from tables. The program `generate` (`release/generate.rs`) writes them; a test
//! compares.

#[path = "foxglove.rs"]
mod foxglove;

pub use self::foxglove::foxglove_layout;
use std::fs;
use std::path::Path;
use toprise::physics::dynamics::Support;
use toprise::run::scenario::{KEYS, Presence, Preset};
use toprise::telemetry::{Leaf, Quantity, channels};

/// The path of each page in the repository, and its text.
pub fn pages() -> [(&'static str, String); 4] {
    [
        ("docs/keys.md", keys_page()),
        ("docs/format.md", format_page()),
        (
            "docs/foxglove-layout.json",
            foxglove_layout(Support::FixedPeg),
        ),
        (
            "docs/foxglove-layout-free-peg.json",
            foxglove_layout(Support::FreePeg { restitution: 0.0 }),
        ),
    ]
}

const KEYS_HEAD: &str = "\
# Keys of a scenario

A scenario is a TOML file: `toprise presets paper > mine.toml`. Keys are grouped in sections: `friction.k` is `k` in
`[friction]`. On the command line it is `--set friction.k=0.02`, and an empty value removes a key. Editors that use
[`schemas/scenario.json`](../schemas/scenario.json) complete and check the keys: begin the file with
`#:schema PATH/schemas/scenario.json`.

| key | meaning | values | `paper` | when |
|---|---|---|---|---|
";

/// The page of all keys.
fn keys_page() -> String {
    let paper = Preset::find("paper").unwrap().values().unwrap();
    let mut page = KEYS_HEAD.to_owned();
    for key in KEYS {
        let unit = key.in_unit();
        let value = paper.get(key.path).map(ToString::to_string);
        let presence = match key.presence {
            Presence::Required => "always".to_owned(),
            Presence::Optional => "optional".to_owned(),
            Presence::RequiredWith(other, words) if words.len() < 4 => {
                format!("with `{other}` = {}", words.join(", "))
            }
            Presence::RequiredWith(other, _) => format!("with any `{other}` but none"),
            Presence::RequiredWithKey(other) => format!("with `{other}`"),
            Presence::OfLaws(required, optional) => format!(
                "with `friction.law` = {}; optional with {}",
                required.join(", "),
                optional.join(", ")
            ),
            Presence::Parameter(["formula"]) => "if `friction.formula` contains it".to_owned(),
            Presence::Parameter(_) => {
                "with any `friction.law` but none; with formula, if it contains it".to_owned()
            }
            Presence::OptionalWith(other, words) => {
                format!("optional with `{other}` = {}", words.join(", "))
            }
        };
        let (path, meaning, kind) = (key.path, key.meaning, key.kind);
        let value = value.filter(|_| path != "description").unwrap_or_default();
        page += &format!("| `{path}` | {meaning}{unit} | {kind} | {value} | {presence} |\n");
    }
    page
}

const CHANNELS_HEADING: &str = "## Channels and fields\n";

/// The page of the format. Its end lists the fields of all channels; the rest stays.
fn format_page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/format.md");
    let written = fs::read_to_string(path).unwrap();
    let (head, _) = written.split_once(CHANNELS_HEADING).unwrap();
    let mut page = format!("{head}{CHANNELS_HEADING}");
    for channel in channels() {
        page += &format!("\n### `{}`\n\n", channel.topic);
        page += &format!("`{}`: {}.\n\n", channel.schema, channel.meaning);
        page += "| field | unit | meaning |\n|---|---|---|\n";
        for leaf in channel.leaves() {
            let Some(field) = field(leaf) else { continue };
            page += &format!("| {field} | {} | {} |\n", leaf.unit, meaning(leaf));
        }
    }
    page
}

/// The name of a field; a vector or quaternion is listed once, at its first component.
fn field(leaf: &Leaf) -> Option<String> {
    if !leaf.is_component {
        return Some(format!("`{}`", leaf.path));
    }
    let name = leaf.path.strip_suffix(".x")?;
    let components = match leaf.quantity {
        Quantity::Orientation => "x, y, z, w",
        _ => "x, y, z",
    };
    Some(format!("`{name}` ({components})"))
}

/// The meaning of a field, with the frame of a vector's components.
fn meaning(leaf: &Leaf) -> String {
    let meaning = leaf.meaning.replace('|', "\\|");
    match leaf.frame.split(':').next() {
        None | Some("") => meaning,
        Some(frame) => format!("{meaning}, {frame} frame"),
    }
}
