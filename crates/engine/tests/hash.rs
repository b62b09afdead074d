//! The hash of a state: it depends on every number, and on no order.

mod common;

use common::random;
use std::collections::HashSet;
use tdem_engine::physics::bond::Failure;
use tdem_engine::{Bond, BondHistory, Breakage, Contact, State, WallContact};

const PARTICLES: usize = 7;
const WALLS: usize = 4;

/// All real numbers of a state but for its initial energies. A new field does not compile until it is here.
fn reals(state: &mut State) -> Vec<&mut f64> {
    let State {
        step: _,
        forces_known: _,
        initial_energy: _,
        initial_heat: _,
        id: _,
        material: _,
        constraint: _,
        radius,
        mass,
        position,
        image: _,
        velocity,
        angular_velocity,
        force,
        moment,
        orientation,
        bonded_position,
        derivatives,
        accounts,
        wall_position,
        contacts,
        wall_contacts,
        bonds,
        bond_histories,
        temperature,
        heat_rate,
        exposure: _,
        reference_radius,
        heat_accounts,
        work_per_kelvin,
    } = state;
    let histories = bond_histories.iter_mut().flat_map(|history| {
        let BondHistory { normal, tension, shear, couple } = history;
        normal.iter_mut().chain([tension]).chain(shear).chain(couple)
    });
    let bonds = bonds.iter_mut().flat_map(|bond| {
        [&mut bond.strength].into_iter().chain(bond.breakage.as_mut().map(|breakage| &mut breakage.energy))
    });
    [radius, mass, temperature, heat_rate, reference_radius, work_per_kelvin]
        .into_iter()
        .flatten()
        .chain(
            [position, velocity, angular_velocity, force, moment, bonded_position, wall_position]
                .into_iter()
                .flatten()
                .flatten(),
        )
        .chain([orientation, accounts, heat_accounts].into_iter().flatten().flatten())
        .chain(derivatives.iter_mut().flatten().flatten())
        .chain(contacts.iter_mut().flat_map(|contact| &mut contact.displacement))
        .chain(wall_contacts.iter_mut().flat_map(|contact| &mut contact.displacement))
        .chain(bonds)
        .chain(histories)
        .collect()
}

/// A state with a number other than zero at every place.
fn full() -> State {
    let n = PARTICLES;
    let pairs = [[0_u32, 1], [0, 4], [2, 3]];
    let mut state = State {
        step: 12,
        id: (0..n as u32).map(|id| 3 * id).collect(),
        material: vec![1; n],
        constraint: vec![2; n],
        exposure: vec![3; n],
        image: vec![[1, -1, 2]; n],
        radius: vec![0.0; n],
        mass: vec![0.0; n],
        temperature: vec![0.0; n],
        heat_rate: vec![0.0; n],
        reference_radius: vec![0.0; n],
        work_per_kelvin: vec![0.0; n],
        position: vec![[0.0; 3]; n],
        velocity: vec![[0.0; 3]; n],
        angular_velocity: vec![[0.0; 3]; n],
        force: vec![[0.0; 3]; n],
        moment: vec![[0.0; 3]; n],
        bonded_position: vec![[0.0; 3]; n],
        orientation: vec![[0.0; 4]; n],
        accounts: vec![[0.0; 4]; n],
        heat_accounts: vec![[0.0; 4]; n],
        derivatives: vec![[[0.0; 3]; 4]; n],
        wall_position: vec![[0.0; 3]; WALLS],
        contacts: pairs.map(|[a, b]| Contact { first: 3 * a, second: 3 * b, displacement: [0.0; 3] }).to_vec(),
        wall_contacts: [[0, 0], [0, 2], [9, 1]]
            .map(|[particle, wall]| WallContact { particle, wall, displacement: [0.0; 3] })
            .to_vec(),
        bonds: pairs.map(|[a, b]| Bond::new(3 * a, 3 * b, 1.0)).to_vec(),
        bond_histories: vec![BondHistory::default(); pairs.len()],
        ..State::default()
    };
    state.bonds[1].breakage = Some(Breakage { step: 7, failure: Failure::Shear, energy: 0.0 });
    for (k, number) in reals(&mut state).into_iter().enumerate() {
        *number = random(1, k as u64) - 0.5;
    }
    state
}

type Change = Box<dyn Fn(&mut State)>;

/// Changes of single integers.
fn integers_changed() -> Vec<Change> {
    vec![
        Box::new(|state| state.step += 1),
        Box::new(|state| state.id[PARTICLES - 1] += 1),
        Box::new(|state| state.material[1] = 0),
        Box::new(|state| state.material[1] = 2),
        Box::new(|state| state.constraint[1] += 1),
        Box::new(|state| state.exposure[1] += 1),
        Box::new(|state| state.image[1][0] += 1),
        Box::new(|state| state.image[1][1] += 1),
        Box::new(|state| state.contacts[0].second = 9),
        Box::new(|state| state.contacts[1].first = 3),
        Box::new(|state| state.wall_contacts[0].wall = 3),
        Box::new(|state| state.wall_contacts[0].particle = 3),
        Box::new(|state| state.bonds[0].second = 9),
        Box::new(|state| state.bonds[1].first = 3),
        Box::new(|state| state.bonds[1].breakage.as_mut().expect("it broke").step += 1),
        Box::new(|state| state.bonds[1].breakage.as_mut().expect("it broke").failure = Failure::Tension),
        Box::new(|state| state.bonds[0].breakage = state.bonds[1].breakage),
        Box::new(|state| state.contacts.truncate(2)),
        Box::new(|state| state.wall_contacts.truncate(2)),
    ]
}

#[test]
fn every_number_changes_the_hash() {
    let state = full();
    let mut seen = HashSet::from([state.hash()]);
    let count = reals(&mut state.clone()).len();
    assert!(count > 300);
    for k in 0..count {
        for change in [f64::next_up, |_| 0.0] {
            let mut other = state.clone();
            let number = reals(&mut other).swap_remove(k);
            *number = change(*number);
            assert!(seen.insert(other.hash()), "real number {k}");
        }
    }
    for (k, change) in integers_changed().iter().enumerate() {
        let mut other = state.clone();
        change(&mut other);
        assert!(seen.insert(other.hash()), "integer {k}");
    }
    // Two numbers that change places.
    let mut other = state.clone();
    (other.velocity[0], other.velocity[1]) = (state.velocity[1], state.velocity[0]);
    assert!(seen.insert(other.hash()));
    (other.velocity[0], other.force[0]) = (state.force[0], state.velocity[0]);
    assert!(seen.insert(other.hash()));
}

fn rotate<T>(fields: [&mut Vec<T>; 3]) {
    for field in fields {
        field.rotate_left(3);
    }
}

#[test]
fn records_may_have_any_order() {
    let state = full();
    let expected = state.hash();
    let mut other = state.clone();
    other.id.rotate_left(3);
    other.image.rotate_left(3);
    other.derivatives.rotate_left(3);
    rotate([&mut other.material, &mut other.constraint, &mut other.exposure]);
    rotate([&mut other.radius, &mut other.mass, &mut other.temperature]);
    rotate([&mut other.heat_rate, &mut other.reference_radius, &mut other.work_per_kelvin]);
    rotate([&mut other.position, &mut other.velocity, &mut other.angular_velocity]);
    rotate([&mut other.force, &mut other.moment, &mut other.bonded_position]);
    rotate([&mut other.orientation, &mut other.accounts, &mut other.heat_accounts]);
    other.contacts.reverse();
    other.wall_contacts.rotate_left(1);
    other.bonds.reverse();
    other.bond_histories.reverse();
    assert_ne!(other, state);
    assert_eq!(other.hash(), expected);
}

#[test]
fn fields_of_zeros_and_signs_of_zeros_do_not_change_the_hash() {
    let full = full();
    let n = full.len();
    let bare = State {
        exposure: Vec::new(),
        temperature: Vec::new(),
        heat_rate: Vec::new(),
        reference_radius: Vec::new(),
        work_per_kelvin: Vec::new(),
        bonded_position: Vec::new(),
        orientation: Vec::new(),
        accounts: Vec::new(),
        heat_accounts: Vec::new(),
        derivatives: Vec::new(),
        bond_histories: Vec::new(),
        ..full.clone()
    };
    let zeros = State {
        exposure: vec![0; n],
        temperature: vec![0.0; n],
        heat_rate: vec![-0.0; n],
        reference_radius: vec![0.0; n],
        work_per_kelvin: vec![0.0; n],
        bonded_position: vec![[0.0, -0.0, 0.0]; n],
        orientation: vec![[0.0; 4]; n],
        accounts: vec![[0.0; 4]; n],
        heat_accounts: vec![[0.0; 4]; n],
        derivatives: vec![[[0.0; 3]; 4]; n],
        bond_histories: vec![BondHistory::default(); full.bonds.len()],
        ..bare.clone()
    };
    assert_eq!(zeros.hash(), bare.hash());
    assert_ne!(bare.hash(), full.hash());
    let mut other = full.clone();
    other.velocity[3][1] = 0.0;
    let expected = other.hash();
    other.velocity[3][1] = -0.0;
    assert_eq!(other.hash(), expected);
}
