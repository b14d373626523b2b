//! The graph of the files of `src`: a file depends on another if it names an item of it. Re-exports such as
//! `mod x; pub use x::Item;` are followed to the file of the item.

use std::collections::{BTreeMap, BTreeSet};

/// A path such as `run::scenario::Key`, from the root of the crate.
type Path = Vec<String>;

/// A `use` declaration: its paths, each with the name that it has in the file.
struct Import {
    is_public: bool,
    paths: Vec<(Path, String)>,
}

/// The dependencies of each file.
pub struct FileGraph(BTreeMap<String, BTreeSet<String>>);

impl FileGraph {
    /// Reads the dependencies from the code of each file, by path below `src`.
    pub fn new(code: &BTreeMap<String, String>) -> Self {
        let names = Names::new(code);
        let mut graph = BTreeMap::new();
        for (module, file) in &names.files {
            let (imports, rest) = imports(&code[file]);
            let mut used: Vec<Path> = paths_in(&rest, &names.children(module));
            for import in imports {
                // The parent of a module re-exports its items; users of these depend on the module.
                if !import.is_public {
                    used.extend(import.paths.into_iter().map(|(path, _)| path));
                }
            }
            let mut files = BTreeSet::new();
            for path in used {
                files.extend(names.file_of(&path, module).filter(|other| other != file));
            }
            graph.insert(file.clone(), files);
        }
        Self(graph)
    }

    /// The circles: files each of which depends on all the others, if indirectly.
    pub fn circles(&self) -> BTreeSet<Vec<String>> {
        let mut circles = BTreeSet::new();
        for file in self.0.keys() {
            let mut circle: Vec<String> = self.reached_from(file).into_iter().collect();
            circle.retain(|other| self.reached_from(other).contains(file));
            if !circle.is_empty() {
                circles.insert(circle);
            }
        }
        circles
    }

    /// The files on which a file depends, also indirectly; with itself if it is in a circle.
    fn reached_from(&self, file: &str) -> BTreeSet<String> {
        let mut reached = BTreeSet::new();
        let mut open = vec![file.to_owned()];
        while let Some(file) = open.pop() {
            for used in &self.0[&file] {
                if reached.insert(used.clone()) {
                    open.push(used.clone());
                }
            }
        }
        reached
    }
}

/// The modules and the names that they re-export.
struct Names {
    /// The file of each module.
    files: BTreeMap<Path, String>,
    /// The item that each re-exported name means.
    exports: BTreeMap<Path, Path>,
}

impl Names {
    fn new(code: &BTreeMap<String, String>) -> Self {
        let mut names = Self {
            files: BTreeMap::new(),
            exports: BTreeMap::new(),
        };
        for file in code.keys() {
            names.files.insert(module_of(file), file.clone());
        }
        for (module, file) in names.files.clone() {
            for import in imports(&code[&file]).0 {
                for (path, name) in import.paths {
                    let item = names.absolute(&path, &module).filter(|_| import.is_public);
                    let exported = [module.clone(), vec![name]].concat();
                    names.exports.extend(item.map(|item| (exported, item)));
                }
            }
        }
        names
    }

    /// The names of a module's own modules.
    fn children(&self, module: &Path) -> Vec<String> {
        let mut children = Vec::new();
        for path in self.files.keys() {
            if let Some((name, parent)) = path.split_last()
                && parent == module.as_slice()
            {
                children.push(name.clone());
            }
        }
        children
    }

    /// The path from the root of the crate; `None` if it leads into another crate.
    fn absolute(&self, path: &Path, module: &Path) -> Option<Path> {
        let mut base = module.clone();
        let mut rest = path.as_slice();
        match rest.first()?.as_str() {
            "crate" => return Some(rest[1..].to_vec()),
            "self" => rest = &rest[1..],
            "super" => {
                while rest.first().is_some_and(|name| name == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            child if self.children(module).iter().any(|name| name == child) => {}
            _ => return None,
        }
        base.extend_from_slice(rest);
        Some(base)
    }

    /// The file of the item at a path in a module.
    fn file_of(&self, path: &Path, module: &Path) -> Option<String> {
        let mut item = self.absolute(path, module)?;
        while let Some(original) = self.original(&item) {
            item = original;
        }
        let mut lengths = (0..=item.len()).rev();
        lengths
            .find_map(|length| self.files.get(&item[..length]))
            .cloned()
    }

    /// The path to which a re-export in a path leads, if there is one.
    fn original(&self, item: &Path) -> Option<Path> {
        for length in (1..=item.len()).rev() {
            let (head, rest) = item.split_at(length);
            if self.files.contains_key(head) {
                return None;
            }
            if let Some(original) = self.exports.get(head) {
                return Some([original, rest].concat());
            }
        }
        None
    }
}

/// The module of a file: `run/time.rs` is `run::time`.
fn module_of(file: &str) -> Path {
    match file.trim_end_matches(".rs") {
        "lib" => Path::new(),
        name => name.split('/').map(str::to_owned).collect(),
    }
}

/// The `use` declarations of a file, and the code without them.
fn imports(code: &str) -> (Vec<Import>, String) {
    let mut imports = Vec::new();
    let mut rest = String::new();
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let (is_public, declaration) = split_visibility(line.trim_start());
        let Some(tree) = declaration.strip_prefix("use ") else {
            rest += declaration;
            rest.push('\n');
            continue;
        };
        let mut tree = tree.to_owned();
        while !tree.contains(';') {
            tree += lines.next().unwrap();
        }
        let mut paths = Vec::new();
        expand(tree.split(';').next().unwrap(), &[], &mut paths);
        imports.push(Import { is_public, paths });
    }
    (imports, rest)
}

/// Whether a declaration is public, and what follows its visibility, whose module is no dependency.
fn split_visibility(line: &str) -> (bool, &str) {
    match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => {
            let (_, declaration) = rest.split_once(')').unwrap();
            (true, declaration.trim_start())
        }
        Some(rest) if rest.starts_with(' ') => (true, rest.trim_start()),
        _ => (false, line),
    }
}

/// Adds the paths of a tree such as `a::{b, c::d}`, which stands behind `head`.
fn expand(tree: &str, head: &[String], paths: &mut Vec<(Path, String)>) {
    let tree = tree.trim();
    let (front, branches) = match tree.split_once('{') {
        Some((front, branches)) => (front, Some(&branches[..branches.rfind('}').unwrap()])),
        None => (tree, None),
    };
    let (front, alias) = match front.split_once(" as ") {
        Some((front, alias)) => (front, Some(alias)),
        None => (front, None),
    };
    let mut path = head.to_vec();
    path.extend(segments(front));
    let Some(branches) = branches else {
        let name = alias.map(str::to_owned).or_else(|| path.last().cloned());
        paths.extend(name.map(|name| (path, name)));
        return;
    };
    let mut depth = 0;
    let branches = branches.split(|mark| {
        depth += i32::from(mark == '{') - i32::from(mark == '}');
        mark == ',' && depth == 0
    });
    for branch in branches.filter(|branch| !branch.trim().is_empty()) {
        expand(branch, &path, paths);
    }
}

fn segments(path: &str) -> Path {
    let names = path.split("::").map(str::trim);
    // `a::{self}` is `a`.
    let mut path: Path = names
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect();
    if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
        path.pop();
    }
    path
}

/// The paths in code that begin with `crate`, `super`, `self` or one of these modules.
fn paths_in(code: &str, modules: &[String]) -> Vec<Path> {
    let is_part = |mark: char| mark.is_alphanumeric() || mark == '_' || mark == ':';
    let mut paths = Vec::new();
    for text in code.split(|mark| !is_part(mark)) {
        let path = segments(text);
        if let [first, _, ..] = path.as_slice() {
            let is_own = ["crate", "super", "self"].contains(&first.as_str());
            if is_own || modules.contains(first) {
                paths.push(path);
            }
        }
    }
    paths
}

#[test]
fn finds_the_circles_of_files() {
    let files = [
        ("lib.rs", "mod a;\nmod b;\nmod c;\npub use c::Item;"),
        (
            "a.rs",
            "use crate::b::{Other, self};\npub(in crate::c) fn f() {}",
        ),
        (
            "b.rs",
            "mod inner;\npub use inner::Other;\nfn f() { inner::g() }",
        ),
        ("b/inner.rs", "use super::super::Item;"),
        ("c.rs", "fn f(x: crate::b::Other) {}"),
    ];
    let code = files.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let circles = FileGraph::new(&BTreeMap::from(code)).circles();
    let circle = ["b/inner.rs", "c.rs"].map(str::to_owned).to_vec();
    assert_eq!(circles, BTreeSet::from([circle]));
}
