//! Differences between the specs of two sweeps.

use serde_json::{Map, Value as Json};

/// The first difference between the specs of two sweeps, in words; `None` if they are equal.
pub(in crate::sweep) fn change(before: &Json, now: &Json) -> Option<String> {
    changed("", before, now)
}

fn changed(path: &str, before: &Json, now: &Json) -> Option<String> {
    match (before, now) {
        (Json::Object(old), Json::Object(new)) => {
            let mut names: Vec<_> = new.keys().chain(old.keys()).collect();
            // Last, because the number of runs follows from the others.
            names.sort_by_key(|name| *name == "runs");
            let differing = names.into_iter().find_map(|name| {
                let inner = format!("{path}.{name}");
                changed(
                    inner.trim_start_matches('.'),
                    &member(old, name),
                    &member(new, name),
                )
            });
            // The order counts: the last axis of a grid varies fastest.
            let is_same = old.keys().eq(new.keys());
            differing.or_else(|| (!is_same).then(|| format!("the order of {path}")))
        }
        (Json::Array(old), Json::Array(new)) if old.len() == new.len() => {
            let mut pairs = old.iter().zip(new).enumerate();
            pairs.find_map(|(i, (old, new))| changed(&format!("{path}[{i}]"), old, new))
        }
        (Json::Array(old), Json::Array(new)) => {
            let (in_file, here) = (old.len(), new.len());
            Some(format!(
                "{path} has {in_file} entries in the file, {here} here"
            ))
        }
        (old, new) if old == new => None,
        (Json::Null, new) => Some(format!("{path} = {new} is not in the file")),
        (old, Json::Null) => Some(format!("{path} = {old} is missing here")),
        (old, new) => Some(format!("{path} is {old} in the file, {new} here")),
    }
}

/// A member of an object; null if it has none of this name.
fn member(object: &Map<String, Json>, name: &str) -> Json {
    object.get(name).cloned().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::spec::Spec;
    use crate::sweep::spec::axis::Axis;
    use crate::sweep::spec::base::Base;
    use crate::sweep::spec::design::Design;
    use std::path::Path;

    fn paper() -> Vec<Base> {
        vec![Base::open("paper", Path::new("."), &[]).unwrap()]
    }

    fn grid(axes: &[(&str, &str)]) -> Spec {
        let axes = axes
            .iter()
            .map(|(key, text)| Axis::parse(key, text).unwrap());
        Spec::new(paper(), Design::Grid(axes.collect()), None).unwrap()
    }

    #[test]
    fn names_the_first_difference() {
        let before = grid(&[("friction.k", "0.1,0.2")]).to_json();
        let message = |axes: &[(&str, &str)]| change(&before, &grid(axes).to_json());
        assert_eq!(message(&[("friction.k", "0.1,0.2")]), None);
        assert_eq!(
            message(&[("friction.k", "0.1,0.3")]).unwrap(),
            "over.friction.k is \"0.1,0.2\" in the file, \"0.1,0.3\" here"
        );
        assert_eq!(
            message(&[]).unwrap(),
            "over.friction.k = \"0.1,0.2\" is missing here"
        );
        let set = [("top.mass".to_owned(), "0.2".to_owned())];
        let bases = vec![Base::open("paper", Path::new("."), &set).unwrap()];
        let axes = vec![Axis::parse("friction.k", "0.1,0.2").unwrap()];
        let heavier = Spec::new(bases, Design::Grid(axes), None).unwrap();
        assert_eq!(
            change(&before, &heavier.to_json()).unwrap(),
            "bases[0].scenario.top.mass is 0.11 in the file, 0.2 here"
        );
    }
}
