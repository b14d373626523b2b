//! `toprise laws`.

use super::{Done, Format, format, output};
use crate::run::scenario::{Key, LAWS, Law};
use anyhow::Error;
use serde_json::{Value, json};

/// Lists the laws of friction.
pub(super) fn laws(form: Format) -> Result<Done, Error> {
    output::print(&match form {
        Format::Text => text(),
        Format::Json => format!("{:#}", Value::from_iter(LAWS.iter().map(json))),
    })?;
    Ok(Done::Well)
}

fn text() -> String {
    let (sliding, others): (Vec<_>, Vec<_>) = LAWS.iter().partition(|law| law.is_sliding());
    let paragraphs = |laws: Vec<&Law>| laws.into_iter().map(paragraph).collect::<String>();
    format!(
        "Laws of sliding, as friction.law:\n\n{}What adds to any of them, each by keys of its own:\n\n{}\
         f force, v slip velocity, N normal force, ω angular velocity, ω_⊥ its horizontal part, w_n its part along \
         the\nsymmetry axis n, w_t the rest, M torque about the peg's centre, z′ the vertical, R radius of the peg.\n",
        paragraphs(sliding),
        paragraphs(others)
    )
}

fn paragraph(law: &Law) -> String {
    let mut rows = vec![vec![law.name.to_owned(), law.formula.to_owned()]];
    let mut add = |left: String, right: String| rows.push(vec![format!("  {left}"), right]);
    for key in law.parameters() {
        add(key.path.to_owned(), parameter(key));
    }
    for (name, text) in [("typical", law.typical), ("source", law.source)] {
        if !text.is_empty() {
            add(name.to_owned(), text.to_owned());
        }
    }
    format::table(&rows, &[]) + "\n"
}

fn parameter(key: &Key) -> String {
    let unit = if key.unit.is_empty() {
        String::new()
    } else {
        format!(" [{}]", key.unit)
    };
    format!("{}{unit}: {}", key.meaning, key.kind)
}

fn json(law: &Law) -> Value {
    let parameter = |key: &Key| {
        json!({
            "key": key.path,
            "unit": key.unit,
            "meaning": key.meaning,
            "allowed": key.kind.to_string(),
        })
    };
    json!({
        "name": law.name,
        "adds_to_any": !law.is_sliding(),
        "formula": law.formula,
        "parameters": law.parameters().map(parameter).collect::<Vec<_>>(),
        "typical": law.typical,
        "source": law.source,
    })
}
