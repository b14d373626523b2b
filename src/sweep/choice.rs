//! Which runs of a sweep are recorded: those whose rows fulfil some comparisons.

use super::axis::column_name;
use super::error::SweepError;
use super::part::Sweep;
use super::reading::{Columns, plain};
use super::spec::Spec;
use crate::run::scenario::Kind;
use crate::run::simulation::StopReason;
use arrow_schema::DataType;
use std::path::Path;

/// The column that says why a row has no outcome: such a row is never chosen.
const ERROR: &str = "error";

/// The reasons to stop that leave no outcome.
const WITHOUT_OUTCOME: [StopReason; 2] = [StopReason::Interrupted, StopReason::Failed];

/// The signs of comparisons. What begins with another one stands before it.
const RELATIONS: [(&str, Relation); 7] = [
    ("<=", Relation::AtMost),
    (">=", Relation::AtLeast),
    ("==", Relation::Equal),
    ("!=", Relation::Unequal),
    ("<", Relation::Less),
    (">", Relation::Greater),
    ("=", Relation::Equal),
];

/// Which runs are chosen: those with an outcome whose rows fulfil all conditions, or the first of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    conditions: Vec<Condition>,
    /// The most runs that are chosen; all if there is none.
    pub(super) most: Option<u64>,
}

/// A comparison of a row's cell with a value.
#[derive(Clone, Debug, PartialEq)]
struct Condition {
    column: String,
    relation: Relation,
    value: Value,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    Less,
    AtMost,
    Greater,
    AtLeast,
    Equal,
    Unequal,
}

#[derive(Clone, Debug, PartialEq)]
enum Value {
    Null,
    Number(f64),
    Word(String),
}

impl Choice {
    /// The runs that a sweep's spec asks to be recorded; none if it asks for none.
    ///
    /// # Errors
    /// As [`Choice::parse`].
    pub fn of(sweep: &Sweep) -> Result<Option<Self>, SweepError> {
        let Spec { keep, record, .. } = sweep.spec();
        let is_asked = !keep.is_empty() || record.is_some();
        is_asked
            .then(|| Self::parse(keep, *record, sweep))
            .transpose()
    }

    /// Reads conditions such as `rise_time > 30`, `stop_reason = fallen` and `weak_time = null`, which compare a column of the
    /// sweep's table, or a key that varies, with a number, a word or null.
    ///
    /// # Errors
    /// [`SweepError::Spec`] for what is no comparison, a column that isn't there, and a value that can't stand in it.
    pub fn parse(
        conditions: &[String],
        most: Option<u64>,
        sweep: &Sweep,
    ) -> Result<Self, SweepError> {
        let parse = |text: &String| {
            let condition = Condition::parse(text, sweep);
            condition.map_err(|reason| SweepError::Spec(format!("keep {text:?}: {reason}")))
        };
        let conditions = conditions.iter().map(parse);
        Ok(Self {
            conditions: conditions.collect::<Result<_, _>>()?,
            most,
        })
    }

    /// Gives the numbers of the chosen rows of a table or part to `take`, in order, until it has enough.
    ///
    /// # Errors
    /// [`SweepError::Table`] if it can't be read.
    pub(super) fn each(
        &self,
        table: &Path,
        mut take: impl FnMut(u64) -> bool,
    ) -> Result<(), SweepError> {
        let mut names = vec!["run", ERROR];
        names.extend(self.conditions.iter().map(|c| c.column.as_str()));
        for rows in Columns::pieces(table, &names)? {
            let rows = rows?;
            let errors = rows.texts(ERROR)?;
            let mut is_chosen: Vec<bool> = errors.iter().map(Option::is_none).collect();
            for condition in &self.conditions {
                let fulfilled = condition.fulfilled(&rows)?;
                for (is_chosen, is_fulfilled) in is_chosen.iter_mut().zip(fulfilled) {
                    *is_chosen &= is_fulfilled;
                }
            }
            let runs = rows.numbers("run")?.into_iter().zip(is_chosen);
            for (run, _) in runs.filter(|(_, is_chosen)| *is_chosen) {
                if !take(run as u64) {
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}

impl Condition {
    fn parse(text: &str, sweep: &Sweep) -> Result<Self, String> {
        let (name, rest) = text.split_at(text.find(['<', '>', '=', '!']).ok_or(FORM)?);
        let sign = RELATIONS.iter().find(|(sign, _)| rest.starts_with(sign));
        let (sign, relation) = *sign.ok_or(FORM)?;
        let word = rest[sign.len()..].trim();
        let column = plain(name.trim());
        if column.is_empty() {
            return Err(FORM.to_owned());
        }
        let schema = sweep.schema();
        let columns = schema.fields().iter().filter(|field| field.name() != ERROR);
        let Some(field) = columns.clone().find(|field| *field.name() == column) else {
            let names: Vec<&str> = columns.map(|field| field.name().as_str()).collect();
            return Err(format!(
                "there is no column {}; there are {}",
                name.trim(),
                names.join(", ")
            ));
        };
        let value = if field.data_type() == &DataType::Utf8 {
            word_of(&column, word, sweep)?
        } else {
            number_of(&column, word)?
        };
        let has_order = matches!(value, Value::Number(_));
        if !has_order && !matches!(relation, Relation::Equal | Relation::Unequal) {
            return Err(format!("{word} is compared by = or != alone"));
        }
        Ok(Self {
            column,
            relation,
            value,
        })
    }

    /// Whether each row fulfils this.
    fn fulfilled(&self, rows: &Columns) -> Result<Vec<bool>, SweepError> {
        Ok(match &self.value {
            Value::Number(number) => {
                let numbers = rows.numbers(&self.column)?.into_iter();
                numbers
                    .map(|cell| !cell.is_nan() && self.relation.holds(&cell, number))
                    .collect()
            }
            Value::Word(word) => {
                let cells = rows.texts(&self.column)?.into_iter();
                cells
                    .map(|cell| cell.is_some_and(|cell| self.relation.holds(&cell, word)))
                    .collect()
            }
            Value::Null => {
                let cells = rows.texts(&self.column)?.into_iter();
                cells
                    .map(|cell| self.relation.holds(&cell.is_none(), &true))
                    .collect()
            }
        })
    }
}

impl Relation {
    fn holds<T: PartialOrd + ?Sized>(self, cell: &T, value: &T) -> bool {
        match self {
            Self::Less => cell < value,
            Self::AtMost => cell <= value,
            Self::Greater => cell > value,
            Self::AtLeast => cell >= value,
            Self::Equal => cell == value,
            Self::Unequal => cell != value,
        }
    }
}

/// What a condition looks like.
const FORM: &str = "a condition is a column, one of < <= > >= = !=, and a number, a word or null, \
                    as in 'rise_time > 30'; each condition is given by itself";

/// The value that a condition on a column of words compares with.
fn word_of(column: &str, word: &str, sweep: &Sweep) -> Result<Value, String> {
    let word = word.trim_matches(['"', '\'']);
    let may_be_null = column != "scenario";
    if word == "null" && may_be_null {
        return Ok(Value::Null);
    }
    let owned = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
    let known: Vec<String> = match column {
        "stop_reason" => stops(),
        "scenario" => sweep.spec().bases().map(|base| base.name.clone()).collect(),
        _ => {
            let mut keys = sweep.spec().keys().iter();
            match keys.find(|key| column_name(key) == column) {
                Some(key) if let Kind::Choice(words) = key.kind => owned(words),
                _ => owned(&[word]),
            }
        }
    };
    if word.is_empty() || !known.iter().any(|known| known == word) {
        let words = known.join(", ");
        let or_null = if may_be_null { ", or null" } else { "" };
        return Err(format!(
            "{column} is never {word:?}; it is one of {words}{or_null}"
        ));
    }
    Ok(Value::Word(word.to_owned()))
}

/// Why a run with an outcome can have stopped, by name.
fn stops() -> Vec<String> {
    let all = StopReason::ALL.into_iter();
    let with_outcome = all.filter(|stop| !WITHOUT_OUTCOME.contains(stop));
    with_outcome.map(|stop| stop.name().to_owned()).collect()
}

/// The value that a condition on a column of numbers compares with.
fn number_of(column: &str, word: &str) -> Result<Value, String> {
    if word == "null" {
        return Ok(Value::Null);
    }
    match word.parse() {
        Ok(number) if f64::is_finite(number) => Ok(Value::Number(number)),
        _ => Err(format!(
            "{column} holds numbers, and {word:?} is neither a finite number nor null; each condition is given by itself"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::super::axis::Axis;
    use super::super::spec::{Base, Design};
    use super::*;

    fn sweep() -> Sweep {
        let bases = ["paper", "viscous"].map(|name| Base::open(name, Path::new(""), &[]).unwrap());
        let axes = [
            ("friction.k", "0.1,0.2"),
            ("friction.dissipation", "full,tilt-torque-only"),
        ];
        let axes = axes.map(|(key, text)| Axis::parse(key, text).unwrap());
        Sweep::new(Spec::new(bases.to_vec(), Design::Grid(axes.to_vec()), None).unwrap())
    }

    fn parsed(text: &str) -> Result<Condition, String> {
        Condition::parse(text, &sweep())
    }

    #[test]
    fn conditions_compare_columns_with_values() {
        for (text, column, relation, value) in [
            (
                "rise_time > 30",
                "rise_time",
                Relation::Greater,
                Value::Number(30.0),
            ),
            (
                "friction.k<=1e-1",
                "friction_k",
                Relation::AtMost,
                Value::Number(0.1),
            ),
            (
                "theta_dot>=-.5",
                "theta_dot",
                Relation::AtLeast,
                Value::Number(-0.5),
            ),
            ("hops == null", "hops", Relation::Equal, Value::Null),
            ("run < 7", "run", Relation::Less, Value::Number(7.0)),
            ("loops != 0", "loops", Relation::Unequal, Value::Number(0.0)),
            (
                "stop_reason = fallen",
                "stop_reason",
                Relation::Equal,
                Value::Word("fallen".to_owned()),
            ),
            (
                "scenario != \"viscous\"",
                "scenario",
                Relation::Unequal,
                Value::Word("viscous".to_owned()),
            ),
            (
                "friction_dissipation=full",
                "friction_dissipation",
                Relation::Equal,
                Value::Word("full".to_owned()),
            ),
        ] {
            let column = column.to_owned();
            let expected = Condition {
                column,
                relation,
                value,
            };
            assert_eq!(parsed(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_condition_says_what_one_is() {
        for (text, part) in [
            ("", "a condition is a column"),
            ("rise_time", "a condition is a column"),
            ("= 1", "a condition is a column"),
            ("rise_time ! 3", "a condition is a column"),
            (
                "risetime > 30",
                "there is no column risetime; there are run, scenario, friction_k, ",
            ),
            ("friction.mu > 30", "there is no column friction.mu"),
            // A key that doesn't vary has no column.
            ("top.mass > 1", "there is no column top.mass"),
            ("error = null", "there is no column error"),
            ("rise_time > late", "is neither a finite number nor null"),
            (
                "rise_time > 30 and loops > 0",
                "each condition is given by itself",
            ),
            ("rise_time >", "is neither a finite number nor null"),
            ("rise_time > inf", "is neither a finite number nor null"),
            ("rise_time =< 30", "is neither a finite number nor null"),
            ("rise_time > null", "compared by = or != alone"),
            ("stop_reason > fallen", "compared by = or != alone"),
            (
                "stop_reason = felled",
                "it is one of risen, fallen, duration",
            ),
            (
                "stop_reason = interrupted",
                "it is one of risen, fallen, duration",
            ),
            (
                "stop_reason = failed",
                "it is one of risen, fallen, duration",
            ),
            (
                "friction.dissipation = some",
                "it is one of full, without-nutation-part",
            ),
            ("scenario_digest =", "is never \"\""),
        ] {
            let told = parsed(text).unwrap_err();
            assert!(told.contains(part), "{text}: {told}");
        }
    }

    /// What the table has in each row is not called null.
    #[test]
    fn every_run_has_a_scenario() {
        for (text, told) in [
            (
                "scenario = stribeck",
                "scenario is never \"stribeck\"; it is one of paper, viscous",
            ),
            (
                "scenario != null",
                "scenario is never \"null\"; it is one of paper, viscous",
            ),
        ] {
            assert_eq!(parsed(text), Err(told.to_owned()));
        }
        assert!(parsed("stop_reason = null").is_ok());
    }

    /// Each reason by name, so that the compiler asks for a new one here.
    #[test]
    fn every_reason_to_stop_can_be_asked_for_unless_it_leaves_no_outcome() {
        use StopReason::*;
        for stop in StopReason::ALL {
            let leaves_outcome = match stop {
                Risen | Fallen | Duration | SlipStopped | Rest | Singular | Jam | Pivot => true,
                Interrupted | Failed => false,
            };
            let is_known = stops().iter().any(|name| name == stop.name());
            assert_eq!(is_known, leaves_outcome, "{stop:?}");
        }
        assert_eq!(stops().len() + WITHOUT_OUTCOME.len(), StopReason::ALL.len());
    }
}
