//! Similar tops move alike: lengths times λ, masses times μ, times times √λ, with the same gravity.

use crate::random_scenarios::Random;
use crate::support::assert_near;
use toprise::run::outcome::outcome;
use toprise::run::scenario::{Preset, Scenario, Value, Values};
use toprise::run::simulation::RunEnd;

/// Factors of a similar top: λ is 4 to the power of `length`, μ is 2 to that of `mass`. Scaling by powers of two is exact
/// in binary arithmetic: only the tolerances, which do not scale, can make the motions differ.
#[derive(Clone, Copy, Debug)]
struct Scale {
    length: i32,
    mass: i32,
}

impl Scale {
    /// The factor of a quantity with these exponents of length, mass and time.
    fn factor(self, [length, mass, time]: [i32; 3]) -> f64 {
        // Times are multiplied by √λ.
        libm::scalbn(1.0, self.length * (2 * length + time) + self.mass * mass)
    }
}

/// Keys with the exponents of their dimension: length, mass, time.
const DIMENSIONS: [(&str, [i32; 3]); 15] = [
    ("top.mass", [0, 1, 0]),
    ("top.transverse_moment", [2, 1, 0]),
    ("top.axial_moment", [2, 1, 0]),
    ("top.center_distance", [1, 0, 0]),
    ("top.peg_radius", [1, 0, 0]),
    ("initial.phi_dot", [0, 0, -1]),
    ("initial.theta_dot", [0, 0, -1]),
    ("initial.psi_dot", [0, 0, -1]),
    ("friction.viscous_speed", [1, 0, -1]),
    ("friction.smoothing_speed", [1, 0, -1]),
    ("friction.patch_radius", [1, 0, 0]),
    ("rolling.arm", [1, 0, 0]),
    ("drilling.patch_radius", [1, 0, 0]),
    ("air.axial", [2, 1, -1]),
    ("stop.duration", [0, 0, 1]),
];

/// The same top in another size.
fn scaled(values: &Values, scale: Scale) -> Scenario {
    let mut values = values.clone();
    for (key, dimension) in DIMENSIONS {
        if let Some(&Value::Number(number)) = values.get(key) {
            values
                .set_value(key, number * scale.factor(dimension))
                .unwrap();
        }
    }
    Scenario::new(values).unwrap()
}

/// A random top of the paper's size on this support.
fn random_top(random: &mut Random, preset: &str, formulation: &str) -> Values {
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for (key, text) in [
        ("formulation", formulation),
        ("stop.theta_risen", ""),
        ("stop.theta_fallen", ""),
        ("stop.on_stick", "continue"),
    ] {
        values.set(key, text).unwrap();
    }
    let law = [
        ("coulomb", ""),
        ("coulomb-sqrt", "friction.smoothing_speed"),
        ("viscous", "friction.viscous_speed"),
    ][random.below(3)];
    values.set("friction.law", law.0).unwrap();
    if !law.1.is_empty() {
        values.set_value(law.1, 0.01 + 0.1 * random.unit()).unwrap();
        values.set("stop.on_stick", "").unwrap();
    }
    if random.below(2) == 0 {
        values
            .set_value("rolling.arm", 1e-4 * random.unit())
            .unwrap();
    }
    if random.below(2) == 0 {
        values.set_value("air.axial", 1e-6 * random.unit()).unwrap();
    }
    for (key, number) in [
        ("friction.k", 0.01 + 0.1 * random.unit()),
        ("initial.theta", 0.1 + 0.7 * random.unit()),
        ("initial.phi_dot", 5.0 * random.symmetric()),
        ("initial.theta_dot", 5.0 * random.symmetric()),
        ("initial.psi_dot", 30.0 + 200.0 * random.unit()),
        ("stop.duration", 0.5),
    ] {
        values.set_value(key, number).unwrap();
    }
    values
}

fn end(scenario: &Scenario) -> RunEnd {
    outcome(scenario, || true).unwrap().end
}

#[test]
fn similar_tops_move_alike() {
    let mut random = Random(31);
    let sizes = [
        // From 0.9 g to 110 kg, and far beyond.
        (-1, -7),
        (2, 10),
        (-5, -30),
    ]
    .map(|(length, mass)| Scale { length, mass });
    for (preset, formulation) in [
        ("full-coulomb", "euler"),
        ("full-coulomb", "body"),
        ("free-paper", "body"),
    ] {
        for _ in 0..6 {
            let values = random_top(&mut random, preset, formulation);
            let original = Scenario::new(values.clone()).unwrap();
            let reference = end(&original);
            let rate = reference.motion.tilt.omega_lean.norm();
            for scale in sizes {
                let found = end(&scaled(&values, scale));
                let name = format!("{formulation} {scale:?}\n{}", original.to_toml());
                assert_eq!(found.stop, reference.stop, "{name}");
                // What a top between 1 g and 100 kg may differ by; 1000 steps of 1e-12 each, in the worst case.
                let difference = scale.factor([0, 0, 1]) * found.motion.tilt.omega_lean
                    - reference.motion.tilt.omega_lean;
                assert_near(&name, difference.norm() / rate, 0.0, 1e-9);
            }
        }
    }
}
