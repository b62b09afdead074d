//! Heat alone on a device, see `kernels/network.cl`. Particles stand in the order of ids.

use super::layout::network::{
    Advance, Assemble, Begin, Conduct, Conduction, Finish, LeastStep, Multiply, Rate, Scalars, Surface, TakeContent,
    TakeSquares, TakeWork, Turn, Warm, heads, record_definitions,
};
use super::layout::{ExchangeOf, with_heads};
use super::memory::{Buffer, Queue};
use super::program::Program;
use super::runtime::{Error, Runtime};
use crate::cpu::split;
use crate::network::{CHUNK, Field, MOST_ITERATIONS, Network, Stuck, Surroundings, TOLERANCE, is_temperature};
use crate::{Fault, HeatPlan, Plan, Scheme, State, heat_accounts};
use rayon::prelude::*;
use tdem_physics::print;

/// Rows side by side, as in the kernels: those of a warp.
const SIDE: usize = 32;
/// Iterations launched before the host asks whether they were enough.
const BATCH: u64 = 16;
/// Words of an exact sum, as in the kernels.
pub(super) const SUM_WORDS: usize = 136;
/// So many chunks may add to the words of one copy before a digit would overflow.
const CHUNKS_PER_COPY: usize = 1 << 15;
/// Copies among which chunks are shared where one would do, so that few wait for each other.
const COPIES: usize = 16;

/// Copies of the words of a sum of so many terms.
pub(super) fn copies_of_sums(terms: usize) -> usize {
    let chunks = terms.div_ceil(CHUNK);
    chunks.div_ceil(CHUNKS_PER_COPY).max(chunks.min(COPIES)).max(1)
}

/// The program of heat alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alone;

impl Program for Alone {
    fn kernels(&self) -> Vec<&'static str> {
        heads().into_iter().map(|head| head.name).collect()
    }
    fn source(&self) -> String {
        let skeletons = ["\n", include_str!("kernels/exact.cl"), "\n", include_str!("kernels/network.cl")].concat();
        print::network_source() + "\n" + &record_definitions() + &with_heads(skeletons, &heads())
    }
}

/// Temperatures of particles on a device, and what conducts between them.
pub(super) struct Conducting<R: Runtime> {
    queue: Queue<R, Alone>,
    conduction: Conduction,
    /// Iterations of the last solution.
    expected: u64,
    /// `(N)`.
    exposure: Buffer<u32, R::Memory>,
    surfaces: Buffer<Surface, R::Memory>,
    exchanges: Buffer<ExchangeOf, R::Memory>,
    /// Temperatures of walls, prescribed ones of exposures, flux, fluid and surroundings of exchanges.
    around: Buffer<f64, R::Memory>,
    /// K, `(N)`.
    temperature: Buffer<f64, R::Memory>,
    /// Heat rates, W, `(N)`: all together, and from walls and through surfaces. While a solution is sought, `total` holds what
    /// the matrix makes of the present way.
    total: Buffer<f64, R::Memory>,
    foreign: Buffer<f64, R::Memory>,
    /// What was booked, J, `(N)`; empty without ledger.
    accounts: Accounts<R::Memory>,
    /// J/K, `(N)`.
    capacity: Buffer<f64, R::Memory>,
    rows: Rows<R::Memory>,
    /// Of an implicit step; empty in the explicit scheme.
    system: System<R::Memory>,
    /// One for each chunk.
    partial: Buffer<f64, R::Memory>,
    /// Words of two exact sums, in copies; zeros between two launches that add and take.
    sums: Buffer<u32, R::Memory>,
    scalars: Buffer<Scalars, R::Memory>,
    /// The part of the step that left no temperature; 0 without any.
    halted: Buffer<u32, R::Memory>,
}

/// Heat accounts: what came in and went out as the kernels have it; all columns as they were taken up, of which the others are
/// kept here.
struct Accounts<M> {
    came_in: Buffer<f64, M>,
    went_out: Buffer<f64, M>,
    taken: Vec<[f64; 4]>,
}

/// Rows of all that conducts: contacts, then bonds, then walls. Rows of 32 particles stand side by side, as long as the
/// longest.
struct Rows<M> {
    /// Where those of 32 particles begin.
    slice: Buffer<u64, M>,
    /// Along each row, `(N)`.
    contacts_end: Buffer<u32, M>,
    bonds_end: Buffer<u32, M>,
    walls_end: Buffer<u32, M>,
    /// The other particle, or the wall.
    other: Buffer<u32, M>,
    /// W/K.
    conductance: Buffer<f64, M>,
}

/// Vectors of an implicit step, `(N)`, see [`Network::implicit`].
struct System<M> {
    end: Buffer<f64, M>,
    loss: Buffer<f64, M>,
    held: Buffer<f64, M>,
    diagonal: Buffer<f64, M>,
    residual: Buffer<f64, M>,
    change: Buffer<f64, M>,
    way: Buffer<f64, M>,
}

impl<R: Runtime> Conducting<R> {
    /// Room for the particles of a state that has temperatures.
    pub(super) fn new(runtime: R, state: &State, plan: &Plan, heat: &HeatPlan) -> Result<Self, Error> {
        let queue = Queue::new(runtime, Alone)?;
        let n = state.len();
        let chunks = n.div_ceil(CHUNK);
        let copies = copies_of_sums(n);
        let exposure: Vec<u32> = state.exposure.iter().map(|&exposure| exposure.into()).collect();
        let (surfaces, exchanges) = surfaces(heat);
        let booked = if plan.ledger { n } else { 0 };
        let implicit = if heat.motion.scheme() == Some(Scheme::Implicit) { n } else { 0 };
        Ok(Conducting {
            conduction: Conduction {
                step: 0.0,
                tolerance_squared: TOLERANCE * TOLERANCE,
                particles: n as u32,
                copies: copies as u32,
                walls: heat.walls.len() as u32,
                exposures: heat.exposures.len() as u32,
                part: 1,
                most_iterations: MOST_ITERATIONS as u32,
                booked: plan.ledger.into(),
                padding: 0,
            },
            expected: BATCH,
            exposure: queue.buffer_of(&exposure)?,
            surfaces: queue.buffer_of(&surfaces)?,
            exchanges: queue.buffer_of(&exchanges)?,
            around: queue.zeros(heat.walls.len() + heat.exposures.len() + 3 * exchanges.len())?,
            temperature: queue.buffer(n)?,
            total: queue.buffer(n)?,
            foreign: queue.buffer(n)?,
            accounts: Accounts { came_in: queue.buffer(booked)?, went_out: queue.buffer(booked)?, taken: Vec::new() },
            capacity: queue.buffer(n)?,
            rows: Rows::of(&queue, &Network::default(), 0)?,
            system: System::new(&queue, implicit)?,
            partial: queue.buffer(chunks)?,
            sums: queue.zeros(2 * copies * SUM_WORDS)?,
            scalars: queue.zeros(1)?,
            halted: queue.zeros(1)?,
            queue,
        })
    }

    fn particles(&self) -> usize {
        self.conduction.particles as usize
    }
    fn chunks(&self) -> usize {
        self.particles().div_ceil(CHUNK)
    }

    fn run_multiply(&self) -> Result<(), Error> {
        let (rows, system) = (&self.rows, &self.system);
        self.queue.run_groups(
            &Multiply {
                conduction: self.conduction,
                scalars: &self.scalars,
                slice: &rows.slice,
                contacts_end: &rows.contacts_end,
                bonds_end: &rows.bonds_end,
                walls_end: &rows.walls_end,
                other: &rows.other,
                conductance: &rows.conductance,
                exposure: &self.exposure,
                surfaces: &self.surfaces,
                held: &system.held,
                way: &system.way,
                product: &self.total,
                sums: &self.sums,
            },
            self.chunks(),
        )
    }

    /// The system of a step, and what is missing in it before anything changed.
    fn set_up(&self) -> Result<(), Error> {
        let (conduction, rows, system) = (self.conduction, &self.rows, &self.system);
        self.queue.run_groups(
            &Begin {
                conduction,
                exposure: &self.exposure,
                surfaces: &self.surfaces,
                around: &self.around,
                capacity: &self.capacity,
                temperature: &self.temperature,
                end: &system.end,
                sums: &self.sums,
            },
            self.chunks(),
        )?;
        self.queue.run_groups(&TakeContent { conduction, sums: &self.sums, scalars: &self.scalars }, 1)?;
        self.queue.run_groups(
            &Assemble {
                conduction,
                slice: &rows.slice,
                contacts_end: &rows.contacts_end,
                bonds_end: &rows.bonds_end,
                walls_end: &rows.walls_end,
                other: &rows.other,
                conductance: &rows.conductance,
                exposure: &self.exposure,
                surfaces: &self.surfaces,
                exchanges: &self.exchanges,
                around: &self.around,
                capacity: &self.capacity,
                end: &system.end,
                foreign: &self.foreign,
                loss: &system.loss,
                held: &system.held,
                diagonal: &system.diagonal,
                residual: &system.residual,
                change: &system.change,
                way: &system.way,
                sums: &self.sums,
            },
            self.chunks(),
        )?;
        self.take_squares(0)
    }

    fn take_squares(&self, counted: u32) -> Result<(), Error> {
        let (conduction, sums, scalars) = (self.conduction, &self.sums, &self.scalars);
        self.queue.run_groups(&TakeSquares { conduction, counted, sums, scalars }, 1)
    }

    /// One iteration; nothing once the solution is found.
    fn iterate(&self) -> Result<(), Error> {
        let (conduction, sums, scalars, system) = (self.conduction, &self.sums, &self.scalars, &self.system);
        self.run_multiply()?;
        self.queue.run_groups(&TakeWork { conduction, sums, scalars }, 1)?;
        self.queue.run_groups(
            &Advance {
                conduction,
                scalars,
                way: &system.way,
                product: &self.total,
                diagonal: &system.diagonal,
                capacity: &self.capacity,
                change: &system.change,
                residual: &system.residual,
                sums,
            },
            self.chunks(),
        )?;
        self.take_squares(1)?;
        let (residual, diagonal, way) = (&system.residual, &system.diagonal, &system.way);
        self.queue.run(&Turn { conduction, scalars, residual, diagonal, way }, self.particles())
    }

    /// Heat rates of the end, once the solution is found.
    fn conclude(&self) -> Result<(), Error> {
        let (conduction, rows, system) = (self.conduction, &self.rows, &self.system);
        let (change, loss, end, foreign) = (&system.change, &system.loss, &system.end, &self.foreign);
        self.queue.run(&Finish { conduction, change, loss, end, foreign }, self.particles())?;
        self.queue.run(
            &Conduct {
                conduction,
                slice: &rows.slice,
                contacts_end: &rows.contacts_end,
                bonds_end: &rows.bonds_end,
                walls_end: &rows.walls_end,
                other: &rows.other,
                conductance: &rows.conductance,
                end,
                foreign,
                total: &self.total,
            },
            self.particles(),
        )
    }
}

impl<R: Runtime> Field for Conducting<R> {
    fn take_up(&mut self, temperature: &[f64], accounts: Vec<[f64; 4]>) -> Result<(), Fault> {
        self.queue.upload(&self.temperature, temperature)?;
        self.accounts.taken = accounts;
        let column = |column: usize| self.accounts.taken.iter().map(|account| account[column]).collect::<Vec<_>>();
        self.queue.upload(&self.accounts.came_in, &column(heat_accounts::IN))?;
        self.queue.upload(&self.accounts.went_out, &column(heat_accounts::OUT))?;
        Ok(())
    }
    fn put(&mut self, state: &mut State) -> Result<(), Fault> {
        let all = usize::MAX;
        let temperature = self.queue.fetch(&self.temperature, all)?;
        let rates = self.queue.fetch(&self.total, all)?;
        let mut came_in = self.queue.fetch(&self.accounts.came_in, all)?;
        let mut went_out = self.queue.fetch(&self.accounts.went_out, all)?;
        state.temperature = temperature.take()?;
        state.heat_rate = rates.take()?;
        state.heat_accounts.clone_from(&self.accounts.taken);
        let booked = came_in.view()?.iter().zip(went_out.view()?);
        for (account, (&came, &went)) in state.heat_accounts.iter_mut().zip(booked) {
            (account[heat_accounts::IN], account[heat_accounts::OUT]) = (came, went);
        }
        Ok(())
    }
    fn temperatures(&mut self) -> Result<Vec<f64>, Fault> {
        Ok(self.queue.read(&self.temperature, usize::MAX)?)
    }
    fn link(&mut self, network: Network) -> Result<(), Fault> {
        self.queue.upload(&self.capacity, &network.capacity)?;
        // The old rows go before there is room for new ones.
        self.rows = Rows::of(&self.queue, &Network::default(), 0)?;
        self.rows = Rows::of(&self.queue, &network, self.particles())?;
        Ok(())
    }
    fn surround(&mut self, around: Surroundings) -> Result<(), Fault> {
        let prescribed = around.prescribed.iter().map(|prescribed| prescribed.unwrap_or_default());
        let outside = around.outside.iter().flatten().flat_map(|o| [o.flux, o.fluid, o.surroundings]);
        let values = around.walls.iter().copied().chain(prescribed).chain(outside);
        self.queue.upload(&self.around, &values.collect::<Vec<_>>())?;
        Ok(())
    }
    fn temper(&mut self) -> Result<(), Fault> {
        // Where properties depend on temperature, temperatures lie on the processor.
        Ok(())
    }
    fn longest_step(&mut self) -> Result<f64, Fault> {
        if self.particles() == 0 {
            return Ok(f64::INFINITY);
        }
        let rows = &self.rows;
        self.queue.run_groups(
            &LeastStep {
                conduction: self.conduction,
                slice: &rows.slice,
                contacts_end: &rows.contacts_end,
                bonds_end: &rows.bonds_end,
                walls_end: &rows.walls_end,
                other: &rows.other,
                conductance: &rows.conductance,
                exposure: &self.exposure,
                surfaces: &self.surfaces,
                exchanges: &self.exchanges,
                around: &self.around,
                capacity: &self.capacity,
                temperature: &self.temperature,
                partial: &self.partial,
            },
            self.chunks(),
        )?;
        Ok(self.queue.read(&self.partial, self.chunks())?.into_iter().fold(f64::INFINITY, f64::min))
    }
    fn rate(&mut self) -> Result<(), Fault> {
        if self.particles() == 0 {
            return Ok(());
        }
        let rows = &self.rows;
        let rate = Rate {
            conduction: self.conduction,
            halted: &self.halted,
            slice: &rows.slice,
            contacts_end: &rows.contacts_end,
            bonds_end: &rows.bonds_end,
            walls_end: &rows.walls_end,
            other: &rows.other,
            conductance: &rows.conductance,
            exposure: &self.exposure,
            surfaces: &self.surfaces,
            exchanges: &self.exchanges,
            around: &self.around,
            temperature: &self.temperature,
            total: &self.total,
            foreign: &self.foreign,
        };
        Ok(self.queue.run(&rate, self.particles())?)
    }
    fn solve(&mut self, step: f64) -> Result<Result<u64, Stuck>, Fault> {
        if self.particles() == 0 {
            return Ok(Ok(0));
        }
        self.conduction.step = step;
        self.set_up()?;
        let mut batch = self.expected;
        let found = loop {
            for _ in 0..batch {
                self.iterate()?;
            }
            let found = self.queue.read(&self.scalars, 1)?[0];
            if found.done != 0 {
                break found;
            }
            batch = BATCH;
        };
        let iterations = u64::from(found.iterations);
        if found.stuck != 0 {
            return Ok(Err(Stuck { iterations, error: (found.error / found.capacity).sqrt() }));
        }
        if !found.error.is_finite() {
            return Ok(Err(Stuck { iterations, error: found.error }));
        }
        self.expected = iterations;
        self.conclude()?;
        Ok(Ok(iterations))
    }
    fn warm(&mut self, step: f64) -> Result<(), Fault> {
        if self.particles() == 0 {
            return Ok(());
        }
        self.conduction.step = step;
        let warm = Warm {
            conduction: self.conduction,
            halted: &self.halted,
            exposure: &self.exposure,
            surfaces: &self.surfaces,
            around: &self.around,
            capacity: &self.capacity,
            total: &self.total,
            foreign: &self.foreign,
            temperature: &self.temperature,
            heat_in: &self.accounts.came_in,
            heat_out: &self.accounts.went_out,
        };
        self.queue.run(&warm, self.particles())?;
        self.conduction.part += 1;
        Ok(())
    }
    fn book(&mut self, column: usize, amount: f64) {
        if let Some(account) = self.accounts.taken.first_mut() {
            account[column] += amount;
        }
    }
    fn astray(&mut self) -> Result<Option<(usize, f64)>, Fault> {
        self.conduction.part = 1;
        if self.queue.read(&self.halted, 1)?[0] == 0 {
            return Ok(None);
        }
        self.queue.clear(&self.halted, 1)?;
        let temperature = self.temperatures()?;
        let first = temperature.iter().position(|&temperature| !is_temperature(temperature));
        Ok(first.map(|index| (index, temperature[index])))
    }
    fn bytes(&self) -> usize {
        self.queue.bytes() + size_of_val(&self.accounts.taken[..])
    }
    fn copy_bandwidth(&self) -> Result<f64, Fault> {
        Ok(self.queue.copy_bandwidth()?)
    }
}

impl<M> Rows<M> {
    fn of<R: Runtime<Memory = M>>(queue: &Queue<R, Alone>, network: &Network, particles: usize) -> Result<Self, Error> {
        let ends = |particle: usize| network.row_ends(particle);
        let column =
            |k: usize| (0..particles).into_par_iter().map(|particle| ends(particle)[k] as u32).collect::<Vec<_>>();
        let sides = particles.div_ceil(SIDE);
        let mut bounds = vec![0; sides + 1];
        for side in 0..sides {
            let rows = side * SIDE..((side + 1) * SIDE).min(particles);
            bounds[side + 1] = bounds[side] + SIDE * rows.map(|particle| ends(particle)[2]).max().unwrap_or(0);
        }
        let (mut other, mut conductance) = (vec![0_u32; bounds[sides]], vec![0.0; bounds[sides]]);
        let of_sides = split(&mut other, &bounds).zip(split(&mut conductance, &bounds)).collect::<Vec<_>>();
        of_sides.into_par_iter().enumerate().for_each(|(side, (other, conductance))| {
            for particle in side * SIDE..((side + 1) * SIDE).min(particles) {
                for (k, (to, through)) in network.row(particle).enumerate() {
                    let place = k * SIDE + particle % SIDE;
                    (other[place], conductance[place]) = (to as u32, through);
                }
            }
        });
        let slice: Vec<u64> = bounds[..sides].iter().map(|&bound| bound as u64).collect();
        Ok(Rows {
            slice: queue.buffer_of(&slice)?,
            contacts_end: queue.buffer_of(&column(0))?,
            bonds_end: queue.buffer_of(&column(1))?,
            walls_end: queue.buffer_of(&column(2))?,
            other: queue.buffer_of(&other)?,
            conductance: queue.buffer_of(&conductance)?,
        })
    }
}

/// Vectors of a system.
const SYSTEM: usize = 7;

impl<M> System<M> {
    fn new<R: Runtime<Memory = M>>(queue: &Queue<R, Alone>, n: usize) -> Result<Self, Error> {
        Ok(System {
            end: queue.buffer(n)?,
            loss: queue.buffer(n)?,
            held: queue.buffer(n)?,
            diagonal: queue.buffer(n)?,
            residual: queue.buffer(n)?,
            change: queue.buffer(n)?,
            way: queue.buffer(n)?,
        })
    }
}

/// Bytes per particle, and per particle at either end of what conducts.
pub(super) fn bytes_each(plan: &Plan, heat: &HeatPlan) -> [usize; 2] {
    let (word, real) = (size_of::<u32>(), size_of::<f64>());
    let accounts = if plan.ledger { 2 * real } else { 0 };
    let system = if heat.motion.scheme() == Some(Scheme::Implicit) { SYSTEM * real } else { 0 };
    // Exposure and ends of rows; temperature, heat rates, capacity.
    [4 * word + 4 * real + accounts + system, word + real]
}

/// Exposures as kernels are told them, and their exchanges one behind the other.
fn surfaces(heat: &HeatPlan) -> (Vec<Surface>, Vec<ExchangeOf>) {
    let (mut surfaces, mut exchanges) = (Vec::new(), Vec::new());
    for exposure in &heat.exposures {
        let first_exchange = exchanges.len() as u32;
        // Where temperatures are prescribed, the exchanges do nothing.
        if exposure.temperature.is_none() {
            exchanges.extend(exposure.exchanges.iter().map(|(exchange, _)| ExchangeOf::from(exchange)));
        }
        surfaces.push(Surface {
            first_exchange,
            end_exchange: exchanges.len() as u32,
            prescribed: exposure.temperature.is_some().into(),
            padding: 0,
        });
    }
    (surfaces, exchanges)
}
