//! Scenarios: reading, checking, writing.

use crate::support::{assert_contains, scenario};
use proptest::prelude::*;
use toprise::run::scenario::{
    Allowed, ApplicableKey, KEYS, Kind, PRESETS, Preset, Scenario, ScenarioError, Value, Values,
};

fn scenario_error(preset: &str, overrides: &[(&str, &str)]) -> ScenarioError {
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for (key, value) in overrides {
        if let Err(error) = values.set(key, value) {
            return error;
        }
    }
    Scenario::new(values).expect_err("accepted")
}

fn error(preset: &str, overrides: &[(&str, &str)]) -> String {
    scenario_error(preset, overrides).to_string()
}

/// The key of a list that has this path.
fn applicable(keys: &[ApplicableKey], path: &str) -> Option<ApplicableKey> {
    keys.iter().find(|item| item.key.path == path).cloned()
}

#[test]
fn canonical_form_of_presets_round_trips() {
    for preset in PRESETS.iter() {
        let scenario = preset.scenario().unwrap();
        assert_eq!(scenario.name(), preset.name);
        assert!(!scenario.description().is_empty());
        let text = scenario.to_toml();
        let back = Scenario::from_toml(&text).unwrap();
        assert_eq!(back, scenario);
        assert_eq!(back.to_toml(), text);
        assert_eq!(back.digest(), scenario.digest());
    }
}

#[test]
fn digest_ignores_the_name() {
    let paper = scenario("paper", &[]);
    let renamed = scenario("paper", &[("name", "other")]);
    assert_eq!(paper.digest(), renamed.digest());
    let other = scenario("paper", &[("friction.k", "0.0300001")]);
    assert_ne!(paper.digest(), other.digest());
}

#[test]
fn errors_name_key_value_and_allowed_values() {
    // Overrides, and the parts of the message.
    for (overrides, parts) in [
        ("top.mass=-1", "top.mass | -1 | from 1e-30"),
        ("top.mass=0", "top.mass | 0 | from 1e-30"),
        (
            "top.transverse_moment=-1e-5",
            "top.transverse_moment | from 1e-30",
        ),
        ("top.peg_radius=0", "top.peg_radius | from 1e-15"),
        ("top.mass=inf", "top.mass | inf | from 1e-30"),
        ("initial.phi=nan", "initial.phi | NaN | finite"),
        ("top.mass=heavy", "top.mass | heavy | number"),
        ("top.mass=\"0.1\"", "top.mass | number"),
        ("friction.law=1", "friction.law | 1 | coulomb"),
        ("friction.law=glue", "friction.law | glue | none, coulomb"),
        (
            "friction.dissipation=half",
            "friction.dissipation | half | spin-term-only",
        ),
        (
            "top.axial_moment=2e-4",
            "top.axial_moment | 2e-4 | 1.704e-4",
        ),
        ("top.axial_moment=1e-4", "top.axial_moment | centre of mass"),
        ("initial.theta=0", "initial.theta | body"),
        ("initial.theta=3.2", "initial.theta | 3.2 | 3.14159"),
        (
            "integrator.relative_tolerance=0",
            "integrator.relative_tolerance | 1e-14",
        ),
        (
            "integrator.absolute_tolerance=-1e-9",
            "integrator.absolute_tolerance | 1e-18",
        ),
        ("sampling.period=0", "sampling.period | nanoseconds"),
        ("sampling.period=1.5e-9", "sampling.period | nanoseconds"),
        ("sampling.period=-0.001", "sampling.period | nanoseconds"),
        ("top.colour=1", "top.colour | top.mass"),
        ("frction.k=1", "frction.k | friction.k"),
        ("top.mass=", "top.mass | missing"),
        ("name=a/b", "name | a/b | letters"),
        ("name=..", "name | beginning"),
        ("friction.law=none", "friction.k | none"),
        ("friction.k=", "friction.k | missing"),
        (
            "stop.theta_risen=0.6",
            "stop.theta_risen | 0.6 | initial.theta",
        ),
        (
            "stop.theta_fallen=0.4",
            "stop.theta_fallen | 0.4 | initial.theta",
        ),
        (
            "stop.duration= stop.theta_risen= stop.theta_fallen=",
            "never stop",
        ),
        ("friction.k=0 stop.duration=", "never stop"),
        (
            "friction.dissipation=spin-term-only stop.theta_risen=",
            "friction.dissipation | stop.theta_risen",
        ),
        ("sampling.period=1e-9", "sampling.period | 4294967295"),
        (
            "friction.law=coulom-sqrt",
            "coulom-sqrt | did you mean coulomb-sqrt? | stribeck",
        ),
        (
            "friction.smoothing_sped=0.1",
            "did you mean friction.smoothing_speed?",
        ),
        ("roling.arm=1", "did you mean rolling.arm?"),
        (
            "psi_dot=1",
            "unknown key psi_dot (did you mean initial.psi_dot?)",
        ),
        ("kk=1", "did you mean friction.k or drilling.k?"),
        ("duratio=1", "did you mean stop.duration?"),
        (
            "foo=1",
            "unknown key foo; allowed: format | friction.k | stop.duration",
        ),
        ("friction.foo=1", "allowed: friction.law"),
        ("friction.law=viscous", "friction.viscous_speed | missing"),
        (
            "friction.viscous_speed=1",
            "friction.viscous_speed | does not apply | coulomb",
        ),
        (
            "friction.law=viscous friction.viscous_speed=0",
            "friction.viscous_speed | 0 | 1e-9",
        ),
        ("rolling.arm=-1e-4", "rolling.arm | -1e-4 | 0 to 1"),
        ("air.axial=nan", "air.axial | NaN"),
        ("drilling.k=0.1", "drilling.patch_radius | missing"),
        ("drilling.patch_radius=0.001", "drilling.k | missing"),
        (
            "friction.law=contensou friction.patch_radius=1e-4 drilling.k=0.1 drilling.patch_radius=1e-4",
            "drilling.k | contensou | already includes",
        ),
        (
            "stop.on_stick=continue",
            "stop.on_stick | friction.dissipation | full",
        ),
        (
            "friction.dissipation=full stop.on_stick=continue stop.duration=",
            "stop.on_stick | stop.duration",
        ),
        ("stop.on_stick=wait", "stop.on_stick | continue"),
    ] {
        let pairs = overrides
            .split(' ')
            .map(|pair| pair.split_once('=').unwrap());
        let message = error("paper", &pairs.collect::<Vec<_>>());
        for part in parts.split(" | ") {
            assert!(
                message.contains(part),
                "{overrides}: {part:?} is not in {message:?}"
            );
        }
    }
}

#[test]
fn rejects_invalid_files() {
    let paper = Preset::find("paper").unwrap().scenario().unwrap().to_toml();
    let broken = |from: &str, to: &str| {
        assert!(paper.contains(from), "{from}");
        Scenario::from_toml(&paper.replace(from, to)).unwrap_err()
    };
    for (from, to, error) in [
        ("[top]", "[top", "not valid TOML: "),
        (
            "mass =",
            "mas =",
            "unknown key top.mas (did you mean top.mass?)",
        ),
        (
            "[top]",
            "[tip]",
            "unknown key tip.mass (did you mean top.mass?)",
        ),
        (
            "mass = 0.11",
            "mass = [0.11]",
            "top.mass = [0.11]: must be ",
        ),
        ("mass = 0.11", "", "missing: top.mass ("),
        ("toprise-1", "toprise-2", "format = toprise-2: must be "),
    ] {
        let text = broken(from, to).to_string();
        assert!(text.starts_with(error), "{text}");
    }
    let text = Scenario::from_toml("").unwrap_err().to_string();
    assert!(text.starts_with("missing: name ("), "{text}");
}

#[test]
fn errors_suggest_a_remedy() {
    for (changes, parts) in [
        (
            &[("friction.law", "stribeck")][..],
            &[
                "friction.static_k (",
                "friction.stribeck_speed (slip speed v_s around which static friction drops to kinetic friction [m/s]: a number from 1e-9",
                "typical values: k_s/k",
            ][..],
        ),
        (
            &[("support.kind", "free"), ("stop.duration", "")],
            &["formulation = \"body\", friction.dissipation = \"full\", stop.duration"],
        ),
        (
            &[("support.restitution", "0.5")],
            &[
                "does not apply without support.kind: set support.kind = free, or remove support.restitution",
            ],
        ),
        (
            &[("friction.viscous_speed", "0.5")],
            &["with friction.law = \"coulomb\": set friction.law = viscous"],
        ),
        (&[("name", &"x".repeat(101))], &["at most 100 letters"]),
        (&[("initial.theta", "30deg")], &["(30deg is 0.5236 rad)"]),
        (
            &[("initial.theta", "0,03")],
            &["with a decimal point, e.g. 0.03"],
        ),
        (&[("initial.theta", "30 °")], &["is 0.5236 rad)"]),
    ] {
        let error = error("paper", changes);
        for part in parts {
            assert_contains(&error, part);
        }
    }
}

#[test]
fn accepts_whole_numbers_and_unquoted_words() {
    let changes = [
        ("gravity", "10"),
        ("formulation", "body"),
        ("description", "no quotes = needed"),
    ];
    let scenario = scenario("paper", &changes);
    assert_eq!(scenario.model.top.gravity, 10.0);
    assert_eq!(scenario.description(), "no quotes = needed");
    assert_eq!(Scenario::from_toml(&scenario.to_toml()).unwrap(), scenario);
}

proptest! {
    #[test]
    fn numbers_round_trip_bit_for_bit(phi in -1e9..1e9_f64, psi_dot in -1e6..1e6_f64, ns in 1_u64..3_600_000_000_000) {
        let period = ns as f64 / 1e9;
        let original = scenario("paper", &[
            ("initial.phi", &format!("{phi:?}")),
            ("initial.psi_dot", &format!("{psi_dot:?}")),
            ("sampling.period", &format!("{period:?}")),
            ("stop.duration", ""),
        ]);
        prop_assert_eq!(original.sample_period_ns, ns);
        let back = Scenario::from_toml(&original.to_toml()).unwrap();
        prop_assert_eq!(back.angles.phi.to_bits(), phi.to_bits());
        prop_assert_eq!(back, original);
    }

    #[test]
    fn arbitrary_text_does_not_panic(text in "\\PC*", key in 0..KEYS.len(), value in "\\PC{0,12}") {
        let _ = Values::from_toml(&text);
        let _ = Scenario::from_toml(&text);
        let mut values = Preset::find("paper").unwrap().values().unwrap();
        if values.set(KEYS[key].path, &value).is_ok() && !value.is_empty() {
            match (KEYS[key].kind.is_text(), values.get(KEYS[key].path)) {
                (true, Some(Value::Text(_))) | (false, Some(Value::Number(_))) => {}
                (_, other) => prop_assert!(false, "{other:?}"),
            }
            if let Ok(scenario) = Scenario::new(values) {
                prop_assert_eq!(Scenario::from_toml(&scenario.to_toml()).unwrap(), scenario);
            }
        }
        if KEYS[key].kind == Kind::Text {
            prop_assert!(value.is_empty() || Values::default().set(KEYS[key].path, &value).is_ok());
        }
    }
}

#[test]
fn errors_truncate_long_values() {
    let long = "x".repeat(10_000_000);
    for text in [
        long.clone(),
        format!("name = {long}"),
        format!("name = \"{long}\""),
        format!("{long} = 1"),
        format!("gravity = \"{long}\""),
        format!("formulation = \"{long}\""),
        format!("gravity = 1\n[top]\nmass = \"{long}"),
    ] {
        let error = Values::from_toml(&text).unwrap_err().to_string();
        assert!(error.len() < 2000, "{} bytes", error.len());
    }
    let error = Values::from_toml(&format!("gravity = 1\nname = {long}")).unwrap_err();
    assert_contains(&error.to_string(), "line 2");
}

#[test]
fn errors_print_numbers_in_short_form() {
    for (key, value, message) in [
        (
            "top.axial_moment",
            "1e300",
            "top.axial_moment = 1e300: must be",
        ),
        (
            "initial.psi_dot",
            "-3e200",
            "initial.psi_dot = -3e200: must be",
        ),
        ("friction.k", "-0.25", "friction.k = -0.25: must be"),
        ("top.mass", "-1", "top.mass = -1: must be"),
        ("top.mass", "-1e-30", "top.mass = -1e-30: must be"),
        ("top.mass", "0", "top.mass = 0: must be"),
        ("initial.psi_dot", "1e15", "initial.psi_dot = 1e15: must be"),
        (
            "initial.psi_dot",
            "12345678",
            "initial.psi_dot = 12345678: must be",
        ),
        ("top.mass", "-0.001", "top.mass = -0.001: must be"),
        (
            "top.mass",
            "1e31",
            "top.mass = 1e31: must be a number from 1e-30 to 1e30 [kg]",
        ),
        (
            "top.mass",
            "1",
            "top.transverse_moment = 8.52e-5: must be more than 4e-4 kg m²",
        ),
        (
            "top.center_distance",
            "-1",
            "top.center_distance = -1: must be a finite number > 0",
        ),
    ] {
        let mut values = Preset::find("paper").unwrap().values().unwrap();
        let error = values.set(key, value).err();
        let error = error.unwrap_or_else(|| Scenario::new(values).unwrap_err());
        assert!(error.to_string().starts_with(message), "{error}");
    }
}

#[test]
fn with_changes_single_keys() {
    let paper = Preset::find("paper").unwrap().scenario().unwrap();
    let changed = paper
        .with([
            ("friction.k", 0.02.into()),
            ("friction.dissipation", "full".into()),
        ])
        .unwrap();
    let same = scenario(
        "paper",
        &[("friction.k", "0.02"), ("friction.dissipation", "full")],
    );
    assert_eq!(changed, same);
    assert!(
        paper
            .with([("friction.dissipation", "half".into())])
            .is_err()
    );
    assert!(paper.with([("friction.law", "none".into())]).is_err());
}

#[test]
fn errors_have_the_key_and_the_value_as_fields() {
    for (case, preset, overrides, key, value) in [
        (
            "range",
            "paper",
            "top.mass=-1",
            Some("top.mass"),
            Some("-1"),
        ),
        (
            "word",
            "paper",
            "friction.law=glue",
            Some("friction.law"),
            Some("glue"),
        ),
        (
            "unknown key",
            "paper",
            "top.colour=1",
            Some("top.colour"),
            None,
        ),
        ("missing", "paper", "friction.k=", Some("friction.k"), None),
        (
            "first of two",
            "paper",
            "friction.law=stribeck",
            Some("friction.static_k"),
            None,
        ),
        (
            "inapplicable",
            "paper",
            "friction.law=none",
            Some("friction.k"),
            None,
        ),
        (
            "body",
            "paper",
            "top.mass=1",
            Some("top.transverse_moment"),
            Some("8.52e-5"),
        ),
        (
            "free peg",
            "paper",
            "support.kind=free",
            Some("support.kind"),
            Some("free"),
        ),
        (
            "tippe top",
            "tippe-top",
            "stop.theta_risen=0.01",
            Some("stop.theta_risen"),
            Some("0.01"),
        ),
        (
            "stop",
            "paper",
            "stop.theta_risen=0.6",
            Some("stop.theta_risen"),
            Some("0.6"),
        ),
        (
            "whole scenario",
            "frictionless",
            "stop.duration=",
            None,
            None,
        ),
    ] {
        let (path, text) = overrides.split_once('=').unwrap();
        let error = scenario_error(preset, &[(path, text)]);
        assert_eq!(error.key.as_deref(), key, "{case}: {error}");
        assert_eq!(error.value.as_deref(), value, "{case}: {error}");
    }
    let syntax = Values::from_toml("[top").unwrap_err();
    assert_eq!(syntax.key, None, "{syntax}");
}

/// The neighbour of a number in the direction of another: by one nanosecond for times.
fn beyond(end: f64, towards: f64, kind: Kind) -> f64 {
    match kind {
        Kind::Nanoseconds => ((end * 1e9).round() + (towards - end).signum()) / 1e9,
        _ if towards > end => end.next_up(),
        _ => end.next_down(),
    }
}

fn accepts(values: &Values, path: &str, value: impl Into<toml::Value>) -> bool {
    let mut changed = values.clone();
    changed.set_value(path, value).is_ok() && Scenario::new(changed).is_ok()
}

#[test]
fn offered_ranges_end_where_values_are_refused() {
    for preset in PRESETS.iter() {
        let values = preset.values().unwrap();
        for ApplicableKey { key, allowed, .. } in values.applicable_keys() {
            let Allowed::Range([low, high]) = allowed else {
                continue;
            };
            // Drilling friction needs two keys; its range is tried with both.
            let mut values = values.clone();
            if key.path == "drilling.k" && values.get("drilling.patch_radius").is_none() {
                values.set("drilling.patch_radius", "0.001").unwrap();
            }
            let case = format!("{}: {} from {low:?} to {high:?}", preset.name, key.path);
            assert!(low <= high, "{case}");
            for (end, outside) in [
                (low, beyond(low, f64::NEG_INFINITY, key.kind)),
                (high, beyond(high, f64::INFINITY, key.kind)),
            ] {
                assert!(accepts(&values, key.path, end), "{case}");
                assert!(!accepts(&values, key.path, outside), "{case}: {outside:?}");
            }
        }
    }
}

#[test]
fn refuses_keys_that_are_not_offered() {
    for preset in PRESETS.iter() {
        let values = preset.values().unwrap();
        let offered = values.applicable_keys();
        for key in KEYS {
            let is_offered = applicable(&offered, key.path).is_some();
            assert!(is_offered || values.get(key.path).is_none(), "{}", key.path);
            let Some([low, high]) = key.typical.filter(|_| !is_offered) else {
                continue;
            };
            for value in [low, f64::midpoint(low, high), high] {
                let case = format!("{}: {} = {value}", preset.name, key.path);
                assert!(!accepts(&values, key.path, value), "{case}");
            }
        }
    }
}

#[test]
fn changing_to_an_offered_word_leaves_a_valid_scenario() {
    for preset in PRESETS.iter() {
        let values = preset.values().unwrap();
        for ApplicableKey { key, allowed, .. } in values.applicable_keys() {
            let Allowed::Words(words) = allowed else {
                continue;
            };
            assert!(!words.is_empty(), "{}: {}", preset.name, key.path);
            for word in words {
                let mut changed = values.clone();
                changed.change(key.path, word).unwrap();
                assert_eq!(changed.get(key.path), Some(&Value::Text(word.to_owned())));
                if let Err(error) = Scenario::new(changed) {
                    panic!("{}: {} = {word}: {error}", preset.name, key.path);
                }
            }
        }
    }
}

#[test]
fn changes_adjust_dependent_keys() {
    for (case, preset, path, value, keys) in [
        (
            "a free peg",
            "paper",
            "support.kind",
            "free",
            &[
                ("formulation", Some("body")),
                ("friction.dissipation", Some("full")),
            ][..],
        ),
        (
            "a free peg stops",
            "frictionless",
            "support.kind",
            "free",
            &[("stop.duration", Some("20"))],
        ),
        (
            "no friction",
            "paper",
            "friction.law",
            "none",
            &[("friction.k", None), ("friction.dissipation", None)],
        ),
        (
            "parameters of a law",
            "paper",
            "friction.law",
            "viscous",
            &[
                ("friction.viscous_speed", Some("0.5")),
                ("friction.k", Some("0.03")),
            ],
        ),
        (
            "a tippe top",
            "free-paper",
            "top.center_distance",
            "-0.003",
            &[("stop.theta_risen", None), ("stop.theta_fallen", None)],
        ),
    ] {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        values.change(path, value).unwrap();
        for (key, expected) in keys {
            let found = values.get(key).map(Value::to_set_notation);
            assert_eq!(found.as_deref(), *expected, "{case}: {key}");
        }
        Scenario::new(values.clone()).unwrap_or_else(|error| panic!("{case}: {error}"));
    }
    let mut values = Preset::find("paper").unwrap().values().unwrap();
    values.change("drilling.k", "0.1").unwrap();
    assert!(values.get("drilling.patch_radius").is_some());
    values.change("drilling.k", "").unwrap();
    assert_eq!(values.get("drilling.patch_radius"), None);
    assert!(values.change("friction.kk", "1").is_err());
}

#[test]
fn offers_depend_on_the_other_keys() {
    let paper = Preset::find("paper").unwrap().values().unwrap();
    let keys = paper.applicable_keys();
    // I_z ≤ 2 (I_x − M l²): the largest l is √((8.52e-5 − 7.25e-5/2)/0.11) m = 0.0210951 m.
    let Some(Allowed::Range([low, high])) =
        applicable(&keys, "top.center_distance").map(|item| item.allowed)
    else {
        panic!("no range");
    };
    let largest = ((8.52e-5 - 7.25e-5 / 2.0) / 0.11_f64).sqrt();
    // Three products, two differences and a root each round by half an epsilon.
    assert!(
        (high - largest).abs() <= 4.0 * f64::EPSILON * largest,
        "{high}"
    );
    assert!(low > 0.0 && low < 1e-300, "{low}");
    assert_eq!(applicable(&keys, "friction.viscous_speed"), None);
    assert_eq!(applicable(&keys, "initial.peg_x"), None);
    assert!(!applicable(&keys, "stop.duration").unwrap().is_required);

    let tippe = Preset::find("tippe-top").unwrap().values().unwrap();
    let keys = tippe.applicable_keys();
    assert_eq!(applicable(&keys, "stop.theta_risen"), None);
    assert!(applicable(&keys, "stop.duration").unwrap().is_required);
    let formulation = applicable(&keys, "formulation").unwrap();
    assert_eq!(formulation.allowed, Allowed::Words(vec!["body"]));
}

#[test]
fn unknown_preset_names_the_similar_ones_or_all() {
    for (name, expected, is_listed) in [
        ("papr", "(did you mean paper?)", false),
        ("zzzz", "presets: paper, ", true),
    ] {
        let message = Preset::find(name).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
        assert_eq!(message.contains("presets: "), is_listed, "{message}");
    }
}
