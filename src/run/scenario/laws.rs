//! The table of friction laws: names, formulas, sources and constructors.

use super::error::ScenarioError;
use crate::physics::friction::{FrictionLaw, Smoothing};

/// A friction law of a scenario.
#[derive(Debug)]
pub struct Law {
    /// Value of `friction.law`, or the section of an additional loss.
    pub name: &'static str,
    /// Force or torque. `f` is the friction force, `v` the slip velocity, `N` the normal force, `ω` the
    /// angular velocity, `ω_⊥` its horizontal part, `w_n` its part along the symmetry axis `n`, `w_t` the
    /// rest; `M` is a torque about the peg's centre.
    pub formula: &'static str,
    /// Typical values of the parameters.
    pub typical: &'static str,
    /// Publication.
    pub source: &'static str,
    /// Constructs the sliding law from its keys; `None` for additional losses.
    make: Option<MakeLaw>,
}

/// The keys of a scenario from which a law is made.
pub(super) trait LawKeys {
    /// The number of a key that is required.
    fn number(&self, path: &'static str) -> Result<f64, ScenarioError>;
    /// The law of `friction.formula`.
    fn formula_law(&self) -> Result<FrictionLaw, ScenarioError>;
}

/// Constructs a sliding law from the values of its keys.
pub(super) type MakeLaw = fn(&dyn LawKeys) -> Result<FrictionLaw, ScenarioError>;

const ZHURAVLEV: &str = "V. F. Zhuravlev, J. Appl. Math. Mech. 62 (1998) 705";

const fn sliding(
    name: &'static str,
    formula: &'static str,
    typical: &'static str,
    source: &'static str,
    make: MakeLaw,
) -> Law {
    Law {
        make: Some(make),
        ..additional_loss(name, formula, typical, source)
    }
}

const fn additional_loss(
    name: &'static str,
    formula: &'static str,
    typical: &'static str,
    source: &'static str,
) -> Law {
    Law {
        name,
        formula,
        typical,
        source,
        make: None,
    }
}

fn regularised(keys: &dyn LawKeys, shape: Smoothing) -> Result<FrictionLaw, ScenarioError> {
    Ok(FrictionLaw::Regularised {
        k: keys.number("friction.k")?,
        speed: keys.number("friction.smoothing_speed")?,
        shape,
    })
}

/// All laws: the sliding laws in the order of `friction.law`, then the additional losses.
#[rustfmt::skip]
pub const LAWS: &[Law] = &[
    sliding("none", "f = 0", "", "", |_| Ok(FrictionLaw::None)),
    sliding("coulomb", "f = −k N v/|v|; at rest |f| ≤ k N",
        "k: steel on PTFE 0.04, lubricated 0.05 to 0.1, steel on plastic 0.2 to 0.3",
        "V. Tanrıverdi, arXiv:2204.14060, section 2",
        |keys| Ok(FrictionLaw::Coulomb { k: keys.number("friction.k")? })),
    sliding("coulomb-sqrt", "f = −k N v/√(v² + v_ε²)", "v_ε: 0.001 to 0.01 m/s",
        "usual regularisation of Coulomb's law",
        |keys| regularised(keys, Smoothing::SquareRoot)),
    sliding("coulomb-tanh", "f = −k N tanh(|v|/v_ε) v/|v|", "v_ε: 0.001 to 0.01 m/s",
        "usual regularisation of Coulomb's law",
        |keys| regularised(keys, Smoothing::Tanh)),
    sliding("coulomb-rational", "f = −k N v/(|v| + v_ε)", "v_ε: 0.001 to 0.01 m/s",
        "T. Ueda, K. Sasaki, S. Watanabe, SIAM J. Appl. Dyn. Syst. 4 (2005) 1159",
        |keys| regularised(keys, Smoothing::Rational)),
    sliding("viscous", "f = −k N v/v_0", "k/v_0: 0.3 s/m",
        "N. M. Bou-Rabee, J. E. Marsden, L. A. Romero, SIAM J. Appl. Dyn. Syst. 3 (2004) 352",
        |keys| Ok(FrictionLaw::Viscous {
            k: keys.number("friction.k")?,
            speed: keys.number("friction.viscous_speed")?,
        })),
    sliding("stribeck", "f = −N (k + (k_s − k) exp(−(v/v_s)²) + c_v |v|) v/|v|; at rest |f| ≤ k_s N",
        "k_s/k: 1.2 to 1.7; v_s: 0.01 to 0.1 m/s",
        "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083",
        |keys| Ok(FrictionLaw::Stribeck {
            k: keys.number("friction.k")?,
            static_k: keys.number("friction.static_k")?,
            speed: keys.number("friction.stribeck_speed")?,
            slope: keys.number("friction.viscous_slope")?,
        })),
    sliding("contensou", "f = −k N v/(|v| + 8 a |ω_z′|/3π), M_z′ = −(3π/16) k N a · a ω_z′/(a |ω_z′| + 15π |v|/16)",
        "a = (3 N R/4 E*)^(1/3): 0.14 mm for E* = 2 GPa", ZHURAVLEV,
        |keys| Ok(FrictionLaw::Contensou {
            k: keys.number("friction.k")?,
            patch_radius: keys.number("friction.patch_radius")?,
        })),
    sliding("formula", "f = −μ(v) N v/|v| with μ(v) = friction.formula; at rest |f| ≤ μ(0) N, or k_s N if it is set",
        "friction.formula: k*tanh(v/a), k*(1 + a*exp(-(v/b)^2)) + c*v", "your own; docs/laws.md has the grammar",
        |keys| keys.formula_law()),
    additional_loss("rolling", "M = −δ N ω_⊥/|ω_⊥|; without rolling |M| ≤ δ N", "δ: 0.01 to 0.3 mm",
        "R. Cross, Am. J. Phys. 81 (2013) 280"),
    additional_loss("drilling", "M_z′ = −(3π/16) k N a sgn ω_z′; without turning |M_z′| ≤ (3π/16) k N a", "a: as for contensou", ZHURAVLEV),
    additional_loss("air", "M = −c_n w_n n − c_t w_t − c |w_n|^(1/2) w_n n", "c_n/I_z: 0.002 to 0.01 1/s",
        "T. von Kármán, Z. Angew. Math. Mech. 1 (1921) 233 (the last term)"),
];

/// The values of `friction.law`.
pub(super) const SLIDING_LAWS: &[&str] = &sliding_laws::<{ count_of_sliding_laws() }>();
/// All sliding laws except `none`.
pub(super) const FRICTIONAL_LAWS: &[&str] = SLIDING_LAWS.split_at(1).1;

/// The law of `friction.formula`, as a list of words.
pub(super) const FORMULA: &[&str] = &["formula"];

const fn count_of_sliding_laws() -> usize {
    let mut count = 0;
    // The sliding laws come first. A loop, because iterators don't work in constants.
    while LAWS[count].make.is_some() {
        count += 1;
    }
    count
}

const fn sliding_laws<const N: usize>() -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = LAWS[i].name;
        i += 1;
    }
    words
}

impl Law {
    /// Whether it is a sliding law rather than an additional loss.
    pub fn is_sliding(&self) -> bool {
        self.make.is_some()
    }
}

/// The constructor of the sliding law with this name.
pub(super) fn find_sliding_law(word: &str) -> Option<MakeLaw> {
    LAWS.iter().find(|law| law.name == word)?.make
}
