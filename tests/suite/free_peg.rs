//! Tops whose peg is free: `val_*` compare with motions and impacts computed by others (`tests/data/free_peg.json`).

use crate::support::{assert_near, scenario};
use nalgebra::Vector3;
use serde_json::Value;
use toprise::physics::dynamics::{
    Formulation, FreeRotation, Guard, Impact, Model, Motion, Passage, Start, Support,
};
use toprise::physics::friction::{Dissipation, Friction, FrictionLaw, Losses, Smoothing};
use toprise::physics::kinematics::{Euler, lean_to_world};

fn reference() -> Value {
    serde_json::from_str(include_str!("../data/free_peg.json")).unwrap()
}

/// A number given as a string of digits.
fn digits(value: &Value, key: &str) -> Option<f64> {
    value.get(key)?.as_str()?.parse().ok()
}

/// A value of a command like `mu=.1 slipx=.4`.
fn given<'a>(command: &'a str, key: &str) -> Option<&'a str> {
    let mut words = command.split_whitespace();
    words.find_map(|word| word.strip_prefix(key)?.strip_prefix('='))
}

fn number(command: &str, key: &str) -> Option<f64> {
    given(command, key).map(|value| value.parse().unwrap())
}

/// The paper's top in the state of `impact_meta`, at the moment of an impact, and what the impact makes of it.
fn hit(command: &str) -> (Model, Motion, Impact) {
    let k = number(command, "mu").unwrap();
    let law = match number(command, "veps") {
        Some(speed) => FrictionLaw::Regularised {
            k,
            speed,
            shape: Smoothing::SquareRoot,
        },
        None => FrictionLaw::Coulomb { k },
    };
    let losses = number(command, "delta").map(|rolling_arm| Losses {
        rolling_arm,
        ..Losses::default()
    });
    let model = Model {
        friction: Friction {
            losses,
            ..Friction::sliding(law, Dissipation::Full)
        },
        support: Support::FreePeg {
            restitution: number(command, "e").unwrap(),
        },
        ..scenario("paper", &[]).model
    };
    let start = start_of_impact(&model, command);
    let (system, state, _) = FreeRotation::start(&model, &start, true);
    let entry = system.enter(Guard::Gap, &state, start.angles).unwrap();
    let (Passage::Bounces(impact) | Passage::Lands(impact)) = entry.passage else {
        panic!("{command}: {:?}", entry.passage)
    };
    (model, entry.motion, impact)
}

fn start_of_impact(model: &Model, command: &str) -> Start {
    let angles = Euler {
        theta: 0.5,
        ..Euler::default()
    };
    let rates = Euler {
        phi: 10.0,
        theta: -2.0,
        psi: 50.0,
    };
    let [x, y] = ["slipx", "slipy"].map(|key| number(command, key).unwrap());
    let tilt = toprise::physics::kinematics::Tilt::from_rates(angles.theta, rates);
    let radius = model.top.peg_radius;
    let rolling = lean_to_world(&tilt.slip_velocity(radius), angles.phi);
    Start {
        angles,
        rates,
        peg_position: Vector3::new(0.0, 0.0, radius),
        peg_velocity: Vector3::new(x, y, -0.1) - rolling,
    }
}

#[test]
fn val_impacts_are_those_computed_by_others() {
    for truth in reference()["single_impacts"].as_array().unwrap() {
        let command = truth["input"].as_str().unwrap();
        let (model, motion, hit) = hit(command);
        let world = |v: &Vector3<f64>| lean_to_world(v, 0.0);
        let (after, impulse) = (world(&hit.after), world(&hit.impulse));
        let omega = world(&motion.tilt.omega_lean);
        let center = world(&motion.center_velocity_lean(&model.top));
        for (key, actual) in [
            ("slip_x_after", after.x),
            ("slip_y_after", after.y),
            ("uz_after", after.z),
            ("impulse_x", impulse.x),
            ("impulse_y", impulse.y),
            ("impulse_normal", impulse.z),
            ("loss_normal", hit.normal_loss),
            ("loss_friction", hit.friction_loss),
            ("wx", omega.x),
            ("wy", omega.y),
            ("wz", omega.z),
            ("vGx", center.x),
            ("vGy", center.y),
            ("vGz", center.z),
        ] {
            let expected = digits(truth, key).unwrap();
            assert_near(&format!("{command}: {key}"), actual, expected, 1e-12);
        }
        assert_eq!(hit.is_held, truth["sticks"].as_bool().unwrap(), "{command}");
    }
}
