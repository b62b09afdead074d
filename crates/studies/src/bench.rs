//! How fast the engine is, as data: particle-steps per second (the Cundall number), bytes per particle, and where the time
//! of a step goes, beside what memory could do.
//!
//! Speed is shown by files of measurements, not by timed tests: a test that fails when a machine is busy says nothing.

use std::time::Instant;
use tdem_engine::physics::contact::{Interaction, Law};
use tdem_engine::physics::material::{Elastic, shear_modulus_eff, young_modulus_eff};
use tdem_engine::{Constraint, Device, Domain, Fault, Integrator, Plan, Profile, Search, Simulation, State};

/// The contact benchmark: a block of spheres on a face-centred cubic lattice, pressed together a little, all contacts
/// present from the start. Material and dampings are those of the gravity packing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactBlock {
    /// Which model.
    pub law: Law,
    /// Lattice cells per direction; four spheres each.
    pub cells: [usize; 3],
    /// Steps per measurement.
    pub steps: u64,
    /// Measurements; the best and the median are reported.
    pub repeats: usize,
    /// Whether dissipated energy is booked.
    pub ledger: bool,
}

impl Default for ContactBlock {
    /// 64,000 spheres, 100 steps: the case that other codes were measured with.
    fn default() -> Self {
        ContactBlock { law: Law::GNTM, cells: [20, 20, 40], steps: 100, repeats: 7, ledger: false }
    }
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Number of particles.
    pub particles: usize,
    /// Contacts per particle, each counted at both ends.
    pub contacts_per_particle: f64,
    /// Threads asked for, on a CPU.
    pub threads: usize,
    /// How often neighbours were listed while it was measured.
    pub searches: u64,
    /// Steps per measurement.
    pub steps: u64,
    /// Particle-steps per second, best of all repeats.
    pub best_rate: f64,
    /// Particle-steps per second, median of all repeats.
    pub median_rate: f64,
    /// Bytes held for the run, all arrays together, per particle.
    pub bytes_per_particle: f64,
    /// Hash of the final state, before the profile: the same on every machine.
    pub hash: u128,
    /// What came after, if it was asked for.
    pub profiled: Option<Profiled>,
}

/// Where the time of a step goes, beside what memory could do.
#[derive(Clone, Debug, PartialEq)]
pub struct Profiled {
    /// Stages apart.
    pub profile: Profile,
    /// How fast the device copies, bytes per second, read and written.
    pub copy_bandwidth: f64,
}

impl Measurement {
    /// Time of a whole step at the best rate, s.
    #[must_use]
    pub fn step_seconds(&self) -> f64 {
        self.particles as f64 / self.best_rate
    }
    /// What a whole step moves at least in that time, over what a copy would move.
    #[must_use]
    pub fn copy_fraction(&self) -> Option<f64> {
        let profiled = self.profiled.as_ref()?;
        Some(profiled.profile.bytes_per_step / self.step_seconds() / profiled.copy_bandwidth)
    }
}

/// Radius of the spheres, m.
const RADIUS: f64 = 0.01;
/// Lattice constant over that of touching spheres.
const SPACING: f64 = 0.999;
/// Density, kg/m³.
const DENSITY: f64 = 920.0;
/// Largest component of the initial velocities, m/s.
const AGITATION: f64 = 0.05;

/// Measures the contact benchmark.
///
/// # Errors
/// The [`Fault`] of a run that cannot go on; in this scene that would be a bug.
pub fn contact(block: &ContactBlock, device: &Device) -> Result<Measurement, Fault> {
    // Page faults and the first list belong to the start, not to the rate.
    let phase = Phase { after: 5, steps: block.steps, repeats: block.repeats, profile: 0 };
    phase.measure(lattice(block), plan(block), device)
}

/// What part of a run is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Steps before.
    pub after: u64,
    /// Steps per measurement.
    pub steps: u64,
    /// Measurements, one after the other; the best and the median are reported.
    pub repeats: usize,
    /// Steps of a profile behind them, which does not change what they measure; 0 leaves it out.
    pub profile: u64,
}

impl Phase {
    /// Measures whole steps: contacts, motion, walls, and search as often as it is due; then each stage for itself.
    ///
    /// # Errors
    /// The [`Fault`] of a run that cannot go on.
    pub fn measure(&self, state: State, plan: Plan, device: &Device) -> Result<Measurement, Fault> {
        self.measure_in(&mut Simulation::new(state, plan, device)?, device)
    }

    /// The same of a simulation that runs on this device already.
    ///
    /// # Errors
    /// The [`Fault`] of a run that cannot go on.
    pub fn measure_in(&self, simulation: &mut Simulation, device: &Device) -> Result<Measurement, Fault> {
        let particles = simulation.particles();
        simulation.advance(self.after)?;
        let searches = simulation.searches();
        let mut rates = Vec::with_capacity(self.repeats);
        for _ in 0..self.repeats.max(1) {
            let start = Instant::now();
            simulation.advance(self.steps)?;
            rates.push((particles as u64 * self.steps) as f64 / start.elapsed().as_secs_f64());
        }
        rates.sort_unstable_by(f64::total_cmp);
        let searches = simulation.searches() - searches;
        let bytes = simulation.bytes();
        let state = simulation.state()?;
        let (contacts, hash) = (state.contacts.len(), state.hash());
        drop(state);
        let profiled = if self.profile == 0 {
            None
        } else {
            let profile = simulation.profile(self.profile)?;
            Some(Profiled { profile, copy_bandwidth: simulation.copy_bandwidth()? })
        };
        Ok(Measurement {
            particles,
            contacts_per_particle: 2.0 * contacts as f64 / particles as f64,
            threads: match device {
                Device::Cpu(options) => {
                    options.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
                }
                Device::Gpu { .. } => 0,
            },
            searches,
            steps: self.steps,
            best_rate: rates[rates.len() - 1],
            median_rate: rates[rates.len() / 2],
            bytes_per_particle: bytes as f64 / particles as f64,
            hash,
            profiled,
        })
    }
}

fn plan(block: &ContactBlock) -> Plan {
    let plastic = Elastic { young_modulus: 9.33e6, poisson_ratio: 0.352 };
    let interaction = Interaction {
        normal_stiffness: 4.0 / 3.0 * young_modulus_eff(plastic, plastic),
        tangential_stiffness: 8.0 * shear_modulus_eff(plastic, plastic),
        normal_damping: 1500.0,
        tangential_damping: 150.0,
        static_friction: 1.0,
        dynamic_friction: 1.0,
        least_normal_force: 0.0,
    };
    Plan {
        dt: 1e-6,
        integrator: Integrator::VelocityVerlet,
        law: block.law,
        materials: 1,
        interactions: vec![interaction],
        bonds: None,
        heat: None,
        walls: Vec::new(),
        gravity: [0.0, 0.0, -9.81],
        constraints: vec![Constraint::FREE],
        ramps: Vec::new(),
        gauges: Vec::new(),
        domain: Domain { min: [-1e3; 3], max: [1e3; 3], periodic: [false; 3] },
        search: Search { skin: 0.1 * RADIUS, every_step: false },
        overlap_limit: 0.5,
        ledger: block.ledger,
    }
}

/// The block at rest but for small velocities that differ from sphere to sphere.
fn lattice(block: &ContactBlock) -> State {
    let [nx, ny, nz] = block.cells;
    let constant = 2.0 * 2.0_f64.sqrt() * RADIUS * SPACING;
    let basis = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let mut position = Vec::with_capacity(4 * nx * ny * nz);
    for cell in 0..nx * ny * nz {
        let corner = [cell % nx, cell / nx % ny, cell / nx / ny];
        for offset in basis {
            position.push(std::array::from_fn(|k| (corner[k] as f64 + offset[k]) * constant));
        }
    }
    let n = position.len();
    let mass = 4.0 / 3.0 * std::f64::consts::PI * RADIUS * RADIUS * RADIUS * DENSITY;
    State {
        id: (0..n as u32).collect(),
        material: vec![0; n],
        constraint: vec![0; n],
        radius: vec![RADIUS; n],
        mass: vec![mass; n],
        position,
        image: vec![[0; 3]; n],
        velocity: (0..n).map(agitation).collect(),
        angular_velocity: vec![[0.0; 3]; n],
        force: vec![[0.0; 3]; n],
        moment: vec![[0.0; 3]; n],
        ..State::default()
    }
}

/// A velocity for each particle, by a multiplicative hash of its number.
fn agitation(particle: usize) -> [f64; 3] {
    std::array::from_fn(|k| {
        let hashed = (3 * particle + k + 1) as u64;
        let hashed = hashed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let hashed = (hashed ^ hashed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11;
        AGITATION * (2.0 * hashed as f64 / (1_u64 << 53) as f64 - 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tdem_engine::cpu::{self, Options, Width};
    use tdem_engine::gpu;

    #[test]
    fn the_block_touches_everywhere_and_its_result_does_not_depend_on_threads() {
        let block = ContactBlock { cells: [6, 6, 6], steps: 20, repeats: 1, ..ContactBlock::default() };
        let one = contact(&block, &Options { threads: Some(1), ..Options::default() }.into()).unwrap();
        let three =
            contact(&block, &Options { threads: Some(3), width: Width::One, ..Options::default() }.into()).unwrap();
        assert_eq!(one.particles, 864);
        assert!(one.contacts_per_particle > 9.0, "{one:?}");
        assert_eq!(one.hash, three.hash);
        assert!(one.bytes_per_particle < 800.0 && one.best_rate >= one.median_rate);
    }

    #[test]
    fn a_profile_behind_the_measurement_does_not_change_it() {
        let block = ContactBlock { cells: [6, 6, 6], ..ContactBlock::default() };
        let device = Device::from(Options { threads: Some(1), ..Options::default() });
        let measure = |profile| {
            let phase = Phase { after: 5, steps: 20, repeats: 2, profile };
            phase.measure(lattice(&block), plan(&block), &device).unwrap()
        };
        let (plain, profiled) = (measure(0), measure(10));
        assert_eq!((plain.hash, plain.searches), (profiled.hash, profiled.searches));
        assert_eq!((&plain.profiled, plain.copy_fraction()), (&None, None));
        let found = profiled.profiled.as_ref().unwrap();
        assert_eq!((found.profile.steps, found.profile.parts.len()), (10, 6));
        assert!(found.profile.bytes_per_step > 100.0 * profiled.particles as f64);
        let fraction = profiled.copy_fraction().unwrap();
        let expected = found.profile.bytes_per_step * profiled.best_rate / profiled.particles as f64;
        assert!((fraction * found.copy_bandwidth / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn memory_of_a_device_is_known_before_a_run() {
        let device = Device::Gpu { api: gpu::Api::OpenCl, index: 0 };
        for (law, ledger) in [(Law::GN, false), (Law::GNTM, false), (Law::GNTM, true)] {
            let block = ContactBlock { law, ledger, cells: [14, 14, 14], steps: 1, repeats: 1 };
            // What touching pairs remember is put aside by the second search.
            let mut plan = plan(&block);
            plan.search.every_step = true;
            let phase = Phase { after: 1, steps: 1, repeats: 1, profile: 0 };
            let found = phase.measure(lattice(&block), plan.clone(), &device).unwrap();
            let pairs = 0.5 * found.contacts_per_particle * found.particles as f64;
            let expected = gpu::bytes(&plan, found.particles, pairs.round() as usize, 0);
            let ratio = found.bytes_per_particle / (expected as f64 / found.particles as f64);
            // Rows at the surface are as long as those beside them, and a little room is kept; without friction nothing is
            // put aside before results are taken.
            assert!(ratio > 0.92 && ratio < 1.08, "{block:?}: {found:?}, {ratio}");
        }
    }

    #[test]
    fn memory_is_known_before_a_run() {
        for law in [Law::GN, Law::GNT, Law::GNTM] {
            for ledger in [false, true] {
                let block = ContactBlock { law, ledger, cells: [6, 6, 6], steps: 1, repeats: 1 };
                let found = contact(&block, &Options::default().into()).unwrap();
                // In a crystal just the touching pairs are listed.
                let pairs = 0.5 * found.contacts_per_particle * found.particles as f64;
                let expected = cpu::bytes(&plan(&block), found.particles, pairs.round() as usize, 0);
                let expected = expected as f64 / found.particles as f64;
                assert!((found.bytes_per_particle - expected).abs() < 0.1, "{block:?}: {found:?}, not {expected}");
            }
        }
    }
}
