//! Scenarios: reading, checking, writing.

use crate::support::{assert_contains, scenario};
use proptest::prelude::*;
use toprise::run::scenario::{KEYS, Kind, PRESETS, Preset, Scenario, Value, Values};

fn error(preset: &str, overrides: &[(&str, &str)]) -> String {
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for (key, value) in overrides {
        if let Err(error) = values.set(key, value) {
            return error.to_string();
        }
    }
    Scenario::new(values).expect_err("accepted").to_string()
}

#[test]
fn every_preset_comes_back_from_its_canonical_form() {
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
fn the_digest_is_that_of_the_run_not_of_its_name() {
    let paper = scenario("paper", &[]);
    let renamed = scenario("paper", &[("name", "other")]);
    assert_eq!(paper.digest(), renamed.digest());
    let other = scenario("paper", &[("friction.k", "0.0300001")]);
    assert_ne!(paper.digest(), other.digest());
}

#[test]
fn each_error_names_key_value_and_what_is_allowed() {
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
            "unknown key psi_dot (did you mean initial.psi_dot?) | stop.duration",
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
fn files_are_checked_like_overrides() {
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
fn errors_say_what_to_do_next() {
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
fn whole_numbers_and_unquoted_words_are_taken() {
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

#[test]
fn an_unknown_preset_is_told_which_there_are() {
    let message = Preset::find("papr").unwrap_err().to_string();
    assert_contains(&message, "papr");
    assert_contains(&message, "full-coulomb");
}

proptest! {
    #[test]
    fn every_number_survives_to_the_last_bit(phi in -1e9..1e9_f64, psi_dot in -1e6..1e6_f64, ns in 1_u64..3_600_000_000_000) {
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
    fn no_text_makes_the_reader_panic(text in "\\PC*", key in 0..KEYS.len(), value in "\\PC{0,12}") {
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
fn errors_quote_the_beginning_of_what_is_long() {
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
fn a_number_that_is_refused_is_told_without_rows_of_zeros() {
    for (key, value, told) in [
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
        assert!(error.to_string().starts_with(told), "{error}");
    }
}

#[test]
fn a_scenario_is_set_otherwise_key_by_key() {
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
