//! Heat on a device, see `kernels/heat.cl`. Temperatures stand in the halves, with moments in the fourth number of spins, heat rates in the fourth number of forces.

use super::bodies::{course_record, table_record};
use super::layout::{
    ConductorOf, ExchangeOf, Exchanging, Exposure, Factors, LinkOf, Piece, Tabled, TakeReals, TakeWords, Thermal,
};
use super::memory::{Buffer, Queue};
use super::program::{Variant, only_link};
use super::runtime::{Error, Runtime};
use crate::cpu::Quad;
use crate::heat::filled;
use crate::{Plan, State, Table};
use std::sync::Arc;
use tdem_physics::heat::Link;

/// What particles have besides temperatures, in working order, `(N)`, and what does not change. Empty where the plan does
/// without.
pub(super) struct Heat<M> {
    /// Indices of exposures.
    pub(super) exposure: Buffer<u32, M>,
    /// Radii at the reference temperature, m.
    pub(super) reference_radius: Buffer<f64, M>,
    /// Radii when the list was made, m.
    pub(super) listed_radius: Buffer<f64, M>,
    /// See [`crate::heat_accounts`], J.
    pub(super) accounts: Buffer<Quad, M>,
    /// $\partial U/\partial T$, J/K, where the ledger follows expansion.
    pub(super) work_per_kelvin: Buffer<f64, M>,
    /// How much warmer a particle became in this step, K, likewise.
    pub(super) warming: Buffer<f64, M>,
    pub(super) thermals: Buffer<Thermal, M>,
    /// `(materials, materials)`.
    pub(super) conductors: Buffer<ConductorOf, M>,
    /// What bonds are to heat, `(materials, materials)`, if those of a pair of materials are alike.
    pub(super) links: Buffer<LinkOf, M>,
    /// The same of all bonds, if there is only one kind of them.
    pub(super) only_link: Option<Link<f64>>,
    /// Of materials, where conductivities depend on temperature.
    pub(super) conductivities: Buffer<Tabled, M>,
    /// Of materials, where specific heats do.
    pub(super) specific_heats: Buffer<Tabled, M>,
    /// `(materials, materials)`, where the numbers of bonds do.
    pub(super) factors: Buffer<Factors, M>,
    pub(super) exposures: Buffer<Exposure, M>,
    pub(super) exchanges: Buffer<Exchanging, M>,
    /// The exposures of the state, by rank.
    pub(super) exposure_by_rank: Arc<Vec<u16>>,
    /// The radii at the reference temperature, by rank, m.
    pub(super) reference_by_rank: Arc<Vec<f64>>,
}

impl<M> Heat<M> {
    /// Pieces of courses are added to those of ramps.
    pub(super) fn of_state<R: Runtime<Memory = M>>(
        queue: &Queue<R>,
        state: &State,
        plan: &Plan,
        variant: &Variant,
        pieces: &mut Vec<Piece>,
    ) -> Result<Self, Error> {
        let exposure: Vec<u32> = state.exposure.iter().map(|&exposure| exposure.into()).collect();
        let booked = if plan.ledger && plan.heat.is_some() { state.len() } else { 0 };
        let accounts = (0..booked).map(|i| Quad(state.heat_accounts.get(i).copied().unwrap_or_default()));
        let followed = if plan.books_expansion() { state.len() } else { 0 };
        let work = (0..followed).map(|i| state.work_per_kelvin.get(i).copied().unwrap_or(0.0));
        let (mut exposures, mut exchanges) = (Vec::new(), Vec::new());
        let known = plan.heat.iter().filter(|_| variant.exposed).flat_map(|heat| {
            let sides = heat.sides.iter().copied().chain(std::iter::repeat(0));
            heat.exposures.iter().zip(sides)
        });
        for (exposure, sides) in known {
            let [first_piece, end_piece] = course_record(exposure.temperature.as_ref(), pieces);
            let first_exchange = exchanges.len() as u32;
            // Where temperatures are prescribed, the exchanges do nothing.
            let acting = if exposure.temperature.is_some() { &[][..] } else { &exposure.exchanges };
            exchanges.extend(acting.iter().map(|(exchange, around)| {
                let [flux_piece, fluid_piece] = course_record(around.flux.as_ref(), pieces);
                let [_, surroundings_piece] = course_record(around.fluid.as_ref(), pieces);
                let [_, end_piece] = course_record(around.surroundings.as_ref(), pieces);
                let exchange = ExchangeOf::from(exchange);
                Exchanging { exchange, flux_piece, fluid_piece, surroundings_piece, end_piece }
            }));
            let (end_exchange, sides) = (exchanges.len() as u32, sides.into());
            exposures.push(Exposure { first_piece, end_piece, first_exchange, end_exchange, sides });
        }
        let conductivities = plan.heat.iter().flat_map(|heat| &heat.tables.conductivity);
        let conductivities: Vec<Tabled> = conductivities.map(|table| tabled(table, pieces)).collect();
        let specific_heats = plan.heat.iter().flat_map(|heat| &heat.tables.specific_heat);
        let specific_heats: Vec<Tabled> = specific_heats.map(|table| tabled(table, pieces)).collect();
        let factors = if variant.bond_tables { factors(plan, pieces) } else { Vec::new() };
        let materials = plan.heat.iter().flat_map(|heat| &heat.materials);
        let thermals =
            materials.map(|material| Thermal { specific_heat: material.specific_heat, expansion: material.expansion });
        let conductors = plan.heat.iter().flat_map(|heat| &heat.conductors).map(ConductorOf::from);
        let links = if variant.bonds { state.alike_links(plan).unwrap_or_default() } else { Vec::new() };
        Ok(Heat {
            exposure: queue.buffer_of(if variant.exposed { &exposure } else { &[] })?,
            reference_radius: queue.buffer_of(&state.reference_radius)?,
            listed_radius: queue.buffer(state.reference_radius.len())?,
            accounts: queue.buffer_of(&accounts.collect::<Vec<_>>())?,
            work_per_kelvin: queue.buffer_of(&work.collect::<Vec<_>>())?,
            warming: queue.zeros(followed)?,
            thermals: queue.buffer_of(&thermals.collect::<Vec<_>>())?,
            conductors: queue.buffer_of(&conductors.collect::<Vec<_>>())?,
            links: queue.buffer_of(&filled(&links).iter().map(LinkOf::from).collect::<Vec<_>>())?,
            only_link: only_link(&links),
            conductivities: queue.buffer_of(&conductivities)?,
            specific_heats: queue.buffer_of(&specific_heats)?,
            factors: queue.buffer_of(&factors)?,
            exposures: queue.buffer_of(&exposures)?,
            exchanges: queue.buffer_of(&exchanges)?,
            exposure_by_rank: Arc::new(state.exposure.clone()),
            reference_by_rank: Arc::new(state.reference_radius.clone()),
        })
    }

    /// Puts particles in a new order.
    pub(super) fn reorder<R: Runtime<Memory = M>>(
        &self,
        queue: &Queue<R>,
        order: &Buffer<u32, M>,
        room: &Buffer<Quad, M>,
    ) -> Result<(), Error> {
        let n = order.len();
        let particles = n as u32;
        if self.exposure.len() > 0 {
            let to = &room.room(n);
            queue.run(&TakeWords { particles, order, from: &self.exposure, to }, n)?;
            queue.copy(to, &self.exposure)?;
        }
        for field in [&self.reference_radius, &self.work_per_kelvin, &self.warming] {
            if field.len() > 0 {
                let to = &room.room(n);
                queue.run(&TakeReals { particles, order, from: field, to }, n)?;
                queue.copy(to, field)?;
            }
        }
        Ok(())
    }
}

fn tabled(table: &Table, pieces: &mut Vec<Piece>) -> Tabled {
    let [first_piece, end_piece] = table_record(table, pieces);
    Tabled { first_piece, end_piece }
}

/// Factors on the numbers of bonds, `(materials, materials)`; 1 where a plan says nothing.
fn factors(plan: &Plan, pieces: &mut Vec<Piece>) -> Vec<Factors> {
    let Some(tables) = plan.bonds.as_ref().map(|bonds| &bonds.tables) else { return Vec::new() };
    let one = Table::constant(1.0);
    let of_pair = |pair: usize| {
        let [stiffness, end_stiffness] = table_record(tables.stiffness.get(pair).unwrap_or(&one), pieces);
        let [strength, end_strength] = table_record(tables.strength.get(pair).unwrap_or(&one), pieces);
        Factors { stiffness, end_stiffness, strength, end_strength }
    };
    (0..plan.materials * plan.materials).map(of_pair).collect()
}

/// Bytes per particle, and per bond where bonds are evaluated apart.
pub(super) fn bytes_each(plan: &Plan) -> [usize; 2] {
    let Some(heat) = &plan.heat else { return [0; 2] };
    let (word, real) = (size_of::<u32>(), size_of::<f64>());
    let exposure = if heat.exposes() { word } else { 0 };
    let radii = if heat.expands() { 2 * real } else { 0 };
    let accounts = if plan.ledger { size_of::<Quad>() } else { 0 };
    let work = if plan.books_expansion() { 2 * real } else { 0 };
    let work_of_bond = if plan.books_expansion() { 2 * real } else { 0 };
    let temperatures = if plan.law.moments { 0 } else { 2 * real };
    [temperatures + exposure + radii + accounts + work, real + work_of_bond]
}
