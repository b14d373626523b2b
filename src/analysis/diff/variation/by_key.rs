//! The part that each changed key has in the findings.
//!
//! Between A and B, several keys may differ. A is simulated with each change alone, and with each pair of changes, and each
//! finding is evaluated there, at the levels and times that A and B have it at. The part of a change is what it does alone,
//! or on top of others if it is impossible without them: a free peg needs the whole friction. The interaction is what the
//! parts leave of the difference.

use crate::analysis::diff::findings::finding::Finding;
use crate::analysis::diff::findings::measure::measure;
use crate::analysis::diff::findings::quantity::Quantity;
use crate::analysis::diff::setup::KeyDifference;
use crate::run::scenario::Scenario;
use schemars::JsonSchema;
use serde::Serialize;

/// Maximum number of simulations: with more changes, their pairs are left out.
const MAX_RUNS: usize = 40;

/// Keys that say how long and how finely a run is recorded. They are those of B in all runs.
const OF_RECORDING: [&str; 3] = ["stop.duration", "sampling.period", "format"];

/// The parts of the changes in the findings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ByKey {
    /// The changes.
    pub changes: Vec<KeyChange>,
    /// The pairs of changes that are possible alone, by their numbers in `changes`; empty if there are too many.
    pub pairs: Vec<[usize; 2]>,
    /// The findings that differ and that a run alone has.
    pub effects: Vec<Effect>,
}

/// A change of keys.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct KeyChange {
    /// The keys, which can only change together.
    pub keys: Vec<String>,
    /// The keys that must have changed before.
    pub after: Vec<String>,
}

/// The parts of the changes in a finding.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Effect {
    /// The finding.
    #[serde(flatten)]
    pub quantity: Quantity,
    /// The difference B − A.
    pub difference: f64,
    /// Its integration error; absent if it is not known.
    pub integration_error: Option<f64>,
    /// The largest change of it by the phase of the nutation.
    pub nutation_change: f64,
    /// The part of each change; absent where a run of it has no such number.
    pub parts: Vec<Option<f64>>,
    /// The interaction of each pair: what both change together, less their parts.
    pub pairs: Vec<Option<f64>>,
    /// What the parts leave of the difference; absent if one is.
    pub interaction: Option<f64>,
}

/// The runs that tell the parts of the changes.
#[derive(Clone, Debug)]
pub struct KeyPlan {
    a: Scenario,
    /// The changes.
    pub changes: Vec<KeyChange>,
    /// A before and after each change; before is A itself for changes that are possible alone.
    singles: Vec<(Option<Scenario>, Scenario)>,
    pairs: Vec<([usize; 2], Scenario)>,
}

/// A, with the keys of recording of B, and B.
struct Ends {
    a: Scenario,
    b: Scenario,
}

impl Ends {
    /// A with some keys of B, if that is a scenario.
    fn with(&self, keys: &[String]) -> Option<Scenario> {
        let paths = keys.iter().map(String::as_str);
        self.a.with_keys_of(&self.b, paths).ok()
    }
}

impl Effect {
    /// The pair with the largest interaction, if it is above the integration error.
    pub fn largest_pair(&self, by_key: &ByKey) -> Option<([usize; 2], f64)> {
        let pairs = by_key.pairs.iter().zip(&self.pairs);
        let known = pairs.filter_map(|(pair, interaction)| Some((*pair, (*interaction)?)));
        known
            .max_by(|(_, one), (_, other)| one.abs().total_cmp(&other.abs()))
            .filter(|(_, interaction)| self.above_error(*interaction) != 0.0)
    }

    /// Whether a part may be one of the phase of the nutation.
    pub fn is_within_nutation(&self, part: f64) -> bool {
        part.abs() <= self.integration_error.unwrap_or(0.0) + self.nutation_change
    }

    /// A part of the difference, or 0 if it is below the integration error.
    pub fn above_error(&self, part: f64) -> f64 {
        if part.abs() > self.integration_error.unwrap_or(0.0) {
            part
        } else {
            0.0
        }
    }
}

impl KeyPlan {
    /// The runs for two scenarios whose keys differ; `None` if fewer than two changes are possible.
    pub fn new(a: &Scenario, b: &Scenario, differing: &[KeyDifference]) -> Option<Self> {
        let ends = Ends {
            a: a.with_keys_of(b, OF_RECORDING).ok()?,
            b: b.clone(),
        };
        let mut changes = Vec::new();
        for key in differing.iter().filter(|key| key.changes_the_run()) {
            if !OF_RECORDING.contains(&key.key.as_str()) {
                changes.push(vec![key.key.clone()]);
            }
        }
        let changes = possible_changes(&ends, changes)?;
        if changes.len() < 2 {
            return None;
        }
        let mut singles = Vec::new();
        for KeyChange { keys, after } in &changes {
            let before = (!after.is_empty()).then(|| ends.with(after)).flatten();
            singles.push((before, ends.with(&[&after[..], keys].concat())?));
        }
        let mut pairs = Vec::new();
        for (at, second) in changes.iter().enumerate() {
            for (of_first, first) in changes[..at].iter().enumerate() {
                if first.after.is_empty() && second.after.is_empty() {
                    let both = ends.with(&[&first.keys[..], &second.keys].concat());
                    pairs.extend(both.map(|both| ([of_first, at], both)));
                }
            }
        }
        // The only pair of two changes is B.
        if changes.len() == 2 || 2 * singles.len() + pairs.len() > MAX_RUNS {
            pairs.clear();
        }
        Some(Self {
            a: ends.a,
            changes,
            singles,
            pairs,
        })
    }

    /// Number of simulations.
    pub fn runs(&self) -> usize {
        let bases = self.singles.iter().filter(|(base, _)| base.is_some());
        1 + bases.count() + self.singles.len() + self.pairs.len()
    }

    /// Whether pairs of changes are simulated, too.
    pub fn has_pairs(&self) -> bool {
        !self.pairs.is_empty()
    }

    /// Simulates the runs. `count` is called after each.
    pub fn compute(&self, findings: &[Finding], count: &dyn Fn()) -> ByKey {
        let mut wanted = Vec::new();
        for finding in findings.iter().filter(|finding| finding.differs()) {
            wanted.extend(finding.b.map(|b| (finding, b)));
        }
        let quantities: Vec<_> = wanted.iter().map(|(finding, _)| finding.quantity).collect();
        let simulate = |scenario: &Scenario| {
            let numbers = measure(scenario, &quantities);
            count();
            numbers
        };
        let base = simulate(&self.a);
        let mut singles = Vec::new();
        for (before, after) in &self.singles {
            singles.push((before.as_ref().map(simulate), simulate(after)));
        }
        let both: Vec<_> = self.pairs.iter().map(|(_, both)| simulate(both)).collect();
        let pairs: Vec<_> = self.pairs.iter().map(|(pair, _)| *pair).collect();
        let mut effects = Vec::new();
        for (at, (finding, b)) in wanted.into_iter().enumerate() {
            // B's number does not come from a change of A's if A has none.
            let Some(a) = base[at] else { continue };
            let parts: Vec<_> = singles
                .iter()
                .map(|(before, run)| {
                    Some(run[at]? - before.as_ref().map_or(Some(a), |run| run[at])?)
                })
                .collect();
            let of_pairs = pairs
                .iter()
                .zip(&both)
                .map(|([one, other], run)| Some(run[at]? - a - parts[*one]? - parts[*other]?));
            let sum: Option<f64> = parts.iter().copied().sum();
            effects.push(Effect {
                quantity: finding.quantity,
                difference: b - a,
                integration_error: finding.integration_error,
                nutation_change: finding.ripple(),
                pairs: of_pairs.collect(),
                interaction: sum.map(|sum| b - a - sum),
                parts,
            });
        }
        ByKey {
            changes: self.changes.clone(),
            pairs,
            effects,
        }
    }
}

/// Orders changes so that each is possible alone or after earlier ones. Keys that are not are joined. `None` if B itself is
/// not possible.
fn possible_changes(ends: &Ends, mut waiting: Vec<Vec<String>>) -> Option<Vec<KeyChange>> {
    let mut found: Vec<KeyChange> = Vec::new();
    while !waiting.is_empty() {
        let next = waiting
            .iter()
            .enumerate()
            .find_map(|(at, keys)| Some((at, prerequisites(ends, &found, keys)?)));
        if let Some((at, after)) = next {
            let keys = waiting.remove(at);
            found.push(KeyChange { keys, after });
        } else if waiting.len() > 1 {
            let first = waiting.remove(0);
            waiting[0].splice(0..0, first);
        } else {
            return None;
        }
    }
    Some(found)
}

/// The keys after which others can change: none, those of one earlier change, or those of all.
fn prerequisites(ends: &Ends, known: &[KeyChange], keys: &[String]) -> Option<Vec<String>> {
    let all: Vec<String> = known
        .iter()
        .flat_map(|change| change.keys.clone())
        .collect();
    let mut bases = vec![Vec::new()];
    for change in known {
        bases.push([change.after.clone(), change.keys.clone()].concat());
    }
    bases.push(all);
    bases
        .into_iter()
        .find(|base| ends.with(base).is_some() && ends.with(&[base, keys].concat()).is_some())
}
