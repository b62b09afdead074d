//! Heat: conduction, surfaces, expansion and its stresses, balance, heat of friction and of dashpots.

mod balance;
mod conduction;
mod expansion;
mod from_case;
mod motion;
mod surfaces;
mod tables;

use super::scene::{HELD, Scene};
use super::{Case, Tier};
use tdem_engine::physics::heat::conduction::{face_centred_bar, pair_conductivity};
use tdem_engine::physics::heat::{Conductor, Dissipation, Exchange, Path};
use tdem_engine::{Around, Course, Exposure, HeatPlan, Motion, Thermal, ThermalTables};

pub(super) const CASES: &[Case] = &[
    Case {
        name: "thermal/two-particles",
        tier: Tier::Quick,
        source: "Euler: (1 - dt H (1/C1 + 1/C2))^n, which tends to e^{-H (1/C1 + 1/C2) t}",
        about: "Two bonded spheres of unequal size exchange heat, the step halved twice: difference, and heat that is kept.",
        body: conduction::two_particles,
    },
    Case {
        name: "thermal/chain-steady",
        tier: Tier::Quick,
        source: "a straight line; H dT/n flows in and out",
        about: "The ends of a chain are held at temperatures: temperatures between them, heat in and out.",
        body: conduction::chain_steady,
    },
    Case {
        name: "thermal/chain-transient",
        tier: Tier::Quick,
        source: "modes cos(k pi (j + 1/2)/N), each by (1 - 4 dt H/C sin^2(k pi/2N))^n",
        about: "An insulated chain of 20 spheres begins with random temperatures: all of them after 200 steps.",
        body: conduction::chain_transient,
    },
    Case {
        name: "thermal/lattice-conductivity",
        tier: Tier::Quick,
        source: "lambda_eff = 4 H/a = lambda with A = sqrt(2) R^2; open sides: 1 - 1/(4 n_x) - 1/(4 n_y) of it, because so many bonds are missing",
        about: "Layers of a face-centred lattice are held at temperatures: what flows along each axis, and between open sides.",
        body: conduction::lattice_conductivity,
    },
    Case {
        name: "thermal/open-sides",
        tier: Tier::Quick,
        source: "lambda A/L by bars thicker by 1/(1 - 1/(4 n_x) - 1/(4 n_y)); 1 - 1/(4 n_x n_y) of it with bonds within sides times 3/2, counted",
        about: "A block of 3 x 2 x 3 cells from a case file with heat.open_sides as cells, then as sides: what flows between its ends.",
        body: from_case::open_sides,
    },
    Case {
        name: "thermal/softened",
        tier: Tier::Quick,
        source: "Hertz: 2 lambda (3 F R*/(4 E*))^(1/3) under the load F, whatever modulus stands for E",
        about: "Two spheres and a floor under a given load, of glass and of softened glass with original_young_modulus: what flows.",
        body: from_case::softened,
    },
    Case {
        name: "thermal/unlike",
        tier: Tier::Quick,
        source: "Euler's rule on paper, lambda_12 = 2 lambda_1 lambda_2/(lambda_1 + lambda_2)",
        about: "A chain of two spheres of concrete and one of steel: temperatures after 30 steps.",
        body: conduction::unlike,
    },
    Case {
        name: "thermal/broken-bond",
        tier: Tier::Quick,
        source: "a bond that broke conducts nothing; a contact conducts by the bar of its own length",
        about: "A bond is torn and its spheres are pressed together again: heat rates before, apart and after.",
        body: conduction::broken_bond,
    },
    Case {
        name: "thermal/contact-circle",
        tier: Tier::Quick,
        source: "H = 2 lambda_12 sqrt(R* h), Batchelor & O'Brien, Proc. R. Soc. A 355 (1977) 313",
        about: "Two unequal spheres pressed together, one of them to a warm wall of another material: heat rates, and 30 steps.",
        body: conduction::contact_circle,
    },
    Case {
        name: "thermal/conductivity-table",
        tier: Tier::Quick,
        source: "Kirchhoff: the integral of lambda dT is straight; H_1/n times its whole flows in and out",
        about: "The ends of a chain whose conductivity falls with temperature are held: temperatures, heat in and out; and by implicit steps.",
        body: tables::conductivity,
    },
    Case {
        name: "thermal/specific-heat-table",
        tier: Tier::Quick,
        source: "the integral of c dT, by trapezia",
        about: "Four spheres are heated and cooled by fluxes along a specific heat with a peak: temperatures at the end.",
        body: tables::specific_heat,
    },
    Case {
        name: "thermal/stiffness-table",
        tier: Tier::Quick,
        source: "F = f(T) K_n u, T the mean of both particles",
        about: "A stretched chain is held and heated, its first sphere colder: forces at both ends.",
        body: tables::stiffness,
    },
    Case {
        name: "thermal/strength-table",
        tier: Tier::Quick,
        source: "s = f(T) s_lim",
        about: "A stretched chain is held and heated in both forms: temperature at which its bonds break.",
        body: tables::strength,
    },
    Case {
        name: "thermal/lumped-cooling",
        tier: Tier::Quick,
        source: "Euler: (1 - dt h A/C)^n, which tends to e^{-h A t/C}; under a flux T = T_0 + A/C times its integral",
        about: "A sphere cools in a fluid, another is heated by a flux that follows a course.",
        body: surfaces::lumped,
    },
    Case {
        name: "thermal/radiation",
        tier: Tier::Quick,
        source: "t = C/(4 eps sigma A a^3) [ln((T - a)/(T + a)) + ...], integrated exactly, with and without depth",
        about: "A hot sphere radiates into cold surroundings, a cold one is heated by hot ones: the time that it takes, from two steps.",
        body: surfaces::radiation,
    },
    Case {
        name: "thermal/one-surface",
        tier: Tier::Quick,
        source: "lambda (T_w - T_s)/L = h (T_s - T_f) + eps sigma (T_s^4 - T_e^4) - q, by halving; T linear between",
        about: "A slab from a warm wall to a face with a fluid, radiation and a flux at once: at rest, its face and its heat.",
        body: surfaces::one_surface,
    },
    Case {
        name: "thermal/semi-infinite",
        tier: Tier::Quick,
        source: "T = T_s erfc(x/(2 sqrt(alpha t))), Carslaw & Jaeger (1959), 2.4",
        about: "The surface of a long column jumps by 100 K: temperatures of all layers when heat has reached 12 of them.",
        body: surfaces::semi_infinite,
    },
    Case {
        name: "thermal/slab",
        tier: Tier::Quick,
        source: "exact: eigenfunctions and ramps (crates/studies/src/slab.rs)",
        about: "Heating of refractory concrete in 56 layers: temperature of the bottom surface from 0.5 to 5.5 h.",
        body: |bench| surfaces::slab(bench, surfaces::Body::Column, 28, 0.05),
    },
    Case {
        name: "thermal/free-expansion",
        tier: Tier::Quick,
        source: "u = alpha dT L, no bond pulls on anything",
        about: "A free block is heated while it moves: elongation along each axis and the greatest force of a bond.",
        body: expansion::free,
    },
    Case {
        name: "thermal/constrained",
        tier: Tier::Quick,
        source: "s = -4 K_n alpha dT/a (1 - 1/(2n)), each bond -K_n L_0 alpha dT",
        about: "A block between six rigid faces is heated: stress on each of them and the force of every bond.",
        body: expansion::constrained,
    },
    Case {
        name: "thermal/uniaxially-constrained",
        tier: Tier::Quick,
        source: "s = -E_100 alpha dT; for the open block E of the static solution in crates/studies/reference/bonded.py",
        about: "A sphere and its neighbours, then a block of 3 x 3 x 3 cells, heated between two rigid faces, free to the sides.",
        body: |bench| expansion::uniaxial(bench, [3, 3, 3], 800, [0.826_802, 0.01]),
    },
    Case {
        name: "thermal/mismatch-series",
        tier: Tier::Quick,
        source: "s = -(alpha_1 + alpha_2) dT/(1/E_1 + 1/E_2) at kappa = 1, where E = C11 and nothing contracts across",
        about: "Two unlike halves one behind the other are heated between rigid walls: stress at both.",
        body: expansion::series,
    },
    Case {
        name: "thermal/mismatch-parallel",
        tier: Tier::Quick,
        source: "F = (alpha_1 - alpha_2) dT/(1/(E_1 A_1) + 1/(E_2 A_2))",
        about: "Two unlike bars, then two bonded layers, between plates that have gone as far as these push them: force and stress in each.",
        body: expansion::parallel,
    },
    Case {
        name: "thermal/restrained-plate",
        tier: Tier::Quick,
        source: "s(z) = -M alpha dT(z), M = C11 + C12 - 2 C12^2/C11; of the lattice with the means of next layers",
        about: "A plate that cannot grow sideways is warmer in the middle than at its faces: stresses of the layers within.",
        body: expansion::restrained_plate,
    },
    Case {
        name: "thermal/free-plate",
        tier: Tier::Quick,
        source: "s(z) = M alpha (mean of T - T(z)); layers at the faces count by the bonds that they have",
        about: "A free plate of 10 x 10 x 4 cells, warmer in the middle than at its faces, at rest: stresses in its middle.",
        body: |bench| expansion::free_plate(bench, [10, 10, 4]),
    },
    Case {
        name: "thermal/time-scale",
        tier: Tier::Quick,
        source: "quasi-static: F = -K_n L alpha mean(dT), whatever S is",
        about: "A chain between rigid ends is heated at one of them, with S and S/2: temperatures and force at the same time of the heat.",
        body: balance::time_scale,
    },
    Case {
        name: "thermal/mass-scaling",
        tier: Tier::Quick,
        source: "u = m g n(n + 1)/(2 K_n) of the true masses; leapfrog sin(a/2) = w dt/2 with w = 2 sqrt(K_n/(beta m)) sin(k/2); Euler with the true m c",
        about: "A chain hangs down, swings and conducts, from a case file with time.mass_scaling 1 and 25: its end, its period, temperatures.",
        body: from_case::mass_scaling,
    },
    Case {
        name: "thermal/balance",
        tier: Tier::Quick,
        source: "first law: heat stored and under way = in - out",
        about: "27 unequal spheres and a bonded chain fly and rub in a box, two of its walls warm, with fluxes, films, radiation and prescribed temperatures, and grow.",
        body: balance::first_law,
    },
    Case {
        name: "thermal/sliding-block",
        tier: Tier::Quick,
        source: "sum of m c dT = mu F_n s",
        about: "A bonded block that rests on the floor by its weight is pushed along it: heat in its spheres.",
        body: motion::sliding_block,
    },
    Case {
        name: "thermal/heat-of-collisions",
        tier: Tier::Quick,
        source: "first law: what the motion loses, heat gains",
        about: "27 spheres collide and rub in an insulated box: energy lost and heat made, by the ledger and in the spheres.",
        body: motion::heat_of_collisions,
    },
    Case {
        name: "thermal/expansion-work",
        tier: Tier::Quick,
        source: "K_n/2 (L alpha dT)^2 for each bond of a held chain; the ledger closes",
        about: "A chain between rigid ends is heated, then a block through two faces that are held: work of expansion, energy in bonds.",
        body: motion::expansion_work,
    },
    Case {
        name: "thermal/slab-55",
        tier: Tier::Full,
        source: "exact: eigenfunctions and ramps (crates/studies/src/slab.rs)",
        about: "The same in 110 layers.",
        body: |bench| surfaces::slab(bench, surfaces::Body::Column, 55, 0.01),
    },
    Case {
        name: "thermal/slab-lattice",
        tier: Tier::Full,
        source: "exact: eigenfunctions and ramps (crates/studies/src/slab.rs)",
        about: "The same in a face-centred lattice of 28 cells whose sides repeat.",
        body: |bench| surfaces::slab(bench, surfaces::Body::Lattice, 28, 0.05),
    },
    Case {
        name: "thermal/slab-open-sides",
        tier: Tier::Full,
        source: "exact: eigenfunctions and ramps (crates/studies/src/slab.rs)",
        about: "The same in a cube of 10 cells with open sides, bars thicker by the bonds that are missing: means of layers.",
        body: |bench| surfaces::slab(bench, surfaces::Body::Block, 10, 0.3),
    },
    Case {
        name: "thermal/uniaxially-constrained-5",
        tier: Tier::Full,
        source: "s = -E_100 alpha dT; for the open block E of the static solution in crates/studies/reference/bonded.py",
        about: "The same with 5 x 5 x 8 cells.",
        body: |bench| expansion::uniaxial(bench, [5, 5, 8], 2500, [0.895_684, 0.005]),
    },
];

/// Temperature to begin with and to count expansions from, K.
const ROOM: f64 = 293.15;
/// Contacts conduct nothing.
const CLOSED: Path = Path::Closed;

/// What a material is to heat.
#[derive(Clone, Copy)]
struct Material {
    conductivity: f64,
    specific_heat: f64,
    expansion: f64,
}

/// Like concrete, but that it does not grow.
const SOLID: Material = Material { conductivity: 1.5, specific_heat: 900.0, expansion: 0.0 };

/// The bar with which a face-centred lattice conducts like the solid, or a block of so many cells across: its section over
/// the square of the sum of radii.
fn face_centred_section(cells: Option<[u32; 2]>) -> f64 {
    let radius = face_centred_bar(cells);
    std::f64::consts::FRAC_PI_4 * radius * radius
}

fn constant(value: f64) -> Course {
    Course(vec![[0.0, value]])
}

/// A temperature that is prescribed.
fn held_at(course: Course) -> Exposure {
    Exposure { temperature: Some(course), exchanges: Vec::new() }
}

/// One exchange with the surroundings.
fn through(exchange: Exchange<f64>, around: Around) -> Exposure {
    Exposure { temperature: None, exchanges: vec![(exchange, around)] }
}

/// A fluid and walls of one temperature, K.
fn furnace(temperature: f64) -> Around {
    Around { fluid: Some(constant(temperature)), surroundings: Some(constant(temperature)), flux: None }
}

/// Nothing goes through.
const NOTHING: Exchange<f64> = Exchange { flux_area: 0.0, conductance: 0.0, radiation: 0.0, resistance: 0.0 };

fn largest_difference(got: &[f64], expected: impl Iterator<Item = f64>) -> f64 {
    got.iter().zip(expected).map(|(got, expected)| (got - expected).abs()).fold(0.0, f64::max)
}

impl Scene {
    /// Adds heat: the materials in their order, the last for those that follow, too; bars of a section over the square of
    /// the sum of radii. All particles are insulated at the temperature of the room.
    fn heat(&mut self, materials: &[Material], section: f64, contacts: Path) {
        let count = self.plan.materials;
        let material = |k: usize| materials[k.min(materials.len() - 1)];
        let conductor = |first: usize, second: usize| {
            let conductivity = pair_conductivity(material(first).conductivity, material(second).conductivity);
            Conductor { conductivity, section }
        };
        let thermal =
            |material: Material| Thermal { specific_heat: material.specific_heat, expansion: material.expansion };
        let heat = HeatPlan {
            dissipation: Dissipation::default(),
            time_scale: 1.0,
            reference_temperature: ROOM,
            materials: (0..count).map(|k| thermal(material(k))).collect(),
            conductors: (0..count * count).map(|k| conductor(k / count, k % count)).collect(),
            tables: ThermalTables::default(),
            contacts,
            exposures: vec![Exposure::default()],
            sides: Vec::new(),
            walls: vec![None; self.plan.walls.len()],
            motion: Motion::Stepped,
        };
        let n = self.state.len();
        self.state.temperature = vec![ROOM; n];
        self.state.heat_rate = vec![0.0; n];
        self.state.exposure = vec![0; n];
        self.state.reference_radius = if heat.expands() { self.state.radius.clone() } else { Vec::new() };
        self.plan.heat = Some(heat);
    }

    /// Sets the step of the heat, s, by the time scale.
    fn heat_step(&mut self, step: f64) {
        if let Some(heat) = &mut self.plan.heat {
            heat.time_scale = step / self.plan.dt;
        }
    }

    /// Gives walls their temperatures, in their order; `None` insulates.
    fn warm_walls(&mut self, walls: &[Option<Course>]) {
        if let Some(heat) = &mut self.plan.heat {
            heat.walls = walls.to_vec();
        }
    }

    /// $mc$, J/K.
    fn capacity(&self, index: usize) -> f64 {
        let material = usize::from(self.state.material[index]);
        self.plan.heat.as_ref().map_or(0.0, |heat| self.state.mass[index] * heat.materials[material].specific_heat)
    }

    /// Exposes particles.
    fn expose(&mut self, particles: &[usize], exposure: &Exposure) {
        if let Some(heat) = &mut self.plan.heat {
            heat.exposures.push(exposure.clone());
            let number = heat.exposures.len() as u16 - 1;
            for &k in particles {
                self.state.exposure[k] = number;
            }
        }
    }

    /// Nothing moves or turns.
    fn hold_all(&mut self) {
        self.state.constraint = vec![self.plan.constraints.len() as u16; self.state.len()];
        self.plan.constraints.push(HELD);
    }
}
