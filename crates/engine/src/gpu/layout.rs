//! What both sides of a launch agree on, in one table per program: the structs, and the parameters of every kernel.
//!
//! A kernel's head is written from this table, and its launch takes its arguments by the same names and types: a
//! mismatch between host and kernel does not compile on one side or the other. How much a launch moves at least is
//! counted from it, too. Each parameter has one of these words before its type:
//!
//! | word | what the kernel does | counted |
//! |---|---|---|
//! | `value` | is told a number or a struct | no |
//! | `read` | reads it; nobody writes it meanwhile | once |
//! | `write` | writes it | once |
//! | `update` | reads and writes it | twice |
//! | `shared` | the same, and one work-item may see what another wrote | twice |
//! | `amend` | reads it, and writes where something changed, which is seldom | once |
//! | `seldom` | does without it for nearly all particles, or in many launches | no |
//! | `touching_update` | reads and writes what touching pairs remember, in both rows | twice |
//! | `touching_read` | reads that in one of both rows | once |
//!
//! `where` names the variants that use the parameter, if others do not.

use super::memory::Buffer;
use super::program::Variant;
use super::runtime::Argument;
use super::traffic::Traffic;
use crate::cpu::Quad;
use bytemuck::{Pod, Zeroable};
use tdem_physics::bond;
use tdem_physics::contact::Interaction;
use tdem_physics::heat::{Conductor, Dissipation, Exchange, Link};
use tdem_physics::print::Members;

/// A type that the host and kernels lay out alike.
pub(crate) trait InC: Pod {
    /// Its name in C.
    const NAME: &'static str;
}
impl InC for f64 {
    const NAME: &'static str = "real";
}
impl InC for u32 {
    const NAME: &'static str = "u32";
}
impl InC for u64 {
    const NAME: &'static str = "u64";
}
impl InC for i32 {
    const NAME: &'static str = "i32";
}

impl InC for Quad {
    const NAME: &'static str = "Quad";
}

/// Three numbers, not padded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct Vector(pub(crate) [f64; 3]);
impl InC for Vector {
    const NAME: &'static str = "Vec3";
}

macro_rules! flat {
    ($(#[$about:meta])* $name:ident as $c:literal, $count:literal from $law:ty) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
        #[repr(transparent)]
        pub(crate) struct $name([f64; $count]);
        impl InC for $name {
            const NAME: &'static str = $c;
        }
        impl From<&$law> for $name {
            fn from(law: &$law) -> Self {
                let mut numbers = [0.0; $count];
                let mut places = numbers.iter_mut();
                law.write(&mut |number| *places.next().expect("as many places as numbers") = number);
                assert!(places.next().is_none(), "as many numbers as places");
                $name(numbers)
            }
        }
    };
}
flat!(
    /// [`Interaction`], as the printed laws lay it out.
    Pair as "Interaction", 7 from Interaction<f64>
);
flat!(
    /// [`bond::Bond`], as the printed laws lay it out.
    Beam as "Bond", 14 from bond::Bond<f64>
);
flat!(
    /// [`bond::Joint`], as the printed laws lay it out.
    JointOf as "Joint", 9 from bond::Joint<f64>
);
flat!(
    /// [`Conductor`], as the printed laws lay it out.
    ConductorOf as "Conductor", 2 from Conductor<f64>
);
flat!(
    /// [`Link`], as the printed laws lay it out.
    LinkOf as "Link", 3 from Link<f64>
);
flat!(
    /// [`Dissipation`], as the printed laws lay it out.
    DissipationOf as "Dissipation", 2 from Dissipation<f64>
);
flat!(
    /// [`Exchange`], as the printed laws lay it out.
    ExchangeOf as "Exchange", 4 from Exchange<f64>
);
flat!(
    /// [`tdem_physics::contact::Period`], as the printed laws lay it out.
    Box3 as "Period", 6 from tdem_physics::contact::Period<f64>
);

macro_rules! records {
    ($($(#[$about:meta])* $name:ident { $($(#[$field_about:meta])* $field:ident: $type:ty),* $(,)? })*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
            #[repr(C)]
            pub(crate) struct $name { $($(#[$field_about])* pub(crate) $field: $type),* }
            impl InC for $name {
                const NAME: &'static str = stringify!($name);
            }
        )*
        /// The structs, as typedefs of C.
        pub(in crate::gpu) fn record_definitions() -> String {
            let mut text = String::new();
            $(
                text += "typedef struct {\n";
                $(text += &format!("    {} {};\n", <$type as InC>::NAME, stringify!($field));)*
                text += concat!("} ", stringify!($name), ";\n");
            )*
            text
        }
        /// Name and size of every struct.
        #[cfg(test)]
        pub(in crate::gpu) fn record_sizes() -> Vec<(&'static str, usize)> {
            vec![$((stringify!($name), size_of::<$name>())),*]
        }
    };
}

records! {
    /// What the kernels of a step are told.
    Step {
        /// s.
        dt: f64,
        /// Half of it, s.
        half_dt: f64,
        /// $\Delta t$ as forces see it, s: 0 while a fresh state is prepared.
        history_dt: f64,
        /// Time by which positions are ahead of velocities, s: 0 while a fresh state is prepared.
        lead: f64,
        /// Time of the end of the step before the present one, s.
        former_time: f64,
        /// Time of the end of the present step, s.
        time: f64,
        /// Time in the middle of the next step, s.
        middle_time: f64,
        /// Time of the end of the next step, s.
        next_time: f64,
        /// How far a wall may move before the list is due, m².
        half_skin_squared: f64,
        /// Ticks are what ways of particles are measured in, 1/m.
        ticks_per_metre: f64,
        /// Longer ways in one step are noted, m²: the list reaches farther then.
        noted_way_squared: f64,
        /// Largest overlap over the sum of radii.
        overlap_limit: f64,
        /// m/s².
        gravity: Vector,
        /// m.
        domain_min: Vector,
        /// m.
        domain_max: Vector,
        period: Box3,
        /// The parameters of the only pair of materials, if there is only one.
        pair: Pair,
        /// The numbers of all bonds, if there is only one kind of them.
        bond: Beam,
        /// Coefficient of local damping.
        local_damping: f64,
        /// The step of the heat, s.
        heat_dt: f64,
        /// Time of the heat at the end of the present step, s.
        heat_time: f64,
        /// Time of the heat in the middle of the next step, s.
        heat_middle_time: f64,
        /// Time of the heat at the end of the next step, s.
        next_heat_time: f64,
        /// Where radii are those that were given and bonds are free of stress, K.
        reference_temperature: f64,
        /// What contacts conduct with, if that is the same for all.
        conductor: ConductorOf,
        /// What all bonds are to heat, if there is only one kind of them.
        link: LinkOf,
        /// Which parts of the energy that motion loses become heat.
        dissipation: DissipationOf,
        particles: u32,
        walls: u32,
        /// Work-items: the larger of both.
        items: u32,
        materials: u32,
        /// Which flags are read; the others are raised.
        parity: u32,
        /// Forces are computed, but nothing is remembered.
        frozen: u32,
        /// Whether a prediction begins with the end of the step before.
        corrects: u32,
        /// A particle with this way or a longer one makes the list due, squared ticks.
        ticks_allowed: u32,
        /// Planes of bonds.
        bond_slots: u32,
        /// Of this step, counted from where records of broken bonds begin.
        number: u32,
        bonds: u32,
        padding: u32,
    }
    /// A plane wall. Its temperature is that of its pieces; without any it is insulated.
    Wall {
        normal: Vector,
        velocity: Vector,
        material: u32,
        first_piece: u32,
        end_piece: u32,
        padding: u32,
    }
    /// Components of motion that forces do not govern: three bits for the velocity, three for the angular velocity. Pieces
    /// of ramps replace its numbers.
    Constraint {
        velocity: Vector,
        angular_velocity: Vector,
        /// N.
        force: Vector,
        components: u32,
        first_piece: u32,
        end_piece: u32,
        padding: u32,
    }
    /// A straight piece of a ramp, a course or a table: it holds from a time or temperature on until another.
    Piece {
        /// s or K.
        from: f64,
        /// s or K.
        until: f64,
        /// Two points of the line.
        start: f64,
        start_value: f64,
        end: f64,
        end_value: f64,
        /// Which of the nine numbers of a constraint a ramp is about.
        number: u32,
        padding: u32,
    }
    /// Pieces of a table over temperature.
    Tabled {
        first_piece: u32,
        end_piece: u32,
    }
    /// Pieces of the factors on stiffness and strength of the bonds of a pair of materials.
    Factors {
        stiffness: u32,
        end_stiffness: u32,
        strength: u32,
        end_strength: u32,
    }
    /// What a material is to heat.
    Thermal {
        /// J/(kg K).
        specific_heat: f64,
        /// 1/K.
        expansion: f64,
    }
    /// How particles exchange heat with their surroundings: at a temperature that pieces prescribe, or through exchanges.
    Exposure {
        first_piece: u32,
        end_piece: u32,
        first_exchange: u32,
        end_exchange: u32,
        /// A bit for each open side.
        sides: u32,
    }
    /// One exchange, and the pieces of what is outside: where those of the flux begin, of the fluid, of the surroundings, and
    /// where these end.
    Exchanging {
        exchange: ExchangeOf,
        flux_piece: u32,
        fluid_piece: u32,
        surroundings_piece: u32,
        end_piece: u32,
    }
    /// What the kernels of a search are told.
    Search {
        /// m.
        skin: f64,
        /// Largest radius, m.
        largest: f64,
        /// Where ticks are counted from, m.
        origin: Vector,
        /// 1/m.
        ticks_per_metre: f64,
        period: Box3,
        particles: u32,
        walls: u32,
        /// Work-items: the larger of both.
        items: u32,
        levels: u32,
        /// A bit for each direction that repeats.
        wraps: u32,
        /// Whether histories were put aside.
        histories: u32,
        /// Whether particles were put in the order of cells.
        reordered: u32,
        /// Planes of bonds.
        bond_slots: u32,
    }
    /// The cells of one size class.
    Level {
        /// m.
        min: Vector,
        /// Cells per metre.
        per_metre: Vector,
        /// Largest radius of the class, m.
        largest: f64,
        /// Cells along the box.
        along_x: u32,
        along_y: u32,
        along_z: u32,
        /// Cells that are kept, see `cpu::Division`.
        cells_x: u32,
        cells_y: u32,
        cells_z: u32,
        first_cell: u32,
        /// Rows side by side in a strip.
        strip: u32,
    }
}

/// A launch: a kernel and its arguments.
pub(crate) trait Call<M> {
    /// What the kernel is a part of.
    type Program;
    /// The kernel's name.
    const NAME: &'static str;
    /// Work-items of a group.
    const GROUP: usize;
    /// The arguments, in the order of the head.
    fn arguments(&self) -> Vec<Argument<'_, M>>;
    /// What it moves at least in this variant of the program, if nothing halts it.
    fn traffic(&self, program: &Self::Program) -> Traffic;
}

/// How a kernel of the table is written in C.
pub(super) struct Head {
    pub(super) name: &'static str,
    pub(super) text: String,
}

/// Skeletons with the heads of their kernels.
///
/// # Panics
/// If a kernel of the table is not written exactly once.
pub(super) fn with_heads(mut skeletons: String, heads: &[Head]) -> String {
    for head in heads {
        let marker = format!("\nkernel {}\n", head.name);
        assert_eq!(skeletons.matches(&marker).count(), 1, "kernel {} is written once", head.name);
        skeletons = skeletons.replace(&marker, &format!("\n{}\n", head.text));
    }
    skeletons
}

macro_rules! parameter {
    (value $type:ty, $name:ident) => {
        format!("const {} {}", <$type as InC>::NAME, stringify!($name))
    };
    (read $type:ty, $name:ident) => {
        format!("GLOBAL const {} *RESTRICT {}", <$type as InC>::NAME, stringify!($name))
    };
    (touching_read $type:ty, $name:ident) => {
        parameter!(read $type, $name)
    };
    (shared $type:ty, $name:ident) => {
        format!("GLOBAL {} *{}", <$type as InC>::NAME, stringify!($name))
    };
    ($use:ident $type:ty, $name:ident) => {
        format!("GLOBAL {} *RESTRICT {}", <$type as InC>::NAME, stringify!($name))
    };
}
macro_rules! field_type {
    (value $type:ty, $life:lifetime, $memory:ident) => { $type };
    ($use:ident $type:ty, $life:lifetime, $memory:ident) => { &$life Buffer<$type, $memory> };
}
macro_rules! argument {
    (value, $field:expr) => {
        Argument::Value(bytemuck::bytes_of(&$field))
    };
    ($use:ident, $field:expr) => {
        Argument::Memory($field.memory())
    };
}
macro_rules! traffic {
    (value, $field:expr) => {
        Traffic::default()
    };
    (seldom, $field:expr) => {
        Traffic::default()
    };
    (update, $field:expr) => {
        Traffic::twice($field)
    };
    (shared, $field:expr) => {
        Traffic::twice($field)
    };
    (touching_update, $field:expr) => {
        Traffic::of_touching_slots($field)
    };
    (touching_read, $field:expr) => {
        Traffic::of_histories($field)
    };
    ($use:ident, $field:expr) => {
        Traffic::once($field)
    };
}
macro_rules! used_by {
    () => {
        |_| true
    };
    ($variants:expr) => {
        $variants
    };
}

macro_rules! kernels {
    (of $program:ty; $($(#[$about:meta])* $kernel:ident as $call:ident($group:literal, $groups:literal) {
        $($parameter:ident: $use:ident $type:ty $(where $variants:expr)?),* $(,)?
    })*) => {
        $(
            $(#[$about])*
            pub(crate) struct $call<'a, M> { $(pub(crate) $parameter: field_type!($use $type, 'a, M)),* }
            impl<M> Call<M> for $call<'_, M> {
                type Program = $program;
                const NAME: &'static str = stringify!($kernel);
                const GROUP: usize = $group;
                fn arguments(&self) -> Vec<Argument<'_, M>> {
                    vec![$(argument!($use, self.$parameter)),*]
                }
                fn traffic(&self, program: &$program) -> Traffic {
                    let parameters: Vec<(fn(&$program) -> bool, Traffic)> =
                        vec![$((used_by!($($variants)?), traffic!($use, self.$parameter))),*];
                    let used = parameters.into_iter().filter(|(used_by, _)| used_by(program));
                    used.map(|(_, traffic)| traffic).sum()
                }
            }
        )*
        /// Every kernel's head: `KERNEL(threads, groups) name(parameters)`.
        pub(in crate::gpu) fn heads() -> Vec<Head> {
            vec![$({
                let parameters = [$(parameter!($use $type, $parameter)),*];
                Head {
                    name: stringify!($kernel),
                    text: format!(
                        "KERNEL({}, {}) {}({})",
                        $group,
                        $groups,
                        stringify!($kernel),
                        parameters.join(",\n    ")
                    ),
                }
            }),*]
        }
    };
}

kernels! {
    of Variant;
    /// See `kernels/predict.cl`.
    predict as Predict(128, 4) {
        step: value Step, status: shared u32,
        place: update Quad, motion: update Quad, spin: update Quad, force: read Quad, moment: read Quad,
        derivatives_x: update Quad, derivatives_y: update Quad, derivatives_z: update Quad,
        image: seldom i32, kind: read u32 where |v| v.constrained || v.heat.is_some(),
        constraints: read Constraint where |v| v.constrained, pieces: read Piece, reference: amend u64,
        walls: read Wall, wall_place: shared Quad, wall_reference: read Quad,
        kick_by_half: write Quad, twist_by_half: write Quad, orientation: update Quad,
        temperature: update f64, reference_radius: read f64, listed_radius: read f64, thermals: read Thermal,
        exposure: read u32, exposures: read Exposure, specific_heats: read Tabled,
        heat_accounts: seldom Quad, work_per_kelvin: read f64, warming: write f64,
    }
    /// See `kernels/bond.cl`.
    bond as EvaluateBonds(128, 4) {
        step: value Step, status: shared u32,
        place: read Quad, motion: read Quad where |v| v.bonds_move(),
        spin: read Quad where |v| v.bonds_move() || v.heat.is_some(),
        orientation: read Quad where |v| !v.bonds_remember(), bonded_place: read Quad where |v| !v.bonds_remember(),
        kind: read u32 where |v| !v.one_bond || v.links_by_material() || v.tempers_pairs(), interactions: seldom Pair,
        joints: read JointOf where |v| !v.alike_bonds, beams: read Beam where |v| v.alike_bonds && !v.one_bond,
        slice: seldom u32, other: seldom u32, bond_other: seldom u32, bond_ends: amend u32, bond_length: read f64,
        bond_strength: read f64, bond_history: update f64, reaction: write Vector, bond_lost: write f64,
        broken: seldom u32, released: seldom f64, kick_by_half: read Quad, twist_by_half: read Quad,
        temperature: read f64, reference_radius: read f64 where |v| v.bonds_by_radius(),
        thermals: read Thermal where |v| !v.alike_links, conductors: read ConductorOf where |v| !v.one_conductor,
        links: read LinkOf where |v| !v.one_link, exposure: read u32 where |v| v.bounded,
        exposures: read Exposure where |v| v.bounded, bond_flow: write f64, bond_work: write f64,
        pieces: read Piece where |v| v.tempers_pairs(), conductivities: read Tabled, factors: read Factors,
    }
    /// See `kernels/contact.cl`.
    contact as Contact(128, 3) {
        step: value Step, status: shared u32,
        place: read Quad, motion: read Quad, spin: read Quad, force: write Quad, moment: write Quad,
        kind: read u32 where |v| {
            !v.one_pair || v.constrained || v.asks_constraints() || v.bonds && !v.one_bond || v.links_by_material()
                || v.heat.is_some() && !v.one_conductor || v.tempers_pairs()
        },
        rank: read u32 where |v| v.ledger,
        interactions: read Pair where |v| !v.one_pair,
        constraints: read Constraint where |v| v.asks_constraints(),
        pieces: read Piece where |v| v.asks_constraints() || v.heat.is_some(),
        slice: read u32, other: amend u32, displacement: touching_update f64,
        walls: read Wall, wall_place: read Quad,
        kick_by_half: read Quad, twist_by_half: read Quad, accounts: update Quad,
        orientation: read Quad where |v| !v.bonds_apart, bonded_place: read Quad where |v| !v.bonds_apart,
        joints: read JointOf where |v| !v.alike_bonds && !v.bonds_apart,
        beams: read Beam where |v| v.alike_bonds && !v.one_bond && !v.bonds_apart,
        bond_other: amend u32 where |v| !v.bonds_apart, bond_start: seldom u32,
        bond_strength: read f64 where |v| !v.bonds_apart, broken: seldom u32, released: seldom f64,
        bond_number: read u32, reaction: read Vector, bond_lost: read f64, bond_flow: read f64,
        bond_work: read f64,
        temperature: read f64, reference_radius: read f64 where |v| v.bonds_by_radius() && !v.bonds_apart,
        thermals: read Thermal where |v| !v.alike_links, conductors: read ConductorOf where |v| !v.one_conductor,
        links: read LinkOf where |v| !v.one_link, exposure: read u32, exposures: read Exposure, exchanges: read Exchanging,
        conductivities: read Tabled, factors: read Factors,
        heat_accounts: seldom Quad, work_per_kelvin: write f64, warming: read f64,
    }
    /// See `kernels/correct.cl`.
    correct as Correct(128, 4) {
        step: value Step, status: shared u32,
        place: update Quad where |v| v.gear, motion: update Quad, spin: update Quad, force: read Quad, moment: read Quad,
        derivatives_x: update Quad, derivatives_y: update Quad, derivatives_z: update Quad,
        kind: read u32 where |v| v.constrained, constraints: read Constraint where |v| v.constrained,
        pieces: read Piece where |v| v.ramps,
    }
    /// See `kernels/fused.cl`.
    fused as Fused(128, 4) {
        step: value Step, status: shared u32,
        place: read Quad, motion: read Quad, spin: read Quad,
        next_place: write Quad, next_motion: write Quad, next_spin: write Quad,
        image: seldom i32,
        kind: read u32 where |v| v.constrained || !v.one_pair || v.bonds && !v.one_bond || v.heat.is_some(),
        interactions: read Pair where |v| !v.one_pair, constraints: read Constraint where |v| v.constrained,
        pieces: read Piece, reference: amend u64,
        slice: read u32, other: amend u32, displacement: touching_update f64,
        walls: read Wall, wall_place: read Quad, next_wall_place: write Quad, wall_reference: read Quad,
        rank: seldom u32, orientation: read Quad, next_orientation: write Quad,
        bonded_place: read Quad where |v| !v.bonds_apart,
        joints: read JointOf where |v| !v.alike_bonds && !v.bonds_apart,
        beams: read Beam where |v| v.alike_bonds && !v.one_bond && !v.bonds_apart,
        bond_other: amend u32 where |v| !v.bonds_apart, bond_start: seldom u32,
        bond_strength: read f64 where |v| !v.bonds_apart, broken: seldom u32, released: seldom f64,
        bond_number: read u32, reaction: read Vector, bond_flow: read f64,
        temperature: read f64, next_temperature: write f64, reference_radius: read f64, listed_radius: read f64,
        thermals: read Thermal, conductors: read ConductorOf where |v| !v.one_conductor,
        links: read LinkOf where |v| !v.one_link, exposure: read u32, exposures: read Exposure, exchanges: read Exchanging,
        conductivities: read Tabled, specific_heats: read Tabled, factors: read Factors,
    }
    /// See `kernels/bond.cl`.
    take_bonds as TakeBonds(128, 4) {
        particles: value u32, first: value u32, planes: value u32, order: read u32, index_of: read u32,
        bond_other: read u32, room: write u32,
    }
    /// See `kernels/bond.cl`.
    take_numbers as TakeNumbers(128, 4) {
        particles: value u32, first: value u32, planes: value u32, order: read u32, bond_number: read u32, room: write u32,
    }
    /// See `kernels/bond.cl`.
    follow_ends as FollowEnds(128, 4) { count: value u32, index_of: read u32, bond_ends: update u32 }
    /// See `kernels/bond.cl`.
    put_bonds as PutBonds(128, 4) {
        particles: value u32, first: value u32, planes: value u32, room: read u32, bond_other: write u32,
    }
    /// See `kernels/bond.cl`.
    take_strengths as TakeStrengths(128, 4) {
        particles: value u32, first: value u32, planes: value u32, order: read u32, strength: read f64, room: write f64,
    }
    /// See `kernels/bond.cl`.
    put_strengths as PutStrengths(128, 4) {
        particles: value u32, first: value u32, planes: value u32, room: read f64, strength: write f64,
    }
    /// See `kernels/bond.cl`.
    invert_order as InvertOrder(128, 4) { particles: value u32, order: read u32, index_of: write u32 }
    /// See `kernels/scan.cl`.
    scan_blocks as ScanBlocks(256, 4) {
        count: value u32, values: update u32, sums: write u32,
    }
    /// See `kernels/scan.cl`.
    scan_sums as ScanSums(256, 1) { count: value u32, sums: update u32, total: write u32 }
    /// See `kernels/scan.cl`.
    scan_add as ScanAdd(256, 4) { count: value u32, starts: update u32, sums: read u32 }
    /// See `kernels/history.cl`.
    history_count as HistoryCount(128, 4) {
        particles: value u32, slice: read u32, other: read u32, rank: read u32, counts: write u32,
    }
    /// See `kernels/history.cl`.
    history_write as HistoryWrite(128, 4) {
        particles: value u32, slice: read u32, other: read u32, displacement: touching_read f64, rank: read u32,
        starts: read u32, partners: write u32, remembered: write f64,
    }
    /// See `kernels/search.cl`.
    bounds as Bounds(128, 4) { particles: value u32, place: read Quad, corners: write Quad }
    /// See `kernels/search.cl`.
    cells as Cells(128, 4) {
        search: value Search, levels: read Level, place: read Quad,
        cell_count: shared u32, cell_of: write u32, place_in_cell: write u32,
    }
    /// See `kernels/search.cl`.
    order_cells as OrderCells(128, 4) {
        particles: value u32, cell_start: read u32, cell_of: read u32, place_in_cell: read u32, order: write u32,
    }
    /// See `kernels/search.cl`.
    order_ranks as OrderRanks(128, 4) { cell_total: value u32, cell_start: read u32, rank: read u32, order: amend u32 }
    /// See `kernels/search.cl`.
    take_quads as TakeQuads(128, 4) { particles: value u32, order: read u32, from: read Quad, to: write Quad }
    /// See `kernels/search.cl`.
    take_reals as TakeReals(128, 4) { particles: value u32, order: read u32, from: read f64, to: write f64 }
    /// See `kernels/search.cl`.
    take_words as TakeWords(128, 4) { particles: value u32, order: read u32, from: read u32, to: write u32 }
    /// See `kernels/search.cl`.
    take_images as TakeImages(128, 4) { particles: value u32, order: read u32, from: read i32, to: write i32 }
    /// See `kernels/search.cl`.
    rows_count as RowsCount(128, 4) {
        search: value Search, levels: read Level, cell_start: read u32, place: read Quad, rank: read u32, order: seldom u32,
        walls: read Wall, wall_place: read Quad, slice_length: write u32, known_low: write u32, known_high: write u32,
    }
    /// See `kernels/search.cl`.
    rows_fill as RowsFill(128, 8) {
        search: value Search, levels: read Level, cell_start: read u32, place: read Quad, rank: read u32,
        known_low: read u32, known_high: read u32, walls: read Wall, wall_place: read Quad,
        order: read u32, starts: read u32 where |v| v.friction(), partners: read u32 where |v| v.friction(),
        remembered: read f64 where |v| v.friction(), slice: read u32, other: write u32,
        displacement: write f64, reference: write u64, wall_reference: write Quad,
        bond_other: read u32 where |v| v.bonds_keep_off, listed_radius: write f64,
    }
}

/// The table of what arithmetic is measured with.
pub(super) mod arithmetic;
/// The table of heat alone.
pub(super) mod network;

#[cfg(test)]
mod tests {
    use super::super::devices::open_opencl;
    use super::super::runtime::{Fetch, Runtime};
    use super::*;
    use std::fmt::Write;
    use tdem_physics::print;

    #[test]
    fn structs_are_as_large_in_kernels_as_here() {
        let mut sizes = record_sizes();
        sizes.extend(network::record_sizes());
        sizes.extend(arithmetic::record_sizes());
        sizes.extend([
            (Pair::NAME, size_of::<Pair>()),
            (Beam::NAME, size_of::<Beam>()),
            (JointOf::NAME, size_of::<JointOf>()),
            (ConductorOf::NAME, size_of::<ConductorOf>()),
            (LinkOf::NAME, size_of::<LinkOf>()),
            (ExchangeOf::NAME, size_of::<ExchangeOf>()),
            (Box3::NAME, size_of::<Box3>()),
            (Vector::NAME, size_of::<Vector>()),
            (Quad::NAME, size_of::<Quad>()),
        ]);
        let mut source = print::types() + &print::bond_types() + &print::heat_types() + &record_definitions();
        source += &network::record_definitions();
        source += &arithmetic::record_definitions();
        source += "KERNEL(64, 1) sizes(GLOBAL u32 *RESTRICT size)\n{\n    FOR_EACH(i, 1u) {\n";
        for (k, (name, _)) in sizes.iter().enumerate() {
            let _ = writeln!(source, "        size[{k}] = (u32)sizeof({name});");
        }
        source += "    }\n}\n";
        let runtime = open_opencl(0).expect("the tests need an OpenCL device");
        let kernel = runtime.build(&source, &["sizes"]).expect("the structs compile");
        let memory = runtime.allocate(4 * sizes.len()).expect("there is room");
        runtime.launch(&kernel[0], 1, 64, &[Argument::Memory(&memory)]).expect("it runs");
        let mut found = runtime.fetch(&memory, 4 * sizes.len()).expect("it is fetched");
        let found: &[u32] = bytemuck::cast_slice(found.wait().expect("it arrives"));
        for ((name, size), &found) in sizes.iter().zip(found) {
            assert_eq!(found as usize, *size, "{name}");
        }
    }
}
