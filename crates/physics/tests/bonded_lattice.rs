//! Verification: chains and blocks of bonds against closed forms and static solutions. The stiffness of a bond is
//! taken from the law itself, by differences, and assembled into a linear system.

use std::f64::consts::{PI, SQRT_2};
use tdem_physics::bond::{
    self, Bond, Cement, Damping, Ends, Posture, Section, face_centred, section::stiffness_per_area,
};
use tdem_physics::contact::Sphere;
use tdem_physics::motion::orientation::Quaternion;
use tdem_physics::{Vec3, vec3};

/// Displacements and rotations of one particle, forces and moments on it.
const DEGREES: usize = 6;

/// Equal particles and the same bond between them.
struct Assembly {
    places: Vec<Vec3<f64>>,
    radius: f64,
    bond: Bond<f64>,
    /// Pairs that are bonded.
    bonds: Vec<[usize; 2]>,
}

/// Forces and moments on both ends of a bond whose ends moved and turned a little.
fn forces(bond: &Bond<f64>, radius: f64, offset: Vec3<f64>, strain: f64, moved: &[f64; 12]) -> [f64; 12] {
    let part = |k: usize| vec3(moved[k], moved[k + 1], moved[k + 2]);
    let sphere =
        Sphere { position: Vec3::zero(), radius, velocity: Vec3::zero(), mass: 1.0, angular_velocity: Vec3::zero() };
    let posture = Posture {
        bonded_offset: offset,
        first_orientation: Quaternion::identity().turned(part(3), 1.0),
        second_orientation: Quaternion::identity().turned(part(9), 1.0),
        free_strain: strain,
    };
    let ends = Ends { first: sphere, second: sphere, offset: offset + part(6) - part(0), lead: 0.0 };
    let r = bond::respond_total(Damping::Off, &ends, &posture, bond);
    let rows: [[f64; 3]; 4] = [r.force, r.first_moment, -r.force, r.second_moment].map(Into::into);
    std::array::from_fn(|k| rows[k / 3][k % 3])
}

impl Assembly {
    fn unknowns(&self) -> usize {
        DEGREES * self.places.len()
    }
    fn degrees(pair: [usize; 2]) -> [usize; 12] {
        std::array::from_fn(|k| DEGREES * pair[k / DEGREES] + k % DEGREES)
    }
    fn offset(&self, [first, second]: [usize; 2]) -> Vec3<f64> {
        self.places[second] - self.places[first]
    }
    /// Row by row: the force at a degree of freedom, negated, per displacement of another.
    fn stiffness(&self) -> Vec<Vec<f64>> {
        let step = 1e-6 * self.radius;
        let mut matrix = vec![vec![0.0; self.unknowns()]; self.unknowns()];
        for &pair in &self.bonds {
            let degrees = Self::degrees(pair);
            for moved in 0..12 {
                // Angles are steps relative to the radius.
                let step = if moved % DEGREES < 3 { step } else { step / self.radius };
                let at = |step: f64| {
                    let displacements = std::array::from_fn(|k| if k == moved { step } else { 0.0 });
                    forces(&self.bond, self.radius, self.offset(pair), 0.0, &displacements)
                };
                let (ahead, behind) = (at(step), at(-step));
                for k in 0..12 {
                    matrix[degrees[k]][degrees[moved]] -= (ahead[k] - behind[k]) / (2.0 * step);
                }
            }
        }
        matrix
    }
    /// Forces that bonds exert where nothing moves and everything would like to expand.
    fn thermal_forces(&self, strain: f64) -> Vec<f64> {
        let mut sum = vec![0.0; self.unknowns()];
        for &pair in &self.bonds {
            let exerted = forces(&self.bond, self.radius, self.offset(pair), strain, &[0.0; 12]);
            for (degree, force) in Self::degrees(pair).into_iter().zip(exerted) {
                sum[degree] += force;
            }
        }
        sum
    }
}

/// Solves for the displacements that are not given, under the given forces; returns all displacements and the forces
/// that hold the given ones.
fn solve(stiffness: &[Vec<f64>], forces: &[f64], given: &[Option<f64>]) -> (Vec<f64>, Vec<f64>) {
    let mut displacements: Vec<f64> = given.iter().map(|value| value.unwrap_or(0.0)).collect();
    let times =
        |u: &[f64]| -> Vec<f64> { stiffness.iter().map(|row| row.iter().zip(u).map(|(k, u)| k * u).sum()).collect() };
    let held = times(&displacements);
    let free: Vec<usize> = (0..given.len()).filter(|&degree| given[degree].is_none()).collect();
    let mut system: Vec<Vec<f64>> = free
        .iter()
        .map(|&row| {
            let mut equation: Vec<f64> = free.iter().map(|&column| stiffness[row][column]).collect();
            equation.push(forces[row] - held[row]);
            equation
        })
        .collect();
    let size = free.len();
    // The matrix is positive definite, so pivots need not be chosen.
    for pivot in 0..size {
        let (done, rest) = system.split_at_mut(pivot + 1);
        let upper = &done[pivot];
        for row in rest {
            let factor = row[pivot] / upper[pivot];
            if factor != 0.0 {
                for column in pivot..=size {
                    row[column] -= factor * upper[column];
                }
            }
        }
    }
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size).map(|column| system[row][column] * displacements[free[column]]).sum();
        displacements[free[row]] = (system[row][size] - known) / system[row][row];
    }
    let reactions = times(&displacements).iter().zip(forces).map(|(inner, outer)| inner - outer).collect();
    (displacements, reactions)
}

fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{a} is not {b}");
}

fn cement(stiffness_ratio: f64, radius_multiplier: f64) -> Cement<f64> {
    Cement {
        stiffness_ratio,
        radius_multiplier,
        tensile_strength: f64::INFINITY,
        shear_strength: f64::INFINITY,
        internal_friction: 0.0,
        moment_contribution: 1.0,
        damping_ratio: 0.0,
    }
}

/// Golden: the flexibilities of chains in gear_bond_reference.out (R = 1, l = 2, E = 1, kappa = 0.4, lambda = 0.8), and
/// the closed forms of the discrete chain.
#[test]
fn chains_stretch_bend_and_twist_as_the_reference() {
    for (count, axial, bending, torsion) in [
        (1, 0.994_718_394_3, 8.703_785_95, 7.771_237_46),
        (2, 1.989_436_788_6, 67.143_491_62, 15.542_474_91),
        (5, 4.973_591_971_6, 1_038.237_324_08, 38.856_187_28),
        (10, 9.947_183_943_2, 8_293.464_612_68, 77.712_374_56),
    ] {
        let cement = cement(0.4, 0.8);
        let section = Section::between(cement.radius_multiplier, 1.0, 1.0);
        let bond = Bond::new(&cement, &section, stiffness_per_area(1.0, 2.0));
        let chain = Assembly {
            places: (0..=count).map(|k| vec3(2.0 * f64::from(k), 0.0, 0.0)).collect(),
            radius: 1.0,
            bond,
            bonds: (0..count as usize).map(|k| [k, k + 1]).collect(),
        };
        let stiffness = chain.stiffness();
        let given: Vec<Option<f64>> = (0..chain.unknowns()).map(|degree| (degree < DEGREES).then_some(0.0)).collect();
        let tip = |direction: usize| {
            let degree = DEGREES * count as usize + direction;
            let mut forces = vec![0.0; chain.unknowns()];
            forces[degree] = 1.0;
            solve(&stiffness, &forces, &given).0[degree]
        };
        close(tip(0), axial, 1e-8);
        close(tip(1), bending, 1e-8);
        close(tip(2), bending, 1e-8);
        close(tip(3), torsion, 1e-8);
        let n = f64::from(count);
        let discrete = 4.0 * n * (4.0 * n * n - 1.0) / (12.0 * bond.stiffness.bending) + n / bond.stiffness.shear;
        close(tip(1), discrete, 1e-8);
    }
}

/// A block of face-centred cubic cells of size 1, normal stiffness 1, bond radius that of the particles, and its places
/// in half cells.
fn block(cells: [i32; 3], stiffness_ratio: f64) -> (Assembly, Vec<[i32; 3]>) {
    let radius = 0.5 * face_centred::bond_length(1.0);
    let section = Section::between(1.0, radius, radius);
    let bond = Bond::new(&cement(stiffness_ratio, 1.0), &section, 1.0 / section.area);
    let mut sites = Vec::new();
    for x in 0..2 * cells[0] {
        for y in 0..2 * cells[1] {
            for z in 0..2 * cells[2] {
                if (x + y + z) % 2 == 0 {
                    sites.push([x, y, z]);
                }
            }
        }
    }
    let apart = |a: [i32; 3], b: [i32; 3]| (0..3).map(|c| (a[c] - b[c]).pow(2)).sum::<i32>();
    let mut bonds = Vec::new();
    for first in 0..sites.len() {
        for second in first + 1..sites.len() {
            if apart(sites[first], sites[second]) == 2 {
                bonds.push([first, second]);
            }
        }
    }
    let places = sites.iter().map(|site| Vec3::from(site.map(|c| 0.5 * f64::from(c)))).collect();
    (Assembly { places, radius, bond, bonds }, sites)
}

/// Golden: block_reference.out, 3 x 3 x 3 cells, kappa = 1/3: the modulus from grip to grip over that of the lattice.
#[test]
fn a_block_in_tension_has_the_modulus_of_the_reference() {
    let (block, sites) = block([3, 3, 3], 1.0 / 3.0);
    let (top, strain) = (5, 1e-3);
    let height = 0.5 * f64::from(top);
    let mut given = vec![None; block.unknowns()];
    for (particle, site) in sites.iter().enumerate() {
        if site[2] == 0 || site[2] == top {
            given[DEGREES * particle + 2] = Some(if site[2] == 0 { 0.0 } else { strain * height });
        }
    }
    // No rigid motion: one corner fixed, another particle of its edge kept from turning about it.
    let corner = sites.iter().position(|&site| site == [0, 0, 0]).unwrap();
    let along = sites.iter().rposition(|&[_, y, z]| y == 0 && z == 0).unwrap();
    for degree in [DEGREES * corner, DEGREES * corner + 1, DEGREES * along + 1] {
        given[degree] = Some(0.0);
    }
    let (_, reactions) = solve(&block.stiffness(), &vec![0.0; block.unknowns()], &given);
    let pull: f64 = (0..sites.len()).filter(|&p| sites[p][2] == top).map(|p| reactions[DEGREES * p + 2]).sum();
    let lattice = face_centred::CubicElasticity::of_bonds(1.0, 1.0 / 3.0, 1.0).young_modulus();
    let ratio = pull / 9.0 / strain / lattice;
    assert!((ratio - 0.8268).abs() < 1e-4, "{ratio}");
    assert!((ratio / face_centred::open_sides([3, 3]) - 0.992).abs() < 1e-3);
}

/// Golden: block_reference.out, 3 x 3 x 3 cells that cannot expand: the stress over -4 K_n alpha dT / a is 0.83333.
#[test]
fn a_heated_block_between_rigid_walls_presses_as_the_reference() {
    let (block, sites) = block([3, 3, 3], 1.0 / 3.0);
    let (last, strain) = (5, 1e-6);
    let mut given = vec![None; block.unknowns()];
    for (particle, site) in sites.iter().enumerate() {
        for component in 0..3 {
            if site[component] == 0 || site[component] == last {
                given[DEGREES * particle + component] = Some(0.0);
            }
        }
    }
    let (displacements, reactions) = solve(&block.stiffness(), &block.thermal_forces(strain), &given);
    let push: f64 = (0..sites.len()).filter(|&p| sites[p][2] == last).map(|p| reactions[DEGREES * p + 2]).sum();
    let ratio = push / 9.0 / (-4.0 * strain);
    assert!((ratio - 0.83333).abs() < 1e-5, "{ratio}");
    assert!((ratio - face_centred::open_sides([3, 3])).abs() < 1e-8, "exact");
    assert!(displacements.iter().all(|u| u.abs() < strain), "and the middle hardly moves");
}

/// Verification: stress = C : strain for the lattice, by the virial of the bonds of one particle, to first order.
#[test]
fn a_uniform_strain_gives_the_stress_of_the_lattice() {
    let ratio = 1.0 / 3.0;
    let elasticity = face_centred::CubicElasticity::of_bonds(1.0, ratio, 1.0);
    let (block, _) = block([1, 1, 1], ratio);
    let sphere = |radius: f64| Sphere {
        position: Vec3::zero(),
        radius,
        velocity: Vec3::zero(),
        mass: 1.0,
        angular_velocity: Vec3::zero(),
    };
    let stress = |stretch: Vec3<f64>, slide: f64| {
        let mut sum = [0.0; 3];
        let half = 0.5;
        for direction in [
            vec3(half, half, 0.0),
            vec3(half, -half, 0.0),
            vec3(half, 0.0, half),
            vec3(half, 0.0, -half),
            vec3(0.0, half, half),
            vec3(0.0, half, -half),
        ] {
            let moved = vec3(
                direction.x * stretch.x,
                direction.y * stretch.y + 0.5 * slide * direction.z,
                direction.z * stretch.z + 0.5 * slide * direction.y,
            );
            let ends = Ends {
                first: sphere(block.radius),
                second: sphere(block.radius),
                offset: direction + moved,
                lead: 0.0,
            };
            let posture = Posture {
                bonded_offset: direction,
                first_orientation: Quaternion::identity(),
                second_orientation: Quaternion::identity(),
                free_strain: 0.0,
            };
            let force = bond::respond_total(Damping::Off, &ends, &posture, &block.bond).force;
            // A particle to a quarter of a cell.
            sum[0] += 4.0 * force.x * direction.x;
            sum[1] += 4.0 * force.y * direction.y;
            sum[2] += 4.0 * force.y * direction.z;
        }
        sum
    };
    let strain = 1e-8;
    let [along, across, _] = stress(vec3(strain, 0.0, 0.0), 0.0);
    close(along / strain, elasticity.c11, 1e-7);
    close(across / strain, elasticity.c12, 1e-7);
    let [_, _, sheared] = stress(Vec3::zero(), strain);
    close(sheared / strain, elasticity.c44, 1e-7);
}

/// Verification: bonds under a uniaxial load along a cube axis, and the strength that follows.
#[test]
fn the_tensile_strength_of_the_lattice_is_that_of_its_bonds() {
    let (ratio, f_t, strain_per_stress) = (1.0 / 3.0, 2.9e6, 1.0 / 30e9);
    let (lattice_constant, radius) = (2e-3, 0.5 * face_centred::bond_length(2e-3));
    let multiplier = 0.7;
    let section = Section::between(multiplier, radius, radius);
    let stiffness = face_centred::normal_stiffness(30e9, ratio, lattice_constant);
    let strengths =
        Cement { tensile_strength: face_centred::tensile_stress(f_t, ratio, multiplier), ..cement(ratio, multiplier) };
    let bond = Bond::new(&strengths, &section, stiffness / section.area);
    let sphere =
        Sphere { position: Vec3::zero(), radius, velocity: Vec3::zero(), mass: 1.0, angular_velocity: Vec3::zero() };
    let under = |stress: f64| {
        let strain = stress * strain_per_stress;
        let bonded_offset = vec3(0.5 * lattice_constant, 0.5 * lattice_constant, 0.0);
        let offset = vec3(bonded_offset.x * (1.0 + strain), bonded_offset.y * (1.0 - 0.2 * strain), 0.0);
        let posture = Posture {
            bonded_offset,
            first_orientation: Quaternion::identity(),
            second_orientation: Quaternion::identity(),
            free_strain: 0.0,
        };
        bond::respond_total(Damping::Off, &Ends { first: sphere, second: sphere, offset, lead: 0.0 }, &posture, &bond)
    };
    assert_eq!(under(0.999 * f_t).failure, 0.0);
    assert_eq!(under(1.001 * f_t).failure, bond::Failure::Tension.code());
    let reaction = under(f_t);
    close(reaction.stress.shear, face_centred::shear_stress(f_t, ratio, multiplier), 1e-3);
    // |F_n| = sqrt(2) R^2 S (1 + kappa) / (1 + 3 kappa).
    close(reaction.load.normal, SQRT_2 * radius * radius * f_t * (1.0 + ratio) / (1.0 + 3.0 * ratio), 1e-3);
    assert!((section.area / (PI * multiplier * multiplier * radius * radius) - 1.0).abs() < 1e-14);
}
