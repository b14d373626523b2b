//! The table of the laws of friction: what there is to choose, for people.

use super::key::{Key, Presence};
use super::keys::KEYS;
use super::words::{SLIDING_LAWS, SlidingLaw};

/// A law of friction, as a scenario names it.
#[derive(Debug)]
pub struct Law {
    /// Its word under `friction.law`, or the section that adds it to any law.
    pub name: &'static str,
    /// Force or torque. `f` is the friction force, `v` the slip velocity, `N` the normal force, `ω` the
    /// angular velocity, `ω_⊥` its horizontal part, `w_n` its part along the symmetry axis `n`, `w_t` the
    /// rest; `M` is a torque about the peg's centre.
    pub formula: &'static str,
    /// Typical values of its parameters.
    pub typical: &'static str,
    /// Who wrote about it.
    pub source: &'static str,
}

const ZHURAVLEV: &str = "V. F. Zhuravlev, J. Appl. Math. Mech. 62 (1998) 705";

const fn law(
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
    }
}

/// All laws: those of sliding in the order of `friction.law`, then those that add to any of them.
#[rustfmt::skip]
pub const LAWS: &[Law] = &[
    law(SlidingLaw::None.word(), "f = 0", "", ""),
    law(SlidingLaw::Coulomb.word(), "f = −k N v/|v|; at rest any up to k N",
        "k: steel on PTFE 0.04, lubricated 0.05 to 0.1, steel on plastic 0.2 to 0.3",
        "V. Tanrıverdi, arXiv:2204.14060, section 2"),
    law(SlidingLaw::CoulombSqrt.word(), "f = −k N v/√(v² + v_ε²)", "v_ε: 0.001 to 0.01 m/s",
        "usual regularisation of Coulomb's law"),
    law(SlidingLaw::CoulombTanh.word(), "f = −k N tanh(|v|/v_ε) v/|v|", "v_ε: 0.001 to 0.01 m/s",
        "usual regularisation of Coulomb's law"),
    law(SlidingLaw::CoulombRational.word(), "f = −k N v/(|v| + v_ε)", "v_ε: 0.001 to 0.01 m/s",
        "T. Ueda, K. Sasaki, S. Watanabe, SIAM J. Appl. Dyn. Syst. 4 (2005) 1159"),
    law(SlidingLaw::Viscous.word(), "f = −k N v/v_0", "k/v_0: 0.3 s/m",
        "N. M. Bou-Rabee, J. E. Marsden, L. A. Romero, SIAM J. Appl. Dyn. Syst. 3 (2004) 352"),
    law(SlidingLaw::Stribeck.word(), "f = −N (k + (k_s − k) exp(−(v/v_s)²) + c_v |v|) v/|v|; at rest any up to k_s N",
        "k_s/k: 1.2 to 1.7; v_s: 0.01 to 0.1 m/s",
        "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083"),
    law(SlidingLaw::Contensou.word(), "f = −k N v/(|v| + 8 a |ω_z′|/3π), M_z′ = −(3π/16) k N a · a ω_z′/(a |ω_z′| + 15π |v|/16)",
        "a = (3 N R/4 E*)^(1/3): 0.14 mm for E* = 2 GPa", ZHURAVLEV),
    law("rolling", "M = −δ N ω_⊥/|ω_⊥|; without rolling any up to δ N", "δ: 0.01 to 0.3 mm",
        "R. Cross, Am. J. Phys. 81 (2013) 280"),
    law("drilling", "M_z′ = −(3π/16) k N a sgn ω_z′", "a: as for contensou", ZHURAVLEV),
    law("air", "M = −c_n w_n n − c_t w_t − c |w_n|^(1/2) w_n n", "c_n/I_z: 0.002 to 0.01 1/s",
        "T. von Kármán, Z. Angew. Math. Mech. 1 (1921) 233 (the last term)"),
];

impl Law {
    /// Whether it is a word of `friction.law`; else it adds to any of those.
    #[must_use]
    pub fn is_sliding(&self) -> bool {
        SLIDING_LAWS.contains(&self.name)
    }

    /// The keys of its parameters.
    pub fn parameters(&self) -> impl Iterator<Item = &'static Key> {
        let is_own = |key: &&Key| match key.presence {
            Presence::With("friction.law", words) => words.contains(&self.name),
            Presence::Required
            | Presence::Optional
            | Presence::With(..)
            | Presence::Beside(_)
            | Presence::OptionalWith(..) => key
                .path
                .split_once('.')
                .is_some_and(|(section, _)| section == self.name),
        };
        let is_parameter = |key: &&Key| !key.kind.is_text();
        KEYS.iter().filter(is_parameter).filter(is_own)
    }
}
