//! Materials and what happens between each two of them.

use crate::build::Conducting;
use crate::codes;
use crate::problem::Problem;
use crate::schema::{Case, Damping, Interaction as Given, Model, Tangential};
use crate::tree::Node;
use tdem_engine::physics::contact::{self, Friction, Interaction, Law, damping::restitution_factor};
use tdem_engine::physics::material::{Elastic, shear_modulus_eff, young_modulus_eff};

/// Name of the built-in, infinitely stiff material of walls.
pub(crate) const RIGID: &str = "rigid";

/// Pairs without an interaction that a message lists.
const MOST_PAIRS: usize = 20;

/// Materials in the order of their indices: by name, the rigid one last.
#[derive(Clone, Debug)]
pub(crate) struct Materials {
    pub(crate) names: Vec<String>,
    pub(crate) elastic: Vec<Elastic>,
    /// With the moduli of the materials that softened ones stand for.
    pub(crate) original: Vec<Elastic>,
    /// Of what moves, so many times the true one as the masses are scaled, kg/m³; the rigid material has none.
    pub(crate) density: Vec<f64>,
    /// What they are to heat, by the mass that moves; the rigid material conducts nothing.
    pub(crate) thermal: Vec<Conducting>,
    /// Index of the entry in the case for each pair, `(materials, materials)`.
    given: Vec<Option<usize>>,
}

impl Materials {
    pub(crate) fn of(case: &Case) -> Self {
        let mut names: Vec<String> = case.material.keys().cloned().collect();
        let mut elastic: Vec<Elastic> = case
            .material
            .values()
            .map(|m| Elastic { young_modulus: m.young_modulus.get(), poisson_ratio: m.poisson_ratio.get() })
            .collect();
        let mut original: Vec<Elastic> = (case.material.values().zip(&elastic))
            .map(|(m, &soft)| Elastic {
                young_modulus: m.original_young_modulus.map_or(soft.young_modulus, crate::schema::Positive::get),
                ..soft
            })
            .collect();
        let scaling = case.time.mass_scaling();
        let mut density: Vec<f64> = case.material.values().map(|m| scaling * m.density.get()).collect();
        let zero = case.heat.as_ref().map_or(0.0, |heat| heat.scale.zero());
        let mut thermal: Vec<Conducting> = case.material.values().map(|of| Conducting::of(of, zero, scaling)).collect();
        names.push(RIGID.to_owned());
        elastic.push(Elastic::RIGID);
        original.push(Elastic::RIGID);
        density.push(f64::INFINITY);
        thermal.push(Conducting::nothing());
        let count = names.len();
        let mut materials = Materials { names, elastic, original, density, thermal, given: vec![None; count * count] };
        for (k, interaction) in case.interaction.iter().enumerate() {
            let [a, b] = interaction.between.each_ref().map(|name| usize::from(materials.index(name)));
            materials.given[a * count + b] = Some(k);
            materials.given[b * count + a] = Some(k);
        }
        materials
    }

    pub(crate) fn len(&self) -> usize {
        self.names.len()
    }

    /// Index of a material that the checks have found to exist.
    pub(crate) fn index(&self, name: &str) -> u16 {
        self.names.iter().position(|n| n == name).unwrap_or(self.names.len() - 1) as u16
    }

    /// The entry of the case for a pair.
    pub(crate) fn given(&self, a: usize, b: usize) -> Option<usize> {
        self.given[a * self.len() + b]
    }

    /// Pairs that can meet: particles of a material among themselves if there are two, with other particles, with walls.
    pub(crate) fn meeting(&self, particles: &[usize], walls: &[bool]) -> Vec<(usize, usize)> {
        let count = self.len();
        let mut pairs = Vec::new();
        for a in 0..count {
            for b in a..count {
                let among = if a == b { particles[a] > 1 } else { particles[a] > 0 && particles[b] > 0 };
                let with_wall = (particles[a] > 0 && walls[b]) || (particles[b] > 0 && walls[a]);
                if among || with_wall {
                    pairs.push((a, b));
                }
            }
        }
        pairs
    }

    /// The pairs that can meet and have no interaction.
    pub(crate) fn missing(&self, case: &Case, tree: &Node, meeting: &[(usize, usize)]) -> Vec<Problem> {
        let missing: Vec<(usize, usize)> =
            meeting.iter().copied().filter(|&(a, b)| self.given(a, b).is_none()).collect();
        if missing.is_empty() {
            return Vec::new();
        }
        let mut pairs: Vec<String> = (missing.iter().take(MOST_PAIRS))
            .map(|&(a, b)| format!("[\"{}\", \"{}\"]", self.names[a], self.names[b]))
            .collect();
        if missing.len() > MOST_PAIRS {
            pairs.push(format!("{} other pairs", missing.len() - MOST_PAIRS));
        }
        let place = if case.interaction.is_empty() {
            tree.key_place(&["material", &self.names[missing[0].0]])
        } else {
            tree.place(&["interaction", &(case.interaction.len() - 1).to_string(), "between"])
        };
        vec![
            Problem::new(
                codes::MISSING_INTERACTION,
                format!("nothing says what happens between {}", pairs.join(" and ")),
            )
            .at(
                place,
                if case.interaction.is_empty() { "particles of this can meet others" } else { "the last one given" },
            )
            .help(format!("add an [[interaction]] with between = {} and its coefficients", pairs[0])),
        ]
    }

    /// Parameters of all pairs, row by row. Pairs that never meet are empty.
    pub(crate) fn interactions(&self, case: &Case) -> Vec<Interaction<f64>> {
        let count = self.len();
        (0..count * count).map(|k| self.interaction(case, k / count, k % count)).collect()
    }

    fn interaction(&self, case: &Case, a: usize, b: usize) -> Interaction<f64> {
        let least_normal_force = if case.contact.clamp { 0.0 } else { f64::NEG_INFINITY };
        let Some(given) = self.given(a, b).map(|k| &case.interaction[k]) else {
            return Interaction {
                normal_stiffness: 0.0,
                tangential_stiffness: 0.0,
                normal_damping: 0.0,
                tangential_damping: 0.0,
                static_friction: 0.0,
                dynamic_friction: 0.0,
                least_normal_force,
            };
        };
        let (first, second) = (self.elastic[a], self.elastic[b]);
        let number = |value: Option<crate::schema::NonNegative>| value.map_or(0.0, crate::schema::NonNegative::get);
        Interaction {
            normal_stiffness: 4.0 / 3.0 * young_modulus_eff(first, second),
            tangential_stiffness: case.contact.tangential_coefficient.get() * shear_modulus_eff(first, second),
            normal_damping: normal_damping(case.contact.damping, given),
            tangential_damping: number(given.tangential_damping),
            static_friction: number(given.static_friction),
            dynamic_friction: number(given.dynamic_friction),
            least_normal_force,
        }
    }
}

fn normal_damping(damping: Damping, given: &Given) -> f64 {
    match damping {
        Damping::Viscous => given.normal_damping.map_or(0.0, crate::schema::NonNegative::get),
        Damping::Restitution => given.restitution.map_or(0.0, |e| restitution_factor(e.get())),
    }
}

/// The contact law of a case.
pub(crate) fn law(case: &Case) -> Law {
    let friction = match (case.model, case.contact.tangential) {
        (Model::GN, _) => Friction::Off,
        (_, Tangential::Displacement) => Friction::Displacement,
        (_, Tangential::Rescaled) => Friction::Rescaled,
    };
    let damping = match case.contact.damping {
        Damping::Viscous => contact::Damping::Viscous,
        Damping::Restitution => contact::Damping::Restitution,
    };
    Law { damping, friction, moments: case.model.turns() }
}
