//! Bonds in working order.

use super::bodies::Quad;
use super::neighbours::indices_by_rank;
use crate::heat::filled;
use crate::{Bond, BondHistory, Plan, State};
use tdem_physics::bond;
use tdem_physics::bond::{Cement, Joint};
use tdem_physics::heat::Link;

/// The bonds of a run. `B` is the number of bonds, `N` of particles.
///
/// A bond stands in the row of its particle of lower rank, in the order of the other's rank; the other particle finds it
/// through `incoming`. Rows are in working order. Who is bonded to whom never changes, so rows are laid out anew only when
/// particles are sorted. Without bonds everything is empty.
#[derive(Default)]
pub(crate) struct Bonds {
    /// As the state has them, `(B)`, ascending by ranks.
    pub(crate) table: Vec<Bond>,
    /// Places of the particles when they were bonded, m, by rank, `(N)`.
    pub(crate) bonded_position: Vec<[f64; 3]>,
    /// Ranks of the second particles, in the order of the table, `(B)`.
    second: Vec<u32>,
    /// Where the bonds of each first rank start in the table, `(N + 1)`.
    of_rank: Vec<u32>,
    /// What bonds are made of, `(materials, materials)`.
    pub(crate) joints: Vec<Joint<f64>>,
    /// The numbers of the bonds of each pair of materials, if they are alike, see [`State::alike_bonds`].
    pub(crate) alike: Option<Vec<bond::Bond<f64>>>,
    /// What the bonds of each pair of materials are to heat, if they are alike, see [`State::alike_links`].
    pub(crate) links: Option<Vec<Link<f64>>>,

    /// Where each row starts, `(N + 1)`.
    pub(crate) start: Vec<u32>,
    /// The row's particle, `(B)`.
    pub(crate) owner: Vec<u32>,
    /// The other particle, `(B)`.
    pub(crate) other: Vec<u32>,
    /// Place in the table, `(B)`.
    place: Vec<u32>,
    /// From the row's particle to the other when they were bonded, m, `(B)`.
    pub(crate) offset: Vec<[f64; 3]>,
    /// Factor on both strengths, `(B)`.
    pub(crate) strength: Vec<f64>,
    /// Whether the bond holds, `(B)`.
    pub(crate) holds: Vec<bool>,
    /// Where the incoming bonds of each particle start, `(N + 1)`.
    incoming_start: Vec<u32>,
    /// Bonds in the rows of lower ranks, in the order of those ranks, `(B)`.
    incoming: Vec<u32>,
    pub(crate) written: Written,
}

/// What stage `bond` writes.
#[derive(Default)]
pub(crate) struct Written {
    /// What bonds remember as the row's particle sees it, `(B)`; empty in the total form.
    pub(crate) history: Vec<BondHistory>,
    /// Force on the row's particle (the other feels the opposite), N, and moment on the other, N m, `(B, 6)`. Valid where
    /// the bond holds.
    pub(crate) reaction: Vec<f64>,
    /// Forces by the rows of the particles, N, `(N)`; the fourth number is not used.
    pub(crate) force: Vec<Quad>,
    /// Moments by the rows of the particles, N m, `(N)`.
    pub(crate) moment: Vec<Quad>,
}

/// Numbers per entry of [`Written::reaction`].
pub(crate) const REACTION: usize = 6;

impl Bonds {
    /// The bonds of a validated state, particles in the order of ids.
    pub(crate) fn from_state(state: &State, plan: &Plan) -> Self {
        let Some(described) = plan.bonds.as_ref().filter(|_| !state.bonds.is_empty()) else { return Bonds::default() };
        let rank = |id: u32| state.index_of(id).unwrap_or(0);
        let offset = |bond: &Bond| state.bonded_offset(plan, rank(bond.first), rank(bond.second));
        let history = if described.remembers() { state.histories_to_begin_with(plan) } else { Vec::new() };
        let before = |id: u32| state.bonds.partition_point(|bond| bond.first < id) as u32;
        let mut bonds = Bonds {
            second: state.bonds.iter().map(|bond| rank(bond.second) as u32).collect(),
            of_rank: state.id.iter().map(|&id| before(id)).chain([state.bonds.len() as u32]).collect(),
            joints: described.joints.iter().map(|joint| joint.unwrap_or(NOTHING)).collect(),
            offset: state.bonds.iter().map(|bond| offset(bond).into()).collect(),
            place: (0..state.bonds.len() as u32).collect(),
            bonded_position: state.bonded_position.clone(),
            written: Written { history, ..Written::default() },
            table: state.bonds.clone(),
            alike: state.alike_bonds(plan),
            links: state.alike_links(plan).as_deref().map(filled),
            ..Bonds::default()
        };
        bonds.lay_out(&(0..state.len() as u32).collect::<Vec<_>>());
        bonds
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.table.is_empty()
    }
    /// The row of a particle.
    #[inline(always)]
    pub(crate) fn row(&self, particle: usize) -> std::ops::Range<usize> {
        self.start[particle] as usize..self.start[particle + 1] as usize
    }
    /// Bonds that others keep for a particle.
    #[inline(always)]
    pub(crate) fn incoming(&self, particle: usize) -> &[u32] {
        match self.incoming_start.get(particle..particle + 2) {
            Some(&[from, to]) => &self.incoming[from as usize..to as usize],
            _ => &[],
        }
    }
    /// Whether a bond holds between two particles.
    pub(crate) fn hold(&self, rank: &[u32], i: usize, j: usize) -> bool {
        let (low, high) = if rank[i] < rank[j] { (i, j) } else { (j, i) };
        self.row(low).any(|slot| self.other[slot] as usize == high && self.holds[slot])
    }
    /// The entry of a bond in the table.
    pub(crate) fn entry(&mut self, slot: usize) -> &mut Bond {
        &mut self.table[self.place[slot] as usize]
    }
    /// What bonds remember, in the order of the table.
    pub(crate) fn histories(&self) -> Vec<BondHistory> {
        in_table(&self.place, &self.written.history)
    }

    /// Lays the rows out for another working order.
    pub(crate) fn lay_out(&mut self, rank: &[u32]) {
        if self.is_empty() {
            return;
        }
        let index = indices_by_rank(rank);
        let history = self.histories();
        let offset = in_table(&self.place, &self.offset);
        let row = |rank: u32| self.of_rank[rank as usize]..self.of_rank[rank as usize + 1];
        self.place = rank.iter().flat_map(|&rank| row(rank)).collect();
        self.start = starts(rank.iter().map(|&rank| row(rank).len() as u32));
        let by_slot = || self.place.iter().map(|&place| place as usize);
        self.owner = rank.iter().zip(0..).flat_map(|(&rank, i)| row(rank).map(move |_| i)).collect();
        self.other = by_slot().map(|place| index[self.second[place] as usize]).collect();
        self.offset = by_slot().map(|place| offset[place]).collect();
        self.strength = by_slot().map(|place| self.table[place].strength).collect();
        self.holds = by_slot().map(|place| self.table[place].holds()).collect();
        self.written = Written {
            history: by_slot().filter_map(|place| history.get(place).copied()).collect(),
            reaction: vec![0.0; REACTION * self.table.len()],
            force: vec![Quad::default(); rank.len()],
            moment: vec![Quad::default(); rank.len()],
        };
        self.list_incoming(&index);
    }

    /// Lists bonds from the side of the higher rank. The table ascends by lower ranks, so each list does, too.
    fn list_incoming(&mut self, index: &[u32]) {
        let mut count = vec![0_u32; index.len()];
        self.second.iter().for_each(|&rank| count[index[rank as usize] as usize] += 1);
        self.incoming_start = starts(count.into_iter());
        let mut next = self.incoming_start.clone();
        let mut slot_of = vec![0_u32; self.table.len()];
        self.place.iter().zip(0..).for_each(|(&place, slot)| slot_of[place as usize] = slot);
        self.incoming = vec![0; self.table.len()];
        for (&rank, &slot) in self.second.iter().zip(&slot_of) {
            let next = &mut next[index[rank as usize] as usize];
            self.incoming[*next as usize] = slot;
            *next += 1;
        }
    }

    /// Bytes per particle and per bond.
    pub(crate) fn bytes_each(plan: &Plan) -> [usize; 2] {
        let Some(described) = &plan.bonds else { return [0; 2] };
        let history = if described.remembers() { size_of::<BondHistory>() } else { 0 };
        let words = 5 * size_of::<u32>() + size_of::<f64>() + size_of::<bool>();
        let bond = size_of::<Bond>() + words + size_of::<[f64; 3]>() + REACTION * size_of::<f64>() + history;
        [3 * size_of::<u32>() + size_of::<[f64; 3]>() + 2 * size_of::<Quad>(), bond]
    }
    pub(crate) fn bytes(&self, plan: &Plan) -> usize {
        let [particle, bond] = Self::bytes_each(plan);
        particle * self.bonded_position.len() + bond * self.table.len()
    }
}

/// Where no bonds are.
const NOTHING: Joint<f64> = Joint {
    cement: Cement {
        stiffness_ratio: 0.0,
        radius_multiplier: 1.0,
        tensile_strength: 0.0,
        shear_strength: 0.0,
        internal_friction: 0.0,
        moment_contribution: 0.0,
        damping_ratio: 0.0,
    },
    stiffness_per_area: 0.0,
    young_modulus: 0.0,
};

/// Where rows of the given lengths start, and the end of the last.
fn starts(lengths: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut end = 0;
    let ends = lengths.map(|length| {
        end += length;
        end
    });
    std::iter::once(0).chain(ends).collect()
}

/// A field by slots, put in the order of the table; an empty one stays empty.
fn in_table<T: Copy + Default>(place: &[u32], by_slot: &[T]) -> Vec<T> {
    let mut in_table = vec![T::default(); by_slot.len()];
    by_slot.iter().zip(place).for_each(|(&value, &place)| in_table[place as usize] = value);
    in_table
}
