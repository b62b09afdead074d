//! Words that people bring along from other programs, and what stands in their place here.

/// What to do instead of a word, if it is one that other programs have; case, spaces, hyphens and underscores do not matter.
///
/// ```
/// let instead = tdem_case::instead("rolling_friction").expect("LIGGGHTS and PFC have it");
/// assert!(instead.contains("rolling"));
/// assert_eq!(tdem_case::instead("RollingFriction"), Some(instead));
/// assert_eq!(tdem_case::instead("mushroom"), None);
/// ```
#[must_use]
pub fn instead(word: &str) -> Option<&'static str> {
    let plain =
        |word: &str| word.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect::<String>();
    let wanted = plain(word);
    HABITS.iter().find(|(words, _)| words.iter().any(|word| plain(word) == wanted)).map(|(_, help)| *help)
}

/// Words, and what to do.
const HABITS: &[(&[&str], &str)] = &[
    (
        &["stl", "mesh", "import_mesh", "geometry", "facets", "triangles", "surface_mesh", "obj", "gmsh"],
        "there are no meshes: walls are planes, [[wall]], six of them a [[box]]; other shapes are made of fixed particles, \
         cut out with within = { cylinder = ... } and `without`",
    ),
    (
        &[
            "insertion",
            "insert",
            "pour",
            "factory",
            "inlet",
            "generator",
            "create_atoms",
            "particle_factory",
            "rain",
            "deposit",
        ],
        "particles are not inserted during a run: all are there at the start, from [particles.random] or [particles.lattice]; \
         let them settle, and start the next stage from that run with [particles.run]",
    ),
    (
        &[
            "friction",
            "friction_coefficient",
            "coefficient_friction",
            "fric",
            "mu",
            "xmu",
            "friction_angle",
            "coulomb_friction",
            "sliding_friction",
        ],
        "there is friction, in each [[interaction]]: static_friction and dynamic_friction, the same number for one coefficient",
    ),
    (
        &[
            "rolling_friction",
            "rolling_resistance",
            "coefficient_rolling_friction",
            "rr_fric",
            "rrfric",
            "mu_r",
            "eta_roll",
            "epsd",
            "twisting_friction",
            "rolling",
        ],
        "there is no rolling resistance: spheres turn freely in GNTM and do not turn at all in GNT; bonded spheres \
         (model = \"BPM\") make bodies that do not roll",
    ),
    (
        &["cylinder", "cone", "drum", "cylinder_wall", "zcylinder", "xcylinder", "ycylinder", "sphere_wall"],
        "walls are planes, [[wall]] and [[box]]; a round container is made of fixed particles, cut out with \
         within = { cylinder = ... } and without = [{ cylinder = ... }]",
    ),
    (
        &[
            "cohesion",
            "adhesion",
            "jkr",
            "sjkr",
            "dmt",
            "cohesion_energy_density",
            "surface_energy",
            "capillary",
            "liquid_bridge",
        ],
        "there is no cohesion in contacts; bonds hold particles together: model = \"BPM\" and a [[bond]]",
    ),
    (
        &[
            "coefficient_of_restitution",
            "coefficient_restitution",
            "restitution_coefficient",
            "cor",
            "e_n",
            "en",
            "bounce",
        ],
        "write `restitution` in each [[interaction]], and contact.damping = \"restitution\"",
    ),
    (
        &["youngs_modulus", "young", "youngs", "elastic_modulus", "modulus", "ymod", "emod"],
        "write `young_modulus` in [material.NAME], Pa",
    ),
    (&["poissons_ratio", "poisson", "nu", "pratio", "poissons"], "write `poisson_ratio` in [material.NAME]"),
    (
        &[
            "kn",
            "ks",
            "kt",
            "k_n",
            "k_s",
            "k_t",
            "normal_stiffness",
            "shear_stiffness",
            "tangential_stiffness",
            "kratio",
            "linear",
            "hooke",
        ],
        "there are no linear springs: stiffness follows from young_modulus and poisson_ratio of the materials (Hertz and \
         Mindlin); contact.tangential_coefficient scales the tangential one",
    ),
    (
        &["gamma_n", "gamman", "gamma_t", "gammat", "dp_nratio", "dp_sratio", "viscous_damping", "damping_coefficient"],
        "write normal_damping and tangential_damping in each [[interaction]], 1/s; or `restitution` with \
         contact.damping = \"restitution\"",
    ),
    (&["timestep", "time_step", "dt", "delta_t", "tstep"], "write time.step, in s or \"auto\""),
    (
        &[
            "steps",
            "n_steps",
            "nsteps",
            "run",
            "duration",
            "end_time",
            "stop_time",
            "cycles",
            "iterations",
            "total_time",
        ],
        "write time.end, in s; `tdem run --steps N` stops after N steps; heat.duration is the length of a programme of heat",
    ),
    (
        &["boundary", "boundary_conditions", "periodic", "pbc", "processors"],
        "write domain.periodic = [true, true, false] for directions that are periodic; in others particles that leave the domain \
         stop the run, and [[wall]] or [[box]] hold them",
    ),
    (&["units", "unit_system", "si"], "all quantities are in SI units, and there is nothing to choose"),
    (
        &["region", "create_box", "block", "simulation_box"],
        "the simulation box is [domain]; [particles.random] and [particles.lattice] have a `min` and a `max` of their own",
    ),
    (
        &[
            "dump",
            "dump_every",
            "thermo",
            "vtk",
            "output_interval",
            "write_every",
            "save_interval",
            "log_interval",
            "recorder",
        ],
        "write output.frames, a number, or output.interval, in s; output.history_interval is that of history.csv",
    ),
    (
        &["restart", "checkpoint", "read_restart"],
        "checkpoints are always written: `tdem resume RUN` goes on from the last one; [particles.run] starts another case from it",
    ),
    (
        &["pair_style", "pair_coeff", "contact_model", "cmat", "law", "hertz", "mindlin", "atom_style", "physics"],
        "write `model`: \"GN\" (normal forces), \"GNT\" (with friction), \"GNTM\" (with rotation), \"BPM\" (with bonds), \"TBPM\" \
         (with bonds and heat); choices in the law stand in [contact]",
    ),
    (
        &["fix", "group", "freeze", "set", "body", "dynamic"],
        "write a [[zone]], or keys of a [[particles]] group: `fixed`, `prescribed`, `force`",
    ),
    (
        &[
            "servo",
            "servo_wall",
            "servo_control",
            "mesh_surface_stress_servo",
            "confining_pressure",
            "pressure",
            "stress_control",
            "triax",
        ],
        "walls have no servo control: they move at a given `velocity`; a `force` on a group or a zone of particles is constant or \
         along points",
    ),
    (
        &["clump", "multisphere", "superquadric", "polyhedron", "rigid_body", "ellipsoid", "template", "shape"],
        "particles are spheres; bodies of other shapes are bonded spheres: model = \"BPM\" and a [[bond]]",
    ),
    (
        &[
            "psd",
            "radius_distribution",
            "size_distribution",
            "particle_size_distribution",
            "rmin",
            "rmax",
            "radii",
            "r_rel_fuzz",
        ],
        "write radius = { min = ..., max = ..., distribution = \"number\" } in [particles.random], or \"volume\"",
    ),
    (&["diameter", "diam", "size_ratio"], "write `radius`, half of it, in m"),
    (&["mass", "weight", "particle_mass"], "masses follow from `density` of the material and the radius"),
    (
        &["porosity", "void_ratio", "void_fraction", "solid_fraction", "packing_fraction"],
        "write volume_fraction in [particles.random], which is 1 - porosity",
    ),
    (
        &["heat_capacity", "thermal_capacity", "cp", "specific_heat_capacity"],
        "write `specific_heat` in [material.NAME], J/(kg K)",
    ),
    (&["conductivity", "lambda", "k_thermal"], "write `thermal_conductivity` in [material.NAME], W/(m K)"),
    (
        &["cte", "thermal_expansion_coefficient", "expansion", "alpha"],
        "write `thermal_expansion` in [material.NAME], 1/K",
    ),
    (
        &["youngs_modulus_original", "area_correction", "true_young_modulus", "heat_young_modulus"],
        "write `original_young_modulus` in [material.NAME], Pa: contact spots then conduct as those of the true material",
    ),
    (
        &["h", "htc", "heat_transfer_coefficient", "film_coefficient"],
        "write convection = { coefficient = ..., temperature = ... } in a [[surface]]",
    ),
    (
        &["parallel_bond", "linearpbond", "pb_modulus", "bond_model", "cpm", "flat_joint", "jcfpm"],
        "write a [[bond]] with model = \"BPM\"",
    ),
    (&["omega", "spin", "angular_vel"], "write angular_velocity, rad/s"),
    (&["vel", "initial_velocity", "speed"], "write `velocity`, m/s"),
    (
        &["neighbor", "neigh_modify", "verlet_distance", "verlet_dist"],
        "write search.skin, as a fraction of the smallest radius",
    ),
    (
        &["threads", "omp", "gpu", "device", "cuda", "opencl", "mpi", "num_threads"],
        "where a case runs is said on the command line: `tdem run CASE --threads N`, `--device cuda`",
    ),
    (&["g", "grav", "gravity_magnitude"], "write gravity = [0.0, 0.0, -9.81], m/s²"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_word_has_one_remedy() {
        let mut words: Vec<&str> = HABITS.iter().flat_map(|(words, _)| words.iter().copied()).collect();
        let count = words.len();
        words.sort_unstable();
        words.dedup();
        assert_eq!(words.len(), count);
        assert!(words.iter().all(|word| instead(word).is_some()));
    }
}
