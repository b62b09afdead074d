//! Bonds as a state keeps them and a plan describes them.

use crate::{Fault, Plan, State, Table};
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::bond::{self, Coefficients, Failure, Form, History, Joint, Law};
use tdem_physics::heat::expansion_work::of_softening;
use tdem_physics::heat::table::mean_temperature;

/// Two particles that are, or were, bonded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond {
    /// The lower id.
    pub first: u32,
    /// The higher id.
    pub second: u32,
    /// Random factor on both strengths; 1 without scatter.
    pub strength: f64,
    /// When and how it broke; `None` while it holds.
    pub breakage: Option<Breakage>,
}

impl Bond {
    /// A bond that holds.
    #[must_use]
    pub const fn new(first: u32, second: u32, strength: f64) -> Self {
        Bond { first, second, strength, breakage: None }
    }
    /// Whether it holds. What broke stays broken.
    #[must_use]
    pub const fn holds(&self) -> bool {
        self.breakage.is_none()
    }
}

/// How a bond ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakage {
    /// The step in which it broke, at least 1; already in this step it exerted nothing.
    pub step: u64,
    /// What it failed in.
    pub failure: Failure,
    /// Energy that left with it, J: [`tdem_physics::bond::released_energy`], less
    /// [`tdem_physics::contact::begun_energy`] where the particles overlap and its end lets contact begin.
    pub energy: f64,
}

/// What an incremental bond remembers, as its first particle sees it; all zero once it is broken. See [`History`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BondHistory {
    /// The normal that the vectors refer to.
    pub normal: [f64; 3],
    /// Normal force, N, tension positive.
    pub tension: f64,
    /// Shear force, N.
    pub shear: [f64; 3],
    /// Moments of torsion and bending, N m.
    pub couple: [f64; 3],
}

impl BondHistory {
    /// The same as the law has it.
    #[inline(always)]
    pub(crate) fn of(history: &History<f64>) -> Self {
        BondHistory {
            normal: history.normal.into(),
            tension: history.tension,
            shear: history.shear.into(),
            couple: history.couple.into(),
        }
    }
    /// The same for the law.
    #[inline(always)]
    pub(crate) fn law(&self) -> History<f64> {
        History {
            normal: self.normal.into(),
            tension: self.tension,
            shear: self.shear.into(),
            couple: self.couple.into(),
        }
    }
    /// All numbers, in the order of the fields.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.normal.into_iter().chain([self.tension]).chain(self.shear).chain(self.couple)
    }
}

/// What a plan says of bonds.
#[derive(Clone, Debug, PartialEq)]
pub struct BondPlan {
    /// Which law acts.
    pub law: Law,
    /// What bonds are made of, for each pair of materials, `(materials, materials)`, symmetric, row by row; `None` where
    /// nothing is bonded.
    pub joints: Vec<Option<Joint<f64>>>,
    /// How they depend on temperature.
    pub tables: BondTables,
    /// Whether contacts act beside bonds that hold. If not, a contact begins in the step in which its bond breaks, and
    /// remembers nothing of before.
    pub contact_in_bonded_pairs: bool,
    /// $\alpha$ of the local damping of all particles, bonded or not, in [0, 1); 0 is none. It takes from components of
    /// force and moment that move a particle, not from those whose motion is prescribed. See
    /// [`tdem_physics::motion::local_damping`].
    pub local_damping: f64,
}

/// Factors over temperature on the numbers of bonds, at the mean temperature of their particles. Each list is for all pairs
/// of materials, `(materials, materials)`, symmetric, row by row, or empty where nothing depends on temperature.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BondTables {
    /// On all four stiffnesses, positive; only of bonds that remember no forces.
    pub stiffness: Vec<Table>,
    /// On both strengths, at least 0.
    pub strength: Vec<Table>,
}

impl BondTables {
    /// Whether nothing depends on temperature.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.stiffness.is_empty() && self.strength.is_empty()
    }
    /// Factors on stiffness and strength of the bonds of a pair of materials, a place in the lists, at the temperatures of
    /// both particles, K.
    #[inline(always)]
    pub(crate) fn factors(&self, pair: usize, temperatures: [f64; 2]) -> [f64; 2] {
        let mean = mean_temperature(temperatures[0], temperatures[1]);
        [&self.stiffness, &self.strength].map(|tables| tables.get(pair).map_or(1.0, |table| table.value(mean)))
    }
    /// What the springs of such a bond gain per kelvin of either particle, J/K, if they hold so much energy, J.
    pub(crate) fn softening(&self, pair: usize, temperatures: [f64; 2], energy: f64) -> f64 {
        let mean = mean_temperature(temperatures[0], temperatures[1]);
        self.stiffness.get(pair).map_or(0.0, |table| of_softening(energy, table.value(mean), table.slope(mean)))
    }
    /// Whether each list is for all pairs or for none, and no value is out of range.
    fn are_sound(&self, pairs: usize) -> bool {
        let all = |tables: &[Table]| tables.is_empty() || tables.len() == pairs;
        all(&self.stiffness)
            && all(&self.strength)
            && self.stiffness.iter().all(|table| table.is_sound(|value| value > 0.0))
            && self.strength.iter().all(|table| table.is_sound(|value| value >= 0.0))
    }
}

impl BondPlan {
    /// Whether bonds have dashpots.
    pub(crate) fn has_dashpots(&self) -> bool {
        self.law.damping != bond::Damping::Off
    }
    /// Whether bonds store forces.
    #[must_use]
    pub fn remembers(&self) -> bool {
        matches!(self.law.form, Form::Incremental(_))
    }
}

/// The numbers of all bonds, if a table of [`State::alike_bonds`] has only one kind of them.
pub(crate) fn only_bond(table: &[bond::Bond<f64>]) -> Option<bond::Bond<f64>> {
    let mut present = table.iter().filter(|numbers| **numbers != NO_BOND);
    let first = present.next()?;
    present.all(|numbers| numbers == first).then_some(*first)
}

/// Where no bonds are.
const NO_BOND: bond::Bond<f64> = {
    const NONE: Coefficients<f64> = Coefficients { normal: 0.0, shear: 0.0, torsion: 0.0, bending: 0.0 };
    bond::Bond {
        stiffness: NONE,
        damping: NONE,
        stress_per_force: 0.0,
        stress_per_torsion: 0.0,
        stress_per_bending: 0.0,
        tensile_strength: 0.0,
        shear_strength: 0.0,
        internal_friction: 0.0,
    }
};

impl Plan {
    /// What bonds between two materials are made of; `None` where there are none.
    #[must_use]
    pub fn joint(&self, first: u16, second: u16) -> Option<&Joint<f64>> {
        let joints = &self.bonds.as_ref()?.joints;
        joints.get(usize::from(first) * self.materials + usize::from(second))?.as_ref()
    }
}

impl State {
    /// Bonds particles as they lie: places are remembered and orientations counted from here on. Bonds may come in any
    /// order, each pair once.
    pub fn make_bonds(&mut self, mut bonds: Vec<Bond>) {
        bonds.sort_unstable_by_key(|bond| (bond.first, bond.second));
        if !bonds.is_empty() {
            self.orientation = vec![[0.0, 0.0, 0.0, 1.0]; self.len()];
            self.bonded_position.clone_from(&self.position);
        }
        self.bonds = bonds;
    }

    /// What incremental bonds remember to begin with: as the state has it, or nothing but where they lie.
    pub(crate) fn histories_to_begin_with(&self, plan: &Plan) -> Vec<BondHistory> {
        if !self.bond_histories.is_empty() {
            return self.bond_histories.clone();
        }
        let unloaded = |bond: &Bond| {
            let [first, second] = [bond.first, bond.second].map(|id| self.index_of(id).unwrap_or(0));
            let offset = self.bonded_offset(plan, first, second);
            BondHistory::of(&History::unloaded(offset * (1.0 / offset.dot(offset).sqrt())))
        };
        self.bonds.iter().map(unloaded).collect()
    }

    /// The numbers of a bond of so much strength between particles of these indices, at their temperatures; `None` where
    /// nothing is bonded.
    pub(crate) fn bond_numbers(&self, plan: &Plan, [i, j]: [usize; 2], strength: f64) -> Option<bond::Bond<f64>> {
        let bonds = plan.bonds.as_ref()?;
        let offset = self.bonded_offset(plan, i, j);
        let joint = plan.joint(self.material[i], self.material[j])?;
        let [first, second] = [i, j].map(|k| self.bonded_sphere(k));
        let numbers = joint.bond_of_spheres(bonds.law.damping, &first, &second, offset.dot(offset).sqrt(), strength);
        if bonds.tables.is_empty() {
            return Some(numbers);
        }
        let pair = usize::from(self.material[i]) * plan.materials + usize::from(self.material[j]);
        let [stiffness, strength] = bonds.tables.factors(pair, [i, j].map(|k| self.temperature[k]));
        Some(numbers.tempered(stiffness, strength))
    }

    /// From the first particle of a bond to the second when they were bonded, m: the nearest image. The arguments are
    /// indices of particles.
    pub(crate) fn bonded_offset(&self, plan: &Plan, first: usize, second: usize) -> Vec3<f64> {
        let position = |index: usize| -> Vec3<f64> { self.bonded_position[index].into() };
        plan.domain.period().nearest(position(second) - position(first))
    }

    /// The numbers of the bonds of each pair of materials but for the factors on their strengths, `(materials, materials)`,
    /// symmetric, row by row, if nothing else decides about them; zeros where nothing is bonded.
    pub(crate) fn alike_bonds(&self, plan: &Plan) -> Option<Vec<bond::Bond<f64>>> {
        let law = plan.bonds.as_ref()?.law;
        let pair = |bond: &Bond| {
            let [i, j] = [bond.first, bond.second].map(|id| self.index_of(id).unwrap_or(0));
            let [a, b] = [i, j].map(|k| usize::from(self.material[k]));
            (i, j, [a * plan.materials + b, b * plan.materials + a])
        };
        let numbers = |i: usize, j: usize| {
            let offset = self.bonded_offset(plan, i, j);
            let joint = plan.joint(self.material[i], self.material[j])?;
            let [first, second] = [i, j].map(|k| self.bonded_sphere(k));
            Some(joint.bond_of_spheres(law.damping, &first, &second, offset.dot(offset).sqrt(), 1.0))
        };
        let mut table = vec![None; plan.materials * plan.materials];
        for (i, j, places) in self.bonds.iter().map(pair) {
            if table[places[0]].is_none() {
                let found = numbers(i, j);
                for place in places {
                    table[place] = found;
                }
            }
        }
        let alike = self.bonds.par_iter().map(pair).all(|(i, j, [place, _])| numbers(i, j) == table[place]);
        alike.then(|| table.into_iter().map(|numbers| numbers.unwrap_or(NO_BOND)).collect())
    }

    /// Checks that bonds belong to the particles and to the plan.
    pub(crate) fn validate_bonds(&self, plan: &Plan) -> Result<(), Fault> {
        let check = |holds: bool, what| if holds { Ok(()) } else { Err(Fault::Inconsistent { what }) };
        if let Some(bonds) = &plan.bonds {
            check(
                bonds.joints.len() == plan.materials * plan.materials,
                "every pair of materials has a joint or none",
            )?;
            check(
                bonds.tables.are_sound(plan.materials * plan.materials),
                "tables of bonds are for all pairs of materials or none, ascend in temperature, and keep bonds stiff",
            )?;
            check(bonds.tables.is_empty() || plan.heat.is_some(), "what depends on temperature needs heat")?;
            check(
                bonds.tables.stiffness.is_empty() || !bonds.remembers(),
                "bonds that remember forces keep their stiffness: the total form does not remember",
            )?;
            check((0.0..1.0).contains(&bonds.local_damping), "local damping is at least 0 and less than 1")?;
        }
        let n = if self.bonds.is_empty() { 0 } else { self.len() };
        check(
            self.orientation.len() == n && self.bonded_position.len() == n,
            "with bonds all particles have an orientation and a bonded position, without bonds none",
        )?;
        let remembered = self.bond_histories.len();
        check(remembered == 0 || remembered == self.bonds.len(), "bond histories are for all bonds or none")?;
        if self.bonds.is_empty() {
            return Ok(());
        }
        let Some(bonds) = &plan.bonds else { return check(false, "bonds have a law") };
        check(plan.law.moments, "bonds need a contact law with moments")?;
        check(bonds.remembers() || remembered == 0, "only incremental bonds have histories")?;
        check(!bonds.remembers() || !self.forces_known || remembered > 0, "incremental bonds have histories")?;
        check(
            self.bonds.is_sorted_by(|a, b| (a.first, a.second) < (b.first, b.second))
                && self.bonds.iter().all(|bond| bond.first < bond.second),
            "bonds ascend strictly, the lower id first",
        )?;
        check(
            self.bonds.iter().all(|b| self.index_of(b.first).is_some() && self.index_of(b.second).is_some()),
            "bonds name particles that exist",
        )?;
        let ends = |bond: &Bond| [bond.first, bond.second].map(|id| self.index_of(id).unwrap_or(0));
        check(
            self.bonds.iter().map(ends).all(|[i, j]| plan.joint(self.material[i], self.material[j]).is_some()),
            "every bonded pair of materials has a joint",
        )?;
        check(
            self.bonds.iter().map(ends).all(|[i, j]| {
                let offset = self.bonded_offset(plan, i, j);
                offset.dot(offset) > 0.0
            }),
            "bonded particles were apart when they were bonded",
        )?;
        check(self.bonds.iter().all(|bond| bond.strength > 0.0), "the strength of a bond is a positive factor")?;
        check(
            self.bonds.iter().filter_map(|bond| bond.breakage).all(|b| (1..=self.step).contains(&b.step)),
            "bonds broke in steps that are done",
        )
    }
}
