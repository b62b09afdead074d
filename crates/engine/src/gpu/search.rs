//! Stage `search`: the host's part of a new list on the device.

use super::layout::{
    Bounds, Box3, Cells, HistoryCount, HistoryWrite, InC, Level, OrderCells, OrderRanks, RowsCount, RowsFill, ScanAdd,
    ScanBlocks, ScanSums, Search, TakeImages, TakeQuads, TakeReals, TakeWords, Vector,
};
use super::memory::{Buffer, Queue};
use super::run::Gpu;
use super::runtime::{Error, Runtime};
use crate::cpu::{Division, Quad, budget, class_of};
use crate::{Fault, Plan, State};
use tdem_physics::contact::Friction;

/// Particles of a slice of rows, as in `kernels/particle.cl`.
pub(super) const SLICE: usize = 32;
/// Values of a block of the prefix sum.
const SCAN_BLOCK: usize = 1024;
/// Groups of the partial bounds.
const BOUNDS_GROUPS: usize = 256;
/// Rows of cells side by side in a strip. Strips beat bricks of 2 to 8 cells by 3 to 12 % on an H100: in a strip the
/// neighbours of particles side by side stand side by side, and are read as one.
const STRIP: u32 = 16;
/// Particles hardly move from one step to the next: where every step searches, they keep their order for so many.
const REORDER_EVERY: u64 = 32;

/// The neighbour list: rows in slices, see `kernels/particle.cl`.
pub(super) struct Rows<M> {
    /// Where each slice starts, in units of `SLICE` slots, `(slices + 1)`.
    pub(super) slice: Buffer<u32, M>,
    pub(super) other: Buffer<u32, M>,
    /// Empty without friction.
    pub(super) displacement: Buffer<f64, M>,
    /// Positions when the list was made, in ticks.
    pub(super) reference: Buffer<u64, M>,
    pub(super) wall_reference: Buffer<Quad, M>,
}

/// What touching pairs remember, in the order of the particles when it was put aside, see `kernels/history.cl`.
pub(super) struct Histories<M> {
    /// `(N + 1)`.
    pub(super) starts: Buffer<u32, M>,
    pub(super) partners: Buffer<u32, M>,
    /// 3 numbers each; empty without friction.
    pub(super) remembered: Buffer<f64, M>,
}

/// Room for a search, beside the free half.
pub(super) struct Scratch<M> {
    order: Buffer<u32, M>,
    cell_start: Buffer<u32, M>,
    sums: Buffer<u32, M>,
    /// The last prefix sum's total.
    total: Buffer<u32, M>,
    corners: Buffer<Quad, M>,
    levels: Buffer<Level, M>,
    /// What is in `levels`.
    known_levels: Vec<Level>,
}

impl<M> Rows<M> {
    pub(super) fn new<R: Runtime<Memory = M>>(queue: &Queue<R>, n: usize, walls: usize) -> Result<Self, Error> {
        Ok(Rows {
            slice: queue.zeros(n.div_ceil(SLICE) + 1)?,
            other: queue.buffer(0)?,
            displacement: queue.buffer(0)?,
            reference: queue.buffer(n)?,
            wall_reference: queue.buffer(walls)?,
        })
    }
}

impl<M> Histories<M> {
    /// Those of a validated state.
    pub(super) fn of_state<R: Runtime<Memory = M>>(
        queue: &Queue<R>,
        state: &State,
        friction: bool,
    ) -> Result<Self, Error> {
        let n = state.len();
        let rank = |id: u32| state.index_of(id).unwrap_or(0);
        let pairs = state.contacts.iter().map(|c| (rank(c.first), rank(c.second) as u32, c.displacement));
        let walls = state.wall_contacts.iter().map(|c| (rank(c.particle), n as u32 + c.wall, c.displacement));
        let mut all: Vec<_> = pairs.chain(walls).collect();
        all.sort_by_key(|&(rank, partner, _)| (rank, partner));
        let mut starts = vec![0_u32; n + 1];
        for &(rank, ..) in &all {
            starts[rank + 1] += 1;
        }
        for rank in 0..n {
            starts[rank + 1] += starts[rank];
        }
        let partners: Vec<u32> = all.iter().map(|&(_, partner, _)| partner).collect();
        let remembered: Vec<f64> =
            if friction { all.iter().flat_map(|&(.., displacement)| displacement).collect() } else { Vec::new() };
        Ok(Histories {
            starts: queue.buffer_of(&starts)?,
            partners: queue.buffer_of(&partners)?,
            remembered: queue.buffer_of(&remembered)?,
        })
    }
}

impl<M> Scratch<M> {
    pub(super) fn new<R: Runtime<Memory = M>>(queue: &Queue<R>, n: usize) -> Result<Self, Error> {
        Ok(Scratch {
            order: queue.buffer(n)?,
            cell_start: queue.buffer(0)?,
            sums: queue.buffer(0)?,
            total: queue.buffer(1)?,
            corners: queue.buffer(2 * BOUNDS_GROUPS)?,
            levels: queue.buffer(32)?,
            known_levels: Vec::new(),
        })
    }
}

/// Bytes of the list and of what is needed to make it: per particle, if there are as many cells; per slot of a row; per
/// touching pair.
pub(super) fn bytes_each(plan: &Plan) -> [usize; 3] {
    let word = size_of::<u32>();
    let displacement = if plan.law.friction == Friction::Off { 0 } else { 3 * size_of::<f64>() };
    // The reference; the order, the start of a cell, that of the histories put aside.
    [size_of::<u64>() + 3 * word, word + displacement, word + displacement]
}

/// Makes sure of room for `len` values; what was there may be lost.
fn reserve<T: InC, R: Runtime>(
    queue: &Queue<R>,
    buffer: &mut Buffer<T, R::Memory>,
    len: usize,
    headroom: usize,
) -> Result<(), Error> {
    if buffer.len() < len {
        // The old memory goes back first: there may not be room for both.
        *buffer = queue.buffer(0)?;
        *buffer = queue.buffer(len + headroom)?;
    }
    buffer.set_used(len);
    Ok(())
}

impl<R: Runtime> Gpu<R> {
    /// Puts aside what pairs remember, if they remember anything that the contact stage does not find by itself.
    pub(super) fn carry_histories(&mut self) -> Result<bool, Fault> {
        let carry = self.rows.displacement.len() > 0;
        if carry {
            self.put_histories_aside()?;
        }
        Ok(carry)
    }

    /// Lists all pairs within the skin anew, in the order of space, with the histories put aside, if any.
    pub(super) fn list_with(&mut self, histories: bool) -> Result<(), Fault> {
        let n = self.particles;
        let occupied = if self.plan.expands() { Some(self.occupied()?) } else { None };
        if let Some([low, high]) = &occupied {
            (self.smallest, self.largest) = (low.scalar(), high.scalar());
        }
        let skin = self.list_skin();
        let reach = 2.0 * self.largest + skin;
        for (length, periodic) in self.plan.domain.length().into_iter().zip(self.plan.domain.periodic) {
            if periodic && length < 2.0 * reach {
                return Err(Fault::BoxTooSmall { length, reach });
            }
        }
        let reordered = self.searches.is_multiple_of(if self.plan.search.every_step { REORDER_EVERY } else { 1 });
        self.searches += 1;
        let (levels, cells) = self.levels(skin, occupied)?;
        let wraps = self.plan.domain.periodic.iter().enumerate().fold(0, |bits, (k, &p)| bits | u32::from(p) << k);
        let search = Search {
            skin,
            largest: self.largest,
            origin: self.step_record.domain_min,
            ticks_per_metre: self.step_record.ticks_per_metre,
            period: Box3::from(&self.plan.domain.period()),
            particles: n as u32,
            walls: self.plan.walls.len() as u32,
            items: self.step_record.items,
            levels: levels.len() as u32,
            wraps,
            histories: histories.into(),
            reordered: reordered.into(),
            bond_slots: self.bonds.slots,
        };
        let (queue, scratch) = (&self.queue, &mut self.scratch);
        if scratch.known_levels != levels {
            scratch.levels.set_used(levels.len());
            queue.upload(&scratch.levels, &levels)?;
            scratch.known_levels.clone_from(&levels);
        }
        reserve(queue, &mut scratch.cell_start, cells + 1, cells / 4)?;
        queue.clear(&scratch.cell_start, cells + 1)?;
        let free = &self.halves[1 - self.now];
        let (cell_of, place_in_cell) = (&free.place.room(n), &free.motion.room(n));
        queue.run(
            &Cells {
                search,
                levels: &scratch.levels,
                place: &self.halves[self.now].place,
                cell_count: &scratch.cell_start,
                cell_of,
                place_in_cell,
            },
            n,
        )?;
        scan(queue, &mut scratch.sums, &scratch.total, &scratch.cell_start, cells)?;
        queue.run(
            &OrderCells {
                particles: n as u32,
                cell_start: &scratch.cell_start,
                cell_of,
                place_in_cell,
                order: &scratch.order,
            },
            n,
        )?;
        queue.run(
            &OrderRanks {
                cell_total: cells as u32,
                cell_start: &scratch.cell_start,
                rank: &self.fields.rank,
                order: &scratch.order,
            },
            cells,
        )?;
        if reordered {
            self.reorder()?;
        }
        self.fill_rows(search)
    }

    /// Counts, lays out and fills the rows.
    fn fill_rows(&mut self, search: Search) -> Result<(), Fault> {
        let n = self.particles;
        let slices = n.div_ceil(SLICE);
        let (queue, scratch, rows) = (&self.queue, &mut self.scratch, &mut self.rows);
        let (half, free) = (&self.halves[self.now], &self.halves[1 - self.now]);
        let (known_low, known_high) = (&free.place.room(n), &free.motion.room(n));
        queue.run(
            &RowsCount {
                search,
                levels: &scratch.levels,
                cell_start: &scratch.cell_start,
                place: &half.place,
                rank: &self.fields.rank,
                order: &scratch.order,
                walls: &self.constants.walls,
                wall_place: &half.wall_place,
                slice_length: &rows.slice,
                known_low,
                known_high,
            },
            n,
        )?;
        scan(queue, &mut scratch.sums, &scratch.total, &rows.slice, slices)?;
        let slots = queue.read(&scratch.total, 1)?[0] as usize * SLICE;
        let headroom = slots / 128;
        reserve(queue, &mut rows.other, slots, headroom)?;
        if self.friction {
            reserve(queue, &mut rows.displacement, 3 * slots, 3 * headroom)?;
        }
        queue.run(
            &RowsFill {
                search,
                levels: &scratch.levels,
                cell_start: &scratch.cell_start,
                place: &half.place,
                rank: &self.fields.rank,
                known_low,
                known_high,
                walls: &self.constants.walls,
                wall_place: &half.wall_place,
                order: &scratch.order,
                starts: &self.histories.starts,
                partners: &self.histories.partners,
                remembered: &self.histories.remembered,
                slice: &rows.slice,
                other: &rows.other,
                displacement: &rows.displacement,
                reference: &rows.reference,
                wall_reference: &rows.wall_reference,
                bond_other: &self.bonds.other,
                listed_radius: &self.heat.listed_radius,
            },
            search.items as usize,
        )?;
        Ok(())
    }

    /// Up to which gap pairs are listed. A pair that touched in the last step must be listed even if it has just parted,
    /// whatever skin was asked for: the contact stage closes its history.
    fn list_skin(&self) -> f64 {
        let parted = 2.000_001 * self.step_way + 1e-9 * self.largest;
        self.plan.search.skin.max(parted)
    }

    /// Puts aside what touching pairs remember; the number of entries.
    pub(super) fn put_histories_aside(&mut self) -> Result<usize, Fault> {
        let n = self.particles;
        let (queue, rows, kept) = (&self.queue, &self.rows, &mut self.histories);
        let rank = &self.fields.rank;
        let particles = n as u32;
        queue
            .run(&HistoryCount { particles, slice: &rows.slice, other: &rows.other, rank, counts: &kept.starts }, n)?;
        scan(queue, &mut self.scratch.sums, &self.scratch.total, &kept.starts, n)?;
        let entries = queue.read(&self.scratch.total, 1)?[0] as usize;
        reserve(queue, &mut kept.partners, entries, entries / 128)?;
        if self.friction {
            reserve(queue, &mut kept.remembered, 3 * entries, 3 * (entries / 128))?;
        }
        queue.run(
            &HistoryWrite {
                particles,
                slice: &rows.slice,
                other: &rows.other,
                displacement: &rows.displacement,
                rank,
                starts: &kept.starts,
                partners: &kept.partners,
                remembered: &kept.remembered,
            },
            n,
        )?;
        Ok(entries)
    }

    /// The cells of each size class over the space that particles occupy, and the number of all cells.
    fn levels(&self, skin: f64, occupied: Option<[Quad; 2]>) -> Result<(Vec<Level>, usize), Fault> {
        let domain = &self.plan.domain;
        let budget = budget(self.particles);
        let width = 2.0 * self.largest + skin;
        let of_domain: f64 = domain.length().iter().map(|length| (length / width).max(1.0)).product();
        // A domain of few cells is taken as it is: looking for the bounds of the particles takes longer.
        let (low, high) = if of_domain <= budget as f64 {
            (domain.min, domain.max)
        } else {
            let [low, high] = occupied.map_or_else(|| self.occupied(), Ok)?;
            (low.vector().into(), high.vector().into())
        };
        let min: [f64; 3] = std::array::from_fn(|k| if domain.periodic[k] { domain.min[k] } else { low[k] });
        let max: [f64; 3] = std::array::from_fn(|k| if domain.periodic[k] { domain.max[k] } else { high[k] });
        let (mut levels, mut cells) = (Vec::new(), 0_u32);
        let mut radius = self.largest;
        for _ in 0..=class_of(self.smallest, self.largest) {
            let width = 1.000_000_1 * (2.0 * radius + skin);
            let extent = std::array::from_fn(|k| max[k] - min[k]);
            let division = Division::new(extent, width, domain.periodic, budget);
            let ([x, y, z], [along_x, along_y, along_z]) = (division.cells, division.along);
            let strip = y.min(STRIP);
            levels.push(Level {
                min: Vector(min),
                per_metre: Vector(division.per_metre),
                largest: radius,
                along_x,
                along_y,
                along_z,
                cells_x: x,
                cells_y: y,
                cells_z: z,
                first_cell: cells,
                strip,
            });
            cells += y.div_ceil(strip) * strip * x * z;
            radius *= 0.5;
        }
        Ok((levels, cells as usize))
    }

    /// The bounds of all centres and of all radii.
    fn occupied(&self) -> Result<[Quad; 2], Fault> {
        let corners = &self.scratch.corners;
        let call = Bounds { particles: self.particles as u32, place: &self.halves[self.now].place, corners };
        self.queue.run_groups(&call, BOUNDS_GROUPS)?;
        let corners = self.queue.read(corners, 2 * BOUNDS_GROUPS)?;
        let mut bounds = [Quad([f64::INFINITY; 4]), Quad([f64::NEG_INFINITY; 4])];
        for pair in corners.chunks_exact(2) {
            for k in 0..4 {
                bounds[0].0[k] = bounds[0].0[k].min(pair[0].0[k]);
                bounds[1].0[k] = bounds[1].0[k].max(pair[1].0[k]);
            }
        }
        Ok(bounds)
    }

    /// Puts all fields in the order found.
    fn reorder(&mut self) -> Result<(), Fault> {
        let n = self.particles;
        let particles = n as u32;
        let (queue, order) = (&self.queue, &self.scratch.order);
        let [first, second] = &self.halves;
        let (from, to) = if self.now == 0 { (first, second) } else { (second, first) };
        let moving = [
            (&from.place, &to.place),
            (&from.motion, &to.motion),
            (&from.spin, &to.spin),
            (&from.orientation, &to.orientation),
        ];
        for (from, to) in moving {
            if from.len() > 0 {
                queue.run(&TakeQuads { particles, order, from, to }, n)?;
            }
        }
        if from.temperature.len() > 0 {
            queue.run(&TakeReals { particles, order, from: &from.temperature, to: &to.temperature }, n)?;
        }
        queue.copy(&from.wall_place, &to.wall_place)?;
        self.now = 1 - self.now;
        // What these halves held is elsewhere now: the free one is room in which a field is put in order.
        let (fields, free) = (&mut self.fields, &mut self.halves[1 - self.now]);
        let room = &mut free.motion;
        if self.bonds.slots > 0 {
            self.bonds.reorder(queue, order, &free.place, room)?;
        }
        self.heat.reorder(queue, order, room)?;
        for field in [&fields.rank, &fields.kind] {
            let to = &room.room(n);
            queue.run(&TakeWords { particles, order, from: field, to }, n)?;
            queue.copy(to, field)?;
        }
        if fields.image.len() > 0 {
            let to = &room.room(3 * n);
            queue.run(&TakeImages { particles, order, from: &fields.image, to }, n)?;
            queue.copy(to, &fields.image)?;
        }
        let [x, y, z] = &mut fields.derivatives;
        let (accounts, kicks) = (&mut fields.accounts, [&mut fields.kick_by_half, &mut fields.twist_by_half]);
        let (booked, places) = (&mut self.heat.accounts, &mut self.bonds.place);
        for field in [x, y, z, accounts, booked, places].into_iter().chain(kicks) {
            if field.len() > 0 {
                queue.run(&TakeQuads { particles, order, from: field, to: room }, n)?;
                std::mem::swap(field, room);
            }
        }
        Ok(())
    }
}

/// Exclusive prefix sum of `count` values in their own place; the entry behind the last, and `total`, get the total.
fn scan<R: Runtime>(
    queue: &Queue<R>,
    sums: &mut Buffer<u32, R::Memory>,
    total: &Buffer<u32, R::Memory>,
    values: &Buffer<u32, R::Memory>,
    count: usize,
) -> Result<(), Error> {
    let blocks = (count + 1).div_ceil(SCAN_BLOCK);
    reserve(queue, sums, blocks, blocks / 4)?;
    let sums = &*sums;
    queue.run_groups(&ScanBlocks { count: count as u32, values, sums }, blocks)?;
    queue.run_groups(&ScanSums { count: blocks as u32, sums, total }, 1)?;
    queue.run_groups(&ScanAdd { count: count as u32, starts: values, sums }, blocks)
}
