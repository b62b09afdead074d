//! The kernels of a run: the printed laws and the skeletons around them, in one text.

use super::layout;
use crate::bond::only_bond;
use crate::{BondPlan, HeatPlan, Integrator, Plan, State};
use std::fmt::Write;
use tdem_physics::contact::Friction;
use tdem_physics::heat::{Link, Path};
use tdem_physics::{bond, print};

/// Kernels that are built together.
pub(crate) trait Program {
    /// The names of the kernels.
    fn kernels(&self) -> Vec<&'static str>;
    /// The whole text but the prelude.
    fn source(&self) -> String;
}

/// What is decided when the kernels are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the source, and they are independent")]
pub(crate) struct Variant {
    pub(crate) law: tdem_physics::contact::Law,
    pub(crate) gear: bool,
    pub(crate) ledger: bool,
    pub(crate) periodic: bool,
    /// Whether components of motion are prescribed for any particle.
    pub(crate) constrained: bool,
    /// Whether anything that is prescribed or applied changes with time.
    pub(crate) ramps: bool,
    /// Whether forces are applied to any particle.
    pub(crate) applied_forces: bool,
    /// Whether all contacts have the same parameters.
    pub(crate) one_pair: bool,
    /// Whether all particles have the same radius.
    pub(crate) one_radius: bool,
    /// Whether all particles have the same mass.
    pub(crate) one_mass: bool,
    /// The law of bonds, if the plan has any.
    pub(crate) bond_law: Option<bond::Law>,
    /// Whether particles are bonded.
    pub(crate) bonds: bool,
    /// Whether all bonds of a pair of materials have the same numbers but for their strengths.
    pub(crate) alike_bonds: bool,
    /// Whether there is only one kind of them.
    pub(crate) one_bond: bool,
    /// Whether each bond is evaluated once, apart from its particles.
    pub(crate) bonds_apart: bool,
    /// Whether strengths have factors.
    pub(crate) scattered_bonds: bool,
    /// Whether bonds that hold keep contact off.
    pub(crate) bonds_keep_off: bool,
    pub(crate) local_damping: bool,
    /// How heat goes through contacts, if there is heat.
    pub(crate) heat: Option<Path>,
    /// Whether radii and bonds follow temperatures.
    pub(crate) expands: bool,
    /// Whether friction or dashpots make heat.
    pub(crate) makes_heat: bool,
    /// Whether particles exchange heat with their surroundings.
    pub(crate) exposed: bool,
    /// Whether bonds within open sides conduct more.
    pub(crate) bounded: bool,
    /// Whether all contacts conduct with the same.
    pub(crate) one_conductor: bool,
    /// Whether all bonds of a pair of materials are the same to heat.
    pub(crate) alike_links: bool,
    /// Whether there is only one kind of them.
    pub(crate) one_link: bool,
    /// Whether conductivities depend on temperature.
    pub(crate) conductivity_tables: bool,
    /// Whether specific heats do.
    pub(crate) specific_heat_tables: bool,
    /// Whether the numbers of bonds do.
    pub(crate) bond_tables: bool,
    /// Whether the ledger follows the work that expansion and softening do on springs.
    pub(crate) expansion_work: bool,
    /// Whether stiffnesses of bonds depend on temperature.
    pub(crate) softens: bool,
}

/// What all contacts that particles of this state can have are told, if it is the same for all.
pub(crate) fn only_of_pairs<'a, T: PartialEq>(
    plan: &'a Plan,
    state: &State,
    of_pair: impl Fn(u16, u16) -> &'a T,
) -> Option<&'a T> {
    let mut present = vec![false; plan.materials];
    for &material in &state.material {
        present[usize::from(material)] = true;
    }
    let present: Vec<u16> = (0..plan.materials as u16).filter(|&m| present[usize::from(m)]).collect();
    let partners = present.iter().copied().chain(plan.walls.iter().map(|wall| wall.material));
    let pairs = partners.flat_map(|b| present.iter().map(move |&a| (a, b)));
    let mut all = pairs.map(|(a, b)| of_pair(a, b));
    let first = all.next()?;
    all.all(|other| other == first).then_some(first)
}

/// What all bonds are to heat, if a table of [`State::alike_links`] has only one kind of them.
pub(crate) fn only_link(table: &[Option<Link<f64>>]) -> Option<Link<f64>> {
    let mut present = table.iter().flatten();
    let first = present.next()?;
    present.all(|link| link == first).then_some(*first)
}

fn alike(values: &[f64]) -> bool {
    values.iter().all(|&value| value == values[0])
}

impl Variant {
    pub(crate) fn of(plan: &Plan, state: &State) -> Self {
        let (alike_bonds, alike_links) = (state.alike_bonds(plan), state.alike_links(plan));
        let (heat, expands) = (plan.heat.as_ref(), plan.expands());
        Variant {
            law: plan.law,
            gear: plan.integrator == Integrator::Gear,
            ledger: plan.ledger,
            periodic: plan.domain.period().any(),
            constrained: plan.constraints.len() > 1,
            ramps: !plan.ramps.is_empty(),
            applied_forces: plan.applies_forces(),
            one_pair: only_of_pairs(plan, state, |a, b| plan.interaction(a, b)).is_some(),
            one_radius: alike(&state.radius) && !expands,
            one_mass: alike(&state.mass),
            bond_law: plan.bonds.as_ref().map(|bonds| bonds.law),
            bonds: !state.bonds.is_empty(),
            alike_bonds: alike_bonds.is_some(),
            one_bond: alike_bonds.is_some_and(|table| only_bond(&table).is_some()),
            bonds_apart: !state.bonds.is_empty()
                && (plan.bonds.as_ref().is_some_and(BondPlan::remembers) || plan.search.every_step),
            scattered_bonds: state.bonds.iter().any(|bond| bond.strength.to_bits() != 1.0_f64.to_bits()),
            bonds_keep_off: !state.bonds.is_empty()
                && plan.bonds.as_ref().is_some_and(|bonds| !bonds.contact_in_bonded_pairs),
            local_damping: plan.bonds.as_ref().is_some_and(|bonds| bonds.local_damping > 0.0),
            heat: heat.map(|heat| heat.contacts),
            expands,
            makes_heat: plan.makes_heat(),
            exposed: heat.is_some_and(HeatPlan::exposes),
            bounded: heat.is_some_and(HeatPlan::bounds),
            one_conductor: heat.is_some_and(|heat| only_of_pairs(plan, state, |a, b| heat.conductor(a, b)).is_some()),
            alike_links: alike_links.is_some(),
            one_link: alike_links.is_some_and(|table| only_link(&table).is_some()),
            conductivity_tables: heat.is_some_and(|heat| !heat.tables.conductivity.is_empty()),
            specific_heat_tables: heat.is_some_and(|heat| !heat.tables.specific_heat.is_empty()),
            expansion_work: plan.books_expansion(),
            softens: !state.bonds.is_empty() && plan.softens(),
            bond_tables: !state.bonds.is_empty() && plan.bonds.as_ref().is_some_and(|bonds| !bonds.tables.is_empty()),
        }
    }
    /// Whether a step is one kernel.
    pub(crate) fn fused(&self) -> bool {
        !self.gear && !self.ledger
    }
    /// Whether what a particle is ordered to do matters to the forces on it or to the ledger.
    pub(crate) fn asks_constraints(&self) -> bool {
        self.applied_forces || self.constrained && (self.ledger || self.local_damping)
    }
    /// Whether bonds store forces.
    pub(crate) fn bonds_remember(&self) -> bool {
        self.bond_law.is_some_and(|law| matches!(law.form, bond::Form::Incremental(_)))
    }
    /// Whether bonds have dashpots.
    pub(crate) fn bond_dashpots(&self) -> bool {
        self.bond_law.is_some_and(|law| law.damping != bond::Damping::Off)
    }
    /// Whether bonds look at velocities.
    pub(crate) fn bonds_move(&self) -> bool {
        self.bonds_remember() || self.bond_dashpots()
    }
    /// Whether what a bond is to heat is looked up by materials.
    pub(crate) fn links_by_material(&self) -> bool {
        self.bonds && self.heat.is_some() && !self.one_link
    }
    /// Whether what acts between two particles depends on their temperature.
    pub(crate) fn tempers_pairs(&self) -> bool {
        self.conductivity_tables || self.bond_tables
    }
    /// Whether the numbers of a bond are worked out from radii at the reference temperature.
    pub(crate) fn bonds_by_radius(&self) -> bool {
        self.bonds && self.expands && !(self.alike_bonds && self.alike_links)
    }
    /// Whether a contact must look for a bond beside it.
    pub(crate) fn contacts_beside_bonds(&self) -> bool {
        self.bonds && !self.bonds_keep_off && self.heat.is_some_and(|path| path != Path::Closed)
    }
    /// Whether touching pairs remember anything.
    pub(crate) fn friction(&self) -> bool {
        self.law.friction != Friction::Off
    }
}

impl Program for Variant {
    fn kernels(&self) -> Vec<&'static str> {
        let written = |name: &&str| match *name {
            "fused" => self.fused(),
            "bond" | "take_numbers" | "follow_ends" => self.bonds_apart,
            "take_reals" => self.heat.is_some(),
            "take_bonds" | "put_bonds" | "take_strengths" | "put_strengths" | "invert_order" => self.bonds,
            _ => true,
        };
        layout::heads().into_iter().map(|head| head.name).filter(written).collect()
    }
    fn source(&self) -> String {
        let mut text = String::new();
        let switches = [
            ("FRICTION", self.friction()),
            ("MOMENTS", self.law.moments),
            ("GEAR", self.gear),
            ("LEDGER", self.ledger),
            ("PERIODIC", self.periodic),
            ("CONSTRAINED", self.constrained),
            ("RAMPS", self.ramps),
            ("APPLIED_FORCES", self.applied_forces),
            ("ONE_PAIR", self.one_pair),
            ("ONE_RADIUS", self.one_radius),
            ("ONE_MASS", self.one_mass),
            ("BONDS", self.bonds),
            ("BOND_DASHPOTS", self.bond_dashpots()),
            ("BONDS_REMEMBER", self.bonds_remember()),
            ("BONDS_APART", self.bonds_apart),
            ("ALIKE_BONDS", self.alike_bonds),
            ("ONE_BOND", self.one_bond),
            ("SCATTERED_BONDS", self.scattered_bonds),
            ("BONDS_KEEP_OFF", self.bonds_keep_off),
            ("LOCAL_DAMPING", self.local_damping),
            ("HEAT", self.heat.is_some()),
            ("HEAT_THROUGH_CONTACTS", self.heat.is_some_and(|path| path != Path::Closed)),
            ("EXPANDS", self.expands),
            ("MAKES_HEAT", self.makes_heat),
            ("EXPANSION_WORK", self.expansion_work),
            ("SOFTENING_WORK", self.expansion_work && self.softens),
            ("EXPOSED", self.exposed),
            ("BOUNDED", self.bounded),
            ("ONE_CONDUCTOR", self.one_conductor),
            ("ALIKE_LINKS", self.alike_links),
            ("ONE_LINK", self.one_link),
            ("CONDUCTIVITY_TABLES", self.conductivity_tables),
            ("SPECIFIC_HEAT_TABLES", self.specific_heat_tables),
            ("BOND_TABLES", self.bond_tables),
            ("CONTACTS_BESIDE_BONDS", self.contacts_beside_bonds()),
        ];
        for (name, on) in switches {
            let _ = writeln!(text, "#define {name} {}", u8::from(on));
        }
        text.push('\n');
        text += &print::source(self.law);
        text.push('\n');
        text += &self.bond_law.map_or_else(print::bond_types, print::bond_source);
        text.push('\n');
        text += &self.heat.map_or_else(print::heat_types, print::heat_source);
        text.push('\n');
        text += &layout::record_definitions();
        let mut skeletons = String::new();
        for file in [
            include_str!("kernels/particle.cl"),
            include_str!("kernels/body.cl"),
            include_str!("kernels/heat.cl"),
            include_str!("kernels/correct.cl"),
            include_str!("kernels/predict.cl"),
            include_str!("kernels/bond.cl"),
            include_str!("kernels/contact.cl"),
            include_str!("kernels/fused.cl"),
            include_str!("kernels/scan.cl"),
            include_str!("kernels/history.cl"),
            include_str!("kernels/search.cl"),
        ] {
            skeletons.push('\n');
            skeletons += file;
        }
        text + &layout::with_heads(skeletons, &layout::heads())
    }
}
