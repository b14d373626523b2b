//! Built-in scenarios: the paper's run and its variations.

use super::definition::Scenario;
use super::error::ScenarioError;
use super::key::{Key, Value};
use super::keys::KEYS;
use super::values::Values;
use crate::run::suggestion::suggestion;

/// The paper's run (V. Tanrıverdi, arXiv:2204.14060, section 3): the base of all presets.
const PAPER: &str = include_str!("paper.toml");

/// A named scenario: the paper's with some keys changed.
#[derive(Debug)]
pub struct Preset {
    /// Its name, which is the scenario's `name`.
    pub name: &'static str,
    description: &'static str,
    /// Keys and values as TOML; an empty value removes the key.
    differences: &'static [(&'static str, &'static str)],
}

/// All presets.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "paper",
        description: "The paper's rise: equations (7) with k = 0.03 (figures 2 and 3)",
        differences: &[],
    },
    Preset {
        name: "paper-precession-term-only",
        description: "Equations (7) without the friction term in the spin's acceleration (figure 4a): rises late",
        differences: &[
            ("friction.dissipation", "precession-term-only"),
            ("stop.duration", "100.0"),
        ],
    },
    Preset {
        name: "paper-spin-term-only",
        description: "Equations (7) without the friction term in the precession's acceleration (figure 4b): falls",
        differences: &[("friction.dissipation", "spin-term-only")],
    },
    Preset {
        name: "full-coulomb",
        description: "The paper's top with the whole friction torque of equation (4)",
        differences: &[("friction.dissipation", "full")],
    },
    Preset {
        name: "frictionless",
        description: "The paper's top without friction: it neither rises nor falls",
        differences: &[
            ("friction.law", "none"),
            ("friction.k", ""),
            ("friction.dissipation", ""),
            ("stop.theta_risen", ""),
            ("stop.theta_fallen", ""),
            ("stop.duration", "20.0"),
        ],
    },
    Preset {
        name: "nutation-free",
        description: "The paper's top, started with almost no nutation: no loops at the end",
        differences: &[
            ("initial.phi_dot", "1.7539"),
            ("initial.theta_dot", "-0.0163"),
        ],
    },
    Preset {
        name: "tilt-torque-only",
        description: "The component of the friction torque about n × e_N alone: rises at constant L_n",
        differences: &[("friction.dissipation", "tilt-torque-only")],
    },
    Preset {
        name: "spin-torque-only",
        description: "The component of the friction torque about the symmetry axis alone: falls",
        differences: &[
            ("friction.dissipation", "spin-torque-only"),
            ("stop.duration", "120.0"),
        ],
    },
    Preset {
        name: "rise-by-loss-of-spin",
        description: "An oblate top in fast precession: it rises while |φ̇| and |ψ̇| decrease (the paper's last paragraph)",
        differences: &[
            ("top.transverse_moment", "1.0e-4"),
            ("top.axial_moment", "1.1e-4"),
            ("initial.phi_dot", "150.0"),
            ("initial.psi_dot", "-10.66"),
            ("friction.dissipation", "full"),
            ("air.axial", "1e-6"),
            ("air.transverse", "1e-6"),
        ],
    },
    Preset {
        name: "viscous",
        description: "Viscous friction: the rise slows as the slip decreases",
        differences: &[
            ("friction.law", "viscous"),
            ("friction.viscous_speed", "0.5"),
            ("friction.dissipation", "full"),
            ("stop.duration", "100.0"),
        ],
    },
    Preset {
        name: "stribeck",
        description: "Stribeck's law: friction grows as the slip decreases",
        differences: &[
            ("friction.law", "stribeck"),
            ("friction.static_k", "0.045"),
            ("friction.stribeck_speed", "0.05"),
            ("friction.viscous_slope", "0.01"),
            ("friction.dissipation", "full"),
        ],
    },
    Preset {
        name: "contensou",
        description: "Coulomb–Contensou friction: drilling smooths the friction force at low slip",
        differences: &[
            ("friction.law", "contensou"),
            ("friction.patch_radius", "1.4e-4"),
            ("friction.dissipation", "full"),
        ],
    },
    Preset {
        name: "lifecycle",
        description: "The life of a top in air: it rises, sleeps, weakens and falls",
        differences: &[
            ("formulation", "body"),
            ("friction.law", "coulomb-sqrt"),
            ("friction.smoothing_speed", "0.05"),
            ("friction.dissipation", "full"),
            ("air.axial", "1.45e-6"),
            ("air.transverse", "4e-6"),
            ("stop.theta_risen", ""),
            ("stop.duration", "120.0"),
        ],
    },
    Preset {
        name: "free-paper",
        description: "The paper's top with a free peg: it hops from 3.24 s on, as its nutation grows, and rolls from 7.10 s on without rising further",
        differences: &[
            ("formulation", "body"),
            ("support.kind", "free"),
            ("friction.dissipation", "full"),
            ("stop.on_stick", "continue"),
            ("stop.duration", "10.0"),
        ],
    },
    Preset {
        name: "free-rolls",
        description: "A free peg with little friction (k = 0.01): it slides and rises for 21.6 s, then rolls and stays inclined",
        differences: &[
            ("formulation", "body"),
            ("support.kind", "free"),
            ("friction.k", "0.01"),
            ("friction.dissipation", "full"),
            ("stop.on_stick", "continue"),
            ("stop.duration", "25.0"),
        ],
    },
    Preset {
        name: "free-viscous",
        description: "A free peg under viscous friction, which can't make it roll: the top rises",
        differences: &[
            ("formulation", "body"),
            ("support.kind", "free"),
            ("friction.law", "viscous"),
            ("friction.viscous_speed", "0.5"),
            ("friction.dissipation", "full"),
        ],
    },
    Preset {
        name: "drop",
        description: "The paper's top dropped from 5 mm: it bounces 21 times in 63 ms, slides, and rolls from 0.63 s on",
        differences: &[
            ("formulation", "body"),
            ("support.kind", "free"),
            ("support.restitution", "0.5"),
            ("initial.height", "0.005"),
            ("friction.k", "0.1"),
            ("friction.dissipation", "full"),
            ("stop.on_stick", "continue"),
            ("stop.duration", "2.0"),
        ],
    },
    Preset {
        name: "tippe-top",
        description: "A tippe top under viscous friction: it inverts and keeps spinning",
        differences: TIPPE_TOP,
    },
    Preset {
        name: "tippe-top-hangs",
        description: "The same tippe top under Coulomb friction: it rolls after 22 ms and never inverts",
        differences: TIPPE_TOP_HANGS,
    },
];

/// A sphere of 40 mm diameter with its centre of mass 6 mm below its centre, spinning at 80 rad/s.
const TIPPE_TOP: &[(&str, &str)] = &[
    ("formulation", "body"),
    ("gravity", "9.82"),
    ("top.mass", "0.020"),
    ("top.transverse_moment", "3.714285714285714e-6"),
    ("top.axial_moment", "3.2e-6"),
    ("top.center_distance", "-0.006"),
    ("top.peg_radius", "0.020"),
    ("initial.theta", "0.1"),
    ("initial.phi_dot", "0.0"),
    ("initial.psi_dot", "80.0"),
    ("initial.center_x_dot", "0.0"),
    ("initial.center_y_dot", "0.0"),
    ("support.kind", "free"),
    ("friction.law", "viscous"),
    ("friction.k", "0.3"),
    ("friction.viscous_speed", "1.0"),
    ("friction.dissipation", "full"),
    ("stop.theta_risen", ""),
    ("stop.theta_fallen", ""),
    ("stop.duration", "12.0"),
];

const TIPPE_TOP_HANGS: &[(&str, &str)] = &[
    ("formulation", "body"),
    ("gravity", "9.82"),
    ("top.mass", "0.020"),
    ("top.transverse_moment", "3.714285714285714e-6"),
    ("top.axial_moment", "3.2e-6"),
    ("top.center_distance", "-0.006"),
    ("top.peg_radius", "0.020"),
    ("initial.theta", "0.1"),
    ("initial.phi_dot", "0.0"),
    ("initial.psi_dot", "80.0"),
    ("initial.center_x_dot", "0.0"),
    ("initial.center_y_dot", "0.0"),
    ("support.kind", "free"),
    ("friction.k", "0.3"),
    ("friction.dissipation", "full"),
    ("stop.theta_risen", ""),
    ("stop.theta_fallen", ""),
    ("stop.on_stick", "continue"),
    ("stop.duration", "5.0"),
];

impl Scenario {
    /// The keys that differ from those of `from`, with their values (`None` if removed). Name and description are
    /// ignored.
    pub fn changes<'a>(
        &'a self,
        from: &'a Values,
    ) -> impl Iterator<Item = (&'static Key, Option<&'a Value>)> {
        let is_text = |key: &Key| matches!(key.path, "format" | "name" | "description");
        let keys = KEYS.iter().filter(move |key| !is_text(key));
        let changes = keys.map(|key| (key, self.value(key.path)));
        changes.filter(|(key, value)| *value != from.get(key.path))
    }

    /// The name, followed by up to two keys that differ from the preset of that name, e.g. `paper, friction.k = 0.02`.
    pub fn title(&self) -> String {
        let preset = PRESETS.iter().find(|preset| preset.name == self.name());
        match preset.map(Preset::values) {
            Some(Ok(preset)) => self.title_from(&preset),
            _ => self.name().to_owned(),
        }
    }

    /// The name, followed by up to two keys that differ from `base`.
    pub fn title_from(&self, base: &Values) -> String {
        let change = |(key, value): (&Key, Option<&Value>)| match value {
            Some(value) => format!(", {} = {}", key.path, value.to_set_notation()),
            None => format!(", without {}", key.path),
        };
        let changes: Vec<_> = self.changes(base).map(change).collect();
        let changes = match changes.len() {
            0..=2 => changes.concat(),
            count => format!(", {count} keys changed"),
        };
        format!("{}{changes}", self.name())
    }
}

impl Preset {
    /// The preset with this name.
    ///
    /// # Errors
    /// [`ScenarioError::UnknownPreset`], which lists all presets.
    pub fn find(name: &str) -> Result<&'static Self, ScenarioError> {
        PRESETS
            .iter()
            .find(|preset| preset.name == name)
            .ok_or_else(|| ScenarioError::UnknownPreset {
                name: name.to_owned(),
                hint: suggestion(name, PRESETS.iter().map(|preset| preset.name)),
                allowed: PRESETS
                    .iter()
                    .map(|p| p.name)
                    .collect::<Vec<_>>()
                    .join(", "),
            })
    }

    /// Its description.
    pub fn description(&self) -> &'static str {
        self.description
    }

    /// Its keys and values.
    ///
    /// # Errors
    /// Never for built-in presets; a test reads them all.
    pub fn values(&self) -> Result<Values, ScenarioError> {
        let mut values = Values::from_toml(PAPER)?;
        values.set("name", self.name)?;
        values.set("description", self.description)?;
        for (key, value) in self.differences {
            values.set(key, value)?;
        }
        Ok(values)
    }

    /// The scenario.
    ///
    /// # Errors
    /// Never for built-in presets; a test reads them all.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::new(self.values()?)
    }
}
