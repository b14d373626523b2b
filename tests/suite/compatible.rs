//! Comparison of schemas with those of a release: what a release has stays, and more may be added.

use serde_json::{Map, Value};
use std::fs;
use std::path::Path;

/// The use of a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Programs read values that toprise writes: reports and messages.
    Output,
    /// Programs write values that toprise reads: scenarios.
    Input,
}

/// A comparison of a released schema with today's.
struct Comparison<'s> {
    usage: Use,
    /// The schema of the release, and today's.
    roots: [&'s Value; 2],
    /// Definitions of the release on the way to the place that is compared.
    definitions: Vec<&'s str>,
    broken: Vec<String>,
}

/// The places in which a schema breaks a promise of a released one. Descriptions promise nothing, but units do.
pub fn broken(released: &Value, today: &Value, usage: Use) -> Vec<String> {
    let mut comparison = Comparison {
        usage,
        roots: [released, today],
        definitions: Vec::new(),
        broken: Vec::new(),
    };
    comparison.compare("", released, today);
    comparison.broken
}

impl<'s> Comparison<'s> {
    fn compare(&mut self, path: &str, released: &'s Value, today: &'s Value) {
        let today = resolved(today, self.roots[1]);
        let Some(name) = released["$ref"].as_str() else {
            return self.compare_resolved(path, released, today);
        };
        // A definition inside itself has been compared.
        if !self.definitions.contains(&name) {
            self.definitions.push(name);
            self.compare_resolved(path, resolved(released, self.roots[0]), today);
            self.definitions.pop();
        }
    }

    fn compare_resolved(&mut self, path: &str, released: &'s Value, today: &'s Value) {
        let types = [released, today].map(types);
        let (from, to) = match self.usage {
            Use::Output => (&types[1], &types[0]),
            Use::Input => (&types[0], &types[1]),
        };
        if !to.is_empty() && (from.is_empty() || from.iter().any(|kind| !to.contains(kind))) {
            self.broken
                .push(format!("{path}: {:?} became {:?}", types[0], types[1]));
        }
        let units = [released, today].map(unit);
        if units[0] != units[1] {
            self.broken
                .push(format!("{path}: {:?} became {:?}", units[0], units[1]));
        }
        self.compare_words(path, released, today);
        self.compare_members(path, released, today);
        for key in ["items", "additionalProperties"] {
            if let Some(inner) = released.get(key).filter(|inner| inner.is_object()) {
                self.compare(&format!("{path}[]"), inner, &today[key]);
            }
        }
        if let Some(items) = released["prefixItems"].as_array() {
            for (at, inner) in items.iter().enumerate() {
                self.compare(&format!("{path}[{at}]"), inner, &today["prefixItems"][at]);
            }
        }
        for key in ["anyOf", "oneOf", "allOf"] {
            self.compare_kinds(path, &released[key], &today[key]);
        }
    }

    /// The words of an enumeration.
    fn compare_words(&mut self, path: &str, released: &Value, today: &Value) {
        let words = [released, today].map(words);
        // An input may take any word now.
        if self.usage == Use::Input && words[1].is_empty() {
            return;
        }
        for word in &words[0] {
            if !words[1].contains(word) {
                self.broken.push(format!("{path}: {word} is gone"));
            }
        }
    }

    fn compare_members(&mut self, path: &str, released: &'s Value, today: &'s Value) {
        for (name, member) in members(released) {
            let path = format!("{path}.{name}");
            match today["properties"].get(name) {
                Some(found) => self.compare(&path, member, found),
                None => self.broken.push(format!("{path} is gone")),
            }
        }
        let (from, to, change) = match self.usage {
            Use::Output => (released, today, "may be absent now"),
            Use::Input => (today, released, "is required now"),
        };
        for name in required(from) {
            if !required(to).contains(&name) {
                self.broken.push(format!("{path}.{name} {change}"));
            }
        }
    }

    /// Compares alternatives: each one of the release must be covered by one of today.
    fn compare_kinds(&mut self, path: &str, released: &'s Value, today: &'s Value) {
        let today = today.as_array().map_or(&[][..], Vec::as_slice);
        for kind in released.as_array().into_iter().flatten() {
            let is_kept = today.iter().any(|other| {
                let mut inner = Comparison {
                    usage: self.usage,
                    roots: self.roots,
                    definitions: self.definitions.clone(),
                    broken: Vec::new(),
                };
                inner.compare(path, kind, other);
                inner.broken.is_empty()
            });
            if !is_kept {
                self.broken
                    .push(format!("{path}: no alternative has all of {kind}"));
            }
        }
    }
}

/// The schema to which a reference leads.
fn resolved<'s>(schema: &'s Value, root: &'s Value) -> &'s Value {
    match schema["$ref"].as_str() {
        Some(name) => root
            .pointer(name.trim_start_matches('#'))
            .unwrap_or(&Value::Null),
        None => schema,
    }
}

fn types(schema: &Value) -> Vec<&str> {
    match &schema["type"] {
        Value::String(one) => vec![one],
        several => texts(several),
    }
}

fn words(schema: &Value) -> Vec<&Value> {
    let words = schema["enum"].as_array().into_iter().flatten();
    words.chain(schema.get("const")).collect()
}

fn members(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    schema["properties"].as_object().into_iter().flatten()
}

fn required(schema: &Value) -> Vec<&str> {
    texts(&schema["required"])
}

fn texts(list: &Value) -> Vec<&str> {
    let items = list.as_array().into_iter().flatten();
    items.filter_map(Value::as_str).collect()
}

/// The unit in brackets at the end of a description.
fn unit(schema: &Value) -> Option<&str> {
    let text = schema["description"].as_str()?.strip_suffix(']')?;
    text.rsplit_once(" [").map(|(_, unit)| unit)
}

/// The schemas in `schemas`, by their file names.
fn schemas() -> Vec<(String, Value)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas");
    let files = fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().path());
    files
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "json")
        })
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, serde_json::from_str(&text).unwrap())
        })
        .collect()
}

fn schema(name: &str) -> Value {
    let schemas = schemas();
    let found = schemas.into_iter().find(|(file, _)| file == name);
    found.unwrap().1
}

fn object<'s>(schema: &'s mut Value, pointer: &str) -> &'s mut Map<String, Value> {
    schema
        .pointer_mut(pointer)
        .unwrap()
        .as_object_mut()
        .unwrap()
}

/// Removes each member of a schema in turn, and passes the rest with the name.
fn without_each_member(whole: &Value, check: impl Fn(&Value, &str)) {
    let mut pointers = vec![String::new()];
    for name in whole["$defs"]
        .as_object()
        .into_iter()
        .flatten()
        .map(|(name, _)| name)
    {
        pointers.push(format!("/$defs/{name}"));
    }
    for pointer in pointers {
        let names = members(whole.pointer(&pointer).unwrap());
        for (name, _) in names {
            let mut rest = whole.clone();
            object(&mut rest, &format!("{pointer}/properties")).remove(name);
            check(&rest, name);
        }
    }
}

#[test]
fn finds_each_removed_member_of_each_schema() {
    for (file, whole) in schemas() {
        for usage in [Use::Output, Use::Input] {
            assert_eq!(broken(&whole, &whole, usage), [""; 0], "{file}");
            without_each_member(&whole, |rest, name| {
                let found = broken(&whole, rest, usage);
                assert!(!found.is_empty(), "{file}: {name} is missed");
                // The other way round it is an addition.
                if usage == Use::Input {
                    return;
                }
                let added = broken(rest, &whole, usage);
                assert_eq!(added, [""; 0], "{file}: {name}");
            });
        }
    }
}

#[test]
fn finds_incompatible_changes_only() {
    type Change = fn(&mut Value);
    let cases: [(&str, &str, Use, Change, bool); 10] = [
        (
            "renamed member",
            "toprise.RunReport.json",
            Use::Output,
            |schema| {
                let members = object(schema, "/properties");
                let digest = members.remove("scenario_digest").unwrap();
                members.insert("digest".to_owned(), digest);
            },
            true,
        ),
        (
            "another type",
            "toprise.RunReport.json",
            Use::Output,
            |schema| schema["properties"]["phi"]["type"] = "string".into(),
            true,
        ),
        (
            "a number that may be null",
            "toprise.RunReport.json",
            Use::Output,
            |schema| schema["properties"]["phi"]["type"] = vec!["number", "null"].into(),
            true,
        ),
        (
            "a member that may be absent",
            "toprise.RunReport.json",
            Use::Output,
            |schema| schema["required"] = Vec::<Value>::new().into(),
            true,
        ),
        (
            "another description",
            "toprise.State.json",
            Use::Output,
            |schema| schema["properties"]["theta"]["description"] = "inclination [rad]".into(),
            false,
        ),
        (
            "another unit",
            "toprise.State.json",
            Use::Output,
            |schema| schema["properties"]["theta"]["description"] = "inclination [deg]".into(),
            true,
        ),
        (
            "a removed law",
            "scenario.json",
            Use::Input,
            |schema| {
                let law = &mut schema["properties"]["friction"]["properties"]["law"];
                law["enum"].as_array_mut().unwrap().pop();
            },
            true,
        ),
        (
            "a further law",
            "scenario.json",
            Use::Input,
            |schema| {
                let law = &mut schema["properties"]["friction"]["properties"]["law"];
                law["enum"].as_array_mut().unwrap().push("dieterich".into());
            },
            false,
        ),
        (
            "a further key",
            "scenario.json",
            Use::Input,
            |schema| {
                object(schema, "/properties").insert("wind".to_owned(), Value::Null);
            },
            false,
        ),
        (
            "a key that is required now",
            "scenario.json",
            Use::Input,
            |schema| schema["required"] = vec!["description"].into(),
            true,
        ),
    ];
    for (name, file, usage, change, is_broken) in cases {
        let released = schema(file);
        let mut today = released.clone();
        change(&mut today);
        assert_ne!(released, today, "{name}");
        let found = broken(&released, &today, usage);
        assert_eq!(!found.is_empty(), is_broken, "{name}: {found:?}");
    }
}

#[test]
fn schemas_of_reports_name_their_version() {
    for (file, text) in toprise::cli::schemas() {
        let schema: Value = serde_json::from_str(&text).unwrap();
        let name = file
            .trim_start_matches("toprise.")
            .trim_end_matches(".json");
        let version = env!("CARGO_PKG_VERSION");
        assert_eq!(schema["$id"], format!("urn:toprise:{version}:{name}"));
    }
}
