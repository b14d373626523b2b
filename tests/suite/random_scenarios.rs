//! Random scenarios, and the laws of motion that their runs must keep.

use crate::laws_of_motion::LawsOfMotion;
use crate::support::MemorySink;
use toprise::archive::sink::{Sink, record_all};
use toprise::physics::math::exp;
use toprise::run::scenario::{KEYS, Kind, Preset, Scenario, Values};
use toprise::telemetry::{RunMessages, Topics};

/// A run is aborted after this many steps: a hard one would take forever.
const MOST_STEPS: u32 = 3000;

/// Numbers that look random, the same on every machine (splitmix64).
pub struct Random(pub u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^ (bits >> 31)
    }

    pub fn below(&mut self, limit: usize) -> usize {
        (self.bits() % limit as u64) as usize
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From −1 to 1.
    pub fn symmetric(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    fn sign(&mut self) -> f64 {
        if self.below(2) == 0 { 1.0 } else { -1.0 }
    }
}

/// How far a random scenario may be from everyday tops.
#[derive(Clone, Copy)]
enum Reach {
    /// Tops as they are made and thrown.
    Plausible,
    /// Anything that a scenario allows, within reason.
    Extreme,
}

/// A random scenario and how it is made, if the choices fit together.
fn scenario(random: &mut Random, reach: Reach) -> Option<Scenario> {
    let mut values = Preset::find("full-coulomb").unwrap().values().unwrap();
    let words = |path: &str| {
        let key = KEYS.iter().find(|key| key.path == path).unwrap();
        let Kind::Choice(words) = key.kind else {
            panic!("{path} is no choice");
        };
        words
    };
    let word = |random: &mut Random, path: &str| {
        let words = words(path);
        words[random.below(words.len())]
    };
    let extreme = matches!(reach, Reach::Extreme);
    let spread = |random: &mut Random, middle: f64, decades: f64| {
        let decades = if extreme { 3.0 * decades } else { decades };
        middle * exp(std::f64::consts::LN_10 * decades * random.symmetric())
    };
    let mut set = |path: &str, value: f64| values.set_value(path, value).is_ok();
    let mass = spread(random, 0.1, 1.0);
    let length = spread(random, 0.03, 0.5);
    // About the peg: at least that of the mass at its distance.
    let transverse = mass * length * length * (1.0 + spread(random, 0.5, 0.5));
    let own = transverse - mass * length * length;
    set("top.mass", mass);
    set("top.center_distance", length);
    set("top.transverse_moment", transverse);
    set("top.axial_moment", own * spread(random, 0.9, 0.1).min(2.0));
    set("top.peg_radius", spread(random, 0.004, 0.5));
    set(
        "initial.theta",
        if extreme {
            std::f64::consts::PI * random.unit()
        } else {
            0.05 + 1.3 * random.unit()
        },
    );
    set("initial.phi", 6.3 * random.unit());
    set(
        "initial.phi_dot",
        if random.below(3) == 0 {
            0.0
        } else {
            spread(random, 3.0, 1.0) * random.sign()
        },
    );
    set(
        "initial.theta_dot",
        if random.below(2) == 0 {
            0.0
        } else {
            spread(random, 0.3, 1.0) * random.sign()
        },
    );
    set(
        "initial.psi_dot",
        spread(random, 150.0, 0.5) * random.sign(),
    );
    let tolerance = [1e-12, 1e-10, 1e-8, 1e-6, 1e-13][random.below(5)];
    set("integrator.relative_tolerance", tolerance);
    set(
        "integrator.absolute_tolerance",
        tolerance * [1.0, 1e-3, 10.0][random.below(3)],
    );
    for (path, middle) in [
        ("rolling.arm", 1e-4),
        ("air.axial", 1e-6),
        ("air.transverse", 1e-6),
        ("air.disc", 1e-6),
    ] {
        if random.below(4) == 0 {
            set(path, spread(random, middle, 1.0));
        }
    }
    if random.below(5) == 0 {
        set("drilling.k", spread(random, 0.1, 0.5));
        set("drilling.patch_radius", spread(random, 1e-4, 0.5));
    }
    let k = spread(random, 0.05, 0.5).min(100.0);
    let duration = spread(random, 0.4, 0.3).min(2.0);
    set("stop.duration", duration);
    set(
        "sampling.period",
        [0.001, 0.002, 0.004, 0.01][random.below(4)],
    );
    let mut text = |path: &str, value: &str| values.set(path, value).is_ok();
    text("stop.theta_risen", "");
    text("stop.theta_fallen", "");
    text("formulation", word(random, "formulation"));
    let law = word(random, "friction.law");
    text("friction.law", law);
    text("friction.dissipation", word(random, "friction.dissipation"));
    text("friction.k", &format!("{k:?}"));
    let mut set = |path: &str, value: f64| values.set_value(path, value).is_ok();
    match law {
        "none" => {
            values.set("friction.k", "").unwrap();
            values.set("friction.dissipation", "").unwrap();
        }
        "coulomb-sqrt" | "coulomb-tanh" | "coulomb-rational" => {
            set("friction.smoothing_speed", spread(random, 0.01, 1.0));
        }
        "viscous" => {
            set("friction.viscous_speed", spread(random, 0.5, 1.0));
        }
        "stribeck" => {
            set("friction.static_k", 1.5 * k);
            set("friction.stribeck_speed", spread(random, 0.05, 1.0));
            set("friction.viscous_slope", 0.01 * random.unit());
        }
        "formula" => {
            let formulas = [
                "k*tanh(v/a)",
                "k*(1 + 0.5*exp(-(v/a)^2))",
                "min(k, v/a) + 0.01*v",
            ];
            let formula = formulas[random.below(formulas.len())];
            set("friction.a", spread(random, 0.05, 1.0));
            values.set("friction.formula", formula).unwrap();
        }
        "contensou" => {
            set("friction.patch_radius", spread(random, 1e-4, 0.5));
        }
        _ => {}
    }
    if random.below(4) == 0 {
        values.set("stop.on_stick", "continue").unwrap();
    }
    Scenario::new(values).ok()
}

/// A random scenario of a top whose peg is free: all laws and losses, any restitution, drops, throws and tippe tops.
fn free_scenario(random: &mut Random, reach: Reach) -> Option<Scenario> {
    let base = scenario(random, reach)?;
    let top = base.model.top;
    let mut values = Values::from_toml(&base.to_toml()).unwrap();
    let has_friction = values.get("friction.dissipation").is_some();
    values.set("formulation", "body").unwrap();
    values.set("support.kind", "free").unwrap();
    values
        .set(
            "friction.dissipation",
            if has_friction { "full" } else { "" },
        )
        .unwrap();
    values
        .set("stop.on_stick", ["", "continue"][random.below(2)])
        .unwrap();
    let mut put = |path: &str, value: f64| values.set_value(path, value).unwrap();
    put(
        "support.restitution",
        [0.0, 1.0, random.unit(), random.unit()][random.below(4)],
    );
    // Three of ten are dropped or thrown.
    match random.below(10) {
        0 | 1 => put("initial.height", 0.02 * random.unit()),
        2 => put("initial.peg_z_dot", 0.5 * random.unit()),
        _ => {}
    }
    match random.below(4) {
        0 => {
            put("initial.peg_x_dot", random.symmetric());
            put("initial.peg_y_dot", random.symmetric());
        }
        1 => {
            put("initial.center_x_dot", 0.0);
            put("initial.center_y_dot", 0.0);
        }
        _ => {}
    }
    if random.below(4) == 0 {
        let radius = 0.005 + 0.03 * random.unit();
        let distance = -0.9 * radius * random.unit();
        let own = 0.4 * top.mass * radius * radius;
        put("top.peg_radius", radius);
        put("top.center_distance", distance);
        put("top.axial_moment", own);
        let central = own * (0.7 + 0.6 * random.unit());
        put(
            "top.transverse_moment",
            central + top.mass * distance * distance,
        );
    }
    Scenario::new(values).ok()
}

/// A random scenario, plausible or not.
fn anywhere(random: &mut Random, make: Make) -> Option<Scenario> {
    let reach = [Reach::Plausible, Reach::Extreme][random.below(2)];
    make(random, reach)
}

/// Random scenarios of tops whose pegs are held, without an end.
pub fn held_tops(mut random: Random) -> impl Iterator<Item = Scenario> {
    std::iter::repeat_with(move || anywhere(&mut random, scenario)).flatten()
}

/// Random scenarios of tops whose pegs are held, such as are made, without an end.
pub fn ordinary_held_tops(mut random: Random) -> impl Iterator<Item = Scenario> {
    std::iter::repeat_with(move || scenario(&mut random, Reach::Plausible)).flatten()
}

/// Random scenarios of tops whose pegs are free, such as are made.
pub fn free_tops(mut random: Random) -> impl Iterator<Item = Scenario> {
    std::iter::repeat_with(move || free_scenario(&mut random, Reach::Plausible)).flatten()
}

/// The laws that the messages of a run break.
fn broken_laws(scenario: &Scenario) -> Vec<String> {
    let mut steps = 0;
    let Ok(run) = RunMessages::new(scenario, &Topics::All) else {
        return Vec::new();
    };
    let mut run = run.continue_while(move || {
        steps += 1;
        steps <= MOST_STEPS
    });
    let mut sink = MemorySink::default();
    let sinks: &mut [&mut dyn Sink] = &mut [&mut sink];
    let recorded = record_all(&mut run, sinks).unwrap();
    let mut laws = LawsOfMotion::new(scenario, recorded.outcome.end.statistics.accepted);
    for message in &sink.messages {
        laws.take(&message.as_message());
    }
    laws.broken()
}

/// Makes a random scenario.
type Make = fn(&mut Random, Reach) -> Option<Scenario>;

/// How many scenarios the long tests try: `TOPRISE_SCENARIOS=10000 cargo test --test suite -- --ignored laws_of_motion`.
const COUNT: &str = "TOPRISE_SCENARIOS";

fn assert_lawful(seed: u64, count: usize, make: Make) {
    let mut random = Random(seed);
    let scenarios = std::iter::repeat_with(|| anywhere(&mut random, make));
    let mut found = Vec::new();
    for scenario in scenarios.flatten().take(count) {
        let broken = broken_laws(&scenario);
        if !broken.is_empty() {
            found.push(format!("{broken:#?}\n{}", scenario.to_toml()));
        }
    }
    println!("tried {count}, {} break a law", found.len());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn random_tops_obey_the_laws_of_motion() {
    assert_lawful(1, 200, scenario);
}

#[test]
fn random_free_tops_obey_the_laws_of_motion() {
    assert_lawful(3, 200, free_scenario);
}

#[test]
#[ignore = "takes minutes"]
fn many_random_tops_obey_the_laws_of_motion() {
    assert_lawful(2, count().unwrap_or(10_000), scenario);
}

#[test]
#[ignore = "takes minutes"]
fn many_random_free_tops_obey_the_laws_of_motion() {
    assert_lawful(4, count().unwrap_or(2000), free_scenario);
}

/// How many scenarios are asked for.
pub fn count() -> Option<usize> {
    std::env::var(COUNT).ok()?.parse().ok()
}

/// Tops of which a law was once called broken by a tolerance that was too small.
#[test]
fn regress_extreme_tops_obey_the_laws_of_motion() {
    let cases: [(&str, &[(&str, &str)]); 6] = [
        ("full-coulomb", &[("air.transverse", "1e-3")]),
        ("full-coulomb", &[("air.axial", "1e-2")]),
        ("full-coulomb", &[("air.disc", "1e-2")]),
        ("paper", &[("top.transverse_moment", "1")]),
        ("paper", &[("top.axial_moment", "1e-9")]),
        ("rise-by-loss-of-spin", &crate::support::FAST_PRECESSION),
    ];
    for (preset, changes) in cases {
        let mut changes = changes.to_vec();
        changes.push(("stop.duration", "1"));
        let scenario = crate::support::scenario(preset, &changes);
        assert_eq!(broken_laws(&scenario), [""; 0], "{preset} {changes:?}");
    }
}
