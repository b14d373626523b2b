//! Friction laws that are formulas: what they mean, what they refuse, and that their motions are those of the laws that
//! toprise has.

use crate::random_scenarios::Random;
use crate::support::{Folder, Run, archive, assert_contains, assert_near, scenario, verified};
use std::time::{Duration, Instant};
use toprise::archive::verify::Verdict;
use toprise::archive::writer::Form;
use toprise::physics::formula::{Formula, Parameters};
use toprise::physics::math;
use toprise::run::scenario::{Preset, Scenario, ScenarioError, Values};
use toprise::run::simulation::Simulation;
use toprise::telemetry::encoding::Encoding;

/// A preset whose friction law is this formula; its own parameters are removed.
fn with_formula(preset: &str, formula: &str, overrides: &[(&str, &str)]) -> Values {
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for key in [
        "static_k",
        "stribeck_speed",
        "viscous_slope",
        "viscous_speed",
        "k",
    ] {
        values.set(&format!("friction.{key}"), "").unwrap();
    }
    values.set("friction.law", "formula").unwrap();
    values.set("friction.formula", formula).unwrap();
    for (key, value) in overrides {
        values.set(key, value).unwrap();
    }
    values
}

fn formula_scenario(preset: &str, formula: &str, overrides: &[(&str, &str)]) -> Scenario {
    Scenario::new(with_formula(preset, formula, overrides)).unwrap()
}

fn refusal(formula: &str, overrides: &[(&str, &str)]) -> ScenarioError {
    Scenario::new(with_formula("paper", formula, overrides)).unwrap_err()
}

/// Asserts that two runs have the same events, to 1e-12 s, and the same end.
fn assert_same_motion(own: &Scenario, known: &Scenario) {
    let [own, known] = [own, known].map(Run::of);
    assert_eq!(own.events.len(), known.events.len());
    assert!(own.events.len() > 2, "a motion without events");
    for (event, expected) in own.events.iter().zip(&known.events) {
        assert_eq!(event.kind, expected.kind);
        let what = format!("{:?}", event.kind);
        assert_near(&what, event.time, expected.time, 1e-12);
    }
    let [end, expected] = [own.end.motion.angles, known.end.motion.angles];
    assert_near("θ", end.theta, expected.theta, 1e-12);
    assert_near("φ", end.phi, expected.phi, 1e-12);
}

#[test]
fn val_formula_k_has_the_motion_of_coulombs_law() {
    for (preset, changes) in [
        ("paper", &[][..]),
        (
            "full-coulomb",
            &[
                ("stop.theta_risen", ""),
                ("stop.duration", "26"),
                ("stop.on_stick", "continue"),
            ],
        ),
        ("free-paper", &[("stop.duration", "8")]),
        ("drop", &[]),
    ] {
        let known = scenario(preset, changes);
        let k = known
            .entries()
            .find(|(key, _)| key.path == "friction.k")
            .unwrap()
            .1;
        let k = k.to_set_notation();
        let changes = [changes, &[("friction.k", &k)]].concat();
        assert_same_motion(&formula_scenario(preset, "k", &changes), &known);
    }
}

#[test]
fn val_formula_of_stribecks_law_has_its_motion() {
    let parameters = [
        ("friction.k", "0.03"),
        ("friction.a", "0.045"),
        ("friction.b", "0.05"),
        ("friction.c", "0.01"),
    ];
    let stribeck = [
        ("friction.law", "stribeck"),
        ("friction.k", "0.03"),
        ("friction.static_k", "0.045"),
        ("friction.stribeck_speed", "0.05"),
        ("friction.viscous_slope", "0.01"),
    ];
    for (preset, changes) in [
        ("stribeck", &[][..]),
        (
            "stribeck",
            &[
                ("stop.theta_risen", ""),
                ("stop.duration", "24"),
                ("stop.on_stick", "continue"),
            ],
        ),
        ("free-paper", &[("stop.duration", "6")]),
    ] {
        let known = scenario(preset, &[changes, &stribeck].concat());
        let formula = "k + (a - k)*exp(-(v/b)^2) + c*v";
        let own = formula_scenario(preset, formula, &[changes, &parameters].concat());
        assert_same_motion(&own, &known);
    }
}

#[test]
fn val_formula_tanh_has_the_motion_of_the_smooth_law() {
    let known = scenario(
        "full-coulomb",
        &[
            ("friction.law", "coulomb-tanh"),
            ("friction.smoothing_speed", "0.01"),
        ],
    );
    let own = formula_scenario(
        "full-coulomb",
        "k*tanh(v/a)",
        &[("friction.k", "0.03"), ("friction.a", "0.01")],
    );
    assert_same_motion(&own, &known);
}

#[test]
fn static_friction_holds_up_to_its_own_bound() {
    let bound = |text: &str, static_k: &str| {
        let changes = [("friction.static_k", static_k)];
        let values = with_formula("paper", text, &changes);
        Scenario::new(values).map(|scenario| scenario.model.friction.law.static_bound(1.0))
    };
    assert_eq!(bound("0.2 - 0.1*tanh(v)", ""), Ok(0.2));
    assert_eq!(bound("0.2 - 0.1*tanh(v)", "0.3"), Ok(0.3));
    assert_eq!(bound("0.1*tanh(v)", ""), Ok(0.0));
    assert_contains(
        &bound("0.2", "0.1").unwrap_err().to_string(),
        "at v = 0, which is 0.2",
    );
    assert_contains(
        &bound("v", "0.1").unwrap_err().to_string(),
        "there is no static friction",
    );
}

/// Kinks cost steps, not accuracy.
#[test]
fn val_kinks_are_integrated_to_the_tolerance() {
    for formula in [
        "min(0.03, v/10)",
        "max(0.03, 0.05 - v)",
        "0.02 + 0.1*abs(v - 0.3)",
        "points(v; 0, 0.05; 0.1, 0.02; 0.3, 0.03; 0.5, 0.03)",
    ] {
        let [run, finer] = ["1e-12", "1e-13"].map(|tolerance| {
            let changes = [
                ("stop.duration", "6"),
                ("integrator.relative_tolerance", tolerance),
                ("integrator.absolute_tolerance", tolerance),
            ];
            Run::of(&formula_scenario("full-coulomb", formula, &changes))
        });
        assert_eq!(run.events.len(), finer.events.len(), "{formula}");
        let [angles, expected] = [&run, &finer].map(|run| run.end.motion.angles);
        // As that of smooth laws: some thousand local errors of 1e-12.
        assert_near(formula, angles.theta, expected.theta, 2e-10);
        assert_near(formula, angles.phi, expected.phi, 2e-9);
    }
}

#[test]
fn recordings_of_formulas_are_verified_in_every_encoding() {
    let formula = "k*(1 + a*exp(-(v/b)^2)) + points(v; 0, 0; 0.3, 0.001)";
    let parameters = [
        ("friction.k", "0.03"),
        ("friction.a", "0.4"),
        ("friction.b", "0.05"),
        ("stop.duration", "0.3"),
    ];
    let scenario = formula_scenario("paper", formula, &parameters);
    assert_eq!(Scenario::from_toml(&scenario.to_toml()).unwrap(), scenario);
    let folder = Folder::new();
    let protobuf = Form {
        encoding: Encoding::Protobuf,
        views: true,
    };
    for (name, form) in [("json.mcap", Form::default()), ("protobuf.mcap", protobuf)] {
        let file = folder.at(name);
        archive(&file, &scenario, &[], form).unwrap();
        assert_eq!(verified(&file).verdict, Verdict::Verified, "{name}");
    }
}

/// What a formula is at a speed, without parameters.
fn value(text: &str, speed: f64) -> f64 {
    let parameters: Parameters = [0.5, 2.0, 3.0, 5.0, 7.0];
    let formula = Formula::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    formula.with_parameters(&parameters).unwrap().at(speed)
}

#[test]
fn signs_and_powers_bind_as_in_physics() {
    for (text, expected) in [
        ("-v^2", -9.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("(-v)^2", 9.0),
        ("2*-v", -6.0),
        ("1 - 2 - 3", -4.0),
        ("8/4/2", 1.0),
        ("--v", 3.0),
        ("1 + 2*3^2", 19.0),
        ("-2^2 + k*a", -3.0),
        ("6/2*3", 9.0),
        ("min(v, a, 1)", 1.0),
        ("max(v, a, 1) + abs(-d)", 10.0),
        ("sqrt(v + 1)*1e1 + .5", 20.5),
        ("log10(1000) + ln(exp(2)) + c", 10.0),
        ("points(v; 1, 5; 2, 7)", 7.0),
        ("points(v - a; 0, k; 2, k + 2)", 1.5),
        ("\tcos( 0 )\n", 1.0),
        ("sin(pi/6)*2", 1.0),
        ("4*atan(1)/pi + tanh(0)", 1.0),
    ] {
        assert_near(text, value(text, 3.0), expected, 1e-15 * 512.0);
    }
    assert!(value("0^0", 0.0).is_nan());
    assert!(value("max(0, 0*(1/0))", 0.0).is_nan());
}

/// Golden bits of what the grammar of 1.x means: on all machines the same.
#[test]
fn regress_values_of_formulas() {
    let mut found = String::new();
    for text in GOLDEN_FORMULAS {
        let mut bits = 0_u64;
        for speed in 0..1000 {
            let value = value(text, f64::from(speed) / 700.0);
            assert!(value.is_finite(), "{text} at {speed}");
            // FNV-1a, a byte at a time.
            for byte in value.to_bits().to_le_bytes() {
                bits = (bits ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
        found += &format!("{bits:016x} ");
    }
    assert_eq!(
        found,
        "0bb08828d5846dee 24351b52f74e3da4 0e87f74c84f88e93 d3943abc36011517 026fd4f5bc3b5491 "
    );
}

/// Half a second of a preset under a golden formula.
pub fn with_parameters(preset: &str, formula: &str) -> Scenario {
    let mut values = with_formula(preset, formula, &[("stop.duration", "0.5")]);
    let parsed = Formula::parse(formula).unwrap();
    for (name, number) in [("k", 0.03), ("a", 0.2), ("b", 0.5), ("c", 0.1), ("d", 1.5)] {
        if parsed.uses(name) {
            values
                .set_value(&format!("friction.{name}"), number)
                .unwrap();
        }
    }
    Scenario::new(values).unwrap()
}

/// Every function and operator.
pub const GOLDEN_FORMULAS: [&str; 5] = [
    "k*(1 + a*exp(-(v/b)^2)) + c*v",
    "k*tanh(v/a)/(1 + ln(1 + v)) + log10(1 + d*v)^1.5",
    "points(v; 0.01, k; 0.2, 1/30; 0.9, 0.03; 1, 1e-3) + pi/100",
    "min(k, a*sqrt(v), 1) + max(0, abs(sin(b*v)) - 0.1)*2^-3",
    "k + atan(v)*cos(d*v)^2/10 - -v^3^0.5/10",
];

#[test]
fn unknown_names_have_a_suggestion_and_a_mark() {
    let text = refusal("k*tnh(v/a)", &[]).to_string();
    assert_contains(
        &text,
        "unknown name tnh (did you mean tanh?)\n  k*tnh(v/a)\n    ^^^",
    );
    let text = refusal("1 + é", &[]).to_string();
    assert_contains(&text, "unexpected 'é'\n  1 + é\n      ^");
    // Long formulas show what is around the place.
    let text = refusal(&format!("{}x", "1 + ".repeat(200)), &[]).to_string();
    let lines: Vec<_> = text.lines().collect();
    assert!(
        lines[1].len() < 80 && lines[1].ends_with('x') && lines[2].ends_with("  ^"),
        "{text}"
    );
}

#[test]
fn parameters_are_those_that_the_formula_contains() {
    assert_contains(&refusal("k*v", &[]).to_string(), "missing: friction.k");
    let text = refusal("0.1", &[("friction.a", "1")]).to_string();
    assert_contains(&text, "friction.a is not in friction.formula");
    let values = with_formula("paper", "0.1*tanh(v/a)", &[("friction.a", "0.1")]);
    let keys = values.applicable_keys();
    let names: Vec<_> = keys
        .iter()
        .map(|key| key.key.path)
        .filter(|path| path.starts_with("friction."))
        .collect();
    assert_eq!(
        names,
        [
            "friction.law",
            "friction.formula",
            "friction.a",
            "friction.dissipation"
        ]
    );
    // While the formula is being written, its parameters stay.
    let values = with_formula("paper", "0.1*tanh(v/", &[("friction.a", "0.1")]);
    let keys = values.applicable_keys();
    assert!(keys.iter().any(|key| key.key.path == "friction.a"));
    assert!(!keys.iter().any(|key| key.key.path == "friction.b"));
    // Changing the law by a click adds a usual formula with its parameters, and removes them again.
    let mut values = Preset::find("viscous").unwrap().values().unwrap();
    values.change("friction.law", "formula").unwrap();
    assert!(Scenario::new(values.clone()).is_ok());
    values.change("friction.formula", "b*tanh(v/c)").unwrap();
    assert!(Scenario::new(values.clone()).is_ok() && values.get("friction.a").is_none());
    values.change("friction.law", "coulomb").unwrap();
    assert!(Scenario::new(values).is_ok());
}

#[test]
fn refuses_coefficients_that_no_contact_has() {
    for (formula, part) in [
        ("1/0", "is inf at v = 0 m/s"),
        ("0^0", "is NaN at v = 0 m/s"),
        ("v^1e9", "is inf at v = 1."),
        (
            "0.1 - v",
            "but must be finite and not negative where the top slips",
        ),
        ("ln(v)", "is -inf at v = 0 m/s"),
    ] {
        assert_contains(&refusal(formula, &[]).to_string(), part);
    }
}

/// What the grid of the check at the start misses, the steps find.
#[test]
fn ends_a_run_where_the_formula_is_negative() {
    let formula = "0.03 - exp(-((v - 0.3)/1e-4)^2)";
    let scenario = formula_scenario("full-coulomb", formula, &[]);
    let error = Simulation::new(&scenario)
        .unwrap()
        .find_map(Result::err)
        .unwrap();
    let text = error.to_string();
    assert_contains(&text, "μ(v) = 0.03 - exp(-((v - 0.3)/1e-4)^2) is -");
    assert!(
        text.contains(" at v = 0.300") || text.contains(" at v = 0.299"),
        "{text}"
    );
}

/// A person's mistake, or an attack: an error at once.
#[test]
fn hostile_formulas_are_one_error_at_once() {
    let long = "1+".repeat(500_000);
    let deep = "(".repeat(10_000) + "v";
    let wide = "v".to_owned() + &"+(v".repeat(3_000);
    let signs = "-".repeat(9_999) + "v";
    let powers = "2^".repeat(4_999) + "v";
    let spaces = " ".repeat(9_000) + "(";
    for formula in [
        &long,
        &deep,
        &wide,
        &signs,
        &powers,
        &spaces,
        "1/0",
        "0^0",
        "v^1e9",
        "9^9^9^9^9",
    ] {
        let start = Instant::now();
        let text = refusal(formula, &[]).to_string();
        assert!(start.elapsed() < Duration::from_millis(100), "{text}");
        assert!(text.len() < 500, "{text}");
    }
}

/// Random formulas.
struct Formulas(Random);

impl Formulas {
    /// A formula with all its parentheses, and its value at a speed.
    fn tree(&mut self, depth: usize, speed: f64) -> (String, f64) {
        if depth == 0 || self.0.below(5) == 0 {
            return match self.0.below(4) {
                0 => ("v".to_owned(), speed),
                1 => ("k".to_owned(), 0.5),
                2 => ("c".to_owned(), 5.0),
                _ => {
                    let number = (self.0.symmetric() * 8.0).round().abs() / 4.0;
                    (format!("{number:?}"), number)
                }
            };
        }
        let (a, x) = self.tree(depth - 1, speed);
        let (b, y) = self.tree(depth - 1, speed);
        match self.0.below(11) {
            0 => (format!("({a} + {b})"), x + y),
            1 => (format!("({a} - {b})"), x - y),
            2 => (format!("({a})*({b})"), x * y),
            3 => (format!("({a}/({b}))"), x / y),
            4 => (
                format!("min({a}, {b})"),
                if x < y || x.is_nan() { x } else { y },
            ),
            5 => (
                format!("max({a}, {b})"),
                if x > y || x.is_nan() { x } else { y },
            ),
            6 => (format!("sqrt({a})"), x.sqrt()),
            7 => (format!("(-({a}))"), -x),
            8 => (format!("abs({a})"), x.abs()),
            9 => (format!("({a})^2"), x * x),
            _ => (format!("tanh({a})"), math::tanh(x)),
        }
    }

    /// Symbols in any order.
    fn soup(&mut self) -> String {
        const SYMBOLS: [&str; 32] = [
            "v", "k", "a", "b", "pi", "exp(", "ln(", "log10(", "sqrt(", "abs(", "tanh(", "sin(",
            "cos(", "atan(", "min(", "max(", "points(", "(", ")", ")", ")", "+", "-", "*", "/",
            "^", ",", ";", "1e3", "0.5", " ", "é",
        ];
        let count = 1 + self.0.below(14);
        (0..count)
            .map(|_| SYMBOLS[self.0.below(SYMBOLS.len())])
            .collect()
    }
}

#[test]
fn random_formulas_have_the_values_of_their_trees() {
    let mut random = Formulas(Random(48));
    for _ in 0..10_000 {
        let speed = random.0.unit();
        let depth = random.0.below(5);
        let (text, expected) = random.tree(depth, speed);
        let actual = value(&text, speed);
        assert!(
            actual == expected || actual.is_nan() && expected.is_nan(),
            "{text} at {speed}: {actual} {expected}"
        );
    }
}

#[test]
fn random_formulas_neither_panic_nor_hang() {
    let mut random = Formulas(Random(49));
    let (mut parsed, mut ran) = (0, 0);
    for index in 0..10_000 {
        let text = if index % 2 == 0 {
            random.soup()
        } else {
            random.tree(6, 0.0).0
        };
        let Ok(formula) = Formula::parse(&text) else {
            continue;
        };
        parsed += 1;
        let Ok(program) = formula.with_parameters(&[0.1, 0.2, 0.3, 0.4, 0.5]) else {
            continue;
        };
        for speed in [
            0.0,
            1e-300,
            1e-9,
            0.3,
            1.0,
            1e9,
            f64::MAX,
            f64::INFINITY,
            f64::NAN,
        ] {
            program.at(speed);
        }
        if ran < 300 {
            ran += u32::from(runs(&text));
        }
    }
    assert!(parsed > 5_000 && ran == 300, "{parsed} parsed, {ran} ran");
}

/// Whether a formula is a law of friction; if so, it is run for a while.
fn runs(text: &str) -> bool {
    let mut changes = vec![("stop.duration", "0.05")];
    let used = Formula::parse(text).unwrap();
    for (name, key) in [
        ("k", "friction.k"),
        ("a", "friction.a"),
        ("b", "friction.b"),
        ("c", "friction.c"),
    ] {
        if used.uses(name) {
            changes.push((key, "0.02"));
        }
    }
    let Ok(scenario) = Scenario::new(with_formula("full-coulomb", text, &changes)) else {
        return false;
    };
    let mut steps = 0;
    let carry_on = || {
        steps += 1;
        steps < 2000
    };
    // Either has an end, or an error that says why not.
    match toprise::run::outcome(&scenario, carry_on) {
        Ok(outcome) => assert!(outcome.end.time <= 0.05),
        Err(error) => assert_contains(&error.to_string(), " at t = "),
    }
    true
}
