//! The architecture described in ARCHITECTURE.md: modules depend only on lower modules, and files have no cycles.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use toprise::telemetry::channels;

/// The modules from the bottom up: each may use those before it. `analysis`, `sweep` and `rerun` are independent.
const ROOMS: &[&[&str]] = &[
    &["physics"],
    &["run"],
    &["telemetry"],
    &["archive"],
    &["analysis", "rerun", "sweep"],
    &["cli"],
];

/// The path of a module below the crate: `["physics", "integrate", "dop853"]`.
type Module = Vec<String>;

/// Every file of `src`, as a module, with the modules of other files that it names.
type Graph = BTreeMap<Module, BTreeSet<Module>>;

#[test]
fn every_room_uses_only_rooms_below_it() {
    let mut edges = 0;
    for (file, used) in graph() {
        for other in used {
            let (Some(from), Some(to)) = (file.first(), other.first()) else {
                continue;
            };
            if from == to {
                continue;
            }
            edges += 1;
            assert!(
                floor(to) < floor(from),
                "{} uses {}, which is not below it",
                name(&file),
                name(&other)
            );
        }
    }
    assert!(edges > 100, "only {edges} uses between rooms are found");
}

#[test]
fn no_files_of_a_room_use_each_other() {
    let graph = graph();
    let knots: Vec<String> = knots(&graph)
        .into_iter()
        .map(|knot| describe(&graph, &knot))
        .collect();
    assert!(
        knots.is_empty(),
        "files that use each other, directly or through others:\n{}",
        knots.join("\n")
    );
}

#[test]
fn plotting_knows_nothing_of_tops() {
    let is_plot = |module: &Module| module.starts_with(&["analysis", "plot"].map(str::to_owned));
    let plot: Vec<_> = graph()
        .into_iter()
        .filter(|(file, _)| is_plot(file))
        .collect();
    assert!(
        plot.len() > 5,
        "only {} files of plotting are found",
        plot.len()
    );
    for (file, used) in plot {
        let other = used.iter().find(|other| !is_plot(other));
        assert_eq!(other, None, "{} uses more than plotting", name(&file));
    }
}

#[test]
fn the_rooms_are_those_of_the_table_in_architecture_md() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let told: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("| `"))
        .filter_map(|rest| rest.split_once("/` |"))
        .map(|(room, _)| room)
        .collect();
    let mut rooms: Vec<&str> = ROOMS.iter().copied().flatten().copied().collect();
    assert!(
        told.iter().all(|room| rooms.contains(room)),
        "ARCHITECTURE.md tells of {told:?}"
    );
    for room in &rooms {
        assert!(told.contains(room), "ARCHITECTURE.md has no row for {room}");
    }
    let mut found: Vec<String> = graph()
        .into_keys()
        .filter_map(|module| module.into_iter().next())
        .collect();
    found.dedup();
    rooms.sort_unstable();
    assert_eq!(found, rooms, "the rooms below src");
}

#[test]
fn topics_are_named_in_the_table_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = BTreeMap::new();
    collect(&root, &mut Vec::new(), &mut sources);
    let tests = test_files(&sources);
    let is_named = |text: &String| channels().iter().any(|info| text.contains(info.topic));
    let mut found = Vec::new();
    for (module, source) in &sources {
        let mut texts: Vec<_> = source.texts.iter().filter(|text| is_named(text)).collect();
        let room = module.first().map(String::as_str);
        let is_table =
            room == Some("telemetry") && module.last().is_some_and(|file| file == "table");
        if is_table {
            assert!(!texts.is_empty(), "{} names no topics", name(module));
            texts.clear();
        }
        if !tests.contains(module) {
            found.extend(texts.iter().map(|text| format!("{}: {text}", name(module))));
        }
    }
    assert!(
        found.is_empty(),
        "{} topics are named outside of the table; use telemetry::fields:\n{}",
        found.len(),
        found.join("\n")
    );
}

fn floor(room: &str) -> usize {
    ROOMS
        .iter()
        .position(|floor| floor.contains(&room))
        .unwrap_or_else(|| panic!("{room} is in no room: add it to ROOMS and ARCHITECTURE.md"))
}

fn name(module: &[String]) -> String {
    format!("src/{}.rs", module.join("/"))
}

fn graph() -> Graph {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = BTreeMap::new();
    collect(&root, &mut Vec::new(), &mut sources);
    let tests = test_files(&sources);
    sources.retain(|module, _| !tests.contains(module));
    let files: BTreeSet<Module> = sources.keys().cloned().collect();
    sources
        .into_iter()
        .filter(|(module, _)| !module.is_empty())
        .map(|(module, source)| {
            let used = source
                .paths
                .iter()
                .filter_map(|path| defining_file(path, &files))
                .filter(|other| *other != module && !other.is_empty())
                .collect();
            (module, used)
        })
        .collect()
}

/// The files that are there for tests alone.
fn test_files(sources: &BTreeMap<Module, Source>) -> BTreeSet<Module> {
    sources
        .iter()
        .flat_map(|(module, source)| source.test_modules.iter().map(|name| child(module, name)))
        .collect()
}

/// What is read of one file.
#[derive(Default)]
struct Source {
    /// Paths into the crate that it names, from the crate's root.
    paths: BTreeSet<Module>,
    /// Files that it declares for its tests alone.
    test_modules: Vec<String>,
    /// Its literals, but for those of tests and documentation.
    texts: Vec<String>,
}

fn collect(directory: &Path, module: &mut Module, sources: &mut BTreeMap<Module, Source>) {
    let mut entries: Vec<_> = fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            module.push(stem);
            collect(&path, module, sources);
            module.pop();
        } else if path.extension().is_some_and(|e| e == "rs") && stem != "main" {
            let mut file = module.clone();
            if stem != "lib" {
                file.push(stem);
            }
            let text = fs::read_to_string(&path).unwrap();
            let tokens: TokenStream = text.parse().unwrap();
            let mut source = Source::default();
            read(tokens.clone(), &file, &mut source);
            literals(tokens, &mut source.texts);
            sources.insert(file, source);
        }
    }
}

/// Reads the tokens of `module`, macros' included, for `mod` declarations and for paths that begin with `crate`,
/// `self`, `super` or, in `use`, with a child module.
fn read(tokens: TokenStream, module: &Module, source: &mut Source) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    let mut is_for_tests = false;
    while at < tokens.len() {
        let word = ident(&tokens[at]);
        match (word.as_deref(), tokens.get(at + 1)) {
            (Some("mod"), Some(name)) if ident(name).is_some() => {
                let inner = child(module, &ident(name).unwrap());
                match tokens.get(at + 2) {
                    Some(TokenTree::Group(body)) => read(body.stream(), &inner, source),
                    _ if is_for_tests => source.test_modules.extend(inner.last().cloned()),
                    _ => {
                        source.paths.insert(inner);
                    }
                }
                at += 3;
                is_for_tests = false;
                continue;
            }
            (Some("use"), Some(_)) => {
                at = tree(&tokens, at + 1, &mut vec![], module, source);
                is_for_tests = false;
                continue;
            }
            (Some("crate" | "self" | "super"), _) if is_colons(&tokens, at + 1) => {
                at = tree(&tokens, at, &mut vec![], module, source);
                continue;
            }
            _ => {}
        }
        if let TokenTree::Group(group) = &tokens[at] {
            if group.delimiter() == Delimiter::Bracket && at > 0 && is_punct(&tokens[at - 1], '#') {
                is_for_tests |= group.stream().to_string().replace(' ', "") == "cfg(test)";
            } else {
                is_for_tests = false;
            }
            read(group.stream(), module, source);
        }
        at += 1;
    }
}

/// Collects the literals that are neither in attributes, as documentation is, nor in test modules.
fn literals(tokens: TokenStream, texts: &mut Vec<String>) {
    let mut after_hash = false;
    let mut is_for_tests = false;
    for token in tokens {
        match &token {
            TokenTree::Group(group) if after_hash && group.delimiter() == Delimiter::Bracket => {
                is_for_tests |= group.stream().to_string().replace(' ', "") == "cfg(test)";
            }
            TokenTree::Group(group) => {
                if !is_for_tests || group.delimiter() != Delimiter::Brace {
                    literals(group.stream(), texts);
                }
                is_for_tests &= group.delimiter() != Delimiter::Brace;
            }
            TokenTree::Literal(literal) => texts.push(literal.to_string()),
            TokenTree::Punct(punct) if punct.as_char() == ';' => is_for_tests = false,
            _ => {}
        }
        after_hash = is_punct(&token, '#') || (after_hash && is_punct(&token, '!'));
    }
}

/// Reads a path or a tree of paths that begins at `at`, and returns where it ends.
fn tree(
    tokens: &[TokenTree],
    mut at: usize,
    path: &mut Vec<String>,
    module: &Module,
    source: &mut Source,
) -> usize {
    if is_colons(tokens, at) {
        return at + 2;
    }
    let length = path.len();
    while let Some(token) = tokens.get(at) {
        if let Some(segment) = ident(token) {
            path.push(segment);
            at += 1;
        } else if let TokenTree::Group(group) = token
            && group.delimiter() == Delimiter::Brace
        {
            let inner: Vec<TokenTree> = group.stream().into_iter().collect();
            let mut next = 0;
            while next < inner.len() {
                next = tree(&inner, next, path, module, source);
                while next < inner.len() && !is_punct(&inner[next], ',') {
                    next += 1;
                }
                next += 1;
            }
            path.truncate(length);
            return at + 1;
        } else {
            at += 1;
            break;
        }
        if is_colons(tokens, at) {
            at += 2;
        } else {
            break;
        }
    }
    source.paths.extend(absolute(path, module));
    path.truncate(length);
    at
}

/// A path from the crate's root. A path that begins with another name is taken for one into a child module.
fn absolute(path: &[String], module: &Module) -> Option<Module> {
    let mut path = path.iter().map(|segment| segment.trim_start_matches("r#"));
    let mut absolute = module.clone();
    match path.next()? {
        "crate" => absolute.clear(),
        "self" => {}
        "super" => {
            absolute.pop();
        }
        other => absolute.push(other.to_owned()),
    }
    for segment in path {
        if segment == "super" {
            absolute.pop();
        } else if segment != "self" {
            absolute.push(segment.to_owned());
        }
    }
    Some(absolute)
}

/// The file that a path leads into: the longest of its beginnings that is one.
fn defining_file(path: &Module, files: &BTreeSet<Module>) -> Option<Module> {
    (0..=path.len())
        .rev()
        .map(|length| path[..length].to_vec())
        .find(|beginning| files.contains(beginning))
}

fn child(module: &Module, name: &str) -> Module {
    let mut child = module.clone();
    child.push(name.to_owned());
    child
}

fn ident(token: &TokenTree) -> Option<String> {
    match token {
        TokenTree::Ident(ident) => Some(ident.to_string()),
        _ => None,
    }
}

fn is_punct(token: &TokenTree, character: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == character)
}

fn is_colons(tokens: &[TokenTree], at: usize) -> bool {
    [at, at + 1]
        .iter()
        .all(|at| tokens.get(*at).is_some_and(|token| is_punct(token, ':')))
}

/// Sets of files each of which reaches all others of its set.
fn knots(graph: &Graph) -> Vec<BTreeSet<Module>> {
    let reach: BTreeMap<&Module, BTreeSet<&Module>> = graph
        .keys()
        .map(|file| (file, reachable(graph, file)))
        .collect();
    let mut knots: Vec<BTreeSet<Module>> = Vec::new();
    for file in graph.keys() {
        let knot: BTreeSet<Module> = reach[file]
            .iter()
            .filter(|other| reach[**other].contains(file))
            .map(|other| (*other).clone())
            .collect();
        if knot.len() > 1 && !knots.contains(&knot) {
            knots.push(knot);
        }
    }
    knots
}

fn reachable<'a>(graph: &'a Graph, from: &Module) -> BTreeSet<&'a Module> {
    let mut seen = BTreeSet::new();
    let mut waiting: Vec<&Module> = graph[from].iter().collect();
    while let Some(file) = waiting.pop() {
        if seen.insert(file)
            && let Some(used) = graph.get(file)
        {
            waiting.extend(used);
        }
    }
    seen
}

fn describe(graph: &Graph, knot: &BTreeSet<Module>) -> String {
    let mut lines = vec![format!("a knot of {} files:", knot.len())];
    for file in knot {
        let others: Vec<String> = graph[file].intersection(knot).map(|f| name(f)).collect();
        lines.push(format!("  {} uses {}", name(file), others.join(", ")));
    }
    lines.join("\n")
}

#[test]
fn every_form_of_use_is_read() {
    let text = "
        mod inner;
        use crate::{a::B, c::{self, d::E}};
        use super::{F, g::H};
        use self::inner::I;
        use inner::{J as K, L};
        use std::fmt;
        use ::serde::Serialize;
        pub(in super::super) fn f() -> crate::m::N { println!(\"{}\", crate::o::p()); super::q::r() }
        mod tests { use super::*; use crate::s::T; }
        #[cfg(test)] mod only_tests;
    ";
    let mut source = Source::default();
    let module = vec!["x".to_owned(), "y".to_owned()];
    read(text.parse().unwrap(), &module, &mut source);
    let paths: BTreeSet<String> = source.paths.iter().map(|path| path.join("::")).collect();
    for path in [
        "x::y::inner",
        "a::B",
        "c",
        "c::d::E",
        "x::F",
        "x::g::H",
        "x::y::inner::I",
        "x::y::inner::J",
        "x::y::inner::L",
        "m::N",
        "o::p",
        "x::q::r",
        "s::T",
        "x::y",
    ] {
        assert!(paths.contains(path), "{path} is missing in {paths:?}");
    }
    assert_eq!(source.test_modules, ["only_tests"]);
}

#[test]
fn literals_of_code_are_read() {
    let text = "
        //! Nor \"/0\".
        /// Not \"/a\".
        #[error(\"/b\")]
        const C: &str = \"/c\";
        #[cfg(test)] mod only_tests;
        mod inner { fn d() { println!(\"/d\") } }
        #[cfg(test)] mod tests { fn e() -> &'static str { \"/e\" } }
        fn f() -> &'static str { \"/f\" }
    ";
    let mut texts = Vec::new();
    literals(text.parse().unwrap(), &mut texts);
    assert_eq!(texts, ["\"/c\"", "\"/d\"", "\"/f\""]);
}
